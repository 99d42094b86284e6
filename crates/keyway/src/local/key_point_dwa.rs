//! Key-point DWA: a dynamic window approach that heads for the key points of the route, and
//! weights speed less the more obstacles are ahead.
//!
//! # Source
//! \[You2021\]: equations (11) and (12), tables 2 and 3, and the weights of its fused runs. The
//! key points come from [`KeyPoints`](crate::guide::KeyPoints); equations (4) to (8) and (10) are
//! those of [`WindowConfig`].
//!
//! | paper | here | unit | fused runs |
//! |---|---|---|---|
//! | alpha | `weights.key_point`, of key(v, omega): the heading towards the key point | | 0.15 |
//! | beta | `weights.distance`, of dist(v, omega) | | 0.1 |
//! | `gamma_max` | `speed_weight.largest`, of vel(v, omega) | | 0.3 |
//! | l1, l2 | `speed_weight.high_risk`, `speed_weight.low_risk` | | 1, 0.5 |
//! | c, d | obstacles in the high-risk and in the low-risk region | | |
//! | gamma(c, d) = `gamma_max` / (l1 c + l2 d + 1/2) | [`SpeedWeight::at`] | | |
//!
//! # Where this differs from the paper
//! - The paper draws the regions but does not describe them. Here they are two half-discs ahead
//!   of the robot: up to `high_risk_m`, and from there to `low_risk_m`.
//! - The number of obstacles is the occupied area in a region over `obstacle_area_m2`: 1 m²
//!   counts the cells of the paper's grid. A cell is in a region if its centre is.
//! - gamma is never above `gamma_max`: by the equation as printed, 0.1 m² would increase the
//!   weight beyond that of open ground.
//!
//! # Errors / cost
//! See [`WindowConfig`]. In addition, the occupied cells of the regions are counted once in each
//! cycle.

use super::dynamic_window::{DynamicWindow, Rollout, Term, TermValue, Weighing};
use super::parameters::{BoxedLocalPlanner, LocalParameters};
use super::terms::{distance, speed};
use super::{
    Decision, DriveMemory, Explanation, LocalPlanner, NoCommand, Scene, Scratch, WindowConfig,
};
use crate::ConfigError;
use crate::geometry::{Point, Pose, Velocity};
use crate::map::Clearance;
use crate::robot::Robot;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Parameters of [`KeyPointDwa`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct KeyPointDwaConfig {
    /// Candidate velocities, and the rules that refuse them.
    pub window: WindowConfig,
    /// Constant weights of the evaluation (11).
    pub weights: KeyPointWeights,
    /// Weight of speed, (12).
    pub speed_weight: SpeedWeight,
    /// In the evaluation (11) alone, larger distances count as this one \[m\].
    pub distance_term_cap_m: f64,
}

/// The weights of the evaluation (11) that do not change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct KeyPointWeights {
    /// alpha: alignment with the key point at `window.judged_s`.
    pub key_point: f64,
    /// beta: distance to obstacles.
    pub distance: f64,
}

/// Weight of speed \[You2021, eq. (12)\], by the obstacles ahead.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SpeedWeight {
    /// `gamma_max`: the weight if no obstacle is ahead.
    pub largest: f64,
    /// l1: weight of an obstacle in the high-risk region.
    pub high_risk: f64,
    /// l2: weight of an obstacle in the low-risk region.
    pub low_risk: f64,
    /// Outer radius of the high-risk region, from the robot's centre \[m\].
    pub high_risk_m: f64,
    /// Outer radius of the low-risk region, which begins there \[m\].
    pub low_risk_m: f64,
    /// Half of the opening angle of both regions, from straight ahead \[deg\].
    pub half_angle_deg: f64,
    /// Occupied area that counts as one obstacle \[m²\].
    pub obstacle_area_m2: f64,
}

impl SpeedWeight {
    /// As published; the regions' shape and the area are readings.
    pub const PAPER: Self = Self {
        largest: 0.3,
        high_risk: 1.0,
        low_risk: 0.5,
        high_risk_m: 1.5,
        low_risk_m: 3.0,
        half_angle_deg: 90.0,
        obstacle_area_m2: 1.0,
    };

