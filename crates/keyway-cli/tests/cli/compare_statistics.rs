//! Tests of `keyway compare`: intervals, tests against the first row, columns, and the default
//! planners and smoothers.

use crate::compare::{number, rows};
use crate::support::{folder, keyway, read, write};
use serde_json::Value;

/// The names of planners and smoothers in the rows.
fn compared(folder: &std::path::Path, line: &str) -> [Vec<String>; 2] {
    let line = format!("compare walled.map --queries 1 --format json {line}");
    let report = keyway(folder, &line).expect_code(0).json();
    ["planner", "smoother"].map(|part| {
        let mut names: Vec<String> =
            rows(&report).iter().map(|row| row[part].as_str().unwrap().to_owned()).collect();
        names.sort();
        names.dedup();
        names
    })
}

#[test]
fn what_is_compared_where_nothing_is_named() {
    let folder = folder();
    let few = [vec!["jps", "theta-star"], vec!["continuous-curvature", "none", "taut"]];
    assert_eq!(compared(folder.path(), ""), few);
    assert_eq!(
        compared(folder.path(), "--planners astar,jps"),
        [vec!["astar", "jps"], vec!["none"]]
    );
    assert_eq!(compared(folder.path(), "--smoothers taut"), [vec!["jps"], vec!["taut"]]);
    write(&folder, "c.toml", "planner = { name = \"astar\" }\nsmoother = { name = \"taut\" }\n");
    assert_eq!(compared(folder.path(), "--config c.toml"), [vec!["astar"], vec!["taut"]]);
}

#[test]
fn all_planners_and_all_smoothers() {
    let folder = folder();
    let list = keyway(folder.path(), "list --format json").expect_code(0).json();
    for (part, line) in [("planner", "--planners all"), ("smoother", "--smoothers all")] {
        let entries = list["entries"].as_array().unwrap().iter();
        let mut names: Vec<&str> = entries
            .filter(|entry| entry["kind"] == part)
            .map(|entry| entry["name"].as_str().unwrap())
            .collect();
        names.sort_unstable();
        assert!(names.len() > 5, "{list}");
        let [planners, smoothers] = compared(folder.path(), line);
        assert_eq!(if part == "planner" { planners } else { smoothers }, names);
    }
    let refused = keyway(folder.path(), "compare walled.map --planners all,jps").expect_code(2).err;
    assert!(refused.contains("--planners: `all` stands for all names; give it alone"), "{refused}");
}

#[test]
fn planners_that_cannot_weigh_unknown_cells_are_left_out_of_all() {
    let folder = folder();
    let line = "compare walled.map --queries 1 --unknown penalised";
    let [planners, _] = compared(folder.path(), "--unknown penalised --planners all");
    let report = keyway(folder.path(), &format!("{line} --planners all --format json")).json();
    let left_out = report["maps"][0]["left_out"].as_array().unwrap();
    let left_out: Vec<&str> = left_out.iter().map(|one| one["planner"].as_str().unwrap()).collect();
    assert!(left_out.contains(&"jps") && left_out.contains(&"prepared"), "{left_out:?}");
    assert!(planners.contains(&"astar".to_owned()) && planners.contains(&"hsta".to_owned()));
    let list = keyway(folder.path(), "list --format json").json();
    let all = list["entries"].as_array().unwrap().iter().filter(|one| one["kind"] == "planner");
    assert_eq!(planners.len() + left_out.len(), all.count());
    let table = keyway(folder.path(), &format!("{line} --planners all")).expect_code(0).out;
    let note = format!("Left out:\n  walled.map: {}: needs one cost", left_out.join(", "));
    assert!(table.contains(&note), "{table}");
    // A named planner is not left out.
    let refused = keyway(folder.path(), &format!("{line} --planners astar,jps")).expect_code(2).err;
    assert!(
        refused.contains("jps needs one cost for all cells") && refused.contains("--planners all")
    );
    // On other maps, no planner is left out.
    let report =
        keyway(folder.path(), "compare walled.map --queries 1 --planners all --format json").json();
    assert_eq!(report["maps"][0]["left_out"], Value::Array(Vec::new()));
}

#[test]
fn without_times_every_run_gives_the_same_bytes() {
    let folder = folder();
    let files = ["report.json", "table.csv", "table.tex", "against_first.tex", "rooms.svg"];
    let run = || {
        let line = "compare rooms.map --queries 3 --no-times --out out";
        let table = keyway(folder.path(), line).expect_code(0).out;
        (table, files.map(|name| read(&folder, &format!("out/{name}"))))
    };
    let (table, written) = run();
    assert_eq!(run(), (table.clone(), written.clone()));
    let header = table.lines().take(4).collect::<String>();
    assert!(!header.contains("plan us") && !header.contains("  us"), "{table}");
    assert!(!written[2].contains(" us"), "{}", written[2]);
    let report: Value = written[0].parse().unwrap();
    for row in rows(&report) {
        let times = row.as_object().unwrap().iter();
        let times: Vec<_> =
            times.filter(|(name, _)| name.ends_with("_us") || name.ends_with("_ms")).collect();
        assert!(times.len() == 5 && times.iter().all(|(_, time)| time.is_null()), "{row}");
    }
}

