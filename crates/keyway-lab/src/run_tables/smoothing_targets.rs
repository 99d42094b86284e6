//! Targets of a smoother, for texts about those that it missed.

use keyway::smooth::{SmootherConfig, WhySharp};
use std::fmt::{Display, Formatter, Result};

/// Distance that a smoothed path should keep, and the limit of its bends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothingTargets {
    /// Radius that the path should keep clear \[m\].
    clearance_m: f64,
    /// The smoother's own safe distance \[m\].
    safe_m: f64,
    /// True if the user sets the turning limit; otherwise it is part of the smoother.
    has_turning_limit: bool,
}

impl SmoothingTargets {
    /// Returns the targets of a smoother for a path that should keep `clearance_m`, on a map with
    /// cells of this side \[m\].
    pub fn new(smoother: &SmootherConfig, clearance_m: f64, cell_m: f64) -> Self {
        let safe_m = smoother.safe_distance_m(cell_m);
        let has_turning_limit = smoother.has_turning_limit();
        Self { clearance_m, safe_m, has_turning_limit }
    }

    /// Text of the reason why a corner stayed sharp.
    pub(super) const fn why_sharp(&self, why: WhySharp) -> &'static str {
        match why {
            WhySharp::Clearance => "a curve would come too close to an obstacle",
            WhySharp::Reversal => "the path reverses",
            WhySharp::TurningRadius if self.has_turning_limit => {
                "no space for a curve within the turning limit"
            }
            WhySharp::TurningRadius => "a curve would turn more than 5 degrees per centimetre",
            _ => "not rounded",
        }
    }
}

impl Display for SmoothingTargets {
    /// Writes the larger one of the two distances.
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if self.safe_m > self.clearance_m {
            write!(f, "the smoother's safe distance of {:.3} m", self.safe_m)
        } else {
            write!(f, "the clearance of {:.3} m", self.clearance_m)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn targets(smoother: &str, clearance_m: f64) -> SmoothingTargets {
        SmoothingTargets::new(&SmootherConfig::by_name(smoother).unwrap(), clearance_m, 0.5)
    }

    #[test]
    fn the_larger_distance_is_what_was_asked_for() {
        assert_eq!(targets("taut", 0.2).to_string(), "the clearance of 0.200 m");
        assert_eq!(targets("hierarchical", 99.0).to_string(), "the clearance of 99.000 m");
        // One expanded cell.
        let own = "the smoother's safe distance of 0.500 m";
        let SmootherConfig::Shortcut(config) = SmootherConfig::by_name("shortcut").unwrap() else {
            panic!("no shortcut")
        };
        let one = SmootherConfig::Shortcut(keyway::smooth::ShortcutConfig {
            expansion_cells: 1,
            ..config
        });
        assert_eq!(SmoothingTargets::new(&one, 0.2, 0.5).to_string(), own);
    }

    #[test]
    fn a_turning_limit_is_only_named_where_there_is_one() {
        let why = |smoother| targets(smoother, 0.0).why_sharp(WhySharp::TurningRadius);
        assert!(why("hierarchical").contains("5 degrees per centimetre"));
        assert!(why("continuous-curvature").contains("turning limit"));
    }
}
