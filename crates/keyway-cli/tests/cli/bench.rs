//! Tests of `keyway bench`.

use crate::support::{expect_members, folder, keyway, read, write};
use serde_json::{Value, json};

#[test]
fn the_bundled_benchmark() {
    let line = "bench grid rooms.map.scen --format json";
    let report = keyway(folder().path(), line).expect_code(0).json();
    assert_eq!(report["schema"], "keyway.bench.grid/1");
    assert_eq!(report["rows"].as_array().unwrap().len(), 1);
    expect_members(
        &report["rows"][0],
        &[
            ("map", |v| v == "rooms.map"),
            ("planner", |v| v == "jps"),
            ("queries", |v| v == 40),
            ("solved", |v| v == 39),
            ("mismatches", |v| v == 0),
            ("illegal_paths", |v| v == 0),
            ("missed", |v| v == 0),
            ("mean_us", Value::is_f64),
            ("median_us", Value::is_f64),
            ("p99_us", Value::is_f64),
            ("mean_cpu_us", |v| v.is_f64() || cfg!(not(unix))),
            ("p5_cpu_us", |v| v.is_f64() || cfg!(not(unix))),
            ("p95_cpu_us", |v| v.is_f64() || cfg!(not(unix))),
            ("mean_expanded", Value::is_f64),
            // There is a query without a path.
            ("p5_expanded", |v| v.as_f64().is_some_and(|count| count < 1.0)),
            ("p95_expanded", |v| v.as_f64().is_some_and(|count| count > 1.0)),
            ("mean_generated", Value::is_f64),
            ("mean_excess", |v| v.as_f64().is_some_and(|excess| excess.abs() < 1e-6)),
            ("p5_excess", |v| v.as_f64().is_some_and(|excess| excess.abs() < 1e-6)),
            ("p95_excess", |v| v.as_f64().is_some_and(|excess| excess.abs() < 1e-6)),
            ("preprocessing_ms", Value::is_f64),
            ("memory_bytes", |v| v.as_u64().is_some_and(|bytes| bytes > 32 * 32 * 16)),
        ],
    );
}

/// Two files with one query each: means over both, and the range between the two.
#[test]
fn several_files_have_totals() {
    let folder = folder();
    let query = "0\twalled.map\t7\t5\t1\t4\t5\t4\t10.82842712\n";
    write(&folder, "a.scen", &format!("version 1\n{query}"));
    write(&folder, "b.scen", "version 1\n0\twalled.map\t7\t5\t1\t4\t1\t3\t1\n");
    let line = "bench grid a.scen b.scen --planner astar --planner greedy";
    let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(0).json();
    let of = |row: &Value, name: &str| row[name].as_f64().unwrap();
    for (i, total) in report["totals"].as_array().unwrap().iter().enumerate() {
        let [one, other] = [&report["rows"][i], &report["rows"][i + 2]];
        assert_eq!((&total["map"], &total["planner"]), (&"all 2".into(), &one["planner"]));
        assert_eq!((&total["queries"], &total["solved"]), (&2.into(), &2.into()));
        let expanded = [one, other].map(|row| of(row, "mean_expanded"));
        assert!(expanded[0] > expanded[1], "{report}");
        assert_eq!(of(total, "mean_expanded"), 0.5 * (expanded[0] + expanded[1]));
        let at = |share: f64| expanded[1] + share * (expanded[0] - expanded[1]);
        let off = [of(total, "p5_expanded") - at(0.05), of(total, "p95_expanded") - at(0.95)];
        assert!(off.iter().all(|off| off.abs() < 1e-9), "{report}");
    }
    let table = keyway(folder.path(), line).expect_code(0).out;
    assert!(table.contains("all 2 ") && table.contains(" to "), "{table}");
    let one = keyway(folder.path(), "bench grid a.scen --format json").expect_code(0).json();
    assert_eq!(one["totals"], Value::Array(Vec::new()));
}

