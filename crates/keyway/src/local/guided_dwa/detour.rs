//! The guide points of a detour around an obstacle that is not on the known map.
//!
//! # Source
//! \[ZhuYin2024\]: equations (19) to (21), and steps 7 to 9 of its whole algorithm.
//!
//! | paper | here | unit |
//! |---|---|---|
//! | `x_ob` | [`Unknown::centre`]: the centre of the sensed part of the obstacle | m |
//! | `x_j-1` | the robot's position when the obstacle was detected | m |
//! | `x_j` | `Detour::Behind::from`: the next node of the route, or `x_j-1` if that node is not before the obstacle | m |
//! | `x_ga` = 2 `x_ob` - `x_j`, eq. (19) | [`Behind::point`]: behind the obstacle | m |
//! | `x_st`, eq. (20) | [`Behind::rejoin`]: the node of the remaining route nearest to `x_ga` | m |
//! | invalid zone | the disc of radius `reached_m` around `x_ga` | m |
//! | `e_gt` | direction of travel on entering the invalid zone | 1 |
//! | `e_gs` | unit vector from `x_ga` to `x_st` | 1 |
//! | `e_gi` = `e_gt` + `e_gs` | direction in which the route is joined | 1 |
//! | `x_it`, eq. (21) | the node in the direction from `x_ga` that is closest to `e_gi` | m |
//!
//! # Where this differs from the paper
//! - The paper does not cover an obstacle on a straight route, with `x_ga` on the route: if
//!   `x_ga` and `x_st` are nearer to each other than half a cell, `e_gs` is 0; if `e_gi` is 0,
//!   `e_gs` is used instead.
//! - The remaining route begins behind the obstacle. Candidates for `x_it` lie behind `x_st`, at
//!   least half a cell from `x_ga`, and are connected with it by a straight line that keeps the
//!   clearance. Among directions that are equal up to rounding, the first along the route is
//!   taken. Without a candidate, `x_it` is `x_st`.
//! - `x_ga` must keep the clearance from everything mapped and sensed, and the straight line from
//!   `x_j` to it may cross the obstacle and nothing else. Otherwise `x_ga` is the first node of
//!   the remaining route that keeps the clearance. If there is none, the detour has failed.
//! - `x_j` is kept while the robot drives to `x_ga`, and the rest is recomputed in each cycle,
//!   from new sensor data and the present position of a moving obstacle. Once nothing of it is
//!   left on the route up to `x_st`, the detour ends.
//!
//! # Errors / cost
//! [`AllCovered`]. Linear in the nodes of the remaining route; (21) with one line-of-sight test
//! for each of them, once per detour.

use super::obstacle::{Cluster, Search, Unknown};
use super::route_nodes::{RouteNode, route_nodes};
use crate::ConfigError;
use crate::geometry::{Point, Segment};
use crate::local::{Detour, DriveMemory, OwnMemory, Scene};
use crate::map::{Clearance, RayCells};
use crate::robot::Robot;
use serde::{Deserialize, Serialize};

/// Parameters of detours around obstacles that are not on the known map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct DetourConfig {
    /// Range \[m\]: distance along the route within which an unknown obstacle matters, and
    /// distance from the robot within which its cells count.
    pub look_ahead_m: f64,
    /// Clearance that the route, a guide point and the straight line from it need to be free
    /// \[m\].
    pub clearance_m: f64,
    /// A guide point is reached within this distance: the radius of the invalid zone \[m\].
    pub reached_m: f64,
}

impl DetourConfig {
    /// For maps with cells of 1 m. All are readings: the range of the sensor, the safe distance
    /// of the smoother, and half a cell.
    pub const PAPER: Self = Self { look_ahead_m: 5.0, clearance_m: 0.8, reached_m: 0.5 };

