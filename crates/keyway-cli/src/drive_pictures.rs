//! Pictures of single moments of a drive: the candidates of one decision, and the whole run as an
//! animation.

use crate::commands::Moment;
use keyway::geometry::{Disc, Point, Polyline, Pose, Velocity};
use keyway::local::{Explanation, ScoredCandidate, Shares};
use keyway::map::{Cell, OccupancyGrid};
use keyway::robot::Robot;
use keyway_draw::layers::{
    Caption, CellTint, DrivenPath, ElusiveObstacles, EstimatedMovers, Fan, Footprints, GoalMark,
    HatchedDiscs, Hits, PathLine, Points, Polygons, Sensors, StartMark, WalkedGround,
};
use keyway_draw::{
    Animation, DrawError, LineStyle, MapPicture, Region, Rgb, Svg, TextTable, animate_frames,
};
use keyway_sim::sim::{ElusiveObstacle, MovingObstacle, StandingPolygon, TrajectoryPoint};
use std::borrow::Cow;

const INK: Rgb = Rgb(0x22, 0x22, 0x22);
const BLUE: Rgb = Rgb(0x00, 0x72, 0xb2);
/// The robot at its current pose.
const ROBOT: LineStyle = LineStyle { color: INK, width_px: 1.8, dashes: "" };
/// The robot at the end of the chosen candidate.
const AFTER: LineStyle = LineStyle { color: INK, width_px: 1.0, dashes: "3 2" };
const TOWARDS: LineStyle = LineStyle { color: BLUE, width_px: 1.0, dashes: "2 3" };
const GUIDE: LineStyle = LineStyle { color: BLUE, width_px: 2.0, dashes: "" };

/// Data shared by all moments of a run.
#[derive(Clone, Copy)]
pub(crate) struct Stage<'a> {
    pub(crate) map: &'a OccupancyGrid,
    pub(crate) robot: &'a Robot,
    /// Static obstacles.
    pub(crate) obstacles: &'a [Disc],
    pub(crate) polygons: &'a [StandingPolygon],
    pub(crate) hidden_cells: &'a [Cell],
    pub(crate) absent_cells: &'a [Cell],
    pub(crate) elusive: &'a [ElusiveObstacle],
    pub(crate) movers: &'a [MovingObstacle],
    pub(crate) start: Point,
    pub(crate) goal: Point,
    pub(crate) tolerance_m: f64,
}

/// One moment, as drawable layers.
struct Shown<'a> {
    moment: &'a Moment,
    robot: [TrajectoryPoint; 1],
    guide: Vec<Point>,
    towards: Polyline,
    discs: Vec<Disc>,
    /// Moving obstacles at that time.
    moving: Vec<Disc>,
    polygons: Vec<&'a [Point]>,
    /// Trajectory driven before that time.
    driven: &'a [TrajectoryPoint],
}

