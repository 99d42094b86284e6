//! The scenes of the papers with random obstacles: their maps, and the obstacles that are not on
//! the map. The papers print pictures and lengths of paths, but no map; each map here is the
//! first in a series of seeded ones on which the papers' baselines have the published lengths.
//! See `scenes/README.md`.
//!
//! `cargo run --release -p keyway-lab --example paper_scenes -- scenes`
//! regenerates the files in `scenes/`, byte for byte.

mod clutter;
mod fit;
#[path = "../support/random.rs"]
mod random;
mod unknown;

use clutter::Clutter;
use fit::{Baseline, first_fit};
use keyway::map::formats::movingai_map_from_grid;
use keyway::map::{Cell, OccupancyGrid};
use keyway::plan::{AStar, AStarConfig, BidirectionalAStar};
use keyway::search::{CornerRule, Cost, Query};
use std::error::Error;
use std::path::Path;
use unknown::{random_cells, scene};

/// Numbers of unknown obstacles in the scenes of \[S1\].
const UNKNOWN: [usize; 5] = [0, 5, 10, 20, 40];

/// A file, relative to the folder of the scenes, and its content.
struct File {
    path: String,
    text: String,
}

impl File {
    fn map(path: &str, grid: &OccupancyGrid) -> Self {
        Self { path: path.to_owned(), text: movingai_map_from_grid(grid) }
    }
}

/// Query from the lower left to the upper right cell of a square map.
fn across(side: i32) -> Query {
    Query::new(Cell::new(0, 0), Cell::new(side - 1, side - 1))
}

/// \[You2021\], table 4: A* and bidirectional A* on one map, corners not cut.
fn you2021() -> Result<Vec<File>, Box<dyn Error>> {
    let clutter = Clutter { side: 20, percent: 20 };
    let query = across(clutter.side);
    let astar = Baseline::new(AStar::default(), query, Cost::new(8, 15));
    let both = Baseline::new(BidirectionalAStar::default(), query, Cost::new(4, 19));
    let (seed, grid) = first_fit(clutter, &[astar, both])?;
    println!("you2021/clutter.map: seed {seed}");
    Ok(vec![File::map("you2021/clutter.map", &grid)])
}

/// \[S1\], tables 1 and 3: A* that cuts corners, from two starts on one map. A robot must be able
/// to pass without cutting any.
fn s1() -> Result<Vec<File>, Box<dyn Error>> {
    let clutter = Clutter { side: 30, percent: 15 };
    let query = across(clutter.side);
    let cutting = || {
        let config = AStarConfig { corners: CornerRule::Allow, ..AStarConfig::default() };
        AStar::new(config)
    };
    let table_3 = Baseline::new(cutting(), query, Cost::new(6, 26));
    let from_1_1 = Query::new(Cell::new(1, 1), query.goal);
    let table_1 = Baseline::new(cutting(), from_1_1, Cost::new(6, 25));
    let (seed, grid) = first_fit(clutter, &[table_3, table_1, Baseline::any_length(query)])?;
    println!("s1/clutter.map: seed {seed}");
    let mut files = vec![File::map("s1/clutter.map", &grid)];

    let cells = random_cells(&grid, &query, UNKNOWN[UNKNOWN.len() - 1])?;
    for count in UNKNOWN {
        let text = scene(grid.frame(), &query, &cells[..count])?;
        files.push(File { path: format!("s1/random_{count:02}.toml"), text });
    }

    let sparse = Clutter { side: 30, percent: 6 };
    let (seed, grid) = first_fit(sparse, &[Baseline::any_length(query)])?;
    println!("s1/scattered.map: seed {seed}");
    files.push(File::map("s1/scattered.map", &grid));
    Ok(files)
}

fn files() -> Result<Vec<File>, Box<dyn Error>> {
    Ok(you2021()?.into_iter().chain(s1()?).collect())
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("expected the folder of the scenes: `scenes`")?;
    for File { path, text } in files()? {
        std::fs::write(Path::new(&folder).join(&path), text)?;
        println!("wrote {path}");
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_of_the_repository_are_what_this_program_writes() -> Result<(), Box<dyn Error>> {
        let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        for File { path, text } in files()? {
            assert_eq!(std::fs::read_to_string(scenes.join(&path))?, text, "{path}");
        }
        Ok(())
    }
}
