//! Tests of `keyway compare`.

use crate::support::{expect_members, folder, keyway, read, write};
use serde_json::Value;

pub(crate) const SCEN: &str = "compare rooms.map --scen rooms.map.scen --planners astar,theta-star";

pub(crate) fn rows(report: &Value) -> &Vec<Value> {
    report["rows"].as_array().unwrap()
}

pub(crate) fn number(row: &Value, name: &str) -> f64 {
    row[name].as_f64().unwrap_or_else(|| panic!("{name}: {row}"))
}

/// Two planners with two smoothers on two maps.
const TWO_MAPS: &str = "compare rooms.map walled.map --planners jps,theta-star \
                        --smoothers none,line-of-sight --queries 3 --seed 5 --format json";

#[test]
fn the_last_rows_are_over_all_maps() {
    let folder = folder();
    let report = keyway(folder.path(), TWO_MAPS).expect_code(0).json();
    let of = |row: usize, name: &str| number(&rows(&report)[row], name);
    // Both maps have three queries, so the mean over all is the mean of both.
    let mean = f64::midpoint(of(1, "mean_length_m"), of(5, "mean_length_m"));
    assert!((of(9, "mean_length_m") - mean).abs() < 1e-9);
    assert_eq!((of(9, "queries"), of(9, "compared")), (6.0, 6.0));
    let expanded = [1, 5, 9].map(|row| of(row, "mean_expanded"));
    assert!((expanded[2] - f64::midpoint(expanded[0], expanded[1])).abs() < 1e-9);
    // Smoothing expands nothing.
    assert_eq!(of(0, "mean_expanded"), expanded[0]);
    assert!(of(0, "mean_generated") >= expanded[0] && expanded[0] >= 1.0);
    let table = keyway(folder.path(), TWO_MAPS.split(" --format").next().unwrap()).out;
    assert!(table.contains("\nall maps: 6 queries\n"), "{table}");
}

