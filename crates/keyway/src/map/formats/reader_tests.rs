use super::super::{DEFAULT_MAX_CELLS, png};
use super::*;
use crate::file_system::test_folder::TestFolder;
use crate::map::MAX_CELLS;
use std::fs::File;

/// Beginnings of files with `width` x `height` cells, each with a file name of its format.
fn beginnings(width: u32, height: u32) -> [(&'static str, Vec<u8>); 4] {
    let plain = format!("P2 {width} {height} 255\n").into_bytes();
    let binary = format!("P5 # a map\n{width} {height}\n255\n").into_bytes();
    let octile = format!("type octile\nheight {height}\nwidth {width}\nmap\n").into_bytes();
    let mut png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR".to_vec();
    png.extend(width.to_be_bytes().iter().chain(&height.to_be_bytes()));
    png.extend(b"\x08\0\0\0\0\0\0\0\0");
    [("a.pgm", plain), ("b.pgm", binary), ("c.map", octile), ("d.png", png)]
}

/// The error, and the peak memory in use \[bytes\].
fn refused(path: &Path) -> (MapFileError, u64) {
    let mut error = None;
    let used = allocation_counter::measure(|| error = read_map(path, None).err());
    (error.unwrap(), used.bytes_max)
}

#[test]
fn maps_of_too_many_cells_are_refused_before_memory_is_taken() {
    let folder = TestFolder::new();
    for (name, content) in beginnings(30_000, 30_000) {
        let path = folder.write(name, content);
        // As long as a file with the whole map.
        File::options().write(true).open(&path).unwrap().set_len(900_000_100).unwrap();
        let yaml = format!(
            "image: {name}\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\n\
             occupied_thresh: 0.65\nfree_thresh: 0.196\n"
        );
        let yaml = folder.write("m.yaml", yaml);
        let described = (!name.ends_with("map")).then_some(yaml);
        for file in described.iter().chain([&path]) {
            let (error, used_bytes) = refused(file);
            let found = error.too_many_cells().unwrap_or_else(|| panic!("{error}"));
            assert_eq!((found.needed(), found.max_cells), (900_000_000, DEFAULT_MAX_CELLS));
            let expected = "a map of 30000 x 30000 cells is larger than the limit of 536870912 cells; if this size is intended, raise the limit";
            assert_eq!(error.to_string(), format!("{}: {expected}", path.display()));
            assert!(used_bytes < 1 << 18, "{name}: {used_bytes} bytes");
        }
    }
}

#[test]
fn the_limit_itself_passes() {
    const { assert!(16_384 * 16_384 <= DEFAULT_MAX_CELLS) };
    let folder = TestFolder::new();
    let pixels = b"\0".repeat(12);
    let whole = |bytes: &[u8]| [bytes, b"0 0 0 0 0 0 0 0 0 0 0 0"].concat();
    let [(_, plain), (_, binary), (_, octile), _] = beginnings(4, 3);
    let png = png::encode(4, 3, &pixels);
    let yaml = b"image: b.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    for (name, content) in [
        ("a.pgm", whole(&plain)),
        ("b.pgm", [binary, pixels].concat()),
        ("c.map", [&octile[..], b"....\n....\n...."].concat()),
        ("d.png", png),
        ("e.yaml", yaml.to_vec()),
    ] {
        let path = folder.write(name, &content);
        let image = |path: &Path| read_file(path, 1 << 10);
        for (max_cells, is_read) in [(12, true), (11, false), (1, false), (u64::MAX, true)] {
            let reader = MapReader { max_cells, ..MapReader::default() };
            for read in [reader.read(&path), reader.from_bytes(&path, &content, image)] {
                let refused = read.as_ref().err().and_then(MapFileError::too_many_cells);
                assert_eq!((read.is_ok(), refused.is_some()), (is_read, !is_read), "{name}");
            }
        }
    }
}

/// No limit allows more cells than a grid can have, and the error does not suggest it.
#[test]
fn maps_that_no_grid_can_hold() {
    let folder = TestFolder::new();
    for (name, content) in beginnings(1 << 16, 1 << 16) {
        let path = folder.write(name, content);
        let reader = MapReader { max_cells: u64::MAX, ..MapReader::default() };
        for read in [reader.read(&path), read_map(&path, None)] {
            let error = read.unwrap_err();
            let expected = format!("larger than the limit of {MAX_CELLS} cells");
            assert!(error.to_string().ends_with(&expected), "{error}");
            assert_eq!(error.too_many_cells(), None);
        }
    }
}

