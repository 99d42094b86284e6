//! Unique names of maps, since many map files are called `map.yaml`.

use std::path::{Component, Path, PathBuf};
use thiserror::Error;

/// The maps of a comparison with their names.
#[derive(Clone, Debug)]
pub(super) struct MapNames(Vec<MapName>);

#[derive(Clone, Debug)]
struct MapName {
    /// The shortest end of the path that is unique among the maps.
    name: String,
    /// Path as given.
    given: PathBuf,
    /// Absolute path, without `.` and `..`.
    whole: PathBuf,
}

/// Two paths of one map.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{} and {} are the same map; give it once", first.display(), second.display())]
pub struct SameMap {
    /// First path.
    pub first: PathBuf,
    /// Second path.
    pub second: PathBuf,
}

/// Error of a text that names several maps.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{text}` names several maps; write {}", names.join(" or "))]
pub struct AmbiguousMap {
    /// The text.
    pub text: String,
    /// Names of the maps.
    pub names: Vec<String>,
}

impl MapNames {
    /// Refuses a file that is named twice, even if it is spelled differently.
    pub(super) fn new(maps: &[PathBuf]) -> Result<Self, SameMap> {
        // The reader of maps refuses a file that does not exist.
        let files: Vec<Option<PathBuf>> = maps.iter().map(|map| map.canonicalize().ok()).collect();
        let earlier = |i: usize| files[..i].iter().position(|file| *file == files[i]);
        let twice =
            |i: usize| files[i].is_some().then(|| earlier(i)).flatten().map(|first| (first, i));
        if let Some((first, second)) = (0..maps.len()).find_map(twice) {
            return Err(SameMap { first: maps[first].clone(), second: maps[second].clone() });
        }
        let wholes: Vec<PathBuf> = maps.iter().map(|map| whole(map)).collect();
        let all = maps.iter().enumerate().map(|(i, map)| MapName {
            name: shortest_end(&wholes, i),
            given: map.clone(),
            whole: wholes[i].clone(),
        });
        Ok(Self(all.collect()))
    }

    pub(super) fn name(&self, map: usize) -> &str {
        &self.0[map].name
    }

    pub(super) fn path(&self, map: usize) -> &Path {
        &self.0[map].given
    }

    pub(super) fn all(&self) -> Vec<String> {
        self.0.iter().map(|map| map.name.clone()).collect()
    }

    /// Returns the map that a text names by its name or its path, or else by the end of its path,
    /// with the file's extension or without; `None` if it names none.
    ///
    /// # Errors
    /// Returns [`AmbiguousMap`] if the text names several maps.
    pub(super) fn named(&self, text: &str) -> Result<Option<usize>, AmbiguousMap> {
        let text = Path::new(text.strip_prefix("./").unwrap_or(text));
        // Every path ends with the empty one.
        if text.file_name().is_none() {
            return Ok(None);
        }
        let is_exactly = |map: &MapName| {
            let given = map.given.strip_prefix(".").unwrap_or(&map.given);
            given == text || Path::new(&map.name) == text || map.whole == text
        };
        if let Some(map) = self.0.iter().position(is_exactly) {
            return Ok(Some(map));
        }
        let has_end = |map: &MapName| {
            map.whole.ends_with(text) || map.whole.with_extension("").ends_with(text)
        };
        let named: Vec<usize> = (0..self.0.len()).filter(|&map| has_end(&self.0[map])).collect();
        match named[..] {
            [] => Ok(None),
            [map] => Ok(Some(map)),
            _ => {
                let names = named.iter().map(|&map| self.name(map).to_owned()).collect();
                Err(AmbiguousMap { text: text.display().to_string(), names })
            }
        }
    }
}

/// Returns the absolute path. A path with `..` becomes that of the folder in which it ends,
/// because the part before it may be a link.
fn whole(map: &Path) -> PathBuf {
    let absolute = std::path::absolute(map).unwrap_or_else(|_| map.to_owned());
    if !absolute.components().any(|part| part == Component::ParentDir) {
        return absolute;
    }
    let folder = absolute.parent().and_then(|folder| folder.canonicalize().ok());
    match (folder, absolute.file_name()) {
        (Some(folder), Some(file)) => folder.join(file),
        _ => absolute,
    }
}

/// Returns the smallest number of last components of a path that no other path ends with, joined
/// by `/`.
fn shortest_end(paths: &[PathBuf], of: usize) -> String {
    let parts = |path: &Path| -> Vec<String> {
        path.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let own = parts(&paths[of]);
    let others = (0..paths.len()).filter(|&i| i != of).map(|i| parts(&paths[i]));
    let shared = |other: Vec<String>| {
        own.iter().rev().zip(other.iter().rev()).take_while(|(a, b)| a == b).count()
    };
    let count = others.map(shared).max().unwrap_or_default() + 1;
    let end = own[own.len().saturating_sub(count)..].join("/");
    // The root is a part, too, and joined to the next one.
    end.strip_prefix("//").map_or_else(|| end.clone(), |rest| format!("/{rest}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(maps: &[&str]) -> MapNames {
        MapNames::new(&maps.iter().map(PathBuf::from).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn the_shortest_end_that_no_other_map_has() {
        for (maps, expected) in [
            (&["/a/map.yaml"][..], &["map.yaml"][..]),
            (&["/a/map.yaml", "/b/map.yaml"], &["a/map.yaml", "b/map.yaml"]),
            (&["/a/map.yaml", "/a/house.yaml"], &["map.yaml", "house.yaml"]),
            (&["/map.yaml", "/b/map.yaml"], &["/map.yaml", "b/map.yaml"]),
            (
                &["/x/a/map.yaml", "/y/a/map.yaml", "/y/b/map.yaml"],
                &["x/a/map.yaml", "y/a/map.yaml", "b/map.yaml"],
            ),
        ] {
            assert_eq!(names(maps).all(), expected);
        }
    }

    #[test]
    fn what_a_text_names() {
        let maps =
            names(&["/m/office/map.yaml", "/m/house/map.yaml", "/m/a.map", "/m/x/office.map"]);
        for (text, map) in [
            ("office/map.yaml", Ok(Some(0))),
            ("house/map", Ok(Some(1))),
            ("m/house/map.yaml", Ok(Some(1))),
            ("/m/house/map.yaml", Ok(Some(1))),
            ("./a.map", Ok(Some(2))),
            ("a", Ok(Some(2))),
            ("a.yaml", Ok(None)),
            ("b/a.map", Ok(None)),
            ("office", Ok(Some(3))),
            ("", Ok(None)),
            (
                "map.yaml",
                Err("`map.yaml` names several maps; write office/map.yaml or house/map.yaml"),
            ),
            ("map", Err("`map` names several maps; write office/map.yaml or house/map.yaml")),
        ] {
            assert_eq!(
                maps.named(text).map_err(|error| error.to_string()),
                map.map_err(str::to_owned),
                "{text}"
            );
        }
        // A path as given names its map.
        let maps = names(&["map.yaml", "house/map.yaml"]);
        assert_eq!(
            (maps.named("map.yaml"), maps.named("house/map.yaml")),
            (Ok(Some(0)), Ok(Some(1)))
        );
    }
}
