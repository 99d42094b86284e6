//! Obstacle density of the world of a run.

use keyway::geometry::Point;
use keyway_sim::episode::Episode;
use keyway_sim::sim::ElusiveShape;
use std::f64::consts::PI;

/// Share of the known map area that obstacles cover at the beginning: occupied cells, and the
/// obstacles outside the map, static and moving. Overlaps, and parts beyond the map, count in full,
/// so the share is capped at 1. It is the same for all stacks, and `None` for a map without a known
/// cell.
pub(super) fn occupied_share(episode: &Episode) -> Option<f64> {
    let (map, frame) = (&episode.known, episode.known.frame());
    let cell_m2 = frame.resolution_m().powi(2);
    let cells = u64::from(frame.width()) * u64::from(frame.height()) - map.unknown().count_ones();
    let movers = episode.movers.iter().map(|mover| mover.at(0.0));
    let circles = episode.obstacles.iter().copied().chain(movers);
    let hidden_m2: f64 = circles.map(|circle| PI * circle.radius_m.powi(2)).sum();
    let polygons_m2: f64 = episode.polygons.iter().map(|polygon| area_m2(polygon.vertices())).sum();
    let standing = episode.elusive.iter().filter(|it| it.stands_at(0.0));
    let elusive_m2: f64 = standing.map(|it| shape_m2(it.shape())).sum();
    let absent = episode.absent_cells.iter().filter(|&&cell| map.occupied().get(cell)).count();
    let occupied = map.occupied().count_ones() + episode.hidden_cells.len() as u64 - absent as u64;
    let occupied_m2 = occupied as f64 * cell_m2 + hidden_m2 + polygons_m2 + elusive_m2;
    (cells > 0).then(|| (occupied_m2 / (cells as f64 * cell_m2)).min(1.0))
}

/// Area of an obstacle that is present only for a time \[m²\].
fn shape_m2(shape: &ElusiveShape) -> f64 {
    match shape {
        ElusiveShape::Disc(disc) => PI * disc.radius_m.powi(2),
        ElusiveShape::Polygon(polygon) => area_m2(polygon.vertices()),
        _ => 0.0,
    }
}

/// Area of a polygon, as a sum over its sides \[m²\].
fn area_m2(vertices: &[Point]) -> f64 {
    let next = vertices.iter().cycle().skip(1);
    let twice_m2: f64 = vertices.iter().zip(next).map(|(a, b)| a.x * b.y - b.x * a.y).sum();
    0.5 * twice_m2.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::Disc;
    use keyway::map::{Cell, OccupancyGrid};
    use keyway_sim::sim::{ElusiveObstacle, MovingObstacle, Presence, StandingPolygon};

    #[test]
    fn a_share_by_hand() {
        // 12 cells of 1 m2, of which 2 are unknown and 3 occupied.
        let map = OccupancyGrid::from_ascii(&["..#?", "..#?", "..#."]);
        let (start, goal) = (Point::new(0.5, 0.5), Point::new(1.5, 0.5));
        let mut episode = Episode::of_robots(map, Vec::new());
        assert_eq!(occupied_share(&episode), Some(0.3));
        episode.obstacles = vec![Disc::new(goal, 0.5)];
        episode.movers = vec![MovingObstacle::straight(start, 1.0, start).unwrap()];
        let share = occupied_share(&episode).unwrap();
        assert!((share - (3.0 + 1.25 * PI) / 10.0).abs() < 1e-12, "{share}");
        // A triangle of half a square metre, and a cell.
        let corners = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(x, y)| Point::new(x, y));
        episode.polygons = vec![StandingPolygon::new(corners.to_vec()).unwrap()];
        episode.hidden_cells = vec![Cell::new(0, 2)];
        let share = occupied_share(&episode).unwrap();
        assert!((share - (4.5 + 1.25 * PI) / 10.0).abs() < 1e-12, "{share}");
        // A disc that is present from the beginning, another one that appears later, and one cell
        // less.
        let disc = |from_s| {
            let presence = Presence { from_s, ..Presence::ALWAYS };
            ElusiveObstacle::new(ElusiveShape::Disc(Disc::new(goal, 0.5)), presence).unwrap()
        };
        episode.elusive = vec![disc(0.0), disc(1.0)];
        episode.absent_cells = vec![Cell::new(2, 1)];
        let share = occupied_share(&episode).unwrap();
        assert!((share - (3.5 + 1.5 * PI) / 10.0).abs() < 1e-12, "{share}");
        episode.known = OccupancyGrid::from_ascii(&["??"]);
        assert_eq!(occupied_share(&episode), None);
    }
}
