//! Tests of `keyway navigate --record`, and of `keyway replay` on recordings.

use crate::support::{folder, keyway, read, write};
use serde_json::Value;
use std::fs;
use tempfile::TempDir;

/// A drive around an unmapped post, with motor lag, noise and lost scans.
const SCENE: &str = "version = 2\nstart = [0.7, 2.0]\ngoal = [5.3, 2.0]\nseed = 3\n\
    [world]\nwidth_m = 6\nheight_m = 4\nresolution_m = 0.05\n\
    [world.obstacles.clutter]\nshare = 0.03\nradius_m = [0.1, 0.2]\n\
    [[unknown]]\nposition = [3.0, 2.0]\nradius_m = 0.2\n\
    [disturbances.actuation]\ndelay_s = 0.2\nv_relative = 0.05\n\
    [disturbances.sensor]\nrange_m = 0.02\ndropped_scans = 0.1\n";

fn recorded(options: &str) -> TempDir {
    let folder = folder();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    write(&folder, "scenes/post.toml", SCENE);
    let line = format!("navigate --scene scenes/post.toml --record run.mcap {options}");
    keyway(folder.path(), &line).expect_code(0);
    folder
}

#[test]
fn every_decision_of_a_recording_is_made_again() {
    let folder = recorded("--explain while.jsonl --format json");
    // The scene is not needed.
    fs::remove_file(folder.path().join("scenes/post.toml")).unwrap();
    let line = "replay run.mcap --explain again.jsonl --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    assert_eq!(
        (&report["schema"], &report["runs"][0]["record"]),
        (&"keyway.replay/1".into(), &"run.mcap".into())
    );
    let flight = &report["runs"][0]["flight"];
    let cycles = read(&folder, "while.jsonl").lines().count();
    assert!(cycles > 50, "{cycles}");
    assert_eq!(flight["cycles"], cycles);
    assert_eq!((&flight["snapshots"], &flight["is_complete"]), (&1.into(), &true.into()));
    let rows = |name: &str| -> Vec<Value> {
        let text = read(&folder, name);
        text.lines().map(|line| line.parse::<Value>().unwrap()).collect()
    };
    for (first, again) in rows("while.jsonl").iter().zip(rows("again.jsonl")) {
        for part in ["cycle", "pose", "command", "chosen", "runner_up", "reason"] {
            assert_eq!(first[part], again[part], "{part}");
        }
    }
    let text = keyway(folder.path(), "replay run.mcap").expect_code(0).out;
    assert_eq!(text, format!("run.mcap: {cycles} decisions, all reproduced\n"));
}

#[test]
fn a_decision_that_is_another_one_is_said() {
    let folder = recorded("");
    // A digit of a command is changed in the text of a step, in an uncompressed chunk.
    let bytes = fs::read(folder.path().join("run.mcap")).unwrap();
    let stream = mcap::MessageStream::new(&bytes).unwrap();
    let mut out = std::io::Cursor::new(Vec::new());
    let mut writer = mcap::WriteOptions::new().create(&mut out).unwrap();
    let mut steps = 0;
    for message in stream {
        let mut message = message.unwrap();
        if message.channel.topic == "/keyway/step" {
            steps += 1;
            if steps == 20 {
                let mut step: Value = serde_json::from_slice(&message.data).unwrap();
                step["omega_radps"] = (step["omega_radps"].as_f64().unwrap() + 1e-12).into();
                message.data = serde_json::to_vec(&step).unwrap().into();
            }
        }
        writer.write(&message).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    fs::write(folder.path().join("other.mcap"), out.into_inner()).unwrap();
    let error = keyway(folder.path(), "replay other.mcap --format json").expect_code(2).json();
    let text = error["message"].as_str().unwrap();
    assert!(
        text.starts_with("other.mcap: at 1.900 s (cycle 19) the decision differs: drive with"),
        "{text}"
    );
}

#[test]
fn a_recording_that_was_cut_off_is_read_as_far_as_it_goes() {
    let folder = recorded("");
    let whole = fs::read(folder.path().join("run.mcap")).unwrap();
    let cycles = |length: usize| {
        fs::write(folder.path().join("cut.mcap"), &whole[..length]).unwrap();
        let answer = keyway(folder.path(), "replay cut.mcap --format json");
        (answer.code == 0).then(|| answer.json()["runs"][0]["flight"].clone())
    };
    let all = cycles(whole.len()).unwrap();
    let without_end = cycles(whole.len() - 9).unwrap();
    assert_eq!(without_end["cycles"], all["cycles"]);
    assert_eq!(without_end["is_complete"], false);
    for length in (0..whole.len()).step_by(whole.len() / 40) {
        if let Some(flight) = cycles(length) {
            assert!(flight["cycles"].as_u64() <= all["cycles"].as_u64());
            assert_eq!(flight["is_complete"], false);
        }
    }
}

#[test]
fn what_is_no_recording_is_refused() {
    let folder = recorded("");
    let message = |line: &str| {
        let error = keyway(folder.path(), &format!("{line} --format json")).expect_code(2).json();
        (error["field"].as_str().unwrap().to_owned(), error["message"].as_str().unwrap().to_owned())
    };
    write(&folder, "diary.mcap", "dear diary");
    for (line, field, text) in [
        ("replay diary.mcap", "RECORD.mcap", "diary.mcap: this is not an MCAP file: "),
        ("replay nowhere.mcap", "RECORD.mcap", "nowhere.mcap: there is no such file"),
        ("replay run.mcap --out shown", "--out", "open it in Foxglove or Lichtblick"),
        ("replay run.mcap --explain run.mcap", "--explain", "run.mcap"),
        ("navigate --scene scenes/post.toml --record run.json", "--record", "ends in .mcap"),
    ] {
        let (got, why) = message(line);
        assert!(got.contains(field) && why.contains(text), "{line}: {got}: {why}");
    }
    let mut out = std::io::Cursor::new(Vec::new());
    mcap::WriteOptions::new().create(&mut out).unwrap().finish().unwrap();
    fs::write(folder.path().join("empty.mcap"), out.into_inner()).unwrap();
    let (_, why) = message("replay empty.mcap");
    assert!(why.contains("it contains no navigator"), "{why}");
}
