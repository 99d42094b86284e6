//! From a ROS map to a path that a robot can drive, to copy: plan, smooth, check the footprint,
//! and compute a speed profile.
//!
//! `cargo run --release --example driveable_path -- [MAP.yaml [START_X START_Y GOAL_X GOAL_Y]]`

use keyway::geometry::{Path, PathSample, Point, Pose, wrap_angle};
use keyway::map::formats::read_map;
use keyway::map::{
    Costmap, CostmapConfig, DistanceField, FieldConfig, LayerConfig, OccupancyGrid, SearchMap,
};
use keyway::plan::{Plan, PlannerConfig};
use keyway::robot::{Footprint, Robot};
use keyway::search::{Query, Workspace};
use keyway::smooth::{
    ContinuousCurvature, ContinuousCurvatureConfig, Smoother, SpeedProfile, SpeedProfileConfig,
};
use std::error::Error;

const HOUSE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../keyway-cli/scenes/small_house.yaml");

/// Distance between samples of the path \[m\].
const SPACING_M: f64 = 0.01;

/// Margin by which the checked footprint is larger \[m\], because the robot moves between two
/// samples.
const MARGIN_M: f64 = 0.02;

/// A box that turns around a point behind its middle: 0.5 m long, 0.3 m wide.
fn footprint(larger_m: f64) -> Result<Footprint, Box<dyn Error>> {
    let (front, back, side) = (0.3 + larger_m, -0.2 - larger_m, 0.15 + larger_m);
    let corners = [[front, side], [back, side], [back, -side], [front, -side]];
    Ok(Footprint::polygon(corners.map(Point::from).to_vec())?)
}

/// The smoothed path of a plan that keeps a clearance.
fn smooth_path(
    grid: &OccupancyGrid,
    ends: [Point; 2],
    clearance_m: f64,
    robot: &Robot,
) -> Result<Path, Box<dyn Error>> {
    let map = SearchMap::new(grid, LayerConfig { clearance_m, ..LayerConfig::default() })?;
    let planner = PlannerConfig::by_name("jps").ok_or("no such planner")?.build(&map)?;
    let [start, goal] = ends.map(|end| map.frame().cell_from_world(end));
    let query = Query::new(start.ok_or("start outside")?, goal.ok_or("goal outside")?);
    let mut plan = Plan::default();
    planner.plan_into(&map, &query, &mut Workspace::default(), None, &mut plan)?;
    let line = plan.line(&map, ends[0], ends[1]);
    // On curves the robot need not be slower than this.
    let curves = ContinuousCurvatureConfig::for_robot(robot, 0.3);
    let smoother = ContinuousCurvature::new(curves)?;
    let done = smoother.smooth(&line, &map.clearance(), clearance_m);
    println!("planned at {clearance_m:.3} m: {:.3} m after smoothing", done.path.length_m());
    println!("  sharp corners, at which the robot turns on the spot: {}", done.sharp_corners.len());
    if let Some(kept_m) = done.kept_clearance_m {
        println!("  but it keeps only {kept_m:.3} m somewhere");
    }
    Ok(done.path)
}

/// The first pose at which the robot would touch an obstacle, along the path or while it turns in
/// place. It starts at the first sample with the heading `from_rad`.
fn first_contact(
    samples: &[PathSample],
    from_rad: f64,
    footprint: &Footprint,
    field: &DistanceField,
) -> Option<Point> {
    let (mut heading_rad, mut s_m) = (from_rad, 0.0);
    for sample in samples {
        let at = sample.position();
        let pose = Pose::new(at.x, at.y, sample.heading_rad);
        // The two samples of a corner have no distance between them.
        let turn_rad = wrap_angle(sample.heading_rad - heading_rad);
        let turns = sample.s_m == s_m && turn_rad != 0.0;
        let is_free = footprint.is_free(pose, field)
            && (!turns || footprint.is_free_turn(at, heading_rad, turn_rad, field));
        if !is_free {
            return Some(at);
        }
        (heading_rad, s_m) = (sample.heading_rad, sample.s_m);
    }
    None
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let file = args.first().map_or(HOUSE, String::as_str);
    let numbers: Vec<f64> = args.iter().skip(1).map(|n| n.parse()).collect::<Result<_, _>>()?;
    let ends = match numbers[..] {
        [] => [Point::new(-8.175, -2.825), Point::new(8.725, 0.875)],
        [a, b, c, d] => [Point::new(a, b), Point::new(c, d)],
        _ => return Err("expected START_X START_Y GOAL_X GOAL_Y".into()),
    };
    let grid = read_map(std::path::Path::new(file), None)?.grid;
    let robot = Robot::small();
    // Unknown cells are obstacles by default, for planning and for the footprint.
    let map = SearchMap::new(&grid, LayerConfig::default())?;
    let field = DistanceField::new(map.frame(), map.obstacles(), &FieldConfig::default());

    // At the inscribed radius narrow passages stay open, but the path has to be checked; the
    // circumscribed radius is always safe.
    let checked = footprint(MARGIN_M)?;
    let mut driveable = None;
    for clearance_m in [checked.inscribed_radius_m(), checked.circumscribed_radius_m()] {
        let path = smooth_path(&grid, ends, clearance_m, &robot)?;
        let samples = path.samples_and_joints(SPACING_M);
        if let Some(at) = first_contact(&samples, 0.0, &checked, &field) {
            println!("  the footprint does not fit at ({:.3}, {:.3})", at.x, at.y);
            continue;
        }
        println!("  the footprint fits at all {} samples and turns", samples.len());
        driveable = Some((path, samples));
        break;
    }
    let (path, samples) = driveable.ok_or("no path on which the footprint fits")?;

    let config = SpeedProfileConfig { spacing_m: SPACING_M, ..SpeedProfileConfig::default() };
    let profile = SpeedProfile::of_path(&path, &robot.limits, &config)?;
    println!("at least {:.1} s, of which {:.1} s turning", profile.time_s, profile.turning_s);

    // For Nav2, or for display.
    let inscribed_radius_m = footprint(0.0)?.inscribed_radius_m();
    let costs =
        Costmap::new(&grid, CostmapConfig { inscribed_radius_m, ..CostmapConfig::default() })?;
    let cost = |sample: &PathSample| costs.cost(grid.frame().cell_from_world(sample.position())?);
    let largest = samples.iter().filter_map(cost).max().unwrap_or(Costmap::FREE);
    println!("largest cost on the way: {largest} of {}", Costmap::LETHAL);
    Ok(())
}
