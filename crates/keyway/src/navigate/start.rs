//! Whether a robot can begin where it stands.

use crate::geometry::{Point, Pose};
use crate::map::Clearance;
use crate::robot::Footprint;

/// Whether a footprint touches an obstacle or the border of the map, or is beyond it: what the simulator calls a contact.
pub(crate) fn touches(footprint: &Footprint, pose: Pose, clearance: &Clearance<'_>) -> bool {
    // Farther away than this, a distance says nothing about contact.
    const REACH_M: f64 = 1e-6;
    footprint.to_border_m(pose, clearance) <= 0.0
        || footprint.distance_m(pose, clearance, REACH_M) <= 0.0
}

/// Whether a footprint touches something whatever its heading. A controller is given the heading later, so one without
/// contact is enough; they are tried degree by degree.
pub(super) fn touches_at_every_heading(
    footprint: &Footprint,
    position: Point,
    clearance: &Clearance<'_>,
) -> bool {
    let headings = match footprint {
        Footprint::Circle(_) => 1,
        Footprint::Polygon(_) => 360,
    };
    let at = |degree: i32| Pose::new(position.x, position.y, f64::from(degree).to_radians());
    (0..headings).all(|degree| touches(footprint, at(degree), clearance))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::OccupancyGrid;

    #[test]
    fn contacts_by_hand() {
        let grid = OccupancyGrid::from_ascii(&["#####", ".....", "#####"]);
        let clearance = Clearance::new(grid.frame(), grid.occupied());
        let touches = |footprint: &Footprint, x, y| {
            touches_at_every_heading(footprint, Point::new(x, y), &clearance)
        };
        let round = Footprint::circle(0.4).unwrap();
        assert!(!touches(&round, 2.5, 1.401) && !touches(&round, 0.401, 1.5));
        assert!(touches(&round, 2.5, 1.4), "the wall");
        assert!(touches(&round, 0.4, 1.5) && touches(&round, -1.0, 1.5), "the border");
        // It fits along the lane, and at no heading when it is as wide as the lane.
        let along = Footprint::rectangle(2.0, 0.9).unwrap();
        assert!(!touches(&along, 2.5, 1.5));
        let wide = Footprint::rectangle(2.0, 1.0).unwrap();
        assert!(touches(&wide, 2.5, 1.5));
    }
}
