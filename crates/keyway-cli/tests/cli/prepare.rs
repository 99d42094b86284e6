//! Tests of `keyway prepare`, and of plans on prepared maps.

use crate::support::{expect_members, folder, keyway, read, without_times, write};
use serde_json::Value;

#[test]
fn prepare_and_plan() {
    let folder = folder();
    let line = "prepare small_house.yaml --radius 0.2 --out house.prepared --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let bytes = std::fs::read(folder.path().join("house.prepared")).unwrap();
    let made = &report["preparation"];
    assert_eq!(made["file_bytes"], bytes.len());
    expect_members(
        &report,
        &[
            ("schema", |v| v == "keyway.prepare/2"),
            ("map", |v| v == "small_house.yaml"),
            ("map_digest", Value::is_string),
            ("estimate", Value::is_null),
            ("preparation", Value::is_object),
            ("config", |v| v["clearance_m"] == 0.2),
            ("files", |v| v[0] == "house.prepared"),
        ],
    );
    expect_members(
        made,
        &[
            ("corner_cells", |v| v.as_u64().is_some_and(|count| count > 10)),
            ("edges", |v| v.as_u64().is_some_and(|count| count > 10)),
            ("label_entries", |v| v.as_u64().is_some_and(|count| count > 10)),
            ("memory_bytes", |v| v.as_u64().is_some_and(|bytes| bytes > 500 * 500 / 8)),
            ("preparation_ms", Value::is_f64),
            ("file_bytes", Value::is_u64),
        ],
    );
    let plan = "plan small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875 --format json";
    let with = |options: &str| keyway(folder.path(), &format!("{plan} --radius 0.2 {options}"));
    let from_file = with("--prepared house.prepared").expect_code(0).json();
    assert_eq!(from_file["planner"], "prepared");
    assert_eq!(
        from_file["cost_cells"],
        with("--planner astar").expect_code(0).json()["cost_cells"]
    );
    let on_the_spot = with("--planner prepared").expect_code(0).json();
    assert_eq!(without_times(from_file), without_times(on_the_spot));

    // A map with another clearance is a different map.
    let refused = keyway(folder.path(), &format!("{plan} --prepared house.prepared"));
    let error = refused.expect_code(2).json();
    assert_eq!((&error["kind"], &error["field"]), (&"input".into(), &"--prepared".into()));
    assert!(error["message"].as_str().unwrap().contains("clearance"), "{error}");
}

#[test]
fn only_if_it_pays() {
    let folder = folder();
    let line = "prepare small_house.yaml --radius 0.2 --out house.prepared";
    let run = |options: &str| keyway(folder.path(), &format!("{line} {options}")).expect_code(0);
    let report = run("--if-it-pays=1 --format json").json();
    assert!(report["preparation"].is_null() && report["files"] == serde_json::json!([]));
    assert!(!folder.path().join("house.prepared").exists());
    let estimate = &report["estimate"];
    expect_members(
        estimate,
        &[
            ("corner_cells", |v| v.as_u64().is_some_and(|count| count > 10)),
            ("label_entries", |v| v.as_u64().is_some_and(|count| count > 10)),
            ("memory_bytes", Value::is_u64),
            ("peak_bytes", Value::is_u64),
            ("time_s", |v| v.as_f64().is_some_and(|time| time > 0.0)),
            ("jps_s", |v| v.as_f64().is_some_and(|time| time > 0.0)),
            ("pays_from_paths", |v| v.as_f64().is_some_and(|paths| paths > 1.0)),
        ],
    );
    let words = run("--if-it-pays=1").out;
    assert!(words.starts_with("not prepared: the preparation takes about"), "{words}");
    let many = run("--if-it-pays=10000000 --format json").json();
    assert_eq!(many["files"][0], "house.prepared");
    let (before, made) = (&many["estimate"], &many["preparation"]);
    assert_eq!((before["corner_cells"].as_u64()), (made["corner_cells"].as_u64()));
    assert!(run("--if-it-pays --format json").json()["estimate"].is_object());
    let refused = keyway(folder.path(), &format!("{line} --if-it-pays=0")).expect_code(2);
    assert!(refused.err.contains("expected a whole number of at least 1"), "{}", refused.err);
}

#[test]
fn only_whole_files_of_the_very_map() {
    let folder = folder();
    keyway(folder.path(), "prepare walled.map --out w.prepared").expect_code(0);
    let plan = |map: &str, file: &str| {
        keyway(
            folder.path(),
            &format!("plan {map} --cells --start 1,0 --goal 5,0 --prepared {file}"),
        )
    };
    plan("walled.map", "w.prepared").expect_code(0);
    write(&folder, "other.map", &read(&folder, "walled.map").replacen("..@..", "..@.@", 1));
    assert!(plan("other.map", "w.prepared").expect_code(2).err.contains("another map"));
    let mut bytes = std::fs::read(folder.path().join("w.prepared")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(folder.path().join("damaged.prepared"), &bytes).unwrap();
    assert!(plan("walled.map", "damaged.prepared").expect_code(2).err.contains("damaged"));
    assert!(plan("walled.map", "walled.map").expect_code(2).err.contains("not a prepared map"));
    assert!(plan("walled.map", "none").expect_code(2).err.contains("cannot read none"));
    let both = "plan walled.map --start 1,1 --goal 5,1 --prepared w.prepared --planner jps";
    keyway(folder.path(), both).expect_code(2);
    let replaced = keyway(folder.path(), "prepare walled.map --out walled.map").expect_code(2);
    assert!(replaced.err.contains("walled.map"), "{}", replaced.err);
}

#[test]
fn robots_are_not_driven_by_it() {
    let folder = folder();
    let line = "navigate --scene small_house.toml --set planner.name=prepared --format json";
    let error = keyway(folder.path(), line).expect_code(2).json();
    assert_eq!((&error["kind"], &error["field"]), (&"config".into(), &"planner.name".into()));
    let penalised = "prepare small_house.yaml --unknown penalised --out a --format json";
    assert_eq!(keyway(folder.path(), penalised).expect_code(2).json()["kind"], "config");
}

#[test]
fn a_benchmark_counts_the_preparation() {
    let line = "bench grid rooms.map.scen --planner jps --planner prepared --format json";
    let report = keyway(folder().path(), line).expect_code(0).json();
    let [jps, prepared] = [0, 1].map(|i| &report["rows"][i]);
    assert_eq!((&prepared["planner"], &prepared["solved"]), (&"prepared".into(), &jps["solved"]));
    assert!(prepared["preprocessing_ms"].as_f64() > jps["preprocessing_ms"].as_f64());
}
