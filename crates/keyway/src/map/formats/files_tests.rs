use super::super::{
    CellRule, ImageError, MAX_MAP_BYTES, MapWarning, MovingAiError, RosMapError, ScenarioError,
    digest, grid_from_image, map_from_bytes,
};
use super::*;
use crate::file_error::ReadError;
use crate::file_system::test_folder::TestFolder;
use crate::geometry::Pose;
use crate::map::{Cell, CellState, FrameError, OccupancyThresholds};
use proptest::prelude::*;
use proptest::sample::Index;
use std::fs;

const YAML: &str = "image: m.pgm\nresolution: 0.5\norigin: [1, 2, 0]\nnegate: 0\n\
    occupied_thresh: 0.65\nfree_thresh: 0.196\n";
const PGM: &[u8] = b"P5 2 1 255\n\x00\xfe";

/// The error of reading a file with this content.
fn refused(name: &str, content: impl AsRef<[u8]>) -> (MapFileError, String) {
    let folder = TestFolder::new();
    folder.write("m.pgm", PGM);
    let path = folder.write(name, content);
    let error = read_map(&path, None).unwrap_err();
    let text = error.to_string();
    (error, text.replace(&folder.path("").display().to_string(), "/folder/"))
}

/// A program killed between the two writes leaves a YAML file that names the image; an image
/// alone would look like an unrelated file.
#[test]
fn the_yaml_file_gets_its_name_before_its_image() {
    let grid = OccupancyGrid::from_ascii(&[".#"]);
    let files = ros_map_files(Path::new("a/b.yaml"), &grid, ImageKind::Pgm).unwrap();
    assert_eq!(files.map(|(path, _)| path), ["a/b.yaml", "a/b.pgm"].map(PathBuf::from));
}

#[test]
fn extensions_pick_the_format() {
    let folder = TestFolder::new();
    folder.write("m.pgm", PGM);
    let drawn = OccupancyGrid::from_ascii(&["#."]);
    let png = image_from_grid(&drawn, ImageKind::Png);
    for (name, content, format) in [
        ("A.PGM", PGM, MapFormat::Pgm),
        ("b.png", &png, MapFormat::Png),
        ("c.Map", b"type octile\nheight 1\nwidth 2\nmap\n@.", MapFormat::MovingAi),
    ] {
        let path = folder.write(name, content);
        let loaded = read_map(&path, None).unwrap();
        assert_eq!((&loaded.grid, loaded.format), (&drawn, format));
        assert_eq!(loaded.digest, digest(&drawn));
        let origin = Pose::new(3.0, 4.0, 1.0);
        let placement = ImagePlacement { resolution_m: 0.25, origin };
        let frame = *read_map(&path, Some(placement)).unwrap().grid.frame();
        assert_eq!((frame.resolution_m(), frame.origin()), (0.25, origin));
        let placement = ImagePlacement { resolution_m: -1.0, origin };
        let text = read_map(&path, Some(placement)).unwrap_err().to_string();
        assert!(text.contains(name) && text.contains("resolution must be a number"), "{text}");
    }
    for name in ["d.yaml", "e.YML"] {
        let loaded = read_map(&folder.write(name, YAML), None).unwrap();
        assert_eq!(loaded.format, MapFormat::Ros);
        assert_eq!(loaded.grid.frame().origin(), Pose::new(1.0, 2.0, 0.0));
        assert_eq!(loaded.grid.occupied(), drawn.occupied());
    }
}

#[test]
fn images_are_found_by_absolute_name_too() {
    let folder = TestFolder::new();
    let elsewhere = TestFolder::new();
    let image = folder.write("m.pgm", PGM);
    let yaml = YAML.replace("m.pgm", &image.display().to_string());
    assert!(read_map(&elsewhere.write("a.yaml", yaml), None).is_ok());
}

