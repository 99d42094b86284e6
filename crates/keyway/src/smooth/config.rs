//! The registry of smoothers by name. A new smoother is entered here.

use super::parameters::SmootherParameters;
use super::{
    BidirectionalSmoothing, BidirectionalSmoothingConfig, ContinuousCurvature,
    ContinuousCurvatureConfig, HierarchicalSmoothing, HierarchicalSmoothingConfig,
    KeyPointSmoothing, KeyPointSmoothingConfig, LineOfSight, LineOfSightConfig, Shortcut,
    ShortcutConfig, Smoother, Taut, TautConfig, Unsmoothed, UnsmoothedConfig,
};
use crate::ConfigError;
use crate::registry::registry;

registry! {
    /// A smoother and its parameters, as data.
    SmootherConfig by SmootherParameters;
    /// The line as planned, collinear points merged.
    None(UnsmoothedConfig) => Unsmoothed;
    /// From each kept point straight to the farthest visible point of the path.
    LineOfSight(LineOfSightConfig) => LineOfSight;
    /// Key points: the turning points, and points that keep the path away from obstacles.
    KeyPoints(KeyPointSmoothingConfig) => KeyPointSmoothing;
    /// From the start and then from the goal, straight to the farthest point of the path that can
    /// be reached safely.
    Bidirectional(BidirectionalSmoothingConfig) => BidirectionalSmoothing;
    /// Drops a point if its neighbours can be connected; runs several passes.
    Shortcut(ShortcutConfig) => Shortcut;
    /// Straight stretches at a safe distance, joined by cubic B-spline bends.
    Hierarchical(HierarchicalSmoothingConfig) => HierarchicalSmoothing;
    /// The locally shortest path at the clearance, pulled tight like a string around the same
    /// obstacles. Its bends are arcs with the clearance as radius.
    Taut(TautConfig) => Taut;
    /// Line of sight, then every corner rounded by two cubic curves with continuous curvature,
    /// within a turning limit.
    ContinuousCurvature(ContinuousCurvatureConfig) => ContinuousCurvature;
}

impl SmootherConfig {
    /// Sets the safe distance of the smoother \[m\] to that of a robot. It replaces the distances
    /// of papers, whose cells are 1 m wide.
    #[must_use]
    pub fn keeping(mut self, safe_distance_m: f64) -> Self {
        match &mut self {
            Self::KeyPoints(config) => config.safe_distance_m = safe_distance_m,
            Self::Hierarchical(config) => config.safe_distance_m = safe_distance_m,
            _ => {}
        }
        self
    }

    /// The smoother.
    ///
    /// # Errors
    /// [`ConfigError`] if a parameter is invalid; the error names it.
    pub fn build(&self) -> Result<Box<dyn Smoother + Send + Sync>, ConfigError> {
        self.parameters().build()
    }

    /// The smoother's own safe distance to obstacles \[m\] on a map with cells of side `cell_m`; 0
    /// for a smoother without one. It applies if it is larger than the clearance.
    pub fn safe_distance_m(&self, cell_m: f64) -> f64 {
        self.parameters().safe_distance_m(cell_m)
    }

    /// True if a parameter limits how sharply a path may bend.
    pub fn has_turning_limit(&self) -> bool {
        self.parameters().has_turning_limit()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_data() {
        for name in SmootherConfig::NAMES {
            let config = SmootherConfig::by_name(name).unwrap();
            assert_eq!((config.name(), config.build().is_ok()), (name, true));
            let json = serde_json::to_value(&config).unwrap();
            assert_eq!(json["name"], name);
            assert_eq!(serde_json::from_value::<SmootherConfig>(json.clone()).unwrap(), config);
            assert!(config.as_published().is_none_or(|paper| paper == config));
            assert!(config.readings().iter().all(|field| json.get(field).is_some()), "{json}");
        }
        assert_eq!(SmootherConfig::by_name("iron"), None);
    }
}
