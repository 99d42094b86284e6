//! Tests of `keyway map`.

use crate::support::{expect_members, folder, keyway, read, write};
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

/// The image is named neither by the command line nor by the YAML file that is replaced.
#[test]
fn a_conversion_replaces_no_image_of_somebody_else() {
    let folder = folder();
    write(&folder, "precious.pgm", "mine");
    let line = "map convert walled.map precious.yaml";
    let refused = keyway(folder.path(), line).expect_code(2);
    assert!(
        refused
            .err
            .contains("precious.pgm exists and would be replaced by the image of precious.yaml"),
        "{}",
        refused.err
    );
    assert_eq!(read(&folder, "precious.pgm"), "mine");
    assert!(!folder.path().join("precious.yaml").exists());
    // The same beside a map with another image.
    let yaml = read(&folder, "small_house.yaml");
    write(&folder, "precious.yaml", &yaml);
    keyway(folder.path(), line).expect_code(2);
    assert_eq!(
        (read(&folder, "precious.pgm"), read(&folder, "precious.yaml")),
        ("mine".into(), yaml)
    );
}

#[test]
fn a_conversion_may_be_repeated() {
    let folder = folder();
    keyway(folder.path(), "map convert walled.map a.yaml").expect_code(0);
    keyway(folder.path(), "map convert closed.map a.yaml").expect_code(0);
    let info = |name: &str| {
        let line = format!("map info {name} --format json");
        keyway(folder.path(), &line).expect_code(0).json()["digest"].clone()
    };
    assert_eq!(info("a.yaml"), info("closed.map"));
    // Killed between writing the YAML file and renaming its image.
    std::fs::remove_file(folder.path().join("a.pgm")).unwrap();
    write(&folder, ".a.pgm.keyway-0.tmp", "P5 1 1");
    keyway(folder.path(), "map convert walled.map a.yaml").expect_code(0);
    assert_eq!(info("a.yaml"), info("walled.map"));
    assert!(!folder.path().join(".a.pgm.keyway-0.tmp").exists());
}

#[test]
fn what_a_format_does_not_keep_is_said() {
    let folder = folder();
    let house = "map convert small_house.yaml house";
    let map = keyway(folder.path(), &format!("{house}.map --format json")).expect_code(0);
    let lost = json!({
        "resolution_m": 0.05, "origin": [-12.5, -12.5, 0.0], "unknown_cells": 183_537, "value_cells": 0
    });
    assert_eq!(map.json()["lost"], lost);
    let said: Vec<&str> = map.err.lines().collect();
    assert_eq!(
        said,
        [
            "warning: house.map: the resolution of 0.05 m is not kept; read the file with --resolution 0.05",
            "warning: house.map: the origin (-12.5, -12.5) m, 0 deg is not kept; read the file with \
             --origin -12.5,-12.5,0",
            "warning: house.map: 183537 unknown cells became occupied",
        ]
    );
    let image = keyway(folder.path(), &format!("{house}.png --format json")).expect_code(0);
    assert_eq!(image.json()["lost"]["unknown_cells"], 0);
    assert_eq!(image.err.lines().count(), 2, "{}", image.err);
    let ros = keyway(folder.path(), &format!("{house}.yaml --format json")).expect_code(0);
    let none = json!({"resolution_m": null, "origin": null, "unknown_cells": 0, "value_cells": 0});
    assert_eq!((ros.json()["lost"].clone(), ros.err.as_str()), (none, ""));
}

#[test]
fn likely_mistakes_are_said() {
    let folder = folder();
    let info = |line: &str| keyway(folder.path(), &format!("map info {line}")).expect_code(0).err;
    assert_eq!(info("small_house.yaml"), "");
    assert!(
        info("small_house.png").starts_with("warning: small_house.png: an image does not contain")
    );
    assert_eq!(info("small_house.png --resolution 0.05"), "");
    let yaml = read(&folder, "small_house.yaml");
    write(&folder, "a.yaml", &yaml.replace("occupied_thresh: 0.65", "occupied_thresh: 0.1"));
    let warning = "warning: a.yaml: `free_thresh` (0.196) is above `occupied_thresh` (0.1)";
    assert!(info("a.yaml").starts_with(warning));
    // The warnings are also printed beside a JSON answer.
    let line = "plan small_house.png --cells --start 86,193 --goal 87,193 --format json";
    let plan = keyway(folder.path(), line).expect_code(0);
    assert!(plan.err.starts_with("warning: ") && plan.json().is_object());
}

/// Two pixels, black and white, as other programs write them.
#[test]
fn images_that_map_savers_do_not_write() {
    let folder = folder();
    let mut bmp =
        b"BM\x3e\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\x02\0\0\0\x01\0\0\0\x01\0\x18\0".to_vec();
    bmp.extend([0; 24]);
    bmp.extend([0, 0, 0, 255, 255, 255, 0, 0]);
    for (name, content) in
        [("m.bmp", &bmp[..]), ("m.ppm", b"P6 2 1 255\n\0\0\0\xff\xff\xff"), ("m.pbm", b"P1 2 1 10")]
    {
        std::fs::write(folder.path().join(name), content).unwrap();
        let yaml = format!("image: {name}\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\n");
        write(&folder, "m.yaml", &(yaml + "occupied_thresh: 0.65\nfree_thresh: 0.196\n"));
        let info = keyway(folder.path(), "map info m.yaml --format json").expect_code(0);
        assert_eq!(info.json()["cells"], json!({"free": 1, "occupied": 1, "unknown": 0}), "{name}");
        assert_eq!(info.err, "");
    }
}
