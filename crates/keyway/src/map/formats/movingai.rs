//! Grid maps of the MovingAI benchmarks \[Sturtevant2012\]: `.map` files of type octile.
//!
//! A header of `type octile`, `height` and `width`, a line `map`, and then one line of text for
//! each row, the top row first. `.`, `G` and `S` are passable, every other character is occupied.
//!
//! `type octile-corner` is the format of the program HOG for maps with terrain heights. Height
//! and width count the corners of cells. One line per row of corners gives their heights,
//! followed by as many rows of terrain, of which the last row and the last column are not part of
//! the map; lower-case letters are the same terrain on a slope. Heights are not kept. Files of
//! this type that have rows of terrain only are read as octile. The rule for cutting corners is
//! not part of the file here, but a setting of the planner (`planner.corners`).

use super::text::{TextError, numbered_lines, text_from_bytes};
use super::{DEFAULT_MAX_CELLS, ImagePlacement, TooManyCells, check_size};
use crate::map::{Cell, CellState, FrameError, GridFrame, MAX_CELLS, OccupancyGrid};
use thiserror::Error;

/// Error in a `.map` file.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MovingAiError {
    /// Not UTF-8.
    #[error(transparent)]
    Text(#[from] TextError),
    /// A line of the header that does not belong there, or the end of the file.
    #[error("line {line}: got {got}, expected {expected}")]
    Header {
        /// Line, from 1.
        line: usize,
        /// Text found there.
        got: String,
        /// Text expected there.
        expected: &'static str,
    },
    /// More or fewer rows than the header says.
    #[error("line {line}: the map has {got}, expected {expected} as the header says")]
    Rows {
        /// The first line too many, or the last line of the map; from 1.
        line: usize,
        /// Rows found.
        got: String,
        /// The height in the header.
        expected: u64,
    },
    /// A row that is longer or shorter than the header says.
    #[error("line {line}: the row has {got} characters, expected {expected} as the header says")]
    RowLength {
        /// Line, from 1.
        line: usize,
        /// Characters in it.
        got: usize,
        /// The width in the header.
        expected: u64,
    },
    /// A character that is no terrain.
    #[error(
        "line {line}, column {column}: {got:?} is not terrain, expected a visible ASCII character"
    )]
    Terrain {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// The character.
        got: char,
    },
    /// A size or placement that is not valid for a grid.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// A map with more cells than the limit.
    #[error(transparent)]
    TooManyCells(#[from] TooManyCells),
}

/// Reads the content of a `.map` file of at most [`DEFAULT_MAX_CELLS`]. The format has no metric
/// units: `placement` gives the size of a cell and the position of the lower-left corner.
///
/// # Errors
/// Returns [`MovingAiError`] if the bytes are not such a map, its rows do not match the header,
/// or it has too many cells.
pub fn parse_movingai_map(
    bytes: &[u8],
    placement: ImagePlacement,
) -> Result<OccupancyGrid, MovingAiError> {
    map_of_at_most(DEFAULT_MAX_CELLS, bytes, placement).map(|octile| octile.grid)
}

/// Lower bound of the columns and rows of a map from its header; `None` if the beginning of the
/// file does not contain the whole header.
pub(super) fn size_of_map(head: &[u8]) -> Option<(u64, u64)> {
    // A character may be cut at the end.
    let text = String::from_utf8_lossy(head);
    let header = parse_header(&mut numbered_lines(text.trim_start_matches('\u{feff}'))).ok()?;
    let corner = u64::from(header.may_have_heights);
    Some(((header.width - corner).max(1), (header.height - corner).max(1)))
}

/// A map, and a flag for the heights that it does not keep.
pub(super) struct Octile {
    pub(super) grid: OccupancyGrid,
    pub(super) has_heights: bool,
}

/// Like [`parse_movingai_map`], with another limit.
pub(super) fn map_of_at_most(
    max_cells: u64,
    bytes: &[u8],
    placement: ImagePlacement,
) -> Result<Octile, MovingAiError> {
    let mut lines = numbered_lines(text_from_bytes(bytes)?);
    let header = parse_header(&mut lines)?;
    let mut rows = parse_rows(lines, &header)?;
    let has_heights = rows.len() as u64 > header.height;
    let Header { mut width, mut height, .. } = header;
    if has_heights {
        // All of the terrain but the last row and column.
        rows = rows.split_off(height as usize);
        rows.pop();
        (width, height) = (width - 1, height - 1);
    }
    check_size::<MovingAiError>((width, height), max_cells)?;
    let frame = GridFrame::new(width, height, placement.resolution_m, placement.origin)?;
    let row = |y: usize| &rows[rows.len() - 1 - y][..width as usize];
    let grid = OccupancyGrid::from_rows(frame, row, |letter| match letter {
        b'.' | b'G' | b'S' => CellState::Free,
        b'g' | b's' if has_heights => CellState::Free,
        _ => CellState::Occupied,
    });
    Ok(Octile { grid, has_heights })
}