    /// The regions of the paper, scaled to the area that a decision of this robot affects: the
    /// low-risk region ends at [`Robot::decision_reach_m`], the high-risk region half as far
    /// away, and one obstacle is the same fraction of them as one cell of the paper's grid.
    pub fn for_robot(robot: &Robot) -> Self {
        let low_risk_m = robot.decision_reach_m();
        let scale = low_risk_m / Self::PAPER.low_risk_m;
        Self {
            high_risk_m: scale * Self::PAPER.high_risk_m,
            low_risk_m,
            obstacle_area_m2: scale * scale * Self::PAPER.obstacle_area_m2,
            ..Self::PAPER
        }
    }

    /// gamma(c, d), eq. (12): the weight for c obstacles in the high-risk and d in the low-risk
    /// region.
    pub fn at(&self, c: f64, d: f64) -> f64 {
        let risk = self.high_risk * c + self.low_risk * d;
        self.largest * (1.0 / (risk + 0.5)).min(1.0)
    }

    /// c and d: the occupied area in the high-risk and in the low-risk region of a robot at
    /// `pose`, in obstacles.
    fn obstacles_ahead(&self, obstacles: &Clearance<'_>, pose: Pose) -> (f64, f64) {
        let (frame, bits) = (obstacles.frame(), obstacles.obstacles());
        let cell_m = frame.resolution_m();
        let centre = frame.grid_from_world(pose.point());
        let (sin, cos) = libm::sincos(pose.theta - frame.origin().theta);
        let least_cos = libm::cos(self.half_angle_deg.to_radians());
        let (near, far) = (self.high_risk_m / cell_m, self.low_risk_m / cell_m);
        let (mut c, mut d) = (0_u32, 0_u32);
        for y in rows_within(centre.y, far, frame.height()) {
            let dy = f64::from(y) + 0.5 - centre.y;
            let half = (far * far - dy * dy).max(0.0).sqrt();
            let (from, to) = (centre.x - half, centre.x + half);
            for x in bits.ones_in_span(y, from.floor() as i32, to.floor() as i32) {
                let to_cell = Point::new(f64::from(x) + 0.5 - centre.x, dy);
                let distance = to_cell.norm();
                let ahead = to_cell.dot(Point::new(cos, sin));
                // The edge belongs to the region, rounded or not.
                if ahead < distance * (least_cos - 1e-9) {
                    continue;
                }
                c += u32::from(distance <= near);
                d += u32::from(distance > near && distance <= far);
            }
        }
        let obstacles_per_cell = cell_m * cell_m / self.obstacle_area_m2;
        (f64::from(c) * obstacles_per_cell, f64::from(d) * obstacles_per_cell)
    }

    fn validate(&self) -> Result<(), ConfigError> {
        let not_negative =
            [("largest", self.largest), ("high_risk", self.high_risk), ("low_risk", self.low_risk)];
        let mut not_negative = not_negative.into_iter();
        not_negative.try_for_each(|(field, value)| ConfigError::unless_weight(field, value))?;
        ConfigError::unless_positive("high_risk_m", self.high_risk_m)?;
        ConfigError::unless_positive("obstacle_area_m2", self.obstacle_area_m2)?;
        let refuse = |field, expected, value| Err(ConfigError::must_be(field, expected, value));
        if !(self.low_risk_m >= self.high_risk_m && self.low_risk_m.is_finite()) {
            return refuse("low_risk_m", "a number of at least high_risk_m", self.low_risk_m);
        }
        if !(self.half_angle_deg > 0.0 && self.half_angle_deg <= 180.0) {
            return refuse("half_angle_deg", "an angle above 0 and up to 180", self.half_angle_deg);
        }
        Ok(())
    }
}

/// Rows of a map of this height that may have a centre within `reach` of a coordinate \[cells\].
fn rows_within(y: f64, reach: f64, height: u32) -> std::ops::RangeInclusive<i32> {
    let last = height as i32 - 1;
    ((y - reach).floor() as i32).max(0)..=((y + reach).floor() as i32).min(last)
}

