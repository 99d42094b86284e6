//! Reading from bytes alone, as a page in a browser does: each kind against a known content, and
//! its error messages. The file names here exist nowhere.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use keyway::file_error::ReadError;
use keyway::files::{
    MAX_TOML_BYTES, ParameterLayers, StackBase, parameters_from_bytes, robot_from_bytes,
    stack_from_bytes,
};
use keyway::geometry::Pose;
use keyway::map::formats::{
    ImageKind, ImagePlacement, LoadedMap, MapFileError, MapFormat, MapReader, RosMap, TooManyCells,
    map_from_bytes, parse_scenarios, ros_map_image, scenarios_for_from_bytes, scenarios_from_bytes,
};
use keyway::map::{Cell, GridFrame, LayerConfig, OccupancyGrid, SearchMap};
use keyway::navigate::Stack;
use keyway::plan::{GlobalPlanner, Plan, Prepared};
use keyway::robot::Robot;
use keyway::search::{Query, Workspace};
use std::fmt::Display;
use std::io::ErrorKind;
use std::path::Path;

const OFFICE: &str = "maps/office.yaml";
const YAML: &str = "image: office.pgm\nresolution: 0.05\norigin: [1.5, -2, 0.25]\nnegate: 0\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\n";
/// The drawing that all images here show.
const DRAWN: [&str; 2] = ["#.?", "..#"];
const PGM: &[u8] = b"P5\n3 2\n255\n\x00\xfe\xcd\xfe\xfe\x00";
/// The same pixels as packed by another program, without compression.
const PNG: &[u8] =
    b"\x89PNG\r\n\x1a\n\x00\x00\x00\x0dIHDR\x00\x00\x00\x03\x00\x00\x00\x02\x08\x00\x00\x00\
      \x00\xb8\x1f9\xc6\x00\x00\x00\x13IDATx\x01\x01\x08\x00\xf7\xff\x00\x00\xfe\xcd\x00\xfe\xfe\
      \x00\x0e\xf3\x03\xc8d\x0b\xec\xf8\x00\x00\x00\x00IEND\xaeB`\x82";
const OCTILE: &str = "type octile\nheight 2\nwidth 3\nmap\n@.T\n.GS\n";
const SCENARIOS: &str = "version 1\n0\tcave.map\t3\t2\t1\t0\t0\t1\t2\n";

const ROBOT: &str = "cycle_s = 0.1\n[footprint]\nradius_m = 0.18\n[limits]\nv_min_mps = 0.0\n\
    v_max_mps = 0.5\nomega_max_radps = 1.5\nacceleration_mps2 = 0.5\ndeceleration_mps2 = 0.5\n\
    angular_acceleration_radps2 = 3.0\nangular_deceleration_radps2 = 3.0\n[[sensors]]\n\
    beams = 360\nfield_of_view_deg = 360.0\nrange_m = 3.5\n";

/// The files that the caller has in memory.
fn image(name: &Path) -> Result<Vec<u8>, ReadError> {
    match name.to_str() {
        Some("maps/office.pgm") => Ok(PGM.to_vec()),
        Some("maps/office.png") => Ok(PNG.to_vec()),
        Some("maps/cut.pgm") => Ok(PGM[..14].to_vec()),
        _ => Err(ReadError::System { path: name.to_owned(), reason: ErrorKind::NotFound.into() }),
    }
}

fn read(name: &str, content: impl AsRef<[u8]>) -> Result<LoadedMap, MapFileError> {
    map_from_bytes(Path::new(name), content.as_ref(), image, None)
}

fn text<T>(result: Result<T, impl Display>) -> String {
    result.map(drop).unwrap_err().to_string()
}

/// A drawn grid with another origin.
fn placed(rows: &[&str], resolution_m: f64, origin: Pose) -> OccupancyGrid {
    let drawn = OccupancyGrid::from_ascii(rows);
    let (width, height) = (drawn.frame().width().into(), drawn.frame().height().into());
    let frame = GridFrame::new(width, height, resolution_m, origin).unwrap();
    OccupancyGrid::from_fn(frame, |cell| drawn.state(cell).unwrap())
}

#[test]
fn ros_maps() {
    let expected = placed(&DRAWN, 0.05, Pose::new(1.5, -2.0, 0.25));
    for (yaml, image) in
        [(YAML.to_owned(), "maps/office.pgm"), (YAML.replace(".pgm", ".png"), "maps/office.png")]
    {
        let map = read(OFFICE, yaml).unwrap();
        assert_eq!((map.grid, map.format), (expected.clone(), MapFormat::Ros));
        assert_eq!(map.sources, [Path::new(OFFICE), Path::new(image)]);
        assert_eq!(map.warnings, []);
    }
    assert_eq!(ros_map_image(&expected, ImageKind::Pgm), PGM);
    let again = RosMap::for_grid(&expected, "office.pgm".to_owned()).to_yaml();
    assert_eq!(read(OFFICE, again).unwrap().grid, expected);
}