struct Header {
    width: u64,
    height: u64,
    /// Rows of heights may come before those of terrain.
    may_have_heights: bool,
    /// Number of the line `map`, the last one of the header; from 1.
    end: usize,
}

/// Parses the header; `lines` then continues with the first row.
fn parse_header<'a>(
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
) -> Result<Header, MovingAiError> {
    let (mut may_have_heights, mut width, mut height) = (None, None, None);
    let mut last = 1;
    for (line, text) in lines {
        last = line;
        let wrong = |expected| MovingAiError::Header { line, got: shown(text), expected };
        let words: Vec<&str> = text.split_ascii_whitespace().take(3).collect();
        match words[..] {
            [] => {}
            ["type", kind @ ("octile" | "octile-corner")] if may_have_heights.is_none() => {
                may_have_heights = Some(kind == "octile-corner");
            }
            ["type", ..] => return Err(wrong("`type octile`, once")),
            ["width", number] if width.is_none() => {
                width = Some(
                    size(number)
                        .ok_or_else(|| wrong("`width` and a number from 1 to 2147483648"))?,
                );
            }
            ["height", number] if height.is_none() => {
                height = Some(
                    size(number)
                        .ok_or_else(|| wrong("`height` and a number from 1 to 2147483648"))?,
                );
            }
            ["map"] => {
                return match (may_have_heights, width, height) {
                    (Some(may_have_heights), Some(width), Some(height)) => {
                        Ok(Header { width, height, may_have_heights, end: line })
                    }
                    (None, ..) => Err(wrong("`type octile` before `map`")),
                    (_, None, _) => Err(wrong("`width` and a number before `map`")),
                    (.., None) => Err(wrong("`height` and a number before `map`")),
                };
            }
            _ => return Err(wrong("`type octile`, `height`, `width`, each once, then `map`")),
        }
    }
    let expected = "`type octile`, `height`, `width`, then `map`";
    Err(MovingAiError::Header { line: last, got: "the end of the file".to_owned(), expected })
}

fn size(word: &str) -> Option<u64> {
    let digits = word.bytes().all(|b| b.is_ascii_digit());
    word.parse().ok().filter(|n| digits && (1..=MAX_CELLS).contains(n))
}

/// Shortens a line for an error message.
fn shown(text: &str) -> String {
    if text.chars().count() > 40 {
        let start: String = text.chars().take(40).collect();
        return format!("{start:?}...");
    }
    format!("{text:?}")
}

/// Parses the rows, top row first. Nothing is stored for rows that are not in the text.
fn parse_rows<'a>(
    lines: impl Iterator<Item = (usize, &'a str)>,
    header: &Header,
) -> Result<Vec<&'a [u8]>, MovingAiError> {
    let mut rows: Vec<&[u8]> = Vec::new();
    let mut last = header.end;
    let wrong = |line, got| MovingAiError::Rows { line, got, expected: header.height };
    let most = if header.may_have_heights { 2 * header.height } else { header.height };
    for (line, text) in lines {
        let whole = rows.len() as u64 == most;
        let may_end = whole || rows.len() as u64 == header.height;
        if may_end && text.trim_ascii().is_empty() {
            continue;
        }
        if whole {
            return Err(wrong(line, format!("more than {}", rows_text(rows.len()))));
        }
        if text.is_empty() {
            // Reporting a missing row is clearer than a row of 0 characters.
            return Err(wrong(line, format!("{} before this blank line", rows_text(rows.len()))));
        }
        check_row(line, text, header.width)?;
        rows.push(text.as_bytes());
        last = line;
    }
    let is_whole = [header.height, most].contains(&(rows.len() as u64));
    if !is_whole {
        return Err(wrong(last, format!("{} before the end of the file", rows_text(rows.len()))));
    }
    Ok(rows)
}

fn rows_text(count: usize) -> String {
    if count == 1 { "1 row".to_owned() } else { format!("{count} rows") }
}