#[test]
fn errors_name_the_file() {
    let (error, text) = refused("m.txt", "");
    assert!(matches!(error, MapFileError::Extension { .. }));
    assert_eq!(
        text,
        "/folder/m.txt: expected a file name that ends in .yaml, .yml, .map, .pgm or .png"
    );

    let (error, text) = refused("a.yaml", YAML.replace("0.5", "-1"));
    assert!(matches!(error, MapFileError::RosMap { reason: RosMapError::Field { .. }, .. }));
    let expected = "/folder/a.yaml: line 2: `resolution` is -1, expected a number of metres per cell from 1e-6 to 1e6";
    assert_eq!(text, expected);

    let (error, text) = refused("a.yaml", YAML.replace("m.pgm", "none.pgm"));
    assert!(matches!(error, MapFileError::Read(ReadError::System { .. })));
    assert!(text.starts_with("cannot read /folder/none.pgm: "), "{text}");

    let (error, text) = refused("a.pgm", "P5 9 9 255\n");
    assert!(matches!(error, MapFileError::Image { reason: ImageError::Truncated { .. }, .. }));
    assert!(text.starts_with("/folder/a.pgm: 9 x 9 pixels need"), "{text}");

    let (error, text) = refused("a.map", "type octile\nheight 1\nwidth 1\nmap\n..");
    assert!(matches!(
        error,
        MapFileError::MovingAi { reason: MovingAiError::RowLength { .. }, .. }
    ));
    assert!(text.starts_with("/folder/a.map: line 5: the row has 2"), "{text}");

    let (error, _) = refused("a.map", "type octile\nheight 1\nwidth 1\nmap\n.\n.");
    assert!(matches!(error, MapFileError::MovingAi { reason: MovingAiError::Rows { .. }, .. }));
    for name in ["a.yaml", "a.map", "a.png", "a.pgm"] {
        assert!(refused(name, "").1.starts_with(&format!("/folder/{name}: ")));
    }
}

#[test]
fn what_is_usually_a_mistake() {
    let folder = TestFolder::new();
    let image = folder.write("m.pgm", PGM);
    let warnings = |path: &Path, placement| read_map(path, placement).unwrap().warnings;
    let text = |warnings: &[MapWarning]| warnings[0].to_string();
    let unsized_image = warnings(&image, None);
    assert_eq!(unsized_image, [MapWarning::Resolution { path: image.clone() }]);
    assert!(text(&unsized_image).contains("m.pgm: an image does not contain its resolution"));
    assert_eq!(warnings(&image, Some(ImagePlacement::default())), []);

    assert_eq!(warnings(&folder.write("a.yaml", YAML), None), []);
    let exchanged = YAML.replace("0.65", "0.2").replace("0.196", "0.65");
    let path = folder.write("b.yaml", &exchanged);
    let found = warnings(&path, None);
    assert_eq!(found, [MapWarning::Thresholds { path, occupied_thresh: 0.2, free_thresh: 0.65 }]);
    assert!(text(&found).contains("`free_thresh` (0.65) is above `occupied_thresh` (0.2)"));
    // In mode raw as well, whose values are not all free when they are a mask of 0 and 1.
    let found = warnings(&folder.write("c.yaml", exchanged + "mode: raw\n"), None);
    assert!(matches!(found[..], [MapWarning::Thresholds { .. }]), "{found:?}");
    folder.write("m.pgm", b"P5 2 1 255\n\x00\x01");
    let path = folder.write("d.yaml", format!("{YAML}mode: raw\n"));
    let found = warnings(&path, None);
    assert_eq!(found, [MapWarning::Mask { path, largest: 1 }]);
    assert!(text(&found).contains("the largest occupancy is 1 of 100"));
}

#[test]
fn folders_and_placements_are_refused() {
    let folder = TestFolder::new();
    fs::create_dir(folder.path("sub.map")).unwrap();
    let error = read_map(&folder.path("sub.map"), None).unwrap_err();
    assert!(matches!(error, MapFileError::Read(ReadError::Folder { .. })));
    assert!(error.to_string().ends_with("sub.map: it is a folder, expected a file"));
    let error = read_map(Path::new("none.pgm"), None).unwrap_err();
    assert!(matches!(error, MapFileError::Read(ReadError::System { .. })));

    let path = folder.write("a.yaml", YAML);
    let error = read_map(&path, Some(ImagePlacement::default())).unwrap_err();
    assert!(matches!(error, MapFileError::Placement { .. }));
    assert!(
        error.to_string().contains("a.yaml: the YAML file already contains the map's resolution")
    );

    let error = write_map(&folder.path("none/a.yaml"), &OccupancyGrid::from_ascii(&["."]));
    assert!(matches!(error, Err(MapFileError::Write(_))));
    let error = write_map(&folder.path("a.bmp"), &OccupancyGrid::from_ascii(&["."]));
    assert!(matches!(error, Err(MapFileError::Extension { .. })));
}

