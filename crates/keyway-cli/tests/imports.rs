//! Tests of imports. A module of the library or the simulator imports earlier modules only, and
//! in no crate do two files import each other. Cargo ensures the order of the crates.
//!
//! Reads the `use` lines of the sources, and every path that begins with `crate::`, outside tests
//! and comments.
#![allow(clippy::unwrap_used)] // the lint spares tests, but not their helpers

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The modules of a crate, earlier ones first. Modules of one layer do not import each other.
type Layers = &'static [&'static [&'static str]];

/// Modules of `keyway`, which run on a robot.
const KEYWAY: Layers = &[
    &["file_error", "given", "random", "registry", "geometry"],
    &["file_system", "config_error"],
    &["robot"],
    &["map"],
    &["search"],
    &["plan"],
    &["smooth"],
    &["route"],
    &["sense"],
    &["local"],
    &["guide"],
    &["navigate"],
    &["files"],
];

/// Modules of `keyway-sim`, the simulated world.
const SIM: Layers =
    &[&["parallel", "worlds"], &["sim"], &["metrics"], &["report"], &["episode"], &["scene_files"]];

/// All crates.
const CRATES: [&str; 7] = [
    "keyway",
    "keyway-sim",
    "keyway-lab",
    "keyway-draw",
    "keyway-cli",
    "keyway-python",
    "keyway-ros",
];

/// A module's path below the crate, such as `["map", "field", "lookup"]`.
type Module = Vec<String>;

/// The text of every module of a crate without comments and tests.
fn sources(name: &str) -> BTreeMap<Module, String> {
    fn collect(folder: &Path, module: &Module, found: &mut BTreeMap<Module, String>) {
        let mut entries: Vec<PathBuf> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
        entries.sort();
        for path in entries {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            if name.ends_with("tests") {
                continue;
            }
            let mut inner = module.clone();
            if path.is_dir() {
                inner.push(name);
                collect(&path, &inner, found);
            } else {
                if !["mod", "lib"].contains(&name.as_str()) {
                    inner.push(name);
                }
                found.insert(inner, code(&fs::read_to_string(&path).unwrap()));
            }
        }
    }
    let mut found = BTreeMap::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(name).join("src");
    collect(&folder, &Vec::new(), &mut found);
    found
}

/// A source without its comments and without what follows `#[cfg(test)]`, which is at its end.
fn code(source: &str) -> String {
    let lines = source.lines().take_while(|line| *line != "#[cfg(test)]");
    let code = lines.map(|line| line.split("//").next().unwrap_or_default());
    code.collect::<Vec<_>>().join("\n")
}

/// The paths of a `use` tree: `a::{b, c::d}` gives `a::b` and `a::c::d`.
fn paths(tree: &str) -> Vec<String> {
    let Some((stem, rest)) = tree.split_once('{') else {
        return vec![tree.split(" as ").next().unwrap_or_default().trim().to_owned()];
    };
    let (inner, mut parts, mut depth, mut from) = (&rest[..rest.rfind('}').unwrap()], vec![], 0, 0);
    for (at, letter) in inner.char_indices().chain([(inner.len(), ',')]) {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(inner[from..at].trim());
                from = at + 1;
            }
            _ => {}
        }
    }
    let parts = parts.into_iter().filter(|part| !part.is_empty());
    parts.flat_map(|part| paths(&format!("{}{part}", stem.trim()))).collect()
}

/// The paths of all `use` items of a source.
fn imports(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        let visible = line.trim_start().trim_start_matches("pub");
        let item = visible.split_once(')').filter(|_| visible.starts_with('('));
        let item = item.map_or(visible, |(_, item)| item).trim_start();
        let Some(tree) = item.strip_prefix("use ") else { continue };
        let mut tree = tree.trim().to_owned();
        while !tree.ends_with(';') {
            tree.push_str(lines.next().expect("an import ends").trim());
        }
        found.extend(paths(tree.trim_end_matches(';')));
    }
    found
}

