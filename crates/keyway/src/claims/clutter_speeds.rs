//! How fast a robot drives where few obstacles are around it, and where many are.

use crate::episode::Episode;
use crate::geometry::Point;
use crate::map::{Cell, OccupancyGrid};
use crate::metrics::statistics::Sample;
use crate::sim::Run;

/// Mean speeds of the two halves of a run.
///
/// The halves are those of the moments at which less, and at which more, of the ground within [`Self::AROUND_M`] of the robot
/// is covered by obstacles of the map than at the median moment. A robot speeds up at its start and brakes at its goal
/// whatever stands there, so moments within the way that this takes are left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ClutterSpeeds {
    /// Where less is covered \[m/s\].
    pub(super) sparse_mps: f64,
    /// Where more is covered \[m/s\].
    pub(super) dense_mps: f64,
}

impl ClutterSpeeds {
    /// As far as the regions of \[You2021\] reach whose obstacles change the weight of speed \[m\].
    pub(super) const AROUND_M: f64 = 3.0;

    /// `None` where nothing is left of the run, or its surroundings are the same everywhere.
    pub(super) fn of(run: &Run, episode: &Episode) -> Option<Self> {
        let limits = &episode.robot.limits;
        let run_up_m = 0.5 * limits.v_max_mps.powi(2) / limits.acceleration_mps2;
        let ends = [run.samples.first()?, run.samples.last()?].map(|sample| sample.pose.point());
        let is_under_way = |at: Point| ends.iter().all(|end| end.distance(at) > run_up_m);
        let moments: Vec<(f64, f64)> = run
            .samples
            .iter()
            .filter(|sample| is_under_way(sample.pose.point()))
            .map(|sample| (covered_share(&episode.known, sample.pose.point()), sample.velocity.v))
            .collect();
        Self::of_moments(&moments)
    }

    /// Of pairs of a covered share and a speed.
    fn of_moments(moments: &[(f64, f64)]) -> Option<Self> {
        let shares = Sample::new(moments.iter().map(|moment| moment.0).collect()).ok()?;
        let middle = shares.quantile(0.5);
        let mean_where = |is_there: fn(f64, f64) -> bool| {
            let there = moments.iter().filter(|moment| is_there(moment.0, middle));
            Some(Sample::new(there.map(|moment| moment.1).collect()).ok()?.mean())
        };
        Some(Self {
            sparse_mps: mean_where(|share, middle| share < middle)?,
            dense_mps: mean_where(|share, middle| share > middle)?,
        })
    }
}

/// The share of the map's cells around a place that are occupied.
fn covered_share(map: &OccupancyGrid, at: Point) -> f64 {
    let frame = map.frame();
    let reach = (ClutterSpeeds::AROUND_M / frame.resolution_m()).ceil() as i32 + 1;
    let Cell { x, y } = frame.cell_near(at);
    let (mut all, mut occupied) = (0, 0);
    for cell in
        (y - reach..=y + reach).flat_map(|y| (x - reach..=x + reach).map(move |x| Cell::new(x, y)))
    {
        let is_on_map = frame.contains(cell);
        if is_on_map && frame.world_from_cell(cell).distance(at) <= ClutterSpeeds::AROUND_M {
            all += 1;
            occupied += i32::from(map.occupied().get(cell));
        }
    }
    f64::from(occupied) / f64::from(all.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_by_hand() {
        let speeds = |moments: &[(f64, f64)]| ClutterSpeeds::of_moments(moments);
        let both = speeds(&[(0.3, 0.2), (0.0, 0.9), (0.1, 0.7), (0.5, 0.4), (0.2, 9.0)]).unwrap();
        assert!((both.sparse_mps - 0.8).abs() < 1e-12 && (both.dense_mps - 0.3).abs() < 1e-12);
        assert_eq!(speeds(&[(0.2, 0.5), (0.2, 0.7)]), None, "the same everywhere");
        assert_eq!(speeds(&[]), None);
    }

    /// Within 3 cells of a cell there are 29; of one in a corner 11 are on the map.
    #[test]
    fn only_what_is_on_the_map_and_near_counts() {
        let mut rows = vec![".".repeat(20); 20];
        rows[19] = format!("##{}", ".".repeat(18));
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let map = OccupancyGrid::from_ascii(&rows);
        let share = |x, y| covered_share(&map, Point::new(x, y));
        assert_eq!([share(0.5, 0.5), share(10.5, 10.5)], [2.0 / 11.0, 0.0]);
        assert_eq!([share(0.5, 3.5), share(0.5, 4.5)], [1.0 / 18.0, 0.0]);
    }
}
