//! Tests of animated searches.

use super::{ROWS, search};
use keyway::geometry::{Point, Polyline};
use keyway::map::{Cell, OccupancyGrid};
use keyway::search::Recording;
use keyway_draw::layers::{GoalMark, Meeting, PathLine, SearchTrace, StartMark};
use keyway_draw::{Animation, MapPicture, animate_search};

/// Width, height, and all frames as shown: red, green and blue of each pixel.
type Film = (usize, usize, Vec<Vec<[u8; 3]>>);

fn paint(
    canvas: &mut [[u8; 3]],
    width: usize,
    at: (usize, usize),
    size: (usize, usize),
    rgba: &[u8],
) {
    for (i, pixel) in rgba.chunks(4).enumerate() {
        if pixel[3] == 255 {
            let (x, y) = (at.0 + i % size.0, at.1 + i / size.0);
            canvas[y * width + x] = [pixel[0], pixel[1], pixel[2]];
        }
    }
}

fn read_gif(bytes: &[u8]) -> Film {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut reader = options.read_info(bytes).unwrap();
    assert_eq!(reader.repeat(), gif::Repeat::Infinite);
    let (width, height) = (reader.width() as usize, reader.height() as usize);
    let mut canvas = vec![[0; 3]; width * height];
    let mut frames = Vec::new();
    while let Some(frame) = reader.read_next_frame().unwrap() {
        let at = (frame.left as usize, frame.top as usize);
        let size = (frame.width as usize, frame.height as usize);
        paint(&mut canvas, width, at, size, &frame.buffer);
        frames.push(canvas.clone());
    }
    (width, height, frames)
}

fn read_png(bytes: &[u8]) -> Film {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().unwrap();
    let (width, height) = (reader.info().width as usize, reader.info().height as usize);
    let count = reader.info().animation_control.map_or(1, |control| control.num_frames);
    let mut canvas = vec![[0; 3]; width * height];
    let mut frames = Vec::new();
    for _ in 0..count {
        let mut buffer = vec![0; 4 * width * height];
        let info = reader.next_frame(&mut buffer).unwrap();
        let size = (info.width as usize, info.height as usize);
        let control = reader.info().frame_control;
        let at = control.map_or((0, 0), |c| (c.x_offset as usize, c.y_offset as usize));
        paint(&mut canvas, width, at, size, &buffer[..4 * size.0 * size.1]);
        frames.push(canvas.clone());
    }
    (width, height, frames)
}

fn largest_difference(a: &[[u8; 3]], b: &[[u8; 3]]) -> u8 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| a.abs_diff(*b)).max().unwrap()
}

#[test]
fn both_formats_play_the_same_frames_and_end_in_the_still_picture() {
    for planner in ["astar", "bidirectional-optimal", "jps"] {
        let (grid, seen, plan) = search(planner);
        let centre = |&cell: &Cell| Point::new(f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5);
        let line = Polyline::new(plan.cells.iter().map(centre).collect());
        let (start, point) = (line.points()[0], *line.points().last().unwrap());
        let frame = |trace| {
            let picture = MapPicture::new(&grid).with(trace).with(Meeting(trace));
            picture.with(StartMark(start)).with(GoalMark { point, tolerance_m: None })
        };
        let still = frame(SearchTrace::new(&seen)).with(PathLine::planned(&line).rimmed());
        let play = || animate_search(&seen, &still, frame, |_, _| ()).unwrap();
        let animation = play();
        let (gif, apng) = (animation.to_gif().unwrap(), animation.to_apng().unwrap());
        assert_eq!((&gif, &apng), (&play().to_gif().unwrap(), &play().to_apng().unwrap()));

        let (width, height, frames) = read_gif(&gif);
        assert_eq!(width.max(height), 640, "{planner}");
        assert_eq!(animation.size_px(), (width as u16, height as u16));
        assert_eq!(frames.len(), animation.frames(), "{planner}");
        assert!(frames.len() <= 82 && animation.duration_s() <= 10.5);
        assert_eq!(read_png(&apng), (width, height, frames.clone()), "{planner}");

        let plain = still.svg();
        let size = plain.as_str().split('"').filter_map(|text| text.parse::<f64>().ok()).take(2);
        let scale = 640.0 / size.fold(0.0, f64::max);
        let (_, _, drawn) = read_png(&plain.to_png(scale).unwrap());
        let difference = largest_difference(frames.last().unwrap(), &drawn[0]);
        assert!(difference <= 16, "{planner}: {difference}");
        assert!(largest_difference(&frames[0], &drawn[0]) > 100, "{planner}: it moves");
    }
}

#[test]
fn animations_without_a_search_and_with_wrong_frames() {
    let grid = OccupancyGrid::from_ascii(&ROWS);
    let (nothing, still) = (Recording::default(), MapPicture::new(&grid));
    let frame = |trace| MapPicture::new(&grid).with(trace);
    let animation = animate_search(&nothing, &still, frame, |_, _| ()).unwrap();
    assert_eq!(animation.frames(), 1, "equal pictures are one");
    assert_eq!(read_gif(&animation.to_gif().unwrap()).2.len(), 1);
    assert_eq!(read_png(&animation.to_apng().unwrap()).2.len(), 1);

    let mut animation = Animation::new(&still.svg(), 1.0).unwrap();
    assert!(animation.to_gif().is_err() && animation.to_apng().is_err());
    let error = animation.push(&still.side_px(100.0).svg(), 1).unwrap_err();
    assert!(error.to_string().contains("one size"), "{error}");
}
