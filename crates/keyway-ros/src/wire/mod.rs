//! The network: the only module that knows `ros2-client`.
//!
//! Only [`Wire::wait`] blocks: inboxes are emptied whenever a message has arrived.

mod action;
mod halts;
mod misfits;
mod parameters;
mod service;

pub(crate) use action::{ActionServer, GoalEvent, GoalId, GoalStatus, Wired};
pub(crate) use service::{ServiceServer, WiredService};

use crate::arguments::{Arguments, Network};
use crate::error::StartError;
use crate::messages::nav2_msgs::{self, jazzy, kilted, services};
use crate::messages::{self, Named};
use crate::settings::Change;
use halts::Halts;
pub(crate) use halts::notice_panics;
use misfits::{Misfits, Way};
use ros2_client::dds::rustdds::{DomainParticipantBuilder, mio1};
use ros2_client::qos::{Durability, History};
use ros2_client::ros2::LogLevel;
use ros2_client::{
    Context, Message, MessageTypeName, Name, NodeName, Publisher, QosProfile, Subscription, rosout,
};
use std::collections::BTreeSet;
use std::fmt::Display;
use std::net::{IpAddr, Ipv4Addr};
use std::sync::mpsc::Receiver;
use std::time::Duration;
use toml::Value;

macro_rules! on_the_wire {
    ($($message:ty),+ $(,)?) => { $(impl Message for $message {})+ };
}

on_the_wire!(
    messages::Empty,
    messages::lifecycle_msgs::State,
    messages::std_srvs::Triggered,
    services::Command,
    services::Costmap,
    services::CostmapMetaData,
    services::LoadedMap,
    services::MapUrl,
    services::ResetDistance,
    services::Success,
    nav2_msgs::ComputePathToPoseGoal,
    nav2_msgs::ComputedPath,
    nav2_msgs::Distance,
    nav2_msgs::FollowPathFeedback,
    nav2_msgs::FollowPathGoal,
    nav2_msgs::FollowPathOutcome,
    nav2_msgs::NavigateToPoseFeedback,
    nav2_msgs::NavigateToPoseGoal,
    nav2_msgs::Outcome,
    nav2_msgs::SmoothPathGoal,
    nav2_msgs::SmoothPathOutcome,
    nav2_msgs::TimedOutcome,
    nav2_msgs::Unread,
    nav2_msgs::WaitFeedback,
    nav2_msgs::WaitGoal,
    jazzy::ComputePathThroughPosesGoal,
    jazzy::DriveGoal,
    jazzy::FollowWaypointsFeedback,
    jazzy::FollowWaypointsGoal,
    jazzy::FollowWaypointsOutcome,
    jazzy::NavigateThroughPosesFeedback,
    jazzy::NavigateThroughPosesGoal,
    jazzy::SpinGoal,
    kilted::ComputePathThroughPosesGoal,
    kilted::DriveGoal,
    kilted::FollowWaypointsOutcome,
    kilted::NavigateThroughPosesFeedback,
    kilted::NavigateThroughPosesGoal,
    kilted::NavigateThroughPosesOutcome,
    kilted::SpinGoal,
);

/// A node on the network.
pub(crate) struct Wire {
    node: ros2_client::Node,
    arguments: Arguments,
    poll: mio1::Poll,
    events: mio1::Events,
    sources: usize,
    halts: Halts,
    changed: Receiver<Change>,
    misfits: Misfits,
}

impl Drop for Wire {
    fn drop(&mut self) {
        // The spinner holds the network.
        self.node.stop_spinner();
    }
}

/// Delivery policy of a topic.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Delivery {
    /// Lost messages are not sent again: for sensors.
    BestEffort,
    Reliable,
    /// Late subscribers get the last message: for maps and static transforms.
    Latched,
}

impl Delivery {
    fn qos(self, depth: usize) -> QosProfile {
        let qos = match self {
            Self::BestEffort => QosProfile::subscription_default(),
            Self::Reliable => QosProfile::publisher_default(),
            Self::Latched => QosProfile::publisher_default().durability(Durability::TransientLocal),
        };
        qos.history(History::KeepLast { depth })
    }
}

/// An error of the network.
fn fault(what: impl Display, why: impl Display) -> StartError {
    StartError::Network { what: what.to_string(), why: why.to_string() }
}

impl Wire {
    /// Joins the network.
    pub(crate) fn open(
        arguments: &Arguments,
        network: Network,
        parameters: &[(&str, Value)],
    ) -> Result<Self, StartError> {
        let mut builder = DomainParticipantBuilder::new(network.domain);
        if network.is_local {
            builder = builder.with_only_networks([IpAddr::V4(Ipv4Addr::LOCALHOST)]);
        }
        let participant = builder.build().map_err(|error| fault("join the network", error))?;
        let misfits = Misfits::new(participant.clone());
        let context = Context::from_domain_participant(participant)
            .map_err(|error| fault("join the network", error))?;
        let name = NodeName::new(arguments.namespace(), arguments.node_name())
            .map_err(|error| fault("name the node", error))?;
        let (options, changed) = parameters::with_parameters(parameters);
        let mut node =
            context.new_node(name, options).map_err(|error| fault("create the node", error))?;
        // Discovery and the parameter services.
        let spinner = node.spinner().map_err(|error| fault("start discovery", error))?;
        std::thread::Builder::new()
            .name("discovery".to_owned())
            .spawn(move || drop(futures::executor::block_on(spinner.spin())))
            .map_err(|error| fault("start discovery", error))?;
        let poll = mio1::Poll::new().map_err(|error| fault("wait for messages", error))?;
        let events = mio1::Events::with_capacity(64);
        // Other sources have higher tokens.
        let halts = mio1::Waker::new(poll.registry(), mio1::Token(0)).and_then(Halts::watch);
        let halts = halts.map_err(|error| fault("watch for halts", error))?;
        let arguments = arguments.clone();
        Ok(Self { node, arguments, poll, events, sources: 0, halts, changed, misfits })
    }

