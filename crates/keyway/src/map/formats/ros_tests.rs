use super::*;
use proptest::prelude::*;

const DEPOT: &str = "image: depot.pgm\nmode: trinary\nresolution: 0.05\n\
    origin: [1.5, -2, 0.25]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

fn parse(text: &str) -> Result<RosMap, RosMapError> {
    RosMap::parse(text.as_bytes())
}

/// [`DEPOT`] with one line replaced.
fn with(field: &str, line: &str) -> Result<RosMap, RosMapError> {
    let lines = DEPOT.lines().map(|old| if old.starts_with(field) { line } else { old });
    parse(&lines.collect::<Vec<_>>().join("\n"))
}

fn depot() -> RosMap {
    RosMap {
        image: "depot.pgm".to_owned(),
        placement: ImagePlacement { resolution_m: 0.05, origin: Pose::new(1.5, -2.0, 0.25) },
        rule: CellRule::IMAGE,
        assumed: Vec::new(),
    }
}

#[test]
fn as_published() {
    assert_eq!(parse(DEPOT), Ok(depot()));
    assert_eq!(with("mode", "# -3.071 3.583"), Ok(depot()));
    assert_eq!(with("mode", "cell: {size: [1, 2], ? x : !thing y}"), Ok(depot()));
    assert_eq!(parse(&format!("---\n{}", DEPOT.replace('\n', "\r\n"))), Ok(depot()));
    assert_eq!(parse(&format!("\u{feff}{DEPOT}")), Ok(depot()));
    assert_eq!(with("origin", "origin:\n  - 1.5\n  - -2.0\n  - 2.5e-1"), Ok(depot()));
}

#[test]
fn modes_and_negation() {
    for (text, mode) in [("Raw", MapMode::Raw), ("scale", MapMode::Scale)] {
        assert_eq!(with("mode", &format!("mode: {text}")).unwrap().rule.mode, mode);
    }
    for (text, negate) in [("1", true), ("true", true), ("False", false), ("no", false)] {
        assert_eq!(with("negate", &format!("negate: {text}")).unwrap().rule.negate, negate);
    }
    assert_eq!(with("image", "image: 7").unwrap().image, "7");
    let swapped = with("free", "free_thresh: 0.9").unwrap();
    assert_eq!((swapped.rule.free_thresh, swapped.rule.occupied_thresh), (0.9, 0.65));
}

#[test]
fn a_tab_is_blamed_on_its_own_line() {
    for (field, tab, line) in [
        ("image", "\timage: depot.pgm", 1),
        ("mode", "\tmode: trinary", 2),
        ("resolution", "  \tresolution: 0.05", 3),
        ("origin", "origin:\n\t- 1.5\n\t- -2\n\t- 0.25", 5),
        ("free", "\tfree_thresh: 0.196", 7),
    ] {
        let text = with(field, tab).unwrap_err().to_string();
        let expected = format!("line {line}, column 1: the line begins with a tab, expected");
        assert!(text.starts_with(&expected), "{text}");
    }
    let between = DEPOT.replace(": ", ":\t");
    assert_eq!(parse(&between), Ok(depot()), "a tab may stand before a value");
}

#[test]
fn missing_fields_are_named() {
    for field in ["image", "resolution", "origin"] {
        for line in ["", &format!("{field}:")] {
            let error = with(field, line).unwrap_err();
            assert!(matches!(error, RosMapError::Missing { .. }), "{field}: {error}");
            let text = format!("the field `{field}` is missing, expected ");
            assert!(error.to_string().starts_with(&text), "{error}");
        }
    }
    assert!(matches!(parse(""), Err(RosMapError::Missing { field: "image", .. })));
    assert!(matches!(parse("a: b"), Err(RosMapError::Missing { field: "image", .. })));
}

#[test]
fn missing_fields_of_the_rule_have_their_usual_values() {
    for field in [NEGATE_FIELD, OCCUPIED_FIELD, FREE_FIELD] {
        for line in ["", &format!("{field}:")] {
            assert_eq!(with(field, line), Ok(RosMap { assumed: vec![field], ..depot() }));
        }
    }
    let bare = parse("image: depot.pgm\nresolution: 0.05\norigin: [1.5, -2, 0.25]\n");
    let assumed = vec![NEGATE_FIELD, OCCUPIED_FIELD, FREE_FIELD];
    assert_eq!(bare, Ok(RosMap { assumed, ..depot() }));
    // They convert raw values to states, too.
    let raw = parse("image: a.pgm\nmode: raw\nnegate: 0\nresolution: 1\norigin: [0, 0, 0]\n");
    assert_eq!(raw.unwrap().assumed, [OCCUPIED_FIELD, FREE_FIELD]);
}

#[test]
fn a_colon_without_a_space_is_named() {
    for (field, line, number, column) in [
        ("image", "image:depot.pgm", 1, 7),
        ("mode", "mode:trinary", 2, 6),
        ("resolution", "resolution:0.05", 3, 12),
        ("origin", "origin:[1.5, -2, 0.25]", 4, 8),
        ("negate", "negate:0", 5, 8),
        ("occupied_thresh", "occupied_thresh:0.65", 6, 17),
        ("free_thresh", "free_thresh:0.196", 7, 13),
    ] {
        let expected = format!(
            "line {number}, column {column}: YAML needs a space after the colon, such as `{field}: ...`"
        );
        assert_eq!(with(field, line).unwrap_err().to_string(), expected);
    }
    let text = parse(&DEPOT.replace(": ", ":")).unwrap_err().to_string();
    assert!(text.starts_with("line 1, column 7: YAML needs a space"), "{text}");
    // A valid file may contain it in a value.
    assert_eq!(with("image", "image: a:b.pgm").unwrap().image, "a:b.pgm");
}