    /// Derived from the robot, one rule for all maps:
    ///
    /// - `look_ahead_m`: [`Robot::decision_reach_m`];
    /// - `clearance_m`: the circumscribed radius and [`Robot::safety_margin_or_default_m`]: the
    ///   robot can turn with that clearance;
    /// - `reached_m`: the inscribed radius, but at least one cycle of driving: the footprint
    ///   covers the point.
    pub fn for_robot(robot: &Robot) -> Self {
        let cycle_m = robot.limits.v_max_mps * robot.cycle_s;
        Self {
            look_ahead_m: robot.decision_reach_m(),
            clearance_m: robot.footprint.circumscribed_radius_m()
                + robot.safety_margin_or_default_m(),
            reached_m: robot.footprint.inscribed_radius_m().max(cycle_m),
        }
    }

    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        ConfigError::unless_positive("look_ahead_m", self.look_ahead_m)?;
        ConfigError::unless_positive("clearance_m", self.clearance_m)?;
        ConfigError::unless_positive("reached_m", self.reached_m)
    }
}

/// No position behind an obstacle is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AllCovered {
    /// Number of positions that were tried.
    pub(super) tried: u32,
}

/// A position behind an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Behind {
    /// `x_ga`.
    point: Point,
    /// `x_st`.
    rejoin: RouteNode,
}

/// Selects the guide point of a cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct GuidePoints<'a> {
    pub(super) config: &'a DetourConfig,
    pub(super) scene: &'a Scene<'a>,
}