impl KeyPointDwaConfig {
    /// As published: tables 2 and 3, with the weights of the fused runs; for maps with cells of 1
    /// m.
    pub const PAPER: Self = Self {
        window: WindowConfig::PAPER,
        weights: KeyPointWeights { key_point: 0.15, distance: 0.1 },
        speed_weight: SpeedWeight::PAPER,
        distance_term_cap_m: 5.0,
    };

    /// Fields for which the paper gives no value: those of [`Self::PAPER`] are interpretations.
    pub const READINGS: &'static [&'static str] = &[
        "window.movers_s",
        "window.distance_cap_m",
        "speed_weight.high_risk_m",
        "speed_weight.low_risk_m",
        "speed_weight.half_angle_deg",
        "speed_weight.obstacle_area_m2",
        "distance_term_cap_m",
    ];

    /// Derived from the robot, one rule for all maps: [`WindowConfig::for_robot`], with the same
    /// cap in the evaluation, and [`SpeedWeight::for_robot`]. The weight of distance is below
    /// that of speed among many obstacles; with a larger weight, a robot stops in front of an
    /// obstacle behind its goal.
    pub fn for_robot(robot: &Robot) -> Self {
        let window = WindowConfig::for_robot(robot);
        Self {
            weights: KeyPointWeights { key_point: 0.4, distance: 0.02 },
            speed_weight: SpeedWeight::for_robot(robot),
            distance_term_cap_m: window.distance_cap_m,
            window,
        }
    }
}

/// The dynamic window approach of \[You2021\] along key points.
#[derive(Clone, Debug)]
pub struct KeyPointDwa {
    window: DynamicWindow,
    weights: KeyPointWeights,
    speed_weight: SpeedWeight,
    distance_cap_m: f64,
}

impl KeyPointDwa {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "key-point-dwa";

    /// Name of key(v, omega) in an evaluation.
    const KEY_POINT: &'static str = "key-point";

    /// Creates a planner for a robot.
    ///
    /// # Errors
    /// Returns a [`ConfigError`] if a value of the robot or the config is invalid, or the two do
    /// not fit together; the error names the field.
    pub fn new(
        config: KeyPointDwaConfig,
        robot: impl Into<Arc<Robot>>,
    ) -> Result<Self, ConfigError> {
        let KeyPointDwaConfig { window, weights, speed_weight, distance_term_cap_m } = config;
        let window = DynamicWindow::new(window, robot)?;
        ConfigError::unless_weight("weights.key_point", weights.key_point)?;
        ConfigError::unless_weight("weights.distance", weights.distance)?;
        speed_weight.validate().map_err(|error| error.within("speed_weight"))?;
        ConfigError::unless_positive("distance_term_cap_m", distance_term_cap_m)?;
        Ok(Self { window, weights, speed_weight, distance_cap_m: distance_term_cap_m })
    }

    /// The robot that is driven.
    pub fn robot(&self) -> &Robot {
        self.window.robot()
    }

    /// The weights of eq. (11) in this cycle.
    fn weighing(&self, scene: &Scene<'_>) -> Weighing<3> {
        let (c, d) = self.speed_weight.obstacles_ahead(&scene.obstacles.clearance(), scene.pose);
        Weighing([
            Term::of(Self::KEY_POINT, self.weights.key_point),
            Term::of(distance::NAME, self.weights.distance),
            Term::of(speed::NAME, self.speed_weight.at(c, d)),
        ])
    }

    /// The terms of eq. (11) before normalisation.
    fn terms(&self, velocity: Velocity, rollout: &Rollout) -> [TermValue; 3] {
        [
            TermValue::of(rollout.heading),
            TermValue::of(distance::raw(rollout.distance_m, self.distance_cap_m)),
            TermValue::of(speed::raw(velocity)),
        ]
    }
}

impl LocalParameters for KeyPointDwaConfig {
    fn for_robot(robot: &Robot) -> Self {
        Self::for_robot(robot)
    }

    fn build(&self, robot: &Arc<Robot>) -> Result<BoxedLocalPlanner, ConfigError> {
        Ok(Box::new(KeyPointDwa::new(self.clone(), Arc::clone(robot))?))
    }

