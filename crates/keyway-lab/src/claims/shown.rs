//! Contents of the pictures of an experiment: paths, searches and runs on one map.

use super::clutter_speeds::Part;
use super::driven::Keeper;
use super::experiment::{Experiment, SCENE_SEED};
use super::method::How;
use keyway::geometry::{Disc, Point, Polyline};
use keyway::map::{Cell, OccupancyGrid};
use keyway::search::Recording;
use keyway_sim::episode::{Episode, EpisodeError};
use keyway_sim::sim::{MovingObstacle, Run};

/// Content of a picture for a method.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The planned path, or the driven path, as far as it went.
    pub line: Polyline,
    /// Recording of the search; `None` for a run.
    pub search: Option<Recording>,
    /// The run; `None` for a path.
    pub run: Option<Run>,
    /// For each sample of a run, true if it belongs to the part over which the mean speed is
    /// taken; `None` if that is the whole run.
    pub part: Option<Vec<bool>>,
    /// Static obstacles that are not on the map.
    pub obstacles: Vec<Disc>,
    /// Moving obstacles.
    pub movers: Vec<MovingObstacle>,
}

/// A map with its start and goal, and the results of every method on it.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The map.
    pub map: OccupancyGrid,
    /// Start and goal \[m\].
    pub ends: [Point; 2],
    /// Results in the order of the methods; `None` for a method without a path, or without a route
    /// to drive.
    pub shown: Vec<Option<Shown>>,
}

impl Experiment {
    /// Returns the results of all methods on the map of a seed or, without a seed, on the scene;
    /// `None` without a scene.
    ///
    /// # Errors
    /// As for [`Self::on_seed`].
    pub fn place(&self, seed: Option<u64>) -> Result<Option<Place>, EpisodeError> {
        match (seed, &self.scene) {
            (Some(seed), _) => self.shown_on(self.map(seed)?, (self.ends, seed)).map(Some),
            (None, Some(scene)) => {
                let map = scene.grid();
                map.map(|map| self.shown_on(map, (scene.ends, SCENE_SEED))).transpose()
            }
            (None, None) => Ok(None),
        }
    }

    fn shown_on(
        &self,
        map: OccupancyGrid,
        (ends, seed): ([Cell; 2], u64),
    ) -> Result<Place, EpisodeError> {
        let mut shown = Vec::new();
        for method in self.methods {
            shown.push(match &method.how {
                How::Plan(planning) => planning.shown(&map, (ends, seed))?,
                How::Drive(driving) => {
                    let mut run = Keeper::default();
                    let watched = driving.watch(&map, (ends, seed), None, &mut run)?;
                    let both = watched.zip(run.0);
                    both.map(|((episode, _), run)| Shown::of_run(driving.part, run, episode))
                }
            });
        }
        let ends = ends.map(|end| map.frame().world_from_cell(end));
        Ok(Place { map, ends, shown })
    }
}

impl Shown {
    fn of_run(part: Part, run: Run, episode: Episode) -> Self {
        let places = run.samples.iter().map(|sample| sample.pose.point());
        let line = Polyline::new(places.collect());
        let part = (part != Part::Whole).then(|| part.samples(&run, &episode));
        let Episode { obstacles, movers, .. } = episode;
        Self { line, search: None, run: Some(run), part, obstacles, movers }
    }
}

#[cfg(test)]
mod tests {
    use crate::claims::{Claim, Measure};

    /// The shown lines are the measured ones.
    #[test]
    fn what_is_shown_is_what_is_measured() {
        for id in ["S0-1", "S0-3"] {
            let experiment = Claim::named(id)[0].experiment;
            let row = experiment.on_seed(3, None).unwrap();
            let place = experiment.place(Some(3)).unwrap().unwrap();
            for (outcome, shown) in row.outcomes.iter().zip(&place.shown) {
                let shown = shown.as_ref().unwrap();
                let length_m = Measure::WayLength.of(outcome.as_ref());
                let is_same = |length_m: f64| (shown.line.length_m() - length_m).abs() < 1e-2;
                assert!(length_m.is_none_or(is_same), "{length_m:?}");
                assert_eq!(shown.search.is_some(), id == "S0-1");
            }
        }
        // Each of the two parts has its own samples; which one is slower is measured.
        let of_parts = Claim::named("S0-7")[0].experiment;
        let row = of_parts.on_seed(1, None).unwrap();
        let shown = of_parts.place(Some(1)).unwrap().unwrap().shown;
        let [sparse, dense] = [0, 1].map(|i| shown[i].as_ref().unwrap());
        let [one, other] = [sparse, dense].map(|shown| shown.part.as_ref().unwrap());
        assert!(one.contains(&true) && other.contains(&true));
        assert!(one.iter().zip(other).all(|(one, other)| !(one & other)));
        for (shown, outcome) in [sparse, dense].into_iter().zip(&row.outcomes) {
            let samples = &shown.run.as_ref().unwrap().samples;
            let own: Vec<f64> = samples
                .iter()
                .zip(shown.part.as_ref().unwrap())
                .filter(|(_, is_in)| **is_in)
                .map(|(sample, _)| sample.velocity.v)
                .collect();
            let mean_mps = own.iter().sum::<f64>() / own.len() as f64;
            let measured_mps = outcome.as_ref().unwrap().driven().unwrap().mean_speed_mps;
            assert!((mean_mps - measured_mps.unwrap()).abs() < 1e-12);
        }
        let without_scene = Claim::named("S2-1")[0].experiment;
        assert_eq!(without_scene.place(None).unwrap(), None);
    }
}
