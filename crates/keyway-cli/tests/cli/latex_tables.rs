//! Tests that the LaTeX tables are valid for any file name.

use crate::batch::scenes;
use crate::latex_reader;
use crate::support::{keyway, read, write};

/// A name of characters that are special to TeX, or unknown to it.
const HOSTILE: &str = "a_b%&#$~^{}[]*--\u{2192}\u{e9}\u{4e2d}";

/// The strict reader accepts the tables, and every row is as wide as the header.
#[test]
fn tables_for_papers_are_sound_whatever_files_are_called() {
    let folder = scenes();
    let printed = keyway(folder.path(), "list astar-follow").expect_code(0).out;
    write(&folder, &format!("{HOSTILE}.toml"), &printed);
    write(&folder, &format!("{HOSTILE}.map"), &read(&folder, "walled.map"));
    let line = "batch scenes/hall.toml --seeds 2 --out out --stacks";
    // The commas of `--stacks` are not part of a name.
    keyway(folder.path(), &format!("{line} ./{HOSTILE}.toml,astar-follow")).expect_code(0);
    let name =
        r"a\_b\%\&\#\$\textasciitilde{}\textasciicircum{}\{\}{[}]{*}-{}-$\rightarrow$éU+4E2D";
    for (file, row) in [("summary", 1), ("against_first", 0)] {
        let tex = read(&folder, &format!("out/{file}.tex"));
        let cells = latex_reader::read(&tex);
        assert_eq!(cells.len(), 2 + row, "{tex}");
        if row == 1 {
            assert_eq!(cells[1][0], format!("./{name}.toml"));
        }
    }
    let line =
        format!("compare walled.map {HOSTILE}.map --queries 2 --planners all --out compared");
    keyway(folder.path(), &line).expect_code(0);
    let cells = latex_reader::read(&read(&folder, "compared/table.tex"));
    let hostile = cells.iter().filter(|row| row[0].starts_with(name)).count();
    assert!(cells.len() > 20 && hostile > 10, "{cells:?}");
    assert_eq!(cells.last().unwrap()[0], "all maps");
}
