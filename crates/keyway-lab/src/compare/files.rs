//! Names of the files that a comparison writes: the report, tables, and pictures of each map.

use super::Compared;
use super::report::SCHEMA;
use crate::results::{OutDir, ResultsError};
use serde_json::Value;
use std::path::Path;

/// Names of the files of a comparison.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CompareFiles {
    /// SVG and PNG of each map.
    pictures: Vec<[String; 2]>,
}

impl CompareFiles {
    /// Name of the report, as JSON.
    pub const REPORT: &str = "report.json";
    /// Name of the table of all rows, as CSV.
    pub const TABLE: &str = "table.csv";
    /// Name of the table of all rows, as LaTeX.
    pub const LATEX: &str = "table.tex";
    /// Names of the table of the tests against the first row, as CSV and as LaTeX.
    pub const AGAINST_FIRST: [&str; 2] = ["against_first.csv", "against_first.tex"];
    /// Name of the table of all answers, as CSV.
    pub const QUERIES: &str = "queries.csv";

    /// Returns the names of the files of a comparison on maps of these names.
    pub fn of_maps(maps: &[String]) -> Self {
        let names = |stem: String| ["svg", "png"].map(|end| format!("{stem}.{end}"));
        Self { pictures: picture_stems(maps).into_iter().map(names).collect() }
    }

    /// Returns the names of the files of an earlier comparison in a folder; empty without one.
    /// Its pictures of other maps would otherwise seem to belong to this comparison.
    ///
    /// # Errors
    /// Returns [`ResultsError`] if the earlier report cannot be read.
    pub fn of_earlier(out: &OutDir) -> Result<Vec<String>, ResultsError> {
        let report = out.earlier(Self::REPORT)?.and_then(|text| serde_json::from_str(&text).ok());
        let Some(report) = report.filter(|report: &Value| report["schema"] == SCHEMA) else {
            return Ok(Vec::new());
        };
        let maps = report["maps"].as_array().into_iter().flatten();
        // Reports of older versions have no names.
        let file_name = |path: &str| Some(Path::new(path).file_name()?.to_str()?.to_owned());
        let name = |map: &Value| {
            map["name"].as_str().map(str::to_owned).or_else(|| file_name(map["map"].as_str()?))
        };
        Ok(Self::of_maps(&maps.filter_map(name).collect::<Vec<_>>()).names())
    }

    /// Returns all names: the tables, then for each map its picture as SVG and as PNG.
    pub fn names(&self) -> Vec<String> {
        let tables = Self::TABLES.map(str::to_owned);
        tables.into_iter().chain(self.pictures.iter().flatten().cloned()).collect()
    }

    /// Returns the names of the pictures of each map, as SVG and as PNG.
    pub fn pictures(&self) -> &[[String; 2]] {
        &self.pictures
    }

    /// Returns the paths of the files in a folder; a map on which nothing was compared has no
    /// picture.
    pub fn paths(&self, maps: &[Compared], out: &OutDir) -> Vec<String> {
        let is_drawn = |(map, _): &(&Compared, &[String; 2])| map.picture_query().is_some();
        let drawn = maps.iter().zip(&self.pictures).filter(is_drawn);
        let pictures = drawn.flat_map(|(_, names)| names).map(String::as_str);
        let all = Self::TABLES.into_iter().chain(pictures);
        all.map(|name| out.path(name).display().to_string()).collect()
    }

    /// Files of all comparisons, in the order in which reports list them.
    const TABLES: [&str; 6] = {
        let [csv, latex] = Self::AGAINST_FIRST;
        [Self::REPORT, Self::TABLE, Self::LATEX, csv, latex, Self::QUERIES]
    };
}

/// Returns file names for pictures of maps, without an extension: each map's name without its own
/// extension, folders joined by `-`, with a number if the name is taken.
fn picture_stems(names: &[String]) -> Vec<String> {
    let mut stems: Vec<String> = Vec::new();
    for name in names {
        let stem = file_name_of(name);
        // Some file systems do not distinguish `A` from `a`.
        let is_free = |stem: &String| !stems.iter().any(|one| one.eq_ignore_ascii_case(stem));
        let numbered = (2..).map(|number| format!("{stem}-{number}"));
        // A free number always exists.
        stems.extend(std::iter::once(stem.clone()).chain(numbered).find(is_free));
    }
    stems
}

fn file_name_of(name: &str) -> String {
    let stem = Path::new(name).with_extension("");
    let is_safe = |letter: char| !letter.is_control() && !r#"\:*?"<>|"#.contains(letter);
    let letters = stem.to_string_lossy();
    let letters = letters.trim_matches('/').chars();
    let safe = letters.map(|letter| if is_safe(letter) { letter } else { '_' });
    safe.map(|letter| if letter == '/' { '-' } else { letter }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_pictures() {
        let stems = |names: &[&str]| {
            picture_stems(&names.iter().map(|&n| n.to_owned()).collect::<Vec<_>>())
        };
        assert_eq!(stems(&["a.map", "a.yaml", "a-2.png"]), ["a", "a-2", "a-2-2"]);
        assert_eq!(
            stems(&["x/map.yaml", "y/map.yaml", "x-map.map"]),
            ["x-map", "y-map", "x-map-2"]
        );
        assert_eq!(stems(&["A.map", "a.png", "/b:c\n.map"]), ["A", "a-2", "b_c_"]);
    }

    #[test]
    fn names_of_files() {
        let files = CompareFiles::of_maps(&["a.map".to_owned(), "b.map".to_owned()]);
        let expected = "report.json table.csv table.tex against_first.csv against_first.tex queries.csv a.svg a.png b.svg b.png";
        assert_eq!(files.names().join(" "), expected);
    }
}
