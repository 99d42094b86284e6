//! CPU times of the control cycles of scenes.
//!
//! `cargo run --release -p keyway-lab --example cycle_times -- FOLDER` drives the scenes of a
//! folder, one after the other, and prints the time per cycle of the first robot: sensing
//! (`Navigator::observe`) and deciding (`Navigator::step`), in CPU time of its thread. The
//! simulation is not counted.

use cpu_time::ThreadTime;
use keyway::geometry::{Point, Pose};
use keyway::navigate::{Navigator, Step};
use keyway::sense::Observation;
use keyway_sim::episode::Episode;
use keyway_sim::metrics::statistics::Sample;
use keyway_sim::sim::{Action, Control, RobotState, Stepper};
use std::error::Error;

#[path = "support/scene.rs"]
mod scene;

/// Measures the CPU time of each cycle of a run \[ms\].
fn cycles(episode: &Episode) -> Result<Vec<f64>, Box<dyn Error>> {
    let robot = &episode.robots[0];
    let mut world: Stepper = episode.stepper()?;
    let mut navigator = Navigator::new(&episode.known, &robot.stack.fit(&robot.robot)?)?;
    let Point { x, y } = robot.start.position;
    navigator.relocate(Pose::new(x, y, 0.0));
    navigator.set_goal(robot.goal)?;
    let mut times = Vec::new();
    while world.outcome().is_none() {
        let RobotState { stamp_s, pose, velocity } = world.told();
        let scans = world.scans();
        let began = ThreadTime::now();
        navigator.observe(&Observation::new(stamp_s, pose, velocity, &scans));
        let step = navigator.step();
        times.push(1000.0 * began.elapsed().as_secs_f64());
        let action = match step {
            Step::Arrived => Action::Arrived,
            step => Action::Drive(step.command()),
        };
        let remaining_m = navigator.guidance().map_or(f64::INFINITY, |it| it.remaining_m);
        let (turn_left_rad, route) = (navigator.turn_left_rad(), navigator.ways_taken());
        world.step(&Control { action, remaining_m, turn_left_rad, route })?;
    }
    Ok(times)
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("the folder of the scenes is missing")?;
    let mut all = Vec::new();
    println!("| scene | cycles | mean (ms) | 99 % | worst |\n|---|--:|--:|--:|--:|");
    for path in scene::paths(&folder)? {
        let times = cycles(&scene::episode(&path)?)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        println!("{}", row(&name, &times)?);
        all.extend(times);
    }
    println!("{}", row("all", &all)?);
    Ok(())
}

/// A row of the table.
fn row(name: &str, times: &[f64]) -> Result<String, Box<dyn Error>> {
    let sample = Sample::new(times.to_vec())?;
    let [late, worst] = [0.99, 1.0].map(|share| sample.quantile(share));
    let (count, mean) = (times.len(), sample.mean());
    Ok(format!("| {name} | {count} | {mean:.2} | {late:.2} | {worst:.2} |"))
}
