//! Command line and environment, as in all ROS 2 programs: `--ros-args`, and the variables that
//! configure the network.

use crate::error::StartError;
use std::path::PathBuf;

/// A command line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Arguments {
    /// Print the help and exit.
    pub(crate) help: bool,
    /// Print the version and exit.
    pub(crate) version: bool,
    /// Node name that replaces the default.
    pub(crate) node: Option<String>,
    pub(crate) namespace: Option<String>,
    /// Remapping rules: names of topics, services and actions, and their replacements.
    pub(crate) remappings: Vec<(String, String)>,
    /// Parameters and their values, as YAML, in the given order.
    pub(crate) parameters: Vec<(String, String)>,
    pub(crate) parameter_files: Vec<PathBuf>,
}

impl Arguments {
    /// Default node name.
    pub(crate) const NODE: &str = "keyway";

    /// Parses the arguments after the program name.
    pub(crate) fn parse(arguments: impl IntoIterator<Item = String>) -> Result<Self, StartError> {
        let mut parsed = Self::default();
        let mut arguments = arguments.into_iter();
        let mut is_of_ros = false;
        while let Some(argument) = arguments.next() {
            let mut value = || {
                arguments.next().ok_or_else(|| StartError::ArgumentWithoutValue(argument.clone()))
            };
            match (argument.as_str(), is_of_ros) {
                ("-h" | "--help", false) => parsed.help = true,
                ("-V" | "--version", false) => parsed.version = true,
                ("--ros-args", _) => is_of_ros = true,
                ("--", true) => is_of_ros = false,
                ("-r" | "--remap", true) => parsed.remappings.push(rule(&value()?)?),
                ("-p" | "--param", true) => parsed.parameters.push(rule(&value()?)?),
                ("--params-file", true) => parsed.parameter_files.push(value()?.into()),
                // Log levels are accepted and ignored: the node logs little.
                ("--log-level" | "--log-config-file" | "-e" | "--enclave", true) => {
                    value()?;
                }
                (flag, true) if flag.ends_with("-logs") => {}
                _ => return Err(StartError::UnknownArgument(argument)),
            }
        }
        parsed.take_names()?;
        Ok(parsed)
    }

    /// Name of the node.
    pub(crate) fn node_name(&self) -> &str {
        self.node.as_deref().unwrap_or(Self::NODE)
    }

    /// Namespace of the node.
    pub(crate) fn namespace(&self) -> &str {
        self.namespace.as_deref().unwrap_or("/")
    }

    /// Extracts the name and namespace of the node from the rules, and drops the rules for other
    /// nodes. Rules may precede the node name.
    fn take_names(&mut self) -> Result<(), StartError> {
        let names_node =
            |name| matches!(for_node(name), (None | Some(Self::NODE), "__node" | "__name"));
        let named = self.remappings.iter().find(|(from, _)| names_node(from));
        self.node = named.map(|(_, to)| to.clone());
        if let Some(name) = self.node.clone().filter(|name| !is_name(name)) {
            return Err(StartError::Node(name));
        }
        let node = self.node_name().to_owned();
        for rules in [&mut self.remappings, &mut self.parameters] {
            rules.retain(|(name, _)| for_node(name).0.is_none_or(|of| of == node));
            for (name, _) in rules {
                *name = for_node(name).1.to_owned();
            }
        }
        let namespace = self.remappings.iter().find(|(from, _)| from == "__ns");
        self.namespace = namespace.map(|(_, to)| to.clone());
        if let Some(namespace) = self.namespace.clone().filter(|name| !is_namespace(name)) {
            return Err(StartError::Namespace(namespace));
        }
        self.remappings.retain(|(from, _)| !["__node", "__name", "__ns"].contains(&from.as_str()));
        let topics = self.remappings.iter().flat_map(|(from, to)| [from, to]);
        match topics.into_iter().find(|name| !is_topic(name)) {
            Some(name) => Err(StartError::Topic(name.clone())),
            None => Ok(()),
        }
    }

