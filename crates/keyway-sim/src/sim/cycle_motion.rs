//! The motion of one control cycle.

use keyway::geometry::{Pose, Velocity};
use keyway::robot::Footprint;

/// Number of exact arcs in the motion of a cycle.
const ARCS: usize = Pose::RAMP_ARCS as usize;

/// Motion of one cycle as the arcs of [`Pose::after_ramp`]. The velocity changes linearly, or
/// linearly before and after one instant. A place on the motion is measured in arcs, from 0 to
/// [`Self::END`], so equal places are the same instant for all robots.
#[derive(Clone, Debug)]
pub(super) struct CycleMotion {
    from: Velocity,
    knee: Option<Knee>,
    to: Velocity,
    duration_s: f64,
    arcs: [Arc; ARCS],
    stop: f64,
}

/// Instant at which the acceleration changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knee {
    /// Place after the beginning of the cycle and before its end.
    pub(super) place: f64,
    /// The velocity there.
    pub(super) velocity: Velocity,
}

/// One of the arcs.
#[derive(Clone, Copy, Debug)]
struct Arc {
    start: Pose,
    velocity: Velocity,
    /// Distance driven before it \[m\].
    driven_m: f64,
    /// Angle turned before it, summed over both directions \[rad\].
    turned_rad: f64,
}

impl CycleMotion {
    /// The place at the end of the cycle.
    pub(super) const END: f64 = ARCS as f64;

    pub(super) fn new(start: Pose, from: Velocity, to: Velocity, duration_s: f64) -> Self {
        Self::with_arcs(start, from, None, to, duration_s)
    }

    /// A motion whose velocity changes linearly up to the knee and linearly after it.
    pub(super) fn with_knee(
        start: Pose,
        from: Velocity,
        knee: Knee,
        to: Velocity,
        duration_s: f64,
    ) -> Self {
        Self::with_arcs(start, from, Some(knee), to, duration_s)
    }

    fn with_arcs(
        start: Pose,
        from: Velocity,
        knee: Option<Knee>,
        to: Velocity,
        duration_s: f64,
    ) -> Self {
        let arc_s = duration_s / Self::END;
        let (mut pose, mut driven_m, mut turned_rad) = (start, 0.0, 0.0);
        let arcs = std::array::from_fn(|i| {
            let velocity = match knee {
                None => from.lerp(to, (i as f64 + 0.5) / Self::END),
                Some(knee) => knee.mean_velocity(from, to, i as f64),
            };
            let arc = Arc { start: pose, velocity, driven_m, turned_rad };
            pose = pose.after_arc(velocity, arc_s);
            driven_m += velocity.v.abs() * arc_s;
            turned_rad += velocity.omega.abs() * arc_s;
            arc
        });
        Self { from, knee, to, duration_s, arcs, stop: Self::END }
    }

    /// Returns the motion of a robot that is stationary at a pose for the whole cycle.
    pub(super) fn standing(pose: Pose, duration_s: f64) -> Self {
        Self::new(pose, Velocity::ZERO, Velocity::ZERO, duration_s)
    }

    /// Stops the robot at a place, for the rest of the cycle.
    pub(super) fn stop_at(&mut self, place: f64) {
        self.stop = place;
    }

    /// The last place at which the robot moves: [`Self::END`] unless it was stopped.
    pub(super) const fn stop(&self) -> f64 {
        self.stop
    }

    pub(super) fn pose(&self, place: f64) -> Pose {
        let (arc, since_s) = self.arc(place);
        arc.start.after_arc(arc.velocity, since_s)
    }

    /// Velocity at a place that is not after [`Self::stop`].
    pub(super) fn velocity(&self, place: f64) -> Velocity {
        match self.knee {
            None => self.from.lerp(self.to, place / Self::END),
            Some(knee) => knee.velocity_at(self.from, self.to, place),
        }
    }

    /// True if the covered area does not change on the arc of a place: the robot is stationary,
    /// or is a disc that turns on the spot.
    pub(super) fn keeps_ground_at(&self, place: f64, footprint: &Footprint) -> bool {
        let (Arc { velocity: Velocity { v, omega, .. }, .. }, _) = self.arc(place);
        let is_zero = |rate: &f64| rate.abs() <= Self::ROUNDING;
        is_zero(v) && (is_zero(omega) || matches!(footprint, Footprint::Circle(_)))
    }

