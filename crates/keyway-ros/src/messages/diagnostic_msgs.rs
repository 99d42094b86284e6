//! `diagnostic_msgs`.

use super::Named;
use super::std_msgs::Header;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DiagnosticArray {
    pub(crate) header: Header,
    pub(crate) status: Vec<DiagnosticStatus>,
}

impl Named for DiagnosticArray {
    const NAME: (&'static str, &'static str) = ("diagnostic_msgs", "DiagnosticArray");
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct DiagnosticStatus {
    pub(crate) level: u8,
    pub(crate) name: String,
    pub(crate) message: String,
    pub(crate) hardware_id: String,
    pub(crate) values: Vec<KeyValue>,
}

impl DiagnosticStatus {
    pub(crate) const OK: u8 = 0;
    pub(crate) const WARN: u8 = 1;
    pub(crate) const ERROR: u8 = 2;
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct KeyValue {
    pub(crate) key: String,
    pub(crate) value: String,
}