#[test]
fn every_planner_with_every_smoother_on_every_map() {
    let folder = folder();
    let report = keyway(folder.path(), TWO_MAPS).expect_code(0).json();
    assert_eq!(report["schema"], "keyway.compare/1");
    let names = |row: &Value| {
        ["map", "planner", "smoother"].map(|name| row[name].as_str().unwrap().to_owned())
    };
    let expected = ["rooms.map", "walled.map", "all maps"].iter().flat_map(|map| {
        ["jps", "theta-star"].iter().flat_map(move |planner| {
            ["none", "line-of-sight"].map(|smoother| [*map, *planner, smoother].map(str::to_owned))
        })
    });
    assert_eq!(rows(&report).iter().map(names).collect::<Vec<_>>(), expected.collect::<Vec<_>>());
    expect_members(
        &rows(&report)[0],
        &[
            ("map", Value::is_string),
            ("planner", Value::is_string),
            ("smoother", Value::is_string),
            ("corners", |v| v == "forbid"),
            ("queries", |v| v == 3),
            ("solved", |v| v == 3),
            ("ci_low_solved", Value::is_f64),
            ("ci_high_solved", |v| v == 1.0),
            ("missed", |v| v == 0),
            ("without_path", |v| v == 0),
            ("compared", |v| v == 3),
            ("mean_length_m", Value::is_f64),
            ("sd_length_m", Value::is_f64),
            ("ci_low_length_m", Value::is_f64),
            ("ci_high_length_m", Value::is_f64),
            ("p5_length_m", Value::is_f64),
            ("p95_length_m", Value::is_f64),
            ("mean_excess", Value::is_f64),
            ("sd_excess", Value::is_f64),
            ("ci_low_excess", Value::is_f64),
            ("ci_high_excess", Value::is_f64),
            ("p5_excess", Value::is_f64),
            ("p95_excess", Value::is_f64),
            ("max_excess", Value::is_f64),
            ("mean_turns", Value::is_f64),
            ("sd_turns", Value::is_f64),
            ("ci_low_turns", Value::is_f64),
            ("ci_high_turns", Value::is_f64),
            ("p5_turns", Value::is_f64),
            ("p95_turns", Value::is_f64),
            ("mean_turning_angle_deg", Value::is_f64),
            ("sd_turning_angle_deg", Value::is_f64),
            ("ci_low_turning_angle_deg", Value::is_f64),
            ("ci_high_turning_angle_deg", Value::is_f64),
            ("p5_turning_angle_deg", Value::is_f64),
            ("p95_turning_angle_deg", Value::is_f64),
            ("mean_non_smooth_turns", Value::is_f64),
            ("sd_non_smooth_turns", Value::is_f64),
            ("ci_low_non_smooth_turns", Value::is_f64),
            ("ci_high_non_smooth_turns", Value::is_f64),
            ("p5_non_smooth_turns", Value::is_f64),
            ("p95_non_smooth_turns", Value::is_f64),
            ("mean_clearance_m", Value::is_f64),
            ("sd_clearance_m", Value::is_f64),
            ("ci_low_clearance_m", Value::is_f64),
            ("ci_high_clearance_m", Value::is_f64),
            ("p5_clearance_m", Value::is_f64),
            ("p95_clearance_m", Value::is_f64),
            ("min_clearance_m", Value::is_f64),
            ("mean_expanded", Value::is_f64),
            ("sd_expanded", Value::is_f64),
            ("ci_low_expanded", Value::is_f64),
            ("ci_high_expanded", Value::is_f64),
            ("p5_expanded", Value::is_f64),
            ("p95_expanded", Value::is_f64),
            ("mean_generated", Value::is_f64),
            ("sd_generated", Value::is_f64),
            ("ci_low_generated", Value::is_f64),
            ("ci_high_generated", Value::is_f64),
            ("p5_generated", Value::is_f64),
            ("p95_generated", Value::is_f64),
            ("shortfalls", |v| v == 0),
            ("median_plan_us", Value::is_f64),
            ("mean_plan_cpu_us", |v| v.is_f64() || cfg!(not(unix))),
            // For the smoother `none`.
            ("median_smooth_us", Value::is_null),
            ("mean_smooth_cpu_us", Value::is_null),
            ("preparation_ms", Value::is_f64),
        ],
    );
    let smoothed = &rows(&report)[1];
    assert!(number(smoothed, "median_smooth_us") > 0.0);
    let again = keyway(folder.path(), TWO_MAPS).json();
    assert_eq!(again["maps"], report["maps"], "the same seed");
    let other = keyway(folder.path(), &TWO_MAPS.replace("seed 5", "seed 6")).json();
    assert_ne!(other["maps"], report["maps"]);
}

/// The wall of `walled.map` is open in the uppermost row only. The shortest line from (1.5, 0.5) to
/// (5.5, 0.5) turns at the wall's upper corners (3, 4) and (4, 4): 2 hypot(1.5, 3.5) + 1.
#[test]
fn one_query_by_hand() {
    let folder = folder();
    write(&folder, "q.csv", "start_x,start_y,goal_x,goal_y\n1.5,0.5,5.5,0.5\n");
    let line = "compare walled.map --pairs q.csv --planners jps,astar \
                --set planner.corners=allow --format json";
    keyway(folder.path(), line).expect_code(2);
    let line = line.replace("jps,", "");
    let report = keyway(folder.path(), &line).expect_code(0).json();
    let shortest_m = 2.0 * 1.5f64.hypot(3.5) + 1.0;
    let query = &report["maps"][0]["queries"][0];
    assert_eq!((&query["start"], &query["goal"]), (&[1.5, 0.5].into(), &[5.5, 0.5].into()));
    assert!((number(&query["shortest_m"], "allow") - shortest_m).abs() < 1e-9);
    assert_eq!(query["shortest_m"]["forbid"], Value::Null);
    let row = &rows(&report)[0];
    // To the cell above the wall, (3, 4), and down again: 2 straight and 2 diagonal steps each.
    let length_m = 4.0 + 4.0 * 2f64.sqrt();
    assert!((number(row, "mean_length_m") - length_m).abs() < 1e-9, "{row}");
    assert!((number(row, "mean_excess") - (length_m / shortest_m - 1.0)).abs() < 1e-9);
    assert_eq!(row["corners"], "allow");
}

