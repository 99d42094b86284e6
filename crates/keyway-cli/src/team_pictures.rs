//! Pictures of several robots in one world. Each has a colour, dashes and a number.

use crate::drive_pictures::{SIDE_PX, centiseconds};
use keyway::geometry::{Disc, Point, Polyline};
use keyway_draw::layers::{
    Caption, CellTint, ElusiveObstacles, Footprints, HatchedDiscs, Movers, NumberedEnds, PathLine,
    Polygons,
};
use keyway_draw::{
    Animation, DrawError, LineStyle, MapPicture, SpeedCurveOptions, SpeedSeries, Svg,
    animate_frames, series_style, speed_curve,
};
use keyway_sim::episode::{Episode, EpisodeRobot};
use keyway_sim::sim::{MovingObstacle, StandingPolygon, TrajectoryPoint};

/// A team and the trajectory of each of its robots; empty for a robot without a route.
#[derive(Clone, Copy)]
pub(crate) struct TeamPicture<'a> {
    pub(crate) team: &'a Episode,
    pub(crate) driven: &'a [Vec<TrajectoryPoint>],
    /// Moving obstacles, as they moved in the run.
    pub(crate) movers: &'a [MovingObstacle],
}

/// The robots at one moment, and their paths so far.
struct Shown<'a> {
    t_s: f64,
    ways: Vec<Polyline>,
    robots: Vec<[TrajectoryPoint; 1]>,
    /// Moving obstacles at that time.
    moving: Vec<Disc>,
    polygons: Vec<&'a [Point]>,
    ends: Vec<(Point, Point)>,
}

impl<'a> TeamPicture<'a> {
    /// Maximum number of animation frames.
    const MOST_FRAMES: usize = 120;

    fn shown(&self, t_s: f64, movers: &[MovingObstacle]) -> Shown<'a> {
        let Episode { robots, polygons, .. } = self.team;
        let until =
            |points: &&[TrajectoryPoint]| points.partition_point(|one| one.t_s <= t_s + 1e-9);
        let parts: Vec<&[TrajectoryPoint]> =
            self.driven.iter().map(Vec::as_slice).map(|all| &all[..until(&all)]).collect();
        let way = |part: &&[TrajectoryPoint]| {
            Polyline::new(part.iter().map(|one| one.pose.point()).collect())
        };
        Shown {
            t_s,
            ways: parts.iter().map(way).collect(),
            robots: parts.iter().filter_map(|part| Some([*part.last()?])).collect(),
            moving: movers.iter().map(|mover| mover.at(t_s)).collect(),
            polygons: polygons.iter().map(StandingPolygon::vertices).collect(),
            ends: robots.iter().map(|one| (one.start.position, one.goal.position)).collect(),
        }
    }

    /// The map with each robot's path so far, and the robot at the end of it.
    fn picture<'b>(&self, shown: &'b Shown<'b>) -> MapPicture<'b>
    where
        'a: 'b,
    {
        let Episode { known, robots, obstacles, hidden_cells, absent_cells, elusive, .. } =
            self.team;
        let mut picture = MapPicture::new(known)
            .with(HatchedDiscs::unknown_obstacles(obstacles))
            .with(HatchedDiscs::moving_obstacles(&shown.moving))
            .with(Polygons::unknown_obstacles(&shown.polygons))
            .with(CellTint::unknown_obstacles(hidden_cells))
            .with(CellTint::absent(absent_cells))
            .with(ElusiveObstacles::at(elusive, shown.t_s));
        for (index, way) in shown.ways.iter().enumerate() {
            let label = format!("robot {index}, {}", robots[index].stack_name);
            picture = picture.with(PathLine::new(way, label, style(index)).rimmed());
        }
        let at_end = self.driven.iter().enumerate().filter(|(_, driven)| !driven.is_empty());
        // The legend explains only the first robot: they differ in colour alone.
        let mut label = "robot";
        for ((index, _), robot) in at_end.zip(&shown.robots) {
            let outline = LineStyle { dashes: "", ..style(index) };
            let layer = Footprints::new(robot, &robots[index].robot.footprint);
            picture = picture.with(layer.looking(std::mem::take(&mut label), outline));
        }
        picture.with(NumberedEnds(&shown.ends))
    }

    fn end_s(&self) -> f64 {
        let ends_s = self.driven.iter().filter_map(|driven| Some(driven.last()?.t_s));
        ends_s.fold(0.0, f64::max)
    }

    /// Picture of the paths of all robots, with times along each path.
    pub(crate) fn svg(&self) -> Svg {
        // The moving obstacles have a layer of their own, with their paths.
        let shown = self.shown(self.end_s(), &[]);
        let runs = self.driven.iter().enumerate();
        let runs = runs.map(|(index, driven)| (driven.as_slice(), style(index).color)).collect();
        self.picture(&shown).with(Movers::among(self.movers, runs)).svg()
    }

    /// Speeds and turn rates of all robots. A limit is shown if it is the same for all.
    pub(crate) fn speed_svg(&self) -> Svg {
        let robots = &self.team.robots;
        let names: Vec<String> = (0..robots.len()).map(|index| format!("robot {index}")).collect();
        let series: Vec<SpeedSeries<'_>> = names
            .iter()
            .zip(self.driven)
            .map(|(name, points)| SpeedSeries { name, points })
            .collect();
        let shared = |limit: fn(&EpisodeRobot) -> f64| {
            let first = robots.first().map(limit);
            first.filter(|&first| robots.iter().all(|robot| limit(robot) == first))
        };
        let options = SpeedCurveOptions {
            v_max_mps: shared(|robot| robot.robot.limits.v_max_mps),
            omega_max_radps: shared(|robot| robot.robot.limits.omega_max_radps),
            ..SpeedCurveOptions::default()
        };
        speed_curve(&series, &options)
    }

    /// Animation of all runs. `progress` is called with the number of pictures drawn so far, and
    /// their total.
    pub(crate) fn animation(
        &self,
        progress: impl FnMut(usize, usize),
    ) -> Result<Animation, DrawError> {
        let end_s = self.end_s();
        let cycles = self.driven.iter().map(Vec::len).max().unwrap_or(0);
        let count = cycles.clamp(1, Self::MOST_FRAMES);
        let moments: Vec<Shown<'_>> = (0..count)
            .map(|frame| end_s * frame as f64 / count as f64)
            .chain([end_s])
            .map(|t_s| self.shown(t_s, self.movers))
            .collect();
        let frame = |index: usize| {
            let shown = &moments[index];
            let caption = Caption(format!("{:.1} s", shown.t_s));
            self.picture(shown).with(caption).side_px(SIDE_PX)
        };
        animate_frames(&frame(count), count, centiseconds(end_s, count), frame, progress)
    }
}

/// Line style of a robot.
fn style(index: usize) -> LineStyle {
    LineStyle { width_px: 2.0, ..series_style(index) }
}
