//! An experiment: methods on a family of maps, and on the paper's scene.

use super::method::{How, Method, MethodResult};
use super::planned::PlanTimes;
use super::reconstruction::Reconstruction;
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::map::formats::{ImagePlacement, parse_movingai_map};
use keyway::map::{Cell, OccupancyGrid};
use keyway::random::Random;
use keyway::search::Workspace;
use keyway_sim::episode::EpisodeError;
use keyway_sim::report::Clock;
use keyway_sim::worlds::GeneratedMap;
use serde::{Deserialize, Serialize};

/// Methods to compare, and their maps.
#[derive(Debug)]
pub struct Experiment {
    /// Name of the experiment.
    pub name: &'static str,
    /// Description of the family's maps in one sentence, for display.
    pub about: &'static str,
    /// Family of maps similar to the paper's, one map for each seed.
    pub family: GeneratedMap,
    /// Selects the maps of the right kind, if not all count. Other maps are skipped, regardless
    /// of the methods' results on them.
    pub kind: Option<fn(&OccupancyGrid, [Cell; 2]) -> bool>,
    /// Start and goal on these maps.
    pub ends: [Cell; 2],
    /// Methods to compare; for paths, the yardstick is one of them.
    pub methods: &'static [Method],
    /// Scene file of this experiment, if there is one.
    pub scene: Option<ExperimentScene>,
    /// Basis for reconstructing the paper's map, or the reason why nothing can be fitted.
    pub reconstruction: Result<&'static Reconstruction, &'static str>,
}

/// A scene of the project's repository: a map that was reconstructed by hand, or the first map that
/// fits.
#[derive(Debug)]
pub struct ExperimentScene {
    /// The scene file in the project's repository.
    pub file: &'static str,
    /// Start and goal.
    pub ends: [Cell; 2],
    /// Map of the scene, as a `MovingAI` file.
    pub(super) map: &'static str,
}

/// Results of all methods on one map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapRow {
    /// Seed of the map; `None` for the scene.
    pub seed: Option<u64>,
    /// Outcomes in the order of the methods; `None` for a method without a path, or without a route
    /// to drive.
    pub outcomes: Vec<Option<MethodResult>>,
}

/// Number of timed plans of each method; the median counts.
const ROUNDS: usize = 7;
/// Maximum number of maps of a seed that are tried for the right kind, and the key of their
/// random number stream.
const KIND_TRIES: u64 = 1000;
const KIND: u64 = 0x6b69_6e64;
/// Seed of the randomness in a run on the scene.
pub(super) const SCENE_SEED: u64 = 1;

impl Experiment {
    /// Method with which all paths are compared: optimal jump point search.
    pub const YARDSTICK: &'static str = "jps";

    /// Returns a method by its name, with its index.
    pub fn method(&self, name: &str) -> Option<(usize, &'static Method)> {
        self.methods.iter().enumerate().find(|(_, method)| method.name == name)
    }

    /// Runs all methods on the map of a seed. With a clock they take turns, and the median of their
    /// times counts.
    ///
    /// # Errors
    /// Returns [`EpisodeError`] if a parameter of the family or of a method is invalid.
    pub fn on_seed(&self, seed: u64, clock: Clock<'_>) -> Result<MapRow, EpisodeError> {
        let grid = self.map(seed)?;
        let outcomes = self.outcomes(&grid, (self.ends, seed), clock)?;
        Ok(MapRow { seed: Some(seed), outcomes })
    }

    /// Returns the map of a seed: the first of a series of maps that is of the right kind.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if a parameter of the family is invalid, or no map is of the right
    /// kind.
    pub fn map(&self, seed: u64) -> Result<OccupancyGrid, ConfigError> {
        let cell_m = self.family.resolution_m;
        let centre =
            |Cell { x, y }: Cell| Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * cell_m;
        let ends = self.ends.map(centre);
        for i in 0..KIND_TRIES {
            let seed = if i == 0 { seed } else { Random::stream(seed, &[KIND, i]).bits() };
            let grid = self.family.generate(seed, &ends)?;
            if self.kind.is_none_or(|is_meant| is_meant(&grid, self.ends)) {
                return Ok(grid);
            }
        }
        Err(ConfigError::new("family", "has no map of the kind that is meant"))
    }

