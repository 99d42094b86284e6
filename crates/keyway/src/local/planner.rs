//! Local planners: they map a scene to the velocity for the next cycle.

use super::{Decision, Explanation, NoCommand, Scene};
use crate::geometry::{Point, Velocity};
use arrayvec::ArrayVec;
use serde::{Deserialize, Serialize};
use std::any::Any;
use std::fmt::Debug;

/// Decides on a velocity in each control cycle.
///
/// A planner is an immutable configuration. Its state from cycle to cycle is [`DriveMemory`],
/// which the caller can inspect, keep and restore; its working memory is [`Scratch`]. So the same
/// scene and the same memory give the same decision.
///
/// ```
/// use keyway::geometry::Velocity;
/// use keyway::local::{Decision, DriveMemory, Evaluation, LocalPlanner, NoCommand, Scene, Scratch};
///
/// /// Turns towards the guide point and never drives.
/// #[derive(Debug)]
/// struct Sunflower;
///
/// impl LocalPlanner for Sunflower {
///     fn decide(
///         &self,
///         scene: &Scene<'_>,
///         _: &mut DriveMemory,
///         _: &mut Scratch,
///     ) -> Result<Decision, NoCommand> {
///         let bearing_rad = scene.pose.bearing_to(scene.guide);
///         let command = Velocity::new(0.0, bearing_rad.clamp(-1.0, 1.0));
///         Ok(Decision { command, evaluation: Evaluation::default() })
///     }
/// }
/// ```
pub trait LocalPlanner: Debug {
    /// Returns the velocity for the next cycle. Allocates nothing once `scratch` is warm.
    ///
    /// # Errors
    /// Returns [`NoCommand`] if no velocity is admissible; the error gives the reason and carries
    /// a safe command.
    fn decide(
        &self,
        scene: &Scene<'_>,
        memory: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand>;

    /// Explains its decision: the point it drives towards, the fate of each candidate, given the
    /// memory from before the decision, and, if none drives, the changes that would free the
    /// robot. A planner that does not choose between candidates returns none.
    ///
    /// It costs many times as much as the decision, and allocates.
    fn explain(&self, _scene: &Scene<'_>, _memory: &DriveMemory) -> Explanation {
        Explanation::default()
    }

    /// True if the planner itself turns the robot in time before narrow ground; otherwise the
    /// controller does.
    fn turns_in_time(&self) -> bool {
        false
    }
}

/// The memory of a local planner from one cycle to the next.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct DriveMemory {
    /// Arc length of the route that the robot has covered \[m\].
    pub covered_m: f64,
    /// The part that only the planner that wrote it interprets.
    pub own: OwnMemory,
}

/// The part of a memory that belongs to one kind of planner.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum OwnMemory {
    /// Nothing: the planner decides afresh in every cycle, or is on its route.
    #[default]
    Nothing,
    /// The detour around an unknown obstacle on which a [`GuidedDwa`](super::GuidedDwa) is.
    Detour(Detour),
    /// The trajectory that the last command of a [`SpaceTime`](super::SpaceTime) planner began.
    Course(Course),
}

impl DriveMemory {
    /// The memory at the beginning of another route: a `Course` is kept, a detour is not.
    #[must_use]
    pub fn on_another_route(self) -> Self {
        let own = match self.own {
            own @ OwnMemory::Course(_) => own,
            OwnMemory::Nothing | OwnMemory::Detour(_) => OwnMemory::Nothing,
        };
        Self { covered_m: 0.0, own }
    }

    /// The detour around an unknown obstacle, if the planner is on one.
    pub const fn detour(&self) -> Option<Detour> {
        match self.own {
            OwnMemory::Detour(detour) => Some(detour),
            OwnMemory::Nothing | OwnMemory::Course(_) => None,
        }
    }

    /// The trajectory that the last command began, if the planner plans farther than its command.
    pub const fn course(&self) -> Option<&Course> {
        match &self.own {
            OwnMemory::Course(course) => Some(course),
            OwnMemory::Nothing | OwnMemory::Detour(_) => None,
        }
    }
}

