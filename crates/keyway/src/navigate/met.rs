//! The moving obstacle that the robot has met on its route.

use super::walked_ground::is_across;
use crate::geometry::{Disc, Segment, Shift};
use crate::sense::Mover;
use serde::{Deserialize, Serialize};

/// The last obstacle that moved across the robot's route. Once stationary, it is sensed as an
/// ordinary obstacle.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Met {
    disc: Option<Disc>,
    /// Time since it was seen to move \[s\].
    age_s: f64,
    /// Time since the last search for a route around it \[s\].
    unlooked_s: f64,
}

impl Met {
    /// Time between two searches for a route around it \[s\].
    const LOOK_S: f64 = 0.5;

    /// Time without motion after which it is forgotten \[s\].
    const FORGET_S: f64 = 30.0;

    /// Largest distance from its last position at which it is recognised again \[m\].
    const SAME_M: f64 = 1.0;

    /// Takes in the moving obstacles: the one that was met before, or else the first one that is
    /// closer than `needed_m` to a route.
    pub(super) fn note(
        &mut self,
        movers: &[Mover],
        way: &(impl Iterator<Item = Segment> + Clone),
        needed_m: f64,
        elapsed_s: f64,
    ) {
        self.age_s += elapsed_s;
        self.unlooked_s += elapsed_s;
        let is_seen = |mover: &&Mover| mover.unseen_s == 0.0 && mover.is_usable();
        let seen = || movers.iter().filter(is_seen);
        let same = self.disc.and_then(|disc| {
            let near = seen().filter(|mover| mover.centre.distance(disc.centre) <= Self::SAME_M);
            near.min_by(|a, b| {
                let away_m = |mover: &Mover| mover.centre.distance(disc.centre);
                away_m(a).total_cmp(&away_m(b))
            })
        });
        let across = || {
            seen().find(|mover| is_across(&Disc::new(mover.centre, mover.radius_m), way, needed_m))
        };
        if let Some(mover) = same.or_else(across) {
            (self.disc, self.age_s) = (Some(Disc::new(mover.centre, mover.radius_m)), 0.0);
        } else if self.age_s > Self::FORGET_S {
            self.disc = None;
        }
    }

    /// The obstacle that was met, if there is one.
    pub(super) const fn disc(&self) -> Option<Disc> {
        self.disc
    }

    /// True if a search for a route around it is due.
    pub(super) fn look(&mut self) -> bool {
        let is_time = self.unlooked_s >= Self::LOOK_S;
        if is_time {
            self.unlooked_s = 0.0;
        }
        is_time
    }

    /// Moves it along with a correction of the robot's pose.
    pub(super) fn shift(&mut self, shift: &Shift) {
        if let Some(disc) = &mut self.disc {
            disc.centre = shift.point(disc.centre);
        }
    }

    pub(super) const fn forget(&mut self) {
        self.disc = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, Pose};
    use std::f64::consts::FRAC_PI_2;

    fn way() -> impl Iterator<Item = Segment> + Clone {
        std::iter::once(Segment::new(Point::new(0.0, 0.0), Point::new(5.0, 0.0)))
    }

    fn mover(id: u64, x: f64, y: f64) -> Mover {
        Mover::standing(id, Point::new(x, y), 0.2)
    }

    #[test]
    fn it_is_who_moves_across_the_way_until_that_is_long_ago() {
        let mut met = Met::default();
        let mut note = |movers: &[Mover], elapsed_s| {
            met.note(movers, &way(), 0.3, elapsed_s);
            met.disc().map(|disc| disc.centre.x)
        };
        assert_eq!(note(&[mover(1, 3.0, 0.6)], 0.1), None, "beside the way");
        assert_eq!(note(&[mover(1, 3.0, 0.6), mover(2, 4.0, 0.4)], 0.1), Some(4.0));
        assert_eq!(note(&[mover(3, 1.0, 0.0), mover(4, 4.5, 0.8)], 0.1), Some(4.5), "the same one");
        let only_expected = Mover { unseen_s: 0.1, ..mover(4, 4.9, 0.8) };
        assert_eq!(note(&[only_expected], 0.1), Some(4.5));
        assert_eq!(note(&[], 29.0), Some(4.5));
        assert_eq!(note(&[], 2.0), None);
    }

    #[test]
    fn it_goes_with_a_robot_whose_place_is_corrected() {
        let mut met = Met::default();
        met.note(&[mover(1, 3.0, 0.0)], &way(), 0.3, 0.1);
        met.shift(&Shift::new(Pose::new(1.0, 0.0, 0.0), Pose::new(1.0, 1.0, FRAC_PI_2)));
        assert!(met.disc().unwrap().centre.distance(Point::new(1.0, 3.0)) < 1e-12);
    }

    #[test]
    fn a_way_past_is_looked_for_twice_a_second() {
        let mut met = Met::default();
        let looks = (0..10).filter(|_| {
            met.note(&[], &way(), 0.3, 0.25);
            met.look()
        });
        assert_eq!(looks.count(), 5);
    }
}
