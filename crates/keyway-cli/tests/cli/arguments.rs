//! Tests of bad arguments of every command: each is refused with a message for the user.

use crate::examples::COMMANDS;
use crate::support::{folder, keyway_args, write};

/// Internal words that are no use to users, and requests for numbers that are hard to read.
fn internal_words(text: &str) -> Option<String> {
    const WORDS: [&str; 25] = [
        "::",
        "Some(",
        "None",
        "Ok(",
        "Err(",
        "Error {",
        "unwrap",
        "panicked",
        "thread '",
        "f64",
        "u64",
        "i64",
        "u32",
        "i32",
        "usize",
        "serde",
        "struct ",
        "enum ",
        "variant",
        "NaN m",
        "inf m",
        "0xff",
        "invalid digit",
        "target type",
        "..=",
    ];
    let word = WORDS.iter().find(|word| text.contains(*word)).map(|word| (*word).to_owned());
    let is_digit = |c: char| c.is_ascii_digit();
    let longest = text.split(|c| !is_digit(c)).map(str::len).max().unwrap_or_default();
    word.or_else(|| (longest > 20).then(|| format!("a number of {longest} digits")))
}

const PLAN: &str = "plan walled.map --start 1.5,0.5 --goal 5.5,0.5";
const SCENE: &str = "navigate --scene small_house.toml";
const DRIVE: &str = "navigate walled.map --start 1.5,0.5 --goal 5.5,0.5";
const COMPARE: &str = "compare walled.map --queries 1";
const GRID: &str = "bench grid rooms.map.scen --every 100";
const SCALE: &str = "bench scale walled.map --sides 14";

/// The rest of a command line, and the argument (or parameter) to blame.
type Bad = (&'static str, &'static str);

const SIZES: [Bad; 9] = [
    ("--radius=-1", "--radius"),
    ("--radius -1e-300", "--radius"),
    ("--radius nan", "--radius"),
    ("--radius inf", "--radius"),
    ("--radius 1e999", "--radius"),
    ("--radius 1e308", "--radius"),
    ("--radius wide", "--radius"),
    ("--radius=", "--radius"),
    ("--robot hal", "--robot"),
];

const CONFIGS: [Bad; 15] = [
    ("--unknown maybe", "--unknown"),
    ("--config none.toml", "--config"),
    ("--config bad.toml", "--config"),
    ("--config map.toml", "map.colour"),
    ("--set corners", "--set"),
    ("--set =1", "--set"),
    ("--set map", "--set"),
    ("--set map=1", "map"),
    ("--set map.colour=1", "map.colour"),
    ("--set map.clearance_m=wide", "map.clearance_m"),
    ("--set map.clearance_m=1e308", "map.clearance_m"),
    ("--set map.unknown=maybe", "map.unknown"),
    ("--set map.unknown_penalty=1e300", "map.unknown_penalty"),
    ("--set map.published.expansion_cells=-1", "map.published.expansion_cells"),
    ("--set map.published.expansion_cells=99999999999", "map.published.expansion_cells"),
];

#[test]
fn of_a_robot_s_size() {
    for command in [PLAN, DRIVE, SCENE, COMPARE, "prepare walled.map --out w", SCALE] {
        all(command, &SIZES);
    }
}

#[test]
fn of_parameters() {
    for command in [PLAN, DRIVE, COMPARE, "prepare walled.map --out w", GRID, SCALE] {
        // With a robot, the clearance of the map is that of the robot.
        all(command, &CONFIGS);
    }
}

