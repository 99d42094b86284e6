//! Services of `nav2_msgs` that are the same in Jazzy and Kilted.

use crate::messages::builtin_interfaces::Time;
use crate::messages::geometry_msgs::Pose;
use crate::messages::nav_msgs::OccupancyGrid;
use crate::messages::std_msgs::Header;
use crate::messages::{Empty, Service, service};
use serde::{Deserialize, Serialize};

service! {
    /// Clears all sensed obstacles.
    "nav2_msgs", ClearEntireCostmap: Empty => Empty
}

service! {
    /// Clears them outside a square around the robot.
    "nav2_msgs", ClearCostmapExceptRegion: ResetDistance => Empty
}

service! {
    /// Clears them inside a square around the robot.
    "nav2_msgs", ClearCostmapAroundRobot: ResetDistance => Empty
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ResetDistance {
    pub(crate) reset_distance: f32,
}

service! {
    /// Returns the global costmap.
    "nav2_msgs", GetCostmap: CostmapMetaData => Costmap
}

/// Returns the local costmap.
pub(crate) struct GetLocalCostmap;

impl Service for GetLocalCostmap {
    const NAME: (&'static str, &'static str) = GetCostmap::NAME;
    type Request = CostmapMetaData;
    type Response = Costmap;
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct CostmapMetaData {
    pub(crate) map_load_time: Time,
    pub(crate) update_time: Time,
    pub(crate) layer: String,
    pub(crate) resolution: f32,
    pub(crate) size_x: u32,
    pub(crate) size_y: u32,
    pub(crate) origin: Pose,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Costmap {
    pub(crate) header: Header,
    pub(crate) metadata: CostmapMetaData,
    pub(crate) data: Vec<u8>,
}

service! {
    /// Loads a map from a file.
    "nav2_msgs", LoadMap: MapUrl => LoadedMap
}

#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct MapUrl {
    pub(crate) map_url: String,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct LoadedMap {
    pub(crate) map: OccupancyGrid,
    pub(crate) result: u8,
}

impl LoadedMap {
    pub(crate) const SUCCESS: u8 = 0;
    pub(crate) const DOES_NOT_EXIST: u8 = 1;
    pub(crate) const INVALID_DATA: u8 = 2;
}

service! {
    /// Starts or stops all nodes.
    "nav2_msgs", ManageLifecycleNodes: Command => Success
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Command {
    pub(crate) command: u8,
}

impl Command {
    /// True if the node is active after it.
    pub(crate) const fn starts(self) -> bool {
        const STARTUP: u8 = 0;
        const RESUME: u8 = 2;
        matches!(self.command, STARTUP | RESUME)
    }

    /// True for a defined command.
    pub(crate) const fn is_known(self) -> bool {
        const LAST: u8 = 6;
        self.command <= LAST
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Success {
    pub(crate) success: bool,
}