/// Each smoother has its own safe distance, or all share one; the same holds for planners.
#[test]
fn parameters_of_one_and_of_all() {
    let folder = folder();
    let config = |line: &str| -> Value {
        let line = format!("compare walled.map --queries 1 --format json {line}");
        keyway(folder.path(), &line).expect_code(0).json()["config"].clone()
    };
    let all = "--smoothers key-points,hierarchical --planners jps,ratio-astar,hsta \
               --set smoother.safe_distance_m=0.25";
    let safe_m = |config: &Value| -> Vec<f64> {
        let smoothers = config["smoothers"].as_array().unwrap().iter();
        smoothers.map(|smoother| smoother["safe_distance_m"].as_f64().unwrap()).collect()
    };
    assert_eq!(safe_m(&config(all)), [0.25, 0.25]);
    let one = format!("--set hierarchical.safe_distance_m=0.5 --set ratio-astar.x=3 {all}");
    let config = config(&one);
    assert_eq!(safe_m(&config), [0.25, 0.5], "that of one counts more");
    assert_eq!(config["planners"][1]["x"], 3.0);
    let refused = |line: &str, parts: [&str; 2], field: &str| {
        let line = format!("compare walled.map --queries 1 --format json {line}");
        let error = keyway(folder.path(), &line).expect_code(2).json();
        assert!(parts.iter().all(|&part| error["message"].to_string().contains(part)), "{error}");
        assert_eq!((&error["kind"], &error["field"]), (&"config".into(), &field.into()), "{error}");
    };
    let names = "--smoothers none,hierarchical";
    let line = format!("{names} --set hierarchical.safe_distance=1");
    refused(&line, ["hierarchical: ", "safe_distance_m"], "hierarchical.safe_distance");
    let line = format!("{names} --set hierarchical.safe_distance_m=-1");
    refused(&line, ["hierarchical: ", "at least 0, got -1"], "hierarchical.safe_distance_m");
    let line = format!("{names} --set smoother.safe_distance_m=1");
    refused(&line, ["none: ", "no field `smoother.safe"], "smoother.safe_distance_m");
    let line = format!("{names} --set key-points.safe_distance_m=1");
    refused(
        &line,
        ["this part is not compared", "none, hierarchical"],
        "key-points.safe_distance_m",
    );
    let line = "--planners jps,ratio-astar --set ratio-astar.x=0";
    refused(line, ["ratio-astar: ", "planner.x must be"], "ratio-astar.x");
    for path in ["smoother.name", "planner.name", "hierarchical.name"] {
        let line = format!("{names} --set {path}=taut");
        refused(&line, [path, "--planners and --smoothers"], path);
    }
    let line = format!("{names} --set smoother={{name=\"taut\"}}");
    refused(&line, ["smoother.name", "--smoothers"], "smoother.name");
}

#[test]
fn paths_are_not_shorter_than_the_shortest_line() {
    let folder = folder();
    let line = format!("{SCEN} --smoothers none,line-of-sight --out out --format json");
    let report = keyway(folder.path(), &line).expect_code(0).json();
    for row in rows(&report) {
        // 39 of the 40 queries have a path.
        assert_eq!((&row["queries"], &row["solved"]), (&40.into(), &39.into()));
        assert_eq!((&row["without_path"], &row["compared"]), (&1.into(), &39.into()));
    }
    let excess = |i: usize| number(&rows(&report)[i], "mean_excess");
    assert!(excess(0) > excess(1) && excess(0) > excess(2), "{report}");
    let queries = read(&folder, "out/queries.csv");
    let header: Vec<&str> = queries.lines().next().unwrap().split(',').collect();
    let column = header.iter().position(|name| *name == "excess").unwrap();
    let all: Vec<f64> =
        queries.lines().skip(1).filter_map(|l| l.split(',').nth(column)?.parse().ok()).collect();
    assert_eq!(all.len(), 4 * 39);
    assert!(all.iter().all(|&excess| (-1e-9..1.0).contains(&excess)), "{all:?}");
}