    /// Largest velocity that rounding leaves after braking to a stop \[m/s, rad/s\]: at most a
    /// tenth of a micrometre per second.
    const ROUNDING: f64 = 1e-7;

    /// Distance driven up to a place \[m\].
    pub(super) fn driven_m(&self, place: f64) -> f64 {
        let (arc, since_s) = self.arc(place);
        arc.driven_m + arc.velocity.v.abs() * since_s
    }

    /// Angle turned up to a place, summed over both directions \[rad\].
    pub(super) fn turned_rad(&self, place: f64) -> f64 {
        let (arc, since_s) = self.arc(place);
        arc.turned_rad + arc.velocity.omega.abs() * since_s
    }

    /// Time from the beginning to a place \[s\].
    pub(super) fn elapsed_s(&self, place: f64) -> f64 {
        place * (self.duration_s / Self::END)
    }

    /// The place at a time after the beginning \[s\].
    pub(super) fn place(&self, elapsed_s: f64) -> f64 {
        (elapsed_s / self.duration_s * Self::END).clamp(0.0, Self::END)
    }

    /// Duration of the cycle \[s\].
    pub(super) const fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Arc of a place, and the time since its beginning \[s\].
    fn arc(&self, place: f64) -> (&Arc, f64) {
        let place = place.min(self.stop);
        let i = (place as usize).min(ARCS - 1);
        (&self.arcs[i], (place - i as f64) * (self.duration_s / Self::END))
    }
}

impl Knee {
    /// Velocity at a place of a motion with this knee.
    fn velocity_at(&self, from: Velocity, to: Velocity, place: f64) -> Velocity {
        if place <= self.place {
            return from.lerp(self.velocity, place / self.place);
        }
        self.velocity.lerp(to, (place - self.place) / (CycleMotion::END - self.place))
    }

