//! Tests of `keyway reproduce`: the claims of the papers, measured again.

use crate::latex_reader;
use crate::support::{Member, expect_members, folder, keyway, read, write};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const IS_NUMBER: fn(&Value) -> bool = Value::is_number;

#[test]
fn the_report_has_published_and_measured_figures_and_verdicts() {
    let folder = folder();
    let line = "reproduce s0-1 S2-4 S0-4 --maps 6 --out out --format json";
    let answer = keyway(folder.path(), line).expect_code(0);
    let report = answer.json();
    assert_eq!(answer.out, read(&folder, "out/report.json"));
    let top: [Member; 8] = [
        ("schema", |v| v == "keyway.reproduce/2"),
        ("seed", |v| v == 1),
        ("maps", |v| v == 6),
        ("times", |v| v == true),
        ("claims", Value::is_array),
        ("experiments", Value::is_array),
        ("ablations", |v| *v == json!([])),
        ("files", Value::is_array),
    ];
    expect_members(&report, &top);
    let claims = report["claims"].as_array().unwrap();
    let ids: Vec<&Value> = claims.iter().map(|claim| &claim["id"]).collect();
    assert_eq!(ids, ["S0-1", "S0-4", "S2-4"]);
    let of_claim: [Member; 12] = [
        ("id", Value::is_string),
        ("paper", |v| v == "You2021" || v == "Wang2019"),
        ("statement", Value::is_string),
        ("source", |v| Path::new("../..").join(v.as_str().unwrap()).is_file()),
        ("rule", |v| v == "figures" || v == "sign"),
        ("published", |v| v.is_object() || v.is_null()),
        ("scene", |v| v.is_object() || v.is_null()),
        ("reconstructed", |v| v.is_object() || v.is_null()),
        ("not_reconstructed", |v| v.is_string() || v.is_null()),
        ("family", Value::is_object),
        ("figures", Value::is_object),
        ("verdict", Value::is_string),
    ];
    for claim in claims {
        expect_members(claim, &of_claim);
    }
    let family: [Member; 7] = [
        ("experiment", |v| v == "you2021-search"),
        ("maps", |v| v == 6),
        ("left_out", Value::is_u64),
        ("mean", IS_NUMBER),
        ("ci95_low", IS_NUMBER),
        ("ci95_high", IS_NUMBER),
        ("figures", |v| v.as_array().is_some_and(|figures| figures.len() == 3)),
    ];
    expect_members(&claims[0]["family"], &family);
    let expanded = &claims[0]["family"]["figures"][1];
    let figure: [Member; 15] = [
        ("measure", |v| v == "expanded"),
        ("unit", |v| v == ""),
        ("scale", |v| v == "relative"),
        ("of", |v| v == "bidirectional-jps, key-points"),
        ("than", |v| v == "astar"),
        ("expected", |v| v == "lower"),
        ("limit", Value::is_null),
        ("pairs", |v| v == 6),
        ("undefined", |v| v == 0),
        ("old_mean", IS_NUMBER),
        ("new_mean", IS_NUMBER),
        ("mean", IS_NUMBER),
        ("ci95_low", IS_NUMBER),
        ("ci95_high", IS_NUMBER),
        ("verdict", Value::is_string),
    ];
    expect_members(expanded, &figure);
    // The scene is fitted to the path length of A*, and its time was measured.
    let scene = &claims[0]["scene"];
    assert_eq!(scene["file"], "scenes/you2021/corner_to_corner.toml");
    assert!((scene["figures"][2]["old"].as_f64().unwrap() - 29.213).abs() < 1e-3);
    assert!(claims[0]["family"]["figures"][0]["new_mean"].as_f64().unwrap() > 0.0);
    // As many fitting maps as requested. On each, A* has the published length.
    let reconstructed: [Member; 5] = [
        ("name", |v| v == "you2021"),
        ("tried", |v| v.as_u64() > Some(6)),
        ("seeds", |v| v.as_array().is_some_and(|seeds| seeds.len() == 6)),
        ("maps", |v| v == 6),
        ("figures", |v| v.as_array().is_some_and(|figures| figures.len() == 3)),
    ];
    expect_members(&claims[0]["reconstructed"], &reconstructed);
    let length_m = claims[0]["reconstructed"]["figures"][2]["old_mean"].as_f64().unwrap();
    assert!((length_m - 29.213).abs() < 1e-3, "{length_m}");
    assert_eq!((&claims[2]["scene"], &claims[2]["reconstructed"]), (&Value::Null, &Value::Null));
    // Either there are fitting maps, or a reason is given.
    for claim in claims {
        assert_ne!(claim["reconstructed"].is_null(), claim["not_reconstructed"].is_null());
    }
    assert_eq!((&claims[1]["rule"], &claims[1]["published"]), (&json!("sign"), &Value::Null));
    let methods = report["experiments"][0]["methods"].as_array().unwrap();
    assert!(methods.iter().any(|method| method["method"] == "jps" && method["mean_excess"] == 0.0));
}

