//! Whether a robot can begin where it stands.

use super::NavigateError;
use crate::geometry::{Point, Pose};
use crate::map::{Clearance, SearchMap};
use crate::robot::Footprint;

/// Whether a footprint touches an obstacle or the border of the map, or is beyond it: what the simulator calls a contact.
pub(crate) fn touches(footprint: &Footprint, pose: Pose, clearance: &Clearance<'_>) -> bool {
    // Farther away than this, a distance says nothing about contact.
    const REACH_M: f64 = 1e-6;
    footprint.to_border_m(pose, clearance) <= 0.0
        || footprint.distance_m(pose, clearance, REACH_M) <= 0.0
}

/// Refuses a start at which the footprint touches something whatever its heading. A controller is given the heading later,
/// so one without contact is enough; they are tried degree by degree.
pub(super) fn check_start(
    footprint: &Footprint,
    position: Point,
    map: &SearchMap,
) -> Result<(), NavigateError> {
    let clearance = map.clearance();
    let headings = match footprint {
        Footprint::Circle(_) => 1,
        Footprint::Polygon(_) => 360,
    };
    let at = |degree: i32| Pose::new(position.x, position.y, f64::from(degree).to_radians());
    if (0..headings).any(|degree| !touches(footprint, at(degree), &clearance)) {
        return Ok(());
    }
    let (why, yaw_deg) = (map.hindrance(position), None);
    Err(NavigateError::StartTouches { position, yaw_deg, footprint: footprint.clone(), why })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    #[test]
    fn a_start_in_contact_is_refused() {
        let grid = OccupancyGrid::from_ascii(&["#####", ".....", "#####"]);
        let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
        let check = |footprint: &Footprint, x, y| check_start(footprint, Point::new(x, y), &map);
        let round = Footprint::circle(0.4).unwrap();
        assert!(check(&round, 2.5, 1.401).is_ok() && check(&round, 0.401, 1.5).is_ok());
        let text = |result: Result<(), NavigateError>| result.unwrap_err().to_string();
        assert_eq!(
            text(check(&round, 2.5, 1.4)),
            "at the start (2.5, 1.4) the robot (radius 0.4 m) touches something (an obstacle is 0.400 m away); \
             move the start away from it"
        );
        let at_border = text(check(&round, 0.4, 1.5));
        assert!(at_border.contains("(the border of the map is 0.400 m away)"), "{at_border}");
        // It fits along the lane, and at no heading when it is as wide as the lane.
        let along = Footprint::rectangle(2.0, 0.9).unwrap();
        assert!(check(&along, 2.5, 1.5).is_ok());
        let wide = Footprint::rectangle(2.0, 1.0).unwrap();
        let everywhere = text(check(&wide, 2.5, 1.5));
        assert!(
            everywhere.contains("(2 m x 1 m) touches something at every heading"),
            "{everywhere}"
        );
    }
}
