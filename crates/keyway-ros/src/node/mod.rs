//! The main loop of the node: messages from the network are passed to the pilot, and in every
//! cycle the commands of the pilot are published.

mod inboxes;
mod outboxes;
mod timing;

use crate::arguments::{Arguments, Network};
use crate::clock::Clock;
use crate::error::StartError;
use crate::messages::builtin_interfaces::Time;
use crate::pilot::{Cycle, Ended, Family, Fault, Pilot, Report, Waits, Wanted};
use crate::served::{Answered, Served, Told, Wish, answered, served};
use crate::settings::Settings;
use crate::wire::{GoalId, GoalStatus, Inbox, Wire};
use inboxes::Inboxes;
use keyway::geometry::Velocity;
use outboxes::Outboxes;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use timing::Timing;

/// The node.
pub(crate) struct Node {
    wire: Wire,
    pilot: Pilot,
    settings: Settings,
    clock: Clock,
    inboxes: Inboxes,
    outboxes: Outboxes,
    /// Actions that drive the robot.
    served: Vec<Box<dyn Served>>,
    answered: Vec<Box<dyn Answered>>,
    /// The client of the current goal.
    drives_for: Option<Client>,
    /// True if the last published command was nonzero.
    moves: bool,
    cycles: u64,
    began: Instant,
    /// True once all inputs were available.
    was_ready: bool,
    timing: Timing,
    /// The last log message about a stationary robot.
    said: String,
}

/// The client that the robot drives for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Client {
    Topic,
    /// The client of an action, by the index of its server.
    Action(usize, GoalId),
}

impl Node {
    /// Delay after the start before missing inputs are logged.
    const PATIENCE: Duration = Duration::from_secs(5);

    /// Joins the network with a pilot.
    pub(crate) fn new(
        arguments: &Arguments,
        network: Network,
        pilot: Pilot,
    ) -> Result<Self, StartError> {
        let mut wire = Wire::open(arguments, network, &pilot.settings().declared())?;
        let settings = pilot.settings().clone();
        let inboxes = Inboxes::new(&mut wire, &settings)?;
        let outboxes = Outboxes::new(&mut wire, &settings)?;
        let served = served(&mut wire, settings.distribution)?;
        let answered = answered(&mut wire, settings.distribution, &settings.stands_for)?;
        let timing = Timing::new(settings.stack.robot().cycle_s);
        Ok(Self {
            wire,
            pilot,
            clock: Clock::new(settings.use_sim_time),
            settings,
            inboxes,
            outboxes,
            served,
            answered,
            drives_for: None,
            moves: false,
            cycles: 0,
            began: Instant::now(),
            was_ready: false,
            timing,
            said: String::new(),
        })
    }

    /// Runs until it is stopped; the robot is then commanded to stop.
    ///
    /// # Errors
    /// Returns [`StartError`] if the network has failed.
    pub(crate) fn run(mut self, is_over: &Arc<AtomicBool>) -> Result<(), StartError> {
        let period = Duration::from_secs_f64(self.timing.period_s());
        let mut next = Instant::now();
        while !is_over.load(Ordering::Relaxed) {
            Wire::check()?;
            if self.wire.take_halt() {
                self.end_after_halt();
            }
            self.wire.wait(next.saturating_duration_since(Instant::now()));
            self.receive();
            let now = Instant::now();
            let is_due = now >= next;
            if is_due {
                self.timing.note_delay(now - next);
                // Missed cycles are not made up for.
                next = (next + period).max(now);
            }
            // A simulation may be faster than real time.
            if (is_due || self.settings.use_sim_time)
                && let Some(now_s) = self.clock.next_cycle_s(period.as_secs_f64())
            {
                self.cycle(now_s);
            }
        }
        self.command(Velocity::ZERO);
        if let Some(client) = self.drives_for.take() {
            let report = Report::default();
            self.tell(client, GoalStatus::Aborted, &Ended::Canceled, &report);
        }
        Ok(())
    }

    /// Logs the missing inputs until all were available once; while driving, logs the reason for
    /// a stationary robot.
    fn explain(&mut self, waits: Option<Waits>) {
        let is_late = self.began.elapsed() > Self::PATIENCE;
        match waits {
            Some(why) if self.drives_for.is_some() => {
                self.say(&format!("the robot is stationary: {why}"));
            }
            Some(why) if !self.was_ready && is_late => self.say(&format!("waiting: {why}")),
            Some(_) => {}
            None => {
                self.was_ready = true;
                self.said.clear();
            }
        }
    }

