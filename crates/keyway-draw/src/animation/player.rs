//! Animations of many pictures over the same map.

use super::Animation;
use crate::map_picture::{Layout, MapPicture};
use crate::raster::DrawError;
use keyway_sim::parallel::{in_parallel, processors};
use resvg::tiny_skia::Pixmap;

/// Display time of the result \[1/100 s\].
const RESULT_CS: u16 = 200;
/// Maximum number of cells along the longer side of a picture; larger maps are drawn in blocks.
const MAX_SIDE_CELLS: i32 = 1024;

/// Animates `pictures` pictures, each shown for this many hundredths of a second, followed by
/// `still`, the picture of the result, for 2 s. The animation has one pixel per unit of `still`.
///
/// `frame` returns a picture by its number, from 0. All pictures have the layout of `still`, with
/// a legend that covers all of them. The map and its tints are drawn once, so they must be the
/// same in all pictures. Colours are those of `still` and of the legend. `progress` is called
/// with the number of pictures drawn so far, and their total.
///
/// ```
/// use keyway::geometry::Point;
/// use keyway::map::OccupancyGrid;
/// use keyway_draw::layers::{Caption, StartMark};
/// use keyway_draw::{MapPicture, animate_frames};
///
/// let map = OccupancyGrid::from_ascii(&["....", ".##.", "...."]);
/// let at = |i: usize| MapPicture::new(&map).with(StartMark(Point::new(0.5 + i as f64, 0.5)));
/// let frame = |i: usize| at(i).with(Caption(format!("{i} s")));
/// let animation = animate_frames(&at(3), 3, 100, frame, |_, _| ())?;
/// assert_eq!((animation.frames(), animation.duration_s()), (4, 5.0));
/// # Ok::<(), keyway_draw::DrawError>(())
/// ```
///
/// # Errors
/// Returns [`DrawError`] if a picture cannot be drawn.
pub fn animate_frames<'a>(
    still: &MapPicture<'a>,
    pictures: usize,
    centiseconds: u16,
    frame: impl Fn(usize) -> MapPicture<'a> + Sync,
    progress: impl FnMut(usize, usize),
) -> Result<Animation, DrawError> {
    let layout = still.layout_with((0..pictures).map(&frame));
    play(still, &layout, 1.0, (pictures, centiseconds), frame, progress)
}

/// The same in a given layout, with this many pixels per unit of it.
pub(super) fn play<'a>(
    still: &MapPicture<'_>,
    layout: &Layout,
    scale: f64,
    (pictures, centiseconds): (usize, u16),
    frame: impl Fn(usize) -> MapPicture<'a> + Sync,
    mut progress: impl FnMut(usize, usize),
) -> Result<Animation, DrawError> {
    let last = still.svg_in(layout);
    let mut animation = Animation::new(&last, scale)?;
    let frame = |i: usize| frame(i).max_side_cells(MAX_SIDE_CELLS);
    let ground = still.ground_in(layout, MAX_SIDE_CELLS).to_pixels(scale)?;
    let draw = |i: usize| {
        let mut pixels = ground.clone();
        frame(i).over_ground_in(layout).draw_over(&mut pixels, scale)?;
        Ok(pixels)
    };
    let mut done = 0;
    in_order(pictures, draw, |pixels| {
        animation.push_pixels(&pixels?, centiseconds)?;
        done += 1;
        progress(done, pictures);
        Ok(())
    })?;
    animation.push(&last, RESULT_CS)?;
    Ok(animation)
}

/// Draws pictures on all processors, a few at a time, and passes them on in order.
fn in_order(
    count: usize,
    draw: impl Fn(usize) -> Result<Pixmap, DrawError> + Sync,
    mut take: impl FnMut(Result<Pixmap, DrawError>) -> Result<(), DrawError>,
) -> Result<(), DrawError> {
    let workers = processors();
    let numbers: Vec<usize> = (0..count).collect();
    for batch in numbers.chunks(workers) {
        in_parallel(batch, workers, |&i| draw(i)).into_iter().try_for_each(&mut take)?;
    }
    Ok(())
}