#[test]
fn of_plan() {
    for (option, name) in [("--start", "1.5,0.5"), ("--goal", "5.5,0.5")] {
        for bad in
            ["1", "1,2,3", "x,y", "nan,1", "1e999,0", "1e308,0", "-1e308,0", "''", ",", "9,9"]
        {
            let line = PLAN.replace(name, bad);
            refused(&line, option);
        }
    }
    for (option, cell) in [("--start", "0,0"), ("--goal", "1,0")] {
        let cells = "plan walled.map --cells --start 0,0 --goal 1,0";
        for bad in ["1.5,0", "99999999999,0", "0,-99999999999", "77,0"] {
            refused(
                &cells.replace(&format!("{option} {cell}"), &format!("{option} {bad}")),
                option,
            );
        }
    }
    all(
        PLAN,
        &[
            ("--planner teleport", "--planner"),
            ("--planner=", "--planner"),
            ("--smoother iron", "--smoother"),
            ("--budget -1", "--budget"),
            ("--budget x", "--budget"),
            ("--budget 1e3", "--budget"),
            ("--prepared none", "--prepared"),
            ("--prepared walled.map", "--prepared"),
            ("--prepared walled.map --planner jps", "--prepared"),
            ("--picture a.gif", "--picture"),
            ("--picture none/a.svg", "--picture"),
            ("--animate a.png", "--animate"),
            ("--curve a.txt", "--curve"),
            ("--spacing 1", "--curve"),
            ("--curve a.csv --spacing 0", "--spacing"),
            ("--curve a.csv --spacing 1e-300", "--spacing"),
            ("--curve a.csv --spacing 1e999", "--spacing"),
            ("--nearest-reachable --goal 1,1", "--nearest-reachable"),
            ("--seed 1", "--seed"),
            ("--colour red", "--colour"),
            ("--format xml", "--format"),
            ("--planner hsta --set hsta.l1_constraint=-1", "planner.l1_constraint"),
            ("--planner hsta --set hsta.l1=1", "hsta.l1"),
            ("--planner hsta --config own.toml", "hsta.colour"),
            ("--set hsta.l1_constraint=1", "hsta.l1_constraint"),
            ("--set jps.name=hsta", "jps.name"),
            ("--planner rrt --set planner.samples=0", "planner.samples"),
            ("--planner rrt --set planner.seed=-1", "planner.seed"),
            ("--planner ratio-astar --set planner.x=-1e308", "planner.x"),
            (
                "--smoother hierarchical --set smoother.safe_distance_m=-1e308",
                "smoother.safe_distance_m",
            ),
        ],
    );
    all("plan walled.map --start 1.5,0.5", &[("", "--goal")]);
    all("plan --start 1.5,0.5 --goal 5.5,0.5", &[("", "<MAP>")]);
    for bad in ["0", "-1", "nan", "1e308", "1e-308", "x"] {
        refused(&format!("{PLAN} --resolution {bad}"), "--resolution");
    }
    for bad in ["1", "nan,0", "1e308,0", "0,0,nan", "x"] {
        refused(&format!("{PLAN} --origin {bad}"), "--origin");
    }
}

#[test]
fn of_navigate() {
    for bad in ["1", "1,2,3,4", "x,y", "nan,1", "1e308,0", "1,1,nan", "99,0"] {
        refused(&DRIVE.replace("1.5,0.5", bad), "--start");
    }
    for bad in ["1", "1,2,3,4", "x,y", "1,2,nan", "1e308,0", "99,0"] {
        refused(&DRIVE.replace("5.5,0.5", bad), "--goal");
    }
    all(
        DRIVE,
        &[
            ("--stack hay", "--stack"),
            ("--robot hal", "--robot"),
            ("--robot bad.toml", "--robot"),
            ("--obstacle 1,1", "--obstacle"),
            ("--obstacle 1,1,-1", "--obstacle"),
            ("--obstacle 1,1,-1e11", "--obstacle"),
            ("--obstacle 1,1,1e308", "--obstacle"),
            ("--obstacle 1,1,nan", "--obstacle"),
            ("--seed -1", "--seed"),
            ("--seed x", "--seed"),
            ("--disturbances none.toml", "--disturbances"),
            ("--disturbances bad.toml", "--disturbances"),
            ("--time-limit 0", "--time-limit"),
            ("--time-limit -1e308", "--time-limit"),
            ("--time-limit nan", "--time-limit"),
            ("--time-limit x", "--time-limit"),
            ("--set local.window.horizon_s=-1e308", "local.window.horizon_s"),
            ("--set controller.blocked_s=0", "controller.blocked_s"),
            ("--set map.free_ends_m=1", "map.free_ends_m"),
            ("--set planner.name=prepared", "planner.name"),
            ("--set hsta.if_no_path=relax", "hsta.if_no_path"),
        ],
    );
    all("navigate walled.map --start 1.5,0.5", &[("", "--goal")]);
    all("navigate walled.map --goal 1.5,0.5", &[("", "--start")]);
    all(SCENE, &[("walled.map", "[MAP]"), ("--start 1,1", "--start"), ("--goal 1,1", "--goal")]);
    all("navigate --scene none.toml", &[("", "--scene")]);
    refused("demo --colour red", "--colour");
}

#[test]
fn of_compare_and_prepare() {
    all(
        COMPARE,
        &[
            ("--planners jps,teleport", "--planners"),
            ("--planners jps,,astar", "--planners"),
            ("--planners jps,", "--planners"),
            ("--planners=", "--planners"),
            ("--smoothers none,none", "--smoothers"),
            ("--smoothers ,", "--smoothers"),
            ("--seed 0.5", "--seed"),
            ("--seed x", "--seed"),
            ("--repeat 0", "--repeat"),
            ("--pairs q.csv", "--queries"),
            ("--scen none.scen", "--scen"),
            ("--set planner.name=jps", "planner.name"),
            ("--set hsta.l1_constraint=1", "hsta.l1_constraint"),
            ("--planners hsta --set hsta.l1_constraint=-1", "hsta.l1_constraint"),
            ("--planners hsta --set hsta.l1_constraint=far", "hsta.l1_constraint"),
            ("--planners hsta,jps --set planner.l1_constraint=1", "planner.l1_constraint"),
        ],
    );
    for bad in ["0", "-1", "x", "1e3", "9999999999"] {
        refused(&format!("compare walled.map --queries {bad}"), "--queries");
    }
    refused("prepare walled.map", "--out");
    refused("prepare walled.map --out none/w", "--out");
    refused("prepare walled.map --out walled.map", "--out");
}

