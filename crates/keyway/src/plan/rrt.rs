//! Rapidly-exploring random tree \[LaValle1998\]: a map, two cells and a seed -> some path in any
//! direction.
//!
//! A tree grows from the start. For each random sample, the tree's nearest node grows one step
//! towards it; as large unexplored regions catch most samples, the tree spreads into them. The
//! search ends when a new node can be joined to the goal. The path has many turns and is far from
//! shortest; here it is a baseline. The same seed gives the same path on every machine.
//!
//! # Source
//! \[LaValle1998\]: section 2. The occasional use of the goal as a sample: \[LaValle2001\].
//!
//! | paper | here | unit |
//! |---|---|---|
//! | K | [`RrtConfig::samples`] | |
//! | `x_init`, `x_rand`, `x_near`, `x_new` | start, `sample`, `near`, `to` | cells |
//! | `RANDOM_STATE` | [`Sampler::draw`] | |
//! | `NEAREST_NEIGHBOR` | the exact nearest node, the oldest one in a tie | |
//! | u, Δt; `SELECT_INPUT`, `NEW_STATE` | straight ahead, [`RrtConfig::step_m`]; [`cell_towards`] | m |
//!
//! # Where this differs from the paper
//! - Nodes are the centres of cells: a sample is any cell of the map, all equally likely, blocked
//!   ones included, and a step ends in the cell whose centre is nearest to the exact end point.
//!   Steps are whole numbers of cells, at least one, so they may be up to 0.71 cells longer or
//!   shorter than requested.
//! - A line is free under the same corner rule as a diagonal step. A step is skipped if it is not
//!   free, or if its cell is already in the tree.
//! - The paper gives no stop condition: here, the search stops when a new node sees the goal and
//!   is within one step of it.
//! - Collinear waypoints are dropped from the result.
//! - In the statistics, the expanded nodes are the samples drawn, which a budget counts, and the
//!   generated ones are the nodes of the tree. An observer is told of the nearest node of each
//!   sample, every time, and of each new node.
//!
//! # Errors / cost
//! See [`PlanError`]; the method may miss a path: [`super::Miss::SamplesUsedUp`]. With a step of
//! one cell, every reachable cell is joined eventually; with longer steps a narrow passage may
//! never be passed. Maps with penalised cells are refused. About O(log n) per sample in a tree of
//! n nodes; 4.4 bytes per cell of the map and 32 for each node, of which only those of the tree
//! are touched.

mod cell_tree;
mod nearest_node;

use super::any_angle::{keep_turns, length};
use super::best_first::check_budget;
use super::parameters::{BoxedPlanner, PlannerParameters};
use super::{GlobalPlanner, Miss, Plan, PlanError, Stop};
use crate::ConfigError;
use crate::map::{Cell, Connectivity, SearchMap};
use crate::random::Random;
use crate::search::{
    CornerRule, Euclidean, Metric, Observer, Query, SearchStatistics, Side, SideStatistics, Sight,
    Workspace, cells,
};
use cell_tree::{CellTree, TreeNode};
use serde::{Deserialize, Serialize};

/// Parameters of [`Rrt`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(default, deny_unknown_fields)]
pub struct RrtConfig {
    /// Lines that pass between two cells touching at a corner, one of which is blocked: `forbid`
    /// or `allow`.
    pub corners: CornerRule,
    /// The length of a growth step, rounded to whole cells, at least one \[m\].
    pub step_m: f64,
    /// The probability that a sample is the goal, from 0 to 1.
    pub goal_bias: f64,
    /// The maximum number of samples.
    pub samples: u64,
    /// Seed of the random numbers: the same seed gives the same path.
    pub seed: u64,
}

impl Default for RrtConfig {
    fn default() -> Self {
        Self {
            corners: CornerRule::Forbid,
            step_m: 1.0,
            goal_bias: 0.05,
            samples: 1_000_000,
            seed: 0,
        }
    }
}

/// Rapidly-exploring random tree: a path from a seed.
#[derive(Clone, Debug, Default)]
pub struct Rrt {
    config: RrtConfig,
}

impl Rrt {
    /// Name on the command line and in reports.
    pub const NAME: &'static str = "rrt";

