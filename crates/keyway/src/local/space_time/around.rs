//! The surroundings of the robot in one cycle: clearance, the route ahead, the cost of headings
//! along it, and moving obstacles.

use super::cost_to_go::{CostToGo, WayAhead, Weighing};
use super::fitting::Ground;
use super::free_headings::BlockedHeadings;
use super::lattice::Lattice;
use super::meeting::Foreseen;
use super::pose_cost::{Driven, PoseCost};
use super::pose_times::{Facing, WayEnd};
use super::room::Room;
use super::{SpaceTime, local, way_ahead};
use crate::geometry::{Disc, Point, wrap_angle};
use crate::local::Scene;
use crate::map::GridFrame;
use crate::sense::Mover;
use std::f64::consts::FRAC_PI_2;

/// The surroundings of the robot in one cycle.
#[derive(Debug, Default)]
pub(super) struct Around {
    pub(super) room: Room,
    pub(super) cost_to_go: CostToGo,
    blocked_headings: BlockedHeadings,
    pub(super) pose_cost: PoseCost,
    pub(super) movers: Vec<Foreseen>,
    route: Vec<Point>,
    walked: Vec<Disc>,
}

impl SpaceTime {
    /// Points in an inscribed radius: of the fine lattice, for clearance and for headings, and of
    /// the coarse one, for the cost to go.
    const FINE: f64 = 3.0;
    const COARSE: f64 = 2.0;

    /// The uncertainty of a moving obstacle is three standard deviations.
    const DEVIATIONS: f64 = 3.0;

    /// Fills in the surroundings of the robot; returns the remaining length of the route beyond
    /// \[m\].
    pub(super) fn look(&self, around: &mut Around, scene: &Scene<'_>, covered_m: f64) -> f64 {
        let frame = scene.obstacles.frame();
        let robot = local(frame, scene.pose.point());
        let inscribed_m = self.outline.inscribed_m.max(frame.resolution_m());
        let reach_m = self.reach_m() + self.outline.circumscribed_m + inscribed_m;
        let fine = Lattice::around(frame, robot, reach_m + inscribed_m, inscribed_m / Self::FINE);
        let mut weighing = self.weighing();
        around.room.fill(fine, scene.obstacles, weighing.comfortable_m);
        let beyond_m =
            way_ahead::collect(&mut around.route, scene, covered_m, reach_m - inscribed_m);
        let coarse = Lattice::around(frame, robot, reach_m, inscribed_m / Self::COARSE);
        around.walked.clear();
        let walked = scene.walked.iter();
        around
            .walked
            .extend(walked.map(|disc| Disc { centre: local(frame, disc.centre), ..*disc }));
        let way = WayAhead { robot, route: &around.route, walked: &around.walked };
        let room_m = |at: Point| around.room.of_point(at);
        let longer_m = 0.5 * self.reach_m();
        let end = way_end(scene, way, (beyond_m, weighing.turning_m));
        let has_to_face = matches!(end.facing, Facing::At(_) | Facing::Back(_));
        if has_to_face && room_m(end.at) < weighing.turning_m {
            weighing.tight = 0.0;
        }
        around.cost_to_go.fill(coarse, &weighing, room_m, &way, longer_m);
        let near = Lattice::around(frame, robot, reach_m, inscribed_m / Self::FINE);
        self.weigh_headings(around, scene, (near, end, weighing.turning_m));
        self.foresee(around, scene);
        beyond_m
    }

    /// Computes the cost of headings along the route ahead.
    fn weigh_headings(
        &self,
        around: &mut Around,
        scene: &Scene<'_>,
        (lattice, end, turning_m): (Lattice, WayEnd, f64),
    ) {
        let Around { room, cost_to_go, blocked_headings, pose_cost, .. } = around;
        let (frame, margin_m) = (scene.obstacles.frame(), self.robot.safety_margin_or_default_m());
        blocked_headings.fit(&self.robot.footprint, margin_m, frame.resolution_m());
        let robot = local(frame, scene.pose.point());
        let ground = Ground {
            obstacles: scene.obstacles,
            blocked: blocked_headings,
            inscribed_m: self.outline.inscribed_m,
            turning_m,
        };
        let limits = &self.robot.limits;
        let can_reverse = self.config.backwards && limits.v_min_mps < 0.0;
        let seen = scene.seen.behind.map(|cells| self.rear.over(cells, frame));
        let driven = Driven { limits, can_reverse, seen };
        let room_m = |place: Point| room.of_point(place);
        let (sin, cos) = libm::sincos(scene.pose.theta - frame.origin().theta);
        let from = (robot, Point::new(cos, sin));
        pose_cost.fill((lattice, cost_to_go), room_m, (&ground, driven), from, &end);
    }

