//! Effect of the curvature-continuous smoother on corners: a table for `docs/smoothers.md`, of
//! paths of `jps` between random free cells of the given maps.
//!
//! `cargo run --release -p keyway-lab --example rounded_corners -- PATHS_PER_MAP MAP...`

use keyway::geometry::{PathPiece, PlannedLine};
use keyway::map::formats::read_map;
use keyway::map::{Cell, Clearance, LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::{Plan, PlannerConfig};
use keyway::search::{Query, Workspace};
use keyway::smooth::{
    ContinuousCurvature, ContinuousCurvatureConfig, LineOfSight, Smoothed, Smoother, Taut, WhySharp,
};
use keyway_sim::metrics::statistics::Sample;
use std::error::Error;
use std::path::Path;

const CLEARANCES_M: [f64; 2] = [0.0, 0.3];
const RADII_M: [f64; 4] = [0.0, 0.2, 0.5, 1.0];

/// Counts over all paths with one clearance and radius.
#[derive(Default)]
struct Tally {
    corners: usize,
    sharp: usize,
    sharp_for_radius: usize,
    /// Excess length over that of `taut`, as a share, of each path; likewise of line of sight.
    excess: Vec<f64>,
    sight_excess: Vec<f64>,
    /// The largest curvature of each path that has a curve \[1/m\].
    peaks: Vec<f64>,
    /// Guaranteed clearance, if that is less than the requested one \[m\].
    least_m: Option<f64>,
}

impl Tally {
    fn add(
        &mut self,
        line: &PlannedLine,
        clearance: &Clearance<'_>,
        clearance_m: f64,
        curves: &ContinuousCurvature,
    ) {
        let smooth = |smoother: &dyn Smoother| smoother.smooth(line, clearance, clearance_m);
        let (sight, taut, done) = (smooth(&LineOfSight), smooth(&Taut), smooth(curves));
        self.corners += sight.path.pieces().len().saturating_sub(1);
        self.sharp += done.sharp_corners.len();
        self.sharp_for_radius += done
            .sharp_corners
            .iter()
            .filter(|corner| corner.why == WhySharp::TurningRadius)
            .count();
        let excess = |of: &Smoothed| of.path.length_m() / taut.path.length_m() - 1.0;
        if taut.path.length_m() > 0.0 {
            self.excess.push(excess(&done));
            self.sight_excess.push(excess(&sight));
        }
        let peak = |piece: &PathPiece| match piece {
            PathPiece::Cubic(c) => c.curvature_at(0.0).abs().max(c.curvature_at(1.0).abs()),
            _ => 0.0,
        };
        let peak = done.path.pieces().iter().map(peak).fold(0.0, f64::max);
        self.peaks.extend((peak > 0.0).then_some(peak));
        let kept = done.kept_clearance_m.into_iter().chain(self.least_m);
        self.least_m = kept.reduce(f64::min);
    }
}

fn lines(map: &SearchMap, paths: usize) -> Result<Vec<PlannedLine>, Box<dyn Error>> {
    let planner = PlannerConfig::by_name("jps").ok_or("no jps")?.build(map)?;
    let free: Vec<Cell> = map.frame().cells().filter(|&cell| map.is_free(cell)).collect();
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let line = |k: usize| {
        let [start, goal] = [k * 7919, k * 104_729 + 31].map(|n| free[n % free.len()]);
        planner.plan_into(map, &Query::new(start, goal), &mut workspace, None, &mut plan).ok()?;
        let centre = |cell| map.frame().world_from_cell(cell);
        Some(plan.line(map, centre(start), centre(goal)))
    };
    Ok((1..20 * paths).filter_map(line).take(paths).collect())
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Quantile; NaN without values.
fn quantile(values: &[f64], share: f64) -> f64 {
    Sample::new(values.to_vec()).map_or(f64::NAN, |sample| sample.quantile(share))
}

fn print_row(clearance_m: f64, radius_m: f64, tally: &mut Tally) {
    let Tally { corners, sharp, excess, peaks, .. } = tally;
    println!(
        "| {clearance_m} m | {radius_m} m | {corners} | {sharp} ({:.1} %) | {:.2} / {:.2} / {:.2} % | \
         {:.1} / {:.1} / {:.1} 1/m |",
        100.0 * *sharp as f64 / *corners as f64,
        100.0 * mean(excess),
        100.0 * quantile(excess, 0.95),
        100.0 * quantile(excess, 1.0),
        quantile(peaks, 0.5),
        quantile(peaks, 0.95),
        quantile(peaks, 1.0),
    );
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [paths, files @ ..] = &args[..] else {
        return Err("expected PATHS_PER_MAP MAP...".into());
    };
    let paths = paths.parse()?;
    let read = |file: &String| Ok(read_map(Path::new(file), None)?.grid);
    let grids: Vec<OccupancyGrid> =
        files.iter().map(read).collect::<Result<_, Box<dyn Error>>>()?;
    println!(
        "| clearance | smallest radius | corners | stay sharp | excess: mean / 95 % / worst | peak: median / 95 % / worst |"
    );
    println!("|---|---|---|---|---|---|");
    let curves = RADII_M.map(|min_turning_radius_m| {
        ContinuousCurvature::new(ContinuousCurvatureConfig { min_turning_radius_m })
    });
    let curves: Vec<_> = curves.into_iter().collect::<Result<_, _>>()?;
    let mut notes = Vec::new();
    for clearance_m in CLEARANCES_M {
        let mut tallies: [Tally; RADII_M.len()] = Default::default();
        for grid in &grids {
            let map = SearchMap::new(grid, LayerConfig { clearance_m, ..LayerConfig::default() })?;
            for line in lines(&map, paths)? {
                for (tally, curves) in tallies.iter_mut().zip(&curves) {
                    tally.add(&line, &map.clearance(), clearance_m, curves);
                }
            }
        }
        for (tally, radius_m) in tallies.iter_mut().zip(RADII_M) {
            print_row(clearance_m, radius_m, tally);
            notes.push(format!(
                "{clearance_m} m, radius {radius_m} m: {} paths; {} of {} sharp corners for the radius; before \
                 rounding {:.2} %, worst {:.1} %; least distance below the clearance {:?}",
                tally.excess.len(), tally.sharp_for_radius, tally.sharp,
                100.0 * mean(&tally.sight_excess), 100.0 * quantile(&tally.sight_excess, 1.0),
                tally.least_m
            ));
        }
    }
    println!("\n{}", notes.join("\n"));
    Ok(())
}