    /// Mean velocity on the arc that begins at a place.
    fn mean_velocity(&self, from: Velocity, to: Velocity, start: f64) -> Velocity {
        let after = start + 1.0 - self.place;
        let middle = |a: f64, b: f64| self.velocity_at(from, to, 0.5 * (a + b));
        if after <= 0.0 || after >= 1.0 {
            return middle(start, start + 1.0);
        }
        middle(start, self.place).lerp(middle(self.place, start + 1.0), after)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_where_the_ramp_ends() {
        let (from, to) = (Velocity::new(0.5, -0.3), Velocity::new(0.4, 0.2));
        let start = Pose::new(1.0, 2.0, 0.7);
        let motion = CycleMotion::new(start, from, to, 0.1);
        assert_eq!(motion.pose(CycleMotion::END), start.after_ramp(from, to, 0.1));
        assert_eq!(motion.pose(0.0), start);
        assert_eq!((motion.velocity(0.0), motion.velocity(CycleMotion::END)), (from, to));
        assert!((motion.driven_m(CycleMotion::END) - 0.045).abs() < 1e-15);
        // 0.05 s at a mean of 0.475 m/s.
        assert!((motion.driven_m(2.0) - 0.02375).abs() < 1e-15);
    }

    #[test]
    fn stands_where_it_was_stopped() {
        let start = Pose::new(1.0, 2.0, 0.7);
        let (from, to) = (Velocity::new(0.5, -0.3), Velocity::new(0.4, 0.2));
        let whole = CycleMotion::new(start, from, to, 0.1);
        let mut stopped = whole.clone();
        stopped.stop_at(2.5);
        for place in [0.0, 1.25, 2.5, 2.75, CycleMotion::END] {
            assert_eq!(stopped.pose(place), whole.pose(place.min(2.5)));
            assert_eq!(stopped.driven_m(place), whole.driven_m(place.min(2.5)));
            assert_eq!(stopped.turned_rad(place), whole.turned_rad(place.min(2.5)));
            assert_eq!(stopped.elapsed_s(place), whole.elapsed_s(place));
        }
        let standing = CycleMotion::standing(start, 0.1);
        assert_eq!((standing.pose(3.3), standing.driven_m(4.0)), (start, 0.0));
    }

    #[test]
    fn discs_turn_without_covering_other_ground() {
        let disc = Footprint::circle(0.2).unwrap();
        let rectangle = Footprint::rectangle(0.4, 0.4).unwrap();
        let v = |v| Velocity::new(v, 0.0);
        let motion = |from, to| CycleMotion::new(Pose::default(), from, to, 0.1);
        let turn = motion(Velocity::new(0.0, 0.5), Velocity::new(0.0, 0.7));
        assert!(turn.keeps_ground_at(1.5, &disc) && !turn.keeps_ground_at(1.5, &rectangle));
        // The speed left after braking by 0.05 m/s in each of ten cycles.
        let braked_mps = (0..10).fold(0.5 + 2.5e-8, |v, _| v - 0.05);
        assert!(braked_mps > 2e-8);
        let braked = motion(v(braked_mps), Velocity::new(braked_mps, 0.1));
        assert!(braked.keeps_ground_at(1.5, &disc) && !braked.keeps_ground_at(1.5, &rectangle));
        // Starts to drive; comes to a stop; reverses half-way through the cycle.
        for (from, to) in [(v(0.0), v(0.1)), (v(0.1), v(0.0)), (v(0.1), v(-0.1))] {
            for place in [0.0, 2.0, CycleMotion::END] {
                assert!(!motion(from, to).keeps_ground_at(place, &disc), "{from:?} {to:?} {place}");
            }
        }
        // Stationary in the second half of the cycle.
        let knee = Knee { place: 2.0, velocity: Velocity::ZERO };
        let brakes = CycleMotion::with_knee(Pose::default(), v(0.1), knee, v(0.0), 0.1);
        let keeps =
            [0.0, 1.9, 2.0, CycleMotion::END].map(|at| brakes.keeps_ground_at(at, &rectangle));
        assert_eq!(keeps, [false, false, true, true]);
    }

    /// Compares a turning motion that speeds up to the knee and brakes after it with sums over many
    /// short arcs.
    #[test]
    fn a_knee_is_followed() {
        let start = Pose::new(1.0, 2.0, 0.7);
        let (from, to) = (Velocity::new(0.2, -0.5), Velocity::new(0.1, 1.0));
        for place in [0.1, 1.0, 1.7, 3.0, 3.9] {
            let knee = Knee { place, velocity: Velocity::new(0.6, -0.3) };
            let motion = CycleMotion::with_knee(start, from, knee, to, 0.1);
            let velocity = |place| motion.velocity(place);
            assert_eq!((velocity(0.0), velocity(place)), (from, knee.velocity));
            assert_eq!(velocity(0.5 * place), from.lerp(knee.velocity, 0.5));
            let after = velocity(0.5 * (place + CycleMotion::END));
            let expected = knee.velocity.lerp(to, 0.5);
            assert!((after.v - expected.v).abs() < 1e-12);
            assert!((after.omega - expected.omega).abs() < 1e-12);
            let end = velocity(CycleMotion::END);
            assert!((end.v - to.v).abs() < 1e-15 && (end.omega - to.omega).abs() < 1e-15);
            // Distance driven while the speed changes linearly before and after the knee.
            let (before_s, after_s) = (0.025 * place, 0.1 - 0.025 * place);
            let length_m = 0.5 * ((0.2 + 0.6) * before_s + (0.6 + 0.1) * after_s);
            assert!((motion.driven_m(CycleMotion::END) - length_m).abs() < 1e-12);
            let (mut pose, steps) = (start, 20_000);
            for step in 0..steps {
                let place = (f64::from(step) + 0.5) * CycleMotion::END / f64::from(steps);
                pose = pose.after_arc(velocity(place), 0.1 / f64::from(steps));
            }
            let end = motion.pose(CycleMotion::END);
            assert!((end.theta - pose.theta).abs() < 1e-6, "{place}");
            // The angular acceleration is 15 rad/s² and more, which no robot has.
            assert!(end.point().distance(pose.point()) < 1e-4, "{place}: {end:?} {pose:?}");
        }
    }
}