#[test]
fn columns_are_chosen() {
    let folder = folder();
    let line = "compare walled.map --queries 2 --columns worst,corners,solved --out out";
    let table = keyway(folder.path(), line).expect_code(0).out;
    let header: Vec<&str> = table.lines().nth(2).unwrap().split_whitespace().collect();
    assert_eq!(header, ["planner", "smoother", "worst", "%", "corners", "solved"]);
    let tex = read(&folder, "out/table.tex");
    assert!(tex.contains("  planner & smoother & worst \\% & corners & solved \\\\"), "{tex}");
    assert!(tex.contains("{llrrr}"), "{tex}");
    let names = keyway(folder.path(), &line.replace("worst,", "")).expect_code(0);
    assert!(names.code == 0 && read(&folder, "out/table.tex").contains("{lllr}"));
    // The help names the same columns.
    let line = "compare walled.map --columns weight";
    let refused = keyway(folder.path(), line).expect_code(2).err;
    let (_, ids) =
        refused.trim().split_once("there is no column `weight`; expected one of ").unwrap();
    let help = keyway(folder.path(), "compare --help").expect_code(0).out;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains(&format!("after the names: {ids} [default")), "{ids}: {help}");
    for (columns, part) in [
        ("length,weight", "there is no column `weight`; expected one of corners, solved,"),
        ("length,length", "length is given twice"),
        ("length,", "a name is missing"),
        ("plan --no-times", "plan is a time, which --no-times omits"),
    ] {
        let line = format!("compare walled.map --columns {columns}");
        let refused = keyway(folder.path(), &line).expect_code(2).err;
        assert!(refused.contains(part) && refused.contains("--columns: "), "{refused}");
    }
}

/// Paths of `astar` are as long as those of `jps`; without diagonal steps they are longer.
#[test]
fn each_row_is_tested_against_the_first() {
    let folder = folder();
    let line = "compare rooms.map --queries 8 --planners jps,astar,astar4 --smoothers none,taut";
    let report = keyway(folder.path(), &format!("{line} --format json")).expect_code(0).json();
    let tests = report["against_first"].as_array().unwrap();
    assert_eq!(tests.len(), 5);
    let names =
        |test: &Value| ["planner", "smoother"].map(|name| test[name].as_str().unwrap().to_owned());
    let find = |planner: &str| {
        let test = tests.iter().find(|test| names(test) == [planner, "none"]);
        test.unwrap_or_else(|| panic!("{report}"))
    };
    let equal = find("astar");
    assert_eq!((&equal["pairs"], &equal["equal"]), (&8.into(), &8.into()));
    assert_eq!((&equal["length_p"], &equal["rank_biserial"]), (&1.0.into(), &0.0.into()));
    assert_eq!(equal["median_length_difference_m"], 0.0);
    let longer = find("astar4");
    // Of 256 sign patterns, the observed one and its mirror image.
    assert_eq!((&longer["equal"], &longer["length_p"]), (&0.into(), &(2.0 / 256.0).into()));
    assert_eq!(longer["rank_biserial"], 1.0);
    assert!(number(longer, "ci_low_length_difference_m") > 0.0, "{longer}");
    // All rows but the one of equal lengths differ in every query: five tests with the same p, or
    // 1.
    let all_differ = tests.iter().filter(|test| test["length_p"] == 2.0 / 256.0).count();
    assert_eq!((all_differ, &longer["length_p_holm"]), (4, &(5.0 * 2.0 / 256.0).into()));
    // One test of what is solved for each other planner.
    let solved = |test: &Value| (test["solved_p"].clone(), test["solved_p_holm"].clone());
    for test in tests {
        let is_first = test["planner"] == "jps";
        let expected = if is_first { Value::Null } else { 1.0.into() };
        assert_eq!(solved(test), (expected.clone(), expected), "{test}");
    }
    let table = keyway(folder.path(), line).expect_code(0).out;
    let (_, part) = table.split_once("\nAgainst jps, none:\n").unwrap_or_else(|| panic!("{table}"));
    let row = part.lines().find(|line| line.contains("astar4   none")).unwrap();
    assert!(row.ends_with(" 1.00  0.039   1.000"), "{row}");
}

/// Without lowering its constraint, `hsta` misses most doors.
#[test]
fn what_one_planner_solves_more_often_is_tested() {
    let folder = folder();
    let line = "compare rooms.map --scen rooms.map.scen --planners jps,hsta,astar \
                --set hsta.if_no_path=fail --set hsta.l1_constraint=2 --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let solved = |i: usize| rows(&report)[i]["solved"].as_u64().unwrap();
    let more = solved(0) - solved(1);
    assert!(more > 0, "{report}");
    let test = &report["against_first"][0];
    assert_eq!((&test["planner"], &test["only_solved_by_first"]), (&"hsta".into(), &more.into()));
    assert_eq!(test["only_solved_by_this"], 0);
    // All differences have the same sign: 2 / 2^n, and twice that for two planners.
    let p = 2.0 / 2f64.powi(more as i32);
    assert!((number(test, "solved_p") / p.min(1.0) - 1.0).abs() < 1e-12, "{test}");
    assert!((number(test, "solved_p_holm") / (2.0 * p).min(1.0) - 1.0).abs() < 1e-12, "{test}");
}
