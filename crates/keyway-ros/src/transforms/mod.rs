//! Poses of frames: the transforms of `/tf` and `/tf_static`, by time.
//!
//! Each frame has one parent. Between two received transforms the pose is interpolated linearly;
//! beyond the last one it is unknown.

mod placement;

pub(crate) use placement::Placement;

use std::collections::{HashMap, VecDeque};
use thiserror::Error;

/// The reason why the pose of a frame is unknown.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum TransformError {
    #[error(
        "no transform received for the frame `{0}`: is its publisher running, and is the name correct?"
    )]
    Unknown(String),
    #[error("no chain of transforms connects the frame `{0}` with `{1}`")]
    Unconnected(String, String),
    #[error(
        "the transforms from `{child}` cover {from_s:.3} s to {to_s:.3} s, but not {at_s:.3} s"
    )]
    OutOfTime { child: String, at_s: f64, from_s: f64, to_s: f64 },
}

/// All transforms of the last seconds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Transforms {
    edges: HashMap<String, Edge>,
}

/// The transforms from a frame to its parent.
#[derive(Clone, Debug)]
struct Edge {
    parent: String,
    /// True for a static transform.
    is_fixed: bool,
    /// Received transforms by their stamps \[s\], the oldest first; never empty.
    told: VecDeque<(f64, Placement)>,
}

impl Edge {
    fn first(&self) -> (f64, Placement) {
        self.told.front().copied().unwrap_or_default()
    }

    fn last(&self) -> (f64, Placement) {
        self.told.back().copied().unwrap_or_default()
    }

    /// The transform at a time \[s\]; outside the received interval, an error with that interval.
    fn at(&self, at_s: f64) -> Result<Placement, [f64; 2]> {
        let ((from_s, _), (to_s, last)) = (self.first(), self.last());
        if self.is_fixed || at_s == to_s {
            return Ok(last);
        }
        if !(from_s..=to_s).contains(&at_s) {
            return Err([from_s, to_s]);
        }
        let after = self.told.partition_point(|&(stamp_s, _)| stamp_s <= at_s);
        let ((before_s, before), (after_s, after)) = (self.told[after - 1], self.told[after]);
        let share = (at_s - before_s) / (after_s - before_s);
        Ok(before.lerp(&after, share))
    }
}

impl Transforms {
    /// Time for which a transform is kept \[s\].
    const KEPT_S: f64 = 10.0;

    /// Maximum depth: longer chains of frames are cycles.
    const DEEPEST: usize = 64;

    /// Stores the transform of a frame at a time \[s\], or a static one. If the stamp is older
    /// than the last one by more than the kept time, the history is cleared: the clock was set
    /// back.
    pub(crate) fn insert(
        &mut self,
        [parent, child]: [&str; 2],
        (stamp_s, placement): (f64, Placement),
        is_fixed: bool,
    ) {
        let [parent, child] = [parent, child].map(without_slash);
        if parent == child || !stamp_s.is_finite() {
            return;
        }
        let edge = self.edges.entry(child.to_owned()).or_insert_with(|| Edge {
            parent: parent.to_owned(),
            is_fixed,
            told: VecDeque::new(),
        });
        let last_s = edge.told.back().map_or(f64::NEG_INFINITY, |&(last_s, _)| last_s);
        if edge.parent != parent || is_fixed || edge.is_fixed || stamp_s < last_s - Self::KEPT_S {
            edge.told.clear();
            (edge.parent, edge.is_fixed) = (parent.to_owned(), is_fixed);
        }
        let place = edge.told.partition_point(|&(other_s, _)| other_s < stamp_s);
        match edge.told.get_mut(place) {
            Some(same) if same.0 == stamp_s => same.1 = placement,
            _ => edge.told.insert(place, (stamp_s, placement)),
        }
        let newest_s = edge.last().0;
        while edge.told.len() > 1 && edge.first().0 < newest_s - Self::KEPT_S {
            edge.told.pop_front();
        }
    }

    /// Clears all moving transforms, as the clock restarts.
    pub(crate) fn restart_clock(&mut self) {
        self.edges.retain(|_, edge| edge.is_fixed);
    }

    /// The pose of a frame in another one at a time \[s\].
    pub(crate) fn at(
        &self,
        frame: &str,
        child: &str,
        at_s: f64,
    ) -> Result<Placement, TransformError> {
        let [outer, inner] = self.chains(frame, child)?;
        let along = |chain: &[&str]| {
            chain.iter().try_fold(Placement::default(), |placement, &name| {
                let edge = &self.edges[name];
                let in_parent = edge.at(at_s).map_err(|[from_s, to_s]| {
                    TransformError::OutOfTime { child: name.to_owned(), at_s, from_s, to_s }
                })?;
                Ok(in_parent.compose(&placement))
            })
        };
        Ok(along(&outer)?.inverse().compose(&along(&inner)?))
    }

    /// The latest time at which the pose of a frame in another one is known \[s\]; infinite if
    /// all transforms between them are static.
    pub(crate) fn latest_s(&self, frame: &str, child: &str) -> Result<f64, TransformError> {
        let chains = self.chains(frame, child)?;
        let moving = chains.iter().flatten().map(|&name| &self.edges[name]);
        let latest_s = moving.filter(|edge| !edge.is_fixed).map(|edge| edge.last().0);
        Ok(latest_s.fold(f64::INFINITY, f64::min))
    }

