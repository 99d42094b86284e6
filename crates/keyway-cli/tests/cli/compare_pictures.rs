//! Tests of the files written by `keyway compare`.

use crate::compare::{SCEN, rows};
use crate::support::{folder, keyway, read, write};
use serde_json::Value;

#[test]
fn tables_and_pictures() {
    let folder = folder();
    // One of the five has no path.
    let table = keyway(folder.path(), &format!("{SCEN} --queries 5 --out out")).expect_code(0);
    for part in ["excess", "theta-star", "4/5", "rooms.map: 5 queries, 4 compared, no corners cut"]
    {
        assert!(table.out.contains(part), "{part}: {}", table.out);
    }
    assert!(table.err.is_empty(), "{}", table.err);
    let report: Value = serde_json::from_str(&read(&folder, "out/report.json")).unwrap();
    let csv = read(&folder, "out/table.csv");
    let lines: Vec<&str> = csv.lines().collect();
    let members: Vec<&str> =
        rows(&report)[0].as_object().unwrap().keys().map(String::as_str).collect();
    assert_eq!(lines[0].split(',').collect::<Vec<_>>(), members);
    assert!(lines.len() == 3 && lines[1].starts_with("rooms.map,astar,none,forbid,5,4,0.37"));
    let tex = read(&folder, "out/table.tex");
    for part in ["\\toprule", "excess \\% &", "  theta-star & none & 4/5 &"] {
        assert!(tex.contains(part), "{part}: {tex}");
    }
    let svg = read(&folder, "out/rooms.svg");
    let query = report["maps"][0]["picture_query"].as_u64().unwrap();
    for part in [format!("query {query}"), "astar, none: ".to_owned(), "shortest line".to_owned()] {
        assert!(svg.contains(&part), "{part}");
    }
    assert!(std::fs::read(folder.path().join("out/rooms.png")).unwrap().starts_with(b"\x89PNG"));
    // Files of the user are not overwritten.
    write(&folder, "out/table.csv", "mine");
    let refused = keyway(folder.path(), &format!("{SCEN} --out out")).expect_code(2);
    assert!(refused.err.contains("table.csv is in the way"), "{}", refused.err);
}

#[test]
fn equal_paths_share_a_line_of_the_picture() {
    let folder = folder();
    // A* and Dijkstra's algorithm both go straight on, and there is nothing to smooth.
    write(&folder, "q.csv", "0.5,0.5,0.5,3.5");
    let line = "compare walled.map --pairs q.csv --planners astar,dijkstra --out out";
    keyway(folder.path(), line).expect_code(0);
    let svg = read(&folder, "out/walled.svg");
    // In the picture and in the legend.
    let strokes = |color: &str| svg.matches(&format!("stroke=\"{color}\"")).count();
    assert_eq!((strokes("#0072b2"), strokes("#d55e00")), (4, 0), "{svg}");
    assert!(svg.contains("astar, none: 3.00 m") && svg.contains("dijkstra, none: 3.00 m"));
}

#[test]
fn pictures_of_an_earlier_comparison_go() {
    let folder = folder();
    let compare = |maps: &str| {
        keyway(folder.path(), &format!("compare {maps} --queries 2 --out out")).expect_code(0);
        let names = std::fs::read_dir(folder.path().join("out")).unwrap();
        let mut names: Vec<String> =
            names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|name| name.contains("rooms") || name.contains("walled"));
        names.sort();
        names
    };
    let all = ["rooms.png", "rooms.svg", "walled.png", "walled.svg"];
    assert_eq!(compare("rooms.map walled.map"), all);
    assert_eq!(compare("walled.map"), all[2..]);
    // Files of the user are kept: one that Keyway never wrote, and one that was edited.
    write(&folder, "out/rooms.txt", "mine");
    write(&folder, "out/walled.svg", "edited");
    assert_eq!(compare("rooms.map"), ["rooms.png", "rooms.svg", "rooms.txt", "walled.svg"]);
    assert_eq!(read(&folder, "out/walled.svg"), "edited");
}

/// In the folder of the demo, the map was written by Keyway.
#[test]
fn the_map_itself_is_not_replaced_by_its_picture() {
    let folder = tempfile::tempdir().unwrap();
    keyway(folder.path(), "demo").expect_code(0);
    let map = || std::fs::read(folder.path().join("keyway-demo/small_house.png")).unwrap();
    let before = map();
    let line = "compare keyway-demo/small_house.yaml --queries 1 --out keyway-demo";
    let refused = keyway(folder.path(), line).expect_code(2);
    assert!(refused.err.contains("small_house.png is an input file"), "{}", refused.err);
    assert_eq!(map(), before);
}

#[test]
fn many_paths_are_drawn_in_panels() {
    let folder = folder();
    let picture = |more: &str| {
        let line = format!("compare walled.map --queries 2 {more} --out out");
        keyway(folder.path(), &line).expect_code(0);
        read(&folder, "out/walled.svg")
    };
    let few = picture("--planners jps,astar4 --smoothers none,line-of-sight,taut");
    assert!(!few.contains("<use") && few.contains("astar4, taut: "), "{few}");
    let many = picture("--planners jps,astar4 --smoothers none,line-of-sight,taut,shortcut");
    assert_eq!(many.matches("<use").count(), 4, "one panel for each smoother");
    for title in [">none<", ">line-of-sight<", ">taut<", ">shortcut<", ">jps: "] {
        assert!(many.contains(title), "{title}");
    }
    // The map is drawn once.
    assert_eq!(many.matches("#2b2b2b").count(), 2, "the map, and in the legend");
}
