//! Subscriptions of the node.

use crate::error::StartError;
use crate::messages::geometry_msgs::{PoseStamped, PoseWithCovarianceStamped};
use crate::messages::map_msgs::OccupancyGridUpdate;
use crate::messages::nav_msgs::{OccupancyGrid, Odometry};
use crate::messages::nav2_msgs::{CostmapFilterInfo, SpeedLimit};
use crate::messages::rosgraph_msgs::Clock;
use crate::messages::sensor_msgs::{LaserScan, PointCloud2};
use crate::messages::tf2_msgs::TFMessage;
use crate::pilot::Pilot;
use crate::settings::Settings;
use crate::wire::{Delivery, Inbox, Wire};

/// All subscriptions.
pub(super) struct Inboxes {
    map: Inbox<OccupancyGrid>,
    map_updates: Inbox<OccupancyGridUpdate>,
    scans: Vec<Inbox<LaserScan>>,
    clouds: Vec<Inbox<PointCloud2>>,
    odometry: Inbox<Odometry>,
    transforms: [Inbox<TFMessage>; 2],
    pub(super) goal_pose: Inbox<PoseStamped>,
    initial_pose: Inbox<PoseWithCovarianceStamped>,
    speed_limit: Inbox<SpeedLimit>,
    filters: Vec<Inbox<CostmapFilterInfo>>,
    /// Masks of the announced filters.
    masks: Vec<(CostmapFilterInfo, Inbox<OccupancyGrid>)>,
    pub(super) clock: Option<Inbox<Clock>>,
}

impl Inboxes {
    pub(super) fn new(wire: &mut Wire, settings: &Settings) -> Result<Self, StartError> {
        let scan = |topic: &String| wire.inbox(topic, Delivery::BestEffort, 4);
        let scans = settings.scan_topics.iter().map(scan).collect::<Result<_, _>>()?;
        let cloud = |topic: &String| wire.inbox(topic, Delivery::BestEffort, 2);
        let clouds = settings.cloud_topics.iter().map(cloud).collect::<Result<_, _>>()?;
        let filter = |topic: &String| wire.inbox(topic, Delivery::Latched, 1);
        let filters = settings.filter_info_topics.iter().map(filter).collect::<Result<_, _>>()?;
        let clock = if settings.use_sim_time {
            Some(wire.inbox("/clock", Delivery::BestEffort, 1)?)
        } else {
            None
        };
        Ok(Self {
            map: wire.inbox("map", Delivery::Latched, 1)?,
            map_updates: wire.inbox("map_updates", Delivery::Reliable, 16)?,
            scans,
            clouds,
            odometry: wire.inbox(&settings.odom_topic, Delivery::BestEffort, 4)?,
            transforms: [
                wire.inbox("/tf", Delivery::BestEffort, 100)?,
                wire.inbox("/tf_static", Delivery::Latched, 100)?,
            ],
            goal_pose: wire.inbox("goal_pose", Delivery::Reliable, 1)?,
            initial_pose: wire.inbox("initialpose", Delivery::Reliable, 1)?,
            speed_limit: wire.inbox("speed_limit", Delivery::Reliable, 1)?,
            filters,
            masks: Vec::new(),
            clock,
        })
    }

    /// Passes transforms and sensor data to the pilot.
    pub(super) fn receive_sensed(&self, pilot: &mut Pilot) {
        for (inbox, is_fixed) in self.transforms.iter().zip([false, true]) {
            for message in inbox.take_all().iter().flat_map(|message| &message.transforms) {
                let Some(placement) = message.placement() else { continue };
                let stamp_s = message.header.stamp.stamp_s();
                let names = [message.header.frame_id.as_str(), &message.child_frame_id];
                pilot.transforms.insert(names, (stamp_s, placement), is_fixed);
            }
        }
        for message in self.odometry.take_all() {
            pilot.sensing.take_odometry(&message);
        }
        for (sensor, inbox) in self.scans.iter().enumerate() {
            for message in inbox.take_all() {
                pilot.sensing.take_scan(sensor, message);
            }
        }
        for (sensor, inbox) in self.clouds.iter().enumerate() {
            for message in inbox.take_all() {
                pilot.sensing.take_cloud(sensor, message);
            }
        }
    }

    /// Passes maps, masks and limits to the pilot; returns the faults found in them.
    pub(super) fn receive_known(&mut self, pilot: &mut Pilot, wire: &mut Wire) -> Vec<String> {
        let mut faults = Vec::new();
        if let Some(message) = self.map.take_all().pop()
            && let Err(error) = pilot.take_map(&message)
        {
            faults.push(format!("the map cannot be used: {error}"));
        }
        for message in self.map_updates.take_all() {
            if let Err(error) = pilot.take_update(&message) {
                faults.push(format!("an update of the map cannot be used: {error}"));
            }
        }
        self.subscribe_to_masks(wire, &mut faults);
        for (info, inbox) in &self.masks {
            if let Some(mask) = inbox.take_all().pop()
                && let Err(error) = pilot.take_mask(info, &mask)
            {
                let topic = &info.filter_mask_topic;
                faults.push(format!("the mask of {topic} cannot be used: {error}"));
            }
        }
        for message in self.speed_limit.take_all() {
            pilot.limit_speed(&message);
        }
        // A new initial pose means that the estimate was wrong, and so are the positions of
        // obstacles sensed with it.
        if self.initial_pose.take_all().pop().is_some() {
            pilot.forget_sensed();
        }
        faults
    }

    /// Subscribes to the masks of announced filters. Each replaces the one of its kind.
    fn subscribe_to_masks(&mut self, wire: &mut Wire, faults: &mut Vec<String>) {
        for info in self.filters.iter().flat_map(Inbox::take_all) {
            if self.masks.iter().any(|(known, _)| is_same(known, &info)) {
                continue;
            }
            match wire.inbox(&info.filter_mask_topic, Delivery::Latched, 1) {
                Ok(inbox) => {
                    self.masks.retain(|(known, _)| known.kind != info.kind);
                    self.masks.push((info, inbox));
                }
                Err(error) => faults.push(error.to_string()),
            }
        }
    }
}

/// True if two announcements describe the same mask in the same way.
fn is_same(a: &CostmapFilterInfo, b: &CostmapFilterInfo) -> bool {
    let told = |info: &CostmapFilterInfo| (info.kind, info.base, info.multiplier);
    a.filter_mask_topic == b.filter_mask_topic && told(a) == told(b)
}
