//! What the curvature-continuous smoother makes of paths between random places of a map, and how long
//! it takes: `cargo run --release --example smoothing -- MAP CLEARANCE_M RADIUS_M`.

use keyway::map::formats::read_map;
use keyway::map::{Cell, LayerConfig, SearchMap};
use keyway::plan::{Plan, PlannerConfig};
use keyway::search::{Query, Workspace};
use keyway::smooth::{ContinuousCurvatureConfig, SmootherConfig, WhySharp};
use std::error::Error;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [map, clearance_m, radius_m] = &args[..] else {
        return Err("expected MAP CLEARANCE_M RADIUS_M".into());
    };
    let config = LayerConfig { clearance_m: clearance_m.parse()?, ..LayerConfig::default() };
    let map = SearchMap::new(&read_map(Path::new(map), None)?.grid, config)?;
    let curvature = ContinuousCurvatureConfig { min_turning_radius_m: radius_m.parse()? };
    let smoothers =
        [SmootherConfig::LineOfSight {}, SmootherConfig::ContinuousCurvature(curvature)];
    let planner = PlannerConfig::by_name("jps").ok_or("no jps")?.build(&map)?;
    let free: Vec<Cell> = map.frame().cells().filter(|&cell| map.is_free(cell)).collect();
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let (mut times_us, mut lengths_m) = ([const { Vec::new() }; 2], [0.0; 2]);
    let (mut rounded, mut sharp) = (0, [0; 3]);
    for k in 0..200 {
        let [start, goal] = [k * 7919, k * 104_729 + 31].map(|n| free[n % free.len()]);
        let query = Query::new(start, goal);
        if planner.plan_into(&map, &query, &mut workspace, None, &mut plan).is_err() {
            continue;
        }
        let centre = |cell| map.frame().world_from_cell(cell);
        let line = plan.line(&map, centre(start), centre(goal));
        for (i, smoother) in smoothers.iter().enumerate() {
            let begin = Instant::now();
            let done = smoother.smooth(&line, &map.clearance(), map.config().clearance_m);
            times_us[i].push(begin.elapsed().as_micros());
            lengths_m[i] += done.path.length_m();
            rounded += done.inserted_points / 7;
            for corner in done.sharp_corners {
                sharp[match corner.why {
                    WhySharp::Clearance => 0,
                    WhySharp::TurningRadius => 1,
                    _ => 2,
                }] += 1;
            }
        }
    }
    println!("{} paths, {rounded} corners rounded", times_us[0].len());
    println!("sharp for clearance, turning radius, reversal: {sharp:?}");
    for (i, smoother) in smoothers.iter().enumerate() {
        times_us[i].sort_unstable();
        let times = &times_us[i];
        let at = |percent: usize| times.get(times.len() * percent / 100).copied().unwrap_or(0);
        let (name, length_m) = (smoother.name(), lengths_m[i]);
        println!(
            "{name}: {length_m:.1} m; median {} us, 95 % {} us, 99 % {} us",
            at(50),
            at(95),
            at(99)
        );
    }
    Ok(())
}
