//! The target points of the guides: key points of You 2021, local goals of S1.

use super::window::State;
use keyway::geometry::Polyline;

fn points(path: &Polyline) -> Vec<(f64, f64)> {
    path.points().iter().map(|point| (point.x, point.y)).collect()
}

fn away(state: State, point: (f64, f64)) -> f64 {
    ((point.0 - state.x).powi(2) + (point.1 - state.y).powi(2)).sqrt()
}

/// Step (6): within R2 of the current key point the next one is taken.
pub(crate) struct KeyPoint {
    left: Vec<(f64, f64)>,
}

impl KeyPoint {
    pub(crate) fn on(path: &Polyline) -> Self {
        let mut left = points(path);
        left.remove(0);
        Self { left }
    }

    pub(crate) fn at(&mut self, state: State) -> (f64, f64) {
        while self.left.len() > 1 && away(state, self.left[0]) <= 1.5 {
            self.left.remove(0);
        }
        self.left[0]
    }
}

/// A point every 2 m along the path, and the goal; the next one is taken within 0.5 m.
pub(crate) struct LocalGoal {
    left: Vec<(f64, f64)>,
}

impl LocalGoal {
    pub(crate) fn on(path: &Polyline) -> Self {
        let corners = points(path);
        let mut left = Vec::new();
        let (mut before, mut next) = (0.0, 2.0);
        for pair in corners.windows(2) {
            let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
            let length = ((x1 - x0).powi(2) + (y1 - y0).powi(2)).sqrt();
            while next <= before + length {
                let part = (next - before) / length;
                left.push((x0 + (x1 - x0) * part, y0 + (y1 - y0) * part));
                next += 2.0;
            }
            before += length;
        }
        left.push(*corners.last().unwrap());
        Self { left }
    }

    pub(crate) fn at(&mut self, state: State) -> (f64, f64) {
        while self.left.len() > 1 && away(state, self.left[0]) <= 0.5 {
            self.left.remove(0);
        }
        self.left[0]
    }
}
