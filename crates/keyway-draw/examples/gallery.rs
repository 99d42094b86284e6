//! Draws an invented room with all layers, and speed curves, into a folder:
//! `cargo run -p keyway-draw --example gallery -- pictures`

use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity};
use keyway::map::{BitGrid, Cell, CellState, GridFrame, OccupancyGrid};
use keyway::robot::Footprint;
use keyway_draw::layers::{
    CellTint, DrivenPath, Footprints, GoalMark, HatchedDiscs, PathLine, Points, StartMark,
};
use keyway_draw::{MapPicture, SpeedCurveOptions, SpeedSeries, Svg, speed_curve};
use keyway_sim::sim::TrajectoryPoint;
use std::error::Error;
use std::path::Path;

const RADIUS_M: f64 = 0.18;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("usage: gallery FOLDER")?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    save(folder, "room", &room(Pose::new(-1.0, -0.5, 0.0))?)?;
    save(folder, "room-rotated", &room(Pose::new(2.0, -1.0, 0.5))?)?;
    save(folder, "map-alone", &MapPicture::new(&room_map(Pose::default())?).svg())?;
    let run = drive(0.5);
    let limits = SpeedCurveOptions {
        v_max_mps: Some(0.55),
        omega_max_radps: Some(0.4),
        ..SpeedCurveOptions::default()
    };
    save(folder, "speed", &speed_curve(&[SpeedSeries { name: "run", points: &run }], &limits))?;
    let slow = drive(0.3);
    let both =
        [SpeedSeries { name: "fast", points: &run }, SpeedSeries { name: "slow", points: &slow }];
    let title = Some("Two runs through the same room".to_owned());
    save(folder, "speed-compared", &speed_curve(&both, &SpeedCurveOptions { title, ..limits }))?;
    Ok(())
}

fn save(folder: &Path, name: &str, picture: &Svg) -> Result<(), Box<dyn Error>> {
    std::fs::write(folder.join(format!("{name}.svg")), picture.as_str())?;
    std::fs::write(folder.join(format!("{name}.png")), picture.to_png(2.0)?)?;
    Ok(())
}

/// A room of 9 m x 6 m with a wall, a table and shelves; unknown beyond.
fn room_map(origin: Pose) -> Result<OccupancyGrid, Box<dyn Error>> {
    let frame = GridFrame::new(220, 160, 0.05, origin)?;
    Ok(OccupancyGrid::from_fn(frame, |cell| {
        let within = |x: std::ops::Range<i32>, y: std::ops::Range<i32>| {
            x.contains(&cell.x) && y.contains(&cell.y)
        };
        let shelves = [95, 118].iter().any(|&y| within(150..175, y..y + 6));
        if !within(18..202, 18..142) {
            CellState::Unknown
        } else if !within(20..200, 20..140)
            || within(85..88, 20..75)
            || within(85..88, 105..140)
            || within(40..60, 90..112)
            || shelves
        {
            CellState::Occupied
        } else {
            CellState::Free
        }
    }))
}