#[test]
fn of_reproduce() {
    for bad in ["S0-9", "s3", "0", "''"] {
        refused(&format!("reproduce {bad} --out r"), "CLAIM");
    }
    for bad in ["1", "-1", "x", "9999999"] {
        refused(&format!("reproduce S0-1 --out r --maps {bad}"), "--maps");
    }
    refused("reproduce S0-1 --out r --seed -1", "--seed");
    refused("reproduce S0-1 --out r --jobs 0", "--jobs");
    refused("reproduce S0-1 --out walled.map", "--out");
    refused("reproduce S0-1", "--out");
}

#[test]
fn of_benchmarks_maps_and_lists() {
    all(
        GRID,
        &[
            ("--planner teleport", "--planner"),
            ("--repeat 0", "--repeat"),
            ("--jobs 0", "--jobs"),
            ("--map-dir none", "FILE.scen"),
            ("--radius 1", "--radius"),
            ("--set hsta.l1_constraint=1", "hsta.l1_constraint"),
        ],
    );
    for bad in ["0", "-1", "x", "9999999999"] {
        refused(&format!("bench grid rooms.map.scen --every {bad}"), "--every");
        refused(&format!("bench scale walled.map --sides {bad}"), "--sides");
    }
    refused("bench grid none.scen", "FILE.scen");
    let missing = refused("bench grid rooms.map.scen --map-dir nope", "FILE.scen");
    assert_eq!(missing.matches("nope/rooms.map").count(), 1, "{missing}");
    all(SCALE, &[("--planner teleport", "--planner"), ("--colour red", "--colour")]);
    for bad in ["0", "-1", "1e308", "x"] {
        refused(&format!("map info walled.map --resolution {bad}"), "--resolution");
        refused(&format!("map convert walled.map w.yaml --resolution {bad}"), "--resolution");
    }
    refused("map info", "<MAP>");
    refused("map convert walled.map", "<OUT>");
    refused("map convert walled.map w.txt", "OUT");
    refused("list nothing", "NAME");
    refused("list --robot hal", "--robot");
    refused("completions tea", "<SHELL>");
}

/// `keyway list` and the help texts address users, too.
#[test]
fn lists_and_help_use_no_internal_words() {
    let folder = folder();
    let ask = |line: &str| keyway_args(folder.path(), line.split_whitespace()).expect_code(0);
    let report = ask("list --format json").json();
    let names = report["entries"].as_array().unwrap().iter();
    let lists = names.map(|entry| format!("list {}", entry["name"].as_str().unwrap()));
    let helps = COMMANDS.iter().map(|command| format!("{command} --help"));
    for line in lists.chain(helps) {
        let text = ask(&line).out;
        let link = text.contains("super") || text.contains("[`");
        assert!(!text.contains("::") && !link, "{line}: {text}");
    }
}

#[track_caller]
fn all(command: &str, bad: &[Bad]) {
    let checked = bad.iter().map(|(option, blamed)| check(&format!("{command} {option}"), blamed));
    let wrong: Vec<String> = checked.filter_map(Result::err).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[track_caller]
fn refused(line: &str, blamed: &str) -> String {
    check(line, blamed).unwrap_or_else(|wrong| panic!("{wrong}"))
}

/// Checks exit code, message and the blamed argument; returns the message. `''` is an empty word.
fn check(line: &str, blamed: &str) -> Result<String, String> {
    let folder = folder();
    write(&folder, "q.csv", "1.5,0.5,5.5,0.5\n");
    write(&folder, "bad.toml", "[planner\n");
    write(&folder, "map.toml", "[map]\ncolour = 1\n");
    write(&folder, "own.toml", "[hsta]\ncolour = 1\n[planner]\nname = \"hsta\"\n");
    let words = || line.split_whitespace().map(|word| if word == "''" { "" } else { word });
    let text = keyway_args(folder.path(), words());
    let is_refused = text.code == 2 && text.out.is_empty() && text.err.starts_with("error: ");
    let wrong = |what: &str| Err(format!("{line}: {what}\n{}{}", text.out, text.err));
    if !is_refused {
        return wrong("not refused");
    }
    if let Some(word) = internal_words(&text.err) {
        return wrong(&word);
    }
    if !line.contains("--format") && !line.starts_with("completions") {
        let report = keyway_args(folder.path(), words().chain(["--format", "json"])).json();
        if report["field"] != blamed {
            return wrong(&format!("{} is blamed, not {blamed}", report["field"]));
        }
    }
    Ok(text.err)
}