    /// Full name of a topic, a service or an action, after the first matching remapping rule.
    pub(crate) fn remapped(&self, name: &str) -> String {
        let namespace = self.namespace();
        // Names that begin with `~` are in the node's own namespace.
        let full = |name: &str| match name.strip_prefix("~/") {
            Some(own) => full_name(&format!("{}/{own}", self.node_name()), namespace),
            None => full_name(name, namespace),
        };
        let rule = self.remappings.iter().find(|(from, _)| full(from) == full(name));
        full(rule.map_or(name, |(_, to)| to))
    }
}

/// True for letters, digits and underscores that do not begin with a digit.
fn is_name(text: &str) -> bool {
    let is_word = text.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
    is_word && text.bytes().next().is_some_and(|first| !first.is_ascii_digit())
}

/// True for `/`, and for names with a slash before each of them.
fn is_namespace(text: &str) -> bool {
    text == "/" || text.strip_prefix('/').is_some_and(|names| names.split('/').all(is_name))
}

/// True for names separated by slashes, optionally after `/` or `~/`.
fn is_topic(text: &str) -> bool {
    let names = text.strip_prefix("~/").or_else(|| text.strip_prefix('/')).unwrap_or(text);
    names.split('/').all(is_name)
}

/// A name with its namespace.
pub(crate) fn full_name(name: &str, namespace: &str) -> String {
    if name.starts_with('/') {
        return name.to_owned();
    }
    format!("{}/{name}", namespace.trim_end_matches('/'))
}

/// The node that a rule is for, if it is for a single one, and the rest of the rule.
fn for_node(name: &str) -> (Option<&str>, &str) {
    name.split_once(':').map_or((None, name), |(node, rest)| (Some(node), rest))
}

/// The two sides of `a:=b`.
fn rule(text: &str) -> Result<(String, String), StartError> {
    let (from, to) = text.split_once(":=").ok_or_else(|| StartError::NoRule(text.to_owned()))?;
    if from.is_empty() || to.is_empty() {
        return Err(StartError::NoRule(text.to_owned()));
    }
    Ok((from.to_owned(), to.to_owned()))
}

/// Network settings of the environment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Network {
    /// Robots in different domains do not see each other.
    pub(crate) domain: u16,
    /// Restricted to this machine.
    pub(crate) is_local: bool,
}

impl Network {
    /// The highest domain: the ports of higher ones would exceed the valid range.
    const LAST_DOMAIN: u16 = 232;

