//! The program `keyway-ros`.

use std::io::Write;
use std::process::ExitCode;

fn main() -> ExitCode {
    // Arguments that are not valid Unicode are never valid: they are refused in their lossy form.
    let arguments = std::env::args_os().skip(1);
    match keyway_ros::run(arguments.map(|argument| argument.to_string_lossy().into_owned())) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            _ = writeln!(std::io::stderr(), "keyway-ros: {error}");
            ExitCode::from(2)
        }
    }
}
