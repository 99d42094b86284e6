//! Every reader reports file errors in plain words: no names of Rust types, no advice for
//! developers, at most one line. Valid files are damaged at many places and in many ways.
#![allow(clippy::unwrap_used)]

use keyway::files::from_toml;
use keyway::map::formats::{
    CellRule, ImageKind, ImagePlacement, RosMap, grid_from_image, image_from_grid,
    movingai_map_from_grid, parse_movingai_map, parse_scenarios, text_from_bytes,
};
use keyway::map::{LayerConfig, OccupancyGrid, SearchMap};
use keyway::plan::Prepared;
use keyway::robot::Robot;
use keyway_sim::scene_files::SceneFile;
use std::collections::BTreeSet;
use std::fmt::Display;

/// Words that only programmers understand, or advice that a message must not give.
const FORBIDDEN: [&str; 38] = [
    "i128",
    "u128",
    "u8",
    "u16",
    "u32",
    "u64",
    "usize",
    "i8",
    "i16",
    "i32",
    "i64",
    "isize",
    "f32",
    "f64",
    "::",
    "Some(",
    "Ok(",
    "Err(",
    "Error",
    "Options",
    "Policy",
    "from_str",
    "budget",
    "Budget",
    "breach",
    "recursi",
    "weak",
    "struct",
    "enum",
    "variant",
    "tuple",
    "digit found",
    "os error",
    "serde",
    "deserializ",
    "unwrap",
    "ChunkType",
    "sequence",
];

/// Texts that are inserted into valid files.
const INSERTED: [&[u8]; 34] = [
    b"\n",
    b" ",
    b"\t",
    b"\0",
    b"\xff",
    b"\xc3\xa9",
    b"#",
    b"---\n",
    b"...\n",
    b"-",
    b"- a\n",
    b"[",
    b"]",
    b"[[",
    b"{",
    b"}",
    b"\"",
    b"'",
    b"'''",
    b":",
    b": ",
    b"=",
    b"= =",
    b",",
    b"&a ",
    b"*a ",
    b"<<: *a\n",
    b"!!int ",
    b"!x ",
    b"? ",
    b"nan",
    b"-1",
    b"1e999",
    b"99999999999999999999",
];

type Reader = fn(&[u8]) -> Option<String>;

fn text<T, E: Display>(read: Result<T, E>) -> Option<String> {
    read.err().map(|error| error.to_string())
}

fn image(bytes: &[u8]) -> Option<String> {
    text(grid_from_image(bytes, &CellRule::IMAGE, ImagePlacement::default()))
}

fn grid() -> OccupancyGrid {
    OccupancyGrid::from_ascii(&["....", ".##.", ".?#.", "...."])
}

fn search_map() -> SearchMap {
    SearchMap::new(&grid(), LayerConfig::default()).unwrap()
}

fn toml_of<E: Display, T>(bytes: &[u8], read: impl Fn(&str) -> Result<T, E>) -> Option<String> {
    match text_from_bytes(bytes) {
        Ok(toml) => text(read(toml)),
        Err(error) => Some(error.to_string()),
    }
}

/// A valid file of each kind, with its reader.
fn readers() -> Vec<(&'static str, Vec<u8>, Reader)> {
    let yaml = "image: depot.pgm\nmode: trinary\nresolution: 0.05\norigin: [1.5, -2, 0.25]\n\
        negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    let scene = "version = 1\nmap = \"a.yaml\"\nrobot = \"small\"\nstart = [1, 2, 90]\n\
        goal = [3.5, 4]\n[[unknown]]\nposition = [0.5, 0.5]\nradius_m = 0.15\n\
        [[moving]]\nradius_m = 0.3\nspline = [[0, 1, 2], [1, 2, 2.5]]\nduration_s = 1.5\n\
        [[moving]]\nradius_m = 0.3\n[moving.random_walk]\nposition = [1, 1]\narea = [[0, 0], [4, 3]]\n\
        speed_mps = [0.2, 0.8]\nleg_s = [1, 5]\nseed = 7\n";
    let scenarios = "version 1\n0\tmaps/a.map\t49\t50\t1\t11\t2\t49\t3.41421\n";
    let prepared = Prepared::build(&search_map()).unwrap().to_bytes();
    vec![
        ("ROS map", yaml.into(), |bytes| text(RosMap::parse(bytes))),
        ("plain PGM", b"P2\n# depot\n3 2\n255\n0 254 205\n0 0 255\n".to_vec(), image),
        ("PGM", image_from_grid(&grid(), ImageKind::Pgm), image),
        ("PNG", image_from_grid(&grid(), ImageKind::Png), image),
        ("MovingAI map", movingai_map_from_grid(&grid()).into_bytes(), |bytes| {
            text(parse_movingai_map(bytes, ImagePlacement::default()))
        }),
        ("scenarios", scenarios.into(), |bytes| text(parse_scenarios(bytes))),
        ("scene", scene.into(), |bytes| toml_of(bytes, SceneFile::from_toml)),
        ("robot", toml::to_string(&Robot::small()).unwrap().into(), |bytes| {
            toml_of(bytes, from_toml::<Robot>)
        }),
        (
            "parameters",
            b"[map]\nunknown = \"free\"\n[planner]\nname = 'astar'\n".to_vec(),
            |bytes| toml_of(bytes, from_toml::<toml::Table>),
        ),
        ("prepared map", prepared, |bytes| text(Prepared::from_bytes(bytes, &search_map()))),
    ]
}