    /// The chains of two frames up to their first common ancestor, without that.
    fn chains<'a>(
        &'a self,
        frame: &'a str,
        child: &'a str,
    ) -> Result<[Vec<&'a str>; 2], TransformError> {
        let [frame, child] = [frame, child].map(without_slash);
        if frame == child {
            return Ok([Vec::new(), Vec::new()]);
        }
        let [mut outer, mut inner] = [frame, child].map(|name| self.up_from(name));
        let unknown = |name: &str| TransformError::Unknown(name.to_owned());
        let is_parent = |name: &str| self.edges.values().any(|edge| edge.parent == name);
        if let Some(name) = [frame, child]
            .into_iter()
            .find(|&name| !self.edges.contains_key(name) && !is_parent(name))
        {
            return Err(unknown(name));
        }
        let shared = outer
            .iter()
            .find(|&name| inner.contains(name))
            .copied()
            .ok_or_else(|| TransformError::Unconnected(child.to_owned(), frame.to_owned()))?;
        for chain in [&mut outer, &mut inner] {
            let length = chain.iter().position(|&name| name == shared);
            chain.truncate(length.unwrap_or(chain.len()));
        }
        Ok([outer, inner])
    }

    /// A frame, its parent, and so on.
    fn up_from<'a>(&'a self, frame: &'a str) -> Vec<&'a str> {
        let parent = |name: &&'a str| self.edges.get(*name).map(|edge| edge.parent.as_str());
        std::iter::successors(Some(frame), parent).take(Self::DEEPEST).collect()
    }
}

/// Frame names used to begin with a slash.
fn without_slash(name: &str) -> &str {
    name.strip_prefix('/').unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::{Pose, wrap_angle};
    use std::f64::consts::{FRAC_PI_2, PI};

    fn upright(x: f64, y: f64, theta: f64) -> Placement {
        Placement::upright(Pose::new(x, y, theta))
    }

    fn robot() -> Transforms {
        let mut transforms = Transforms::default();
        transforms.insert(["map", "odom"], (2.0, upright(10.0, 0.0, FRAC_PI_2)), false);
        transforms.insert(["odom", "base_link"], (1.0, upright(0.0, 0.0, 0.0)), false);
        transforms.insert(["odom", "base_link"], (2.0, upright(2.0, 0.0, 1.0)), false);
        transforms.insert(["base_link", "base_scan"], (0.0, upright(0.3, 0.0, PI)), true);
        transforms
    }

    fn is_near(found: Placement, expected: Placement) -> bool {
        let [found, expected] = [found, expected].map(|placement| placement.on_ground());
        let apart_m = found.point().distance(expected.point());
        apart_m < 1e-9 && wrap_angle(found.theta - expected.theta).abs() < 1e-9
    }

    #[test]
    fn between_two_times_it_is_between_two_places() {
        let transforms = robot();
        let found = transforms.at("odom", "base_link", 1.5).unwrap();
        assert!(is_near(found, upright(1.0, 0.0, 0.5)), "{found:?}");
        let late = transforms.at("odom", "base_link", 2.1).unwrap_err();
        let TransformError::OutOfTime { child, from_s, to_s, .. } = late else { panic!() };
        assert_eq!((child.as_str(), from_s, to_s), ("base_link", 1.0, 2.0));
    }

    /// By hand: odom is at (10, 0) and its x axis points along y; the robot is 2 m along the x
    /// axis of odom.
    #[test]
    fn chains_lead_up_and_down() {
        let transforms = robot();
        let in_map = transforms.at("map", "base_link", 2.0).unwrap();
        assert!(is_near(in_map, upright(10.0, 2.0, FRAC_PI_2 + 1.0)), "{in_map:?}");
        let back = transforms.at("base_link", "map", 2.0).unwrap();
        assert!(is_near(in_map.compose(&back), upright(0.0, 0.0, 0.0)));
        let scan = transforms.at("base_link", "/base_scan", 77.0).unwrap();
        assert!(is_near(scan, upright(0.3, 0.0, PI)), "what never moves is known at all times");
        assert_eq!(transforms.latest_s("map", "base_scan"), Ok(2.0));
        assert_eq!(transforms.latest_s("base_link", "base_scan"), Ok(f64::INFINITY));
    }

    #[test]
    fn what_is_missing_is_named() {
        let mut transforms = robot();
        let unknown = transforms.at("map", "camera", 2.0);
        assert_eq!(unknown, Err(TransformError::Unknown("camera".to_owned())));
        transforms.insert(["mast", "camera"], (2.0, upright(0.0, 0.0, 0.0)), false);
        let apart = TransformError::Unconnected("camera".to_owned(), "map".to_owned());
        assert_eq!(transforms.at("map", "camera", 2.0), Err(apart));
        transforms.restart_clock();
        assert!(transforms.at("map", "base_link", 2.0).is_err());
        assert!(transforms.at("base_link", "base_scan", 2.0).is_ok());
    }

    #[test]
    fn frames_in_a_circle_end() {
        let mut transforms = Transforms::default();
        transforms.insert(["a", "b"], (0.0, upright(1.0, 0.0, 0.0)), false);
        transforms.insert(["b", "a"], (0.0, upright(1.0, 0.0, 0.0)), false);
        assert!(transforms.at("a", "c", 0.0).is_err());
        assert!(transforms.at("a", "b", 0.0).is_ok());
    }

    /// A clock that is set back clears the history; a slightly late transform is inserted in
    /// order.
    #[test]
    fn times_may_come_late_and_begin_anew() {
        let mut transforms = robot();
        transforms.insert(["odom", "base_link"], (1.4, upright(0.0, 1.0, 0.0)), false);
        let found = transforms.at("odom", "base_link", 1.4).unwrap();
        assert!(is_near(found, upright(0.0, 1.0, 0.0)));
        transforms.insert(["odom", "base_link"], (-20.0, upright(5.0, 1.0, 0.0)), false);
        assert_eq!(transforms.latest_s("odom", "base_link"), Ok(-20.0));
    }
}