/// The modules named after `crate::`, anywhere in the code.
fn named(code: &str) -> BTreeSet<String> {
    let mut names: BTreeSet<String> = imports(code)
        .iter()
        .filter_map(|path| path.strip_prefix("crate::"))
        .map(|path| path.split("::").next().unwrap_or_default().to_owned())
        .collect();
    for rest in code.split("crate::").skip(1) {
        let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        names.insert(rest[..end].to_owned());
    }
    names
}

#[test]
fn no_layer_knows_a_later_one() {
    for (name, layers, imports) in [("keyway", KEYWAY, 200), ("keyway-sim", SIM, 20)] {
        let layer = |name: &str| layers.iter().position(|names| names.contains(&name));
        let (mut looked_at, mut wrong) = (0, Vec::new());
        for (module, code) in sources(name) {
            let Some(own) = module.first() else { continue };
            let own_layer = layer(own).unwrap_or_else(|| panic!("{own} is in none of the layers"));
            for name in named(&code).iter().filter(|name| *name != own) {
                // Names that are not modules, such as `crate::ConfigError`, come from early files.
                let Some(known) = layer(name) else { continue };
                looked_at += 1;
                if known >= own_layer {
                    wrong.push(format!("{} knows {name}", module.join("::")));
                }
            }
        }
        assert!(looked_at > imports, "{name}: {looked_at} imports");
        assert!(wrong.is_empty(), "{name}: {wrong:#?}");
    }
}

/// The module that defines an import, following `pub use` of modules.
fn origin(from: &Module, path: &str, modules: &BTreeMap<Module, String>) -> Option<Module> {
    let mut names = path.split("::").peekable();
    let mut base = match *names.peek()? {
        "crate" => Vec::new(),
        "super" => from.clone(),
        _ => return None,
    };
    while let Some(&name) = names.peek() {
        match name {
            "crate" => {}
            "super" => drop(base.pop()),
            name => {
                let mut inner = base.clone();
                inner.push(name.to_owned());
                if !modules.contains_key(&inner) {
                    return Some(reexported(&base, name, modules).unwrap_or(base));
                }
                base = inner;
            }
        }
        names.next();
    }
    Some(base)
}

/// The module below `module` from which it re-exports a name.
fn reexported(module: &Module, name: &str, modules: &BTreeMap<Module, String>) -> Option<Module> {
    imports(&modules[module]).iter().find_map(|path| {
        let (stem, last) = path.rsplit_once("::")?;
        let mut inner = module.clone();
        inner.extend(stem.split("::").map(str::to_owned));
        (last == name && modules.contains_key(&inner))
            .then(|| reexported(&inner, name, modules).unwrap_or(inner))
    })
}

#[test]
fn no_two_files_import_each_other() {
    let circles: Vec<String> = CRATES.into_iter().flat_map(circles).collect();
    assert!(circles.is_empty(), "{circles:#?}");
}

/// The pairs of files of a crate that import each other.
fn circles(name: &str) -> Vec<String> {
    let modules = sources(name);
    let mut edges = BTreeSet::new();
    for (module, code) in &modules {
        for path in imports(code) {
            if let Some(to) = origin(module, &path, &modules).filter(|to| to != module) {
                edges.insert((module.clone(), to));
            }
        }
    }
    assert!(edges.len() > 20, "{name}: {} edges", edges.len());
    // A module and the files in its folder count as one.
    let is_below = |a: &Module, b: &Module| a.starts_with(b) || b.starts_with(a);
    edges
        .iter()
        .filter(|(a, b)| a < b && !is_below(a, b) && edges.contains(&(b.clone(), a.clone())))
        .map(|(a, b)| format!("{name}: {} and {}", a.join("::"), b.join("::")))
        .collect()
}

#[test]
fn imports_are_read() {
    let code = code(
        "use super::a::{B, c::{D, E as F}};\npub use crate::plan::G; // use crate::no\nfn f() {\n    \
         crate::map::h();\n}\n#[cfg(test)]\nuse crate::tests::I;\n",
    );
    let all = ["super::a::B", "super::a::c::D", "super::a::c::E", "crate::plan::G"];
    assert_eq!(imports(&code), all);
    assert_eq!(named(&code).into_iter().collect::<Vec<_>>(), ["map", "plan"]);
}