/// Recomputes the figures from the table of all maps.
#[test]
fn figures_follow_from_the_maps() {
    let folder = folder();
    let line = "reproduce S4-6 --maps 5 --no-times --out out --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let text = read(&folder, "out/maps.csv");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let at = |name: &str| header.iter().position(|column| column == name).unwrap();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let expanded = |method: &str| -> Vec<f64> {
        let counts = |row: &&csv::StringRecord| {
            (&row[at("group")], &row[at("counts")]) == ("family", "true")
        };
        let own = rows.iter().filter(counts).filter(|row| &row[at("method")] == method);
        own.map(|row| row[at("expanded")].parse().unwrap()).collect()
    };
    let pairs = expanded("hsta, k = 1").into_iter().zip(expanded("hsta"));
    let changes: Vec<f64> = pairs.map(|(old, new)| (new - old) / old).collect();
    let figure = &report["claims"][0]["family"]["figures"][0];
    let mean = changes.iter().sum::<f64>() / changes.len() as f64;
    assert_eq!(changes.len(), 5);
    assert!((figure["mean"].as_f64().unwrap() - mean).abs() < 1e-12, "{figure} {changes:?}");
    // No time is in any file.
    assert!(rows.iter().all(|row| row[at("search_s")].is_empty()), "{text}");
}

#[test]
fn the_number_of_jobs_changes_no_byte() {
    let run = |jobs: u32| {
        let folder = folder();
        let line = format!(
            "reproduce S0-1 S0-5 S4-5 S2-6 --maps 7 --seed 40 --no-times --jobs {jobs} --out out --format json"
        );
        let printed = keyway(folder.path(), &line).expect_code(0).out;
        let files = ["report.json", "report.html", "claims.csv", "maps.csv", "maps.jsonl"];
        (printed, files.map(|file| read(&folder, &format!("out/{file}"))))
    };
    let (one, three) = (run(1), run(3));
    assert!(one == three, "{}\n{}", one.0, three.0);
    let report: Value = one.0.parse().unwrap();
    // Times are not judged, so a claim has a verdict without them.
    let claims = report["claims"].as_array().unwrap();
    let times = claims.iter().find(|claim| claim["id"] == "S2-6").unwrap();
    assert_eq!(
        (&times["figures"]["not_judged"], &times["figures"]["not_measured"]),
        (&json!(1), &json!(0))
    );
    assert_ne!(times["verdict"], "not_measured");
    // Maps that are left out do not depend on the order of completion, either.
    let left_out = report["experiments"][0]["left_out"].as_u64().unwrap();
    assert!(left_out > 0, "{}", report["experiments"]);
}

#[test]
fn the_table_has_a_line_for_every_claim_and_figure() {
    let folder = folder();
    let text = keyway(folder.path(), "reproduce S0-1 S0-4 S2-6 --maps 3 --no-times --out out")
        .expect_code(0)
        .out;
    assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
    for part in [
        "S2-6",
        "- expanded of bidirectional-jps, key-points, lower",
        "-59.77 %",
        "undecided",
        "of 3 maps",
        "wrote out/maps.csv",
    ] {
        assert!(text.contains(part), "{part} is missing in\n{text}");
    }
}

/// A folder in which three maps of two claims were measured, without times.
fn measured() -> TempDir {
    let folder = folder();
    keyway(folder.path(), "reproduce S0-5 S4-6 --maps 3 --no-times --out out").expect_code(0);
    folder
}

