//! Pictures of plans and runs.

use crate::drive_pictures::Stage;
use crate::error::{CliError, Kind};
use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity};
use keyway::map::{BitGrid, GridFrame, OccupancyGrid};
use keyway::robot::Robot;
use keyway::search::Recording;
use keyway_draw::layers::{
    CellTint, DrivenPath, ElusiveObstacles, EndMark, Footprints, GoalMark, HatchedDiscs, Meeting,
    Movers, OtherGoals, PathLine, Points, Polygons, SearchNodes, SearchTrace, StartMark,
    WalkedGround,
};
use keyway_draw::{
    LineStyle, MapPicture, Rgb, SERIES, SpeedCurveOptions, SpeedSeries, Svg, speed_curve,
};
use keyway_sim::sim::{StandingPolygon, TrajectoryPoint};

/// PNG pixels per unit of the picture.
pub(crate) const PNG_SCALE: f64 = 2.0;

/// A map, the search for a path on it, and the path.
pub(crate) struct PlanPicture<'a> {
    pub(crate) map: &'a OccupancyGrid,
    /// Cells that the search must not enter.
    pub(crate) blocked: &'a BitGrid,
    pub(crate) start: Point,
    pub(crate) goals: &'a PlanGoals,
    pub(crate) search: &'a Recording,
    pub(crate) line: Option<&'a Polyline>,
    pub(crate) smoothed: Option<&'a Polyline>,
}

/// The goals of a plan that are on the map.
pub(crate) struct PlanGoals {
    /// The goal that the path leads to, or the only goal.
    main: Option<Point>,
    others: Vec<Point>,
}

impl PlanGoals {
    /// Splits the goals. `nearest` is the goal that the path leads to, if one was found.
    pub(crate) fn new(all: &[Point], nearest: usize, is_found: bool, frame: &GridFrame) -> Self {
        let main = Some(all[nearest]).filter(|_| is_found || all.len() == 1);
        // The other goals may be far outside the map.
        let is_shown = |i: &usize| frame.cell_from_world(all[*i]).is_some();
        let others = (0..all.len()).filter(|&i| main.is_none() || i != nearest).filter(is_shown);
        Self { main, others: others.map(|i| all[i]).collect() }
    }
}

/// Line styles that stand out from the colours of a search.
const PLANNED: LineStyle = LineStyle { color: Rgb(0x22, 0x22, 0x22), width_px: 1.4, dashes: "" };
const SMOOTHED: LineStyle = LineStyle { color: SERIES[2], width_px: 1.8, dashes: "" };
/// Colour of free cells with too little clearance for the robot: a grey that no search uses.
const TOO_CLOSE: Rgb = Rgb(0xea, 0xe8, 0xe4);

impl<'a> PlanPicture<'a> {
    /// Picture of the search and its result.
    pub(crate) fn still(&self) -> MapPicture<'a> {
        let mut picture = self.frame(SearchTrace::new(self.search));
        if let Some(line) = self.line {
            picture = picture.with(PathLine::new(line, "planned path", PLANNED).rimmed());
        }
        if let Some(line) = self.smoothed {
            picture = picture.with(PathLine::new(line, "smoothed path", SMOOTHED).rimmed());
        }
        picture
    }

    /// Picture of the search up to some step.
    pub(crate) fn frame(&self, trace: SearchTrace<'a>) -> MapPicture<'a> {
        let picture = MapPicture::new(self.map)
            .with(CellTint::blocked(self.blocked).color(TOO_CLOSE))
            .with(trace)
            .with(SearchNodes(trace))
            .with(Meeting(trace))
            .with(StartMark(self.start));
        let PlanGoals { main, others } = self.goals;
        let label = if main.is_some() { "other goal" } else { "goal without a path" };
        let picture = picture.with(OtherGoals::new(others).label(label));
        match *main {
            Some(point) => picture.with(GoalMark { point, tolerance_m: None }),
            None => picture,
        }
    }
}

