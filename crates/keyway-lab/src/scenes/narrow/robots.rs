//! Robots of any shape.

use keyway::geometry::Point;
use keyway::random::Random;
use keyway::robot::{Footprint, Limits, Robot};

/// Draws a robot of 0.3 to 3 m/s: a disc of 0.1 to 0.8 m, or a rectangle of 0.25 to 1.2 m, up to
/// 0.6 m wide, that turns about its centre or about a point nearer to its rear. Most can reverse.
pub(super) fn any_robot(random: &mut Random) -> Robot {
    let footprint = any_footprint(random);
    // Log-uniform: as many between 0.3 and 0.6 m/s as between 1.5 and 3 m/s.
    let v_max_mps = 0.3 * random.between([0.0, f64::ln(10.0)]).exp();
    let v_max_mps = super::to(v_max_mps, 100.0);
    let robot = Robot::derived(footprint, v_max_mps);
    let v_min_mps = if random.is_chosen(0.7) { -super::to(0.4 * v_max_mps, 100.0) } else { 0.0 };
    Robot { limits: Limits { v_min_mps, ..robot.limits.clone() }, ..robot }
}

#[expect(clippy::expect_used, reason = "the sizes that are drawn can be used")]
fn any_footprint(random: &mut Random) -> Footprint {
    let kind = random.below(4);
    if kind == 0 {
        let radius_m = super::to(random.between([0.05, 0.4]), 1e3);
        return Footprint::circle(radius_m).expect("radii of 0.05 to 0.4 m can be used");
    }
    let length_m = random.between([0.25, 1.2]);
    let width_m = (length_m * random.between([0.5, 0.9])).min(0.6);
    let [length_m, width_m] = [length_m, width_m].map(|side_m| super::to(side_m, 100.0));
    // Distance from the rear to the centre of rotation, as a share of the length.
    let rear = if kind == 1 { 0.5 } else { random.between([0.12, 0.5]) };
    let rear_m = super::to(rear * length_m, 1e3);
    let (ahead_m, half_m) = (length_m - rear_m, 0.5 * width_m);
    let corners = [[ahead_m, half_m], [-rear_m, half_m], [-rear_m, -half_m], [ahead_m, -half_m]];
    let corners = corners.map(Point::from).to_vec();
    Footprint::polygon(corners).expect("rectangles around their origin can be used")
}

/// Largest width \[m\], across the heading.
pub(super) fn width_m(robot: &Robot) -> f64 {
    match &robot.footprint {
        Footprint::Circle(circle) => 2.0 * circle.radius_m(),
        Footprint::Polygon(polygon) => {
            let sides = polygon.vertices().iter().map(|vertex| vertex.y);
            let [low, high] = sides.fold([0.0_f64; 2], |[low, high], y| [low.min(y), high.max(y)]);
            high - low
        }
    }
}
