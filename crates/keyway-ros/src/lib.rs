//! Keyway as a node of ROS 2: it takes a map, scans, odometry and transforms, and drives to goals,
//! by the names that Nav2 gives to all of them. It needs no ROS installation.
//!
//! It is a shell over [`keyway::Navigator`], without any logic of driving of its own.
//!
//! | module | holds |
//! |---|---|
//! | `arguments` | the command line and the environment of ROS |
//! | `settings` | parameters, and what they make: a robot, a stack, names of frames and topics |
//! | `messages` | messages of ROS as values |
//! | `transforms` | where frames are, by time |
//! | `pilot` | messages -> what the navigator observes -> commands and outcomes; no network |
//! | `served` | the actions: what their goals want, how their outcomes are written |
//! | `clock` | the time of the machine, or of a simulation |
//! | `costmaps`, `pictures` | costmaps to look at, drawn beside control |
//! | `wire` | the only module that knows the network |
//! | `node` | the loop between `wire` and `pilot` |
//! | `simulator` | a robot in the world of a scene, in the place of a real one |

mod arguments;
mod clock;
mod costmaps;
mod error;
mod messages;
mod node;
mod pictures;
mod pilot;
mod served;
mod settings;
mod simulator;
mod transforms;
mod wire;

pub use error::StartError;

use arguments::{Arguments, Network};
use node::Node;
use pilot::Pilot;
use settings::{Settings, SimulatorSettings};
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use simulator::Simulator;
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Runs the node with the arguments after the name of the program, until it is told to stop (by
/// SIGINT, SIGTERM or SIGQUIT, or the end of its terminal), or prints what it was asked for.
///
/// # Errors
/// An argument, a parameter or a variable of the environment that cannot be used, or a network that
/// does not work.
pub fn run(arguments: impl IntoIterator<Item = String>) -> Result<(), StartError> {
    let mut arguments = arguments.into_iter().peekable();
    let is_simulator = arguments.next_if(|first| first == "sim").is_some();
    let is_scene = |argument: &String| is_simulator && !argument.starts_with('-');
    let scene = arguments.next_if(is_scene);
    let arguments = Arguments::parse(arguments)?;
    if arguments.help {
        return print(&help());
    }
    if arguments.version {
        return print(&format!("keyway-ros {}\n", env!("CARGO_PKG_VERSION")));
    }
    wire::notice_panics();
    let distro = variable("ROS_DISTRO");
    let network = Network::of_environment(variable)?;
    let is_over = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM, SIGQUIT, SIGHUP] {
        // Under `nohup` the end of the terminal is to change nothing.
        if !is_ignored(signal) {
            signal_hook::flag::register(signal, Arc::clone(&is_over)).map_err(|error| {
                StartError::Network { what: "listen to signals".to_owned(), why: error.to_string() }
            })?;
        }
    }
    if is_simulator {
        let scene = scene.ok_or_else(|| StartError::ArgumentWithoutValue("sim".to_owned()))?;
        let node = arguments.node.clone().or_else(|| Some("simulator".to_owned()));
        let arguments = Arguments { node, ..arguments };
        let settings = SimulatorSettings::of(&arguments, distro.as_deref())?;
        return Simulator::new(Path::new(&scene), &arguments, network, settings)?.run(&is_over);
    }
    let pilot = Pilot::new(Settings::of(&arguments, distro.as_deref())?);
    Node::new(&arguments, network, pilot)?.run(&is_over)
}

/// Says something to whoever has started the program. Where nobody can read it, the robot goes on.
pub(crate) fn say(what: impl Display) {
    _ = writeln!(std::io::stderr(), "keyway-ros: {what}");
}

/// Prints what was asked for; a reader who has gone is no fault.
fn print(text: &str) -> Result<(), StartError> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(StartError::Output(error.to_string()))
        }
        _ => Ok(()),
    }
}

/// True for a signal that the program was started to ignore, as far as the system tells.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|bits| u64::from_str_radix(bits.trim(), 16).ok());
    ignored.is_some_and(|bits| bits >> (signal - 1) & 1 == 1)
}

fn variable(name: &str) -> Option<String> {
    std::env::var(name).ok()
}

fn help() -> String {
    let [parameters, of_simulator] = settings::help();
    format!(
        "Keyway as a node of ROS 2: drives a robot to goals, by the names that Nav2 gives to topics and actions\n\n\
         Usage: keyway-ros --ros-args -p robot:=NAME|FILE [ARGUMENTS OF ROS]\n       \
         keyway-ros sim SCENE.toml [--ros-args ARGUMENTS OF ROS]: a robot in a simulated world\n\n\
         Arguments of ROS, after --ros-args:\n  \
         -r, --remap FROM:=TO    another name; __node and __ns for those of the node\n  \
         -p, --param NAME:=VALUE a parameter\n  \
         --params-file FILE      parameters from a file (YAML)\n\n\
         Parameters, and their defaults:\n{parameters}\n\n\
         Parameters of the simulator:\n{of_simulator}\n\n\
         Environment: ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_DISTRO\n"
    )
}
