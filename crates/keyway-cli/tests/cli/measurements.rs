//! Tests that tables of measurements name the command that prints them, and that it exists.

use std::path::{Path, PathBuf};

const DOCUMENTS: [&str; 6] = [
    "README.md",
    "docs/lab/findings.md",
    "docs/lab/performance.md",
    "docs/planners.md",
    "docs/python.md",
    "docs/smoothers.md",
];

/// Possible origins of a table: a command, a test, or a source outside the repository.
const ORIGINS: [&str; 8] = [
    "keyway batch",
    "keyway bench",
    "keyway compare",
    "cargo ",
    "gallery.sh",
    "side_by_side.py",
    "`corner_blend.rs`",
    "no command",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Each table with the paragraphs before it, back to the previous table or heading, and those
/// after it, up to the next heading.
fn tables(text: &str) -> Vec<(String, String)> {
    let is_table = |block: &str| block.starts_with('|') && block.contains("|--");
    let (mut found, mut around): (Vec<(String, String)>, _) = (Vec::new(), String::new());
    for block in text.split("\n\n") {
        let block = block.trim();
        if block.starts_with('#') {
            around.clear();
        }
        if is_table(block) {
            found.push((block.to_owned(), around.clone()));
            around.clear();
        } else {
            around.push_str(block);
            if let Some((_, about)) = found.last_mut().filter(|_| !block.starts_with('#')) {
                about.push_str(block);
            }
        }
    }
    found
}

/// True if most of a table's cells, after the first column, are numbers.
fn is_measured(table: &str) -> bool {
    let cells = table.lines().skip(2).flat_map(|row| row.trim_matches('|').split('|').skip(1));
    let (mut numbers, mut all) = (0, 0);
    for cell in cells {
        all += 1;
        numbers += usize::from(cell.trim().starts_with(|c: char| c.is_ascii_digit() || c == '-'));
    }
    2 * numbers > all
}

#[test]
fn every_table_of_measurements_names_what_prints_it() {
    let mut measured = 0;
    for document in DOCUMENTS {
        let text = std::fs::read_to_string(root().join(document)).unwrap();
        for (table, around) in tables(&text).into_iter().filter(|(table, _)| is_measured(table)) {
            measured += 1;
            let head = table.lines().next().unwrap();
            // Line breaks are not part of a command.
            let around = around.split_whitespace().collect::<Vec<_>>().join(" ");
            let has_origin = ORIGINS.iter().any(|origin| around.contains(origin));
            assert!(has_origin, "{document}: nothing says what prints {head}");
        }
    }
    assert!(measured > 15, "{measured} tables");
}

/// True if a cell contains the range of its values: `6.92 (2.1 to 14.3)`, or `median / worst`.
fn is_range(cell: &str) -> bool {
    let is_digit = |letter: char| letter.is_ascii_digit();
    [" to ", " / "].iter().any(|between| {
        cell.match_indices(between).any(|(at, _)| {
            let after = &cell[at + between.len()..];
            cell[..at].ends_with(is_digit) && after.trim_start_matches('-').starts_with(is_digit)
        })
    })
}

/// True if at least every second row has a range.
fn has_ranges(table: &str) -> bool {
    let rows: Vec<&str> = table.lines().skip(2).collect();
    2 * rows.iter().filter(|row| row.split('|').any(is_range)).count() >= rows.len()
}

#[test]
fn every_table_of_measurements_has_ranges_or_says_why_not() {
    for document in DOCUMENTS {
        let text = std::fs::read_to_string(root().join(document)).unwrap();
        for (table, around) in tables(&text).into_iter().filter(|(table, _)| is_measured(table)) {
            let head = table.lines().next().unwrap();
            let around = around.split_whitespace().collect::<Vec<_>>().join(" ").to_lowercase();
            let says_why = around.contains("there is no range");
            assert!(has_ranges(&table) || says_why, "{document}: no range in {head}");
        }
    }
}

#[test]
fn ranges_are_recognised() {
    for cell in ["6.92 (2.1 to 14.3)", "-0.1 (-2 to -1)", "0.01 / 0.02", "327 to 529"] {
        assert!(is_range(cell), "{cell}");
    }
    for cell in ["6.92", "9.0 -> 6.4", "7370 (3582 + 3788)", "corner to corner", "jps / astar"] {
        assert!(!is_range(cell), "{cell}");
    }
}

#[test]
fn examples_and_benchmarks_that_are_named_exist() {
    let crates =
        ["keyway", "keyway-sim", "keyway-lab"].map(|name| root().join("crates").join(name));
    for document in DOCUMENTS {
        let text = std::fs::read_to_string(root().join(document)).unwrap();
        let words: Vec<&str> = text.split_whitespace().collect();
        for pair in words.windows(2) {
            let folder = match pair[0] {
                "--example" => "examples",
                "--bench" => "benches",
                _ => continue,
            };
            let name = pair[1].trim_end_matches(['`', '.', ',', ';', ')']);
            let is_there = |of: &PathBuf| of.join(folder).join(name).with_extension("rs").exists();
            assert!(crates.iter().any(is_there), "{document}: {name}");
        }
    }
}
