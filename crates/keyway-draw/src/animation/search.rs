//! Animation of the progress of a search.

use super::Animation;
use super::player::play;
use crate::layers::SearchTrace;
use crate::map_picture::MapPicture;
use crate::raster::DrawError;
use keyway::search::Recording;

/// Maximum number of pictures of a search.
const FRAMES: usize = 80;
/// Maximum display time of a search, and of each of its pictures \[1/100 s\].
const SEARCH_CS: usize = 800;
const LONGEST_FRAME_CS: usize = 40;
/// Longer side \[px\].
const SIDE_PX: f64 = 640.0;

/// Animates a search: up to 80 pictures, each with the same number of further events, for 8 s at
/// most, followed by `still`, the picture of the result, for 2 s. The longer side has 640 pixels.
///
/// `frame` returns the picture of a part of the search. It must contain everything that `still`
/// shows from the beginning on, and has the layout of `still`. The map and its tints are drawn
/// once, so they must be the same in all pictures. `progress` is called with the number of
/// pictures drawn so far, and their total.
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
/// Returns [`DrawError`] if a picture cannot be drawn, which no recording causes.
pub fn animate_search<'a>(
    recording: &'a Recording,
    still: &MapPicture<'_>,
    frame: impl Fn(SearchTrace<'a>) -> MapPicture<'a> + Sync,
    progress: impl FnMut(usize, usize),
) -> Result<Animation, DrawError> {
    let events = recording.events().len();
    let pictures = events.min(FRAMES);
    let centiseconds = (SEARCH_CS / pictures.max(1)).min(LONGEST_FRAME_CS) as u16;
    let trace = SearchTrace::new(recording);
    let frame = |i: usize| frame(trace.first(i * events / pictures.max(1)));
    let layout = still.layout();
    let scale = SIDE_PX / still.svg_in(&layout).longer_side()?;
    play(still, &layout, scale, (pictures + 1, centiseconds), frame, progress)
}
