//! `lifecycle_msgs`.

use super::{Empty, Service, service};
use serde::{Deserialize, Serialize};

service! {
    /// Query of the state of a managed node.
    "lifecycle_msgs", GetState: Empty => State
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct State {
    pub(crate) id: u8,
    pub(crate) label: String,
}

impl State {
    /// State of an active or inactive node.
    pub(crate) fn of(is_active: bool) -> Self {
        let (id, label) = if is_active { (3, "active") } else { (2, "inactive") };
        Self { id, label: label.to_owned() }
    }
}
