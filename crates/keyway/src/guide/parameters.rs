//! The interface that every guide's parameters implement.

use super::Guide;
use crate::ConfigError;
use crate::robot::Robot;

/// A guide chosen by name.
pub(super) type BoxedGuide = Box<dyn Guide + Send + Sync>;

/// Properties of a guide that follow from its parameters.
pub(super) trait GuideParameters {
    /// The parameters for a robot.
    fn for_robot(robot: &Robot) -> Self
    where
        Self: Sized;

    /// Builds the guide.
    fn build(&self) -> Result<BoxedGuide, ConfigError>;

    /// The values of the guide's paper.
    fn as_published() -> Option<Self>
    where
        Self: Sized,
    {
        None
    }

    /// Fields for which the paper gives no value.
    fn readings(&self) -> &'static [&'static str] {
        &[]
    }
}