#[test]
fn what_was_measured_is_not_measured_again() {
    let whole = measured();
    let lines = read(&whole, "out/maps.jsonl");
    assert!(!whole.path().join("out/journal.jsonl").exists());
    // As a killed program leaves it: two complete maps, and half of a third one.
    let killed = folder();
    std::fs::create_dir(killed.path().join("out")).unwrap();
    let lines: Vec<&str> = lines.lines().collect();
    // A mark that a new measurement would not have.
    let marked = lines[0].replacen("\"expanded\":", "\"expanded\":1000", 1);
    assert_ne!(marked, lines[0]);
    let torn = &lines[2][..100];
    write(&killed, "out/journal.jsonl", &format!("{marked}\n{}\n{torn}", lines[1]));
    let line = "reproduce S0-5 S4-6 --maps 3 --no-times --out out";
    keyway(killed.path(), line).expect_code(0);
    let found = read(&killed, "out/maps.jsonl");
    assert_eq!(found.lines().next().unwrap(), marked);
    assert!(found.lines().skip(1).eq(lines[1..].iter().copied()), "{found}");
    assert!(!killed.path().join("out/journal.jsonl").exists());
    // The results are reused, too; with times, everything is measured again.
    keyway(killed.path(), line).expect_code(0);
    assert_eq!(read(&killed, "out/maps.jsonl"), found);
    keyway(killed.path(), "reproduce S0-5 S4-6 --maps 3 --out out").expect_code(0);
    assert_ne!(read(&killed, "out/maps.jsonl").lines().next().unwrap(), marked);
    write(&killed, "out/journal.jsonl", "dear diary\n");
    let error = keyway(killed.path(), line).expect_code(2).err;
    assert!(error.contains("not the journal of a reproduction"), "{error}");
}

#[test]
fn the_page_stands_alone_and_holds_every_picture() {
    let folder = measured();
    let page = read(&folder, "out/report.html");
    // Links lead to anchors on the page; nothing is loaded. The only address is the SVG
    // namespace.
    let links: Vec<&str> =
        page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(links.len() > 4);
    for link in links {
        let place = link.strip_prefix('#').unwrap_or_else(|| panic!("{link}"));
        assert!(page.contains(&format!("id=\"{place}\"")), "{link}");
    }
    assert!(!page.contains("src=") && !page.contains("url(") && !page.contains("@import"));
    let addresses: BTreeSet<&str> =
        page.split("http").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    assert!(addresses.iter().all(|rest| *rest == "://www.w3.org/2000/svg"), "{addresses:?}");
    let mut pictures = 0;
    for entry in std::fs::read_dir(folder.path().join("out/figures")).unwrap() {
        let svg = std::fs::read_to_string(entry.unwrap().path()).unwrap();
        assert!(page.contains(&svg));
        pictures += 1;
    }
    // Bars of both claims, one of them with a bound; and paths, searches and nodes of each
    // experiment.
    assert_eq!((pictures, page.matches("<figure>").count()), (9, 9));
    for part in ["S0-5", "keyway reproduce S4-6 --out DIR", "scenes/you2021/corner_to_corner.toml"]
    {
        assert!(page.contains(part), "{part}");
    }
}

/// The texts of a picture, one after another.
fn texts(folder: &TempDir, figure: &str) -> String {
    let svg = read(folder, &format!("out/figures/{figure}.svg"));
    let texts = svg.split("</text>").filter_map(|part| part.rsplit_once('>'));
    texts.map(|(_, text)| text).collect::<Vec<_>>().join(" ")
}

