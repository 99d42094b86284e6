//! Definitions of the terms in tables, shown below the tables and in the help of their commands.

/// Columns of `keyway compare`.
pub(crate) const COMPARE_TERMS: &str = "\
Columns (means are over the compared queries: those that every planner solved, except planners that solved none;
below a mean: 5th to 95th percentile of the queries):
  solved      queries for which the planner found a path
  length      length of the smoothed path
  excess      by how much it is longer than the shortest line around all blocked cells; a smoothed path keeps
              its clearance from the obstacles, not from blocked cells, and can be slightly shorter
  turns       points at which the heading changes; on a curve, each stretch that bends to one side
  non-smooth  heading jumps: each turn of a polyline; on a curve, changes of more than 5 degrees within 1 cm
  clearance   smallest distance from a path to an obstacle
  shortfalls  paths with less clearance than requested (omitted if there are none): lines of theta-star and
              lazy-theta-star keep up to half a cell's diagonal less, and smoothers then keep as much as they do
  plan        median time of a query
  smooth      median time to smooth its path; empty for the smoother `none`, which leaves the path unchanged
Each row against the first one, on the same queries:
  equal       queries on which both paths have the same length
  difference  length difference to the first row: Hodges-Lehmann median and 95 % confidence interval
  effect      rank-biserial correlation, from -1 (every path that differs is shorter) to 1 (longer)
  p           probability of such differences by chance: of lengths by Wilcoxon's signed-rank test, of solved
              queries by McNemar's exact test, both corrected for the number of rows by Holm's method
CSV and JSON have more columns: `--out DIR`, `--format json`; `--columns` selects those of LaTeX.";

/// Columns of `keyway bench grid`.
pub(crate) const GRID_TERMS: &str = "\
Columns (below a mean: 5th to 95th percentile of the queries):
  solved      queries answered with a path, out of all
  mismatches  answers that contradict the scenario file: a path longer than the shortest one (for
              planners that guarantee shortest paths), a path shorter than possible, or a wrong
              answer to the question whether a path exists
  illegal     paths through an obstacle, across a corner that must not be cut, or with a wrong start or goal
  missed      queries for which the planner reports that it missed an existing path
  median, p99 wall-clock time of a query; cpu: mean CPU time of its thread
  expanded    nodes taken from the open list, mean over the queries
  excess      by how much paths are longer than shortest ones, mean over the queries
  prep        time to prepare the map; MB: memory of map layers and search";

/// Columns of `keyway bench scale`.
pub(crate) const SCALE_TERMS: &str = "\
Columns (each row is one query):
  prep        time to derive the map's layers and components; wall, cpu: times of the query
  expanded    nodes taken from the open list
  map         memory of the map's layers and components
  search      memory reserved by the search; for jps, memory used
  peak        peak memory of the process; it can be less than the memory reserved by the search, as reserved
              memory that is never touched does not count";

/// Rows of `keyway plan`.
pub(crate) const PLAN_TERMS: &str = "\
Terms:
  expanded    nodes taken from the open list; generated: nodes put there, or improved there
  turns       points at which the heading changes; on a curve, each stretch that bends to one side
  not smooth  heading jumps: each turn of a polyline; on a curve, changes of more than 5 degrees within 1 cm
  excess      by how much the path costs more than a cheapest path of straight and diagonal steps";