/// A space-time trajectory: velocities at the ends of stretches of the same duration; in between
/// they change linearly.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Course {
    /// The duration of a stretch \[s\].
    pub stretch_s: f64,
    /// The velocities, in order.
    pub velocities: ArrayVec<Velocity, { Course::MOST_STRETCHES }>,
}

impl Course {
    /// Upper limit of the number of stretches.
    pub const MOST_STRETCHES: usize = 32;

    /// Velocity at an instant after the beginning of a trajectory that begins with `first`; after
    /// its end, the last velocity.
    pub fn velocity(&self, first: Velocity, after_s: f64) -> Velocity {
        let stretches = after_s / self.stretch_s;
        let begun = stretches.max(0.0) as usize;
        let last = self.velocities.last().copied().unwrap_or(first);
        let Some(&to) = self.velocities.get(begun) else { return last };
        let from = begun.checked_sub(1).map_or(first, |before| self.velocities[before]);
        from.lerp(to, stretches - begun as f64)
    }
}

/// A detour around an obstacle that is not in the known map, with the names of \[ZhuYin2024\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "stage", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Detour {
    /// Towards a point behind it.
    Behind {
        /// `x_j`: beginning of the detour \[m\].
        from: Point,
        /// `x_ga`: the point behind it \[m\].
        point: Point,
        /// Arc length of `x_st`, the node of the route nearest to that point, from the start of
        /// the route \[m\].
        rejoin_m: f64,
    },
    /// From there back to the route.
    Back {
        /// `x_it`: the point at which the route is joined \[m\].
        point: Point,
        /// Its arc length from the start of the route \[m\].
        along_m: f64,
    },
}

/// Working memory of local planners. It holds no result and has no meaning between calls; keeping
/// it saves allocations. Each planner keeps its part under a type of its own.
#[derive(Debug, Default)]
pub struct Scratch {
    parts: Vec<Box<dyn Any + Send>>,
}

impl Scratch {
    /// The part of this type, as the last call left it; initially its default.
    #[expect(clippy::missing_panics_doc, reason = "a part is found by its type")]
    pub fn part<T: Any + Send + Default>(&mut self) -> &mut T {
        let known = self.parts.iter().position(|part| part.is::<T>());
        let index = known.unwrap_or_else(|| {
            self.parts.push(Box::new(T::default()));
            self.parts.len() - 1
        });
        self.parts[index].downcast_mut().expect("the part was found by its type")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocities_of_a_course_change_linearly() {
        let velocities = [Velocity::new(1.0, 0.0), Velocity::new(1.0, 2.0)].into_iter().collect();
        let course = Course { stretch_s: 0.5, velocities };
        let at = |after_s: f64| course.velocity(Velocity::new(0.5, 0.0), after_s);
        assert_eq!(at(0.0), Velocity::new(0.5, 0.0));
        assert_eq!(at(0.25), Velocity::new(0.75, 0.0));
        assert_eq!(at(0.5), Velocity::new(1.0, 0.0));
        assert_eq!(at(0.75), Velocity::new(1.0, 1.0));
        assert_eq!((at(1.0), at(9.0)), (Velocity::new(1.0, 2.0), Velocity::new(1.0, 2.0)));
        let none = Course { stretch_s: 0.5, velocities: ArrayVec::new() };
        assert_eq!(none.velocity(Velocity::new(0.5, 0.0), 0.7), Velocity::new(0.5, 0.0));
    }

    #[test]
    fn each_type_has_a_part_of_its_own() {
        let mut scratch = Scratch::default();
        scratch.part::<Vec<u8>>().push(7);
        scratch.part::<Vec<f64>>().push(0.5);
        assert_eq!((scratch.part::<Vec<u8>>().len(), scratch.part::<Vec<f64>>()[0]), (1, 0.5));
        let info = allocation_counter::measure(|| scratch.part::<Vec<u8>>()[0] = 8);
        assert_eq!((info.count_total, scratch.part::<Vec<u8>>()[0]), (0, 8));
    }
}
