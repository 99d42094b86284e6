//! Errors at the start of the node.

use keyway::navigate::NavigateError;
use std::path::PathBuf;
use thiserror::Error;

/// The reason why the node cannot start.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StartError {
    /// An argument that does not exist.
    #[error(
        "unknown argument `{0}`; arguments of ROS come after `--ros-args`, and `--help` lists them"
    )]
    UnknownArgument(String),
    /// An argument at the end that needs a value.
    #[error("`{0}` needs a value after it")]
    ArgumentWithoutValue(String),
    /// A value that is not of the form `a:=b`.
    #[error("`{0}` is no rule of the form `name:=value`")]
    NoRule(String),
    /// An invalid namespace.
    #[error(
        "`{0}` is no namespace: it is `/`, or names with a slash before each, such as `/robot1/base`; names are letters, digits and \
         underscores, and begin with no digit"
    )]
    Namespace(String),
    /// An invalid node name.
    #[error(
        "`{0}` is no name of a node: it is letters, digits and underscores, and begins with no digit; \
         `__ns` gives a namespace"
    )]
    Node(String),
    /// An invalid name of a topic, a service or an action.
    #[error(
        "`{0}` is no name of a topic: it is names with a slash between them, such as `front/scan`, perhaps \
         after `/` or `~/`; names are letters, digits and underscores, and begin with no digit"
    )]
    Topic(String),
    /// The help, or the version, cannot be printed.
    #[error("cannot print: {0}")]
    Output(String),
    /// An environment variable with an invalid value.
    #[error("the variable {name} of the environment is `{value}`, and must be {expected}")]
    Variable {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: String,
        /// The valid values.
        expected: &'static str,
    },
    /// A file that cannot be read.
    #[error("cannot read {}: {why}", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The fault.
        why: String,
    },
    /// An invalid parameter.
    #[error("parameter `{name}`: {why}")]
    Parameter {
        /// Its name.
        name: String,
        /// The fault.
        why: String,
    },
    /// A robot and a stack that do not fit together.
    #[error(transparent)]
    Navigate(#[from] NavigateError),
    /// An invalid scene.
    #[error("{0}")]
    Scene(String),
    /// A network failure.
    #[error("cannot {what}: {why}")]
    Network {
        /// The failed operation.
        what: String,
        /// The reason reported by the network.
        why: String,
    },
}
