//! Parts of a run with few and with many obstacles around the robot, and the mean speed in each.

use keyway::geometry::Point;
use keyway::map::{Cell, OccupancyGrid};
use keyway_sim::episode::Episode;
use keyway_sim::metrics::statistics;
use keyway_sim::sim::{Run, TrajectoryPoint};

/// A part of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The whole run.
    Whole,
    /// The half of the run in which obstacles of the map cover the least ground within 3 m.
    Sparse,
    /// The half of the run in which they cover the most ground.
    Dense,
}

impl Part {
    /// Range within which obstacles change the speed weight in \[You2021\] \[m\].
    const AROUND_M: f64 = 3.0;

    /// Returns true for each sample of a run that belongs to this part.
    ///
    /// The halves contain the samples at which obstacles of the map cover less, or more, of the
    /// ground within [`Self::AROUND_M`] of the robot than at the median sample. The robot
    /// accelerates at its start and brakes at its goal regardless of obstacles, so samples within
    /// its acceleration distance of either belong to neither half.
    pub(super) fn samples(self, run: &Run, episode: &Episode) -> Vec<bool> {
        let (Some(first), Some(last)) = (run.samples.first(), run.samples.last()) else {
            return Vec::new();
        };
        let limits = &episode.robots[0].robot.limits;
        let run_up_m = 0.5 * limits.v_max_mps.powi(2) / limits.acceleration_mps2;
        let ends = [first, last].map(|sample| sample.pose.point());
        let is_under_way = |at: Point| ends.iter().all(|end| end.distance(at) > run_up_m);
        let share = |sample: &TrajectoryPoint| {
            let at = sample.pose.point();
            is_under_way(at).then(|| covered_share(&episode.known, at))
        };
        match self {
            Self::Whole => vec![true; run.samples.len()],
            Self::Sparse | Self::Dense => {
                self.of_shares(&run.samples.iter().map(share).collect::<Vec<_>>())
            }
        }
    }

    /// Selects the samples by their shares; `None` belongs to neither half.
    fn of_shares(self, shares: &[Option<f64>]) -> Vec<bool> {
        let values = statistics::Sample::new(shares.iter().copied().flatten().collect());
        let middle = values.map_or(f64::NAN, |values| values.quantile(0.5));
        let is_in = |share: f64| match self {
            Self::Whole => true,
            Self::Sparse => share < middle,
            Self::Dense => share > middle,
        };
        shares.iter().map(|share| share.is_some_and(is_in)).collect()
    }

    /// Returns the mean speed of its samples \[m/s\]; `None` without samples, because the
    /// surroundings are the same everywhere.
    pub(super) fn mean_speed_mps(self, run: &Run, episode: &Episode) -> Option<f64> {
        let samples = run.samples.iter().zip(self.samples(run, episode));
        let own = samples.filter(|(_, is_in)| *is_in).map(|(sample, _)| sample.velocity.v);
        Some(statistics::Sample::new(own.collect()).ok()?.mean())
    }
}

/// Share of occupied map cells around a position.
fn covered_share(map: &OccupancyGrid, at: Point) -> f64 {
    let frame = map.frame();
    let reach = (Part::AROUND_M / frame.resolution_m()).ceil() as i32 + 1;
    let Cell { x, y } = frame.cell_near(at);
    let (mut all, mut occupied) = (0, 0);
    for cell in
        (y - reach..=y + reach).flat_map(|y| (x - reach..=x + reach).map(move |x| Cell::new(x, y)))
    {
        let is_on_map = frame.contains(cell);
        if is_on_map && frame.world_from_cell(cell).distance(at) <= Part::AROUND_M {
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
        let halves = |shares: &[Option<f64>]| {
            [Part::Sparse, Part::Dense].map(|part| {
                let is_in = part.of_shares(shares);
                (0..shares.len()).filter(|&i| is_in[i]).collect::<Vec<_>>()
            })
        };
        let shares = [0.3, 0.0, 0.1, 0.5, 0.2].map(Some);
        assert_eq!(halves(&shares), [vec![1, 2], vec![0, 3]]);
        // Samples in neither half do not shift the median.
        let shares = [None, Some(0.3), None, Some(0.1), Some(0.2), None];
        assert_eq!(halves(&shares), [vec![3], vec![1]]);
        let none: [Vec<usize>; 2] = Default::default();
        assert_eq!(halves(&[Some(0.2), Some(0.2)]), none, "the same everywhere");
        assert_eq!(halves(&[]), none);
    }

    /// Within 3 cells of a cell there are 29 cells; for a corner cell, 11 of them are on the map.
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
