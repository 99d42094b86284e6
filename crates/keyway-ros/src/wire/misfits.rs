//! Detection of incompatible nodes on the topics of this one: the network itself does not report
//! them.

use super::Named;
use ros2_client::dds::rustdds::{DomainParticipant, QosPolicies};
use ros2_client::{MessageTypeName, QosProfile};
use std::collections::BTreeSet;

/// The topics of this node, and the reported incompatibilities.
pub(super) struct Misfits {
    participant: DomainParticipant,
    topics: Vec<Topic>,
    said: BTreeSet<String>,
}

/// A topic of this node.
struct Topic {
    /// With its namespace.
    name: String,
    /// The message type, as named by the network.
    kind: String,
    way: Way,
    qos: QosPolicies,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    In,
    Out,
}

impl Misfits {
    pub(super) const fn new(participant: DomainParticipant) -> Self {
        Self { participant, topics: Vec::new(), said: BTreeSet::new() }
    }

    /// Adds a topic of this node.
    pub(super) fn add<M: Named>(&mut self, name: String, way: Way, qos: QosProfile) {
        let (package, kind) = M::NAME;
        let kind = MessageTypeName::new(package, kind).dds_msg_type();
        self.topics.push(Topic { name, kind, way, qos: qos.into() });
    }

    /// The current incompatibilities of other nodes on the topics of this one.
    pub(super) fn now(&self) -> BTreeSet<String> {
        let readers = self.participant.discovered_readers();
        let writers = self.participant.discovered_writers();
        let of_readers = readers.iter().map(|reader| {
            let topic = &reader.subscription_topic_data;
            (Way::Out, topic.topic_name(), topic.type_name(), topic.qos())
        });
        let of_writers = writers.iter().map(|writer| {
            let topic = &writer.publication_topic_data;
            (Way::In, topic.topic_name(), &topic.type_name, topic.qos())
        });
        let mut found = BTreeSet::new();
        for (way, name, kind, qos) in of_readers.chain(of_writers) {
            let Some(name) = name.strip_prefix("rt") else { continue };
            let topics = self.topics.iter().filter(|own| own.way == way && own.name == name);
            found.extend(topics.filter_map(|own| own.misfit(kind, &qos)));
        }
        found
    }

    /// Those that are not reported yet.
    pub(super) fn untold(&mut self, now: &BTreeSet<String>) -> Vec<String> {
        let untold: Vec<String> = now.difference(&self.said).cloned().collect();
        // One that disappears and returns is reported again.
        self.said.clone_from(now);
        untold
    }
}

impl Topic {
    /// The reason why another node is incompatible, from its message type and quality of service.
    fn misfit(&self, kind: &str, qos: &QosPolicies) -> Option<String> {
        let name = &self.name;
        let [theirs, ours] = match self.way {
            Way::In => ["sends", "expects"],
            Way::Out => ["expects", "sends"],
        };
        if kind != self.kind {
            let (other, own) = (in_words(kind), in_words(&self.kind));
            return Some(format!(
                "{name}: another node {theirs} {other}, but this node {ours} {own}"
            ));
        }
        let (offered, requested) = match self.way {
            Way::In => (qos, &self.qos),
            Way::Out => (&self.qos, qos),
        };
        let policy = offered.compliance_failure_wrt(requested)?;
        let policy = format!("{policy:?}").to_lowercase();
        let sender = match self.way {
            Way::In => "another node sends",
            Way::Out => "this node sends",
        };
        Some(format!("{name}: {sender} with less {policy} than the receiver requests"))
    }
}

/// A message type by the name that users know.
fn in_words(kind: &str) -> String {
    kind.replace("::dds_::", "/").replace("::", "/").trim_end_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Delivery;

    fn topic(way: Way, delivery: Delivery) -> Topic {
        let kind = "geometry_msgs::msg::dds_::TwistStamped_".to_owned();
        Topic { name: "/cmd_vel".to_owned(), kind, way, qos: delivery.qos(1).into() }
    }

    #[test]
    fn another_kind_of_message_does_not_fit() {
        let qos = Delivery::Reliable.qos(1).into();
        let own = topic(Way::Out, Delivery::Reliable);
        assert_eq!(own.misfit(&own.kind, &qos), None);
        let said = own.misfit("geometry_msgs::msg::dds_::Twist_", &qos).unwrap();
        let expected = "/cmd_vel: another node expects geometry_msgs/msg/Twist, but this node sends \
                        geometry_msgs/msg/TwistStamped";
        assert_eq!(said, expected);
        let said = topic(Way::In, Delivery::Reliable).misfit("a::msg::dds_::B_", &qos).unwrap();
        assert!(said.contains("another node sends a/msg/B, but this node expects"), "{said}");
    }

    #[test]
    fn a_receiver_may_ask_for_no_more_than_is_sent() {
        use Delivery::{BestEffort, Latched, Reliable};
        for (sent, asked, policy) in [
            (Latched, Reliable, None),
            (Latched, BestEffort, None),
            (Reliable, Reliable, None),
            (Reliable, Latched, Some("durability")),
            (BestEffort, Reliable, Some("reliability")),
        ] {
            let out = topic(Way::Out, sent);
            let said = out.misfit(&out.kind, &asked.qos(1).into());
            let expected = |sender: &str| {
                policy.map(|policy| {
                    format!(
                        "/cmd_vel: {sender} sends with less {policy} than the receiver requests"
                    )
                })
            };
            assert_eq!(said, expected("this node"));
            let into = topic(Way::In, asked);
            let said = into.misfit(&into.kind, &sent.qos(1).into());
            assert_eq!(said, expected("another node"));
        }
    }
}
