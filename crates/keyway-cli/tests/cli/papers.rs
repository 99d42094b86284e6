//! Tests that every source is defined once, in `docs/papers.md`, and cited by its key.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// All texts with possible citations: sources and documentation, without `docs/papers.md` itself.
fn texts() -> Vec<(PathBuf, String)> {
    let mut folders = ["crates", "docs", "scenes"].map(|folder| root().join(folder)).to_vec();
    let mut texts = Vec::new();
    let mut read = |path: PathBuf| {
        let is_text =
            path.extension().is_some_and(|extension| extension == "rs" || extension == "md");
        if is_text && !path.ends_with("docs/papers.md") {
            texts.push((path.clone(), std::fs::read_to_string(path).unwrap()));
        }
    };
    read(root().join("README.md"));
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { folders.push(path) } else { read(path) }
        }
    }
    texts
}

/// `[Key]` at the beginning of a table's row, and the row.
fn definitions() -> BTreeMap<String, String> {
    let text = std::fs::read_to_string(root().join("docs/papers.md")).unwrap();
    let mut all = BTreeMap::new();
    for line in text.lines() {
        let Some((key, row)) = line.strip_prefix("| [").and_then(|row| row.split_once("] |"))
        else {
            continue;
        };
        assert!(all.insert(key.to_owned(), row.to_owned()).is_none(), "{key} is defined twice");
    }
    all
}

/// A name and a year: `Hart1968`, or `S1`, whose year is unknown.
fn is_key(word: &str) -> bool {
    let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let year = &word[name.len()..];
    let is_name = name.len() > 1
        && name.starts_with(char::is_uppercase)
        && name.chars().all(char::is_alphabetic);
    word == "S1" || is_name && matches!(year.get(..2), Some("19" | "20")) && year.len() == 4
}

/// The keys of a text, in brackets or not.
fn citations(text: &str) -> BTreeSet<String> {
    let words = text.split(|c: char| !c.is_alphanumeric() && c != '_');
    words.filter(|word| is_key(word)).map(str::to_owned).collect()
}

#[test]
fn every_citation_is_defined_and_every_definition_is_cited() {
    let defined = definitions();
    let mut cited = BTreeSet::new();
    for (path, text) in texts() {
        for key in citations(&text) {
            assert!(defined.contains_key(&key), "{key} of {} is not defined", path.display());
            cited.insert(key);
        }
    }
    for key in defined.keys() {
        assert!(is_key(key) && cited.contains(key), "{key} is defined and cited nowhere");
    }
    // The patterns of this test.
    assert!(["Hart1968", "ZhuYin2024", "S1"].iter().all(|key| is_key(key)));
    assert!(
        !["Nav2", "v2024", "S2", "Berlin_0_1024", "A2024", "2024"].iter().any(|word| is_key(word))
    );
}

/// Titles appear in `docs/papers.md` alone, so that they cannot differ.
#[test]
fn no_source_is_cited_by_its_title() {
    let plain = |text: &str| -> String {
        let lines = text.lines().map(|line| line.trim_start().trim_start_matches(['/', '!']));
        let words: Vec<String> =
            lines.flat_map(str::split_whitespace).map(str::to_lowercase).collect();
        words.join(" ")
    };
    let titles: Vec<String> = definitions()
        .values()
        .filter_map(|row| row.split('"').nth(1).map(plain))
        .map(|title| title.trim_end_matches(',').to_owned())
        .collect();
    assert!(titles.len() > 20, "{titles:?}");
    for (path, text) in texts() {
        let text = plain(&text);
        for title in &titles {
            assert!(
                !text.contains(title.as_str()),
                "{} has the title of a source: {title}",
                path.display()
            );
        }
    }
}

#[test]
fn the_readme_names_the_papers() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    assert!(readme.contains("](docs/papers.md)"));
}
