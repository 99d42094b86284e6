//! `std_srvs`.

use super::{Empty, Service};
use serde::{Deserialize, Serialize};

/// Query that asks if nodes are active.
pub(crate) struct IsActive;

impl Service for IsActive {
    const NAME: (&'static str, &'static str) = ("std_srvs", "Trigger");
    type Request = Empty;
    type Response = Triggered;
}

/// A success flag, with a message.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Triggered {
    pub(crate) success: bool,
    pub(crate) message: String,
}
