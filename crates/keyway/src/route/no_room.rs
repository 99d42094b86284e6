//! The reason why a start or goal has too little clearance, in positions.

use crate::geometry::Point;
use crate::map::SearchMap;
use crate::plan::{PathEnd, PlanError};

/// The reason why a start or goal \[m\] cannot be used, with its position, its cell and the
/// nearest free position; `None` for every other error. Planners report cells only.
pub fn why_no_room(
    map: &SearchMap,
    [start, goal]: [Point; 2],
    error: &PlanError,
) -> Option<String> {
    let (end, cell, what) = match *error {
        PlanError::OutsideMap { end, cell, .. } => (end, cell, "is outside the map".to_owned()),
        PlanError::Blocked { end, cell, by, .. } => (end, cell, by.to_string()),
        _ => return None,
    };
    let position = match end {
        PathEnd::Start => start,
        PathEnd::Goal => goal,
    };
    let nearest = map.nearest_free(cell).map_or_else(
        || "there is no free position on this map".to_owned(),
        |free| {
            let position = text_of(map.frame().world_from_cell(free));
            format!("the nearest free position is {position}, cell {free}")
        },
    );
    Some(format!("{end} {}, cell {cell}, {what}; {nearest}", text_of(position)))
}

fn text_of(Point { x, y }: Point) -> String {
    let is_short = x.abs().max(y.abs()) < 1e9;
    if is_short { format!("({x:.3}, {y:.3})") } else { format!("({x:e}, {y:e})") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{Cell, LayerConfig, OccupancyGrid};

    #[test]
    fn positions_are_those_that_were_given() {
        let grid = OccupancyGrid::from_ascii(&["..", ".#"]);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let text = |goal, error: &PlanError| {
            why_no_room(&map, [Point::new(0.5, 0.5), goal], error).unwrap()
        };
        let end = PathEnd::Goal;
        let cell = Cell::new(7, 1);
        let outside = PlanError::OutsideMap { end, cell, width: 2, height: 2 };
        assert_eq!(
            text(Point::new(7.25, 1.5), &outside),
            "goal (7.250, 1.500), cell (7, 1), is outside the map; the nearest free position is (1.500, 1.500), cell (1, 1)"
        );
        assert!(text(Point::new(1e300, 1.5), &outside).starts_with("goal (1e300, 1.5e0), cell "));
        assert_eq!(why_no_room(&map, [Point::default(); 2], &PlanError::OtherMap), None);
    }
}