#[test]
fn mistakes_are_exit_code_1() {
    let folder = folder();
    let header = "version 1\n";
    let bench = |queries: &str| {
        write(&folder, "q.scen", &format!("{header}{queries}"));
        let report = keyway(folder.path(), "bench grid q.scen --format json");
        let code = report.code;
        let row = report.json()["rows"][0].clone();
        (code, row["mismatches"].as_u64().unwrap(), row["solved"].as_u64().unwrap())
    };
    // From the top: (1, 4) is the lower left of the wall's left side.
    let right = "0\twalled.map\t7\t5\t1\t4\t5\t4\t10.82842712\n";
    assert_eq!(bench(right), (0, 0, 1));
    assert_eq!(bench(&right.replace("10.82842712", "10.83")), (0, 0, 1), "published digits");
    assert_eq!(bench(&right.replace("10.82842712", "10.8")), (1, 1, 1));
    assert_eq!(bench(&right.replace("10.82842712", "0")), (1, 1, 1), "unreachable, it says");
    assert_eq!(bench("0\twalled.map\t7\t5\t1\t4\t1\t4\t0\n"), (0, 0, 1), "from a cell to itself");
    assert_eq!(bench("0\twalled.map\t7\t5\t3\t4\t1\t4\t2\n"), (0, 0, 0), "a blocked start");
    assert_eq!(bench("0\tclosed.map\t7\t5\t1\t4\t5\t4\t0\n"), (0, 0, 0), "unreachable");
    assert_eq!(bench("0\tclosed.map\t7\t5\t1\t4\t5\t4\t9\n"), (1, 1, 0));
}

#[test]
fn wrong_answers_are_listed() {
    let folder = folder();
    let wrong = "0\twalled.map\t7\t5\t1\t4\t5\t4\t9.5\n";
    let blocked = "0\twalled.map\t7\t5\t1\t4\t5\t4\t0\n";
    write(
        &folder,
        "q.scen",
        &format!("version 1\n0\twalled.map\t7\t5\t1\t4\t1\t4\t0\n{wrong}{blocked}"),
    );
    let line = "bench grid q.scen --planner jps --planner astar4";
    let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(1).json();
    let mistakes = report["mistakes"].as_array().unwrap();
    expect_members(
        &mistakes[0],
        &[
            ("scenarios", |v| v == "q.scen"),
            ("line", |v| v == 3),
            ("planner", |v| v == "jps"),
            // Rows in the file count from the top.
            ("start", |v| *v == json!([1, 0])),
            ("goal", |v| *v == json!([5, 0])),
            ("expected_cells", |v| v == 9.5),
            ("got", |v| v == "path"),
            ("got_cells", |v| v.as_f64().is_some_and(|cells| (cells - 10.828).abs() < 1e-3)),
        ],
    );
    assert_eq!((&mistakes[1]["line"], &mistakes[1]["expected_cells"]), (&4.into(), &Value::Null));
    let table = keyway(folder.path(), line).expect_code(1).out;
    let expected = "q.scen, line 3: jps, (1, 0) to (5, 0): expected a path of 9.500 cells, got one of 10.828 cells";
    assert!(table.contains(expected), "{table}");
    assert!(
        table.contains("line 4: jps, (1, 0) to (5, 0): expected no path, got one of 10.828"),
        "{table}"
    );
    // Only the first of many are listed.
    write(&folder, "q.scen", &format!("version 1\n{}", wrong.repeat(12)));
    let table = keyway(folder.path(), "bench grid q.scen").expect_code(1).out;
    assert_eq!(table.matches("expected a path").count(), 10, "{table}");
    assert!(table.contains("and 2 more; `--format json` lists all of them"), "{table}");
    let right = keyway(folder.path(), "bench grid rooms.map.scen").expect_code(0).out;
    assert!(!right.contains("Wrong answers"), "{right}");
}

