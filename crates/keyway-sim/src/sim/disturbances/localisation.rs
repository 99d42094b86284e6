//! Localisation and odometry errors: the pose and velocity that are reported to a controller.

use super::gaussian::{Gaussian, cut};
use super::{Kind, LocalisationFaults, Source, cycles_late};
use keyway::geometry::{Point, Pose, Velocity};
use keyway::random::Random;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Errors of a robot's localisation and odometry.
#[derive(Clone, Debug)]
pub(in crate::sim) struct Localisation {
    faults: LocalisationFaults,
    x: CorrelatedError,
    y: CorrelatedError,
    heading: CorrelatedError,
    v: Gaussian,
    omega: Gaussian,
    drift: Drift,
    jumps: Option<Jumps>,
    /// Delay from a pose to its report \[cycles\].
    late: usize,
    cycle_s: f64,
    /// Poses and velocities that are not reported yet, oldest first.
    under_way: VecDeque<(Pose, Velocity)>,
}

/// True state of a robot at the beginning of a cycle.
#[derive(Clone, Copy, Debug)]
pub(in crate::sim) struct TrueState {
    /// Time \[s\].
    pub(in crate::sim) t_s: f64,
    /// Pose in the world frame.
    pub(in crate::sim) pose: Pose,
    /// Velocity that odometry measures: that of the wheels.
    pub(in crate::sim) odometry: Velocity,
    /// Distance driven so far \[m\].
    pub(in crate::sim) driven_m: f64,
}

impl Localisation {
    /// Returns the errors, or `None` for a robot that knows its state exactly.
    pub(in crate::sim) fn new(
        faults: LocalisationFaults,
        source: Source,
        cycle_s: f64,
    ) -> Option<Self> {
        if faults.is_none() {
            return None;
        }
        let error = |kind| CorrelatedError::new(source, kind, cycle_s, faults.correlation_s);
        Some(Self {
            x: error(Kind::X),
            y: error(Kind::Y),
            heading: error(Kind::Heading),
            v: Gaussian::new(source, Kind::ToldV),
            omega: Gaussian::new(source, Kind::ToldOmega),
            drift: Drift::new(&faults, source),
            jumps: faults.jumps().then(|| Jumps::new(&faults, source)),
            late: cycles_late(faults.delay_s, cycle_s),
            cycle_s,
            under_way: VecDeque::new(),
            faults,
        })
    }

    /// Returns the pose and velocity that are reported to the controller in the next cycle.
    pub(in crate::sim) fn told(&mut self, state: TrueState) -> (Pose, Velocity) {
        let now = (self.estimated(state), self.measured(state.odometry));
        if self.late == 0 {
            return now;
        }
        self.under_way.push_back(now);
        if self.under_way.len() > self.late + 1 {
            self.under_way.pop_front();
        }
        self.under_way.front().copied().unwrap_or(now)
    }

    /// Returns the stamp of the pose that is reported in a cycle \[s\].
    pub(in crate::sim) fn stamp_s(&self, cycle: u64) -> f64 {
        cycle.saturating_sub(self.late as u64) as f64 * self.cycle_s + self.faults.stamp_late_s
    }

    fn estimated(&mut self, state: TrueState) -> Pose {
        let TrueState { t_s, pose, driven_m, .. } = state;
        let LocalisationFaults { position_m, heading_rad, .. } = self.faults;
        let noisy = Pose::new(
            pose.x + position_m * self.x.next(),
            pose.y + position_m * self.y.next(),
            pose.theta + heading_rad * self.heading.next(),
        );
        let drifted = self.drift.after(driven_m).of(noisy);
        match &mut self.jumps {
            Some(jumps) => jumps.at(t_s).of(drifted),
            None => drifted,
        }
    }

