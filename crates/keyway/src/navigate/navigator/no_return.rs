//! The point of no return of a robot that cannot drive backwards.
//!
//! Such a robot stays in a place in which it can neither drive on nor turn. So before it leaves the
//! last place from which it surely gets on, it has to know how: from where it would stand, it can
//! turn and drive straight to where it can turn around again, to its goal, or as far as it looks,
//! as it faces or in two directions. If that is not so, it stops, and a manoeuvre leads it in: one
//! that keeps less room, if there is no other.

use super::Deciding;
use crate::geometry::Velocity;
use crate::navigate::RecoveryKind;
use crate::navigate::mode::Mode;
use crate::navigate::recovery::{RecoveryUnderWay, TightPlace, kept_room_m};
use crate::navigate::watch::RestOfRoute;

impl Deciding<'_> {
    /// The command of a manoeuvre that leads on, or braking before it begins, where a command leads
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

    /// True if the robot would stand where it does not surely get on, while now it comes to where
    /// it can turn around.
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
        // Inside of a long lane, the first one is answered at once.
        self.tighter_place().straight_on(stands_at(Velocity::ZERO)).is_some()
            && !self.tight_place().surely_gets_on(stands_at(command))
    }

    /// The place in which it is, with less room to keep: where it does not surely get on any more,
    /// it may still come out again.
    fn tighter_place(&self) -> TightPlace<'_> {
        const SHARE: f64 = 0.25;
        let place = self.tight_place();
        TightPlace { room_m: SHARE * place.room_m, ..place }
    }

    /// The place in which it is.
    pub(super) fn tight_place(&self) -> TightPlace<'_> {
        let (robot, obstacles) = (self.robot, &self.world.obstacles);
        let RestOfRoute { path, covered_m } = self.rest();
        let goal_tolerance_m = self.stack.controller.goal_tolerance_m;
        let room_m = kept_room_m(robot, self.pose, obstacles);
        TightPlace { robot, obstacles, path, covered_m, goal_tolerance_m, room_m }
    }
}
