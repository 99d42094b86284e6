//! Definitions of the terms in tables, shown below the tables and in the help of their commands.

/// Columns of `keyway compare`.
pub(crate) const COMPARE_TERMS: &str = "\
Columns (means are over the compared queries, those solved by every planner that solved any at all; below a
mean: between what the queries lie, without the lowest and the highest 5 %):
  solved      queries for which the planner found a path
  length      length of the smoothed path
  excess      how much longer it is than the shortest line around all blocked cells; a smoothed path keeps
              its distance from the obstacles themselves and may be a little shorter
  turns       points at which the heading changes; of a curve, each stretch that bends to one side
  non-smooth  heading jumps: each turn of a line, on a curve changes of more than 5 degrees within 1 cm
  clearance   the least distance from a path to an obstacle
  shortfalls  paths that keep less distance than was asked for (left out where there are none)
  plan        median time of a query
  smooth      median time of smoothing its path; none for the smoother `none`, which leaves it as it is
Each row against the first one, on the same queries:
  equal       queries on which both paths have the same length
  difference  of the lengths, this less the first: median, and between what it lies with 95 % confidence
  effect      from -1, this path is always shorter, to 1, always longer (rank-biserial correlation)
  p           how likely such differences would be by chance: of lengths by Wilcoxon's signed-rank test, of
              solved queries by McNemar's exact test, both corrected for several rows by Holm's method
CSV, LaTeX and JSON have more columns: `--out DIR`, `--format json`.";

/// Columns of `keyway bench grid`.
pub(crate) const GRID_TERMS: &str = "\
Columns (below a mean: between what the queries lie, without the lowest and the highest 5 %):
  solved      queries answered with a path, out of all
  mismatches  answers that contradict the scenario file: a path longer than the shortest one (for
              planners that promise shortest ones), one shorter than possible, or a wrong answer
              about whether there is one
  illegal     paths through an obstacle or around a corner that may not be cut, or with wrong ends
  missed      queries for which the planner says that there is a path that it did not find
  median, p99 wall clock of a query; cpu: mean of its thread's CPU time
  expanded    nodes taken from the open list, mean over the queries
  excess      how much longer paths are than the shortest ones, mean over the queries
  prep        time of preparing the map; MB: memory of map layers and search";

/// Columns of `keyway bench scale`.
pub(crate) const SCALE_TERMS: &str = "\
Columns (each row is one query):
  prep        time of deriving the map's layers and its components; wall, cpu: of the query
  expanded    nodes taken from the open list
  map         memory of the map's layers and components
  search      memory that the search reserved; jps counts only what it used
  peak        the most memory of the process in use at once; it may be less than what the search reserved, as
              memory that is reserved and never touched is not in use";

/// Rows of `keyway plan`.
pub(crate) const PLAN_TERMS: &str = "\
Terms:
  expanded    nodes taken from the open list; generated: nodes put there, or improved there
  turns       points at which the heading changes; of a curve, each stretch that bends to one side
  not smooth  heading jumps: each turn of a line, on a curve changes of more than 5 degrees within 1 cm
  excess      how much more the path costs than the cheapest one of straight and diagonal steps";
