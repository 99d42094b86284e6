//! Tests of `keyway batch`.

use crate::support::{folder, keyway, read, write};
use serde_json::{Value, json};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// A generated hall of 6 m x 4 m; other seeds give other halls.
const HALL: &str = "version = 2\nseed = 5\nstart = [0.7, 2.0]\ngoal = [5.3, 2.0]\n[world]\nwidth_m = 6\nheight_m = 4\n\
                    resolution_m = 0.05\n[world.obstacles.clutter]\nshare = 0.05\nradius_m = [0.1, 0.2]\n\
                    [rules]\nreference_time_s = 10\n";

/// Two scenes, with two stacks and two seeds: eight runs.
const BATCH: &str = "batch scenes --stacks key-point-fusion,astar-follow --seeds 2";

/// Files that must not depend on the number of repetitions and threads, nor on the parts.
const SAME: [&str; 12] = [
    "runs.jsonl",
    "runs.csv",
    "summary.csv",
    "summary.md",
    "summary.tex",
    "against_first.tex",
    "by_scene.csv",
    "wins.csv",
    "wins.md",
    "plots/time.svg",
    "plots/clearance.svg",
    "plots/length_time.svg",
];

/// Two scenes in a folder of their own.
pub(crate) fn scenes() -> TempDir {
    let folder = folder();
    std::fs::create_dir(folder.path().join("scenes")).unwrap();
    write(&folder, "scenes/hall.toml", HALL);
    let denser = HALL.replace("seed = 5", "seed = 9").replace("share = 0.05", "share = 0.07");
    write(&folder, "scenes/more.toml", &denser);
    folder
}

fn results(folder: &TempDir, out: &str) -> Vec<String> {
    SAME.iter().map(|name| read(folder, &format!("{out}/{name}"))).collect()
}

#[test]
fn the_results_are_the_same_on_any_number_of_threads_and_in_parts() {
    let folder = scenes();
    let batch = |rest: &str| keyway(folder.path(), &format!("{BATCH} {rest}")).expect_code(0);
    let report = batch("--out one --jobs 1 --format json").json();
    assert_eq!((&report["schema"], &report["runs"]), (&json!("keyway.batch/1"), &json!(8)));
    assert_eq!(report["stacks"][0]["stack"], "key-point-fusion");
    assert_eq!(report["stacks"][0]["runs"], 4);
    // Both stacks reach the goal in all four runs.
    let reached = &report["wins"][0];
    assert_eq!((&reached["measure"], &reached["equal"]), (&json!("reached"), &json!(4)));
    assert!(report["cycles"][1]["mean_cycle_us"].is_f64(), "{}", report["cycles"]);
    batch("--out three --jobs 3");
    assert_eq!(results(&folder, "one"), results(&folder, "three"));
    batch("--out a --shard 1/2");
    batch("--out b --shard 2/2");
    assert_eq!(read(&folder, "a/runs.jsonl").lines().count(), 4);
    let merged = keyway(folder.path(), "batch merge b a --out whole --format json");
    assert_eq!(merged.expect_code(0).json()["runs"], 8);
    assert_eq!(results(&folder, "one"), results(&folder, "whole"));
    // The measured times were merged, too: nothing was driven again.
    let times: String = ["a", "b"].map(|out| read(&folder, &format!("{out}/times.jsonl"))).concat();
    let whole = read(&folder, "whole/times.jsonl");
    assert!(whole.lines().all(|line| times.contains(line)), "{whole}\n{times}");
}