    fn measured(&mut self, odometry: Velocity) -> Velocity {
        let LocalisationFaults { v_relative, omega_relative, .. } = self.faults;
        let (v_error, omega_error) = (self.v.next_cut(), self.omega.next_cut());
        if self.faults.velocity_is_zero {
            return Velocity::ZERO;
        }
        Velocity::new(
            odometry.v * (1.0 + v_relative * v_error),
            odometry.omega * (1.0 + omega_relative * omega_error),
        )
    }
}

/// Error of a pose in the world frame.
#[derive(Clone, Copy, Debug)]
struct Offset {
    position: Point,
    heading_rad: f64,
}

impl Offset {
    const NONE: Self = Self { position: Point::new(0.0, 0.0), heading_rad: 0.0 };

    /// Returns the pose with this error.
    fn of(self, pose: Pose) -> Pose {
        let Self { position: Point { x, y }, heading_rad } = self;
        Pose::new(pose.x + x, pose.y + y, pose.theta + heading_rad)
    }
}

/// Point at a distance \[m\] from the origin in a random direction.
fn anywhere_at(distance_m: f64, random: &mut Random) -> Point {
    let (sin, cos) = libm::sincos(TAU * random.unit());
    Point::new(cos, sin) * distance_m
}

/// Error that grows with the driven distance.
#[derive(Clone, Copy, Debug)]
struct Drift {
    per_metre: Offset,
}

impl Drift {
    fn new(faults: &LocalisationFaults, source: Source) -> Self {
        let mut random = source.stream(Kind::Drift);
        let position = anywhere_at(faults.drift, &mut random);
        let side = if random.is_chosen(0.5) { 1.0 } else { -1.0 };
        Self { per_metre: Offset { position, heading_rad: side * faults.heading_drift_radpm } }
    }

    fn after(self, driven_m: f64) -> Offset {
        let Offset { position, heading_rad } = self.per_metre;
        Offset { position: position * driven_m, heading_rad: heading_rad * driven_m }
    }
}

/// Jumps of a pose, one in each interval of `every_s`.
#[derive(Clone, Debug)]
struct Jumps {
    random: Random,
    jump_m: f64,
    jump_rad: f64,
    every_s: f64,
    for_s: f64,
    /// Index of the last drawn interval, the time at which its jump begins \[s\], and its offset.
    drawn: Option<(u64, f64, Offset)>,
}

impl Jumps {
    fn new(faults: &LocalisationFaults, source: Source) -> Self {
        let LocalisationFaults { jump_m, jump_rad, jump_every_s, jump_for_s, .. } = *faults;
        let random = source.stream(Kind::Jump);
        Self { random, jump_m, jump_rad, every_s: jump_every_s, for_s: jump_for_s, drawn: None }
    }

    /// Returns the error at a time. Times must not decrease.
    fn at(&mut self, t_s: f64) -> Offset {
        let stretch = (t_s / self.every_s) as u64;
        let mut next = self.drawn.map_or(0, |(drawn, ..)| drawn + 1);
        // Skipped intervals are drawn, too, so that a jump does not depend on the cycle.
        while next <= stretch {
            self.drawn = Some(self.draw(next));
            next += 1;
        }
        let is_always_off = self.for_s >= self.every_s;
        match self.drawn {
            Some((_, _, offset)) if is_always_off => offset,
            Some((_, from_s, offset)) if (from_s..from_s + self.for_s).contains(&t_s) => offset,
            _ => Offset::NONE,
        }
    }

    fn draw(&mut self, stretch: u64) -> (u64, f64, Offset) {
        let idle_s = self.every_s - self.for_s;
        let from_s = stretch as f64 * self.every_s + idle_s * self.random.unit();
        let distance_m = self.jump_m * self.random.unit();
        let position = anywhere_at(distance_m, &mut self.random);
        let heading_rad = self.random.between([-self.jump_rad, self.jump_rad]);
        (stretch, from_s, Offset { position, heading_rad })
    }
}

