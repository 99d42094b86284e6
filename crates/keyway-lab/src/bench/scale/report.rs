//! Report of all measurements, as data, as a table, and as curves.

use super::ScaleRow;
use crate::table::{number, rows};
use keyway_sim::report::Inputs;
use serde::Serialize;

/// Report `keyway.bench.scale/1`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScaleReport {
    /// Name of the format.
    pub schema: &'static str,
    /// Version of Keyway.
    pub version: &'static str,
    /// Name of the map, such as the path of its file.
    pub map: String,
    /// [`keyway::map::formats::digest`] of the map.
    pub map_digest: String,
    /// A row for each side and planner.
    pub rows: Vec<ScaleRow>,
    /// Paths of the files that were written.
    pub files: Vec<String>,
}

/// A quantity as a function of the side of the map.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleCurves<'a> {
    /// Name of the quantity with its unit.
    pub label: &'static str,
    /// A curve for each planner.
    pub curves: Vec<ScaleCurve<'a>>,
}

/// A quantity of one planner.
#[derive(Clone, Debug, PartialEq)]
pub struct ScaleCurve<'a> {
    /// Name of the planner.
    pub planner: &'a str,
    /// Side of each map \[cells\], and the value of the quantity.
    pub points: Vec<(f64, f64)>,
}

impl ScaleReport {
    /// Reports measurements on a map, without files.
    pub fn new(map: String, map_digest: String, rows: Vec<ScaleRow>) -> Self {
        let (schema, version) = ("keyway.bench.scale/1", Inputs::VERSION);
        Self { schema, version, map, map_digest, rows, files: Vec::new() }
    }

    /// Returns the times of query and preparation, and the memory: the peak if the platform
    /// reports it for all rows, otherwise that of map and search.
    pub fn curves(&self) -> [ScaleCurves<'_>; 3] {
        let has_peak = self.rows.iter().all(|row| row.peak_resident_bytes.is_some());
        let memory_label = if has_peak { "peak memory [MB]" } else { "memory [MB]" };
        let memory_bytes =
            |row: &ScaleRow| row.peak_resident_bytes.unwrap_or(row.map_bytes + row.workspace_bytes);
        [
            self.of_planners("query [ms]", &|row| row.wall_ms),
            self.of_planners("preparation [ms]", &|row| row.preparation_ms),
            self.of_planners(memory_label, &|row| megabytes(memory_bytes(row))),
        ]
    }

    fn of_planners(
        &self,
        label: &'static str,
        value: &dyn Fn(&ScaleRow) -> f64,
    ) -> ScaleCurves<'_> {
        let mut names: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !names.contains(&row.planner.as_str()) {
                names.push(&row.planner);
            }
        }
        let curve = |planner| {
            let own = self.rows.iter().filter(|row| row.planner == planner);
            let points = own.map(|row| (f64::from(row.side_cells), value(row))).collect();
            ScaleCurve { planner, points }
        };
        ScaleCurves { label, curves: names.into_iter().map(curve).collect() }
    }
}

fn megabytes(bytes: u64) -> f64 {
    bytes as f64 / 1e6
}

/// Table of rows for the terminal.
pub fn scale_table(measured: &[ScaleRow]) -> String {
    let header = [
        "planner",
        "outcome",
        "side",
        "prep ms",
        "wall ms",
        "cpu ms",
        "expanded",
        "cost cells",
        "map MB",
        "search MB",
        "peak MB",
    ];
    let cells = |row: &ScaleRow| {
        vec![
            row.planner.clone(),
            row.outcome.text().to_owned(),
            row.side_cells.to_string(),
            number(Some(row.preparation_ms), 2),
            number(Some(row.wall_ms), 3),
            number(row.cpu_ms, 3),
            row.expanded.to_string(),
            number(row.cost_cells, 2),
            number(Some(megabytes(row.map_bytes)), 1),
            number(Some(megabytes(row.workspace_bytes)), 1),
            number(row.peak_resident_bytes.map(megabytes), 1),
        ]
    };
    rows(&header, measured.iter().map(cells).collect(), 2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::map::Cell;
    use keyway_sim::report::PlanOutcome;

    fn row(planner: &str, side_cells: u32, peak_resident_bytes: Option<u64>) -> ScaleRow {
        ScaleRow {
            planner: planner.to_owned(),
            side_cells,
            outcome: PlanOutcome::Found,
            start: Cell::new(0, 0),
            goal: Cell::new(1, 1),
            preparation_ms: 2.0,
            wall_ms: 3.0,
            cpu_ms: None,
            expanded: 4,
            generated: 5,
            cost_cells: Some(6.0),
            map_bytes: 1_000_000,
            workspace_bytes: 500_000,
            peak_resident_bytes,
        }
    }

    #[test]
    fn memory_is_the_peak_only_if_all_have_one() {
        let memory = |rows| {
            let report = ScaleReport::new("m".to_owned(), "d".to_owned(), rows);
            let [_, _, ScaleCurves { label, curves }] = report.curves();
            let points: Vec<_> = curves.into_iter().map(|curve| curve.points).collect();
            (label, points)
        };
        let peak = Some(7_000_000);
        let rows = vec![row("a", 8, peak), row("b", 8, peak), row("a", 16, peak)];
        let points = vec![vec![(8.0, 7.0), (16.0, 7.0)], vec![(8.0, 7.0)]];
        assert_eq!(memory(rows), ("peak memory [MB]", points));
        assert_eq!(memory(vec![row("a", 8, None)]), ("memory [MB]", vec![vec![(8.0, 1.5)]]));
    }
}
