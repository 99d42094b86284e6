//! The robot between messages and commands: what came in is observed by the navigator, and in every
//! cycle it says what to do. It knows no network and reads no clock.

mod codes;
mod errand;
mod goals;
mod sensing;
mod waits;

#[cfg(test)]
pub(crate) use codes::Code;
pub(crate) use codes::Ended;
pub(crate) use errand::Wanted;
pub(crate) use waits::Waits;

use crate::messages::nav_msgs::OccupancyGrid;
use crate::settings::Settings;
use crate::transforms::Transforms;
use errand::Errand;
use keyway::geometry::{Pose, Velocity};
use keyway::map::{CellState, GridFrame};
use keyway::navigate::{NavigateError, Navigator, Step};
use sensing::Sensing;
use thiserror::Error;

/// A robot that drives by messages.
pub(crate) struct Pilot {
    settings: Settings,
    pub(crate) transforms: Transforms,
    pub(crate) sensing: Sensing,
    /// Nothing can be done before there is a map.
    navigator: Option<Navigator>,
    errand: Option<Errand>,
    /// Pose in the map, when it was last known.
    pose: Option<Pose>,
}

/// The result of a cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cycle {
    pub(crate) command: Velocity,
    /// The errand has ended in this cycle.
    pub(crate) ended: Option<Ended>,
    /// Nothing was decided.
    pub(crate) waits: Option<Waits>,
}

/// A map that cannot be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum MapError {
    #[error("a map of {width} x {height} cells has {values} values")]
    Count { width: u32, height: u32, values: usize },
    #[error("the origin of the map is no pose")]
    Origin,
    #[error("{0}")]
    Frame(String),
    #[error(transparent)]
    Navigate(#[from] NavigateError),
}

impl Pilot {
    pub(crate) fn new(settings: Settings) -> Self {
        let sensing = Sensing::new(settings.scan_topics.len());
        Self {
            settings,
            transforms: Transforms::default(),
            sensing,
            navigator: None,
            errand: None,
            pose: None,
        }
    }

    /// Takes in a map, in the place of the last one. Where it cannot be used, that one stays.
    pub(crate) fn take_map(&mut self, message: &OccupancyGrid) -> Result<(), MapError> {
        let map = map_of(message)?;
        match &mut self.navigator {
            Some(navigator) => navigator.set_map(&map)?,
            None => self.navigator = Some(Navigator::new(&map, &self.settings.stack)?),
        }
        Ok(())
    }

    /// The clock begins anew, such as that of a simulation.
    pub(crate) fn restart_clock(&mut self) {
        self.transforms.restart_clock();
        self.sensing.restart_clock();
        self.pose = None;
        if let Some(navigator) = &mut self.navigator {
            navigator.restart_clock();
        }
    }

    /// The navigator, once there is a map.
    pub(crate) const fn navigator(&self) -> Option<&Navigator> {
        self.navigator.as_ref()
    }

    /// Pose in the map, when it was last known.
    pub(crate) const fn pose(&self) -> Option<Pose> {
        self.pose
    }

    /// The next command, at a time \[s\]. In doubt of where it is the robot stands.
    pub(crate) fn cycle(&mut self, now_s: f64) -> Cycle {
        let step = match self.look(now_s) {
            Err(waits) => {
                return Cycle { command: Velocity::ZERO, ended: None, waits: Some(waits) };
            }
            Ok(navigator) => navigator.step_at(now_s),
        };
        let ended = self.end_of_errand(&step, now_s);
        if matches!(ended, Some(Ended::Failed { .. })) {
            self.stop();
            return Cycle { command: Velocity::ZERO, ended, waits: None };
        }
        Cycle { command: step.command(), ended, waits: None }
    }

    /// Observes what has come.
    fn look(&mut self, now_s: f64) -> Result<&mut Navigator, Waits> {
        let Settings { frames, max_pose_age_s, .. } = &self.settings;
        let navigator = self.navigator.as_mut().ok_or(Waits::Map)?;
        let stamp_s = self.transforms.latest_s(&frames.map, &frames.base)?.min(now_s);
        let pose = self.transforms.at(&frames.map, &frames.base, stamp_s)?.pose;
        self.pose = Some(pose);
        let age_s = now_s - stamp_s;
        if age_s > *max_pose_age_s {
            return Err(Waits::NewPose { age_s });
        }
        self.sensing.observe(navigator, (stamp_s, pose), (&self.transforms, &frames.base))?;
        Ok(navigator)
    }

    /// The errand, if it ends by this step.
    fn end_of_errand(&mut self, step: &Step, now_s: f64) -> Option<Ended> {
        let navigator = self.navigator.as_ref()?;
        let ended = self.errand.as_mut()?.end(navigator, step, now_s)?;
        self.errand = None;
        Some(ended)
    }
}

/// A map of values: 65 and more are occupied, as map servers have it; below 0 nothing is known.
fn map_of(message: &OccupancyGrid) -> Result<keyway::OccupancyGrid, MapError> {
    const OCCUPIED: i8 = 65;
    let info = &message.info;
    let (width, height) = (info.width, info.height);
    let values = message.data.len();
    if u64::from(width) * u64::from(height) != values as u64 {
        return Err(MapError::Count { width, height, values });
    }
    let origin = info.origin.on_ground().ok_or(MapError::Origin)?;
    // 0.05 in single precision is not 0.05; nobody makes cells of a part of a micrometre.
    let resolution_m = (f64::from(info.resolution) * 1e6).round() / 1e6;
    let frame = GridFrame::new(u64::from(width), u64::from(height), resolution_m, origin)
        .map_err(|error| MapError::Frame(error.to_string()))?;
    let mut values = message.data.iter();
    Ok(keyway::OccupancyGrid::from_fn(frame, |_| match values.next() {
        Some(&value) if value >= OCCUPIED => CellState::Occupied,
        Some(&value) if value >= 0 => CellState::Free,
        _ => CellState::Unknown,
    }))
}

#[cfg(test)]
mod tests;
