//! The program `keyway-ros`.

use std::process::ExitCode;

fn main() -> ExitCode {
    match keyway_ros::run(std::env::args().skip(1)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("keyway-ros: {error}");
            ExitCode::from(2)
        }
    }
}