const YAML: &str = "image: m.pgm\nresolution: 0.5\norigin: [1, 2, 0]\nnegate: 0\noccupied_thresh: 0.65\n\
    free_thresh: 0.196\n";

/// The warnings about a map, without the name of the folder.
fn warnings(folder: &TestFolder, file: &str) -> Vec<String> {
    let loaded = read_map(&folder.path(file), None).unwrap();
    let name = folder.path("").display().to_string();
    loaded.warnings.iter().map(|warning| warning.to_string().replace(&name, "/")).collect()
}

#[test]
fn unknown_cells_that_are_read_as_free_are_counted() {
    let folder = TestFolder::new();
    folder.write("m.pgm", b"P5 4 1 255\n\x00\xfe\xcd\xcd");
    let read = |yaml: &str| {
        folder.write("a.yaml", yaml);
        warnings(&folder, "a.yaml")
    };
    assert_eq!(read(YAML), [""; 0]);
    let expected = "/a.yaml: 2 cells with the grey value of unknown cells (205 in saved maps) are read as free, because \
                    `free_thresh` is 0.25; with 0.196 they are unknown";
    let quarter = YAML.replace("0.196", "0.25");
    assert_eq!(read(&quarter), [expected]);
    assert_eq!(read(&format!("{quarter}mode: scale\n")), [expected]);
    // No cell is free by a threshold there, or the grey has another meaning.
    assert_eq!(read(&format!("{quarter}mode: raw\n")), [""; 0]);
    assert_eq!(read(&quarter.replace("negate: 0", "negate: 1")), [""; 0]);

    let rgba = [[0, 0, 0, 255], [254, 254, 254, 255], [205, 205, 205, 255], [205, 205, 205, 0]];
    let mut png = Vec::new();
    let mut encoder = ::png::Encoder::new(&mut png, 4, 1);
    encoder.set_color(::png::ColorType::Rgba);
    encoder.write_header().unwrap().write_image_data(rgba.as_flattened()).unwrap();
    folder.write("m.png", png);
    let expected = "/m.png: 1 cells with the grey value of unknown cells (205 in saved maps) are read as free, because an \
                    opaque alpha channel counts as a bright colour, as in the map server; save the image without it";
    let of_png = YAML.replace("m.pgm", "m.png");
    assert_eq!(read(&of_png), [expected]);
    assert_eq!(warnings(&folder, "m.png").iter().filter(|text| *text == expected).count(), 1);
    assert_eq!(read(&format!("{of_png}mode: scale\n")), [""; 0], "alpha is no colour there");
}

#[test]
fn fields_that_are_missing_are_said() {
    let folder = TestFolder::new();
    folder.write("m.pgm", b"P5 2 1 255\n\x00\xcd");
    let whole = folder.write("whole.yaml", YAML);
    for (line, expected) in [
        (
            "free_thresh: 0.196\n",
            "the field `free_thresh` is missing; 0.196 is assumed, as map savers write it",
        ),
        (
            "occupied_thresh: 0.65\n",
            "the field `occupied_thresh` is missing; 0.65 is assumed, as map savers write it",
        ),
        ("negate: 0\n", "the field `negate` is missing; 0 is assumed, as map savers write it"),
    ] {
        let path = folder.write("a.yaml", YAML.replace(line, ""));
        assert_eq!(warnings(&folder, "a.yaml"), [format!("/a.yaml: {expected}")]);
        assert_eq!(read_map(&path, None).unwrap().grid, read_map(&whole, None).unwrap().grid);
    }
}

#[test]
fn heights_that_are_not_kept_are_said() {
    let folder = TestFolder::new();
    folder.write("a.map", "type octile-corner\nheight 2\nwidth 2\nmap\n22\n23\n.T\nTT\n");
    folder.write("b.map", "type octile-corner\nheight 2\nwidth 2\nmap\n.T\nTT\n");
    let expected = "/a.map: heights of a map of type octile-corner are ignored, so paths across steps in the \
                    terrain count as free";
    assert_eq!(warnings(&folder, "a.map"), [expected]);
    assert_eq!(warnings(&folder, "b.map"), [""; 0]);
}
