//! The loop of the node: what comes from the network goes to the pilot, and in every cycle what the
//! pilot says goes to the network.

use crate::arguments::{Arguments, Network};
use crate::clock::Clock;
use crate::error::StartError;
use crate::messages::builtin_interfaces::Time;
use crate::messages::geometry_msgs::{PoseStamped, Twist, TwistStamped};
use crate::messages::nav_msgs::{OccupancyGrid, Odometry, Path};
use crate::messages::nav2_msgs::SpeedLimit;
use crate::messages::rosgraph_msgs::Clock as ClockMessage;
use crate::messages::sensor_msgs::LaserScan;
use crate::messages::std_msgs::Header;
use crate::messages::tf2_msgs::TFMessage;
use crate::pilot::{Cycle, Ended, Family, Pilot, Report, Wanted};
use crate::served::{Answered, Served, Told, Wish, answered, served};
use crate::settings::Settings;
use crate::transforms::Placement;
use crate::wire::{Delivery, GoalId, GoalStatus, Inbox, Outbox, Wire};
use keyway::geometry::Velocity;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Everything that the node is.
pub(crate) struct Node {
    wire: Wire,
    pilot: Pilot,
    settings: Settings,
    clock: Clock,
    inboxes: Inboxes,
    outboxes: Outboxes,
    /// Actions for which the robot drives.
    served: Vec<Box<dyn Served>>,
    answered: Vec<Box<dyn Answered>>,
    /// The client that has asked for the present goal.
    drives_for: Option<Client>,
    /// The last command that was published, while it was one to move.
    moves: bool,
    cycles: u64,
    /// Routes that were planned when the last one was published.
    routes_published: u32,
    /// The last thing that was said of standing still.
    said: String,
}

struct Inboxes {
    map: Inbox<OccupancyGrid>,
    scans: Vec<Inbox<LaserScan>>,
    odometry: Inbox<Odometry>,
    transforms: [Inbox<TFMessage>; 2],
    goal_pose: Inbox<PoseStamped>,
    speed_limit: Inbox<SpeedLimit>,
    clock: Option<Inbox<ClockMessage>>,
}

struct Outboxes {
    command: Commands,
    plan: Outbox<Path>,
}

/// Commands, with and without a stamp.
enum Commands {
    Plain(Outbox<Twist>),
    Stamped(Outbox<TwistStamped>),
}

/// The client for which the robot drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Client {
    Topic,
    /// Of an action, by its index among those that are served.
    Action(usize, GoalId),
}

impl Node {
    /// Joins the network.
    pub(crate) fn new(
        arguments: &Arguments,
        network: Network,
        settings: Settings,
    ) -> Result<Self, StartError> {
        let mut wire = Wire::open(arguments, network)?;
        let scan = |topic: &String| wire.inbox(topic, Delivery::BestEffort, 4);
        let scans = settings.scan_topics.iter().map(scan).collect::<Result<_, _>>()?;
        let clock = if settings.use_sim_time {
            Some(wire.inbox("/clock", Delivery::BestEffort, 1)?)
        } else {
            None
        };
        let inboxes = Inboxes {
            map: wire.inbox("map", Delivery::Latched, 1)?,
            scans,
            odometry: wire.inbox(&settings.odom_topic, Delivery::BestEffort, 4)?,
            transforms: [
                wire.inbox("/tf", Delivery::Reliable, 100)?,
                wire.inbox("/tf_static", Delivery::Latched, 100)?,
            ],
            goal_pose: wire.inbox("goal_pose", Delivery::Reliable, 1)?,
            speed_limit: wire.inbox("speed_limit", Delivery::Reliable, 1)?,
            clock,
        };
        let command = if settings.is_cmd_vel_stamped {
            Commands::Stamped(wire.outbox("cmd_vel", Delivery::Reliable, 1)?)
        } else {
            Commands::Plain(wire.outbox("cmd_vel", Delivery::Reliable, 1)?)
        };
        let outboxes = Outboxes { command, plan: wire.outbox("plan", Delivery::Reliable, 1)? };
        let served = served(&mut wire, settings.distribution)?;
        let answered = answered(&mut wire, settings.distribution, &settings.stands_for)?;
        Ok(Self {
            wire,
            pilot: Pilot::new(settings.clone()),
            clock: Clock::new(settings.use_sim_time),
            settings,
            inboxes,
            outboxes,
            served,
            answered,
            drives_for: None,
            moves: false,
            cycles: 0,
            routes_published: 0,
            said: String::new(),
        })
    }

