//! Recordings of drives for a page, cycle by cycle.

use keyway::geometry::{Point, Pose};
use keyway::local::{Explanation, Fate};
use keyway::map::Cell;
use keyway::navigate::Navigator;
use keyway_sim::episode::{Cycle, CycleReport, EpisodeObserver};
use keyway_sim::sim::MovingObstacle;

/// Number of points of a candidate's trajectory, without the robot's position.
pub const FAN_POINTS: usize = 6;
/// Numbers of a candidate velocity: its fate, its score, and its points.
pub const FAN_NUMBERS: usize = 2 + 2 * FAN_POINTS;

/// The recorded cycles of a robot.
#[derive(Clone, Default)]
pub(crate) struct Film {
    pub(crate) cycles: Vec<CycleReport>,
    pub(crate) routes: Vec<(u64, Vec<Point>)>,
    pub(crate) poses: Vec<u8>,
    pub(crate) hits: Vec<u8>,
    pub(crate) sensed: Vec<u8>,
    pub(crate) fans: Vec<u8>,
    pub(crate) refusals: Vec<(u64, String)>,
    known: Vec<Cell>,
    has_reasons: bool,
    /// [`Navigator::routes_planned`] at the last cycle.
    planned: Option<u32>,
}

impl Film {
    pub(crate) fn new(has_reasons: bool) -> Self {
        Self { has_reasons, ..Self::default() }
    }

    fn note_route(&mut self, cycle: u64, navigator: &Navigator) {
        let planned = navigator.routes_planned();
        if self.planned.replace(planned) != Some(planned) {
            let points = navigator.route().map(|route| route.smoothed.points().to_vec());
            self.routes.push((cycle, points.unwrap_or_default()));
        }
    }

    /// Positions of all moving obstacles in each cycle.
    pub(crate) fn places_of(&self, movers: &[MovingObstacle]) -> Vec<u8> {
        let places = |cycle: &CycleReport| {
            let t_s = cycle.t_s;
            movers.iter().map(move |mover| mover.at(t_s).centre)
        };
        let numbers = self.cycles.iter().flat_map(places).flat_map(|at| [at.x as f32, at.y as f32]);
        numbers.flat_map(f32::to_le_bytes).collect()
    }

    fn note_hits(&mut self, cycle: &Cycle<'_>) {
        let observation = cycle.observation;
        let scans = observation.scans.iter();
        let points: Vec<Point> =
            scans.flat_map(|one| one.scan.hits(observation.pose.compose(one.mount))).collect();
        self.hits.extend((points.len() as u32).to_le_bytes());
        let numbers = points.iter().flat_map(|point| [point.x as f32, point.y as f32]);
        self.hits.extend(numbers.flat_map(f32::to_le_bytes));
    }

    fn note_fan(&mut self, from: Pose, explanation: &Explanation) {
        let candidates = explanation.candidates.iter();
        self.fans.extend((explanation.candidates.len() as u32).to_le_bytes());
        for (i, candidate) in candidates.enumerate() {
            let fate = match candidate.fate {
                _ if explanation.chosen == Some(i) => 1.0,
                _ if explanation.runner_up == Some(i) => 2.0,
                Fate::Admissible { .. } => 0.0,
                Fate::Refused { free_for_s: Some(_), .. } => 3.0,
                Fate::Refused { free_for_s: None, .. } => 4.0,
            };
            let score = candidate.score().unwrap_or(0.0);
            let points = spread(&candidate.poses).map(|pose| pose.unwrap_or(&from).point());
            let numbers = [fate, score].into_iter().chain(points.flat_map(|at| [at.x, at.y]));
            self.fans.extend(numbers.flat_map(|number| (number as f32).to_le_bytes()));
        }
    }

    fn note_sensed(&mut self, navigator: &Navigator) {
        let now: Vec<Cell> = navigator.sensed().ones().collect();
        let is_new =
            |cell: &&Cell| self.known.binary_search_by_key(&key(**cell), |c| key(*c)).is_err();
        let new: Vec<Cell> = now.iter().filter(is_new).copied().collect();
        self.sensed.extend((new.len() as u32).to_le_bytes());
        self.sensed.extend(new.iter().flat_map(|cell| [cell.x, cell.y]).flat_map(i32::to_le_bytes));
        self.known = now;
    }
}

/// Poses of a trajectory at equal steps, including the last one; `None` for an empty trajectory.
fn spread(poses: &[Pose]) -> impl Iterator<Item = Option<&Pose>> {
    let step = |i: usize| (poses.len() * i).div_ceil(FAN_POINTS).checked_sub(1);
    (1..=FAN_POINTS).map(move |i| step(i).and_then(|at| poses.get(at)))
}

/// Sort key of the cells of a grid, row by row.
const fn key(cell: Cell) -> (i32, i32) {
    (cell.y, cell.x)
}

impl EpisodeObserver for Film {
    fn started(&mut self, navigator: &Navigator) {
        self.note_route(0, navigator);
    }

    fn decided(&mut self, cycle: &Cycle<'_>) {
        let Pose { x, y, theta } = cycle.observation.pose;
        self.poses.extend([x, y, theta].into_iter().flat_map(f64::to_le_bytes));
        self.note_hits(cycle);
        self.note_sensed(cycle.navigator);
        self.note_route(cycle.index, cycle.navigator);
        let refusal = cycle.navigator.refusal();
        self.refusals.extend(refusal.map(|refusal| (cycle.index, refusal.to_string())));
        let explanation =
            if self.has_reasons { cycle.navigator.explain() } else { Explanation::default() };
        self.note_fan(cycle.observation.pose, &explanation);
        self.cycles.push(CycleReport::of(cycle, &explanation));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_are_spread_up_to_the_last_one() {
        let poses: Vec<Pose> = (1..=20).map(|i| Pose::new(f64::from(i), 0.0, 0.0)).collect();
        let at = |poses: &[Pose]| -> Vec<Option<f64>> {
            spread(poses).map(|pose| pose.map(|pose| pose.x)).collect()
        };
        assert_eq!(at(&poses), [4.0, 7.0, 10.0, 14.0, 17.0, 20.0].map(Some));
        assert_eq!(at(&poses[..2]), [1.0, 1.0, 1.0, 2.0, 2.0, 2.0].map(Some));
        assert_eq!(at(&[]), [None; FAN_POINTS]);
    }
}
