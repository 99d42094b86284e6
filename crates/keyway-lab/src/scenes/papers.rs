//! Scenes on which the baselines of a paper have its published figures.

use super::{NamedScene, ScenesError};
use crate::claims::{Claim, Reconstruction};
use keyway::geometry::Point;
use keyway_sim::episode::Start;
use keyway_sim::scene_files::SceneFile;

/// Request for scenes of the papers' reconstructed maps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PapersRequest {
    /// Names of reconstructions, such as `you2021`; if empty, all of them.
    pub names: Vec<String>,
    /// Number of scenes of each: the first maps that fit, by their seeds from 1 on.
    pub count: usize,
}

impl PapersRequest {
    /// Returns the scenes of each reconstruction, in the order of their seeds.
    ///
    /// # Errors
    /// Returns [`ScenesError`] if no such reconstruction exists, or too few maps fit.
    pub fn scenes(&self) -> Result<Vec<NamedScene>, ScenesError> {
        let mut scenes = Vec::new();
        for of in self.chosen()? {
            let fitted = of.find(self.count).map_err(ScenesError::Baseline)?;
            let (found, tried) = (fitted.seeds.len(), fitted.tried);
            if found < self.count {
                return Err(ScenesError::TooFew { name: of.name, found, tried });
            }
            for seed in fitted.seeds {
                scenes.push(named(of, seed)?);
            }
        }
        Ok(scenes)
    }

    /// Returns each of the reconstructions once, in the order of the claims.
    fn chosen(&self) -> Result<Vec<&'static Reconstruction>, ScenesError> {
        let mut all: Vec<&'static Reconstruction> = Vec::new();
        for of in Claim::all().filter_map(|claim| claim.experiment.reconstruction.ok()) {
            if all.iter().all(|known| known.name != of.name) {
                all.push(of);
            }
        }
        let is_unknown = |name: &&String| all.iter().all(|of| of.name != name.as_str());
        if let Some(name) = self.names.iter().find(is_unknown) {
            let known = all.iter().map(|of| of.name).collect();
            return Err(ScenesError::Unknown { what: "reconstruction", name: name.clone(), known });
        }
        all.retain(|of| self.names.is_empty() || self.names.iter().any(|name| name == of.name));
        Ok(all)
    }
}

fn named(of: &Reconstruction, seed: u64) -> Result<NamedScene, ScenesError> {
    let cell_m = of.family.resolution_m;
    let [start, goal] =
        of.ends.map(|cell| Point::new(f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5) * cell_m);
    let published = of.baselines.iter().map(|one| format!("{}: {}", one.name, one.published));
    let published: Vec<String> = published.collect();
    let scene = SceneFile {
        description: Some(format!(
            "A reconstruction of {}; published of the baselines, and met: {}",
            of.name,
            published.join("; ")
        )),
        world: Some(of.family.clone()),
        seed,
        robot: "paper".to_owned(),
        ..SceneFile::new(Start { position: start, heading_rad: None }, goal.into())
    };
    scene.validate().map_err(ScenesError::Reconstruction)?;
    Ok(NamedScene { file: format!("{}_{seed}.toml", of.name), scene })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_choose_reconstructions() {
        let chosen = |names: &[&str]| {
            let names = names.iter().map(|&name| name.to_owned()).collect();
            let chosen = PapersRequest { names, count: 1 }.chosen()?;
            Ok::<_, ScenesError>(chosen.iter().map(|of| of.name).collect::<Vec<_>>())
        };
        assert_eq!(chosen(&["s1", "you2021", "s1"]).unwrap(), ["you2021", "s1"]);
        assert!(chosen(&[]).unwrap().len() > 2);
        let error = chosen(&["you2012"]).unwrap_err();
        let expected = "there is no reconstruction `you2012`; expected one of you2021, s1";
        assert!(error.to_string().starts_with(expected), "{error}");
        assert!(error.to_string().ends_with("; did you mean `you2021`?"), "{error}");
        assert_eq!(error.field(), Some("names"));
    }
}