    /// Creates a planner with these parameters.
    ///
    /// # Errors
    /// Returns an error if a parameter is out of its range; the error names it.
    pub fn new(config: RrtConfig) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self { config })
    }

    /// Grows a tree from the start until it reaches the goal; returns the goal's node.
    fn run(
        &self,
        map: &SearchMap,
        query: &Query,
        tree: &mut CellTree,
        seen: &mut impl Observer,
    ) -> Result<(TreeNode, SearchStatistics), PlanError> {
        let RrtConfig { corners, samples, .. } = self.config;
        let step_cells = step_cells(self.config.step_m, map.frame().resolution_m());
        let mut growth = Growth { tree, sight: Sight::new(map, corners), step_cells, seen };
        let mut sampler = Sampler::new(&self.config, map, query.goal);
        // No cell is in the tree twice, and there is at most one node per sample besides start and
        // goal.
        let most = samples.saturating_add(2).min(map.index_count() as u64);
        let mut newest = Some(growth.tree.start(map, query.start, most as usize));
        let mut expanded = 0;
        loop {
            let joined = newest.and_then(|node| growth.join(node, query.goal));
            let generated = growth.tree.len() as u64;
            let statistics = SearchStatistics::one_sided(SideStatistics { expanded, generated });
            if let Some(goal) = joined {
                return Ok((goal, statistics));
            }
            if expanded == samples {
                let miss = Miss::SamplesUsedUp { samples };
                return Err(PlanError::Missed { planner: Self::NAME, miss, statistics });
            }
            check_budget(query, statistics)?;
            expanded += 1;
            newest = growth.extend(sampler.draw());
        }
    }
}

/// The length of a step in whole cells, at least one.
fn step_cells(step_m: f64, resolution_m: f64) -> u32 {
    // A step longer than any map is equivalent to one of its size, so the value is clamped.
    (step_m / resolution_m + 0.5).clamp(1.0, f64::from(i32::MAX)) as u32
}

/// Draws samples: the goal with probability `goal_bias`, otherwise any cell of the map.
struct Sampler {
    random: Random,
    goal: Cell,
    goal_bias: f64,
    width: u32,
    height: u32,
}

impl Sampler {
    fn new(config: &RrtConfig, map: &SearchMap, goal: Cell) -> Self {
        Self {
            random: Random::new(config.seed),
            goal,
            goal_bias: config.goal_bias,
            width: map.frame().width(),
            height: map.frame().height(),
        }
    }

    fn draw(&mut self) -> Cell {
        if self.random.is_chosen(self.goal_bias) {
            return self.goal;
        }
        let x = self.random.below(self.width);
        Cell::new(x as i32, self.random.below(self.height) as i32)
    }
}

/// The growth of a tree.
struct Growth<'a, O> {
    tree: &'a mut CellTree,
    sight: Sight<'a>,
    step_cells: u32,
    seen: &'a mut O,
}

impl<O: Observer> Growth<'_, O> {
    /// Grows one step from the nearest node towards a sample, unless the step is blocked.
    fn extend(&mut self, sample: Cell) -> Option<TreeNode> {
        let near = self.tree.nearest(sample)?;
        if self.seen.is_watching() {
            self.seen.expanded(Side::Forward, near.cell, cells(near.g));
        }
        let to = cell_towards(near.cell, sample, self.step_cells);
        let grows = !self.tree.contains(to) && self.sight.is_free(near.cell, to);
        grows.then(|| self.add(to, near))
    }

    /// The goal's node, if the goal is within one step of this node and in its line of sight.
    fn join(&mut self, node: TreeNode, goal: Cell) -> Option<TreeNode> {
        if node.cell == goal {
            return Some(node);
        }
        let is_near = distance_sq(node.cell, goal) <= u64::from(self.step_cells).pow(2);
        let joins = is_near && self.sight.is_free(node.cell, goal);
        joins.then(|| self.add(goal, node))
    }

    fn add(&mut self, cell: Cell, parent: TreeNode) -> TreeNode {
        let (from, to) = (parent.cell, cell);
        let length = Euclidean.length(from.x.abs_diff(to.x), from.y.abs_diff(to.y));
        let node = self.tree.add(cell, parent, length);
        if self.seen.is_watching() {
            self.seen.generated(Side::Forward, cell, parent.cell, cells(node.g));
            self.seen.linked(Side::Forward, cell, parent.cell);
        }
        node
    }
}