/// One of the two queries ends 0.5 m beside the wall.
#[test]
fn paths_that_keep_less_than_they_should_are_reported() {
    let folder = folder();
    write(&folder, "q.csv", "0.5,0.5,2.5,0.5\n0.5,0.5,0.5,4.5");
    let line = "compare walled.map --pairs q.csv --smoothers none,key-points --out out";
    let safe = format!("{line} --set key-points.safe_distance_m=");
    let columns = |line: &str| -> (String, String, String) {
        let table = keyway(folder.path(), line).expect_code(0).out;
        let tex = read(&folder, "out/table.tex");
        assert!(table.contains("clear-") && tex.contains("least clearance m"), "{tex}");
        let report: Value = read(&folder, "out/report.json").parse().unwrap();
        let shortfalls = rows(&report).iter().map(|row| &row["shortfalls"]).cloned();
        (table, tex, shortfalls.collect::<Value>().to_string())
    };
    let (table, tex, counts) = columns(&format!("{safe}1"));
    assert_eq!(counts, "[0,1]");
    for (text, header) in [(&table, "short-"), (&tex, "shortfalls")] {
        let parts = [header, "0/2", "1/2"];
        assert!(parts.iter().all(|part| text.contains(part)), "{text}");
    }
    let (table, tex, counts) = columns(&format!("{safe}0.5"));
    assert_eq!(counts, "[0,0]");
    assert!(!table.contains("short-") && !tex.contains("shortfalls"), "{table}");
}

#[test]
fn queries_without_a_path_are_reported_with_the_reason() {
    let folder = folder();
    let wall = "3.5,0.5,0.5,0.5\n";
    write(
        &folder,
        "q.csv",
        &format!("# one that has a path\n0.5,0.5,2.5,0.5\n{wall}0.5,0.5,6.5,0.5"),
    );
    let line =
        "compare closed.map --pairs q.csv --planners jps,astar --smoothers none,taut --out out";
    let table = keyway(folder.path(), line).expect_code(0).out;
    let (_, note) = table.split_once("\nNot solved:\n").unwrap_or_else(|| panic!("{table}"));
    let lines: Vec<&str> =
        note.lines().take_while(|line| !line.is_empty()).map(str::trim).collect();
    let [blocked, apart] = lines[..] else { panic!("{note}") };
    let start =
        "closed.map, query 2 (line 3 of q.csv), not compared: jps, astar: start (3, 0) is inside";
    assert!(blocked.starts_with(start), "{blocked}");
    let all = "closed.map, query 3 (line 4 of q.csv), not compared: jps, astar: no path exists from \
               the start to the goal";
    assert_eq!(apart, all);
    let report: Value = read(&folder, "out/report.json").parse().unwrap();
    let queries = &report["maps"][0]["queries"];
    let member = |name: &str| (0..3).map(|i| queries[i][name].clone()).collect::<Value>();
    assert_eq!(member("line"), Value::from([2, 3, 4].to_vec()));
    assert_eq!(member("compared"), Value::from([true, false, false].to_vec()));
    assert_eq!(queries[0]["unsolved"], Value::Array(Vec::new()));
    let unsolved = &queries[1]["unsolved"][0];
    assert_eq!(
        (&unsolved["planners"][1], &unsolved["outcome"]),
        (&"astar".into(), &"blocked".into())
    );
    assert_eq!(queries[2]["unsolved"][0]["outcome"], "no_path");
    let csv = read(&folder, "out/queries.csv");
    let ends: Vec<&str> = csv.lines().map(|line| line.rsplit_once(',').unwrap().1).collect();
    assert_eq!(ends[..4], ["line", "2", "3", "4"]);
    assert!(csv.lines().nth(3).unwrap().ends_with("no path exists from the start to the goal,4"));
    // Only the first of many are listed, and nothing if there are none.
    write(&folder, "q.csv", &wall.repeat(7));
    let many = keyway(folder.path(), "compare closed.map --pairs q.csv").expect_code(1).out;
    assert_eq!(many.matches("inside an obstacle").count(), 5, "{many}");
    assert!(many.contains("and 2 more"), "{many}");
    let solved = keyway(folder.path(), "compare closed.map --queries 2").expect_code(0).out;
    assert!(!solved.contains("Not solved"), "{solved}");
}