/// Draws all layers on a map.
fn room(origin: Pose) -> Result<Svg, Box<dyn Error>> {
    let map = room_map(origin)?;
    let frame = *map.frame();
    let to_world = |x: f64, y: f64| frame.world_from_grid(Point::new(x, y) * (1.0 / 0.05));
    let run: Vec<TrajectoryPoint> = drive(0.5)
        .into_iter()
        .map(|p| {
            let at = to_world(p.pose.x, p.pose.y);
            TrajectoryPoint { pose: Pose::new(at.x, at.y, p.pose.theta + origin.theta), ..p }
        })
        .collect();
    let corners = [(1.6, 1.6), (3.9, 3.9), (4.8, 4.5), (6.5, 4.5), (9.2, 1.8)];
    let planned = Polyline::new(corners.iter().map(|&(x, y)| to_world(x, y)).collect());
    let curve: Vec<Point> = route(200).iter().map(|&(x, y)| to_world(x, y)).collect();
    let smoothed = Polyline::new(curve.clone());
    let key_points: Vec<Point> = [40, 90, 130, 165].iter().map(|&i| curve[i]).collect();
    let discs = [
        Disc { centre: to_world(3.3, 2.5), radius_m: 0.3 },
        Disc { centre: to_world(7.25, 3.1), radius_m: 0.4 },
    ];
    let sensed = front_of(&discs, &frame, curve[90]);
    let blocked = inflate(&map, RADIUS_M);
    let (start, goal) = (curve[0], curve[curve.len() - 1]);
    let footprint = Footprint::circle(RADIUS_M)?;
    Ok(MapPicture::new(&map)
        .title("A room with two obstacles that the map does not show")
        .with(CellTint::blocked(&blocked))
        .with(CellTint::sensed(&sensed))
        .with(HatchedDiscs::unknown_obstacles(&discs))
        .with(PathLine::planned(&planned))
        .with(PathLine::smoothed(&smoothed))
        .with(Points::key_points(&key_points))
        .with(DrivenPath::new(&run))
        .with(Footprints::new(&run, &footprint))
        .with(StartMark(start))
        .with(GoalMark { point: goal, tolerance_m: Some(0.3) })
        .svg())
}

/// A smooth route through the room \[m from the map's corner\].
fn route(count: u32) -> Vec<(f64, f64)> {
    (0..=count)
        .map(|i| {
            let s = f64::from(i) / f64::from(count);
            (1.6 + 7.6 * s, 1.6 + 0.2 * s + 2.9 * (std::f64::consts::PI * s).sin().powf(0.8))
        })
        .collect()
}

/// A robot that deviates a little from the route, and is slower in turns.
fn drive(cruise: f64) -> Vec<TrajectoryPoint> {
    let way = route(400);
    let mut run: Vec<TrajectoryPoint> = Vec::new();
    let (mut t_s, mut before) = (0.0, None);
    for (i, pair) in way.windows(2).enumerate() {
        let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
        let (theta, step) = (dy.atan2(dx), dx.hypot(dy));
        let s = i as f64 / way.len() as f64;
        let ramp = (12.0 * s).min(12.0 * (1.0 - s)).min(1.0);
        let v = cruise * ramp * (0.7 + 0.3 * (9.0 * s).cos()).max(0.2) + 0.02;
        let omega = before.map_or(0.0, |before: f64| (theta - before) / (step / v));
        before = Some(theta);
        let off = 0.12 * (14.0 * s).sin();
        let pose = Pose::new(pair[0].0 - off * theta.sin(), pair[0].1 + off * theta.cos(), theta);
        run.push(TrajectoryPoint { t_s, pose, velocity: Velocity::new(v, omega) });
        t_s += step / v;
    }
    run
}

/// Cells on the near side of discs as seen from a point.
fn front_of(discs: &[Disc], frame: &GridFrame, eye: Point) -> BitGrid {
    let mut cells = BitGrid::new(frame.width(), frame.height(), false);
    for disc in discs {
        for i in -40..=40 {
            let angle = (eye - disc.centre).heading() + f64::from(i) * 0.03;
            let rim = disc.centre + Point::new(angle.cos(), angle.sin()) * disc.radius_m;
            if let Some(cell) = frame.cell_from_world(rim) {
                cells.set(cell, true);
            }
        }
    }
    cells
}

/// Cells within a radius of an occupied one, by brute force.
fn inflate(map: &OccupancyGrid, radius_m: f64) -> BitGrid {
    let frame = map.frame();
    let reach = (radius_m / frame.resolution_m()).ceil() as i32;
    let mut near = map.occupied().clone();
    for cell in frame.cells().filter(|&cell| map.occupied().get(cell)) {
        for dy in -reach..=reach {
            for dx in -reach..=reach {
                if dx * dx + dy * dy <= reach * reach {
                    near.set(Cell::new(cell.x + dx, cell.y + dy), true);
                }
            }
        }
    }
    near
}