    /// Stops after a halt of the process: people near a stationary robot do not expect it to
    /// start again by itself.
    fn end_after_halt(&mut self) {
        let Some(client) = self.drives_for.take() else { return };
        self.say("the process was halted: the robot stops, and its goal is aborted");
        self.pilot.stop();
        self.command(Velocity::ZERO);
        let ended = Ended::failed(Fault::Unknown, "the process was halted");
        self.tell(client, GoalStatus::Aborted, &ended, &Report::default());
    }

    /// Processes all received messages.
    fn receive(&mut self) {
        for message in self.inboxes.clock.iter().flat_map(Inbox::take_all) {
            self.clock.tell(message.clock.stamp_s());
        }
        if self.clock.take_restart() {
            self.say("the clock was reset: earlier sensor data is discarded");
            self.pilot.restart_clock();
        }
        for change in self.wire.changes() {
            self.pilot.change(&change);
        }
        self.inboxes.receive_sensed(&mut self.pilot);
        for fault in self.inboxes.receive_known(&mut self.pilot, &mut self.wire) {
            self.say(&fault);
        }
        let Some(now_s) = self.clock.now_s() else {
            if self.began.elapsed() > Self::PATIENCE {
                self.say("`use_sim_time` is set, but no message on /clock has arrived: the node waits for it");
            }
            return;
        };
        if let Some(goal) = self.inboxes.goal_pose.take_all().pop() {
            self.begin(Client::Topic, Wanted::Poses(vec![goal]), now_s);
        }
        self.receive_goals(now_s);
    }

    /// Processes the goals of action clients.
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

    /// Starts the goal of a client, in place of the previous one.
    fn begin(&mut self, client: Client, wanted: Wanted, now_s: f64) {
        if let Some(before) = self.drives_for.take() {
            // As in Nav2, a preempted goal is aborted, without an error.
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

    /// Cancels the goal of a client.
    fn give_up(&mut self, client: Client, now_s: f64) {
        let report = self.pilot.report(now_s).unwrap_or_default();
        if self.drives_for == Some(client) {
            self.pilot.stop();
            self.drives_for = None;
        }
        self.tell(client, GoalStatus::Canceled, &Ended::Canceled, &report);
    }

    /// Reports the end of a goal to its client.
    fn tell(&mut self, client: Client, status: GoalStatus, ended: &Ended, report: &Report) {
        if let Client::Action(index, id) = client {
            self.served[index].end(id, status, ended, report);
        }
    }

    /// Runs one control cycle.
    fn cycle(&mut self, now_s: f64) {
        let began = Instant::now();
        let Cycle { command, ended, waits } = self.pilot.cycle(now_s);
        self.timing.note(began.elapsed(), waits.clone());
        self.cycles += 1;
        if self.drives_for.is_some() || self.moves {
            self.command(command);
        }
        self.explain(waits);
        if let Some((ended, report)) = ended
            && let Some(client) = self.drives_for.take()
        {
            let is_reached = ended == Ended::Succeeded;
            let status = if is_reached { GoalStatus::Succeeded } else { GoalStatus::Aborted };
            if !is_reached {
                self.say(&format!("the goal was not reached: {}", ended.code(Family::Navigate).1));
            }
            self.tell(client, status, &ended, &report);
        }
        self.feed_back(now_s);
        self.outboxes.show(&self.pilot, &mut self.wire, &mut self.timing, now_s);
    }

    fn command(&mut self, command: Velocity) {
        self.moves = command != Velocity::ZERO;
        let stamp_s = self.clock.now_s().unwrap_or_default();
        self.outboxes.command(command, (stamp_s, &self.settings.frames.base));
    }

    /// Sends feedback to the client, in every other cycle.
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

    /// Logs a message, once.
    fn say(&mut self, what: &str) {
        // Digits are ignored, as numbers change from cycle to cycle.
        let kind: String = what.chars().filter(|letter| !letter.is_ascii_digit()).collect();
        if self.said != kind {
            self.wire.say(what);
            self.said = kind;
        }
    }
}

/// However the node ends, its last command is to stop.
impl Drop for Node {
    fn drop(&mut self) {
        if self.moves {
            self.command(Velocity::ZERO);
        }
    }
}
