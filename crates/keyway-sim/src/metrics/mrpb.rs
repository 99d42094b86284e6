//! Metrics of MRPB, a benchmark of local planners.
//!
//! # Source
//! \[Wen2021\], and the program published by its authors.
//!
//! | paper | here | unit |
//! |---|---|---|
//! | `d_o` | [`Mrpb::min_distance_m`] | m |
//! | `p_o` | [`Mrpb::share_near`] | |
//! | `f_ps` | [`Mrpb::path_smoothness_m2`] | m² |
//! | `f_vs` | [`Mrpb::velocity_smoothness_mps2`] | m/s² |
//!
//! The times of MRPB, T and C, are [`RunMetrics::time_s`](super::RunMetrics::time_s) and the mean
//! time of a decision, which needs a clock.
//!
//! # Difference from the paper
//! The published program ignores an interval near obstacles that lasts until the end of a run;
//! here it counts.
//!
//! # Cost
//! One distance to the nearest obstacle for every sample of the run. Allocates nothing.

use crate::sim::{Run, TrajectoryPoint, World};
use keyway::geometry::Point;
use keyway::robot::{Footprint, Robot};
use serde::{Deserialize, Serialize};

/// Safety and smoothness of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mrpb {
    /// Distance from the robot's centre of rotation below which an obstacle is near \[m\].
    pub safe_distance_m: f64,
    /// Smallest distance from the robot's centre of rotation to an obstacle at the ends of the
    /// cycles \[m\]; `None` without obstacles.
    pub min_distance_m: Option<f64>,
    /// Share of the time that the robot spent near obstacles; `None` for a run of zero duration.
    pub share_near: Option<f64>,
    /// Sum over all cycles of the squared second difference of the position, |x(k + 1) - 2 x(k) +
    /// x(k - 1)|² \[m²\].
    pub path_smoothness_m2: f64,
    /// Mean over all cycles of the absolute change of speed per time \[m/s²\]; `None` for a run of
    /// zero duration.
    pub velocity_smoothness_mps2: Option<f64>,
}

impl Mrpb {
    /// Returns the safe distance of a robot, which the benchmark leaves to its user: 0.1 m more
    /// than the circumscribed radius of its footprint \[m\].
    pub fn safe_distance_m(robot: &Robot) -> f64 {
        robot.footprint.circumscribed_radius_m() + 0.1
    }

    /// Measures a run in its world.
    pub fn of_run(run: &Run, world: &World, safe_distance_m: f64) -> Self {
        let world = &*run.world(world);
        let mut nearest_m = f64::INFINITY;
        let (mut near_s, mut was_near) = (0.0, false);
        let mut before_s = 0.0;
        for sample in &run.samples {
            let reach_m = nearest_m.max(safe_distance_m);
            let distance_m = distance_m(world, sample, reach_m);
            nearest_m = nearest_m.min(distance_m);
            let is_near = distance_m < safe_distance_m;
            near_s += if is_near && was_near { sample.t_s - before_s } else { 0.0 };
            (was_near, before_s) = (is_near, sample.t_s);
        }
        let time_s = before_s;
        Self {
            safe_distance_m,
            min_distance_m: nearest_m.is_finite().then_some(nearest_m),
            share_near: (time_s > 0.0).then(|| near_s / time_s),
            path_smoothness_m2: path_smoothness_m2(&run.samples),
            velocity_smoothness_mps2: velocity_smoothness_mps2(&run.samples),
        }
    }
}

/// Distance from the robot's centre to the nearest obstacle \[m\]; `reach_m` if none is nearer.
fn distance_m(world: &World, sample: &TrajectoryPoint, reach_m: f64) -> f64 {
    world.at(sample.t_s).distance(&Footprint::POINT, sample.pose, reach_m)
}

fn path_smoothness_m2(samples: &[TrajectoryPoint]) -> f64 {
    let second_difference = |three: &[TrajectoryPoint]| {
        let [a, b, c] = [0, 1, 2].map(|i: usize| three[i].pose.point());
        let Point { x, y } = (c - b) - (b - a);
        x * x + y * y
    };
    samples.windows(3).map(second_difference).sum()
}