#[test]
fn each_run_says_what_it_was() {
    let folder = scenes();
    keyway(folder.path(), &format!("{BATCH} --out out")).expect_code(0);
    let rows: Vec<Value> =
        read(&folder, "out/runs.jsonl").lines().map(|line| line.parse().unwrap()).collect();
    let keys = |row: &Value| (row["scene"].clone(), row["stack"].clone(), row["seed"].clone());
    let expected = ["hall", "more"].into_iter().zip([5, 9]).flat_map(|(scene, seed)| {
        ["key-point-fusion", "astar-follow"].into_iter().flat_map(move |stack| {
            [seed, seed + 1].map(|seed| (json!(scene), json!(stack), json!(seed)))
        })
    });
    assert_eq!(rows.iter().map(keys).collect::<Vec<_>>(), expected.collect::<Vec<_>>());
    let first = &rows[0];
    assert_eq!((&first["outcome"], &first["reference_time_s"]), (&json!("reached"), &json!(10.0)));
    let (time_s, score) = (first["time_s"].as_f64().unwrap(), first["score"].as_f64().unwrap());
    assert!((score - 10.0 / time_s.clamp(20.0, 80.0)).abs() < 1e-12, "{first}");
    // The same runs one at a time: with the first stack, and with the one that drives in the same
    // world after it.
    for (stack, row) in [("key-point-fusion", first), ("astar-follow", &rows[2])] {
        let line = format!("navigate --scene scenes/hall.toml --stack {stack} --format json");
        let alone = keyway(folder.path(), &line).expect_code(0).json();
        for member in ["time_s", "length_m", "min_clearance_m"] {
            assert_eq!(alone["run"][member], row[member], "{stack}: {member}");
        }
    }
}

#[test]
fn nothing_finished_is_lost_or_made_again() {
    let folder = scenes();
    let batch = |out: &str| keyway(folder.path(), &format!("{BATCH} --out {out}")).expect_code(0);
    batch("whole");
    let whole = results(&folder, "whole");
    // A batch that was killed while writing its sixth run.
    let journal: Vec<String> = read(&folder, "whole/runs.jsonl")
        .lines()
        .map(|line| {
            let run: Value = line.parse().unwrap();
            json!({"run": run, "measured": {"wall_s": 4321.0, "mean_cycle_us": null}}).to_string()
        })
        .collect();
    std::fs::create_dir(folder.path().join("torn")).unwrap();
    let torn = journal[..5].join("\n") + "\n" + &journal[5][..50];
    write(&folder, "torn/journal.jsonl", &torn);
    batch("torn");
    assert_eq!(results(&folder, "torn"), whole);
    let times = read(&folder, "torn/times.jsonl");
    assert_eq!(times.matches("4321.0").count(), 5, "{times}");
    assert!(!folder.path().join("torn/journal.jsonl").exists());
    // A scene that has changed is driven again; the others are not.
    let more = read(&folder, "scenes/more.toml");
    write(&folder, "scenes/more.toml", &more.replace("[0.1, 0.2]", "[0.1, 0.19]"));
    batch("torn");
    assert_eq!(read(&folder, "torn/times.jsonl").matches("4321.0").count(), 4);
    assert_ne!(results(&folder, "torn"), whole);
    // Fewer runs, or others, would take the place of those that are there.
    let torn = results(&folder, "torn");
    for fewer in ["--seeds 1", "--seeds 2 --stacks astar-follow"] {
        let line = format!("batch scenes {fewer} --out torn --format json");
        let refused = keyway(folder.path(), &line).expect_code(2).json();
        assert_eq!((&refused["field"], &refused["kind"]), (&json!("--out"), &json!("output")));
        let message = refused["message"].as_str().unwrap();
        assert!(message.contains("torn holds runs that this batch does not have"), "{message}");
        assert_eq!(results(&folder, "torn"), torn);
    }
    // More seeds are added to them.
    keyway(folder.path(), &format!("{} --out torn", BATCH.replace("--seeds 2", "--seeds 3")))
        .expect_code(0);
    assert_eq!(read(&folder, "torn/times.jsonl").matches("4321.0").count(), 4);
}