    /// Runs until it is told to stop; then the robot is told to stand.
    pub(crate) fn run(&mut self, is_over: &Arc<AtomicBool>) {
        let period = Duration::from_secs_f64(self.settings.stack.robot().cycle_s);
        let mut next = Instant::now();
        while !is_over.load(Ordering::Relaxed) {
            self.wire.wait(next.saturating_duration_since(Instant::now()));
            self.receive();
            let now = Instant::now();
            let is_due = now >= next;
            if is_due {
                // A cycle that was missed is not made up for.
                next = (next + period).max(now);
            }
            // A simulation may be faster than this machine's clock.
            if (is_due || self.settings.use_sim_time)
                && let Some(now_s) = self.clock.next_cycle_s(period.as_secs_f64())
            {
                self.cycle(now_s);
            }
        }
        self.command(Velocity::ZERO);
    }

    /// Takes in all that has come.
    fn receive(&mut self) {
        for message in self.inboxes.clock.iter().flat_map(Inbox::take_all) {
            self.clock.tell(message.clock.stamp_s());
        }
        if self.clock.take_restart() {
            self.say("the clock was set: what was sensed by the old one no longer counts");
            self.pilot.restart_clock();
        }
        for (inbox, is_fixed) in self.inboxes.transforms.iter().zip([false, true]) {
            for message in inbox.take_all().iter().flat_map(|message| &message.transforms) {
                let Some(pose) = message.on_ground() else { continue };
                let is_flipped = message.transform.rotation.is_upside_down();
                let stamp_s = message.header.stamp.stamp_s();
                let names = [message.header.frame_id.as_str(), &message.child_frame_id];
                let placement = Placement { pose, is_flipped };
                self.pilot.transforms.insert(names, (stamp_s, placement), is_fixed);
            }
        }
        for message in self.inboxes.odometry.take_all() {
            self.pilot.sensing.take_odometry(&message);
        }
        for (sensor, inbox) in self.inboxes.scans.iter().enumerate() {
            for message in inbox.take_all() {
                self.pilot.sensing.take_scan(sensor, message);
            }
        }
        if let Some(message) = self.inboxes.map.take_all().pop()
            && let Err(error) = self.pilot.take_map(&message)
        {
            self.say(&format!("the map cannot be used: {error}"));
        }
        for message in self.inboxes.speed_limit.take_all() {
            self.pilot.limit_speed(&message);
        }
        let Some(now_s) = self.clock.now_s() else { return };
        if let Some(goal) = self.inboxes.goal_pose.take_all().pop() {
            self.begin(Client::Topic, Wanted::Poses(vec![goal]), now_s);
        }
        self.receive_goals(now_s);
    }

    /// Takes in what clients of actions want.
    fn receive_goals(&mut self, now_s: f64) {
        for index in 0..self.served.len() {
            for wish in self.served[index].receive(Time::of(now_s)) {
                match wish {
                    Wish::Begin(id, wanted) => self.begin(Client::Action(index, id), wanted, now_s),
                    Wish::Cancel(id) => self.give_up(Client::Action(index, id), now_s),
                }
            }
        }
        let told = Told { now_s, frame: &self.settings.frames.map };
        for action in &mut self.answered {
            action.answer_all(&mut self.pilot, told);
        }
    }

