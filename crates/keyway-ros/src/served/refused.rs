//! Actions of Nav2 that this node lacks. Their goals are refused, so that a waiting client
//! continues.

use super::Answered;
use crate::error::StartError;
use crate::messages::Action;
use crate::messages::nav2_msgs::{
    AssistedTeleop, ComputeAndTrackRoute, ComputeRoute, DockRobot, FollowGpsWaypoints, UndockRobot,
    Unread,
};
use crate::pilot::Pilot;
use crate::served::Told;
use crate::wire::{ActionServer, Wire, Wired};

/// A server that refuses all goals.
struct Refused<A: Wired>(ActionServer<A>);

impl<A: Wired + Action<Goal = Unread>> Answered for Refused<A> {
    fn answer_all(&mut self, _: &mut Pilot, _: Told<'_>) {
        self.0.refuse_all();
    }
}

/// All refused actions.
pub(super) fn refused(wire: &mut Wire) -> Result<Vec<Box<dyn Answered>>, StartError> {
    Ok(vec![
        Box::new(Refused(wire.action::<AssistedTeleop>("assisted_teleop")?)),
        Box::new(Refused(wire.action::<ComputeRoute>("compute_route")?)),
        Box::new(Refused(wire.action::<ComputeAndTrackRoute>("compute_and_track_route")?)),
        Box::new(Refused(wire.action::<DockRobot>("dock_robot")?)),
        Box::new(Refused(wire.action::<FollowGpsWaypoints>("follow_gps_waypoints")?)),
        Box::new(Refused(wire.action::<UndockRobot>("undock_robot")?)),
    ])
}
