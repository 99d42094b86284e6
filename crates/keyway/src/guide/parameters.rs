//! What every guide says of itself by its parameters.

use super::Guide;
use crate::ConfigError;
use crate::robot::Robot;

/// A guide chosen by name.
pub(super) type BoxedGuide = Box<dyn Guide + Send + Sync>;

/// What is known of a guide by its parameters.
pub(super) trait GuideParameters {
    /// The parameters for a robot.
    fn for_robot(robot: &Robot) -> Self
    where
        Self: Sized;

    /// The guide with these parameters.
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
