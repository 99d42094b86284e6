//! What of a controller can be written outside the crate.

use super::Stack;
use crate::ConfigError;
use crate::guide::Guide;
use crate::local::LocalPlanner;
use crate::robot::Robot;
use std::sync::Arc;

/// The local planner and the guide of a controller: those of a stack, or any others.
///
/// ```
/// use keyway::guide::{Carrot, CarrotConfig};
/// use keyway::navigate::{Parts, Stack};
/// use keyway::robot::Robot;
/// use std::sync::Arc;
///
/// let robot = Robot::small();
/// let parts = Parts::of(&Stack::keyway(&robot), &robot)?;
/// // Stands for a guide of your own.
/// let carrot = Carrot::new(CarrotConfig { look_ahead_m: 0.5 })?;
/// let parts = Parts { guide: Arc::new(carrot), ..parts };
/// # Ok::<(), keyway::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Parts {
    /// Decides on a velocity in each cycle, in place of `local` of the stack.
    pub local: Arc<dyn LocalPlanner + Send + Sync>,
    /// Chooses the point to drive towards, in place of `guide` of the stack.
    pub guide: Arc<dyn Guide + Send + Sync>,
}

impl Parts {
    /// The parts of a stack.
    ///
    /// # Errors
    /// When a value of theirs or of the robot cannot be used; the error names the field.
    pub fn of(stack: &Stack, robot: &Robot) -> Result<Self, ConfigError> {
        let local = stack.local.build(robot).map_err(|error| error.within("local"))?;
        let guide = stack.guide.build().map_err(|error| error.within("guide"))?;
        Ok(Self { local: local.into(), guide: guide.into() })
    }
}