#[test]
fn nothing_to_compare_is_exit_code_1() {
    let folder = folder();
    write(&folder, "q.csv", "1.5,0.5,5.5,0.5");
    let report = keyway(folder.path(), "compare closed.map --pairs q.csv --format json");
    let report = report.expect_code(1).json();
    let row = &rows(&report)[0];
    assert_eq!((&row["without_path"], &row["compared"]), (&1.into(), &0.into()));
    assert_eq!((&row["mean_length_m"], &row["mean_excess"]), (&Value::Null, &Value::Null));
    assert_eq!(report["maps"][0]["picture_query"], Value::Null);
}

#[test]
fn bad_input_is_exit_code_2() {
    let folder = folder();
    write(&folder, "q.csv", "start_x,start_y,goal_x,goal_y\n1.5,0.5,5.5,0.5\n1.5,0.5,9.5,0.5\n");
    write(&folder, "twin.map", &read(&folder, "rooms.map"));
    write(&folder, "short.csv", "sx,sy,gx,gy\n1.5,0.5,5.5,0.5\n");
    write(&folder, "empty.csv", "start_x,start_y,goal_x,goal_y\n");
    write(&folder, "empty.scen", "version 1\n");
    write(&folder, "full.map", "type octile\nheight 1\nwidth 2\nmap\n@.\n");
    for (line, part) in [
        ("compare", "MAP"),
        ("compare nowhere.map", "nowhere.map"),
        ("compare walled.map --planners jps,nobody", "nobody"),
        ("compare walled.map --smoothers none,nobody", "nobody"),
        ("compare walled.map --set planner.corner=allow", "planner.corner"),
        ("compare walled.map --pairs q.csv", "q.csv: line 3: the goal (9.5, 0.5) is outside"),
        ("compare walled.map --pairs short.csv", "short.csv: line 1: `sx` is not a column"),
        ("compare walled.map --pairs none.csv", "none.csv"),
        ("compare walled.map --scen rooms.map.scen", "line 2"),
        ("compare twin.map --scen rooms.map.scen", "for the map rooms.map, not for twin.map"),
        ("compare walled.map --scen empty.scen", "it has no scenarios"),
        ("compare walled.map --pairs empty.csv", "there are no pairs"),
        ("compare walled.map --planners jps,astar,jps", "--planners: jps is given twice"),
        ("compare walled.map --smoothers none,none", "--smoothers: none is given twice"),
        ("compare walled.map --scen rooms.map.scen --pairs q.csv", "--pairs"),
        ("compare walled.map --pairs q.csv --seed 1", "cannot be used with '--seed <N>'"),
        ("compare walled.map --pairs q.csv --queries 1", "cannot be used with '--queries <N>'"),
        ("compare rooms.map --scen rooms.map.scen --seed 1", "cannot be used with '--seed <N>'"),
        ("compare walled.map --queries 0", "--queries"),
        ("compare walled.map --repeat 0", "--repeat"),
        ("compare walled.map --radius -1", "a length of at least 0"),
        ("compare walled.map --planners jps --unknown penalised", "one cost"),
        ("compare rooms.map full.map", "full.map has no two connected free cells\n"),
        (
            "compare walled.map rooms.map --radius 2.2",
            "walled.map has no two connected free cells; the clearance of 2.2 m may be too large",
        ),
        (
            "compare rooms.map walled.map --radius 3",
            "walled.map: a radius of 3 m leaves no cell free on this map of 7.000 x 5.000 m",
        ),
    ] {
        let refused = keyway(folder.path(), line).expect_code(2);
        assert!(refused.err.contains(part), "{line}: {}", refused.err);
    }
}

#[test]
fn pairs_of_several_maps() {
    let folder = folder();
    let pairs = "map,start_x_m,start_y_m,goal_x_m,goal_y_m\nwalled,0.5,0.5,1.5,0.5\n\
                 rooms.map,20.5,1.5,21.5,1.5\nwalled.map,0.5,0.5,2.5,0.5\nother,99,99,99,99\n";
    write(&folder, "q.csv", pairs);
    let line = "compare walled.map rooms.map --pairs q.csv --format json";
    let report = keyway(folder.path(), line);
    let report = report.json();
    let goals = |map: usize| -> Vec<&Value> {
        report["maps"][map]["queries"].as_array().unwrap().iter().map(|q| &q["goal"]).collect()
    };
    assert_eq!(goals(0), [&Value::from([1.5, 0.5]), &[2.5, 0.5].into()]);
    assert_eq!(goals(1), [&Value::from([21.5, 1.5])]);
    let refused = keyway(folder.path(), &line.replace("rooms.map", "closed.map")).expect_code(2);
    assert!(refused.out.contains("no line has closed.map in the column `map`"), "{}", refused.out);
}