/// The cell whose centre is nearest to the point on the line from `from` to `to` at the distance
/// of a step (half-way: the farther one); `to` itself if it is within a step.
fn cell_towards(from: Cell, to: Cell, step_cells: u32) -> Cell {
    let distance_sq = u128::from(distance_sq(from, to));
    let step_sq = u128::from(step_cells).pow(2);
    if distance_sq <= step_sq {
        return to;
    }
    // round(step |d| / distance) is the largest n with 2n - 1 <= sqrt(4 step^2 d^2 / distance^2).
    let along = |from: i32, to: i32| {
        let d_sq = u128::from(from.abs_diff(to)).pow(2);
        let cells = ((4 * step_sq * d_sq / distance_sq).isqrt() as u32).div_ceil(2);
        if to >= from {
            from.wrapping_add_unsigned(cells)
        } else {
            from.wrapping_sub_unsigned(cells)
        }
    };
    Cell::new(along(from.x, to.x), along(from.y, to.y))
}

/// The square of the distance between the centres of two cells.
fn distance_sq(a: Cell, b: Cell) -> u64 {
    u64::from(a.x.abs_diff(b.x)).pow(2) + u64::from(a.y.abs_diff(b.y)).pow(2)
}

impl PlannerParameters for RrtConfig {
    fn check(&self) -> Result<(), ConfigError> {
        let RrtConfig { step_m, goal_bias, samples, .. } = *self;
        ConfigError::unless_positive("step_m", step_m)?;
        if !(0.0..=1.0).contains(&goal_bias) {
            return Err(ConfigError::must_be("goal_bias", "from 0 to 1", goal_bias));
        }
        if samples == 0 {
            return Err(ConfigError::must_be("samples", "at least 1", 0.0));
        }
        Ok(())
    }

    fn build(&self, _: &SearchMap) -> Result<BoxedPlanner, PlanError> {
        Ok(Box::new(Rrt::new(self.clone())?))
    }
}

impl GlobalPlanner for Rrt {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn connectivity(&self) -> Connectivity {
        self.config.corners.connectivity()
    }

    fn is_any_angle(&self) -> bool {
        true
    }

    fn needs_uniform_cost(&self) -> bool {
        true
    }

