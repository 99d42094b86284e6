//! Scenes with changing goals, and with a door that closes and opens on the map.
//!
//! `cargo run --release -p keyway-lab --example changing_goals -- FOLDER [doors]`
//! drives the scenes of a folder. In each, the robot gets another goal every 3 s, five times:
//! reachable positions, drawn from the scene's number, and at last the goal of the scene. From
//! the last change on, it should take no more than 1.1 times as long as a run that begins there.
//! With `doors` the goal stays the same; after 3 s the map is updated to block the middle of the
//! route ahead, and after 9 s to open it again.

use keyway::geometry::{Point, Pose};
use keyway::map::{Cell, CellState, CellWindow, Edit};
use keyway::navigate::{Goal, Navigator, Step};
use keyway_sim::episode::{Episode, EpisodeOutcome, Start, run_episode};
use keyway_sim::sim::{Action, Control, Outcome, RobotState, Stepper};
use std::error::Error;

#[path = "support/scene.rs"]
mod scene;

/// Time between two changes \[s\].
const EVERY_S: f64 = 3.0;
const CHANGES: u32 = 5;

/// Outcome of a run, its time, and that of the reference run \[s\].
struct Measured {
    outcome: Outcome,
    took_s: f64,
    fresh_s: Option<f64>,
}

/// A robot in its world.
struct Drive {
    world: Stepper,
    navigator: Navigator,
    changes: u32,
}

impl Drive {
    fn new(episode: &Episode) -> Result<Self, Box<dyn Error>> {
        let robot = &episode.robots[0];
        let mut navigator = Navigator::new(&episode.known, &robot.stack.fit(&robot.robot)?)?;
        let Point { x, y } = robot.start.position;
        navigator.relocate(Pose::new(x, y, 0.0));
        navigator.set_goal(robot.goal)?;
        Ok(Self { world: episode.stepper()?, navigator, changes: 0 })
    }

    fn state(&self) -> RobotState {
        self.world.told()
    }

    /// Runs one cycle, and returns the outcome once the run has ended.
    fn cycle(&mut self) -> Result<Option<Outcome>, Box<dyn Error>> {
        let RobotState { stamp_s, pose, velocity } = self.world.told();
        let scans = self.world.scans();
        let observation = keyway::sense::Observation::new(stamp_s, pose, velocity, &scans);
        self.navigator.observe(&observation);
        let action = match self.navigator.step() {
            // The robot has stopped at a goal that is not the last one.
            Step::Arrived if self.changes < CHANGES => Action::Stop,
            Step::Arrived => Action::Arrived,
            step => Action::Drive(step.command()),
        };
        let guidance = self.navigator.guidance();
        let remaining_m = guidance.map_or(f64::INFINITY, |guidance| guidance.remaining_m);
        let route = self.navigator.ways_taken() + 1000 * self.changes;
        let turn_left_rad = self.navigator.turn_left_rad();
        self.world.step(&Control { action, remaining_m, turn_left_rad, route })?;
        Ok(self.world.outcome())
    }

    /// Drives until a time \[s\].
    fn until(&mut self, end_s: f64) -> Result<Option<Outcome>, Box<dyn Error>> {
        while self.state().stamp_s < end_s - 1e-9 {
            if let Some(outcome) = self.cycle()? {
                return Ok(Some(outcome));
            }
        }
        Ok(None)
    }

    fn finish(&mut self) -> Result<Outcome, Box<dyn Error>> {
        loop {
            if let Some(outcome) = self.cycle()? {
                return Ok(outcome);
            }
        }
    }

