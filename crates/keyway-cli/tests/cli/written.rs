//! Tests that every command lists its written files in the same form.

use crate::support::{folder, keyway};
use serde_json::Value;

#[test]
fn what_was_written_is_said() {
    let plan = "plan walled.map --start 0.5,0.5 --goal 6.5,0.5";
    let all = format!("{plan} --picture p.png --animate a.gif --curve c.csv");
    for (line, files) in [
        (all.as_str(), &["c.csv", "p.png", "a.gif"][..]),
        (plan, &[]),
        // Without a path there is no curve.
        (
            "plan closed.map --start 0.5,0.5 --goal 6.5,0.5 --curve d.csv --picture q.svg",
            &["q.svg"],
        ),
        ("prepare walled.map --out w.prepared", &["w.prepared"]),
        (
            "compare walled.map --queries 1 --out c",
            &[
                "c/report.json",
                "c/table.csv",
                "c/table.tex",
                "c/against_first.csv",
                "c/against_first.tex",
                "c/queries.csv",
                "c/walled.svg",
                "c/walled.png",
            ],
        ),
        ("compare walled.map --queries 1", &[]),
        (
            "bench scale walled.map --sides 7 --out s",
            &["s/report.json", "s/scale.svg", "s/scale.png"],
        ),
        ("map convert walled.map w.yaml", &["w.yaml", "w.pgm"]),
        ("map convert walled.map w.png", &["w.png"]),
        ("map info walled.map", &[]),
        (
            "navigate --scene small_house.toml --time-limit 1 --out n",
            &[
                "n/report.json",
                "n/map.svg",
                "n/map.png",
                "n/speed.svg",
                "n/speed.png",
                "n/trajectory.csv",
            ],
        ),
        (
            "navigate closed.map --start 0.5,0.5 --goal 6.5,0.5 --radius 0.1 --out o",
            &["o/report.json", "o/map.svg", "o/map.png"],
        ),
    ] {
        let folder = folder();
        let text = keyway(folder.path(), line).out;
        let wrote: Vec<&str> =
            text.lines().filter_map(|line| line.strip_prefix("wrote ")).collect();
        assert_eq!(wrote, files, "{line}: {text}");
        assert!(files.iter().all(|file| folder.path().join(file).is_file()), "{line}");
        let report = keyway(folder.path(), &format!("{line} --format json")).json();
        assert_eq!(report["files"], Value::from(files.to_vec()), "{line}");
    }
}
