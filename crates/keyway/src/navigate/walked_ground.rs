//! Areas in which moving obstacles walk, and the time for which the robot has been held up beside
//! them.
//!
//! A pedestrian that walks back and forth in a gap may block it indefinitely although a detour
//! exists, and the waiting time is unknown. The robot therefore takes the detour once it takes no
//! longer than the robot has been held up already, as in the ski-rental problem, where one rents
//! until the rent has cost as much as buying (\[Karlin1988\]). It then loses at most twice as
//! much as with the waiting time known beforehand, apart from the time between two checks.

use crate::geometry::{Disc, Point, Segment, Shift};
use crate::robot::Robot;
use crate::sense::Mover;
use serde::{Deserialize, Serialize};

/// Recent positions of moving obstacles, and the areas that the robot avoids.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct WalkedGround {
    steps: Vec<Step>,
    /// Discs of the avoided steps.
    avoided: Vec<Disc>,
}

/// A position at which a moving obstacle was seen.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Step {
    disc: Disc,
    /// Time since a moving obstacle was last seen here \[s\].
    age_s: f64,
    /// True if the obstacle had left, and came back.
    is_walked_again: bool,
    is_avoided: bool,
}

impl WalkedGround {
    /// Time without a return after which a position is forgotten \[s\].
    const FORGET_S: f64 = 20.0;

    /// Time of absence after which a new sighting counts as a return \[s\].
    const AWAY_S: f64 = 1.0;

    /// Maximum number of steps; beyond it, the oldest ones are dropped.
    const MOST: usize = 128;

    /// Takes in the moving obstacles that are seen.
    pub(super) fn note(&mut self, movers: &[Mover], elapsed_s: f64) {
        self.steps.iter_mut().for_each(|step| step.age_s += elapsed_s);
        self.steps.retain(|step| step.age_s <= Self::FORGET_S);
        let seen = movers.iter().filter(|mover| mover.unseen_s == 0.0 && mover.is_usable());
        seen.for_each(|mover| self.note_step(mover));
        self.list_avoided();
    }

    /// Moves the steps along with a correction of the robot's pose.
    pub(super) fn shift(&mut self, shift: &Shift) {
        let steps = self.steps.iter_mut();
        steps.for_each(|step| step.disc.centre = shift.point(step.disc.centre));
        self.list_avoided();
    }

    fn note_step(&mut self, mover: &Mover) {
        let disc = Disc { centre: mover.centre, radius_m: mover.radius_m };
        let is_same = |step: &&mut Step| {
            step.disc.centre.distance(disc.centre) <= 0.5 * step.disc.radius_m.min(disc.radius_m)
        };
        if let Some(step) = self.steps.iter_mut().find(is_same) {
            step.is_walked_again |= step.age_s > Self::AWAY_S;
            step.age_s = 0.0;
            return;
        }
        if self.steps.len() >= Self::MOST {
            let ages = self.steps.iter().map(|step| step.age_s).enumerate();
            let oldest = ages.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index);
            self.steps.swap_remove(oldest);
        }
        self.steps.push(Step { disc, age_s: 0.0, is_walked_again: false, is_avoided: false });
    }

    /// The area to avoid: discs closer than `needed_m` to one of the segments on which moving
    /// obstacles walk repeatedly, those that are avoided already, and all discs at most twice
    /// that distance from these, since the robot does not fit between them. An obstacle that has
    /// crossed the route only once has left it free.
    pub(super) fn across(
        &self,
        way: &(impl Iterator<Item = Segment> + Clone),
        needed_m: f64,
    ) -> Vec<Disc> {
        let is_across = |step: &Step| {
            step.is_avoided || step.is_walked_again && self::is_across(&step.disc, way, needed_m)
        };
        let (across, mut others): (Vec<Step>, Vec<Step>) =
            self.steps.iter().partition(|&step| is_across(step));
        let mut joined: Vec<Disc> = across.into_iter().map(|step| step.disc).collect();
        let mut next = 0;
        while let Some(&disc) = joined.get(next) {
            joined.extend(
                others
                    .extract_if(.., |step| step.joins(&disc, 2.0 * needed_m))
                    .map(|step| step.disc),
            );
            next += 1;
        }
        joined
    }

    /// Sets the avoided area, in place of the last one.
    pub(super) fn avoid(&mut self, ground: &[Disc]) {
        self.steps.iter_mut().for_each(|step| step.is_avoided = ground.contains(&step.disc));
        self.list_avoided();
    }

    /// The avoided area.
    pub(super) fn avoided(&self) -> &[Disc] {
        &self.avoided
    }

    fn list_avoided(&mut self) {
        self.avoided.clear();
        self.avoided.extend(self.steps.iter().filter(|step| step.is_avoided).map(|step| step.disc));
    }
}