    fn as_published() -> Option<Self> {
        Some(Self::PAPER)
    }

    fn readings(&self) -> &'static [&'static str] {
        Self::READINGS
    }
}

impl LocalPlanner for KeyPointDwa {
    fn decide(
        &self,
        scene: &Scene<'_>,
        _: &mut DriveMemory,
        scratch: &mut Scratch,
    ) -> Result<Decision, NoCommand> {
        let terms = |velocity, rollout: &Rollout| self.terms(velocity, rollout);
        self.window.decide(scene, scratch, &self.weighing(scene), terms)
    }

    fn explain(&self, scene: &Scene<'_>, _: &DriveMemory) -> Explanation {
        let terms = |velocity, rollout: &Rollout| self.terms(velocity, rollout);
        self.window.explain(scene, &self.weighing(scene), terms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Polyline;
    use crate::map::{Cell, CellState, DistanceField, FieldConfig, GridFrame, OccupancyGrid};
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn equation_12_by_hand() {
        let gamma = |c, d| SpeedWeight::PAPER.at(c, d);
        for (c, d, expected) in [
            (0.0, 0.0, 0.3),
            (1.0, 0.0, 0.2),
            (0.0, 1.0, 0.3),
            (2.0, 0.0, 0.12),
            (2.0, 2.0, 0.3 / 3.5),
            // 0.3 / 0.6 = 0.5 by the equation as printed.
            (0.1, 0.0, 0.3),
        ] {
            assert!((gamma(c, d) - expected).abs() < 1e-12, "({c}, {d}): {}", gamma(c, d));
        }
    }

    #[test]
    fn regions_by_hand() {
        // The robot faces up from the middle of the lowest row.
        let map =
            OccupancyGrid::from_ascii(&["##.....", "...#...", "...##..", ".......", "..#...."]);
        let obstacles = Clearance::new(map.frame(), map.occupied());
        let ahead =
            |x, y, theta| SpeedWeight::PAPER.obstacles_ahead(&obstacles, Pose::new(x, y, theta));
        // One obstacle is beside it, at exactly 90 degrees and 1 m; (3, 2) and (4, 2) are 2 m and
        // 2.24 m away, (3, 3) 3 m.
        assert_eq!(ahead(3.5, 0.5, FRAC_PI_2), (1.0, 3.0));
        assert_eq!(ahead(3.5, 0.5, -FRAC_PI_2), (1.0, 0.0));
        // Half a metre farther: 1.5 m belongs to the high-risk region.
        assert_eq!(ahead(3.5, 1.0, FRAC_PI_2), (1.0, 2.0));
        assert_eq!(ahead(-90.0, 1.0, 0.0), (0.0, 0.0));
    }

    proptest! {
        /// On any map at any pose, the cells are those that a test of each of them finds.
        #[test]
        fn regions_are_those_of_all_cells(seed in prop::collection::vec(0u8..4, 30 * 20), x in -1.0..4.0f64, y in -1.0..4.0f64,
                theta in -3.0..3.0f64, yaw in -3.0..3.0f64, half_angle_deg in 1.0..180.0f64) {
            let frame = GridFrame::new(30, 20, 0.1, Pose::new(0.3, 0.2, yaw)).unwrap();
            let mut each = seed.iter();
            let map = OccupancyGrid::from_fn(frame, |_| {
                if each.next() == Some(&0) { CellState::Occupied } else { CellState::Free }
            });
            let weight = SpeedWeight { high_risk_m: 0.5, low_risk_m: 1.1, half_angle_deg, obstacle_area_m2: 0.01, ..SpeedWeight::PAPER };
            let pose = Pose::new(x, y, theta);
            let (mut c, mut d) = (0.0, 0.0);
            for cell in frame.cells().filter(|&cell: &Cell| map.occupied().get(cell)) {
                let centre = frame.world_from_cell(cell);
                let away = centre.distance(pose.point());
                let bearing_deg = pose.bearing_to(centre).abs().to_degrees();
                prop_assume!((bearing_deg - half_angle_deg).abs() > 1e-6 && (away - 0.5).abs() > 1e-9 && (away - 1.1).abs() > 1e-9);
                if bearing_deg <= half_angle_deg && away <= 1.1 {
                    *(if away <= 0.5 { &mut c } else { &mut d }) += 1.0;
                }
            }
            let found = weight.obstacles_ahead(&Clearance::new(&frame, map.occupied()), pose);
            prop_assert!((found.0 - c).abs() < 1e-9 && (found.1 - d).abs() < 1e-9, "{found:?} {c} {d}");
        }
    }

    #[test]
    fn speed_counts_less_where_something_stands_ahead() {
        let planner = KeyPointDwa::new(KeyPointDwaConfig::PAPER, Robot::paper()).unwrap();
        let weight = |rows: &[&str]| {
            let map = OccupancyGrid::from_ascii(rows);
            let field = &DistanceField::new(map.frame(), map.occupied(), &FieldConfig::default());
            let path = &Polyline::default();
            let (pose, guide) = (Pose::new(0.5, 0.5, 0.0), Point::new(6.5, 0.5));
            let velocity = Velocity::new(0.2, 0.0);
            let sensed = map.occupied();
            let scene = Scene {
                obstacles: field,
                sensed,
                seen: crate::sense::SeenCells::ANYWHERE,
                movers: &[],
                walked: &[],
                pose,
                velocity,
                guide,
                path,
                goal_heading_rad: None,
                remaining_m: f64::INFINITY,
                jerk_limited: None,
            };
            let (memory, scratch) = (&mut DriveMemory::default(), &mut Scratch::default());
            let chosen = planner.decide(&scene, memory, scratch).unwrap().evaluation.chosen;
            let names: Vec<_> = chosen.as_slice().iter().map(|share| share.term.clone()).collect();
            assert_eq!(names, ["key-point", "distance", "speed"]);
            format!("{:?}", planner.weighing(&scene))
        };
        let expected = |gamma| {
            let terms = [Term::of("key-point", 0.15), Term::of("distance", 0.1), gamma];
            format!("{:?}", Weighing(terms))
        };
        let gamma = |c| Term::of("speed", SpeedWeight::PAPER.at(c, 0.0));
        assert_eq!(weight(&[".......", "......."]), expected(gamma(0.0)));
        assert_eq!(weight(&[".#.....", "......."]), expected(gamma(1.0)));
    }

    #[test]
    fn regions_of_a_robot_are_what_a_decision_can_change() {
        let weight = SpeedWeight::for_robot(&Robot::small());
        assert!(
            (weight.low_risk_m - 1.23).abs() < 1e-12 && (weight.high_risk_m - 0.615).abs() < 1e-12
        );
        assert!((weight.obstacle_area_m2 - 0.1681).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_used_is_named() {
        let base = KeyPointDwaConfig::PAPER;
        let field = |config| KeyPointDwa::new(config, Robot::paper()).unwrap_err().path;
        let weights = KeyPointWeights { key_point: f64::NAN, ..base.weights };
        assert_eq!(field(KeyPointDwaConfig { weights, ..base.clone() }), "weights.key_point");
        let with = |speed_weight| field(KeyPointDwaConfig { speed_weight, ..base.clone() });
        let paper = SpeedWeight::PAPER;
        assert_eq!(with(SpeedWeight { low_risk: -1.0, ..paper }), "speed_weight.low_risk");
        assert_eq!(with(SpeedWeight { low_risk_m: 1.4, ..paper }), "speed_weight.low_risk_m");
        assert_eq!(
            with(SpeedWeight { half_angle_deg: 0.0, ..paper }),
            "speed_weight.half_angle_deg"
        );
        assert_eq!(
            with(SpeedWeight { obstacle_area_m2: 0.0, ..paper }),
            "speed_weight.obstacle_area_m2"
        );
        let window = WindowConfig { horizon_s: 0.0, ..base.window.clone() };
        assert_eq!(field(KeyPointDwaConfig { window, ..base.clone() }), "window.horizon_s");
        assert_eq!(
            field(KeyPointDwaConfig { distance_term_cap_m: 0.0, ..base }),
            "distance_term_cap_m"
        );
    }
}
