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
    #[error("`{0}` is not a rule of the form `name:=value`")]
    NoRule(String),
    /// An invalid namespace.
    #[error(
        "`{0}` is not a namespace; expected `/`, or names with a slash before each, such as `/robot1/base`; names have letters, digits \
         and underscores, and do not begin with a digit"
    )]
    Namespace(String),
    /// An invalid node name.
    #[error(
        "`{0}` is not the name of a node; names have letters, digits and underscores, and do not begin \
         with a digit; a namespace is set with `__ns`"
    )]
    Node(String),
    /// An invalid name of a topic, a service or an action.
    #[error(
        "`{0}` is not the name of a topic; expected names with slashes between them, such as `front/scan`, \
         optionally after `/` or `~/`; names have letters, digits and underscores, and do not begin with a digit"
    )]
    Topic(String),
    /// The help, or the version, cannot be printed.
    #[error("cannot print: {0}")]
    Output(String),
    /// An environment variable with an invalid value.
    #[error("the environment variable {name} must be {expected}, got `{value}`")]
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
