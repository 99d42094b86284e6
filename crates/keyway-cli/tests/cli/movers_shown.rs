//! Tests of moving obstacles in pictures: a walker that moves to and fro, which the robot
//! approaches and then passes by a detour.

use crate::support::{folder, keyway, read};
use std::path::Path;

/// True if the picture of the candidates at a time contains this text.
#[track_caller]
fn fan_says(time_s: &str, text: &str) -> bool {
    let folder = folder();
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/complaints/pacing.toml");
    let line = format!("navigate --scene {} --out run --fan {time_s}", scene.display());
    keyway(folder.path(), &line).expect_code(0);
    read(&folder, "run/fan.svg").contains(&format!(">{text}</text>"))
}

#[test]
fn what_is_followed_has_the_number_of_its_track() {
    assert!(fan_says("3", "track 2"));
}

#[test]
fn what_moves_is_called_so() {
    assert!(fan_says("3", "moving obstacle") && fan_says("3", "unknown obstacle"));
}

#[test]
fn what_is_gone_around_is_shown_while_it_is() {
    let label = "area avoided by the route";
    assert!(!fan_says("1", label) && fan_says("4", label));
}