#[test]
fn pictures_say_what_they_show_and_how_they_were_made() {
    let folder = folder();
    let line = "reproduce S0-3 S0-6 S0-7 S1-4 S1-6 S4-5 --maps 2 --no-times --out out";
    keyway(folder.path(), line).expect_code(0);
    // An axis has a unit, 1 for a number.
    let clearance = texts(&folder, "S1-6.clearance");
    assert!(clearance.contains("difference of clearance [m]"), "{clearance}");
    assert!(texts(&folder, "S4-5.missed").contains("difference of missed [1]"));
    // Numbers are printed beside their bars, with the published value, if there is one.
    let note = "+0.500 m (+0.500 to +0.500) n = 2";
    assert!(clearance.contains(note) && !clearance.contains("published"), "{clearance}");
    let runs = texts(&folder, "S0-3.change");
    assert!(runs.contains("published \u{2212}13.59 %, n = 2"), "{runs}");
    // The axis of a share is complete, even if the share is 0.
    let kept = texts(&folder, "S0-6.kept");
    assert!(kept.contains("0 20 40 60 80 100") && kept.contains("on 0 of 2 maps"), "{kept}");
    for figure in [
        "S1-6.kept",
        "S1-6.clearance",
        "s1-smoothing.paths",
        "s1-smoothing.search",
        "s1-smoothing.expanded",
    ] {
        let texts = texts(&folder, figure);
        let made = "keyway reproduce S1-6 --maps 2 --seed 1 --no-times --out DIR.";
        assert!(texts.contains(made), "{figure}: {texts}");
    }
    assert!(texts(&folder, "s1-half-enclosed.speeds").contains("scenes/s1/half_enclosed.toml"));
    // A stack that never reaches the goal has a row nevertheless.
    let times = texts(&folder, "s1-half-enclosed.time");
    assert!(times.contains("dwa-to-goal") && times.contains("n = 0"), "{times}");
    // Parts of a run are distinguished in one picture of it; its time does not apply to them.
    let paths = texts(&folder, "you2021-speeds.paths");
    for part in ["one run", "where obstacles are sparse", "where obstacles are dense"] {
        assert_eq!(paths.matches(part).count(), 1, "{part}: {paths}");
    }
    assert!(texts(&folder, "you2021-speeds.mean_speed").contains("mean speed [m/s]"));
    assert!(!folder.path().join("out/figures/you2021-speeds.time.svg").exists());
}

#[test]
fn the_table_for_papers_is_sound() {
    let folder = measured();
    let cells = latex_reader::read(&read(&folder, "out/claims.tex"));
    // A row for each figure: two of each claim.
    assert_eq!((cells.len(), cells[0][0].as_str()), (5, "claim"));
    assert_eq!((cells[1][0].as_str(), cells[3][0].as_str()), ("S0-5", "S4-6"));
}

/// A variant is compared with the published method on the same maps, and the base has a point of
/// its own in a curve.
#[test]
fn ablations_are_asked_for() {
    let folder = folder();
    let line = "reproduce S2-2 --ablations --maps 4 --no-times --out out --format json";
    let report = keyway(folder.path(), line).expect_code(0).json();
    let ablations = report["ablations"].as_array().unwrap();
    let names: Vec<&Value> = ablations.iter().map(|ablation| &ablation["experiment"]).collect();
    assert_eq!(names, ["wang2019-parts", "wang2019-x"]);
    let (x, experiments) = (&ablations[1], report["experiments"].as_array().unwrap());
    assert_eq!(
        (experiments.len(), &x["values"][2], &x["base"]),
        (1, &json!(1.1), &json!("X = 1.1"))
    );
    // With X = 1 the estimate never exceeds the cost, and more nodes are expanded.
    let plain = &x["figures"][0];
    assert_eq!((&plain["of"], &plain["measure"]), (&json!("X = 1"), &json!("expanded")));
    assert_eq!((&plain["expected"], &plain["verdict"]), (&json!("none"), &Value::Null));
    assert!(plain["mean"].as_f64().unwrap() > 0.0, "{plain}");
    let page = read(&folder, "out/report.html");
    let curve = read(&folder, "out/figures/wang2019-x.expanded.svg");
    assert!(page.contains(&curve) && page.contains("Ablation wang2019-x"));
    // No time is in any file.
    assert!(!folder.path().join("out/figures/wang2019-x.planning_time.svg").exists());
}

