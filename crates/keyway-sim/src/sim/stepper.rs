//! A run that the caller advances cycle by cycle.

use super::drive::{check, command};
use super::fleet::{Entrant, Fleet};
use super::{
    Control, Disturbances, Outcome, Participant, RobotState, Run, RunRules, SimError, World,
    WorldAt,
};
use keyway::geometry::{Point, Pose};
use keyway::robot::Robot;
use keyway::sense::{Observation, Scan, SensorScan};
use std::borrow::Cow;

/// One robot in a world, for a caller that cannot provide a closure, such as a learning agent
/// that requests one step at a time. The same decisions give bitwise the same run as
/// [`simulate`](super::simulate).
///
/// ```
/// use keyway::geometry::{Point, Pose, Velocity};
/// use keyway::map::OccupancyGrid;
/// use keyway::robot::Robot;
/// use keyway_sim::sim::{Action, Control, Disturbances, Outcome, RunRules, Stepper, World};
///
/// let world = World::from_known(&OccupancyGrid::from_ascii(&["........", "........"]), Vec::new())?;
/// let (start, goal) = (Pose::new(1.0, 1.0, 0.0), Point::new(7.0, 1.0));
/// let (robot, rules) = (Robot::small(), RunRules::default());
/// let mut run = Stepper::new(world, robot, (start, goal), Disturbances::default(), rules)?;
/// while run.outcome().is_none() {
///     let pose = run.told().pose;
///     let action = Action::Drive(Velocity::new(0.5, 0.0));
///     let remaining_m = pose.point().distance(goal);
///     run.step(&Control { action, remaining_m, turn_left_rad: 0.0, route: 0 })?;
/// }
/// assert_eq!(run.outcome(), Some(Outcome::Reached));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Stepper {
    fleet: Fleet<'static>,
}

impl Stepper {
    /// Creates a robot at rest at its start with its first scan. If it starts in contact or at
    /// its goal, its run has already ended.
    ///
    /// # Errors
    /// Returns an error if an argument is invalid.
    pub fn new(
        world: World,
        robot: Robot,
        (start, goal): (Pose, Point),
        disturbances: Disturbances,
        rules: RunRules,
    ) -> Result<Self, SimError> {
        let mut nobody = |_: &Observation<'_>| unreachable!("a check asks nobody");
        check(&[Participant {
            robot: &robot,
            start,
            goal,
            disturbances: disturbances.clone(),
            rules: rules.clone(),
            controller: &mut nobody,
        }])?;
        let cycle_s = robot.cycle_s;
        let robot = Cow::Owned(robot);
        let entrant = Entrant { robot, start, goal, disturbances, rules };
        let mut fleet = Fleet::new(Cow::Owned(world), [entrant], cycle_s);
        fleet.sense(0);
        Ok(Self { fleet })
    }

    /// Outcome of the run; `None` while it continues.
    pub fn outcome(&self) -> Option<Outcome> {
        self.fleet.outcome(0)
    }