#[test]
fn unusable_fields_are_named_with_line_and_expectation() {
    let cases = [
        ("image", "\"\"", 1, "a file"),
        ("mode", "binary", 2, "trinary, scale or raw"),
        ("resolution", "0", 3, "a number of metres per cell"),
        ("resolution", "-0.05", 3, "a number of metres per cell"),
        ("resolution", ".nan", 3, "a number of metres per cell"),
        ("resolution", "NaN", 3, "a number of metres per cell"),
        ("resolution", "1e999", 3, "a number of metres per cell"),
        ("resolution", "5 cm", 3, "a number of metres per cell"),
        ("resolution", "1e7", 3, "a number of metres per cell from 1e-6 to 1e6"),
        ("resolution", "1e-300", 3, "a number of metres per cell from 1e-6 to 1e6"),
        ("origin", "[1e300, 0, 0]", 4, "up to 1e9"),
        ("origin", "[1, 2]", 4, "three numbers [x, y, yaw]"),
        ("origin", "[1, 2, 3, 4]", 4, "three numbers [x, y, yaw]"),
        ("origin", "[1, 2, .inf]", 4, "three numbers [x, y, yaw]"),
        ("negate", "2", 5, "0, 1, true or false"),
        ("occupied_thresh", "nan", 6, "an occupancy from 0 to 1"),
        ("free_thresh", "-0.1", 7, "an occupancy from 0 to 1"),
    ];
    for (name, value, at, text) in cases {
        let error = with(name, &format!("{name}: {value}")).unwrap_err();
        let RosMapError::Field { line, field, expected, .. } = &error else {
            panic!("{name}: {error}")
        };
        assert_eq!((*line, *field), (at, name), "{error}");
        assert!(expected.contains(text) || name == "image", "{error}");
        assert!(error.to_string().starts_with(&format!("line {at}: `{name}` is ")), "{error}");
    }
    let error = with("origin", "origin: [1, b, .inf]").unwrap_err();
    assert_eq!(
        error.to_string(),
        "line 4: `origin` is [1, b, .inf], expected three numbers [x, y, yaw] in metres and \
         radians, up to 1e9"
    );
}

#[test]
fn what_is_not_such_a_mapping() {
    let duplicate = format!("{DEPOT}mode: raw\n");
    let cases = [
        ("- a\n- b\n", 1),
        ("[", 1),
        ("image: a\n---\nimage: b\n", 3),
        ("x\n", 1),
        (&duplicate, 8),
    ];
    for (text, at) in cases {
        let error = parse(text).unwrap_err();
        let RosMapError::Syntax { line, reason, .. } = &error else { panic!("{error}") };
        assert!(*line == at && !reason.is_empty(), "{text}: {error}");
        assert_eq!(error.to_string().matches("column").count(), 1, "{error}");
    }
    for (field, value, at) in [("origin", "3", 4), ("image", "[a, b]", 1), ("negate", "{a: b}", 5)]
    {
        let error = with(field, &format!("{field}: {value}")).unwrap_err();
        let text = error.to_string();
        assert!(text.starts_with(&format!("line {at}: `{field}` is {value}, expected ")), "{text}");
    }
    let error = RosMap::parse(b"image: a\nmode: \xff\n").unwrap_err();
    assert!(matches!(error, RosMapError::Text(_)));
    assert!(error.to_string().starts_with("line 2"), "{error}");
}

#[test]
fn names_that_need_quotes() {
    assert_eq!(quoted("maps/a-b_1.pgm"), "maps/a-b_1.pgm");
    assert_eq!(quoted("a b: \"c\"\n.pgm"), "\"a b: \\\"c\\\"\\u000a.pgm\"");
}

proptest! {
    #[test]
    fn written_is_read_back(image in "\\PC{1,20}|[a-z\n\t\"\\\\:#' ]{1,9}", x in -1e9..1e9f64, y in -1e3..1e3f64,
                            yaw in -3.1..3.1f64, resolution_m in 1e-6..1e6f64, negate: bool,
                            thresholds in (0.0..=1.0, 0.0..=1.0), mode in 0..3usize) {
        let (occupied_thresh, free_thresh) = thresholds;
        let mode = [MapMode::Trinary, MapMode::Scale, MapMode::Raw][mode];
        let map = RosMap {
            image,
            placement: ImagePlacement { resolution_m, origin: Pose::new(x, y, yaw) },
            rule: CellRule { mode, negate, occupied_thresh, free_thresh },
            assumed: Vec::new(),
        };
        prop_assert_eq!(parse(&map.to_yaml()), Ok(map.clone()), "{}", map.to_yaml());
    }

    #[test]
    fn nothing_panics(bytes: Vec<u8>, at in 0..DEPOT.len(), text in "\\PC{0,4}|[\\[\\]{}:&*!|>\n -]{0,6}") {
        let _ = RosMap::parse(&bytes);
        let mutated = format!("{}{text}{}", &DEPOT[..at], &DEPOT[at..]);
        let _ = parse(&mutated);
        let _ = parse(&DEPOT[..at]);
    }
}