/// Measurements before a kill are kept, and the results equal those of an uninterrupted
/// reproduction.
#[test]
fn killed_on_the_way_it_goes_on() {
    let folder = folder();
    let line = "reproduce S1-8 --maps 6 --no-times --jobs 2";
    keyway(folder.path(), &format!("{line} --out whole")).expect_code(0);
    let mut child = Command::new(env!("CARGO_BIN_EXE_keyway"))
        .args(line.split_whitespace().chain(["--out", "killed"]))
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let journal = folder.path().join("killed/journal.jsonl");
    let finished = || std::fs::read_to_string(&journal).unwrap_or_default().lines().count();
    while finished() < 2 && child.try_wait().unwrap().is_none() {
        std::thread::yield_now();
    }
    assert!(child.try_wait().unwrap().is_none(), "it has ended too early to say anything");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(finished() >= 2);
    // A mark in the earlier measurements that a new one would not have.
    let held = std::fs::read_to_string(&journal).unwrap();
    let marked = held.replacen("\"non_smooth_turns\":", "\"non_smooth_turns\":1000", 1);
    assert_ne!(marked, held);
    std::fs::create_dir(folder.path().join("marked")).unwrap();
    write(&folder, "marked/journal.jsonl", &marked);
    for out in ["killed", "marked"] {
        keyway(folder.path(), &format!("{line} --out {out}")).expect_code(0);
    }
    let first = marked.lines().next().unwrap();
    let found = read(&folder, "marked/maps.jsonl");
    assert_eq!(found.lines().filter(|line| *line == first).count(), 1, "{found}");
    for file in ["maps.jsonl", "maps.csv", "claims.csv", "report.html", "tables.md"] {
        let [killed, whole] =
            ["killed", "whole"].map(|out| read(&folder, &format!("{out}/{file}")));
        assert!(killed == whole, "{file}");
    }
}

/// Cells of the rows of the table with this header.
fn cells_of(text: &str, header: &str) -> Vec<Vec<String>> {
    let rows = text.lines().skip_while(|line| !line.starts_with(header));
    let rows = rows.skip(2).take_while(|line| line.starts_with('|'));
    let cells =
        |row: &str| row.trim_matches('|').split(" | ").map(|it| it.trim().to_owned()).collect();
    let rows: Vec<Vec<String>> = rows.map(cells).collect();
    assert!(!rows.is_empty(), "no table {header}");
    rows
}

/// The documented claims, their wording and published values, and the counts of verdicts.
#[test]
fn the_documentation_has_the_tables_that_are_written() {
    let folder = folder();
    keyway(folder.path(), "reproduce all --maps 2 --out out").expect_code(0);
    let written = read(&folder, "out/tables.md");
    let document = |name: &str| {
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name))
            .unwrap()
    };
    let (findings, readme) = (document("docs/lab/findings.md"), document("README.md"));
    for (text, header, columns) in [
        (&findings, "| claim | figure |", 3),
        (&findings, "| claim | statement |", 3),
        (&findings, "| experiment | maps tried", 1),
    ] {
        let first = |text: &str| -> Vec<Vec<String>> {
            cells_of(text, header).iter().map(|row| row[..columns].to_vec()).collect()
        };
        assert_eq!(first(text), first(&written), "{header}");
    }
    // The claims' verdicts follow from those of their figures, and both are counted.
    let (mut of_claims, mut claim) = (Vec::<Vec<String>>::new(), Vec::new());
    for row in cells_of(&findings, "| claim | figure |") {
        if !row[0].is_empty() && !claim.is_empty() {
            of_claims.push(std::mem::take(&mut claim));
        }
        claim.push(row[5].trim_matches('*').to_owned());
    }
    of_claims.push(claim);
    let in_short = cells_of(&findings, "| claim | statement |");
    assert_eq!((of_claims.len(), in_short.len()), (31, 31));
    let count = |of: &[String], verdict: &str| of.iter().filter(|it| *it == verdict).count();
    for (figures, row) in of_claims.iter().zip(&in_short) {
        let [hold, not, undecided] =
            ["holds", "does not hold", "undecided"].map(|verdict| count(figures, verdict));
        let expected = match (hold, not, undecided) {
            (0, 0, 0) => "only times",
            (_, 0, 0) => "holds",
            (0, 0, _) => "undecided",
            (0, ..) => "does not hold",
            _ => "mixed",
        };
        assert_eq!(row[4].split(':').next(), Some(expected), "{row:?}");
    }
    let with = |verdict: &str| in_short.iter().filter(|row| row[4].starts_with(verdict)).count();
    let counted = format!(
        "{} hold, {} do not, {} are mixed",
        with("holds"),
        with("does not hold"),
        with("mixed")
    );
    assert!(findings.contains(&counted) && readme.contains(&counted), "{counted}");
}
