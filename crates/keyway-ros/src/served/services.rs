//! Services, which are answered at once.

use super::{Answered, Told};
use crate::costmaps::Shown;
use crate::messages::lifecycle_msgs::{GetState, State};
use crate::messages::nav2_msgs::services::{
    ClearCostmapAroundRobot, ClearCostmapExceptRegion, ClearEntireCostmap, Command, Costmap,
    CostmapMetaData, GetCostmap, GetLocalCostmap, LoadMap, LoadedMap, ManageLifecycleNodes, MapUrl,
    ResetDistance, Success,
};
use crate::messages::std_srvs::{IsActive, Triggered};
use crate::messages::{Empty, Service};
use crate::pilot::{Pilot, UrlError};
use crate::wire::{ServiceServer, WiredService};

/// A service of the node.
pub(super) trait Serves: Service {
    fn answer(pilot: &mut Pilot, request: Self::Request, told: Told<'_>) -> Self::Response;
}

impl<S: Serves + WiredService> Answered for ServiceServer<S> {
    fn answer_all(&mut self, pilot: &mut Pilot, told: Told<'_>) {
        self.answer_requests(|request| S::answer(pilot, request, told));
    }
}

impl Serves for GetState {
    fn answer(pilot: &mut Pilot, _: Empty, _: Told<'_>) -> State {
        State::of(pilot.is_active())
    }
}

impl Serves for IsActive {
    fn answer(pilot: &mut Pilot, _: Empty, _: Told<'_>) -> Triggered {
        let success = pilot.is_active();
        Triggered { success, message: State::of(success).label }
    }
}

impl Serves for ManageLifecycleNodes {
    fn answer(pilot: &mut Pilot, request: Command, _: Told<'_>) -> Success {
        if request.is_known() {
            pilot.set_active(request.starts());
        }
        Success { success: request.is_known() }
    }
}

impl Serves for ClearEntireCostmap {
    fn answer(pilot: &mut Pilot, _: Empty, _: Told<'_>) -> Empty {
        pilot.forget_sensed();
        Empty::default()
    }
}

impl Serves for ClearCostmapExceptRegion {
    fn answer(pilot: &mut Pilot, _: ResetDistance, _: Told<'_>) -> Empty {
        pilot.forget_sensed();
        Empty::default()
    }
}

impl Serves for ClearCostmapAroundRobot {
    fn answer(pilot: &mut Pilot, _: ResetDistance, _: Told<'_>) -> Empty {
        pilot.forget_sensed();
        Empty::default()
    }
}

impl Serves for GetCostmap {
    fn answer(pilot: &mut Pilot, _: CostmapMetaData, told: Told<'_>) -> Costmap {
        pilot.costmap(Shown::Global, told.now_s).unwrap_or_default()
    }
}

impl Serves for GetLocalCostmap {
    fn answer(pilot: &mut Pilot, _: CostmapMetaData, told: Told<'_>) -> Costmap {
        pilot.costmap(Shown::Local, told.now_s).unwrap_or_default()
    }
}

impl Serves for LoadMap {
    fn answer(pilot: &mut Pilot, request: MapUrl, told: Told<'_>) -> LoadedMap {
        match pilot.load_map(&request.map_url, told.now_s) {
            Ok(map) => LoadedMap { map, result: LoadedMap::SUCCESS },
            Err(error) => {
                crate::say(&error);
                let result = match error {
                    UrlError::Missing(_) => LoadedMap::DOES_NOT_EXIST,
                    UrlError::File(_) | UrlError::Map(_) => LoadedMap::INVALID_DATA,
                };
                LoadedMap { result, ..LoadedMap::default() }
            }
        }
    }
}
