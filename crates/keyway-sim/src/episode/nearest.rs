//! Replacement of unreachable goals.

use super::task::Task;
use super::{Episode, EpisodeError};
use keyway::geometry::Point;
use keyway::navigate::{Goal, Navigator};

/// A reachable goal that replaces an unreachable one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestGoal {
    /// Index of the robot.
    pub robot: usize,
    /// Requested goal \[m\].
    pub asked: Point,
    /// Replacement: the nearest reachable position \[m\].
    pub goal: Point,
}

impl Episode {
    /// Replaces each goal that is unreachable from the last way-point or the start by the nearest
    /// reachable position, with any heading; returns the replaced goals. A goal stays if no
    /// position is reachable.
    ///
    /// # Errors
    /// Returns an error if the episode cannot be run.
    pub fn reach_nearest(&mut self) -> Result<Vec<NearestGoal>, EpisodeError> {
        self.check()?;
        let mut replaced = Vec::new();
        for robot in 0..self.robots.len() {
            let task = Task::new(self, robot);
            let blame = |error| task.blame(error);
            let mut navigator = Navigator::new(&self.known, &task.fit()?).map_err(blame)?;
            let (start, asked) = (task.robot.start.position, task.robot.goal.position);
            let from = task.robot.via.last().copied().unwrap_or(start);
            let nearest = navigator.nearest_reachable(from, asked);
            if let Some(goal) = nearest.filter(|&goal| goal != asked) {
                self.robots[robot].goal = Goal::from(goal);
                replaced.push(NearestGoal { robot, asked, goal });
            }
        }
        Ok(replaced)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::episode::{EpisodeOutcome, EpisodeRobot, run_episode};
    use keyway::map::OccupancyGrid;
    use keyway::robot::Robot;

    #[test]
    fn it_drives_to_the_nearest_place() {
        let map = OccupancyGrid::from_ascii(&["....#...", "....#...", "....#...", "....#..."]);
        let robot = |goal: [f64; 2]| {
            EpisodeRobot::new(Robot::small(), Point::new(0.6, 2.0), Point::from(goal))
        };
        let mut episode = Episode::of_robots(map, vec![robot([7.0, 2.4]), robot([2.5, 2.5])]);
        let replaced = episode.reach_nearest().unwrap();
        let [NearestGoal { robot: 0, goal, .. }] = replaced[..] else { panic!("{replaced:?}") };
        assert_eq!(goal, Point::new(3.5, 2.5));
        assert_eq!(episode.robots[1].goal.position, Point::new(2.5, 2.5));
        episode.robots.truncate(1);
        assert_eq!(run_episode(&episode).unwrap().first().outcome, EpisodeOutcome::Reached);
        assert_eq!(episode.reach_nearest().unwrap(), [], "it can be reached now");
    }
}