    fn weighing(&self) -> Weighing {
        let margin_m = self.robot.safety_margin_or_default_m();
        let turning_m = self.outline.circumscribed_m + margin_m;
        Weighing {
            blocked_m: self.outline.inscribed_m + margin_m,
            turning_m,
            comfortable_m: turning_m + self.config.comfortable_m,
            discomfort: self.config.discomfort,
            tight: Weighing::TIGHT,
        }
    }

    /// Fills in the moving obstacles that a trajectory may meet.
    fn foresee(&self, around: &mut Around, scene: &Scene<'_>) {
        let Around { movers, room, .. } = around;
        let horizon_s = self.config.horizon_s;
        // A polygon lies between its inscribed and circumscribed circles, in most directions.
        let body_m = 0.5 * (self.outline.inscribed_m + self.outline.circumscribed_m);
        movers.clear();
        let near = scene.movers.iter().filter(|mover| {
            let meets_m = self.reach_m() + mover.velocity_mps.norm() * horizon_s + mover.radius_m;
            let apart_m = mover.centre.distance(scene.pose.point());
            mover.is_usable() && apart_m <= meets_m + body_m + self.config.mover_room_m
        });
        for mover in near {
            let mut foreseen = self.foreseen(mover, scene.obstacles.frame(), body_m);
            foreseen.wall_s = foreseen.until_wall_s(mover.radius_m, room, horizon_s);
            foreseen.look_ahead(self.config.mover_room_m, self.farthest_s());
            movers.push(foreseen);
        }
    }

    fn foreseen(&self, mover: &Mover, frame: &GridFrame, body_m: f64) -> Foreseen {
        let (sin, cos) = libm::sincos(frame.origin().theta);
        let v = mover.velocity_mps;
        Foreseen {
            centre: local(frame, mover.centre),
            velocity_mps: Point::new(v.x * cos + v.y * sin, v.y * cos - v.x * sin),
            reach_m: mover.radius_m + body_m,
            off_m: mover.position_uncertainty_m / Self::DEVIATIONS,
            off_mps: mover.velocity_uncertainty_mps / Self::DEVIATIONS,
            off_mps2: self.config.mover_acceleration_mps2,
            wall_s: f64::INFINITY,
            matters_sq: Foreseen::ALWAYS,
        }
    }
}

/// The end of the route on the lattice, and the heading there, given the remaining length beyond
/// it and the clearance that the robot needs to turn \[m\].
fn way_end(scene: &Scene<'_>, way: WayAhead<'_>, lengths_m: (f64, f64)) -> WayEnd {
    let WayAhead { robot, route, .. } = way;
    let at = route.last().copied().unwrap_or(robot);
    let before = route.iter().rev().nth(1).copied().unwrap_or(robot);
    let facing = match scene.goal_heading_rad {
        _ if lengths_m.0 > 0.0 && backs_in(scene, lengths_m) => {
            Facing::Back((before - at).heading())
        }
        _ if lengths_m.0 > 0.0 => Facing::On((at - before).heading()),
        Some(heading_rad) => Facing::At(heading_rad - scene.obstacles.frame().origin().theta),
        None => Facing::Any,
    };
    WayEnd { at, facing }
}

/// True if the robot has to reach its goal backwards, as it can turn nowhere on the rest of its
/// route beyond the lattice \[m\].
fn backs_in(scene: &Scene<'_>, (beyond_m, turning_m): (f64, f64)) -> bool {
    let Some(heading_rad) = scene.goal_heading_rad else { return false };
    let (path, clearance) = (scene.path, scene.obstacles.clearance());
    let length_m = path.length_m();
    let stations = (0..).map(|i| length_m - beyond_m + 0.5 * turning_m * f64::from(i));
    let mut places =
        stations.take_while(|&along_m| along_m < length_m).filter_map(|m| path.at_length(m));
    let is_wide = |place: Point| clearance.is_clear_point(place, turning_m);
    let Some(last) = path.segments().last() else { return false };
    let off_rad = wrap_angle(heading_rad - (last.b - last.a).heading());
    off_rad.abs() > FRAC_PI_2 && !is_wide(last.b) && !places.any(is_wide)
}
