//! `keyway map`.

use crate::support::{expect_members, folder, keyway, read};
use serde_json::{Value, json};

#[test]
fn info_of_the_bundled_map() {
    let folder = folder();
    let info =
        keyway(folder.path(), "map info small_house.yaml --format json").expect_code(0).json();
    expect_members(
        &info,
        &[
            ("schema", |v| v == "keyway.map/1"),
            ("map", |v| v == "small_house.yaml"),
            ("format", |v| v == "ros"),
            ("digest", Value::is_string),
            ("width_cells", |v| v == 500),
            ("height_cells", |v| v == 500),
            ("resolution_m", |v| v == 0.05),
            ("origin", |v| *v == json!([-12.5, -12.5, 0.0])),
            ("cells", |v| *v == json!({"free": 63021, "occupied": 3442, "unknown": 183_537})),
            ("known_cells", |v| *v == json!([[63, 135], [439, 360]])),
            ("has_values", |v| v == false),
            ("files", |v| *v == json!([])),
        ],
    );
    let image = "map info small_house.png --resolution 0.05 --origin -12.5,-12.5 --format json";
    let image = keyway(folder.path(), image).expect_code(0).json();
    assert_eq!(image["digest"], info["digest"], "the same map without its YAML file");
    let table = keyway(folder.path(), "map info small_house.yaml").expect_code(0).out;
    assert!(table.contains("500 x 500 cells, 25.00 x 25.00 m"), "{table}");
}

#[test]
fn known_cells_by_hand() {
    let info = keyway(folder().path(), "map info closed.map --format json").expect_code(0).json();
    assert_eq!(info["known_cells"], json!([[0, 0], [6, 4]]));
    assert_eq!(info["cells"], json!({"free": 30, "occupied": 5, "unknown": 0}));
}

#[test]
fn conversion_and_back() {
    let folder = folder();
    let placed =
        "map convert rooms.map house.yaml --resolution 0.5 --origin -2,-3,90 --format json";
    let house = keyway(folder.path(), placed).expect_code(0).json();
    assert_eq!((&house["map"], &house["resolution_m"]), (&json!("house.yaml"), &json!(0.5)));
    assert_eq!(house["origin"][2], std::f64::consts::FRAC_PI_2);
    keyway(folder.path(), "map convert house.yaml back.map").expect_code(0);
    let tiles = |name: &str| read(&folder, name).replace('T', "@");
    assert_eq!(tiles("back.map"), tiles("rooms.map"));
    let strange = keyway(folder.path(), "map convert rooms.map house.txt").expect_code(2);
    assert!(strange.err.contains("house.txt") && !folder.path().join("house.txt").exists());
}

#[test]
fn no_output_replaces_what_is_read() {
    let folder = folder();
    let image = || std::fs::read(folder.path().join("small_house.png")).unwrap();
    let before = image();
    let commands = [
        "map convert small_house.yaml small_house.png",
        "map convert small_house.png small_house.png",
        "plan small_house.yaml --start -8.175,-2.825 --goal 8.725,0.875 --picture small_house.png",
    ];
    for command in commands {
        let refused = keyway(folder.path(), command).expect_code(2);
        assert!(refused.err.contains("small_house.png"), "{}", refused.err);
        assert_eq!(image(), before, "{command}");
    }
}