/// An error that changes slowly, with mean 0 and standard deviation 1: a stationary Gauss-Markov
/// process in discrete time.
///
/// e' = q e + sqrt(1 - q²) n, where n is normal and q is the correlation of two errors one step
/// apart. The variance stays q² + (1 - q²) = 1, and errors k steps apart have the correlation q^k.
#[derive(Clone, Debug)]
struct CorrelatedError {
    gaussian: Gaussian,
    /// Correlation of two errors one cycle apart.
    kept: f64,
    error: Option<f64>,
}

impl CorrelatedError {
    fn new(source: Source, kind: Kind, cycle_s: f64, correlation_s: f64) -> Self {
        let kept = libm::exp(-cycle_s / correlation_s);
        Self { gaussian: Gaussian::new(source, kind), kept, error: None }
    }

    /// The next error, clipped. The process itself is not clipped, so its correlation does not
    /// change.
    fn next(&mut self) -> f64 {
        let fresh = self.gaussian.next();
        let kept = self.kept;
        let error =
            self.error.map_or(fresh, |error| kept * error + (1.0 - kept * kept).sqrt() * fresh);
        self.error = Some(error);
        cut(error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: LocalisationFaults = LocalisationFaults {
        position_m: 0.0,
        heading_rad: 0.0,
        correlation_s: 0.0,
        v_relative: 0.0,
        omega_relative: 0.0,
        drift: 0.0,
        heading_drift_radpm: 0.0,
        jump_m: 0.0,
        jump_rad: 0.0,
        jump_every_s: 0.0,
        jump_for_s: 0.0,
        delay_s: 0.0,
        stamp_late_s: 0.0,
        velocity_is_zero: false,
    };

    /// State at time 0.
    fn moving(pose: Pose, odometry: Velocity) -> TrueState {
        TrueState { t_s: 0.0, pose, odometry, driven_m: 0.0 }
    }

    fn localisation(noise: LocalisationFaults, robot: usize) -> Localisation {
        Localisation::new(noise, Source { seed: 6, robot, sensor: 0 }, 0.1).unwrap()
    }

    /// The errors of x, y and heading, in units of their standard deviations.
    fn errors(noise: LocalisationFaults, robot: usize, count: usize) -> Vec<[f64; 3]> {
        let mut localisation = localisation(noise, robot);
        let LocalisationFaults { position_m, heading_rad, .. } = noise;
        let mut next = || {
            let (Pose { x, y, theta }, _) =
                localisation.told(moving(Pose::new(4.0, -2.0, 1.0), Velocity::ZERO));
            [(x - 4.0) / position_m, (y + 2.0) / position_m, (theta - 1.0) / heading_rad]
        };
        (0..count).map(|_| next()).collect()
    }

    fn mean(products: impl Iterator<Item = f64>) -> f64 {
        let (sum, count) = products.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
        sum / count
    }

    /// Checks mean, standard deviation and correlations of 100,000 errors that are drawn anew each
    /// time.
    #[test]
    fn errors_without_correlation_are_white() {
        let noise = LocalisationFaults { position_m: 0.05, heading_rad: 0.02, ..NONE };
        let all = errors(noise, 0, 100_000);
        // Four standard deviations of the mean of 100,000 errors.
        let tolerance = 4.0 / f64::sqrt(1e5);
        for part in 0..3 {
            assert!(mean(all.iter().map(|errors| errors[part])).abs() < tolerance);
            let variance = mean(all.iter().map(|errors| errors[part] * errors[part]));
            assert!((variance - 0.995).abs() < 2.0 * tolerance, "{variance}");
            assert!(all.iter().all(|errors| errors[part].abs() <= 3.0 + 1e-9));
            let next = mean(all.windows(2).map(|pair| pair[0][part] * pair[1][part]));
            assert!(next.abs() < tolerance, "{next}");
            let beside = mean(all.iter().map(|errors| errors[part] * errors[(part + 1) % 3]));
            assert!(beside.abs() < tolerance, "{beside}");
        }
    }

    /// Uses many robots, so that all means are of independent draws. From the first time on, the
    /// errors keep their standard deviation, and their correlation decays as defined.
    #[test]
    fn errors_drift_with_their_correlation_time() {
        const ROBOTS: usize = 20_000;
        let noise =
            LocalisationFaults { position_m: 0.05, heading_rad: 0.02, correlation_s: 0.5, ..NONE };
        let drifts: Vec<Vec<[f64; 3]>> =
            (0..ROBOTS).map(|robot| errors(noise, robot, 21)).collect();
        let tolerance = 4.0 / f64::sqrt(ROBOTS as f64);
        for part in 0..3 {
            for cycle in [0, 1, 5, 20] {
                let at = |drift: &Vec<[f64; 3]>| drift[cycle][part];
                let error = mean(drifts.iter().map(at));
                assert!(error.abs() < tolerance, "{cycle}: {error}");
                let variance = mean(drifts.iter().map(|drift| at(drift) * at(drift)));
                assert!((variance - 0.995).abs() < 1.5 * tolerance, "{cycle}: {variance}");
                let product = mean(drifts.iter().map(|drift| drift[0][part] * at(drift)));
                let expected = 0.995 * libm::exp(-0.1 * cycle as f64 / 0.5);
                assert!((product - expected).abs() < 1.5 * tolerance, "{cycle}: {product}");
            }
        }
    }

    #[test]
    fn velocities_are_off_by_a_share_of_themselves() {
        let mut localisation =
            localisation(LocalisationFaults { v_relative: 0.1, omega_relative: 0.2, ..NONE }, 0);
        let pose = Pose::new(4.0, -2.0, 1.0);
        let mut sums = [0.0; 4];
        for _ in 0..100_000 {
            let (told_pose, told) = localisation.told(moving(pose, Velocity::new(0.5, -2.0)));
            assert_eq!(told_pose, pose);
            let (v, omega) = (told.v / 0.5 - 1.0, told.omega / -2.0 - 1.0);
            assert!(v.abs() <= 0.3 + 1e-9 && omega.abs() <= 0.6 + 1e-9);
            for (sum, term) in sums.iter_mut().zip([v, v * v, omega * omega, v * omega]) {
                *sum += term / 1e5;
            }
        }
        // Four standard deviations of each mean.
        let [v, v_squared, omega_squared, product] = sums;
        assert!(v.abs() < 4.0 * 0.1 / f64::sqrt(1e5), "{v}");
        assert!((v_squared / 0.01 - 0.995).abs() < 4.0 * f64::sqrt(2e-5), "{v_squared}");
        assert!((omega_squared / 0.04 - 0.995).abs() < 4.0 * f64::sqrt(2e-5), "{omega_squared}");
        assert!(product.abs() < 4.0 * 0.02 / f64::sqrt(1e5), "{product}");
        // The reported velocity of a stationary robot is 0.
        assert_eq!(localisation.told(moving(pose, Velocity::ZERO)), (pose, Velocity::ZERO));
    }

    /// Errors of the pose at some times and distances: x, y, heading.
    fn pose_errors(
        faults: LocalisationFaults,
        robot: usize,
        states: impl Iterator<Item = (f64, f64)>,
    ) -> Vec<[f64; 3]> {
        let mut localisation = localisation(faults, robot);
        let pose = Pose::new(4.0, -2.0, 1.0);
        let told = |(t_s, driven_m)| {
            let state = TrueState { t_s, pose, odometry: Velocity::ZERO, driven_m };
            let (Pose { x, y, theta }, _) = localisation.told(state);
            [x - 4.0, y + 2.0, theta - 1.0]
        };
        states.map(told).collect()
    }

    #[test]
    fn drift_grows_with_the_way_in_a_direction_of_its_own() {
        let faults = LocalisationFaults { drift: 0.02, heading_drift_radpm: 0.01, ..NONE };
        let errors_of =
            |robot| pose_errors(faults, robot, (0..=100).map(|step| (0.0, 0.5 * f64::from(step))));
        let mut sides = [0; 2];
        for robot in 0..200 {
            let errors = errors_of(robot);
            let [x, y, heading] = errors[100];
            assert!((x.hypot(y) - 1.0).abs() < 1e-9 && (heading.abs() - 0.5).abs() < 1e-9);
            sides[usize::from(heading > 0.0)] += 1;
            for (step, error) in errors.iter().enumerate() {
                let expected = [x, y, heading].map(|it| it * step as f64 / 100.0);
                assert!(error.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9));
            }
        }
        // Expected are 100 with a standard deviation of 7.
        assert!(sides[0] > 70 && sides[1] > 70, "{sides:?}");
        assert_ne!(errors_of(0), errors_of(1));
    }

    #[test]
    fn the_pose_jumps_once_in_each_stretch_and_back() {
        let faults = LocalisationFaults {
            jump_m: 0.3,
            jump_rad: 0.2,
            jump_every_s: 20.0,
            jump_for_s: 5.0,
            ..NONE
        };
        // 500 intervals of 200 cycles.
        let errors =
            pose_errors(faults, 0, (0..100_000).map(|cycle| (f64::from(cycle) / 10.0, 0.0)));
        let (mut largest_m, mut largest_rad, mut distinct) = (0.0_f64, 0.0_f64, 0);
        for stretch in errors.chunks(200) {
            let is_off = |error: &&[f64; 3]| error.iter().any(|part| part.abs() > 1e-9);
            let off: Vec<_> = stretch.iter().filter(is_off).collect();
            // A jump of 5 s takes 50 cycles, give or take one.
            assert!((49..=51).contains(&off.len()), "{}", off.len());
            let first = stretch.iter().position(|error| is_off(&error)).unwrap();
            assert!(
                stretch[first..first + off.len()].iter().all(|error| error == off[0]),
                "in one"
            );
            let [x, y, heading] = *off[0];
            largest_m = largest_m.max(x.hypot(y));
            largest_rad = largest_rad.max(heading.abs());
            distinct += usize::from(x.hypot(y) > 0.15);
        }
        assert!((0.29..=0.3).contains(&largest_m) && (0.19..=0.2).contains(&largest_rad));
        // Any distance is equally likely: expected are 250 with a standard deviation of 11.
        assert!((205..=295).contains(&distinct), "{distinct}");
        // A jump does not depend on the cycle.
        let rarely = pose_errors(faults, 0, (0..50_000).map(|cycle| (f64::from(cycle) / 5.0, 0.0)));
        assert!(rarely.iter().zip(errors.iter().step_by(2)).all(|(a, b)| a == b));
        let always = LocalisationFaults { jump_for_s: 20.0, ..faults };
        let errors = pose_errors(always, 0, (0..1000).map(|cycle| (f64::from(cycle) / 10.0, 0.0)));
        assert!(errors.iter().all(|error| *error != [0.0; 3]));
    }

    #[test]
    fn a_late_pose_is_an_earlier_one() {
        // The delay is two cycles: it is rounded up.
        let faults = LocalisationFaults { delay_s: 0.15, ..NONE };
        let mut localisation = localisation(faults, 0);
        let told: Vec<_> = (0..6)
            .map(|cycle| {
                let x = f64::from(cycle);
                localisation.told(moving(Pose::new(x, 0.0, 0.0), Velocity::new(x, -x)))
            })
            .map(|(pose, velocity)| (pose.x, velocity.v, velocity.omega))
            .collect();
        let at = |x: f64| (x, x, -x);
        assert_eq!(told, [0.0, 0.0, 0.0, 1.0, 2.0, 3.0].map(at));
    }

    #[test]
    fn odometry_may_always_say_zero() {
        let mut localisation =
            localisation(LocalisationFaults { velocity_is_zero: true, ..NONE }, 0);
        let pose = Pose::new(4.0, -2.0, 1.0);
        let told = localisation.told(moving(pose, Velocity::new(0.5, 1.0)));
        assert_eq!(told, (pose, Velocity::ZERO));
    }
}
