//! What it costs to come near to something that moves.

use super::course::State;
use crate::geometry::Point;

/// A mover along the axes of the map's cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foreseen {
    pub(super) centre: Point,
    pub(super) velocity_mps: Point,
    /// Of it and of the robot together \[m\].
    pub(super) reach_m: f64,
    /// A standard deviation of its position \[m\] and of its velocity \[m/s\].
    pub(super) off_m: f64,
    pub(super) off_mps: f64,
    /// How it may speed up or turn \[m/s²\].
    pub(super) off_mps2: f64,
    /// When it comes to something that stands; then it may go anywhere \[s\].
    pub(super) wall_s: f64,
}

impl Foreseen {
    /// Where it is expected, and a standard deviation of that \[m\].
    #[inline]
    fn at(&self, after_s: f64) -> (Point, f64) {
        let straight_s = after_s.min(self.wall_s);
        let centre = self.centre + self.velocity_mps * straight_s;
        let off_m = self.off_m + (self.off_mps + 0.5 * self.off_mps2 * after_s) * after_s;
        let after_wall_s = after_s - straight_s;
        (centre, off_m + 0.7 * self.velocity_mps.norm() * after_wall_s)
    }
}

/// Everything that moves, in one cycle.
#[derive(Debug)]
pub(super) struct Meeting<'a> {
    pub(super) movers: &'a [Foreseen],
    /// Room to them that the robot likes to have \[m\].
    pub(super) comfortable_m: f64,
    /// Seconds that a second in contact counts as.
    pub(super) contact: f64,
}

impl Meeting<'_> {
    /// What a second at a state costs \[s\].
    #[inline]
    pub(super) fn cost_s(&self, state: &State, v_mps: f64) -> f64 {
        let mut sum = 0.0;
        for mover in self.movers {
            let (centre, off_m) = mover.at(state.after_s);
            let wide_m = self.comfortable_m + 2.0 * off_m;
            let apart = state.at - centre;
            let enough_m = mover.reach_m + wide_m;
            let apart_sq = apart.dot(apart);
            if apart_sq >= enough_m * enough_m {
                continue;
            }
            let gap_m = apart_sq.sqrt() - mover.reach_m;
            let near = (1.0 - gap_m / wide_m).min(1.0);
            // The less is known, the less likely is a contact where the disc is.
            let reach_sq = mover.reach_m * mover.reach_m;
            let sure = reach_sq / (reach_sq + off_m * off_m);
            let grazing = 0.1 + 0.4 * off_m / (off_m + 0.1);
            let depth = if gap_m < 0.0 { 1.0 - gap_m / mover.reach_m } else { 0.0 };
            let speed = 1.0 + 0.5 * v_mps.abs();
            sum += sure * self.contact * (grazing * near * near + depth) * speed;
        }
        sum
    }
}
