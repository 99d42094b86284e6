//! The point of no return of a robot that cannot drive backwards.
//!
//! A robot that cannot drive backwards gets stuck in a place in which it can neither drive on nor
//! turn. Before it leaves the last position from which it is sure to get on, it must have a
//! continuation: from its stopping pose, it can rotate and drive straight to a position at which
//! it can turn around again, to its goal, or as far as its horizon, as it faces or in two
//! directions. If it has none, it stops, and a manoeuvre leads it in, with less clearance if
//! there is no other.

use super::Deciding;
use crate::geometry::Velocity;
use crate::navigate::RecoveryKind;
use crate::navigate::mode::Mode;
use crate::navigate::recovery::{RecoveryUnderWay, TightPlace, kept_room_m};
use crate::navigate::watch::RestOfRoute;

impl Deciding<'_> {
    /// The command of a manoeuvre that leads on, or braking before it starts, if a command leads
    /// beyond the point of no return.
    pub(super) fn led_in(&mut self, command: Velocity) -> Option<Velocity> {
        if !self.leads_beyond_return(command) {
            return None;
        }
        if !self.stands() {
            return Some(self.robot.limits.braked(self.velocity, self.robot.cycle_s));
        }
        let kind = RecoveryKind::Manoeuvre;
        let leads_in = |place: TightPlace<'_>| {
            let motions = place.manoeuvre(self.pose).or_else(|| place.straight_on(self.pose))?;
            RecoveryUnderWay::begin(kind, motions, place.room_m)
        };
        let begun = leads_in(self.tight_place()).or_else(|| leads_in(self.tighter_place()));
        let Some(begun) = begun else {
            self.task.led_from = Some(self.pose.point());
            return None;
        };
        self.task.mode = Mode::Recovering(begun);
        self.record.counts.recoveries.add(kind);
        self.go_on_recovering().map(|(_, command)| command)
    }

    /// True if the robot would stop at a pose from which it is not sure to get on, while at
    /// present it still reaches a position at which it can turn around.
    fn leads_beyond_return(&self, command: Velocity) -> bool {
        let footprint = &self.robot.footprint;
        let (inscribed_m, size_m) =
            (footprint.inscribed_radius_m(), footprint.circumscribed_radius_m());
        let may_wedge = self.robot.limits.v_min_mps >= 0.0 && size_m > inscribed_m;
        let may_manoeuvre = matches!(self.task.mode, Mode::Following)
            && self.stack.controller.recoveries.contains(&RecoveryKind::Manoeuvre);
        let was_asked =
            self.task.led_from.is_some_and(|at| at.distance(self.pose.point()) < size_m);
        if !may_wedge
            || !may_manoeuvre
            || was_asked
            || self.robot.stands(command)
            || !self.local.turns_in_time()
        {
            return false;
        }
        let stands_at = |command| self.robot.stop_pose(self.pose, self.velocity, command);
        // Inside a long lane, the first test settles it.
        self.tighter_place().straight_on(stands_at(Velocity::ZERO)).is_some()
            && !self.tight_place().surely_gets_on(stands_at(command))
    }

    /// The present surroundings with less clearance: where the robot is no longer sure to get on,
    /// it may still get out again.
    fn tighter_place(&self) -> TightPlace<'_> {
        const SHARE: f64 = 0.25;
        let place = self.tight_place();
        TightPlace { room_m: SHARE * place.room_m, ..place }
    }

    /// The present surroundings.
    pub(super) fn tight_place(&self) -> TightPlace<'_> {
        let (robot, obstacles) = (self.robot, &self.world.obstacles);
        let RestOfRoute { path, covered_m } = self.rest();
        let goal_tolerance_m = self.stack.controller.goal_tolerance_m;
        let room_m = kept_room_m(robot, self.pose, obstacles);
        TightPlace { robot, obstacles, path, covered_m, goal_tolerance_m, room_m }
    }
}