impl<'a> Stage<'a> {
    fn shown(&self, moment: &'a Moment, driven: &'a [TrajectoryPoint]) -> Shown<'a> {
        let Moment { t_s, pose, velocity, guide, .. } = *moment;
        let until = driven.partition_point(|point| point.t_s <= t_s + 1e-9);
        Shown {
            moment,
            robot: [TrajectoryPoint { t_s, pose, velocity }],
            guide: vec![guide],
            towards: Polyline::new(vec![pose.point(), guide]),
            discs: self.obstacles.to_vec(),
            moving: self.movers.iter().map(|mover| mover.at(t_s)).collect(),
            polygons: self.polygons.iter().map(StandingPolygon::vertices).collect(),
            driven: &driven[..until],
        }
    }

    /// The layers that both kinds of pictures share.
    fn picture<'b>(&self, shown: &'b Shown<'_>) -> MapPicture<'b>
    where
        'a: 'b,
    {
        let footprint = &self.robot.footprint;
        MapPicture::new(self.map)
            .with(HatchedDiscs::unknown_obstacles(&shown.discs))
            .with(HatchedDiscs::moving_obstacles(&shown.moving))
            .with(Polygons::unknown_obstacles(&shown.polygons))
            .with(CellTint::unknown_obstacles(self.hidden_cells))
            .with(CellTint::absent(self.absent_cells))
            .with(ElusiveObstacles::at(self.elusive, shown.moment.t_s))
            .with(CellTint::sensed_list(&shown.moment.sensed))
            .with(WalkedGround(&shown.moment.walked))
            .with(PathLine::smoothed(&shown.moment.route).label("route"))
            .with(EstimatedMovers(&shown.moment.movers))
            .with(Hits(&shown.moment.hits))
            .with(PathLine::new(&shown.towards, "to the guide point", TOWARDS))
            .with(Points::new(&shown.guide, "guide point", GUIDE))
            .with(Footprints::new(&shown.robot, footprint).looking("robot", ROBOT))
            .with(Sensors::new(shown.robot[0].pose, &self.robot.sensors))
    }

    fn goal_layer(&self) -> GoalMark {
        GoalMark { point: self.goal, tolerance_m: Some(self.tolerance_m) }
    }

    /// Picture of the candidates of one decision. The legend explains only what is in view.
    pub(crate) fn fan_svg(&self, moment: &Moment) -> Svg {
        let (low, high) = self.around(moment);
        let is_seen = |point: Point, radius_m: f64| {
            let nearest = Point::new(point.x.clamp(low.x, high.x), point.y.clamp(low.y, high.y));
            nearest.distance(point) <= radius_m
        };
        let hits = moment.hits.iter().copied().filter(|&hit| is_seen(hit, 0.0)).collect();
        let walked = moment.walked.iter().copied();
        let walked = walked.filter(|disc| is_seen(disc.centre, disc.radius_m)).collect();
        let moment = &Moment { hits, walked, ..moment.clone() };
        let mut shown = self.shown(moment, &[]);
        for discs in [&mut shown.discs, &mut shown.moving] {
            discs.retain(|disc| is_seen(disc.centre, disc.radius_m));
        }
        shown.guide.retain(|&guide| is_seen(guide, 0.0));
        let explanation = &moment.explanation;
        let after: Vec<TrajectoryPoint> = explanation
            .chosen
            .and_then(|chosen| explanation.candidates[chosen].poses.last())
            .map(|&pose| TrajectoryPoint { pose, ..shown.robot[0] })
            .into_iter()
            .collect();
        let end = Footprints::new(&after, &self.robot.footprint)
            .looking("robot after the chosen candidate", AFTER);
        let mut picture = self.picture(&shown);
        if is_seen(self.goal, self.tolerance_m) {
            picture = picture.with(self.goal_layer());
        }
        picture
            .with(Fan::new(moment.pose, explanation))
            .with(end)
            .region(Region::Window(low, high))
            .title(fan_title(moment))
            .table(fan_table(explanation))
            .svg()
    }

    /// Corners of a square around the robot and its candidates.
    fn around(&self, moment: &Moment) -> (Point, Point) {
        let poses = moment.explanation.candidates.iter().flat_map(|one| &one.poses);
        let points = poses.map(Pose::point).chain([moment.pose.point()]);
        let (low, high) = corners(points);
        let (middle, size) = (low.lerp(high, 0.5), high - low);
        let room_m = 2.5 * self.robot.footprint.circumscribed_radius_m().max(0.1);
        let half_m = 0.5 * size.x.max(size.y) + room_m;
        let half = Point::new(half_m, half_m);
        (middle - half, middle + half)
    }

    /// Animation of the whole run. `progress` is called with the number of pictures drawn so far,
    /// and their total.
    pub(crate) fn animation(
        &self,
        moments: &[Moment],
        driven: &[TrajectoryPoint],
        progress: impl FnMut(usize, usize),
    ) -> Result<Animation, DrawError> {
        let run_s = driven.last().map_or(0.0, |point| point.t_s);
        let centiseconds = centiseconds(run_s, moments.len());
        let region = self.whole(moments, driven);
        let v_max_mps = self.robot.limits.v_max_mps;
        let shown: Vec<Shown<'_>> = moments.iter().map(|one| self.shown(one, driven)).collect();
        let frame = |shown| {
            let Shown { moment, driven, .. }: &Shown<'_> = shown;
            let speed_mps = moment.velocity.v;
            self.picture(shown)
                .with(StartMark(self.start))
                .with(self.goal_layer())
                .with(Fan::new(moment.pose, &moment.explanation).pale())
                .with(DrivenPath::new(driven).v_max_mps(v_max_mps))
                .with(Caption(format!("{:.1} s, {speed_mps:.2} m/s", moment.t_s)))
                .region(region)
                .side_px(SIDE_PX)
        };
        // The end of the run, with the scan and estimates of the last moment before it.
        let last = moments.last().zip(driven.last()).map(|(moment, end)| Moment {
            t_s: end.t_s,
            pose: end.pose,
            velocity: end.velocity,
            explanation: Explanation::default(),
            ..moment.clone()
        });
        let last = last.as_ref().map(|moment| self.shown(moment, driven));
        let still = match &last {
            Some(last) => frame(last),
            None => MapPicture::new(self.map),
        };
        animate_frames(&still, shown.len(), centiseconds, |i| frame(&shown[i]), progress)
    }

    /// The part of the map that the run covers, with a margin.
    fn whole(&self, moments: &[Moment], driven: &[TrajectoryPoint]) -> Region {
        let routes = moments.iter().flat_map(|moment| moment.route.points()).copied();
        let points = routes.chain(driven.iter().map(|point| point.pose.point()));
        let (low, high) = corners(points.chain([self.start, self.goal]));
        let (middle, size) = (low.lerp(high, 0.5), high - low);
        let room_m = 4.0 * self.robot.footprint.circumscribed_radius_m().max(0.1);
        // A drive along a corridor gets a margin beside it.
        let half_m = |side_m: f64| 0.5 * side_m.max(0.5 * size.x.max(size.y)) + room_m;
        let half = Point::new(half_m(size.x), half_m(size.y));
        Region::Window(middle - half, middle + half)
    }
}

