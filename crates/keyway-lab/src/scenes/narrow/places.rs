//! The kinds of narrow places. Lengths are metres in a frame whose origin is the centre of the
//! map.

use super::Ends;
use super::robots::width_m;
use keyway::geometry::Pose;
use keyway::random::Random;
use keyway::robot::{Footprint, Robot};
use std::f64::consts::{FRAC_PI_2, PI};

/// The static boxes, and the start and goal.
type Drawing = (Vec<[f64; 4]>, Ends);

/// A kind of place.
#[derive(Debug)]
pub(super) struct Place {
    pub(super) name: &'static str,
    pub(super) about: &'static str,
    pub(super) draw: fn(&Robot, &mut Random) -> Drawing,
}

impl Place {
    pub(super) const ALL: &[Self] = &[
        Self {
            name: "tunnel",
            about: "A straight tunnel through a wall of 1 to 4 m, 1.5 to 10 cm wider on each side \
                    than the robot, which starts in front of it or inside",
            draw: tunnel,
        },
        Self {
            name: "door",
            about: "A door in a thin wall, 2 to 15 cm wider on each side than the robot",
            draw: door,
        },
        Self {
            name: "bay",
            about: "A bay, 4 to 20 cm wider on each side than the robot, with the goal at its end, \
                    facing in, out or in any direction",
            draw: bay,
        },
        Self {
            name: "corner",
            about: "Two corridors that meet at a right angle, in which the robot can barely turn or \
                    cannot turn at all",
            draw: corner,
        },
        Self {
            name: "lane",
            about: "A lane, 2 to 10 cm wider on each side than the robot, in which it starts and \
                    ends",
            draw: lane,
        },
        Self {
            name: "room",
            about: "Two rooms with furniture, and a door between them",
            draw: room,
        },
        Self {
            name: "wall",
            about: "A wall along which the robot starts or ends, or both, 1 to 12 cm from it",
            draw: wall,
        },
    ];
}

/// Distance beyond the border of the map, in any rotation.
const FAR_M: f64 = 8.0;

/// Maximum distance of routes from the centre of the map \[m\].
const REACH_M: f64 = 3.8;

/// A wall across the map, from `left` to `right`, with a gap from `low` to `high`.
fn wall_with_gap([left, right]: [f64; 2], [low, high]: [f64; 2]) -> Vec<[f64; 4]> {
    vec![[left, -FAR_M, right, low], [left, high, right, FAR_M]]
}

/// Width of a gap, wider than the robot by this much on each side.
fn gap_m(robot: &Robot, random: &mut Random, to_each_side_m: [f64; 2]) -> f64 {
    width_m(robot) + 2.0 * random.between(to_each_side_m)
}

fn anywhere(random: &mut Random, [x, y]: [[f64; 2]; 2]) -> Pose {
    Pose::new(random.between(x), random.between(y), random.between([-PI, PI]))
}

fn ends(start: Pose, goal: Pose, has_heading: bool) -> Ends {
    Ends { start, goal, has_heading }
}

fn tunnel(robot: &Robot, random: &mut Random) -> Drawing {
    let half_m = 0.5 * gap_m(robot, random, [0.015, 0.1]);
    let length_m = random.between([1.0, 4.0]);
    let [left, right] = [-0.5 * length_m, 0.5 * length_m];
    let boxes = wall_with_gap([left, right], [-half_m, half_m]);
    let goal = anywhere(random, [[right + 0.7, REACH_M], [-2.0, 2.0]]);
    let goal = if random.is_chosen(0.2) { Pose::new(-goal.x, goal.y, goal.theta) } else { goal };
    let start = if random.is_chosen(0.25) {
        let facing = if random.is_chosen(0.5) { 0.0 } else { PI };
        let off_m = random.between([-0.004, 0.004]);
        Pose::new(random.between([left, right]), off_m, facing)
    } else {
        anywhere(random, [[-REACH_M, left - 0.5], [-2.0, 2.0]])
    };
    (boxes, ends(start, goal, random.is_chosen(0.3)))
}

fn door(robot: &Robot, random: &mut Random) -> Drawing {
    let half_m = 0.5 * gap_m(robot, random, [0.02, 0.15]);
    let middle = random.between([-1.0, 1.0]);
    let boxes = wall_with_gap([-0.05, 0.05], [middle - half_m, middle + half_m]);
    let start = anywhere(random, [[-REACH_M, -0.2], [-2.5, 2.5]]);
    let goal = anywhere(random, [[0.2, REACH_M], [-2.5, 2.5]]);
    (boxes, ends(start, goal, random.is_chosen(0.4)))
}

