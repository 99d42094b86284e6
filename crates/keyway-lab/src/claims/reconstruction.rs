//! Maps on which the baselines have their published figures.
//!
//! The papers print path lengths and numbers of turns, but no maps. With cells of 1 m, a length is
//! a + b sqrt(2), so a and b are known exactly. A map is a reconstruction if every baseline has its
//! published figure there; the paper's own method is not considered. Many maps fit: the fitting
//! ones are taken in the order of their seeds.

use super::planned::{Planned, Planning};
use keyway::ConfigError;
use keyway::geometry::Point;
use keyway::map::{Cell, OccupancyGrid};
use keyway::search::Workspace;
use keyway_sim::episode::EpisodeError;
use keyway_sim::worlds::GeneratedMap;
use std::f64::consts::SQRT_2;

/// Basis of a reconstruction: a family of maps and the published figures of the baselines.
#[derive(Debug)]
pub struct Reconstruction {
    /// Name such as `you2021`; also the name of the folder of its scenes.
    pub name: &'static str,
    /// Candidate maps.
    pub family: GeneratedMap,
    /// Start and goal of the experiment.
    pub ends: [Cell; 2],
    /// Baselines that must have their published figures.
    pub baselines: &'static [Baseline],
}

/// A baseline with its published figure.
#[derive(Debug)]
pub struct Baseline {
    /// Display name.
    pub name: &'static str,
    /// Planning of the baseline.
    pub planning: Planning,
    /// Start and goal, if different from those of the experiment.
    pub ends: Option<[Cell; 2]>,
    /// Published figure of the baseline.
    pub published: Published,
}

/// Published figure of a baseline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Published {
    /// Numbers of straight and of diagonal steps of its path.
    Steps(u32, u32),
    /// Number of turns of its path.
    Turns(usize),
    /// Existence of a path, of any length.
    Found,
}

/// Maps that fit, and the number of maps tried.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fitted {
    /// Seeds of the maps that fit.
    pub seeds: Vec<u64>,
    /// Number of maps tried, from seed 1 on.
    pub tried: u64,
}

/// Lengths that differ by less are equal \[m\].
const ROUNDING_M: f64 = 1e-6;

impl Reconstruction {
    /// Number of fitting maps that are reported.
    pub const KEPT: usize = 30;
    /// Maximum number of maps that are tried.
    pub const MOST_TRIED: u64 = 1_000_000;

    /// Returns the map of a seed, whether it fits or not.
    ///
    /// # Errors
    /// Returns [`ConfigError`] if a parameter of the family is invalid.
    pub fn map(&self, seed: u64) -> Result<OccupancyGrid, ConfigError> {
        let cell_m = self.family.resolution_m;
        let centre =
            |Cell { x, y }: Cell| Point::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * cell_m;
        self.family.generate(seed, &self.ends.map(centre))
    }

    /// Returns the first maps that fit, by their seeds from 1 on, until the wanted number is found
    /// or [`Self::MOST_TRIED`] were tried. Each try costs a map, and the searches of the baselines
    /// up to the first mismatch.
    ///
    /// # Errors
    /// Returns [`EpisodeError`] if a parameter is invalid.
    pub fn find(&self, wanted: usize) -> Result<Fitted, EpisodeError> {
        let (mut fitted, mut workspace) = (Fitted::default(), Workspace::default());
        while fitted.seeds.len() < wanted && fitted.tried < Self::MOST_TRIED {
            fitted.tried += 1;
            if self.fits(&self.map(fitted.tried)?, &mut workspace)? {
                fitted.seeds.push(fitted.tried);
            }
        }
        Ok(fitted)
    }

    /// True if all baselines have their published figures on a map.
    fn fits(&self, map: &OccupancyGrid, workspace: &mut Workspace) -> Result<bool, EpisodeError> {
        for baseline in self.baselines {
            let ends = baseline.ends.unwrap_or(self.ends);
            let planned = baseline.planning.run(map, (ends, 0), workspace, None)?;
            if !planned.is_some_and(|planned| baseline.published.is_met_by(&planned)) {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl Published {
    fn is_met_by(self, planned: &Planned) -> bool {
        match self {
            Self::Steps(straight, diagonal) => {
                let length_m = f64::from(straight) + f64::from(diagonal) * SQRT_2;
                (planned.path.length_m - length_m).abs() < ROUNDING_M
            }
            Self::Turns(turns) => planned.path.turns == turns,
            Self::Found => true,
        }
    }
}

impl std::fmt::Display for Published {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Steps(straight, diagonal) => {
                let length_m = f64::from(*straight) + f64::from(*diagonal) * SQRT_2;
                write!(f, "{length_m:.3} m = {straight} + {diagonal} sqrt(2)")
            }
            Self::Turns(turns) => write!(f, "{turns} turns"),
            Self::Found => f.write_str("a path"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::claims::{Claim, Experiment};

    #[test]
    fn figures_of_baselines_by_hand() {
        let grid = OccupancyGrid::from_ascii(&["....", ".##.", "...."]);
        let experiment = Claim::named("S0-1")[0].experiment;
        let crate::claims::How::Plan(jps) =
            &experiment.method(Experiment::YARDSTICK).unwrap().1.how
        else {
            panic!("the yardstick plans")
        };
        let ends = [Cell::new(0, 0), Cell::new(3, 2)];
        let planned = jps.run(&grid, (ends, 0), &mut Workspace::default(), None).unwrap().unwrap();
        let met = |published: Published| published.is_met_by(&planned);
        assert!(met(Published::Steps(5, 0)) && met(Published::Turns(1)) && met(Published::Found));
        assert!(!met(Published::Steps(3, 1)) && !met(Published::Turns(2)));
        assert_eq!(Published::Steps(8, 15).to_string(), "29.213 m = 8 + 15 sqrt(2)");
    }

    /// Found maps fit, no map before or between them does, and the paper's own method is not a
    /// baseline.
    #[test]
    fn maps_that_fit() {
        let of = Claim::named("S1-2")[0].experiment.reconstruction.unwrap();
        let fitted = of.find(2).unwrap();
        let mut workspace = Workspace::default();
        let all: Vec<u64> = (1..=fitted.tried)
            .filter(|&seed| of.fits(&of.map(seed).unwrap(), &mut workspace).unwrap())
            .collect();
        assert_eq!((all, fitted.seeds.len()), (fitted.seeds, 2));
    }
}