    /// Reads the variables by their names.
    pub(crate) fn of_environment(
        variable: impl Fn(&str) -> Option<String>,
    ) -> Result<Self, StartError> {
        const DOMAIN: &str = "ROS_DOMAIN_ID";
        const RANGE: &str = "ROS_AUTOMATIC_DISCOVERY_RANGE";
        const LOCAL: &str = "ROS_LOCALHOST_ONLY";
        let set = |name| variable(name).filter(|value| !value.is_empty());
        let wrong = |name, value: String, expected| StartError::Variable { name, value, expected };
        let domain = match set(DOMAIN) {
            None => 0,
            Some(text) => match text.parse() {
                Ok(domain) if domain <= Self::LAST_DOMAIN => domain,
                _ => return Err(wrong(DOMAIN, text, "a whole number from 0 to 232")),
            },
        };
        // As in ROS, the older variable has priority if it is set.
        let is_local = match (set(LOCAL).as_deref(), set(RANGE)) {
            (Some("1"), _) => true,
            (Some("0") | None, None) => false,
            (Some("0") | None, Some(range)) => match range.as_str() {
                "LOCALHOST" => true,
                "SUBNET" | "SYSTEM_DEFAULT" => false,
                _ => {
                    let expected = "SUBNET, LOCALHOST or SYSTEM_DEFAULT";
                    return Err(wrong(RANGE, range, expected));
                }
            },
            (Some(other), _) => return Err(wrong(LOCAL, other.to_owned(), "0 or 1")),
        };
        Ok(Self { domain, is_local })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Arguments, StartError> {
        Arguments::parse(text.split_whitespace().map(str::to_owned))
    }

    #[test]
    fn rules_of_ros() {
        let text = "--ros-args -r __ns:=/r1 --remap __node:=nav -r cmd_vel:=motors -r cmd_vel:=wheels -p robot:=jackal \
                    -p nav:rate:=10 -p other:rate:=5 --params-file a.yaml --log-level debug \
                    --disable-rosout-logs --";
        let parsed = parse(text).unwrap();
        assert_eq!((parsed.node_name(), parsed.namespace.as_deref()), ("nav", Some("/r1")));
        assert_eq!(parsed.remapped("cmd_vel"), "/r1/motors");
        assert_eq!(parsed.remapped("/r1/cmd_vel"), "/r1/motors");
        assert_eq!(parsed.remapped("scan"), "/r1/scan");
        assert_eq!(parsed.remapped("/tf"), "/tf");
        assert_eq!(parsed.remapped("~/state"), "/r1/nav/state");
        assert_eq!(Arguments::default().remapped("scan"), "/scan");
        let expected = [("robot", "jackal"), ("rate", "10")];
        assert!(parsed.parameters.iter().map(|(a, b)| (a.as_str(), b.as_str())).eq(expected));
        assert_eq!(parsed.parameter_files, [PathBuf::from("a.yaml")]);
        assert!(parse("--help").unwrap().help && parse("-V").unwrap().version);
        assert_eq!(parse("").unwrap(), Arguments::default());
    }

    #[test]
    fn rules_may_stand_before_the_name_of_the_node() {
        let text = "--ros-args -p nav:rate:=10 -p keyway:rate:=5 -r nav:scan:=front -r nav:__ns:=/a \
                    -r __node:=nav";
        let parsed = parse(text).unwrap();
        assert_eq!(parsed.parameters, [("rate".to_owned(), "10".to_owned())]);
        assert_eq!(parsed.remapped("scan"), "/a/front");
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (text, said) in [
            ("--robot x", "--robot"),
            ("--ros-args -r cmd_vel", "cmd_vel"),
            ("--ros-args -r", "-r"),
            ("--ros-args -p a:=", "a:="),
            ("--ros-args -r __ns:=r1", "r1"),
            ("--ros-args -r __ns:=/a//b", "/a//b"),
            ("--ros-args -r __ns:=/1a", "/1a"),
            ("--ros-args -r __ns:=/a/", "/a/"),
            ("--ros-args -r __node:=a/b", "`a/b`"),
            ("--ros-args -r scan:=front//scan", "`front//scan`"),
            ("--ros-args -r scan:=/1/scan", "`/1/scan`"),
        ] {
            let message = parse(text).unwrap_err().to_string();
            assert!(message.contains(said), "{message}");
        }
    }

    #[test]
    fn the_environment_chooses_the_network() {
        let network = |variables: &[(&str, &str)]| {
            let variable = |name: &str| {
                variables
                    .iter()
                    .find(|(other, _)| *other == name)
                    .map(|(_, value)| (*value).to_owned())
            };
            Network::of_environment(variable)
        };
        assert_eq!(network(&[]).unwrap(), Network { domain: 0, is_local: false });
        let local = network(&[("ROS_DOMAIN_ID", "7"), ("ROS_LOCALHOST_ONLY", "1")]).unwrap();
        assert_eq!(local, Network { domain: 7, is_local: true });
        let range = [("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")];
        assert!(network(&range).unwrap().is_local);
        for wrong in [
            ("ROS_DOMAIN_ID", "233"),
            ("ROS_DOMAIN_ID", "x"),
            ("ROS_LOCALHOST_ONLY", "yes"),
            ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"),
        ] {
            let message = network(&[wrong]).unwrap_err().to_string();
            assert!(message.contains(wrong.0) && message.contains(wrong.1), "{message}");
        }
    }
}