    /// Sets out for a client, in the place of the one before.
    fn begin(&mut self, client: Client, wanted: Wanted, now_s: f64) {
        if let Some(before) = self.drives_for.take() {
            // As Nav2 does: a goal that gives way to another one was aborted, without an error.
            let report = self.pilot.report(now_s).unwrap_or_default();
            self.tell(before, GoalStatus::Aborted, &Ended::Canceled, &report);
        }
        match self.pilot.begin(wanted, now_s) {
            Ok(()) => self.drives_for = Some(client),
            Err(ended) => {
                self.pilot.stop();
                self.say(&format!("the goal is refused: {}", ended.code(Family::Navigate).1));
                self.tell(client, GoalStatus::Aborted, &ended, &Report::default());
            }
        }
    }

    /// Gives up the goal of a client.
    fn give_up(&mut self, client: Client, now_s: f64) {
        let report = self.pilot.report(now_s).unwrap_or_default();
        if self.drives_for == Some(client) {
            self.pilot.stop();
            self.drives_for = None;
        }
        self.tell(client, GoalStatus::Canceled, &Ended::Canceled, &report);
    }

    /// Tells a client how its goal ended.
    fn tell(&mut self, client: Client, status: GoalStatus, ended: &Ended, report: &Report) {
        if let Client::Action(index, id) = client {
            self.served[index].end(id, status, ended, report);
        }
    }

    /// One cycle of control.
    fn cycle(&mut self, now_s: f64) {
        let Cycle { command, ended, waits } = self.pilot.cycle(now_s);
        self.cycles += 1;
        if self.drives_for.is_some() || self.moves {
            self.command(command);
        }
        match waits {
            Some(why) if self.drives_for.is_some() => {
                self.say(&format!("the robot stands: {why}"));
            }
            Some(_) => {}
            None => self.said.clear(),
        }
        if let Some((ended, report)) = ended
            && let Some(client) = self.drives_for.take()
        {
            let is_reached = ended == Ended::Succeeded;
            let status = if is_reached { GoalStatus::Succeeded } else { GoalStatus::Aborted };
            if !is_reached {
                self.say(&format!("the goal is not reached: {}", ended.code(Family::Navigate).1));
            }
            self.tell(client, status, &ended, &report);
        }
        self.publish_route(now_s);
        self.feed_back(now_s);
    }

    fn command(&mut self, command: Velocity) {
        self.moves = command != Velocity::ZERO;
        match &self.outboxes.command {
            Commands::Plain(outbox) => outbox.publish(command.into()),
            Commands::Stamped(outbox) => {
                let stamp_s = self.clock.now_s().unwrap_or_default();
                let header = Header::new(stamp_s, &self.settings.frames.base);
                outbox.publish(TwistStamped { header, twist: command.into() });
            }
        }
    }

    /// Publishes the route, if it is a new one.
    fn publish_route(&mut self, now_s: f64) {
        let Some(navigator) = self.pilot.navigator() else { return };
        let planned = navigator.routes_planned();
        let Some(route) = navigator.route().filter(|_| planned != self.routes_published) else {
            return;
        };
        self.routes_published = planned;
        let header = Header::new(now_s, &self.settings.frames.map);
        let heading_rad = navigator.goal().and_then(|goal| goal.heading_rad);
        self.outboxes.plan.publish(Path::along(&header, route.smoothed.points(), heading_rad));
    }

    /// Tells the client how far its robot is, in every other cycle.
    fn feed_back(&self, now_s: f64) {
        let Some(Client::Action(index, id)) = self.drives_for else { return };
        if !self.cycles.is_multiple_of(2) {
            return;
        }
        if let Some(report) = self.pilot.report(now_s) {
            let told = Told { now_s, frame: &self.settings.frames.map };
            self.served[index].feed_back(id, &report, told);
        }
    }

    /// Says something, once.
    fn say(&mut self, what: &str) {
        // Numbers in it change from cycle to cycle.
        let kind: String = what.chars().filter(|letter| !letter.is_ascii_digit()).collect();
        if self.said != kind {
            eprintln!("keyway-ros: {what}");
            self.said = kind;
        }
    }
}