#[test]
fn errors_of_ros_maps() {
    let with = |from: &str, to: &str| text(read(OFFICE, YAML.replace(from, to)));
    assert_eq!(
        with("resolution: 0.05\n", ""),
        "maps/office.yaml: the field `resolution` is missing, expected a number of metres per cell \
         from 1e-6 to 1e6"
    );
    assert_eq!(
        with("office.pgm", "absent.pgm"),
        "cannot read maps/absent.pgm: there is no such file or folder"
    );
    assert_eq!(
        with("office.pgm", "cut.pgm"),
        "maps/cut.pgm: 3 x 2 pixels need at least 6 bytes after the header, got 3"
    );
    assert_eq!(
        text(read(OFFICE, b"image: \xff")),
        "maps/office.yaml: line 1 is not UTF-8 text (byte 8 of the line is 0xff); save the file as UTF-8"
    );
    assert_eq!(
        text(read("maps/office.txt", YAML)),
        "maps/office.txt: expected a file name that ends in .yaml, .yml, .map, .pgm or .png"
    );
}

#[test]
fn images_and_movingai_maps() {
    let placement = ImagePlacement { resolution_m: 0.25, origin: Pose::new(3.0, 4.0, 0.0) };
    let drawn = |rows| placed(rows, placement.resolution_m, placement.origin);
    for (name, content, grid, format) in [
        ("a.pgm", PGM, drawn(&DRAWN), MapFormat::Pgm),
        ("a.png", PNG, drawn(&DRAWN), MapFormat::Png),
        ("a.map", OCTILE.as_bytes(), drawn(&["#.#", "..."]), MapFormat::MovingAi),
    ] {
        let map = map_from_bytes(Path::new(name), content, image, Some(placement)).unwrap();
        assert_eq!((map.grid, map.format), (grid, format), "{name}");
    }
    let error = text(read("a.png", b"RIFF"));
    let start = "a.png: the file starts with \"RIFF\", expected a PGM, PPM, PBM";
    assert!(error.starts_with(start), "{error}");
    assert_eq!(
        text(read("a.map", OCTILE.replace("@.T", "@."))),
        "a.map: line 5: the row has 2 characters, expected 3 as the header says"
    );
}

#[test]
fn scenarios() {
    let name = Path::new("cave.map.scen");
    let found = scenarios_from_bytes(name, SCENARIOS.as_bytes()).unwrap();
    assert_eq!(found, parse_scenarios(SCENARIOS.as_bytes()).unwrap());
    let [one] = &found[..] else { panic!("{found:?}") };
    assert_eq!((one.start, one.goal), (Cell::new(1, 1), Cell::new(0, 0)));
    assert_eq!((one.line, one.optimal_length), (2, 2.0));

    let map = read("cave.map", OCTILE).unwrap().grid;
    let of_map =
        |grid: &OccupancyGrid| scenarios_for_from_bytes(name, SCENARIOS.as_bytes(), grid.frame());
    assert_eq!(of_map(&map).unwrap(), found);
    assert_eq!(
        text(of_map(&OccupancyGrid::from_ascii(&["."]))),
        "cave.map.scen: line 2: the scenario is for a map of 3 x 2 cells, this map has 1 x 1"
    );
    assert_eq!(
        text(scenarios_from_bytes(name, b"version 2\n")),
        "cave.map.scen: line 1: the version is \"2\", expected 1"
    );
}

#[test]
fn robots() {
    let name = Path::new("mine.toml");
    assert_eq!(robot_from_bytes(name, ROBOT.as_bytes()).unwrap(), Robot::small());
    let with = |from, to| text(robot_from_bytes(name, ROBOT.replace(from, to).as_bytes()));
    assert_eq!(
        with("cycle_s = 0.1", "cycle_s = \"fast\""),
        "mine.toml: line 1, column 11: `cycle_s`: invalid type: string \"fast\", expected a number"
    );
    assert_eq!(
        with("cycle_s = 0.1", "cycle_s = -0.1"),
        "mine.toml: cycle_s must be a time from 0.001 to 10 s, got -0.1"
    );
}

