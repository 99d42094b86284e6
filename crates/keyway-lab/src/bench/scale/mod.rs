//! Time and memory of planners on one map, tiled to increasing sizes.
//!
//! Every planner plans on every map in a separate process, so its peak memory is its own, and its
//! memory is as fresh as at the first query of a program. The caller starts these processes: each
//! calls [`ScaleRequest::measure_here`] and returns its row.

mod error;
mod report;
mod row;
mod tiled;

pub use error::ScaleError;
pub use report::{ScaleCurve, ScaleCurves, ScaleReport, scale_table};
pub use row::ScaleRow;

use crate::progress::Progress;
use keyway::files::RobotSize;
use keyway::map::OccupancyGrid;
use keyway::navigate::Stack;
use row::measure;
use tiled::tiled;

/// Planners, and the sizes of a map on which they are measured.
#[derive(Clone, Copy, Debug)]
pub struct ScaleRequest<'a> {
    /// The map that is tiled.
    pub map: &'a OccupancyGrid,
    /// The planners, each with its layers.
    pub stacks: &'a [Stack],
    /// Sides of the square maps \[cells\].
    pub sides_cells: &'a [u32],
    /// Size of the robot. A radius that leaves no cell free is refused.
    pub size: &'a RobotSize,
}

/// One measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScaleTask {
    /// Index of the planner.
    pub planner: usize,
    /// Side of the map \[cells\].
    pub side_cells: u32,
}

impl ScaleRequest<'_> {
    /// Measures every planner on every side; `alone` executes a task in a separate process.
    ///
    /// # Errors
    /// Returns the error of `alone`, or [`ScaleError::Stopped`] if the observer stops the
    /// measurement.
    pub fn run<E: From<ScaleError>>(
        &self,
        mut alone: impl FnMut(ScaleTask) -> Result<ScaleRow, E>,
        progress: &dyn Progress,
    ) -> Result<Vec<ScaleRow>, E> {
        let planners = 0..self.stacks.len();
        let on_side =
            |&side_cells| planners.clone().map(move |planner| ScaleTask { planner, side_cells });
        let tasks: Vec<ScaleTask> = self.sides_cells.iter().flat_map(on_side).collect();
        progress.expect(tasks.len());
        let mut rows = Vec::new();
        for task in tasks {
            rows.push(alone(task)?);
            if progress.answered().is_break() {
                return Err(ScaleError::Stopped.into());
            }
        }
        Ok(rows)
    }

    /// Executes a task in this process: plans once from corner to corner of the tiled map.
    ///
    /// # Errors
    /// Returns [`ScaleError`] if the map cannot be tiled to this side, or the planner cannot be
    /// used on it. A query without a path is a result.
    pub fn measure_here(&self, task: ScaleTask) -> Result<ScaleRow, ScaleError> {
        let grid = tiled(self.map, task.side_cells)?;
        measure(self, grid, task)
    }

    /// True if every planner found a path, and all paths of optimal ones on a side cost the same.
    pub fn is_sound(&self, rows: &[ScaleRow]) -> bool {
        rows.chunks(self.stacks.len().max(1)).all(|side| {
            let both = side.iter().zip(self.stacks);
            let optimal = both.filter(|(_, stack)| stack.planner.is_optimal());
            let costs: Vec<f64> = optimal.filter_map(|(row, _)| row.cost_cells).collect();
            let are_equal = costs.iter().all(|cost| (cost - costs[0]).abs() <= 1e-9 * costs[0]);
            are_equal && side.iter().all(|row| row.cost_cells.is_some())
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::plan::PlannerConfig;
    use keyway::robot::Robot;

    fn stacks(planners: &[&str]) -> Vec<Stack> {
        let usual = Stack::for_plans(&Robot::small());
        let stack = |name| {
            let planner = PlannerConfig::by_name(name).unwrap();
            Stack { planner, ..usual.clone() }
        };
        planners.iter().map(|&name| stack(name)).collect()
    }

    #[test]
    fn every_planner_is_measured_on_every_side() {
        let (map, stacks) = (OccupancyGrid::from_ascii(&["..", ".#"]), stacks(&["astar", "jps"]));
        let size = &RobotSize::default();
        let request = ScaleRequest { map: &map, stacks: &stacks, sides_cells: &[4, 7], size };
        let rows = request.run(|task| request.measure_here(task), &()).unwrap();
        let found: Vec<(&str, u32)> =
            rows.iter().map(|row| (row.planner.as_str(), row.side_cells)).collect();
        assert_eq!(found, [("astar", 4), ("jps", 4), ("astar", 7), ("jps", 7)]);
        assert!(request.is_sound(&rows));
        let mut wrong = rows.clone();
        wrong[1].cost_cells = wrong[1].cost_cells.map(|cost| cost + 1.0);
        assert!(!request.is_sound(&wrong));
        wrong[1].cost_cells = None;
        assert!(!request.is_sound(&wrong));
    }

    #[test]
    fn errors_name_what_is_wrong() {
        let error = |map: &OccupancyGrid, radius_m, side_cells| {
            let stacks = stacks(&["astar"]);
            let size = &RobotSize::new(None, radius_m).unwrap();
            let request = ScaleRequest { map, stacks: &stacks, sides_cells: &[side_cells], size };
            request.measure_here(ScaleTask { planner: 0, side_cells }).unwrap_err()
        };
        let walled = OccupancyGrid::from_ascii(&["###", "#.#", "###"]);
        assert_eq!(error(&walled, None, 6), ScaleError::Apart);
        let unknown = OccupancyGrid::from_ascii(&["??", "??"]);
        assert_eq!(error(&unknown, None, 4), ScaleError::NoFreeCell { is_unknown_blocked: true });
        let full = OccupancyGrid::from_ascii(&["##", "##"]);
        assert_eq!(error(&full, None, 4), ScaleError::NoFreeCell { is_unknown_blocked: false });
        let wide = error(&walled, Some(3.5), 6).to_string();
        assert!(wide.starts_with("a radius of 3.5 m leaves no cell free"), "{wide}");
    }
}
