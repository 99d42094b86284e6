//! A search as it progressed.

use super::Animation;
use crate::layers::SearchTrace;
use crate::map_picture::MapPicture;
use crate::raster::DrawError;
use keyway::search::Recording;
use resvg::tiny_skia::Pixmap;
use std::num::NonZero;
use std::thread;

/// Pictures of a search, at most.
const FRAMES: usize = 80;
/// How long a search is shown \[1/100 s\], and each of its pictures at most.
const SEARCH_CS: usize = 800;
const LONGEST_FRAME_CS: usize = 40;
/// How long the result is shown \[1/100 s\].
const RESULT_CS: u16 = 200;
/// Longer side \[px\].
const SIDE_PX: f64 = 640.0;

/// Plays a search: up to 80 pictures, each with the same number of further events, for 8 s at most;
/// then `still`, the picture of the result, for 2 s. Its longer side has 640 pixels.
///
/// `frame` gives the picture of a part of the search. It must contain whatever `still` shows from
/// the beginning on, and is shown in its layout. The map and its tints are drawn once, so they must
/// be the same in all pictures. `progress` is called with the number of pictures drawn so far, and
/// their total.
///
/// ```
/// use keyway::geometry::{Point, Polyline};
/// use keyway::map::{Cell, LayerConfig, OccupancyGrid, SearchMap};
/// use keyway::plan::{AStar, GlobalPlanner, Plan};
/// use keyway::search::{Query, Recording, Workspace};
/// use keyway_draw::layers::{PathLine, SearchTrace};
/// use keyway_draw::{MapPicture, animate_search};
///
/// let grid = OccupancyGrid::from_ascii(&["....", ".##.", "...."]);
/// let map = SearchMap::new(&grid, LayerConfig::default())?;
/// let query = Query::new(Cell::new(0, 0), Cell::new(3, 2));
/// let (mut recording, mut plan) = (Recording::default(), Plan::default());
/// let mut workspace = Workspace::default();
/// AStar::default().plan_into(&map, &query, &mut workspace, Some(&mut recording), &mut plan)?;
///
/// let line = plan.line(&map, Point::new(0.5, 0.5), Point::new(3.5, 2.5));
/// let frame = |trace| MapPicture::new(&grid).with(trace);
/// let still = frame(SearchTrace::new(&recording)).with(PathLine::planned(line.polyline()));
/// let animation = animate_search(&recording, &still, frame, |_, _| ())?;
/// // One picture before the first event, one after each, and the result.
/// assert_eq!(animation.frames(), recording.events().len() + 2);
/// assert!(animation.to_gif()?.len() < 100_000);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When a picture cannot be drawn, which no recording causes.
pub fn animate_search<'a>(
    recording: &'a Recording,
    still: &MapPicture<'_>,
    frame: impl Fn(SearchTrace<'a>) -> MapPicture<'a> + Sync,
    mut progress: impl FnMut(usize, usize),
) -> Result<Animation, DrawError> {
    let last = still.svg();
    let scale = SIDE_PX / last.longer_side()?;
    let mut animation = Animation::new(&last, scale)?;
    let events = recording.events().len();
    let pictures = events.min(FRAMES);
    let centiseconds = (SEARCH_CS / pictures.max(1)).min(LONGEST_FRAME_CS) as u16;
    let (trace, layout) = (SearchTrace::new(recording), still.layout());
    let frame = |shown: usize| frame(trace.first(shown)).max_side_cells(SIDE_PX as i32);
    let ground = frame(0).svg_in(&layout).to_pixels(scale)?;
    let draw = |i: usize| {
        let mut pixels = ground.clone();
        let shown = i * events / pictures.max(1);
        frame(shown).over_ground_in(&layout).draw_over(&mut pixels, scale)?;
        Ok(pixels)
    };
    let mut done = 0;
    in_order(pictures + 1, draw, |pixels| {
        animation.push_pixels(&pixels?, centiseconds)?;
        done += 1;
        progress(done, pictures + 1);
        Ok(())
    })?;
    animation.push(&last, RESULT_CS)?;
    Ok(animation)
}

/// Draws pictures on all processors, a few at a time, and hands them over in their order.
fn in_order(
    count: usize,
    draw: impl Fn(usize) -> Result<Pixmap, DrawError> + Sync,
    mut take: impl FnMut(Result<Pixmap, DrawError>) -> Result<(), DrawError>,
) -> Result<(), DrawError> {
    let workers = thread::available_parallelism().map_or(1, NonZero::get);
    for first in (0..count).step_by(workers) {
        let batch = first..(first + workers).min(count);
        let drawn: Vec<_> = thread::scope(|scope| {
            let threads: Vec<_> = batch
                .map(|i| {
                    scope.spawn({
                        let draw = &draw;
                        move || draw(i)
                    })
                })
                .collect();
            threads.into_iter().map(thread::ScopedJoinHandle::join).collect()
        });
        for picture in drawn {
            take(picture.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))?;
        }
    }
    Ok(())
}
