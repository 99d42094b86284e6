//! Scenes on which the baselines of a paper have its published figures.

use super::Named;
use crate::args::PapersArgs;
use crate::error::{CliError, Kind};
use keyway::files::did_you_mean;
use keyway::geometry::Point;
use keyway_lab::claims::{Claim, Reconstruction};
use keyway_sim::episode::Start;
use keyway_sim::scene_files::SceneFile;
use std::fmt::Display;

/// The scenes of each reconstruction, in the order of their seeds.
pub(super) fn scenes(args: &PapersArgs) -> Result<Vec<Named>, CliError> {
    let mut scenes = Vec::new();
    for of in chosen(&args.names)? {
        let fitted = of.find(args.count).map_err(unusable)?;
        if fitted.seeds.len() < args.count {
            let (found, tried) = (fitted.seeds.len(), fitted.tried);
            let message = format!("{}: only {found} of {tried} maps fit; ask for as many", of.name);
            return Err(CliError::new(Kind::Usage, message).field("--count"));
        }
        for seed in fitted.seeds {
            scenes.push(named(of, seed)?);
        }
    }
    Ok(scenes)
}

/// All reconstructions, each once, or those that are named.
fn chosen(names: &[String]) -> Result<Vec<&'static Reconstruction>, CliError> {
    let mut all: Vec<&'static Reconstruction> = Vec::new();
    for of in Claim::all().filter_map(|claim| claim.experiment.reconstruction.ok()) {
        if all.iter().all(|known| known.name != of.name) {
            all.push(of);
        }
    }
    if let Some(name) = names.iter().find(|name| all.iter().all(|of| of.name != name.as_str())) {
        let known: Vec<&str> = all.iter().map(|of| of.name).collect();
        let meant = did_you_mean(name, known.iter().copied());
        let known = known.join(", ");
        let message =
            format!("there is no reconstruction `{name}`; expected one of {known}{meant}");
        return Err(CliError::new(Kind::Usage, message).field("NAME"));
    }
    all.retain(|of| names.is_empty() || names.iter().any(|name| name == of.name));
    Ok(all)
}

fn named(of: &Reconstruction, seed: u64) -> Result<Named, CliError> {
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
    scene.validate().map_err(unusable)?;
    Ok(Named { file: format!("{}_{seed}.toml", of.name), scene })
}

/// A test makes all scenes, so this does not happen.
fn unusable(error: impl Display) -> CliError {
    CliError::new(Kind::Config, error)
}
