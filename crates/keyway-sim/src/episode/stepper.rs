//! The world of an episode, for an external controller.

use super::driver::{bound_for, remaining_m, world_of};
use super::task::Task;
use super::{Episode, EpisodeError, EpisodeRobot};
use crate::sim::{RunRules, Stepper};
use keyway::ConfigError;
use keyway::geometry::Pose;

impl Episode {
    /// Returns the episode's robot at the start in its world, for an external controller. The
    /// stack plans the first route, which determines the start heading and the time limit, and
    /// does not drive.
    ///
    /// # Errors
    /// Returns an error if the episode cannot be run, has no route, or has several robots.
    pub fn stepper(&self) -> Result<Stepper, EpisodeError> {
        let EpisodeRobot { robot, disturbances, start, via, goal, .. } = self.check()?;
        if self.robots.len() > 1 {
            let expected =
                format!("must be one for an external controller, got {}", self.robots.len());
            return Err(ConfigError::new("robots", expected).into());
        }
        let task = Task::new(self, 0);
        let world = world_of(&[task]).map_err(EpisodeError::of_all)?;
        let stack = task.fit()?;
        let (navigator, route) = bound_for(&self.known, &stack, (start.position, via, *goal))?;
        let start: Pose = task.start_pose(&world, &route)?;
        let rules: RunRules = task.run_rules(remaining_m(&navigator));
        let ends = (start, goal.position);
        let stepper = Stepper::new(world, robot.clone(), ends, disturbances.clone(), rules);
        stepper.map_err(EpisodeError::of_all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::run_episode;
    use crate::report::trajectory_row;
    use crate::sim::{Action, Control, RobotState};
    use keyway::geometry::Disc;
    use keyway::geometry::Point;
    use keyway::map::OccupancyGrid;
    use keyway::navigate::Step;
    use keyway::robot::Robot;
    use keyway::sense::Observation;

    /// Checks that external control by the episode's own navigator gives the episode's own run.
    #[test]
    fn it_is_the_world_of_the_episode() {
        let map = OccupancyGrid::from_ascii(&["........", "........", "........", "........"]);
        let (start, goal) = (Point::new(0.6, 2.0), Point::new(7.4, 2.0));
        let mut episode = Episode::new(map, Robot::small(), start, goal);
        episode.obstacles = vec![Disc::new(Point::new(4.0, 2.1), 0.3)];
        let mut run = episode.stepper().unwrap();
        let EpisodeRobot { robot, stack, .. } = &episode.robots[0];
        let stack = stack.fit(robot).unwrap();
        let ends = (start, &[][..], goal.into());
        let (mut navigator, _) = bound_for(&episode.known, &stack, ends).unwrap();
        while run.outcome().is_none() {
            let RobotState { stamp_s, pose, velocity } = run.told();
            let scans = run.scans();
            navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
            let action = match navigator.step() {
                Step::Arrived => Action::Arrived,
                step => Action::Drive(step.command()),
            };
            let (remaining_m, route) = (remaining_m(&navigator), navigator.ways_taken());
            let turn_left_rad = navigator.turn_left_rad();
            run.step(&Control { action, remaining_m, turn_left_rad, route }).unwrap();
        }
        let samples = run.into_run().unwrap().samples;
        let expected = run_episode(&episode).unwrap().first().trajectory.unwrap();
        assert_eq!(samples.iter().map(trajectory_row).collect::<Vec<_>>(), expected);
    }

    #[test]
    fn several_robots_are_not_driven_from_outside() {
        let map = OccupancyGrid::from_ascii(&["........"; 4]);
        let robot =
            |y: f64| EpisodeRobot::new(Robot::small(), Point::new(0.6, y), Point::new(7.4, y));
        let none = Episode::of_robots(map.clone(), vec![]).stepper().map(drop).unwrap_err();
        assert_eq!(none.to_string(), "robots must be one or more, got none");
        let two =
            Episode::of_robots(map, vec![robot(1.0), robot(3.0)]).stepper().map(drop).unwrap_err();
        assert_eq!(two.to_string(), "robots must be one for an external controller, got 2");
    }
}
