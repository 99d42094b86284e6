//! The output files of a plan: picture and animation of the search, and the path as a table.

use super::curve::CURVE;
use crate::args::{AnimationFile, PictureFile, PlanArgs};
use crate::error::CliError;
use crate::inputs::{refuse_to_replace_a_source, refuse_unwritable};
use crate::out_file::{write_animation, write_file};
use crate::pictures::{PlanPicture, png};
use keyway::map::formats::LoadedMap;
use keyway_draw::animate_search;
use std::path::PathBuf;

const PICTURE: &str = "--picture";
const ANIMATE: &str = "--animate";

/// Refuses outputs that would replace an input file or cannot be written. It is called before the
/// search, so that no result is lost.
pub(super) fn check(args: &PlanArgs, map: &LoadedMap) -> Result<(), CliError> {
    let picture = args.picture.as_ref().map(|file| (&file.path, PICTURE));
    let animation = args.animate.as_ref().map(|file| (&file.path, ANIMATE));
    let curve = args.curve.as_ref().map(|file| (&file.path, CURVE));
    let named = args.prepared.iter().chain(&args.config.config).cloned();
    let robot = args.size.robot.iter().map(PathBuf::from);
    let read: Vec<PathBuf> = map.sources.iter().cloned().chain(named).chain(robot).collect();
    for (path, field) in picture.into_iter().chain(animation).chain(curve) {
        refuse_to_replace_a_source(&read, path, field)?;
        refuse_unwritable(path, field)?;
    }
    Ok(())
}

/// True if an output that shows the search is requested.
pub(super) const fn show_search(args: &PlanArgs) -> bool {
    args.picture.is_some() || args.animate.is_some()
}

/// Writes the files and returns their paths. Without a path there is no curve; the file of an
/// earlier one is kept.
pub(super) fn write(
    args: &PlanArgs,
    picture: &PlanPicture<'_>,
    curve: Option<&[u8]>,
) -> Result<Vec<String>, CliError> {
    let mut written = Vec::new();
    if let Some((file, bytes)) = args.curve.as_ref().zip(curve) {
        write_file(&file.path, bytes, CURVE)?;
        written.push(&file.path);
    }
    if let Some(file) = &args.picture {
        write_picture(file, picture)?;
        written.push(&file.path);
    }
    if let Some(file) = &args.animate {
        write_the_search(file, picture)?;
        written.push(&file.path);
    }
    Ok(written.into_iter().map(|path| path.display().to_string()).collect())
}

fn write_picture(file: &PictureFile, picture: &PlanPicture<'_>) -> Result<(), CliError> {
    let svg = picture.still().svg();
    let bytes = if file.is_png { png(&svg)? } else { svg.into_string().into_bytes() };
    write_file(&file.path, &bytes, PICTURE)
}

fn write_the_search(file: &AnimationFile, picture: &PlanPicture<'_>) -> Result<(), CliError> {
    let frame = |trace| picture.frame(trace);
    write_animation(file, ANIMATE, |progress| {
        animate_search(picture.search, &picture.still(), frame, progress)
    })
}