fn check_row(line: usize, text: &str, width: u64) -> Result<(), MovingAiError> {
    // All bytes are checked without an early exit, so that the compiler compares many at once.
    let is_visible = text.bytes().fold(true, |all, byte| all & byte.is_ascii_graphic());
    let other = || text.chars().enumerate().find(|(_, c)| !c.is_ascii_graphic());
    if let Some((at, got)) = if is_visible { None } else { other() } {
        return Err(MovingAiError::Terrain { line, column: at + 1, got });
    }
    if text.len() as u64 != width {
        return Err(MovingAiError::RowLength { line, got: text.len(), expected: width });
    }
    Ok(())
}

/// Writes the content of a `.map` file. The format has only two states: **unknown cells are
/// written as occupied** (`@`). The pose of the grid in the world is not kept either.
pub fn movingai_map_from_grid(grid: &OccupancyGrid) -> String {
    let (width, height) = (grid.frame().width(), grid.frame().height());
    let mut text = format!("type octile\nheight {height}\nwidth {width}\nmap\n");
    text.reserve(height as usize * (width as usize + 1));
    for y in (0..height as i32).rev() {
        text.extend((0..width as i32).map(|x| match grid.state(Cell::new(x, y)) {
            Some(CellState::Free) => '.',
            _ => '@',
        }));
        text.push('\n');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SMALL: &str = "type octile\nheight 2\nwidth 3\nmap\n.G@\nSTW\n";

    fn parse(text: &str) -> Result<OccupancyGrid, MovingAiError> {
        parse_movingai_map(text.as_bytes(), ImagePlacement::default())
    }

    #[test]
    fn terrain_and_row_order() {
        let drawn = OccupancyGrid::from_ascii(&["..#", ".##"]);
        assert_eq!(parse(SMALL), Ok(drawn.clone()));
        for text in [
            "type octile\nwidth 3\nheight 2\nmap\n..@\n.OO",
            "height 2\n type  octile \nwidth 3\nmap\n..@\n.@@\n\n \n\r\n",
            &SMALL.replace('\n', "\r\n"),
            &format!("\u{feff}{SMALL}"),
        ] {
            assert_eq!(parse(text), Ok(drawn.clone()), "{text}");
        }
        assert_eq!(
            parse("type octile\nheight 1\nwidth 1\nmap\n."),
            Ok(OccupancyGrid::from_ascii(&["."]))
        );
    }

    /// By hand: 3 x 2 cells have 4 x 3 corners.
    #[test]
    fn heights_of_corners_are_passed_over() {
        let drawn = OccupancyGrid::from_ascii(&["..#", "..#"]);
        let header = "type octile-corner\nheight 3\nwidth 4\nmap\n";
        let heights = "2222\n2233\n2233\n";
        let terrain = ".gT#\nSs@T\nTTTT\n";
        for text in [
            format!("{header}{heights}{terrain}"),
            format!("{header}{heights}\n{terrain}\n"),
            format!("{header}{heights}{terrain}").replace('\n', "\r\n"),
        ] {
            let read =
                |max_cells| map_of_at_most(max_cells, text.as_bytes(), ImagePlacement::default());
            let Octile { grid, has_heights } = read(6).unwrap();
            assert_eq!((grid, has_heights), (drawn.clone(), true));
            assert!(matches!(read(5), Err(MovingAiError::TooManyCells(_))));
        }
        // Terrain only.
        let octile = SMALL.replace("octile", "octile-corner");
        assert_eq!(parse(&octile), parse(SMALL));
        for (rows, line, got) in [("", 4, 0), ("2222\n", 5, 1), (".gT#\n2233\n2233\n....\n", 8, 4)]
        {
            let error = parse(&format!("{header}{rows}")).unwrap_err().to_string();
            assert!(error.starts_with(&format!("line {line}: the map has {got} row")), "{error}");
        }
        let more = parse(&format!("{header}{heights}{terrain}....\n")).unwrap_err().to_string();
        assert!(more.starts_with("line 11: the map has more than 6 rows"), "{more}");
        let thin = "type octile-corner\nheight 1\nwidth 2\nmap\n22\n..\n";
        assert!(matches!(parse(thin), Err(MovingAiError::Frame(FrameError::Empty { .. }))));
    }

    #[test]
    fn placement_is_the_callers() {
        let origin = crate::geometry::Pose::new(1.0, 2.0, 0.5);
        let grid =
            parse_movingai_map(SMALL.as_bytes(), ImagePlacement { resolution_m: 0.1, origin });
        let frame = *grid.unwrap().frame();
        assert_eq!((frame.resolution_m(), frame.origin()), (0.1, origin));
        let bad = ImagePlacement { resolution_m: 0.0, ..ImagePlacement::default() };
        let error = parse_movingai_map(SMALL.as_bytes(), bad).unwrap_err();
        assert!(matches!(error, MovingAiError::Frame(FrameError::Resolution(_))));
    }

    #[test]
    fn bad_headers_name_the_line() {
        for (text, at, key) in [
            ("", 1, "got the end of the file"),
            ("type octile\nheight 2\n", 2, "got the end of the file"),
            ("type tile\n", 1, "expected `type octile`"),
            ("type octile\ntype octile\n", 2, "expected `type octile`, once"),
            ("height 0\n", 1, "expected `height` and a number from 1"),
            ("width -3\n", 1, "expected `width` and a number from 1"),
            ("width +3\n", 1, "expected `width` and a number from 1"),
            (
                "width 99999999999999999999\n",
                1,
                "expected `width` and a number from 1 to 2147483648",
            ),
            ("height 2147483649\n", 1, "expected `height` and a number from 1 to 2147483648"),
            ("width 3\nwidth 3\n", 2, "each once"),
            ("width 3 4\n", 1, "each once"),
            ("width 3\nheight 2\nmap\n", 3, "expected `type octile` before"),
            ("type octile\nheight 2\nmap\n", 3, "expected `width` and a number before"),
            ("type octile\nwidth 2\nmap\n", 3, "expected `height` and a number before"),
            (&format!("\n{}", "@".repeat(1000)), 2, "@\"..., expected"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(matches!(error, MovingAiError::Header { line, .. } if line == at), "{error}");
            let message = error.to_string();
            assert!(message.starts_with(&format!("line {at}: got ")), "{message}");
            assert!(message.contains(key) && message.len() < 150, "{message}");
        }
    }

    #[test]
    fn bad_rows_name_the_line() {
        let map = |rows: &str| parse(&SMALL.replace(".G@\nSTW\n", rows)).unwrap_err();
        for (rows, message) in [
            (
                "...\n",
                "line 5: the map has 1 row before the end of the file, expected 2 as the header says",
            ),
            (
                "...",
                "line 5: the map has 1 row before the end of the file, expected 2 as the header says",
            ),
            (
                "...\n\n",
                "line 6: the map has 1 row before this blank line, expected 2 as the header says",
            ),
            (
                "",
                "line 4: the map has 0 rows before the end of the file, expected 2 as the header says",
            ),
            (
                "\n...\n",
                "line 5: the map has 0 rows before this blank line, expected 2 as the header says",
            ),
            (
                "...\n...\n\n...\n",
                "line 8: the map has more than 2 rows, expected 2 as the header says",
            ),
        ] {
            let error = map(rows);
            assert!(matches!(error, MovingAiError::Rows { .. }), "{error}");
            assert_eq!(error.to_string(), message);
        }
        let error = map("...\n..\n");
        assert_eq!(error, MovingAiError::RowLength { line: 6, got: 2, expected: 3 });
        assert!(error.to_string().contains("has 2 characters, expected 3"), "{error}");
        assert!(matches!(map("....\n...\n"), MovingAiError::RowLength { line: 5, got: 4, .. }));
        let error = map("...\n.\t.\n");
        assert_eq!(error, MovingAiError::Terrain { line: 6, column: 2, got: '\t' });
        assert!(error.to_string().starts_with("line 6, column 2: '\\t' is not terrain"), "{error}");
        assert!(matches!(map("..é\n...\n"), MovingAiError::Terrain { line: 5, column: 3, .. }));
        let huge = SMALL.replace("height 2", "height 2147483648");
        assert!(matches!(parse(&huge), Err(MovingAiError::Rows { .. })));
        let error =
            parse_movingai_map(b"type octile\n\xff", ImagePlacement::default()).unwrap_err();
        assert!(matches!(error, MovingAiError::Text(TextError { line: 2, .. })));
    }

    #[test]
    fn unknown_is_written_as_occupied() {
        let grid = OccupancyGrid::from_ascii(&["#?.", "..."]);
        let text = movingai_map_from_grid(&grid);
        assert_eq!(text, "type octile\nheight 2\nwidth 3\nmap\n@@.\n...\n");
        assert_eq!(parse(&text), Ok(OccupancyGrid::from_ascii(&["##.", "..."])));
    }

    proptest! {
        #[test]
        fn nothing_panics(bytes: Vec<u8>, at in 0..SMALL.len(), insert in "[0-9a-zA-Z.@\n\r \t]{0,4}") {
            let _ = parse_movingai_map(&bytes, ImagePlacement::default());
            let _ = parse(&SMALL[..at]);
            let _ = parse(&format!("{}{insert}{}", &SMALL[..at], &SMALL[at..]));
        }
    }
}