/// A map, a route and the trajectory driven along it; without a run, start and goal only.
pub(crate) struct RunPicture<'a> {
    pub(crate) stage: Stage<'a>,
    pub(crate) driven: Option<DrivenPicture<'a>>,
}

/// The layers that only a completed run has.
pub(crate) struct DrivenPicture<'a> {
    pub(crate) line: &'a Polyline,
    pub(crate) smoothed: &'a Polyline,
    pub(crate) key_points: &'a [Point],
    pub(crate) sensed: &'a BitGrid,
    /// Obstacles that the robot detoured around.
    pub(crate) walked: &'a [Disc],
    pub(crate) points: &'a [TrajectoryPoint],
    /// Number of routes that the robot searched.
    pub(crate) routes: u32,
    /// Reason why the run ended before its goal; `None` if it was reached.
    pub(crate) ended_by: Option<&'static str>,
}

impl RunPicture<'_> {
    pub(crate) fn svg(&self) -> Svg {
        let Stage { map, robot, obstacles, polygons, hidden_cells, .. } = self.stage;
        let Stage { absent_cells, elusive, movers, start, goal, tolerance_m, .. } = self.stage;
        let polygons: Vec<&[Point]> = polygons.iter().map(StandingPolygon::vertices).collect();
        let goal = GoalMark { point: goal, tolerance_m: Some(tolerance_m) };
        let points = self.driven.as_ref().map_or(&[][..], |driven| driven.points);
        let mut picture = MapPicture::new(map)
            .with(HatchedDiscs::unknown_obstacles(obstacles))
            .with(Polygons::unknown_obstacles(&polygons))
            .with(CellTint::unknown_obstacles(hidden_cells))
            .with(CellTint::absent(absent_cells))
            .with(ElusiveObstacles::new(elusive))
            .with(Movers::new(movers, points))
            .with(StartMark(start))
            .with(goal);
        if let Some(driven) = &self.driven {
            // Later routes are not drawn; the reader should know that there were some.
            let label = |name: &str| match driven.routes {
                0 | 1 => name.to_owned(),
                all => format!("{name}, first of {all}"),
            };
            picture = picture
                .with(CellTint::sensed(driven.sensed))
                .with(WalkedGround(driven.walked))
                .with(PathLine::planned(driven.line).label(label("planned path")))
                .with(Points::key_points(driven.key_points))
                .with(DrivenPath::new(driven.points).v_max_mps(robot.limits.v_max_mps))
                .with(
                    PathLine::smoothed(driven.smoothed).label(label("smoothed path")).over_driven(),
                )
                .with(Footprints::new(driven.points, &robot.footprint));
            if let (Some(label), Some(end)) = (driven.ended_by, driven.points.last()) {
                picture = picture.with(EndMark { point: end.pose.point(), label });
            }
        }
        picture.svg()
    }
}

/// Chart of speed and turn rate of a run over time.
pub(crate) fn speed_svg(name: &str, points: &[TrajectoryPoint], robot: &Robot) -> Svg {
    let options = SpeedCurveOptions {
        v_max_mps: Some(robot.limits.v_max_mps),
        omega_max_radps: Some(robot.limits.omega_max_radps),
        ..SpeedCurveOptions::default()
    };
    speed_curve(&[SpeedSeries { name, points }], &options)
}

/// Converts a row of the report into a trajectory point.
pub(crate) fn trajectory_point(&[t_s, x, y, yaw_rad, v, omega]: &[f64; 6]) -> TrajectoryPoint {
    TrajectoryPoint { t_s, pose: Pose::new(x, y, yaw_rad), velocity: Velocity::new(v, omega) }
}

pub(crate) fn png(svg: &Svg) -> Result<Vec<u8>, CliError> {
    svg.to_png(PNG_SCALE).map_err(|error| CliError::new(Kind::Output, error))
}