    /// Subscribes to a topic, with a queue of `depth` messages.
    pub(crate) fn inbox<M: Named>(
        &mut self,
        topic: &str,
        delivery: Delivery,
        depth: usize,
    ) -> Result<Inbox<M>, StartError> {
        let qos = delivery.qos(depth);
        let topic_of = self.topic::<M>(topic, &qos)?;
        self.misfits.add::<M>(self.arguments.remapped(topic), Way::In, qos.clone());
        let mut subscription = self
            .node
            .create_subscription(&topic_of, Some(qos))
            .map_err(|error| fault(format_args!("subscribe to {topic}"), error))?;
        self.register(&mut subscription)?;
        Ok(Inbox { subscription })
    }

    /// Creates a publisher.
    pub(crate) fn outbox<M: Named>(
        &mut self,
        topic: &str,
        delivery: Delivery,
        depth: usize,
    ) -> Result<Outbox<M>, StartError> {
        let qos = delivery.qos(depth);
        let topic_of = self.topic::<M>(topic, &qos)?;
        self.misfits.add::<M>(self.arguments.remapped(topic), Way::Out, qos.clone());
        let publisher = self
            .node
            .create_publisher(&topic_of, Some(qos))
            .map_err(|error| fault(format_args!("publish on {topic}"), error))?;
        Ok(Outbox { publisher })
    }

    fn topic<M: Named>(
        &self,
        topic: &str,
        qos: &QosProfile,
    ) -> Result<ros2_client::dds::rustdds::Topic, StartError> {
        let (package, name) = M::NAME;
        self.node
            .create_topic(&self.name(topic)?, MessageTypeName::new(package, name), qos)
            .map_err(|error| fault(format_args!("create the topic {topic}"), error))
    }

    /// The name after the remapping rules of the command line.
    fn name(&self, name: &str) -> Result<Name, StartError> {
        let name = self.arguments.remapped(name);
        Name::parse(&name).map_err(|error| fault(format_args!("use the name {name}"), error))
    }

    fn register(&mut self, source: &mut impl mio1::event::Source) -> Result<(), StartError> {
        self.sources += 1;
        self.poll
            .registry()
            .register(source, mio1::Token(self.sources), mio1::Interest::READABLE)
            .map_err(|error| fault("wait for messages", error))
    }

    /// Parameters set by other nodes since the last call.
    pub(crate) fn changes(&self) -> impl Iterator<Item = Change> + '_ {
        self.changed.try_iter()
    }

    /// True if the process was halted since the last call.
    pub(crate) fn take_halt(&self) -> bool {
        self.halts.take()
    }

    /// Checks the network threads.
    ///
    /// # Errors
    /// Returns [`StartError`] if a thread has panicked: messages may no longer be received or
    /// sent.
    pub(crate) fn check() -> Result<(), StartError> {
        if halts::has_panicked() {
            return Err(fault("continue", "a network thread has panicked"));
        }
        Ok(())
    }

    /// True if a topic has a subscriber.
    pub(crate) fn is_heard<M: Named>(&self, outbox: &Outbox<M>) -> bool {
        outbox.publisher.get_subscription_count(&self.node) > 0
    }

    /// Logs a message to the standard error and /rosout.
    pub(crate) fn say(&self, what: &str) {
        crate::say(what);
        rosout!(self.node, LogLevel::Warn, "{what}");
    }

    /// The current incompatibilities on the topics of this node. New ones are logged.
    pub(crate) fn misfits(&mut self) -> BTreeSet<String> {
        let now = self.misfits.now();
        for misfit in self.misfits.untold(&now) {
            self.say(&misfit);
        }
        now
    }

    /// Waits for a message, but no longer than this.
    pub(crate) fn wait(&mut self, longest: Duration) {
        // A signal makes it return early, which is harmless.
        let _ = self.poll.poll(&mut self.events, Some(longest));
    }
}

/// Received messages of a topic.
pub(crate) struct Inbox<M> {
    subscription: Subscription<M>,
}

impl<M: Named> Inbox<M> {
    /// All messages received so far, in order. Undecodable ones are dropped.
    pub(crate) fn take_all(&self) -> Vec<M> {
        let mut taken = Vec::new();
        // An error consumes its message; the loop stops after this many in a row.
        let mut errors = 0;
        while errors < 16 {
            match self.subscription.take() {
                Ok(Some((message, _))) => taken.push(message),
                Ok(None) => break,
                Err(_) => errors += 1,
            }
        }
        taken
    }
}

/// A publisher of a topic.
pub(crate) struct Outbox<M: serde::Serialize> {
    publisher: Publisher<M>,
}

impl<M: Named> Outbox<M> {
    /// Publishes a message; it is lost if the queue is full.
    pub(crate) fn publish(&self, message: M) {
        drop(self.publisher.publish(message));
    }
}