#[test]
fn stacks() {
    let (name, robot) = (Path::new("mine.toml"), Robot::small());
    let stack = Stack::keyway(&robot);
    let toml = toml::to_string(&stack).unwrap();
    assert_eq!(stack_from_bytes(name, toml.as_bytes(), &robot).unwrap(), stack);
    let unnamed = toml.replacen("name = \"jps\"", "name = \"jsp\"", 1);
    let line = 1 + unnamed.lines().position(|line| line == "name = \"jsp\"").unwrap();
    let error = text(stack_from_bytes(name, unnamed.as_bytes(), &robot));
    let start = format!("mine.toml: line {line}, column 8: `planner.name`: unknown value `jsp`, ");
    assert!(error.starts_with(&start) && error.ends_with("; did you mean `jps`?"), "{error}");
}

#[test]
fn parameters() {
    let name = Path::new("mine.toml");
    let content = b"map.clearance_m = 0.5\nplanner.name = \"astar\"\n";
    let file = parameters_from_bytes(name, content).unwrap();
    assert_eq!(file.name, "mine.toml");
    let layers = ParameterLayers { file: Some(file), ..ParameterLayers::default() };
    let robot = Robot::small();
    let stack = Stack::keyway(&robot);
    let changed = layers.over(StackBase::for_robot(&stack, &robot), &[]).unwrap();
    assert_eq!((changed.map.clearance_m, changed.planner.name()), (0.5, "astar"));
    assert_eq!(
        text(parameters_from_bytes(name, b"map.clearance_m = \n")),
        "mine.toml: line 1, column 19: string values must be quoted, expected literal string"
    );
}

#[test]
fn prepared_maps() {
    let grid = OccupancyGrid::from_ascii(&["......", ".####.", "......"]);
    let map = SearchMap::new(&grid, LayerConfig::default()).unwrap();
    let bytes = Prepared::build(&map).unwrap().to_bytes();
    assert_eq!(&bytes[..16], b"KeywayPM\x01\x00\x00\x00\x00\x00\x00\x00");
    let prepared = Prepared::from_bytes(&bytes, &map).unwrap();
    let (mut workspace, mut plan) = (Workspace::default(), Plan::default());
    let query = Query::new(Cell::new(0, 0), Cell::new(5, 2));
    prepared.plan_into(&map, &query, &mut workspace, None, &mut plan).unwrap();
    assert_eq!((plan.cost.cells(), plan.cells.len()), (7.0, 8));

    assert_eq!(
        text(Prepared::from_bytes(PGM, &map)),
        "this is not a prepared map, expected a file that `keyway prepare` has written"
    );
    let (found, expected) = (bytes.len() - 1, bytes.len());
    assert_eq!(
        text(Prepared::from_bytes(&bytes[..found], &map)),
        format!("the prepared map has {found} bytes, expected {expected}; prepare the map again")
    );
    let other = SearchMap::new(&OccupancyGrid::from_ascii(&["..."]), LayerConfig::default());
    assert_eq!(
        text(Prepared::from_bytes(&bytes, &other.unwrap())),
        "the preparation was made for another map, clearance or treatment of unknown cells; \
         prepare this map with these settings"
    );
}

/// The size limits of files, which their readers apply, too.
#[test]
fn limits() {
    let (name, robot) = (Path::new("big.toml"), Robot::small());
    let mut content = b" ".repeat(MAX_TOML_BYTES as usize + 1);
    let expected = "cannot read big.toml: it is larger than the limit of 16 MiB";
    assert_eq!(text(robot_from_bytes(name, &content)), expected);
    assert_eq!(text(stack_from_bytes(name, &content, &robot)), expected);
    assert_eq!(text(parameters_from_bytes(name, &content)), expected);
    content.pop();
    assert!(parameters_from_bytes(name, &content).is_ok());

    let mut yaml = YAML.to_owned();
    yaml.push_str(&"#".repeat((1 << 20) - yaml.len()));
    assert!(read(OFFICE, &yaml).is_ok());
    yaml.push('#');
    assert_eq!(
        text(read(OFFICE, &yaml)),
        "cannot read maps/office.yaml: it is larger than the limit of 1 MiB"
    );

    let reader = MapReader { max_cells: 5, ..MapReader::default() };
    for (name, content, blamed) in [
        (OFFICE, YAML.as_bytes(), "maps/office.pgm"),
        ("a.png", PNG, "a.png"),
        ("a.map", OCTILE.as_bytes(), "a.map"),
    ] {
        let error = reader.from_bytes(Path::new(name), content, image).unwrap_err();
        assert_eq!(error.too_many_cells().map(TooManyCells::needed), Some(6));
        let expected = "a map of 3 x 2 cells is larger than the limit of 5 cells; if this size is \
                        intended, raise the limit";
        assert_eq!(error.to_string(), format!("{blamed}: {expected}"));
    }
}