    /// Runs all methods on a reconstructed map, given by its seed; `None` without a reconstruction.
    ///
    /// # Errors
    /// As for [`Self::on_seed`].
    pub fn on_reconstruction(
        &self,
        seed: u64,
        clock: Clock<'_>,
    ) -> Result<Option<MapRow>, EpisodeError> {
        let Ok(of) = self.reconstruction else { return Ok(None) };
        let outcomes = self.outcomes(&of.map(seed)?, (of.ends, seed), clock)?;
        Ok(Some(MapRow { seed: Some(seed), outcomes }))
    }

    /// Runs all methods on the scene; `None` without a scene.
    ///
    /// # Errors
    /// As for [`Self::on_seed`].
    pub fn on_scene(&self, clock: Clock<'_>) -> Result<Option<MapRow>, EpisodeError> {
        let Some(scene) = &self.scene else { return Ok(None) };
        let Some(grid) = scene.grid() else { return Ok(None) };
        let outcomes = self.outcomes(&grid, (scene.ends, SCENE_SEED), clock)?;
        Ok(Some(MapRow { seed: None, outcomes }))
    }

    fn outcomes(
        &self,
        grid: &OccupancyGrid,
        task: ([Cell; 2], u64),
        clock: Clock<'_>,
    ) -> Result<Vec<Option<MethodResult>>, EpisodeError> {
        let mut contenders: Vec<(&Method, Workspace)> =
            self.methods.iter().map(|method| (method, Workspace::default())).collect();
        let mut outcomes = Vec::new();
        for (method, workspace) in &mut contenders {
            outcomes.push(method.run(grid, task, workspace, clock)?);
        }
        if clock.is_some() {
            // The runs above only warmed up the memory.
            let mut times = vec![Vec::new(); contenders.len()];
            for _ in 0..ROUNDS {
                for ((method, workspace), times) in contenders.iter_mut().zip(&mut times) {
                    // A run has hundreds of cycles, so it needs no repetition.
                    if let How::Plan(planning) = &method.how {
                        let planned = planning.run(grid, task, workspace, clock)?;
                        times.extend(planned.and_then(|planned| planned.times));
                    }
                }
            }
            for (outcome, times) in outcomes.iter_mut().zip(times) {
                if let Some(MethodResult::Planned(planned)) = outcome {
                    planned.times = PlanTimes::medians(&times);
                }
            }
        }
        self.measure_excess(&mut outcomes);
        Ok(outcomes)
    }

    fn measure_excess(&self, outcomes: &mut [Option<MethodResult>]) {
        let Some((yardstick, _)) = self.method(Self::YARDSTICK) else { return };
        let shortest = outcomes[yardstick].as_ref().and_then(MethodResult::planned);
        let Some(shortest_m) = shortest.map(|shortest| shortest.path.length_m) else { return };
        for outcome in outcomes.iter_mut().flatten() {
            if let MethodResult::Planned(planned) = outcome {
                planned.excess =
                    (shortest_m > 0.0).then(|| planned.path.length_m / shortest_m - 1.0);
            }
        }
    }
}

impl ExperimentScene {
    /// Returns the map; `None` cannot happen, since a test reads all maps.
    pub(super) fn grid(&self) -> Option<OccupancyGrid> {
        parse_movingai_map(self.map.as_bytes(), ImagePlacement::default()).ok()
    }
}