/// ROS maps are usually called `map.yaml`, in a folder named after their content.
#[test]
fn maps_of_one_file_name_have_names_of_their_own() {
    let folder = folder();
    for name in ["office", "house"] {
        std::fs::create_dir(folder.path().join(name)).unwrap();
    }
    write(&folder, "office/map.map", &read(&folder, "walled.map"));
    write(&folder, "house/map.map", &read(&folder, "rooms.map"));
    let pairs = "map,start_x,start_y,goal_x,goal_y\noffice/map.map,0.5,0.5,1.5,0.5\n\
                 house/map,1.5,1.5,2.5,1.5\noffice/map.map,0.5,0.5,2.5,0.5\n";
    write(&folder, "q.csv", pairs);
    let line =
        "compare office/map.map office/../house/map.map --pairs q.csv --planners jps --out out";
    let table = keyway(folder.path(), line).expect_code(0).out;
    let names = ["office/map.map", "house/map.map"];
    assert!(
        names.iter().all(|name| table.contains(&format!("\n{name}: ")) || table.starts_with(name)),
        "{table}"
    );
    let report: Value = read(&folder, "out/report.json").parse().unwrap();
    let of = |list: &str, member: &str| -> Vec<String> {
        let all = report[list].as_array().unwrap().iter();
        all.map(|one| one[member].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(
        (of("rows", "map"), of("maps", "name")),
        (
            [names[0], names[1], "all maps"].map(str::to_owned).to_vec(),
            names.map(str::to_owned).to_vec()
        )
    );
    assert_eq!(of("maps", "map")[1], "office/../house/map.map");
    let firsts = |file: &str| -> Vec<String> {
        let text = read(&folder, file);
        text.lines().skip(1).map(|line| line.split(',').next().unwrap().to_owned()).collect()
    };
    assert_eq!(firsts("out/table.csv"), [names[0], names[1], "all maps"]);
    assert_eq!(firsts("out/queries.csv"), [names[0], names[0], names[1]]);
    let tex = read(&folder, "out/table.tex");
    assert!(names.iter().all(|name| tex.contains(&format!("  {name} & "))), "{tex}");
    for picture in ["office-map.svg", "office-map.png", "house-map.svg", "house-map.png"] {
        assert!(folder.path().join("out").join(picture).is_file(), "{picture}");
    }
    write(&folder, "q.csv", &pairs.replacen("office/map.map", "map.map", 1));
    let refused = keyway(folder.path(), line).expect_code(2).err;
    let part = "line 2: `map.map` names several maps; write office/map.map or house/map.map";
    assert!(refused.contains(part), "{refused}");
}

#[test]
fn the_same_map_twice_is_refused() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("a")).unwrap();
    let mut others = vec!["walled.map", "./walled.map", "a/../walled.map"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("walled.map", folder.path().join("link.map")).unwrap();
        others.push("link.map");
    }
    for other in others {
        let line = format!("compare walled.map rooms.map {other} --queries 1");
        let refused = keyway(folder.path(), &line).expect_code(2).err;
        let message = format!("walled.map and {other} are the same map; give it once");
        assert!(refused.contains(&message), "{refused}");
    }
}

#[test]
fn the_table_fits_a_terminal_and_its_words_are_defined() {
    let folder = folder();
    let line = "compare small_house.yaml walled.map --radius 0.05 --queries 2 \
                --planners jps,bidirectional-jps-fixed --smoothers none,continuous-curvature,key-points";
    let table = keyway(folder.path(), line).expect_code(0).out;
    let widest = table.lines().map(|line| line.chars().count()).max().unwrap();
    assert!(widest <= 120, "{widest}: {table}");
    let help = keyway(folder.path(), "compare --help").expect_code(0).out;
    for term in ["excess", "turns", "non-smooth", "clearance", "shortfalls", "smooth"] {
        let definition = format!("\n  {term} ");
        assert!(table.contains(&definition) && help.contains(&definition), "{term}: {table}");
    }
}