/// The same worlds with another robot and other disturbances, compared with single runs.
#[test]
fn robot_and_disturbances_are_those_that_are_given() {
    let folder = scenes();
    let robot = keyway(folder.path(), "list small").expect_code(0).out;
    let late = robot.replace("actuation_delay_s = 0.0", "actuation_delay_s = 0.3");
    assert_ne!(late, robot);
    write(&folder, "late.toml", &late);
    write(&folder, "noise.toml", "[actuation]\nv_relative = 0.05\nomega_relative = 0.05\n");
    let rows = |out: &str, rest: &str| -> Vec<Value> {
        keyway(folder.path(), &format!("batch scenes/hall.toml --out {out} {rest}")).expect_code(0);
        read(&folder, &format!("{out}/runs.jsonl"))
            .lines()
            .map(|line| line.parse().unwrap())
            .collect()
    };
    let ideal = rows("ideal", "");
    let options = "--robot late.toml --disturbances noise.toml";
    let noisy = rows("noisy", &format!("{options} --seeds 2"));
    assert_ne!(ideal[0]["digest"], noisy[0]["digest"]);
    assert_ne!(ideal[0]["length_m"], noisy[0]["length_m"]);
    for (row, seed) in noisy.iter().zip([5, 6]) {
        let alone =
            format!("navigate --scene scenes/hall.toml {options} --seed {seed} --format json");
        let report = keyway(folder.path(), &alone).expect_code(0).json();
        assert_eq!((&report["run"]["length_m"], &json!(seed)), (&row["length_m"], &row["seed"]));
        assert_eq!(report["inputs"]["disturbances"]["seed"], json!(seed));
        assert_eq!(report["inputs"]["disturbances"]["actuation"]["v_relative"], json!(0.05));
        assert_eq!(report["inputs"]["robot"]["actuation_delay_s"], json!(0.3));
    }
    assert_ne!(noisy[0]["length_m"], noisy[1]["length_m"]);
    write(&folder, "wrong.toml", "[actuation]\nv_relative = 5\n");
    for command in ["batch scenes/hall.toml --out wrong", "navigate --scene scenes/hall.toml"] {
        let wrong =
            keyway(folder.path(), &format!("{command} --disturbances wrong.toml --format json"));
        let error = wrong.expect_code(2).json();
        assert_eq!(error["field"], "actuation.v_relative", "{error}");
    }
}

#[test]
fn a_stack_file_lies_beside_the_scene_that_names_it() {
    let folder = scenes();
    let printed = keyway(folder.path(), "list astar-follow").expect_code(0).out;
    write(&folder, "scenes/mine.stack", &printed);
    write(&folder, "scenes/hall.toml", &format!("stack = \"./mine.stack\"\n{HALL}"));
    keyway(folder.path(), "batch scenes/hall.toml --out out").expect_code(0);
    let other = "batch scenes/hall.toml --stacks scenes/mine.stack --out other";
    keyway(folder.path(), other).expect_code(0);
    let row = |out: &str| read(&folder, &format!("{out}/runs.jsonl")).parse::<Value>().unwrap();
    let (own, named) = (row("out"), row("other"));
    assert_eq!(
        (&own["stack"], &named["stack"]),
        (&json!("./mine.stack"), &json!("scenes/mine.stack"))
    );
    assert_eq!(own["time_s"], named["time_s"]);
}