    /// Returns a reachable position, drawn by a number.
    fn any_place(&mut self, number: u64) -> Option<Point> {
        let frame = *self.navigator.map().frame();
        let share = |n: u64| (n >> 11) as f64 / (1u64 << 53) as f64;
        // The mixing of SplitMix64.
        let mixed = |n: u64| {
            let n = n.wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let n = (n ^ (n >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let n = (n ^ (n >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            n ^ (n >> 31)
        };
        let cell = Cell::new(
            (share(mixed(2 * number + 1)) * f64::from(frame.width())) as i32,
            (share(mixed(2 * number + 2)) * f64::from(frame.height())) as i32,
        );
        let from = self.state().pose.point();
        self.navigator.nearest_reachable(from, frame.world_from_cell(cell))
    }
}

/// Measures the time from the last change on, and that of a run from there \[s\]; `None` if the
/// run ended before it.
fn changing(episode: &Episode, number: u64) -> Result<Option<Measured>, Box<dyn Error>> {
    let mut drive = Drive::new(episode)?;
    let last: Goal = episode.robots[0].goal;
    for change in 1..=CHANGES {
        if let Some(outcome) = drive.until(EVERY_S * f64::from(change))? {
            let (took_s, fresh_s) = (0.0, None);
            let has_collided = matches!(outcome, Outcome::Collided { .. });
            return Ok(has_collided.then_some(Measured { outcome, took_s, fresh_s }));
        }
        drive.changes = change;
        if change == CHANGES {
            drive.navigator.set_goal(last)?;
        } else if let Some(place) = drive.any_place(number * 100 + u64::from(change)) {
            // A robot that waits for clearance keeps its goal.
            drop(drive.navigator.set_goal(place));
        }
    }
    let RobotState { stamp_s, pose, .. } = drive.state();
    let outcome = drive.finish()?;
    let took_s = drive.state().stamp_s - stamp_s;
    let mut fresh = episode.clone();
    fresh.robots[0].start = Start { position: pose.point(), heading_rad: Some(pose.theta) };
    let report = run_episode(&fresh).map(keyway_sim::episode::EpisodeReport::first);
    let reached = report.ok().filter(|report| report.outcome == EpisodeOutcome::Reached);
    let fresh_s = reached.and_then(|report| Some(report.run?.time_s));
    Ok(Some(Measured { outcome, took_s, fresh_s }))
}

/// Measures a run whose map loses and gains a door \[s\], and one without.
fn doors(episode: &Episode) -> Result<Option<Measured>, Box<dyn Error>> {
    let report = run_episode(episode).map(keyway_sim::episode::EpisodeReport::first)?;
    let fresh_s = report.run.map(|run| run.time_s);
    let mut drive = Drive::new(episode)?;
    drive.changes = CHANGES;
    if drive.until(EVERY_S)?.is_some() {
        return Ok(None);
    }
    let route = drive.navigator.route().ok_or("it has a goal")?.smoothed.points().to_vec();
    let length_m: f64 = route.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
    let (mut left_m, mut place) = (0.5 * length_m, route[0]);
    for pair in route.windows(2) {
        let step_m = pair[0].distance(pair[1]);
        if left_m <= step_m && step_m > 0.0 {
            place = pair[0].lerp(pair[1], left_m / step_m);
            break;
        }
        left_m -= step_m;
    }
    let map = drive.navigator.map();
    let frame = *map.frame();
    let near = |cell: &Cell| frame.world_from_cell(*cell).distance(place) < 0.5;
    let cells: Vec<Cell> = CellWindow::around(&frame, place, 0.5).cells().filter(near).collect();
    let before: Vec<Edit> =
        cells.iter().filter_map(|&cell| Some(Edit { cell, state: map.state(cell)? })).collect();
    let closed: Vec<Edit> =
        cells.iter().map(|&cell| Edit { cell, state: CellState::Occupied }).collect();
    drive.navigator.edit_map(&closed);
    if let Some(outcome) = drive.until(3.0 * EVERY_S)? {
        let took_s = drive.state().stamp_s;
        return Ok(Some(Measured { outcome, took_s, fresh_s }));
    }
    drive.navigator.edit_map(&before);
    let outcome = drive.finish()?;
    let took_s = drive.state().stamp_s;
    Ok(Some(Measured { outcome, took_s, fresh_s }))
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = arguments.first().ok_or("the folder of the scenes is missing")?;
    let has_doors = arguments.get(1).is_some_and(|what| what == "doors");
    let paths = scene::paths(folder)?;
    let (mut runs, mut reached, mut collided, mut early) = (0, 0, 0, 0);
    let mut ratios = Vec::new();
    for (number, path) in paths.iter().enumerate() {
        let mut episode = scene::episode(path)?;
        episode.rules.time_limit_s = Some(300.0);
        let measured =
            if has_doors { doors(&episode)? } else { changing(&episode, number as u64)? };
        let Some(Measured { outcome, took_s, fresh_s }) = measured else {
            early += 1;
            continue;
        };
        runs += 1;
        reached += u32::from(outcome == Outcome::Reached);
        collided += u32::from(matches!(outcome, Outcome::Collided { .. }));
        if outcome != Outcome::Reached {
            println!("{}: {outcome:?} after {took_s:.1} s", path.display());
        } else if let Some(fresh_s) = fresh_s {
            ratios.push(took_s / fresh_s);
            if took_s > 1.5 * fresh_s {
                println!("{}: {took_s:.1} s, a run from there {fresh_s:.1} s", path.display());
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    let worst = ratios.last().copied().unwrap_or(f64::NAN);
    let above = ratios.iter().filter(|ratio| **ratio > 1.1).count();
    println!(
        "{runs} runs ({early} ended before): {reached} reached, {collided} collided; times by those of fresh runs: mean {mean:.3}, worst {worst:.2}, above 1.1: {above} of {}",
        ratios.len()
    );
    Ok(())
}