/// True if a disc comes closer than `needed_m` to a route.
pub(super) fn is_across(
    disc: &Disc,
    way: &(impl Iterator<Item = Segment> + Clone),
    needed_m: f64,
) -> bool {
    let reach_m = disc.radius_m + needed_m;
    way.clone().any(|leg| leg.distance_sq_to_point(disc.centre) <= reach_m * reach_m)
}

impl Step {
    fn joins(&self, disc: &Disc, gap_m: f64) -> bool {
        self.disc.centre.distance(disc.centre) <= self.disc.radius_m + disc.radius_m + gap_m
    }
}

/// Time for which a robot has stayed near a position.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Hold {
    at: Option<Point>,
    held_s: f64,
    /// Time since the last search for a detour \[s\].
    unlooked_s: f64,
}

impl Hold {
    /// Time between two searches for a detour \[s\].
    const LOOK_S: f64 = 0.5;

    /// A robot is held up while it gets no farther than its own diameter, or than it drives at
    /// full speed in this time \[s\].
    const AWAY_S: f64 = 0.5;

    /// Updates the position of the robot, after this time since the last update \[s\].
    pub(super) fn note(&mut self, position: Point, robot: &Robot, elapsed_s: f64) {
        let away_m = Self::AWAY_S * robot.limits.v_max_mps;
        let away_m = away_m.max(2.0 * robot.footprint.circumscribed_radius_m());
        if self.at.is_none_or(|at| at.distance(position) >= away_m) {
            *self = Self { at: Some(position), held_s: 0.0, unlooked_s: 0.0 };
        }
        self.held_s += elapsed_s;
        self.unlooked_s += elapsed_s;
    }

    /// Time for which the robot has been held up \[s\].
    pub(super) const fn held_s(&self) -> f64 {
        self.held_s
    }

