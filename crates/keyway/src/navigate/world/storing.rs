//! Serialised form of the world model.

use super::{SensorTimes, Told, World, unbelievable};
use crate::map::{CellState, Edit, OccupancyGrid};
use crate::navigate::doubts::Doubts;
use crate::navigate::masks::Masks;
use crate::navigate::motors::StoredMotors;
use crate::navigate::poses::Poses;
use crate::navigate::recovery::DrivenTrack;
use crate::navigate::time::Time;
use crate::navigate::walked_ground::WalkedGround;
use crate::navigate::{Blocked, FittedStack, NavigateError, RestoreError};
use crate::robot::Robot;
use crate::sense::{ProjectedScan, SeenStored, SensedPlaces, SensorPoints, Tracker};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The part of a [`World`] that cannot be derived from the rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::navigate) struct StoredWorld {
    map: Arc<OccupancyGrid>,
    masks: Masks,
    inserted_m: Option<f64>,
    #[serde(default)]
    is_between_cells: bool,
    sensed: SensedPlaces,
    seen: Option<SeenStored>,
    tracker: Option<Tracker>,
    walked: WalkedGround,
    track: DrivenTrack,
    motors: StoredMotors,
    edits: Vec<Edit>,
    poses: Poses,
    told: Option<Told>,
    /// Reason why the last observation was discarded.
    refused: Option<Refused>,
    has_changed_much: bool,
    now: Option<Time>,
    scans: Vec<ProjectedScan>,
    times: Vec<SensorTimes>,
    points_at: [Option<Time>; SensorPoints::MOST_SENSORS],
    ranges_m: Vec<Vec<f64>>,
    scanned: Option<Time>,
    doubts: Doubts,
}

/// Reason why an observation was discarded.
#[derive(Clone, Debug, Serialize, Deserialize)]
enum Refused {
    BadInput(String),
    TimeRunsBack { stamp_s: f64, last_s: f64 },
}

impl Refused {
    fn of(why: &Blocked) -> Self {
        match *why {
            Blocked::TimeRunsBack { stamp_s, last_s } => Self::TimeRunsBack { stamp_s, last_s },
            Blocked::BadInput(field) => Self::BadInput(field.to_owned()),
            // No other reason exists.
            _ => Self::BadInput(OBSERVED[0].to_owned()),
        }
    }
}

impl From<Refused> for Blocked {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::TimeRunsBack { stamp_s, last_s } => Self::TimeRunsBack { stamp_s, last_s },
            Refused::BadInput(field) => Self::BadInput(
                OBSERVED.into_iter().find(|one| *one == field).unwrap_or(OBSERVED[0]),
            ),
        }
    }
}

/// Fields of an observation that may be rejected.
const OBSERVED: [&str; 6] =
    ["stamp_s", "pose.x", "pose.y", "pose.theta", "velocity.v", "velocity.omega"];

impl World {
    /// The stored part of the world model.
    pub(in crate::navigate) fn stored(&self) -> StoredWorld {
        StoredWorld {
            map: Arc::clone(self.unmasked.as_ref().unwrap_or(&self.known)),
            masks: self.masks.clone(),
            inserted_m: self.router.layers.inserted_m(),
            is_between_cells: self.router.layers.is_between_cells,
            sensed: self.sensed.stored(),
            seen: self.seen.as_ref().map(crate::sense::SeenGround::stored),
            tracker: self.tracker.clone(),
            walked: self.walked.clone(),
            track: self.track.clone(),
            motors: self.motors.stored(),
            edits: self.edits.clone(),
            poses: self.poses.clone(),
            told: self.told,
            refused: self.refused.as_ref().map(Refused::of),
            has_changed_much: self.has_changed_much,
            now: self.now,
            scans: self.scans.clone(),
            times: self.times.clone(),
            points_at: self.points_at,
            ranges_m: self.ranges_m.clone(),
            scanned: self.scanned,
            doubts: self.doubts.clone(),
        }
    }

    /// Restores a world model, with all derived data.
    pub(in crate::navigate) fn restored(
        stored: StoredWorld,
        parts: &FittedStack,
    ) -> Result<Self, RestoreError> {
        let known = stored.masks.over(&stored.map);
        let mut world = Self::new(&known, parts).map_err(NavigateError::into_restore)?;
        world.check(&stored, &parts.robot)?;
        // Keep-out zones are not walls: obstacles sensed in them are restored.
        world.sensed = crate::sense::SensedLayer::restored(&stored.map, &stored.sensed);
        world.unmasked = stored.masks.keep_out.is_some().then_some(stored.map);
        world.masks = stored.masks;
        let router = &mut world.router;
        if let Some(clearance_m) = stored.inserted_m {
            router.layers.insert_again(&known, clearance_m);
        }
        router.layers.is_between_cells = stored.is_between_cells;
        router.layers.mark(&world.sensed.cells(), |_| CellState::Occupied);
        world.obstacles = router.distances(&parts.robot);
        if let (Some(seen), Some(cells)) = (&mut world.seen, stored.seen)
            && !seen.restore(cells)
        {
            return Err(RestoreError::Contradiction("seen"));
        }
        world.tracker = stored.tracker.filter(|_| world.tracker.is_some());
        (world.walked, world.track) = (stored.walked, stored.track);
        if !world.motors.take_up(stored.motors) {
            return Err(RestoreError::Contradiction("motors"));
        }
        (world.edits, world.poses) = (stored.edits, stored.poses);
        world.has_changed_much = stored.has_changed_much;
        world.refused = stored.refused.map(Blocked::from);
        (world.told, world.now, world.scanned) = (stored.told, stored.now, stored.scanned);
        (world.scans, world.times) = (stored.scans, stored.times);
        (world.points_at, world.ranges_m) = (stored.points_at, stored.ranges_m);
        world.doubts = stored.doubts;
        Ok(world)
    }

    /// Rejects parts that do not belong to the robot.
    fn check(&self, stored: &StoredWorld, robot: &Robot) -> Result<(), RestoreError> {
        let sensors = self.times.len();
        let counts = [
            ("scans", stored.scans.len()),
            ("times", stored.times.len()),
            ("ranges_m", stored.ranges_m.len()),
            ("doubts", stored.doubts.sensors()),
        ];
        if let Some((part, _)) = counts.into_iter().find(|&(_, count)| count != sensors) {
            return Err(RestoreError::Contradiction(part));
        }
        if stored.seen.is_some() != self.seen.is_some() {
            return Err(RestoreError::Contradiction("seen"));
        }
        if !stored.tracker.as_ref().is_none_or(Tracker::is_sound) {
            return Err(RestoreError::Contradiction("tracker"));
        }
        let is_true = |told: &Told| unbelievable(robot, told.pose, told.velocity).is_none();
        if !(stored.told.as_ref().is_none_or(is_true) && stored.poses.is_finite()) {
            return Err(RestoreError::Contradiction("told"));
        }
        Ok(())
    }
}