/// Files that are truncated, or have a byte replaced, removed, or text inserted: at every
/// position, or at some of many.
fn damaged(sound: &[u8]) -> impl Iterator<Item = Vec<u8>> + '_ {
    let step = sound.len().div_ceil(400);
    (0..=sound.len()).step_by(step).flat_map(move |at| {
        let (before, after) = sound.split_at(at);
        let rest = after.get(1..).unwrap_or_default();
        let inserted = INSERTED.iter().map(move |text| [before, text, after].concat());
        let replaced = INSERTED.iter().map(move |text| [before, text, rest].concat());
        let cut = [before.to_vec(), [before, rest].concat()];
        inserted.chain(replaced).chain(cut)
    })
}

#[track_caller]
fn check(reader: &str, message: &str) {
    let found: Vec<&&str> = FORBIDDEN.iter().filter(|word| message.contains(**word)).collect();
    assert!(found.is_empty(), "{reader}: {found:?} in: {message}");
    // A value in Rust's debug format: `Name { ...`.
    let mut words = message.split(" { ").map(|part| part.rsplit(' ').next().unwrap_or_default());
    let is_name = |word: &str| word.starts_with(|first: char| first.is_ascii_uppercase());
    assert!(!words.any(is_name) || !message.contains(" { "), "{reader}: {message}");
    assert!(!message.is_empty() && !message.contains('\n'), "{reader}: {message:?}");
    assert!(message.len() < 800, "{reader}: {message}");
}

#[test]
fn no_reader_speaks_of_its_program() {
    for (reader, sound, read) in readers() {
        assert_eq!(read(&sound), None, "{reader}");
        let messages: BTreeSet<String> = damaged(&sound).filter_map(|bytes| read(&bytes)).collect();
        assert!(messages.len() > 3, "{reader}: {messages:?}");
        for message in &messages {
            check(reader, message);
        }
    }
}

/// Attacks on a parser.
#[test]
fn large_and_deep_files() {
    let long_list = format!("image: [{}\n", "a,".repeat(300_000));
    let nested = format!("image: {}\n", "[".repeat(5000));
    let laughs: String = (1..12).fold("a0: &a0 [x]\n".to_owned(), |text, i| {
        let of = format!("*a{},", i - 1).repeat(10);
        text + &format!("a{i}: &a{i} [{of}]\n")
    });
    for yaml in [long_list, nested, laughs, "a: &a [*a]\n".to_owned(), "a: *b\n".to_owned()] {
        if let Err(error) = RosMap::parse(yaml.as_bytes()) {
            check("ROS map", &error.to_string());
        }
    }
    for toml in [
        format!("a = {}", "[".repeat(5000)),
        format!("{}a = 1", "a.".repeat(5000)),
        format!("version = {}", "9".repeat(5000)),
        format!("{} = 1", "a".repeat(100_000)),
        format!("version = 1\nmap = \"{}\"\nstart = 1", "\\n".repeat(100_000)),
    ] {
        if let Err(error) = SceneFile::from_toml(&toml) {
            check("scene", &error.to_string());
        }
        if let Err(error) = from_toml::<Robot>(&toml) {
            check("robot", &error.to_string());
        }
    }
}

/// Messages with line, field, given value and expected value.
#[test]
fn messages_that_help() {
    let of = |wanted: &str, old: &str, new: &str| {
        let (_, sound, read) = readers().into_iter().find(|(name, ..)| *name == wanted).unwrap();
        let sound = String::from_utf8(sound).unwrap();
        assert!(sound.contains(old), "{old}");
        read(sound.replacen(old, new, 1).as_bytes()).unwrap()
    };
    for (reader, old, new, message) in [
        (
            "ROS map",
            "0.05",
            "1e9",
            "line 3: `resolution` is 1e9, expected a number of metres per cell from 1e-6 to 1e6",
        ),
        (
            "ROS map",
            "mode: trinary\n",
            "mode: trinary\nmode: raw\n",
            "line 3, column 1: a field is given twice, expected each field once",
        ),
        (
            "ROS map",
            "image",
            "---\nimage: a\n---\nimage",
            "line 4, column 1: a second document begins here, expected one; remove the line `---` and \
             everything that does not belong to the map",
        ),
        (
            "ROS map",
            "[1.5, -2, 0.25]",
            "&a [*a]",
            "line 4, column 13: an alias (`*name`) cannot be resolved; write the value in its place",
        ),
        (
            "ROS map",
            "negate: 0",
            "negate",
            "line 5, column 1: expected lines of the form `field: value`, such as `resolution: 0.05`",
        ),
        (
            "scene",
            "version = 1",
            "version = -1",
            "`version` is -1; this program reads scenes of version 1 and 2",
        ),
        (
            "scene",
            "[3.5, 4]",
            "[3.5]",
            "line 5, column 8: `goal`: expected [x, y] or [x, y, yaw_deg], got 1 numbers",
        ),
        (
            "scene",
            "\"a.yaml\"",
            "7",
            "line 2, column 7: `map`: invalid type: integer `7`, expected a string",
        ),
        (
            "robot",
            "beams = 360",
            "beams = -1",
            "line 17, column 9: `sensors[0].beams`: invalid value: integer `-1`, expected a whole number from \
             0 to 4294967295",
        ),
        (
            "robot",
            "cycle_s = 0.1",
            "cycle_s = [1]",
            "line 1, column 11: `cycle_s`: invalid type: array, expected a number",
        ),
    ] {
        assert_eq!(of(reader, old, new), message);
    }
}