    /// Time for which the robot has been held up, if a search for a detour is due \[s\].
    pub(super) fn look(&mut self) -> Option<f64> {
        // A sum of cycles reaches that time despite rounding.
        const ROUNDING_S: f64 = 1e-9;
        let is_time = self.unlooked_s >= Self::LOOK_S - ROUNDING_S;
        is_time.then(|| {
            self.unlooked_s = 0.0;
            self.held_s
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mover(x: f64, y: f64) -> Mover {
        Mover::standing(7, Point::new(x, y), 0.3)
    }

    fn walk(ground: &mut WalkedGround, from: (f64, f64), to: (f64, f64)) {
        for step in 0..=20 {
            let part = f64::from(step) / 20.0;
            let at =
                Point::from(<[f64; 2]>::from(from)).lerp(Point::from(<[f64; 2]>::from(to)), part);
            ground.note(&[mover(at.x, at.y)], 0.1);
        }
    }

    fn way(from: [f64; 2], to: [f64; 2]) -> impl Iterator<Item = Segment> + Clone {
        std::iter::once(Segment::new(from.into(), to.into()))
    }

    #[test]
    fn a_lane_is_avoided_as_a_whole_and_another_one_is_not() {
        let mut ground = WalkedGround::default();
        let crossing = || way([3.0, 1.0], [6.0, 1.0]);
        walk(&mut ground, (5.0, 0.0), (5.0, 3.0));
        assert_eq!(ground.across(&crossing(), 0.2), [], "it has gone by");
        walk(&mut ground, (5.0, 3.0), (5.0, 0.0));
        for (from, to) in [(0.0, 3.0), (3.0, 0.0)] {
            walk(&mut ground, (8.0, from), (8.0, to));
        }
        let across = ground.across(&crossing(), 0.2);
        assert!(across.len() >= 10 && across.iter().all(|disc| disc.centre.x == 5.0));
        let farthest_m = across.iter().map(|disc| disc.centre.y).fold(0.0, f64::max);
        assert!(farthest_m > 2.8, "{farthest_m}");
        assert_eq!(ground.across(&way([3.0, -1.0], [9.0, -1.0]), 0.2), []);
        ground.avoid(&across);
        assert_eq!(ground.avoided().len(), across.len());
        assert_eq!(ground.across(&way([0.0, 9.0], [1.0, 9.0]), 0.2).len(), across.len());
        ground.avoid(&[]);
        assert_eq!(ground.avoided(), []);
    }

    #[test]
    fn what_nobody_walks_on_any_more_is_forgotten() {
        let mut ground = WalkedGround::default();
        walk(&mut ground, (5.0, 0.0), (5.0, 3.0));
        walk(&mut ground, (5.0, 3.0), (5.0, 0.0));
        let all = ground.across(&way([5.0, 0.0], [5.0, 3.0]), 0.2);
        ground.avoid(&all);
        ground.note(&[], 19.0);
        assert!(ground.avoided().iter().all(|disc| disc.centre.y < 2.5), "it was there longer ago");
        assert!(!ground.avoided().is_empty());
        ground.note(&[], 2.0);
        assert_eq!((ground.avoided().len(), ground.steps.len()), (0, 0));
        let unseen = Mover { unseen_s: 0.1, ..mover(1.0, 1.0) };
        ground.note(&[unseen], 0.1);
        assert_eq!(ground.steps.len(), 0, "only expected there");
    }

    #[test]
    fn of_too_many_steps_the_oldest_are_forgotten() {
        let mut ground = WalkedGround::default();
        for x in 0..200 {
            ground.note(&[mover(f64::from(x), 0.0)], 0.01);
        }
        assert_eq!(ground.steps.len(), WalkedGround::MOST);
        assert!(ground.steps.iter().all(|step| step.disc.centre.x >= 72.0));
    }

    #[test]
    fn a_thin_walker_leaves_no_gaps() {
        let mut ground = WalkedGround::default();
        for x in [0, 1, 2, 3, 2, 1, 0] {
            let thin = Mover { radius_m: 0.05, ..mover(0.0, 0.5 * f64::from(x)) };
            ground.note(&[thin], 0.6);
        }
        let crossing = || way([-1.0, 0.5], [1.0, 0.5]);
        assert_eq!(ground.across(&crossing(), 0.2).len(), 4, "0.4 m between them");
        assert_eq!(ground.across(&crossing(), 0.15).len(), 1, "0.4 m, where 0.3 m are enough");
    }

    #[test]
    fn a_robot_that_stays_near_a_place_is_held_up() {
        let (mut hold, robot) = (Hold::default(), Robot::small());
        let mut held = Vec::new();
        for cycle in 1..=12 {
            // Back and forth by 10 cm.
            hold.note(Point::new(0.1 * f64::from(cycle % 2), 0.0), &robot, 0.1);
            held.extend(hold.look().map(|held_s| (cycle, held_s)));
        }
        assert_eq!(held.iter().map(|held| held.0).collect::<Vec<_>>(), [5, 10]);
        assert!((held[1].1 - 1.0).abs() < 1e-9, "{held:?}");
        for cycle in 1..5 {
            hold.note(Point::new(0.5, 0.0), &robot, 0.1);
            assert_eq!(hold.look(), None, "{cycle}: it got away");
        }
        hold.note(Point::new(0.5, 0.0), &robot, 0.1);
        assert!((hold.look().unwrap() - 0.5).abs() < 1e-9);
    }
}