#[cfg(unix)]
#[test]
fn names_that_no_yaml_file_can_hold() {
    use std::os::unix::ffi::OsStrExt;
    let folder = TestFolder::new();
    let path = folder.path("").join(std::ffi::OsStr::from_bytes(b"\xff.yaml"));
    let error = write_map(&path, &OccupancyGrid::from_ascii(&["."])).unwrap_err();
    assert!(matches!(error, MapFileError::ImageName { .. }));
    assert!(error.to_string().contains("expected a file name in UTF-8"));
    assert!(folder.names().is_empty());
}

#[test]
fn scenarios_for_a_map() {
    let folder = TestFolder::new();
    let path = folder.write("a.scen", "version 1\n0 a.map 2 1 0 0 1 0 1\n1 a.map 4 2 0 0 1 0 1\n");
    let scenarios = read_scenarios(&path).unwrap();
    assert_eq!(scenarios[1].start, Cell::new(0, 1));
    let grid = OccupancyGrid::from_ascii(&[".."]);
    let error = read_scenarios_for(&path, grid.frame()).unwrap_err();
    let MapFileError::Scenarios { reason: ScenarioError::OtherMap { line: 3, .. }, .. } = error
    else {
        panic!("{error}")
    };
    let path = folder.write("b.scen", "0 a.map 2 1 0 0 1 0 1");
    assert_eq!(read_scenarios_for(&path, grid.frame()).unwrap().len(), 1);
}

#[test]
fn writing_leaves_the_two_files_only() {
    let folder = TestFolder::new();
    let grid = OccupancyGrid::from_ascii(&["#?", ".."]);
    write_ros_map(&folder.path("my map.yaml"), &grid, ImageKind::Png).unwrap();
    write_map(&folder.path("b.yml"), &grid).unwrap();
    assert_eq!(folder.names(), ["b.pgm", "b.yml", "my map.png", "my map.yaml"]);
    assert_eq!(read_map(&folder.path("my map.yaml"), None).unwrap().grid, grid);
    let yaml = fs::read_to_string(folder.path("b.yml")).unwrap();
    let expected = "image: b.pgm\nmode: trinary\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\n\
        occupied_thresh: 0.65\nfree_thresh: 0.196\n";
    assert_eq!(yaml, expected);
}

fn frames() -> impl Strategy<Value = GridFrame> {
    let origin = (-1e3..1e3f64, -1e3..1e3f64, -3.1..3.1f64);
    (1..70u64, 1..9u64, 0.001..10f64, origin).prop_map(
        |(width, height, resolution_m, (x, y, yaw))| {
            GridFrame::new(width, height, resolution_m, Pose::new(x, y, yaw)).unwrap()
        },
    )
}

fn with_values(
    frame: GridFrame,
    values: Vec<u8>,
    thresholds: OccupancyThresholds,
) -> OccupancyGrid {
    OccupancyGrid::from_known_values(frame, values, thresholds).unwrap()
}