impl MapRow {
    /// True if every method that must succeed did so.
    pub fn counts(&self, experiment: &Experiment) -> bool {
        let mut all = experiment.methods.iter().zip(&self.outcomes);
        all.all(|(method, outcome)| {
            !method.must_succeed || outcome.as_ref().is_some_and(MethodResult::succeeded)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::Claim;
    use keyway::navigate::Stack;
    use std::path::Path;
    use std::sync::atomic::{AtomicU32, Ordering};

    fn experiments() -> Vec<&'static Experiment> {
        let mut all: Vec<&Experiment> = Vec::new();
        for experiment in Claim::all().map(|claim| claim.experiment) {
            if all.iter().all(|known| known.name != experiment.name) {
                all.push(experiment);
            }
        }
        all
    }

    #[test]
    fn every_experiment_can_be_made_and_has_the_yardstick() {
        for experiment in experiments() {
            assert!(
                experiment.family.validate().is_ok() && experiment.family.obstacles.is_random()
            );
            let plans = experiment.methods.iter().any(|method| matches!(method.how, How::Plan(_)));
            let has_yardstick = experiment.method(Experiment::YARDSTICK).is_some();
            assert_eq!(plans, has_yardstick, "{}", experiment.name);
            if plans {
                let row = experiment.on_seed(1, None).unwrap();
                assert_eq!(row, experiment.on_seed(1, None).unwrap(), "{}", experiment.name);
                assert_eq!(row.outcomes.len(), experiment.methods.len());
            }
            for method in experiment.methods {
                let How::Drive(driving) = &method.how else { continue };
                assert!(Stack::published_by_name(driving.stack).is_some(), "{}", driving.stack);
                assert!(driving.unknown.as_ref().is_none_or(|unknown| unknown.validate().is_ok()));
            }
            let names: Vec<&str> = experiment.methods.iter().map(|method| method.name).collect();
            assert!((1..names.len()).all(|i| !names[i..].contains(&names[i - 1])), "{names:?}");
        }
    }

    /// Claims with the same experiment share its runs.
    #[test]
    fn experiments_of_one_name_are_one() {
        for claim in Claim::all() {
            let own = claim.experiment;
            let first = experiments().into_iter().find(|other| other.name == own.name).unwrap();
            assert!(std::ptr::eq(first, own), "{}", own.name);
        }
    }

    /// These maps equal those of the scene files, and the baselines have the published lengths on
    /// them.
    #[test]
    fn scenes_are_those_of_the_files() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        // The crate on its own has no scene files.
        if !root.join("scenes").is_dir() {
            return;
        }
        for experiment in experiments() {
            let Some(scene) = &experiment.scene else { continue };
            let text = std::fs::read_to_string(root.join(scene.file)).unwrap();
            let file: toml::Table = text.parse().unwrap();
            let folder = root.join(scene.file).parent().unwrap().to_owned();
            let map = std::fs::read_to_string(folder.join(file["map"].as_str().unwrap())).unwrap();
            assert_eq!(map, scene.map, "{}", scene.file);
            for (end, cell) in ["start", "goal"].into_iter().zip(scene.ends) {
                let place = file[end].as_array().unwrap();
                let place: Vec<f64> = place.iter().map(|x| x.as_float().unwrap()).collect();
                assert_eq!(place, [f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5]);
            }
        }
    }

    #[test]
    fn a_map_counts_when_all_find_a_path_that_need_one() {
        let experiment = experiments()[0];
        let found = experiment.on_seed(1, None).unwrap();
        assert!(found.counts(experiment));
        for i in 0..found.outcomes.len() {
            let mut row = found.clone();
            row.outcomes[i] = None;
            assert_eq!(row.counts(experiment), !experiment.methods[i].must_succeed);
        }
    }

    /// A clock that advances by one at each reading: each part takes 1 s.
    #[test]
    fn times_are_those_of_the_clock() {
        let ticks = AtomicU32::new(0);
        let clock = || f64::from(ticks.fetch_add(1, Ordering::Relaxed));
        let experiment = experiments()[0];
        let row = experiment.on_seed(1, Some(&clock)).unwrap();
        for (method, outcome) in experiment.methods.iter().zip(row.outcomes) {
            let How::Plan(planning) = &method.how else { panic!("{} drives", method.name) };
            let smoothing_s = if planning.smoother.is_some() { 1.0 } else { 0.0 };
            let times = PlanTimes { layers_s: 1.0, search_s: 1.0, smoothing_s };
            let outcome = outcome.unwrap();
            assert_eq!(outcome.planned().unwrap().times, Some(times), "{}", method.name);
        }
    }
}