/// Longer side of an animation's plot \[px\]: large enough to show a robot in a house.
pub(crate) const SIDE_PX: f64 = 800.0;
/// Longest playing time of an animation \[s\]; shorter runs are played in real time.
const PLAY_S: f64 = 10.0;
/// Shortest display time of a picture \[1/100 s\]; many viewers do not support shorter ones.
const SHORTEST_FRAME_CS: f64 = 4.0;

/// Display time of each picture of a run \[1/100 s\].
pub(crate) fn centiseconds(run_s: f64, pictures: usize) -> u16 {
    let each_s = run_s.min(PLAY_S) / pictures.max(1) as f64;
    (100.0 * each_s).round().max(SHORTEST_FRAME_CS) as u16
}

/// Lower left and upper right corner of the smallest rectangle around points.
fn corners(points: impl Iterator<Item = Point>) -> (Point, Point) {
    let both = points.map(|point| (point, point)).reduce(|(low, high), (point, _)| {
        let low = Point::new(low.x.min(point.x), low.y.min(point.y));
        (low, Point::new(high.x.max(point.x), high.y.max(point.y)))
    });
    both.unwrap_or_default()
}

fn fan_title(moment: &Moment) -> String {
    let candidates = &moment.explanation.candidates;
    if candidates.is_empty() {
        return format!("{:.1} s: no candidates", moment.t_s);
    }
    let admissible = candidates.iter().filter(|one| one.score().is_some()).count();
    let all = candidates.len();
    format!("{:.1} s: {all} velocities tried, {admissible} admissible", moment.t_s)
}

/// Formats a number with a fixed number of decimals; a value that rounds to 0 has no sign.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|byte| matches!(byte, b'0' | b'.')) => rest.to_owned(),
        _ => text,
    }
}

/// Cost shares of the best two candidates; if none is admissible, the remedies.
fn fan_table(explanation: &Explanation) -> TextTable {
    let best = [("chosen", explanation.chosen()), ("second best", explanation.runner_up())];
    let best: Vec<_> = best.into_iter().filter_map(|(name, it)| Some((name, it?))).collect();
    let mut table = TextTable::new();
    if let Some((_, ScoredCandidate { shares: first, .. })) = best.first() {
        let row = |head: &str, cells: &dyn Fn(&Shares) -> [String; 2]| {
            let cells = best.iter().flat_map(|(_, one)| cells(one.shares));
            std::iter::once(head.to_owned()).chain(cells).collect::<Vec<_>>()
        };
        let head = best.iter().flat_map(|(name, _)| [*name, "share"]);
        table = table.row(std::iter::once("").chain(head));
        let speeds = |head: &str, value: &dyn Fn(Velocity) -> f64| {
            let cells =
                best.iter().flat_map(|(_, one)| [fixed(value(one.velocity), 3), String::new()]);
            std::iter::once(head.to_owned()).chain(cells).collect::<Vec<_>>()
        };
        table = table.row(speeds("candidate's speed [m/s]", &|velocity| velocity.v));
        table = table.row(speeds("candidate's turn rate [rad/s]", &|velocity| velocity.omega));
        for share in first.as_slice() {
            let cells = |shares: &Shares| {
                let share = shares.term(&share.term);
                let number = |value: Option<f64>, digits| {
                    value.map_or_else(String::new, |value| fixed(value, digits))
                };
                let (raw, weighted) =
                    (share.map(|share| share.raw), share.map(|share| share.weighted));
                [number(raw, 3), number(weighted, 6)]
            };
            table = table.row(row(&format!("term: {}", share.term), &cells));
        }
        table = table.row(row("score", &|shares| [String::new(), fixed(shares.total(), 6)]));
    }
    if !explanation.remedies.is_empty() {
        table = table
            .row([Cow::Borrowed("Every candidate is blocked; remedies tried, in this order:")]);
    }
    for remedy in &explanation.remedies {
        table = table.row([Cow::Owned(remedy.to_string())]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_rounded_to_0_has_no_sign() {
        let texts = [-0.0, -4e-7, -6e-7, 0.0, -1.0].map(|value| fixed(value, 6));
        assert_eq!(texts, ["0.000000", "0.000000", "-0.000001", "0.000000", "-1.000000"]);
    }

    #[test]
    fn long_runs_are_played_in_ten_seconds_and_short_ones_as_they_were() {
        // 60 s in 120 pictures: 10 s. 3 s in 30 pictures: 3 s.
        assert_eq!((centiseconds(60.0, 120), centiseconds(3.0, 30)), (8, 10));
        assert_eq!((centiseconds(0.1, 120), centiseconds(0.0, 0)), (4, 4));
    }
}