/// Grids with and without values.
fn grids() -> impl Strategy<Value = OccupancyGrid> {
    let value = prop_oneof![0..=100u8, Just(255u8)];
    let thresholds = (1..=100u8, 0..100u8)
        .prop_filter_map("order", |(occupied, free)| OccupancyThresholds::new(occupied, free).ok());
    (frames(), any::<bool>(), prop::collection::vec(value, 70 * 9), thresholds).prop_map(
        |(frame, has_values, mut values, thresholds)| {
            values.truncate(frame.cell_count() as usize);
            if has_values {
                return with_values(frame, values, thresholds);
            }
            let width = frame.width() as usize;
            OccupancyGrid::from_fn(frame, |Cell { x, y }| {
                match values[y as usize * width + x as usize] {
                    0..=40 => CellState::Free,
                    41..=80 => CellState::Occupied,
                    _ => CellState::Unknown,
                }
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn what_is_written_is_read_back(grid in grids()) {
        let folder = TestFolder::new();
        let yaml = folder.path("a.yaml");
        let placement =
            ImagePlacement { resolution_m: grid.frame().resolution_m(), origin: grid.frame().origin() };
        for kind in [ImageKind::Pgm, ImageKind::Png] {
            write_ros_map(&yaml, &grid, kind).unwrap();
            prop_assert_eq!(&read_map(&yaml, None).unwrap().grid, &grid);
        }
        for name in ["b.pgm", "b.png", "b.map"] {
            let path = folder.path(name);
            write_map(&path, &grid).unwrap();
            let read = read_map(&path, Some(placement)).unwrap().grid;
            prop_assert_eq!(read.frame(), grid.frame());
            for cell in grid.frame().cells() {
                let expected = match grid.state(cell) {
                    Some(CellState::Unknown) if name == "b.map" => Some(CellState::Occupied),
                    state => state,
                };
                prop_assert_eq!(read.state(cell), expected);
            }
        }
    }

    #[test]
    fn values_above_100_come_back_as_unknown(value in 101..=255u8) {
        let folder = TestFolder::new();
        let frame = GridFrame::new(1, 1, 1.0, Pose::default()).unwrap();
        let path = folder.path("a.yaml");
        write_map(&path, &with_values(frame, vec![value], OccupancyThresholds::default())).unwrap();
        let image = fs::read(folder.path("a.pgm")).unwrap();
        prop_assert_eq!(image.last(), Some(&255));
        let read = read_map(&path, None).unwrap().grid;
        prop_assert_eq!(read, with_values(frame, vec![255], OccupancyThresholds::default()));
    }
}

fn decode(bytes: &[u8]) -> Result<OccupancyGrid, ImageError> {
    grid_from_image(bytes, &CellRule::IMAGE, ImagePlacement::default())
}

proptest! {
    #[test]
    fn no_image_panics(grid in grids(), garbage: Vec<u8>, png: bool,
                       edits in prop::collection::vec((any::<Index>(), any::<u8>()), 0..4),
                       cut: Option<Index>) {
        let mut bytes = image_from_grid(&grid, if png { ImageKind::Png } else { ImageKind::Pgm });
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = decode(&bytes);
        for start in [&b""[..], b"P2", b"P5 ", b"P2 3 2 255\n", b"\x89PNG\r\n\x1a\n"] {
            let _ = decode(&[start, &garbage].concat());
        }
    }

    #[test]
    fn no_header_of_a_plain_image_panics(text in "P[25][ \n#]{1,2}[0-9]{1,5}[ #\n][0-9]{1,20}[ \r\n]{1,2}[0-9]{1,6}[ \n#][0-9 #\n]{0,60}") {
        if let Err(error) = decode(text.as_bytes()) {
            let impossible = matches!(error, ImageError::Frame(FrameError::Empty { .. }));
            prop_assert!(!impossible, "{}", error);
        }
    }
}

/// Files and memory give the same map, or the same error.
#[test]
fn memory_is_read_like_files() {
    let png = image_from_grid(&OccupancyGrid::from_ascii(&["#.?"]), ImageKind::Png);
    let octile = b"type octile\nheight 1\nwidth 2\nmap\n@.";
    let placed = ImagePlacement { resolution_m: 0.25, origin: Pose::new(3.0, 4.0, 1.0) };
    for (name, content) in [
        ("a.yaml", YAML.as_bytes()),
        ("b.yaml", b"image: m.pgm\nresolution: 0\n"),
        ("c.yaml", b"image: absent.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.2\nfree_thresh: 0.8\n"),
        ("d.pgm", PGM),
        ("e.pgm", b"P5 9 9 255\n"),
        ("f.png", &png),
        ("g.png", &png[..40]),
        ("h.map", octile),
        ("i.map", &octile[..20]),
        ("j.txt", PGM),
    ] {
        let folder = TestFolder::new();
        folder.write("m.pgm", PGM);
        let path = folder.write(name, content);
        for placement in [None, Some(placed)] {
            let read = read_map(&path, placement);
            let image = |image: &Path| read_file(image, MAX_MAP_BYTES);
            let parsed = map_from_bytes(&path, content, image, placement);
            assert_eq!(read.is_ok(), ["a", "d", "f", "h"].contains(&&name[..1]) && !(name == "a.yaml" && placement.is_some()));
            match (read, parsed) {
                (Ok(read), Ok(parsed)) => assert_eq!(read, parsed),
                (read, parsed) => {
                    assert_eq!(read.unwrap_err().to_string(), parsed.unwrap_err().to_string());
                }
            }
        }
    }
}

#[test]
fn scenarios_from_memory_have_the_errors_of_files() {
    let (good, bad) = ("version 1\n0\tm.map\t2\t1\t0\t0\t1\t0\t1\n", "version 1\n0\tm.map\n");
    let folder = TestFolder::new();
    let path = folder.write("a.scen", good);
    let parsed = scenarios_from_bytes(&path, good.as_bytes()).unwrap();
    assert_eq!((parsed.len(), &parsed), (1, &read_scenarios(&path).unwrap()));
    let path = folder.write("b.scen", bad);
    let error = scenarios_from_bytes(&path, bad.as_bytes()).unwrap_err().to_string();
    assert_eq!(error, read_scenarios(&path).unwrap_err().to_string());
    assert!(error.contains("b.scen: line 2: "), "{error}");
}