#[test]
fn planners_that_cut_corners_are_judged_by_their_own_rule() {
    let folder = folder();
    let line =
        "bench grid rooms.map.scen --planner astar --set planner.corners=allow --format json";
    let row = keyway(folder.path(), line).expect_code(0).json()["rows"][0].clone();
    assert_eq!((&row["illegal_paths"], &row["mismatches"]), (&0.into(), &0.into()), "{row}");
    assert!(row["mean_excess"].as_f64().unwrap() < 0.0, "shorter than without cutting: {row}");
}

#[test]
fn repeated_and_thinned() {
    let folder = folder();
    let ask = |more: &str| {
        let line = format!("bench grid rooms.map.scen --planner jps --planner astar {more}");
        keyway(folder.path(), &format!("{line} --format json")).expect_code(0).json()
    };
    let nodes = |report: &Value| {
        let rows = report["rows"].as_array().unwrap().iter();
        rows.map(|row| [row["queries"].clone(), row["mean_expanded"].clone()]).collect::<Vec<_>>()
    };
    let (once, thrice) = (ask(""), ask("--repeat 3"));
    assert_eq!(
        (&once["repeat"], &once["every"], &thrice["repeat"]),
        (&1.into(), &1.into(), &3.into())
    );
    assert_eq!(nodes(&once), nodes(&thrice), "repetitions change times only");
    // 40 queries: the 1st, 8th, ..., 36th.
    let thinned = ask("--every 7");
    assert_eq!(thinned["rows"][0]["queries"], 6);
    let scen = read(&folder, "rooms.map.scen");
    let (header, queries) = scen.split_once('\n').unwrap();
    let kept: Vec<&str> = queries.lines().step_by(7).collect();
    write(&folder, "rooms.map.scen", &format!("{header}\n{}\n", kept.join("\n")));
    assert_eq!(nodes(&ask("")), nodes(&thinned));
    keyway(folder.path(), "bench grid rooms.map.scen --every 0").expect_code(2);
    keyway(folder.path(), "bench grid rooms.map.scen --repeat 0").expect_code(2);
}

#[test]
fn rows_come_in_the_order_of_the_files() {
    let folder = folder();
    let scen = read(&folder, "rooms.map.scen");
    let map = read(&folder, "rooms.map");
    std::fs::create_dir(folder.path().join("maps")).unwrap();
    let mut line = "bench grid --jobs 3 --map-dir maps --planner astar --planner astar".to_owned();
    for i in 0..5 {
        let name = format!("r{i}.map");
        write(&folder, &format!("maps/{name}"), &map);
        write(&folder, &format!("{name}.scen"), &scen.replace("rooms.map", &name));
        line = format!("{line} {name}.scen");
    }
    let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(0).json();
    let maps: Vec<&str> =
        report["rows"].as_array().unwrap().iter().map(|row| row["map"].as_str().unwrap()).collect();
    let expected: Vec<String> = (0..10).map(|i| format!("r{}.map", i / 2)).collect();
    assert_eq!(maps, expected);
    let table = keyway(folder.path(), &line).expect_code(0);
    assert!(table.out.contains("mismatches") && table.err.is_empty(), "{}", table.err);
}

#[test]
fn bad_files_are_exit_code_2() {
    let folder = folder();
    keyway(folder.path(), "bench grid none.scen").expect_code(2);
    write(&folder, "q.scen", "version 1\n0\tnone.map\t7\t5\t1\t4\t5\t4\t9\n");
    let missing = keyway(folder.path(), "bench grid q.scen").expect_code(2);
    assert!(missing.err.contains("none.map"), "{}", missing.err);
    write(&folder, "q.scen", "version 1\n0\twalled.map\t7\t6\t1\t4\t5\t4\t9\n");
    let size = keyway(folder.path(), "bench grid q.scen").expect_code(2);
    assert!(size.err.contains("line 2"), "{}", size.err);
}

