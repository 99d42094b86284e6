//! Messages of ROS 2 by their packages: their fields in the order of their definitions, which is
//! their encoding (CDR).
//!
//! The encoding says nothing of the fields, so a definition that differs between distributions is
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
    /// Its package and its name in there.
    const NAME: (&'static str, &'static str);
}

/// An action: what is asked for, what becomes of it, and what is told on the way.
pub(crate) trait Action: 'static {
    /// Its package and its name in there.
    const NAME: (&'static str, &'static str);
    type Goal: Clone + Serialize + DeserializeOwned + Send + 'static;
    type Outcome: Clone + Serialize + DeserializeOwned + Send + 'static;
    type Feedback: Clone + Serialize + DeserializeOwned + Send + 'static;
}

/// A service: a request and its response.
pub(crate) trait Service: 'static {
    /// Its package and its name in there.
    const NAME: (&'static str, &'static str);
    type Request: Clone + Serialize + DeserializeOwned + Send + 'static;
    type Response: Clone + Serialize + DeserializeOwned + Send + 'static;
}

/// Makes a service of its parts.
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

/// A definition without fields: it has one byte, as C knows no empty structs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, serde::Deserialize)]
pub(crate) struct Empty {
    structure_needs_at_least_one_member: u8,
}