    /// Scans that the controller gets in this cycle; after the run, those of its last decision.
    pub fn scans(&self) -> Vec<SensorScan<'_>> {
        self.fleet.scans(0)
    }

    /// Last scan of the first sensor; after the run, the scan of its last decision.
    pub fn scan(&self) -> &Scan {
        self.fleet.scan(0)
    }

    /// Pose and velocity that were reported to the robot; after the run, the true ones.
    pub fn told(&self) -> RobotState {
        if self.outcome().is_some() { self.state() } else { self.fleet.told(0) }
    }

    /// The robot's true pose and velocity.
    pub fn state(&self) -> RobotState {
        self.fleet.state(0)
    }

    /// The world at the end of the last cycle.
    pub fn world(&self) -> WorldAt<'_> {
        self.fleet.world()
    }

    /// Drives one cycle. Does nothing after the run has ended.
    ///
    /// # Errors
    /// Returns an error if a velocity is not a number, or the run is given up. Nothing changes
    /// then.
    pub fn step(&mut self, control: &Control) -> Result<Option<Outcome>, SimError> {
        if self.outcome().is_none() {
            let cycle = self.fleet.cycle(0);
            let command = command(control.action, 0, cycle)?;
            if self.fleet.goes_on(0, control) {
                self.fleet.command(0, command);
                self.fleet.drive_cycle();
                self.fleet.sense(0);
            }
        }
        Ok(self.outcome())
    }

    /// Returns the run; `None` while it continues.
    pub fn into_run(self) -> Option<Run> {
        self.fleet.into_runs().pop()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{Action, SensorFaults, simulate};
    use keyway::geometry::{Disc, Velocity};
    use keyway::map::OccupancyGrid;

    /// Drives towards the longest range. The decisions depend on all inputs.
    fn wander(observation: &Observation<'_>) -> Control {
        let Observation { pose, velocity, scans, .. } = *observation;
        let scan = scans[0].scan;
        let seen = |i: &usize| scan.ranges_m.get(*i).unwrap().min(scan.range_max_m);
        let best = (0..scan.ranges_m.len()).max_by(|a, b| seen(a).total_cmp(&seen(b))).unwrap();
        let turn = scan.bearing_rad(best);
        let nearest_m = scan.ranges_m.iter().fold(scan.range_max_m, f64::min);
        let command = Velocity::new(0.2 * nearest_m + 0.1 * velocity.v.abs() + 0.01 * pose.x, turn);
        Control {
            action: Action::Drive(command),
            remaining_m: -pose.x - 10.0 * pose.theta,
            turn_left_rad: 0.0,
            route: 0,
        }
    }

    #[test]
    fn it_is_the_run_that_simulate_makes() {
        let map = OccupancyGrid::from_ascii(&["........", "..##....", "........", "........"]);
        let posts = vec![Disc::new(Point::new(5.0, 1.0), 0.25)];
        let world = World::from_known(&map, posts).unwrap();
        let (robot, start, goal) = (Robot::small(), Pose::new(1.0, 1.0, 0.3), Point::new(7.5, 3.5));
        let sensor = SensorFaults { range_m: 0.02, ..SensorFaults::default() };
        let disturbances = Disturbances { sensor, seed: 7, ..Disturbances::default() };
        let rules = RunRules { time_limit_s: 30.0, ..RunRules::default() };
        let mut one = [Participant {
            robot: &robot,
            start,
            goal,
            disturbances: disturbances.clone(),
            rules: rules.clone(),
            controller: &mut wander,
        }];
        let expected = simulate(&world, &mut one).unwrap().remove(0);
        let mut run =
            Stepper::new(world, robot.clone(), (start, goal), disturbances, rules).unwrap();
        while run.outcome().is_none() {
            let RobotState { stamp_s, pose, velocity } = run.told();
            let scans = run.scans();
            let control = wander(&Observation::new(stamp_s, pose, velocity, &scans));
            run.step(&control).unwrap();
        }
        assert!(expected.cycles > 20, "{:?}", expected.outcome);
        assert_eq!(run.world().discs().count(), 1);
        assert_eq!(Some(run.told().pose), expected.samples.last().map(|sample| sample.pose));
        assert_eq!(run.into_run(), Some(expected));
    }

    #[test]
    fn it_can_be_given_up_and_goes_on_after_a_mistake() {
        let world = World::from_known(&OccupancyGrid::from_ascii(&["....", "...."]), Vec::new());
        let (start, goal) = (Pose::new(1.0, 1.0, 0.0), Point::new(3.0, 1.0));
        let rules = RunRules::default();
        let robot = Robot::small();
        let mut run =
            Stepper::new(world.unwrap(), robot, (start, goal), Disturbances::default(), rules)
                .unwrap();
        let control = |action| Control { action, remaining_m: 1.0, route: 0, turn_left_rad: 0.0 };
        let nan = Velocity::new(f64::NAN, 0.0);
        assert!(run.step(&control(Action::Drive(nan))).is_err());
        let given_up = run.step(&control(Action::GiveUp)).unwrap_err();
        assert_eq!(given_up, SimError::GivenUp { cycle: 0 });
        assert_eq!(run.step(&control(Action::Drive(Velocity::new(0.1, 0.0)))), Ok(None));
        assert!(run.state().pose.x > 1.0);
    }
}
