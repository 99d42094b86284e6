//! Tests of `keyway plan --curve`.

use crate::support::{expect_members, folder, keyway, read, write};
use serde_json::Value;

const WALLED: &str = "plan walled.map --start 1.5,0.5 --goal 5.5,0.5";
const HOUSE: &str = "plan small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875 --radius 0.2 \
                     --smoother continuous-curvature";

/// One line of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    s_m: f64,
    at: [f64; 2],
    heading_rad: f64,
    curvature_per_m: f64,
    t_s: f64,
    v_mps: f64,
    omega_radps: f64,
}

fn rows(csv: &str) -> Vec<Row> {
    let mut lines = csv.lines();
    let header = "s_m,x_m,y_m,heading_rad,curvature_per_m,t_s,v_mps,omega_radps,limit";
    assert_eq!(lines.next(), Some(header));
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        let n: Vec<f64> = fields[..8].iter().map(|field| field.parse().unwrap()).collect();
        assert!(fields.len() == 9 && fields[8].parse::<f64>().is_err(), "{line}");
        Row {
            s_m: n[0],
            at: [n[1], n[2]],
            heading_rad: n[3],
            curvature_per_m: n[4],
            t_s: n[5],
            v_mps: n[6],
            omega_radps: n[7],
        }
    };
    lines.map(row).collect()
}

/// True if equal up to the last digit: the file has the same digits, but `serde_json` reads the
/// last one with an error.
fn is_read_as(json: &Value, number: f64) -> bool {
    (json.as_f64().unwrap() - number).abs() <= 4.0 * f64::EPSILON * number.abs()
}

/// Time from rest to rest with a bounded rate, and bounds on its increase and decrease.
fn time_s(distance: f64, rate: f64, up: f64, down: f64) -> f64 {
    let peak = (2.0 * distance * up * down / (up + down)).sqrt().min(rate);
    let ramps = peak / up + peak / down;
    ramps + (distance - 0.5 * peak * ramps) / peak
}

/// The path crosses the wall in straight legs, with a stop and a turn at every corner.
#[test]
fn a_path_with_corners_by_hand() {
    let folder = folder();
    let line = format!("{WALLED} --curve a.csv --spacing 0.25 --format json");
    let report = keyway(folder.path(), &line).expect_code(0).json();
    keyway(folder.path(), &format!("{WALLED} --curve a.JSON --spacing 0.25")).expect_code(0);
    let json: Value = serde_json::from_str(&read(&folder, "a.JSON")).unwrap();
    let rows = rows(&read(&folder, "a.csv"));
    let corners: Vec<[f64; 2]> = serde_json::from_value(report["waypoints_m"].clone()).unwrap();
    let legs: Vec<[f64; 2]> =
        corners.windows(2).map(|p| [p[1][0] - p[0][0], p[1][1] - p[0][1]]).collect();
    let headings: Vec<f64> = legs.iter().map(|leg| leg[1].atan2(leg[0])).collect();
    let lengths: Vec<f64> = legs.iter().map(|leg| leg[0].hypot(leg[1])).collect();
    let turns: Vec<f64> = headings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    assert!(turns.len() > 2 && turns.iter().all(|&turn| turn < 2.0), "{turns:?}");

    let limits = &json["inputs"]["robot"]["limits"];
    let limit = |name: &str| limits[name].as_f64().unwrap();
    let drive = |&length: &f64| {
        time_s(length, limit("v_max_mps"), limit("acceleration_mps2"), limit("deceleration_mps2"))
    };
    let (up, down) = (limit("angular_acceleration_radps2"), limit("angular_deceleration_radps2"));
    let turn = |&angle: &f64| time_s(angle, limit("omega_max_radps"), up, down);
    let turning_s: f64 = turns.iter().map(turn).sum();
    let expected_s = lengths.iter().map(drive).sum::<f64>() + turning_s;
    let last = rows[rows.len() - 1];
    assert!((last.t_s - expected_s).abs() < 1e-9, "{} {expected_s}", last.t_s);
    assert!(is_read_as(&json["time_s"], last.t_s));
    assert!((json["turning_s"].as_f64().unwrap() - turning_s).abs() < 1e-9);
    assert!((last.s_m - lengths.iter().sum::<f64>()).abs() < 1e-9);
    assert_eq!((rows[0].at, last.at), (corners[0], corners[corners.len() - 1]));

    // Every row lies on its leg; at a corner there are two.
    let mut leg = 0;
    for (i, row) in rows.iter().enumerate() {
        if i > 0 && rows[i - 1].s_m == row.s_m {
            assert!(row.at == corners[leg + 1] && row.v_mps == 0.0 && rows[i - 1].v_mps == 0.0);
            leg += 1;
        }
        let along_m = row.s_m - lengths[..leg].iter().sum::<f64>();
        for axis in 0..2 {
            let expected = corners[leg][axis] + legs[leg][axis] * along_m / lengths[leg];
            assert!((row.at[axis] - expected).abs() < 1e-9, "{row:?}");
        }
        assert!((row.heading_rad - headings[leg]).abs() < 1e-9, "{row:?}");
        assert_eq!((row.curvature_per_m, row.omega_radps), (0.0, 0.0));
    }
    assert_eq!(leg, turns.len());
}