    fn search_into(
        &self,
        map: &SearchMap,
        query: &Query,
        workspace: &mut Workspace,
        seen: Option<&mut dyn Observer>,
        plan: &mut Plan,
    ) -> Result<(), PlanError> {
        let tree = workspace.part::<CellTree>();
        let (goal, statistics) = match seen {
            None => self.run(map, query, tree, &mut ()),
            Some(mut seen) => self.run(map, query, tree, &mut seen),
        }?;
        tree.path_into(goal, &mut plan.cells);
        keep_turns(&mut plan.cells);
        plan.cost = length(&plan.cells);
        plan.statistics = statistics;
        plan.stop = Some(Stop::GoalJoined);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::{LayerConfig, OccupancyGrid};

    fn ask(rows: &[&str], ends: [(i32, i32); 2], config: RrtConfig) -> Result<Plan, PlanError> {
        let map = SearchMap::new(&OccupancyGrid::from_ascii(rows), LayerConfig::default()).unwrap();
        let [start, goal] = ends.map(|(x, y)| Cell::new(x, y));
        let mut plan = Plan::default();
        Rrt::new(config)?
            .plan_into(&map, &Query::new(start, goal), &mut Workspace::default(), None, &mut plan)
            .map(|()| plan)
    }

    fn only_the_goal() -> RrtConfig {
        RrtConfig { goal_bias: 1.0, samples: 100, ..RrtConfig::default() }
    }

    fn cells_of(plan: &Plan) -> Vec<(i32, i32)> {
        plan.cells.iter().map(|cell| (cell.x, cell.y)).collect()
    }

    #[test]
    fn steps_in_whole_cells() {
        assert_eq!(step_cells(1.0, 1.0), 1);
        assert_eq!(step_cells(1.0, 0.4), 3);
        assert_eq!(step_cells(0.1, 1.0), 1);
        assert_eq!(step_cells(1e30, 0.05), i32::MAX as u32);
    }

    #[test]
    fn one_step_towards_a_sample_by_hand() {
        let towards = |to: (i32, i32), step| {
            let cell = cell_towards(Cell::new(0, 0), Cell::new(to.0, to.1), step);
            (cell.x, cell.y)
        };
        // The whole distance, as it is 5 cells long.
        assert_eq!(towards((3, -4), 5), (3, -4));
        // A tenth of it.
        assert_eq!(towards((30, -40), 5), (3, -4));
        // (0.71, 0.71), (0.96, 0.29), (-0.2, -9.998).
        assert_eq!(towards((10, 10), 1), (1, 1));
        assert_eq!(towards((10, 3), 1), (1, 0));
        assert_eq!(towards((-2, -100), 10), (0, -10));
        let far = cell_towards(Cell::new(i32::MAX, 0), Cell::new(0, i32::MAX), i32::MAX as u32);
        // A step of r cells along the diagonal: r / sqrt(2) = 1,518,500,249.3 each way.
        assert_eq!((i32::MAX - far.x, far.y), (1_518_500_249, 1_518_500_249));
    }

    #[test]
    fn straight_to_the_goal_by_hand() {
        // Nine samples at (10, 0) add (1, 0) to (9, 0), which is one step from the goal.
        let plan = ask(&["..........."], [(0, 0), (10, 0)], only_the_goal()).unwrap();
        assert_eq!(cells_of(&plan), [(0, 0), (10, 0)]);
        assert_eq!(plan.cost, crate::plan::PlanCost::Length(10.0));
        assert_eq!((plan.statistics.expanded(), plan.statistics.generated()), (9, 11));
        assert_eq!(plan.stop, Some(Stop::GoalJoined));
        // With steps of 4: (4, 0), then (8, 0), which is near enough.
        let config = RrtConfig { step_m: 4.0, ..only_the_goal() };
        let plan = ask(&["..........."], [(0, 0), (10, 0)], config).unwrap();
        assert_eq!((plan.statistics.expanded(), plan.statistics.generated()), (2, 4));
        // The start may be near enough itself.
        let plan = ask(&["..", ".."], [(0, 0), (0, 1)], only_the_goal()).unwrap();
        assert_eq!((plan.statistics.expanded(), plan.statistics.generated()), (0, 2));
    }

    #[test]
    fn a_wall_stops_a_tree_that_only_wants_the_goal() {
        let rows = ["...", ".#.", ".#."];
        let error = ask(&rows, [(0, 0), (2, 0)], only_the_goal()).unwrap_err();
        let statistics =
            SearchStatistics::one_sided(SideStatistics { expanded: 100, generated: 1 });
        let miss = Miss::SamplesUsedUp { samples: 100 };
        assert_eq!(error, PlanError::Missed { planner: "rrt", miss, statistics });
        // Random samples find a path around it.
        assert!(ask(&rows, [(0, 0), (2, 0)], RrtConfig::default()).is_ok());
    }

    /// A long corridor, one cell wide, which a few samples cannot pass.
    #[test]
    fn few_samples_miss_a_winding_corridor() {
        let rows = ["...........", "##########.", "...........", ".##########", "..........."];
        let config = |samples| RrtConfig { samples, ..RrtConfig::default() };
        let error = ask(&rows, [(0, 0), (0, 4)], config(30)).unwrap_err();
        assert!(matches!(
            error,
            PlanError::Missed { miss: Miss::SamplesUsedUp { samples: 30 }, .. }
        ));
        let plan = ask(&rows, [(0, 0), (0, 4)], config(100_000)).unwrap();
        // Corners are not cut: 2 rows up, 10 columns along, 2 rows up, 10 columns back.
        assert_eq!(plan.cost, crate::plan::PlanCost::Length(24.0));
    }

    #[test]
    fn parameters_out_of_range() {
        let field = |config| Rrt::new(config).unwrap_err().path;
        let default = RrtConfig::default;
        for step_m in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(field(RrtConfig { step_m, ..default() }), "step_m");
        }
        for goal_bias in [-0.1, 1.1, f64::NAN] {
            assert_eq!(field(RrtConfig { goal_bias, ..default() }), "goal_bias");
        }
        assert_eq!(field(RrtConfig { samples: 0, ..default() }), "samples");
    }

    /// The paths of two seeds, which are the same on every machine.
    #[test]
    fn a_seed_is_a_path() {
        let rows = ["........", "..####..", "........"];
        let path = |seed| {
            let config = RrtConfig { seed, ..RrtConfig::default() };
            cells_of(&ask(&rows, [(0, 0), (7, 2)], config).unwrap())
        };
        assert_eq!(path(0), [(0, 0), (6, 0), (6, 1), (7, 2)]);
        assert_eq!(path(1), [(0, 0), (6, 0), (6, 1), (7, 1), (7, 2)]);
    }
}
