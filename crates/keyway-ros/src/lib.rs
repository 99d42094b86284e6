//! Keyway as a ROS 2 node: it receives a map, scans, odometry and transforms, and drives to
//! goals. Its topics, services and actions have the names of Nav2. It needs no ROS installation.
//!
//! It is a shell over [`keyway::Navigator`], without driving logic of its own.
//!
//! | module | holds |
//! |---|---|
//! | `arguments` | the command line and the environment of ROS |
//! | `settings` | parameters, converted to a robot, a stack, names of frames and topics |
//! | `messages` | messages of ROS as Rust types |
//! | `transforms` | poses of frames, by time |
//! | `pilot` | messages -> observations of the navigator -> commands and outcomes; no network |
//! | `served` | the actions: tasks of their goals, messages of their outcomes |
//! | `clock` | system time, or simulated time |
//! | `costmaps`, `pictures` | costmaps for display, drawn in a separate thread |
//! | `wire` | the only module that knows the network |
//! | `node` | the loop between `wire` and `pilot` |
//! | `simulator` | a simulated robot in the world of a scene |

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

/// Runs the node until it is stopped (by SIGINT, SIGTERM or SIGQUIT, or the end of its terminal),
/// or prints the help or version. `arguments` are those after the program name.
///
/// # Errors
/// Returns [`StartError`] for an invalid argument, parameter or environment variable, or if the
/// network fails.
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
        // Under `nohup` the end of the terminal is ignored.
        if !is_ignored(signal) {
            signal_hook::flag::register(signal, Arc::clone(&is_over)).map_err(|error| {
                StartError::Network { what: "handle signals".to_owned(), why: error.to_string() }
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

/// Logs a message to the standard error. The robot continues if it cannot be written.
pub(crate) fn say(what: impl Display) {
    _ = writeln!(std::io::stderr(), "keyway-ros: {what}");
}

/// Prints a text; a broken pipe is not an error.
fn print(text: &str) -> Result<(), StartError> {
    match std::io::stdout().write_all(text.as_bytes()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(StartError::Output(error.to_string()))
        }
        _ => Ok(()),
    }
}

/// True if the parent process set the signal to be ignored, as far as the system reports it.
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
        "Keyway as a ROS 2 node: drives a robot to goals, with the topics and actions of Nav2\n\n\
         Usage: keyway-ros --ros-args -p robot:=NAME|FILE [ARGUMENTS OF ROS]\n       \
         keyway-ros sim SCENE.toml [--ros-args ARGUMENTS OF ROS]: a robot in a simulated world\n\n\
         Arguments of ROS, after --ros-args:\n  \
         -r, --remap FROM:=TO    rename a topic or an action; __node and __ns set the node's name and namespace\n  \
         -p, --param NAME:=VALUE a parameter\n  \
         --params-file FILE      parameters from a file (YAML)\n\n\
         Parameters, and their defaults:\n{parameters}\n\n\
         Parameters of the simulator:\n{of_simulator}\n\n\
         Environment: ROS_DOMAIN_ID, ROS_LOCALHOST_ONLY, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_DISTRO\n"
    )
}