#[test]
fn a_curve_reads_back_as_the_smoothed_path() {
    let folder = folder();
    let line = format!("{HOUSE} --curve a.csv --robot jackal --format json");
    let report = keyway(folder.path(), &line).expect_code(0).json();
    keyway(folder.path(), &format!("{HOUSE} --curve a.json --robot jackal")).expect_code(0);
    let json: Value = serde_json::from_str(&read(&folder, "a.json")).unwrap();
    let rows = rows(&read(&folder, "a.csv"));
    let last = rows[rows.len() - 1];
    assert!(is_read_as(&json["time_s"], last.t_s) && is_read_as(&json["length_m"], last.s_m));
    assert_eq!(json["spacing_m"], 0.01);
    let limit = |name: &str| json["inputs"]["robot"]["limits"][name].as_f64().unwrap();
    assert_eq!(limit("v_max_mps"), 2.0, "a jackal");
    // The report's line consists of chords of the curve.
    let length_m = report["smoothed"]["length_m"].as_f64().unwrap();
    assert!((last.s_m / length_m - 1.0).abs() < 1e-3, "{} {length_m}", last.s_m);

    let (mut chords_m, mut bent, mut driven_s) = (0.0, 0, 0.0);
    for pair in rows.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let (step_m, chord) = (b.s_m - a.s_m, [b.at[0] - a.at[0], b.at[1] - a.at[1]]);
        assert!((0.0..=0.01 + 1e-9).contains(&step_m), "{a:?} {b:?}");
        // Only a corner is listed twice.
        assert!(step_m > 0.0 || (a.heading_rad - b.heading_rad).abs() > 1e-6, "{a:?} {b:?}");
        chords_m += chord[0].hypot(chord[1]);
        if step_m > 1e-6 {
            driven_s += 2.0 * step_m / (a.v_mps + b.v_mps);
            // A chord of a curve has approximately the mean of the headings at its ends.
            let off = |heading: f64| {
                let across = chord[1] * heading.cos() - chord[0] * heading.sin();
                across / step_m
            };
            let mean_curvature = 0.5 * (a.curvature_per_m + b.curvature_per_m);
            assert!((off(a.heading_rad) + off(b.heading_rad)).abs() < 2e-3, "{a:?} {b:?}");
            let turned = off(a.heading_rad) - off(b.heading_rad);
            assert!((turned - mean_curvature * step_m).abs() < 2e-3, "{a:?} {b:?}");
        }
        bent += usize::from(b.curvature_per_m.abs() > 0.1);
        assert_eq!(b.omega_radps, b.curvature_per_m * b.v_mps);
        assert!(b.v_mps <= limit("v_max_mps") + 1e-9);
        assert!(b.omega_radps.abs() <= limit("omega_max_radps") + 1e-9);
        assert!(b.t_s >= a.t_s);
    }
    assert!(bent > 50, "{bent}");
    assert!(chords_m <= last.s_m + 1e-9 && chords_m > last.s_m * (1.0 - 1e-4), "{chords_m}");
    let turning_s = json["turning_s"].as_f64().unwrap();
    assert!(((driven_s + turning_s) / last.t_s - 1.0).abs() < 1e-2, "{driven_s} {}", last.t_s);

    let samples = json["samples"].as_array().unwrap();
    assert_eq!(samples.len(), rows.len());
    for (sample, row) in samples.iter().zip(&rows) {
        let [x_m, y_m] = row.at;
        for (name, number) in [
            ("s_m", row.s_m),
            ("x_m", x_m),
            ("y_m", y_m),
            ("heading_rad", row.heading_rad),
            ("curvature_per_m", row.curvature_per_m),
            ("t_s", row.t_s),
            ("v_mps", row.v_mps),
            ("omega_radps", row.omega_radps),
        ] {
            assert!(is_read_as(&sample[name], number), "{name}: {sample} {row:?}");
        }
    }
    expect_members(
        &json,
        &[
            ("schema", |v| v == "keyway.curve/3"),
            ("length_m", Value::is_f64),
            ("time_s", Value::is_f64),
            ("turning_s", Value::is_f64),
            ("spacing_m", Value::is_f64),
            ("samples", Value::is_array),
            ("inputs", |v| v["config"]["smoother"]["name"] == "continuous-curvature"),
        ],
    );
}

#[test]
fn without_a_path_an_old_file_is_kept() {
    let folder = folder();
    write(&folder, "a.csv", "old");
    let closed = WALLED.replace("walled", "closed");
    keyway(folder.path(), &format!("{closed} --curve a.csv")).expect_code(1);
    assert_eq!(read(&folder, "a.csv"), "old");
    keyway(folder.path(), &format!("{WALLED} --curve a.csv")).expect_code(0);
    assert_ne!(read(&folder, "a.csv"), "old");
}

#[test]
fn a_path_of_no_length() {
    let folder = folder();
    let line = WALLED.replace("5.5,0.5", "1.5,0.5");
    keyway(folder.path(), &format!("{line} --curve a.csv")).expect_code(0);
    let rows = rows(&read(&folder, "a.csv"));
    assert!(!rows.is_empty() && rows.iter().all(|row| row.at == [1.5, 0.5] && row.t_s == 0.0));
}
