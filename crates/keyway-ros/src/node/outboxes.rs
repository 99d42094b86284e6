//! Publishers of the node.

use super::timing::Timing;
use crate::costmaps::{Known, Shown};
use crate::error::StartError;
use crate::messages::diagnostic_msgs::DiagnosticArray;
use crate::messages::geometry_msgs::{PolygonStamped, Twist, TwistStamped};
use crate::messages::nav_msgs::{OccupancyGrid, Path};
use crate::messages::std_msgs::Header;
use crate::messages::visualization_msgs::MarkerArray;
use crate::pictures::{Order, Pictures};
use crate::pilot::Pilot;
use crate::settings::Settings;
use crate::wire::{Delivery, Outbox, Wire};
use keyway::geometry::Velocity;

/// All publishers.
pub(super) struct Outboxes {
    command: Commands,
    plan: Outbox<Path>,
    local_plan: Outbox<Path>,
    footprint: Outbox<PolygonStamped>,
    costmaps: [(Shown, Outbox<OccupancyGrid>); 2],
    markers: Outbox<MarkerArray>,
    fan: Outbox<MarkerArray>,
    diagnostics: Outbox<DiagnosticArray>,
    pictures: Pictures,
    /// Number of planned routes at the time of the last published one.
    routes_published: u32,
    /// Cycles since the start.
    cycles: u64,
}

/// Commands, with and without a stamp.
enum Commands {
    Plain(Outbox<Twist>),
    Stamped(Outbox<TwistStamped>),
}

impl Outboxes {
    /// Interval of pictures \[s\].
    const PICTURES_S: f64 = 0.5;

    /// Interval of global costmaps \[s\].
    const GLOBAL_S: f64 = 2.0;

    /// Interval of diagnostics \[s\].
    const DIAGNOSTICS_S: f64 = 1.0;

    pub(super) fn new(wire: &mut Wire, settings: &Settings) -> Result<Self, StartError> {
        let command = if settings.is_cmd_vel_stamped {
            Commands::Stamped(wire.outbox("cmd_vel", Delivery::Reliable, 1)?)
        } else {
            Commands::Plain(wire.outbox("cmd_vel", Delivery::Reliable, 1)?)
        };
        let costmap = |wire: &mut Wire, name| wire.outbox(name, Delivery::Latched, 1);
        Ok(Self {
            command,
            plan: wire.outbox("plan", Delivery::Reliable, 1)?,
            local_plan: wire.outbox("local_plan", Delivery::Reliable, 1)?,
            footprint: wire.outbox("local_costmap/published_footprint", Delivery::Reliable, 1)?,
            costmaps: [
                (Shown::Local, costmap(wire, "local_costmap/costmap")?),
                (Shown::Global, costmap(wire, "global_costmap/costmap")?),
            ],
            markers: wire.outbox("markers", Delivery::Reliable, 1)?,
            fan: wire.outbox("fan", Delivery::Reliable, 1)?,
            diagnostics: wire.outbox("/diagnostics", Delivery::Reliable, 1)?,
            pictures: Pictures::new().map_err(|error| StartError::Network {
                what: "start the thread that draws costmaps".to_owned(),
                why: error.to_string(),
            })?,
            routes_published: 0,
            cycles: 0,
        })
    }

    /// Publishes a command, stamped with a time \[s\].
    pub(super) fn command(&self, command: Velocity, (stamp_s, frame): (f64, &str)) {
        match &self.command {
            Commands::Plain(outbox) => outbox.publish(command.into()),
            Commands::Stamped(outbox) => {
                let header = Header::new(stamp_s, frame);
                outbox.publish(TwistStamped { header, twist: command.into() });
            }
        }
    }

    /// Publishes the routes, diagnostics, pictures and costmaps that are due after a cycle.
    pub(super) fn show(&mut self, pilot: &Pilot, wire: &mut Wire, timing: &mut Timing, now_s: f64) {
        self.cycles += 1;
        self.show_route(pilot, now_s);
        if self.is_time_for(Self::DIAGNOSTICS_S, timing) {
            self.diagnostics.publish(timing.diagnostics(pilot, &wire.misfits(), now_s));
        }
        if self.is_time_for(Self::PICTURES_S, timing) {
            self.show_pictures(pilot, wire, now_s);
        }
        for (shown, outbox) in &self.costmaps {
            let every_s = match shown {
                Shown::Local => Self::PICTURES_S,
                Shown::Global => Self::GLOBAL_S,
            };
            if self.is_time_for(every_s, timing) && wire.is_heard(outbox) {
                self.order(*shown, pilot, now_s);
            }
        }
        for (drawn, grid) in self.pictures.take_all() {
            let outbox = self.costmaps.iter().find(|(shown, _)| *shown == drawn);
            if let Some((_, outbox)) = outbox {
                outbox.publish(grid);
            }
        }
    }

    /// True in every cycle that is a multiple of the interval.
    fn is_time_for(&self, every_s: f64, timing: &Timing) -> bool {
        let every = (every_s / timing.period_s()).round().max(1.0) as u64;
        self.cycles.is_multiple_of(every)
    }

    /// Publishes the route if it is new.
    fn show_route(&mut self, pilot: &Pilot, now_s: f64) {
        let Some(navigator) = pilot.navigator() else { return };
        let planned = navigator.routes_planned();
        if planned != self.routes_published
            && let Some(route) = pilot.route(now_s)
        {
            self.routes_published = planned;
            self.plan.publish(route);
        }
    }

    fn show_pictures(&self, pilot: &Pilot, wire: &Wire, now_s: f64) {
        show(&self.local_plan, wire, || pilot.local_plan(now_s));
        show(&self.footprint, wire, || pilot.footprint(now_s));
        show(&self.markers, wire, || pilot.markers(now_s));
        show(&self.fan, wire, || pilot.fan(now_s));
    }

    fn order(&self, shown: Shown, pilot: &Pilot, now_s: f64) {
        let (Some(navigator), Some(pose)) = (pilot.navigator(), pilot.pose()) else { return };
        let (known, header) = (Known::of(navigator), pilot.header(now_s));
        self.pictures.order(Order { shown, known, place: pose.point(), header });
    }
}

/// Publishes a message if there is one and it has subscribers.
fn show<M: crate::messages::Named>(
    outbox: &Outbox<M>,
    wire: &Wire,
    made: impl FnOnce() -> Option<M>,
) {
    if wire.is_heard(outbox)
        && let Some(message) = made()
    {
        outbox.publish(message);
    }
}