#[test]
fn killed_at_any_moment_it_goes_on() {
    let folder = scenes();
    let line = format!("{BATCH} --seeds 6 --jobs 2");
    let line = line.replace("--seeds 2 ", "");
    keyway(folder.path(), &format!("{line} --out whole")).expect_code(0);
    for kill_at in [1, 7] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_keyway"))
            .args(line.split_whitespace().chain(["--out", "killed"]))
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        let journal = folder.path().join("killed/journal.jsonl");
        let finished = || std::fs::read_to_string(&journal).unwrap_or_default().lines().count();
        while finished() < kill_at && child.try_wait().unwrap().is_none() {
            std::thread::yield_now();
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    keyway(folder.path(), &format!("{line} --out killed")).expect_code(0);
    assert_eq!(results(&folder, "killed"), results(&folder, "whole"));
}

#[test]
fn two_batches_at_once_need_two_folders() {
    let folder = scenes();
    let line = "batch scenes --seeds 1000 --jobs 1 --out both";
    let mut child = Command::new(env!("CARGO_BIN_EXE_keyway"))
        .args(line.split_whitespace())
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let journal = folder.path().join("both/journal.jsonl");
    let finished = || std::fs::read_to_string(&journal).unwrap_or_default().lines().count();
    while finished() == 0 && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    let refused = keyway(folder.path(), &format!("{line} --format json"));
    let merged = keyway(folder.path(), "batch scenes/hall.toml --out other");
    let merge = keyway(folder.path(), "batch merge other --out both");
    assert!(child.try_wait().unwrap().is_none(), "it has ended too early to say anything");
    let error = refused.expect_code(2).json();
    assert_eq!((&error["kind"], &error["field"]), (&json!("output"), &json!("--out")));
    let message = error["message"].as_str().unwrap();
    let expected = "both: another `keyway` is writing to this folder; wait until";
    assert!(message.starts_with(expected), "{message}");
    merged.expect_code(0);
    assert!(merge.expect_code(2).err.contains("writing to this folder"));
    // Once killed, it no longer blocks others.
    child.kill().unwrap();
    child.wait().unwrap();
    let known = finished();
    assert!(known > 0);
    // The short batch would lack some of its runs.
    std::fs::remove_file(&journal).unwrap();
    let short = line.replace("--seeds 1000", "--seeds 2");
    keyway(folder.path(), &short).expect_code(0);
    assert_eq!(read(&folder, "both/runs.jsonl").lines().count(), 4);
    assert!(!journal.exists());
}

#[test]
fn what_cannot_be_driven_is_refused_before_anything_is() {
    let folder = scenes();
    let refused = |line: &str| {
        let error = keyway(folder.path(), &format!("{line} --format json")).expect_code(2).json();
        assert!(!folder.path().join("out").exists(), "{line}");
        (error["field"].clone(), error["message"].as_str().unwrap().to_owned())
    };
    let (field, message) = refused("batch scenes nowhere.toml --out out");
    assert!(field == "SCENE.toml" && message.contains("nowhere.toml"), "{message}");
    let (_, message) = refused("batch scenes scenes/hall.toml --out out");
    assert!(message.contains("two scenes are named `hall`"), "{message}");
    let (_, message) = refused("batch scenes --stacks rrt-follow,rrt-follow --out out");
    assert!(message.contains("`rrt-follow` is given twice"), "{message}");
    let (field, message) = refused("batch scenes --stacks tea --out out");
    assert_eq!(field, "--stacks");
    assert!(message.contains("there is no stack `tea`"), "{message}");
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    let (_, message) = refused("batch empty --out out");
    assert!(message.contains("there is no scene (*.toml)"), "{message}");
    for shard in ["3/2", "0/2", "1/10001", "1/18446744073709551615", "1/99999999999999999999"] {
        let (field, message) = refused(&format!("batch scenes --shard {shard} --out out"));
        assert_eq!(field, "--shard");
        assert!(message.contains("the first of four parts, of at most 10000"), "{message}");
    }
    // A file of the user.
    write(&folder, "journal.jsonl", "dear diary\n");
    let error = keyway(folder.path(), "batch scenes --out . --format json").expect_code(2).json();
    assert!(error["message"].as_str().unwrap().contains("not the journal of a batch"), "{error}");
    assert_eq!(read(&folder, "journal.jsonl"), "dear diary\n");
    write(&folder, "journal.jsonl", "dear diary, without an end of the line");
    keyway(folder.path(), "batch scenes --out .").expect_code(2);
    assert!(read(&folder, "journal.jsonl").ends_with("end of the line"));
}

/// The result files are validated: their stated size is not trusted.
#[test]
fn results_that_are_damaged_are_named_by_file_and_line() {
    let folder = scenes();
    keyway(folder.path(), &format!("{BATCH} --shard 1/2 --out part")).expect_code(0);
    let merge = || keyway(folder.path(), "batch merge part --out no").expect_code(2).err;
    let part = read(&folder, "part/part.json");
    for (of, expected) in [
        (
            "10000",
            "missing: 2/10000, 3/10000, 4/10000, 5/10000, 6/10000, 7/10000, 8/10000, 9/10000, 10/10000, 11/10000 and 9989 more; give",
        ),
        ("10001", "part.json: it does not contain a valid part of a batch, of at most 10000 parts"),
        (
            "1000000000",
            "part.json: it does not contain a valid part of a batch, of at most 10000 parts",
        ),
        (
            "18446744073709551615",
            "part.json: it does not contain a valid part of a batch, of at most 10000 parts",
        ),
    ] {
        write(&folder, "part/part.json", &part.replace("\"of\": 2", &format!("\"of\": {of}")));
        let error = merge();
        assert!(error.contains(expected), "{of}: {error}");
    }
    write(&folder, "part/part.json", &part);
    for name in ["runs.jsonl", "times.jsonl"] {
        let text = read(&folder, &format!("part/{name}"));
        let path = folder.path().join("part").join(name);
        let second = text.lines().nth(1).unwrap();
        for (line, expected) in [
            (format!("{}\n", &second[..20]), "line 2: it is not from a batch of this version"),
            (
                "x".repeat((16 << 20) + 1),
                "line 2 has 16777217 bytes, more than the limit of 16 MiB",
            ),
        ] {
            write(&folder, &format!("part/{name}"), &text.replacen(second, &line, 1));
            let error = merge();
            assert!(error.contains(&format!("part/{name}: {expected}")), "{error}");
        }
        std::fs::File::create(&path).unwrap().set_len((4 << 30) + 1).unwrap();
        let error = merge();
        let expected = format!("part/{name}: it is larger than the limit of 4 GiB");
        assert!(error.contains(&expected), "{error}");
        write(&folder, &format!("part/{name}"), &text);
    }
    // A table that Keyway wrote, as its file list shows, but that was modified: it is written
    // again.
    keyway(folder.path(), &format!("{BATCH} --shard 1/2 --out part")).expect_code(0);
}

/// The scenes are not needed; parts of different batches are refused.
#[test]
fn parts_are_put_together_when_all_are_there() {
    let folder = scenes();
    let run = |line: &str| keyway(folder.path(), line);
    let part = |i: u32| format!("{BATCH} --keep all --shard {i}/3 --out part-{i}");
    run(&format!("{BATCH} --keep all --out one")).expect_code(0);
    for i in 1..=3 {
        run(&part(i)).expect_code(0);
    }
    // Another stack in the same worlds, in a batch of its own.
    run("batch scenes --stacks rrt-follow --out other").expect_code(0);
    let refused = |line: &str| {
        let error = run(&format!("batch merge {line} --format json")).expect_code(2).json();
        error["message"].as_str().unwrap().to_owned()
    };
    let message = refused("part-3 part-1 --out no");
    assert!(
        message.contains("part-3: other parts of the same batch are missing: 2/3;"),
        "{message}"
    );
    let message = refused("part-1 part-2 part-3 one --out no");
    assert!(
        message.contains("with key-point-fusion and seed 5 is in both part-1 and one"),
        "{message}"
    );
    assert!(refused("one --out one").contains("is one of the folders to merge"));
    let message = refused("scenes --out no");
    assert!(
        message
            .contains("there is no such file or folder; it is written when a batch has finished")
    );
    write(&folder, "scenes/more.toml", &HALL.replace("seed = 5", "seed = 9").replace("5.3", "5.2"));
    run(&part(3).replace("part-3", "late")).expect_code(0);
    let message = refused("part-1 part-2 late --out no");
    assert!(
        message.contains("part-1: other parts of the same batch are missing: 3/3;"),
        "{message}"
    );
    run("batch scenes/more.toml --stacks rrt-follow --out later").expect_code(0);
    let message = refused("other later --out no");
    assert!(message.contains("has different inputs in other and later"), "{message}");
    assert!(!folder.path().join("no").exists());
    std::fs::remove_dir_all(folder.path().join("scenes")).unwrap();
    run("batch merge part-3 part-1 part-2 --out whole").expect_code(0);
    assert_eq!(results(&folder, "one"), results(&folder, "whole"));
    for record in std::fs::read_dir(folder.path().join("one/records")).unwrap() {
        let name = record.unwrap().file_name().into_string().unwrap();
        let [one, whole] =
            ["one", "whole"].map(|out| read(&folder, &format!("{out}/records/{name}")));
        assert!(one == whole, "{name}");
    }
    // A merged batch is complete; other batches may follow it.
    run("batch merge whole other --out all").expect_code(0);
    let all = read(&folder, "all/runs.jsonl");
    let both = ["whole", "other"].map(|out| read(&folder, &format!("{out}/runs.jsonl")));
    assert_eq!(all, both.concat());
    // A part that is still running.
    write(&folder, "part-2/journal.jsonl", "");
    assert!(refused("part-3 part-1 part-2 --out no").contains("the batch has not finished"));
    std::fs::remove_file(folder.path().join("part-2/journal.jsonl")).unwrap();
    let line = read(&folder, "part-2/runs.jsonl").lines().next().unwrap().to_owned();
    write(&folder, "part-2/runs.jsonl", &line);
    let times = read(&folder, "part-2/times.jsonl");
    assert!(refused("part-3 part-1 part-2 --out no").contains("differs from that of runs.jsonl"));
    write(&folder, "part-2/times.jsonl", times.lines().next().unwrap());
    write(&folder, "part-2/runs.jsonl", &line.replace("\"seed\":", "\"grain\":"));
    let message = refused("part-3 part-1 part-2 --out no");
    assert!(message.contains("part-2/runs.jsonl: line 1: it is not from a batch"), "{message}");
    write(&folder, "part-2/runs.jsonl", &line);
    let message = refused("part-3 part-1 part-2 --out no");
    assert!(message.contains("do not match the division of the batch"), "{message}");
}

/// Two tables with intervals; file names may contain special characters of TeX.
#[test]
fn the_summary_is_a_table_for_papers() {
    let folder = scenes();
    let printed = keyway(folder.path(), "list astar-follow").expect_code(0).out;
    write(&folder, "my_own.toml", &printed);
    let line = "batch scenes --stacks key-point-fusion,./my_own.toml --seeds 2 --out out";
    keyway(folder.path(), line).expect_code(0);
    let (tex, against) = (read(&folder, "out/summary.tex"), read(&folder, "out/against_first.tex"));
    let row = |text: &str, name: &str| {
        let row = text.lines().find(|line| line.trim().starts_with(name));
        row.unwrap_or_else(|| panic!("{name}: {text}")).to_owned()
    };
    assert!(tex.contains(r"stack & runs & reached \% & contacts & stuck & time s"), "{tex}");
    let first = row(&tex, "key-point-fusion & 4 & 100.0 (51.0 to 100.0) & 0 + 0 & 0 & ");
    assert!(first.matches(" to ").count() == 3 && first.ends_with(r"\\"), "{first}");
    row(&tex, r"./my\_own.toml & 4 & ");
    assert!(against.contains("% Against key-point-fusion."), "{against}");
    row(&against, r"./my\_own.toml & ");
}

/// Empty plots are omitted, and those of an earlier batch are removed.
#[test]
fn plots_show_what_there_is() {
    let folder = scenes();
    let batch = |line: &str| keyway(folder.path(), &format!("{line} --out out")).expect_code(0);
    batch("batch scenes --stacks key-point-fusion,astar-follow --seeds 2");
    let names = || {
        let entries = std::fs::read_dir(folder.path().join("out/plots")).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names.join(" ")
    };
    // The clutter of two scenes stands for the scenes, so that there is no trend to show.
    let all =
        "captions.md clearance.png clearance.svg length_time.png length_time.svg time.png time.svg";
    assert_eq!(names(), all);
    let time = read(&folder, "out/plots/time.svg");
    for text in [">key-point-fusion<", ">astar-follow<", ">4 of 4<", "time [s]"] {
        assert!(time.contains(text), "{text}");
    }
    // Captions stand beside the pictures.
    let captions = read(&folder, "out/plots/captions.md");
    for text in ["**time.svg**: Time", "whiskers:", "pale:"] {
        assert!(captions.contains(text), "{text}: {captions}");
    }
    assert!(!time.contains("whiskers:"), "{time}");
    let rows: Vec<Value> =
        read(&folder, "out/runs.jsonl").lines().map(|line| line.parse().unwrap()).collect();
    let share = |row: &Value| row["occupied_share"].as_f64().unwrap();
    assert!(rows.iter().all(|row| (0.02..0.1).contains(&share(row))), "{rows:?}");
    // The two stacks drive in the same worlds.
    assert_eq!(rows[0]["occupied_share"], rows[2]["occupied_share"]);
    assert_ne!(rows[0]["occupied_share"], rows[1]["occupied_share"]);
    // Nothing reached the goal.
    for name in ["hall", "more"] {
        let scene = read(&folder, &format!("scenes/{name}.toml"));
        write(&folder, &format!("scenes/{name}.toml"), &format!("{scene}time_limit_s = 0.5\n"));
    }
    batch("batch scenes --stacks key-point-fusion,astar-follow --seeds 2");
    assert_eq!(names(), "");
    // One scene whose clutter differs from seed to seed: eight runs, in two groups.
    let varied = format!("{HALL}[random.unknown]\ncount = 3\nradius_m = [0.05, 0.8]\n");
    write(&folder, "varied.toml", &varied);
    keyway(folder.path(), "batch varied.toml --stacks key-point-fusion --seeds 8 --out varied")
        .expect_code(0);
    let captions = read(&folder, "varied/plots/captions.md");
    assert!(
        captions.contains("**success.svg**: ") && captions.contains("(4 of each"),
        "{captions}"
    );
}

/// Twenty equal runs are no evidence, and two scenes may disagree.
#[test]
fn repetitions_count_once_and_each_scene_has_its_line() {
    let folder = scenes();
    std::fs::create_dir(folder.path().join("still")).unwrap();
    for (name, goal) in [("near", "goal = [2.0, 2.0]"), ("far", "goal = [5.3, 2.0]")] {
        let still = HALL.replace("goal = [5.3, 2.0]", goal).replace("share = 0.05", "share = 0.0");
        write(&folder, &format!("still/{name}.toml"), &still);
    }
    let line = "batch still --stacks key-point-fusion,astar-follow --seeds 3 --out out";
    let answer = keyway(folder.path(), &format!("{line} --format json")).expect_code(0);
    let report = answer.json();
    let stack = &report["stacks"][0];
    assert_eq!([&stack["runs"], &stack["independent_runs"]], [&json!(6), &json!(2)]);
    assert_eq!(report["against_first"][0]["pairs"], json!(2));
    assert_eq!(report["scenes"].as_array().unwrap().len(), 4);
    let summary = read(&folder, "out/summary.md");
    for text in ["every seed gave the same runs", "| near | 3 of 3 | 3 of 3 |"] {
        assert!(summary.contains(text), "{text}: {summary}");
    }
    let by_scene = read(&folder, "out/by_scene.csv");
    assert!(by_scene.starts_with("scene,stack,runs,reached,"), "{by_scene}");
    assert_eq!(by_scene.lines().count(), 5);
}

/// The stop rule is enabled on the command line, or in the scenes.
#[test]
fn the_stop_rule_is_behind_every_stack_by_one_word() {
    let folder = scenes();
    std::fs::create_dir(folder.path().join("safe")).unwrap();
    write(&folder, "safe/hall.toml", &HALL.replace("seed = 5", "seed = 5\nsafe = true"));
    let runs = |line: &str, out: &str| {
        keyway(folder.path(), &format!("{line} --out {out} --keep all")).expect_code(0);
        let record = read(&folder, &format!("{out}/records/hall.astar-follow.5.json"));
        let record: Value = record.parse().unwrap();
        (
            record["report"]["run"]["unsafe_commands"].clone(),
            read(&folder, &format!("{out}/runs.csv")),
        )
    };
    let (none, _) = runs("batch scenes/hall.toml --stacks astar-follow", "plain");
    let (told, rows) = runs("batch scenes/hall.toml --stacks astar-follow --safe", "told");
    let (in_scene, same) = runs("batch safe/hall.toml --stacks astar-follow", "in_scene");
    assert!(none.is_null() && told["standing"].is_u64(), "{none} {told}");
    assert_eq!((told, rows), (in_scene, same));
}