fn bay(robot: &Robot, random: &mut Random) -> Drawing {
    let half_m = 0.5 * gap_m(robot, random, [0.04, 0.2]);
    let size_m = 2.0 * robot.footprint.circumscribed_radius_m();
    let depth_m = size_m * random.between([0.8, 2.5]);
    let mut boxes = wall_with_gap([0.0, FAR_M], [-half_m, half_m]);
    boxes.push([depth_m, -half_m, FAR_M, half_m]);
    // A wall opposite to the bay.
    let opposite_m = -size_m * random.between([1.2, 4.0]) - 0.3;
    boxes.push([-FAR_M, -FAR_M, opposite_m, FAR_M]);
    let facing = if random.is_chosen(0.5) { PI } else { 0.0 };
    let goal = Pose::new(random.between([0.3 * depth_m, depth_m]), 0.0, facing);
    let start = anywhere(random, [[opposite_m, 0.0], [-3.0, 3.0]]);
    (boxes, ends(start, goal, random.is_chosen(0.8)))
}

fn corner(robot: &Robot, random: &mut Random) -> Drawing {
    let widest_m = 2.2 * robot.footprint.circumscribed_radius_m();
    let mut corridor_m =
        || random.between([width_m(robot) + 0.06, widest_m.max(width_m(robot) + 0.1)]);
    let (across_m, up_m) = (corridor_m(), corridor_m());
    // A lane along the x axis from the left, then one upwards.
    let boxes = vec![
        [-FAR_M, -FAR_M, FAR_M, -0.5 * across_m],
        [-FAR_M, 0.5 * across_m, -0.5 * up_m, FAR_M],
        [0.5 * up_m, -0.5 * across_m, FAR_M, FAR_M],
    ];
    let flip = |random: &mut Random| if random.is_chosen(0.2) { PI } else { 0.0 };
    let start = Pose::new(random.between([-REACH_M, -1.5]), 0.0, flip(random));
    let goal = Pose::new(0.0, random.between([1.5, REACH_M]), FRAC_PI_2 + flip(random));
    (boxes, ends(start, goal, random.is_chosen(0.2)))
}

fn lane(robot: &Robot, random: &mut Random) -> Drawing {
    let half_m = 0.5 * gap_m(robot, random, [0.02, 0.1]);
    let boxes = wall_with_gap([-FAR_M, FAR_M], [-half_m, half_m]);
    let flip = |random: &mut Random| if random.is_chosen(0.2) { PI } else { 0.0 };
    let start = Pose::new(random.between([-4.0, -2.0]), 0.0, flip(random));
    let goal = Pose::new(random.between([2.0, 4.0]), 0.0, 0.0);
    (boxes, ends(start, goal, false))
}

fn room(robot: &Robot, random: &mut Random) -> Drawing {
    let half_m = 0.5 * gap_m(robot, random, [0.03, 0.2]);
    let middle = random.between([-1.5, 1.5]);
    let mut boxes = wall_with_gap([-0.05, 0.05], [middle - half_m, middle + half_m]);
    let [width_m, height_m] = [random.between([2.0, 3.5]), random.between([2.0, 3.0])];
    boxes.extend([
        [-FAR_M, height_m, FAR_M, FAR_M],
        [-FAR_M, -FAR_M, FAR_M, -height_m],
        [-FAR_M, -FAR_M, -width_m, FAR_M],
        [width_m, -FAR_M, FAR_M, FAR_M],
    ]);
    for _ in 0..random.below(7) {
        let [x, y] = [random.between([-width_m, width_m]), random.between([-height_m, height_m])];
        let sides = [(); 2].map(|()| random.between([0.2, 0.9]));
        boxes.push([x, y, x + sides[0], y + sides[1]]);
    }
    let start = anywhere(random, [[-width_m, -0.2], [-height_m, height_m]]);
    let goal = anywhere(random, [[0.2, width_m], [-height_m, height_m]]);
    (boxes, ends(start, goal, random.is_chosen(0.5)))
}

/// Route beside a wall, along it or away from it.
fn wall(robot: &Robot, random: &mut Random) -> Drawing {
    let mut boxes = vec![[-FAR_M, -FAR_M, FAR_M, 0.0]];
    if random.is_chosen(0.5) {
        let across_m = 2.0 * robot.footprint.circumscribed_radius_m() + random.between([0.1, 1.0]);
        boxes.push([-FAR_M, across_m, FAR_M, FAR_M]);
    }
    let beside = |random: &mut Random, x: [f64; 2]| {
        let theta = FRAC_PI_2 * f64::from(random.below(4));
        let facing = Pose::new(0.0, 0.0, theta);
        let lowest_m = match &robot.footprint {
            Footprint::Circle(circle) => -circle.radius_m(),
            Footprint::Polygon(polygon) => {
                let turned = polygon.vertices().iter().map(|&at| facing.world_from_body(at).y);
                turned.fold(0.0, f64::min)
            }
        };
        Pose::new(random.between(x), random.between([0.01, 0.12]) - lowest_m, theta)
    };
    let free = [[-REACH_M, REACH_M], [0.2, 3.0]];
    let which = random.below(3);
    let start = if which == 1 { anywhere(random, free) } else { beside(random, [-3.5, -0.5]) };
    let goal = if which == 0 { anywhere(random, free) } else { beside(random, [-1.0, 3.5]) };
    (boxes, ends(start, goal, which > 0))
}
