//! Messages of ROS 2, by package. The order of the fields is that of their definitions, which
//! determines their encoding (CDR).
//!
//! The encoding does not identify fields, so a definition that differs between distributions is
//! written once for each of them.

pub(crate) mod builtin_interfaces;
pub(crate) mod diagnostic_msgs;
pub(crate) mod geometry_msgs;
pub(crate) mod lifecycle_msgs;
pub(crate) mod map_msgs;
pub(crate) mod nav2_msgs;
pub(crate) mod nav_msgs;
pub(crate) mod rosgraph_msgs;
pub(crate) mod sensor_msgs;
pub(crate) mod std_msgs;
pub(crate) mod std_srvs;
pub(crate) mod tf2_msgs;
pub(crate) mod visualization_msgs;

use serde::Serialize;
use serde::de::DeserializeOwned;

/// A message of a topic.
pub(crate) trait Named: Clone + Serialize + DeserializeOwned + Send + 'static {
    /// Its package and its name in that package.
    const NAME: (&'static str, &'static str);
}

/// An action: its goal, its outcome, and its feedback.
pub(crate) trait Action: 'static {
    /// Its package and its name in that package.
    const NAME: (&'static str, &'static str);
    type Goal: Clone + Serialize + DeserializeOwned + Send + 'static;
    type Outcome: Clone + Serialize + DeserializeOwned + Send + 'static;
    type Feedback: Clone + Serialize + DeserializeOwned + Send + 'static;
}

/// A service: a request and its response.
pub(crate) trait Service: 'static {
    /// Its package and its name in that package.
    const NAME: (&'static str, &'static str);
    type Request: Clone + Serialize + DeserializeOwned + Send + 'static;
    type Response: Clone + Serialize + DeserializeOwned + Send + 'static;
}

/// Defines a service from its parts.
macro_rules! service {
    ($(#[$doc:meta])* $package:literal, $service:ident: $request:ty => $response:ty) => {
        $(#[$doc])*
        pub(crate) struct $service;

        impl Service for $service {
            const NAME: (&'static str, &'static str) = ($package, stringify!($service));
            type Request = $request;
            type Response = $response;
        }
    };
}
use service;

/// A definition without fields: it has one byte, as C has no empty structs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, serde::Deserialize)]
pub(crate) struct Empty {
    structure_needs_at_least_one_member: u8,
}
