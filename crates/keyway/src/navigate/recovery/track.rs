//! The track that the robot has driven.

use crate::geometry::{Point, Shift};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// The last positions on the robot's track, newest last.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::navigate) struct DrivenTrack {
    places: VecDeque<Point>,
    spacing_m: f64,
}

impl DrivenTrack {
    /// Maximum number of positions.
    const MOST: usize = 64;

    pub(in crate::navigate) fn new(spacing_m: f64) -> Self {
        Self { places: VecDeque::with_capacity(Self::MOST), spacing_m }
    }

    /// Records the position of the robot once it is far enough from the last one. Allocates
    /// nothing.
    pub(in crate::navigate) fn note(&mut self, position: Point) {
        let is_far = |last: &Point| last.distance(position) >= self.spacing_m;
        if self.places.back().is_none_or(is_far) {
            if self.places.len() >= Self::MOST {
                self.places.pop_front();
            }
            self.places.push_back(position);
        }
    }

    /// Moves them along with a correction of the robot's pose.
    pub(in crate::navigate) fn shift(&mut self, shift: &Shift) {
        self.places.iter_mut().for_each(|place| *place = shift.point(*place));
    }

    /// The positions up to `length_m` back along the track from a position, the farthest first.
    pub(in crate::navigate) fn back(
        &self,
        position: Point,
        length_m: f64,
    ) -> impl Iterator<Item = Point> + '_ {
        let (mut last, mut driven_m) = (position, 0.0);
        let count = self.places.iter().rev().take_while(move |&&place| {
            driven_m += place.distance(last);
            last = place;
            driven_m <= length_m
        });
        let first = self.places.len() - count.count();
        self.places.range(first..).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_track_leads_back_the_way_it_came() {
        let mut track = DrivenTrack::new(0.125);
        for i in 0..=640 {
            track.note(Point::new(f64::from(i) / 64.0, 0.0));
        }
        let here = Point::new(10.0, 0.0);
        let back: Vec<f64> = track.back(here, 0.4).map(|place| place.x).collect();
        assert_eq!(back, [9.625, 9.75, 9.875, 10.0]);
        assert_eq!(track.back(here, 1e9).count(), DrivenTrack::MOST);
        assert_eq!(DrivenTrack::new(0.125).back(here, 1.0).count(), 0);
        let info = allocation_counter::measure(|| track.note(Point::new(20.0, 0.0)));
        assert_eq!(info.count_total, 0);
    }
}