#[test]
fn a_map_is_tiled_to_larger_ones() {
    let folder = folder();
    let line = "bench scale small_house.yaml --unknown free --sides 500,700 --planner astar --planner jps --out scale";
    let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(0).json();
    assert_eq!(report["schema"], "keyway.bench.scale/1");
    let rows = report["rows"].as_array().unwrap();
    let names: Vec<(&str, u64)> = rows
        .iter()
        .map(|row| (row["planner"].as_str().unwrap(), row["side_cells"].as_u64().unwrap()))
        .collect();
    assert_eq!(names, [("astar", 500), ("jps", 500), ("astar", 700), ("jps", 700)]);
    expect_members(
        &rows[3],
        &[
            ("planner", Value::is_string),
            ("side_cells", Value::is_u64),
            ("outcome", |v| v == "found"),
            ("start", Value::is_array),
            ("goal", Value::is_array),
            ("preparation_ms", Value::is_f64),
            ("wall_ms", Value::is_f64),
            ("cpu_ms", |v| v.is_f64() || cfg!(not(unix))),
            ("expanded", Value::is_u64),
            ("generated", Value::is_u64),
            ("cost_cells", Value::is_f64),
            ("map_bytes", Value::is_u64),
            ("workspace_bytes", Value::is_u64),
            ("peak_resident_bytes", |v| v.is_u64() || cfg!(not(target_os = "linux"))),
        ],
    );
    assert_eq!(rows[2]["cost_cells"], rows[3]["cost_cells"]);
    // Same result as a plan on the untiled map.
    let ends = |row: &Value| [&row["start"], &row["goal"]].map(Value::to_string);
    let [start, goal] = ends(&rows[0]);
    let [start, goal] = [start.trim_matches(['[', ']']), goal.trim_matches(['[', ']'])];
    let plan = format!(
        "plan small_house.yaml --unknown free --planner astar --cells --start {start} --goal {goal} --format json"
    );
    let plan = keyway(folder.path(), &plan).expect_code(0).json();
    assert_eq!(plan["cost_cells"], rows[0]["cost_cells"]);
    assert_eq!(plan["expanded"], rows[0]["expanded"]);

    let written: Value = serde_json::from_str(&read(&folder, "scale/report.json")).unwrap();
    assert_eq!(written, report);
    assert!(read(&folder, "scale/scale.svg").contains("side of the map [cells]"));
    let png = std::fs::read(folder.path().join("scale/scale.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
    let table = keyway(folder.path(), line).expect_code(0);
    assert!(table.out.contains("peak MB") && table.err.is_empty(), "{}", table.err);
    assert!(
        table.out.contains("it can be less than the memory reserved by the search"),
        "{}",
        table.out
    );
}

#[test]
fn parameters_reach_the_measured_process() {
    let folder = folder();
    let ask = |more: &str| {
        let line = format!("bench scale walled.map --sides 7 {more} --format json");
        keyway(folder.path(), &line).expect_code(0).json()["rows"][0]["cost_cells"].clone()
    };
    // With corner cutting, the path over the wall is shorter.
    assert!(ask("--planner astar --set planner.corners=allow").as_f64() < ask("").as_f64());
    for (line, part) in [
        ("bench scale nowhere.map", "nowhere.map"),
        ("bench scale walled.map --planner nobody", "nobody"),
        ("bench scale walled.map --sides 7,1", "1"),
        ("bench scale rooms.map --sides 40", "are not connected"),
        ("bench scale small_house.yaml --sides 64", "is free; with --unknown free, paths may lead"),
        ("bench scale walled.map --sides 60000", "larger than the limit"),
        ("bench scale walled.map --sides 7 --planner jps --unknown penalised", "one cost"),
    ] {
        let refused = keyway(folder.path(), line).expect_code(2);
        assert!(refused.err.contains(part), "{}", refused.err);
    }
}
