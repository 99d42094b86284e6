//! `std_srvs`.

use super::{Empty, Service};
use serde::{Deserialize, Serialize};

/// A question to be answered with yes or no: whether nodes are active.
pub(crate) struct IsActive;

impl Service for IsActive {
    const NAME: (&'static str, &'static str) = ("std_srvs", "Trigger");
    type Request = Empty;
    type Response = Triggered;
}

/// The answer, with a word about it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Triggered {
    pub(crate) success: bool,
    pub(crate) message: String,
}