impl GuidePoints<'_> {
    /// Directions whose angles with `e_gi` differ by less are equal, as cosines.
    const EQUAL_DIRECTIONS: f64 = 1e-9;

    /// Target of a detour around an unknown obstacle; `None` if none is on the route.
    pub(super) fn target(
        &self,
        memory: &mut DriveMemory,
        cluster: &mut Cluster,
    ) -> Result<Option<Point>, AllCovered> {
        let position = self.scene.pose.point();
        if let Some(Detour::Back { point, along_m }) = memory.detour() {
            let is_reached = position.distance(point) <= self.config.reached_m;
            if !is_reached
                && self.sensed().of_point(point, self.config.clearance_m) >= self.config.clearance_m
            {
                return Ok(Some(point));
            }
            memory.own = OwnMemory::Nothing;
            if is_reached {
                memory.covered_m = along_m;
            }
        }
        let to_m = match memory.detour() {
            Some(Detour::Behind { rejoin_m, .. }) => rejoin_m,
            _ => memory.covered_m + self.config.look_ahead_m,
        };
        let Some(unknown) = self.first_unknown(memory.covered_m, to_m, cluster) else {
            if memory.detour().is_some() {
                memory.own = OwnMemory::Nothing;
                let window_m = to_m - memory.covered_m;
                memory.covered_m =
                    self.scene.path.nearest_along(position, memory.covered_m, window_m);
            }
            return Ok(None);
        };
        let from = match memory.detour() {
            Some(Detour::Behind { from, .. }) => from,
            _ => self.detected_from(memory.covered_m, &unknown),
        };
        let behind = self.behind(from, &unknown, cluster)?;
        if position.distance(behind.point) > self.config.reached_m {
            let Behind { point, rejoin } = behind;
            memory.own =
                OwnMemory::Detour(Detour::Behind { from, point, rejoin_m: rejoin.along_m });
            return Ok(Some(point));
        }
        let back = self.back(&behind);
        memory.covered_m = behind.rejoin.along_m;
        memory.own = OwnMemory::Detour(Detour::Back { point: back.point, along_m: back.along_m });
        Ok(Some(back.point))
    }

    fn sensed(&self) -> Clearance<'_> {
        Clearance::new(self.scene.obstacles.frame(), self.scene.sensed)
    }

    fn cell_m(&self) -> f64 {
        self.scene.obstacles.frame().resolution_m()
    }

    /// The nodes of the route after an arc length.
    fn nodes(&self, from_m: f64) -> impl Iterator<Item = RouteNode> + '_ {
        route_nodes(self.scene.path, self.cell_m(), from_m)
    }

    /// The first unknown obstacle on a stretch of the route.
    fn first_unknown(&self, from_m: f64, to_m: f64, cluster: &mut Cluster) -> Option<Unknown> {
        let search = Search {
            sensed: self.sensed(),
            clearance_m: self.config.clearance_m,
            robot: self.scene.pose.point(),
            range_m: self.config.look_ahead_m,
        };
        let stretch = self.nodes(from_m).take_while(|node| node.along_m <= to_m);
        cluster.first_on(stretch, &search)
    }

    /// `x_j`: the next node of the route if it is before the obstacle, otherwise the position of
    /// the robot.
    fn detected_from(&self, covered_m: f64, unknown: &Unknown) -> Point {
        let next = self.nodes(covered_m).next().filter(|node| node.along_m < unknown.along_m);
        next.map_or(self.scene.pose.point(), |node| node.point)
    }

    /// `x_ga` and `x_st`.
    fn behind(
        &self,
        from: Point,
        unknown: &Unknown,
        cluster: &Cluster,
    ) -> Result<Behind, AllCovered> {
        // Eq. (19)
        let point = unknown.centre * 2.0 - from;
        let is_free =
            |point| self.scene.obstacles.clearance().is_clear_point(point, self.config.clearance_m);
        let remaining = || self.nodes(unknown.along_m);
        if is_free(point) && self.crosses_nothing_else(from, point, cluster) {
            // Eq. (20)
            let to = |node: &RouteNode| (node.point - point).norm_sq();
            let nearest = remaining().min_by(|a, b| to(a).total_cmp(&to(b)));
            if let Some(rejoin) = nearest {
                return Ok(Behind { point, rejoin });
            }
        }
        let mut tried = 1;
        for node in remaining() {
            tried += 1;
            if is_free(node.point) {
                return Ok(Behind { point: node.point, rejoin: node });
            }
        }
        Err(AllCovered { tried })
    }

    /// True if the straight line from `x_j` to `x_ga` crosses no obstacle except the one to drive
    /// around.
    fn crosses_nothing_else(&self, from: Point, to: Point, cluster: &Cluster) -> bool {
        let (frame, obstacles) = (self.scene.obstacles.frame(), self.scene.obstacles.clearance());
        let (start, end) = (frame.grid_from_world(from), frame.grid_from_world(to));
        let length = start.distance(end);
        if length == 0.0 {
            return true;
        }
        let direction = (end - start) * (1.0 / length);
        let mut passed = RayCells::new(frame, start, direction, length);
        passed
            .all(|passed| !obstacles.obstacles().get(passed.cell) || cluster.contains(passed.cell))
    }

    /// `x_it`: the node at which the route is joined from `x_ga`.
    fn back(&self, behind: &Behind) -> RouteNode {
        let Behind { point, rejoin } = *behind;
        let half_cell_m = 0.5 * self.cell_m();
        let (sin, cos) = libm::sincos(self.scene.pose.theta);
        let e_gt = Point::new(cos, sin);
        let to_rejoin = rejoin.point - point;
        let e_gs = if to_rejoin.norm() < half_cell_m {
            Point::default()
        } else {
            to_rejoin * (1.0 / to_rejoin.norm())
        };
        let sum = e_gt + e_gs;
        let e_gi = if sum.norm() < Self::EQUAL_DIRECTIONS { e_gs } else { sum };
        let obstacles = self.scene.obstacles.clearance();
        // Eq. (21)
        let mut best: Option<(RouteNode, f64)> = None;
        for node in self.nodes(rejoin.along_m) {
            let to_node = node.point - point;
            if to_node.norm() < half_cell_m {
                continue;
            }
            let cosine = to_node.dot(e_gi) / (to_node.norm() * e_gi.norm());
            let is_closer =
                best.is_none_or(|(_, closest)| cosine > closest + Self::EQUAL_DIRECTIONS);
            let line = Segment::new(point, node.point);
            if is_closer && obstacles.is_clear(line, self.config.clearance_m) {
                best = Some((node, cosine));
            }
        }
        best.map_or(rejoin, |(node, _)| node)
    }
}