fn velocity_smoothness_mps2(samples: &[TrajectoryPoint]) -> Option<f64> {
    let rate = |two: &[TrajectoryPoint]| {
        (two[1].velocity.v - two[0].velocity.v).abs() / (two[1].t_s - two[0].t_s)
    };
    let cycles = samples.len().checked_sub(1).filter(|&cycles| cycles > 0)?;
    Some(samples.windows(2).map(rate).sum::<f64>() / cycles as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{
        KeyFrame, KeyFrames, MoverWay, MovingObstacle, ObstacleMotion, Outcome, WayPoints,
    };
    use keyway::geometry::{Disc, Pose, Velocity};
    use keyway::map::OccupancyGrid;

    /// A run with cycles of 0.5 s, given by positions on a line, and speeds.
    fn run(driven: &[(f64, f64)]) -> Run {
        let sample = |(i, &(x, v)): (usize, &(f64, f64))| TrajectoryPoint {
            t_s: i as f64 * 0.5,
            pose: Pose::new(x, 2.5, 0.0),
            velocity: Velocity::new(v, 0.0),
        };
        Run {
            outcome: Outcome::Reached,
            samples: driven.iter().enumerate().map(sample).collect(),
            length_m: 1.0,
            min_clearance_m: None,
            min_standing_clearance_m: None,
            min_mover_clearance_m: None,
            min_robot_clearance_m: None,
            movers: Vec::new(),
            cycles: driven.len() as u64 - 1,
        }
    }

    fn world(circles: Vec<Disc>) -> World {
        World::from_known(&OccupancyGrid::from_ascii(&[".........."; 5]), circles).unwrap()
    }

    const DRIVEN: [(f64, f64); 6] =
        [(1.0, 0.0), (1.5, 1.0), (2.5, 2.0), (3.5, 2.0), (4.0, 0.5), (4.0, 0.0)];

    #[test]
    fn measures_by_hand() {
        // The disc's edge is 0.5 m from the positions 2.5 and 4.5.
        let post = Disc::new(Point::new(3.5, 2.5), 0.5);
        let world = world(vec![post]);
        let mrpb = Mrpb::of_run(&run(&DRIVEN), &world, 0.6);
        assert_eq!(mrpb.min_distance_m, Some(0.0));
        // Near at 2.5, at 3.5 and twice at 4.0: 1.5 of 2.5 s, the end of the run included.
        assert!((mrpb.share_near.unwrap() - 0.6).abs() < 1e-12);
        // Second differences 0.5, 0, -0.5, -0.5.
        assert!((mrpb.path_smoothness_m2 - 0.75).abs() < 1e-12);
        // Changes 1, 1, 0, 1.5, 0.5 in 0.5 s each.
        assert!((mrpb.velocity_smoothness_mps2.unwrap() - 1.6).abs() < 1e-12);
        let far = Mrpb::of_run(&run(&DRIVEN[..2]), &world, 0.6);
        assert_eq!((far.min_distance_m, far.share_near), (Some(1.5), Some(0.0)));
    }

    /// A moving obstacle comes near the stationary robot at only one instant of the run.
    #[test]
    fn movers_are_where_they_are_then() {
        let frame = |t_s, x, y| KeyFrame { t_s, position: Point::new(x, y) };
        let frames = vec![frame(0.0, 9.0, 0.5), frame(1.0, 2.5, 3.0), frame(1.5, 9.0, 0.5)];
        let motion = ObstacleMotion::KeyFrames(KeyFrames::new(frames.clone()).unwrap());
        let among =
            |motion| world(vec![]).with_movers(vec![MovingObstacle::new(0.25, motion).unwrap()]);
        let mrpb = Mrpb::of_run(&run(&DRIVEN), &among(motion), 0.6);
        assert!((mrpb.min_distance_m.unwrap() - 0.25).abs() < 1e-12);
        // One sample has no duration.
        assert_eq!(mrpb.share_near, Some(0.0));
        // The recorded path of an obstacle that gave way gives the same result.
        let course = WayPoints::around(vec![Point::new(9.0, 0.5), Point::new(9.0, 4.5)], 1.0);
        let movers = vec![MoverWay { index: 0, key_frames: frames }];
        let run = Run { movers, ..run(&DRIVEN) };
        let world = among(ObstacleMotion::GivesWay(course.unwrap()));
        assert_eq!(Mrpb::of_run(&run, &world, 0.6), mrpb);
    }

    #[test]
    fn nothing_near_and_no_time() {
        let mrpb = Mrpb::of_run(&run(&[(1.0, 0.0)]), &world(vec![]), 0.6);
        assert_eq!((mrpb.min_distance_m, mrpb.share_near), (None, None));
        assert_eq!((mrpb.path_smoothness_m2, mrpb.velocity_smoothness_mps2), (0.0, None));
        assert!((Mrpb::safe_distance_m(&Robot::small()) - 0.28).abs() < 1e-12);
    }
}
