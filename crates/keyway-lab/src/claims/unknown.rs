//! Unknown obstacles on a path.

use keyway::ConfigError;
use keyway::geometry::{Disc, Point, Polyline};
use keyway::map::{Cell, OccupancyGrid};
use keyway::robot::Robot;
use keyway_sim::episode::{Episode, RandomObstacles};

/// Returns the static discs of a seed: those that a run of [`Robot::paper`] between the same
/// start and goal encounters with this seed.
///
/// # Errors
/// Returns [`ConfigError`] if a value is invalid.
pub(super) fn standing(
    unknown: Option<&RandomObstacles>,
    grid: &OccupancyGrid,
    (ends, seed): ([Cell; 2], u64),
) -> Result<Vec<Disc>, ConfigError> {
    let Some(unknown) = unknown else { return Ok(Vec::new()) };
    let [start, goal] = ends.map(|cell| grid.frame().world_from_cell(cell));
    let mut episode = Episode::new(grid.clone(), Robot::paper(), start, goal);
    unknown.put_into(&mut episode, seed)?;
    Ok(episode.obstacles)
}

/// Smallest distance from a line to discs \[m\], 0 if it goes through one; `None` without discs.
pub(super) fn clearance_m(line: &Polyline, discs: &[Disc]) -> Option<f64> {
    let from = |centre: Point| {
        let distances = line.segments().map(|segment| segment.distance_sq_to_point(centre).sqrt());
        distances.fold(f64::INFINITY, f64::min)
    };
    discs.iter().map(|disc| (from(disc.centre) - disc.radius_m).max(0.0)).reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_by_hand() {
        let line = Polyline::new(vec![[0.0, 0.0].into(), [4.0, 0.0].into(), [4.0, 3.0].into()]);
        let clearance = |discs: &[([f64; 2], f64)]| {
            let discs: Vec<Disc> =
                discs.iter().map(|&(at, radius_m)| Disc::new(at.into(), radius_m)).collect();
            clearance_m(&line, &discs)
        };
        assert_eq!(clearance(&[]), None);
        assert_eq!(clearance(&[([2.0, 2.0], 0.5)]), Some(1.5), "beside both stretches");
        assert_eq!(clearance(&[([2.0, 2.0], 0.5), ([5.0, 2.0], 0.75)]), Some(0.25));
        assert_eq!(clearance(&[([2.0, 0.25], 0.5)]), Some(0.0), "on the line");
        assert_eq!(clearance(&[([7.0, 7.0], 2.0)]), Some(3.0), "beyond its end");
    }
}
