//! `keyway demo`: drives the bundled scene as `keyway navigate --scene` does.

use super::navigate::{FILES, Wanted, drive, given, given_scene, table, write_files, written};
use super::{Done, print};
use crate::args::{Cli, Command, DemoArgs, Format};
use crate::error::{CliError, Kind};
use crate::out_dir::prepare;
use crate::report_text::WithFiles;
use crate::stdout::print_files;
use clap::Parser;
use keyway_lab::results::OutDir;
use keyway_sim::episode::{Episode, EpisodeOutcome};

const SCENE: &str = "small_house.toml";

/// Files that are copied into the folder: the scene and its map, and a small benchmark.
const BUNDLED: [(&str, &[u8]); 6] = [
    (SCENE, include_bytes!("../../scenes/small_house.toml")),
    ("small_house.yaml", include_bytes!("../../scenes/small_house.yaml")),
    ("small_house.png", include_bytes!("../../scenes/small_house.png")),
    ("NOTICE", include_bytes!("../../scenes/NOTICE")),
    ("rooms.map", include_bytes!("../../scenes/rooms.map")),
    ("rooms.map.scen", include_bytes!("../../scenes/rooms.map.scen")),
];

pub(crate) fn run(args: &DemoArgs) -> Result<Done, CliError> {
    let names: Vec<&str> = BUNDLED.iter().map(|(name, _)| *name).chain(FILES).collect();
    let mut out = prepare(&args.out, &names)?;
    for (name, bytes) in BUNDLED {
        out.write(name, bytes)?;
    }
    let episode = bundled(&out)?;
    let driven = drive(&episode, Wanted::default())?;
    let names = BUNDLED.iter().map(|(name, _)| *name).chain(written(&driven));
    let files: Vec<String> = names.map(|name| out.path(name).display().to_string()).collect();
    write_files(&episode, &driven, &files, &mut out)?;
    let (open, scene) = (out.path("map.png"), out.path(SCENE));
    out.finish()?;
    match args.format {
        Format::Json => crate::json::print(&WithFiles { report: &driven.report, files: &files })?,
        Format::Table => {
            print("A robot crosses a house, around an obstacle that is not on its map.\n")?;
            print(&table(&episode, &driven))?;
            print_files(&files)?;
            print(&format!(
                "\nOpen {} to see the trajectory. Put something else in the robot's way:\n\
                 keyway navigate --scene {} --obstacle 3,-0.3,0.4 --out run",
                open.display(),
                scene.display()
            ))?;
        }
    }
    Ok(Done::when(driven.report.outcome == EpisodeOutcome::Reached))
}

/// The episode that `keyway navigate --scene` runs.
fn bundled(out: &OutDir) -> Result<Episode, CliError> {
    let scene = out.path(SCENE);
    let argv = ["keyway".as_ref(), "navigate".as_ref(), "--scene".as_ref(), scene.as_os_str()];
    match Cli::try_parse_from(argv) {
        Ok(Cli { command: Command::Navigate(args) }) => {
            given(&args, given_scene(&args)?.as_ref()).map(|given| given.episode)
        }
        Ok(_) => Err(CliError::new(Kind::Usage, "the demo is a drive")),
        Err(error) => Err(CliError::from_clap(&error)),
    }
}
