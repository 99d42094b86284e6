//! Outlines of the regions of a set of cells: one SVG path, without seams between cells.

use std::fmt::Write as _;

/// A direction along the grid lines, counter-clockwise: +x, +y, -x, -y.
const STEPS: [(i32, i32); 4] = [(1, 0), (0, 1), (-1, 0), (0, -1)];

/// Returns SVG path data for the cells (x, y) with 0 <= x < `width`, 0 <= y < `height` that are
/// `inside`; cell (x, y) is the unit square from (x, y) to (x + 1, y + 1). Empty if there are
/// none.
///
/// Outer borders run counter-clockwise and holes clockwise, so that both fill rules paint exactly
/// the cells. Returns `None` as soon as the text exceeds `max_bytes`.
pub(crate) fn outline(
    width: i32,
    height: i32,
    inside: impl Fn(i32, i32) -> bool,
    max_bytes: usize,
) -> Option<String> {
    let at = |x: i32, y: i32| x >= 0 && y >= 0 && x < width && y < height && inside(x, y);
    let mut walk = Walk { at, width, seen: vec![false; width as usize * height as usize] };
    let mut path = String::new();
    // Position of the pen: the beginning of the loop drawn last.
    let mut pen = (0, 0);
    for y in 0..height {
        for x in 0..width {
            // Every loop has a lower edge, and the first one found is at its lower left corner.
            if (walk.at)(x, y) && !(walk.at)(x, y - 1) && !walk.seen[walk.index(x, y)] {
                let _ = write!(path, "m{} {}", x - pen.0, y - pen.1);
                walk.around((x, y), &mut path);
                pen = (x, y);
                if path.len() > max_bytes {
                    return None;
                }
            }
        }
    }
    Some(path)
}

/// Follows the border of a set with the set on its left.
struct Walk<F> {
    at: F,
    width: i32,
    /// Cells whose lower edge has been drawn.
    seen: Vec<bool>,
}

impl<F: Fn(i32, i32) -> bool> Walk<F> {
    fn index(&self, x: i32, y: i32) -> usize {
        y as usize * self.width as usize + x as usize
    }

    /// Writes the loop that begins at `start` with a step to +x, and marks its lower edges.
    fn around(&mut self, start: (i32, i32), path: &mut String) {
        let (mut x, mut y) = start;
        let (mut direction, mut run) = (0, 0);
        loop {
            if direction == 0 {
                let index = self.index(x, y);
                self.seen[index] = true;
            }
            let (dx, dy) = STEPS[direction];
            (x, y, run) = (x + dx, y + dy, run + 1);
            let turned = self.turn(x, y, direction);
            if turned != direction {
                // The last, closing edge is drawn by `z`.
                if (x, y) == start && turned == 0 {
                    path.push('z');
                    return;
                }
                let (letter, sign) = [('h', 1), ('v', 1), ('h', -1), ('v', -1)][direction];
                let _ = write!(path, "{letter}{}", sign * run);
                (direction, run) = (turned, 0);
            }
        }
    }

    /// Returns the direction in which the border continues from the grid point (x, y). Cells that
    /// touch only at a corner are separate.
    fn turn(&self, x: i32, y: i32, direction: usize) -> usize {
        // The cells ahead on the left and on the right, by direction.
        let (left, right) = [
            ((x, y), (x, y - 1)),
            ((x - 1, y), (x, y)),
            ((x - 1, y - 1), (x - 1, y)),
            ((x, y - 1), (x - 1, y - 1)),
        ][direction];
        if !(self.at)(left.0, left.1) {
            (direction + 1) % 4
        } else if (self.at)(right.0, right.1) {
            (direction + 3) % 4
        } else {
            direction
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Returns the corners of the loops in path data.
    fn loops(path: &str) -> Vec<Vec<(i32, i32)>> {
        let mut pen = (0, 0);
        let mut all = Vec::new();
        for part in path.split_terminator('z') {
            let mut points = Vec::new();
            let spaced = part.replace('h', " h").replace('v', " v");
            for word in spaced.split(' ') {
                let value: i32 = word.trim_start_matches(['m', 'h', 'v']).parse().unwrap();
                match word.as_bytes()[0] {
                    b'm' | b'h' => pen.0 += value,
                    _ => pen.1 += value,
                }
                if word.as_bytes()[0] != b'm' {
                    points.push(pen);
                }
            }
            // The next `m` is relative to the beginning of this loop.
            pen = points[0];
            all.push(points);
        }
        all
    }

    /// Winding number of the loops around the centre of a cell, counter-clockwise.
    fn winding(loops: &[Vec<(i32, i32)>], x: i32, y: i32) -> i32 {
        let mut count = 0;
        for points in loops {
            for (i, &(ax, ay)) in points.iter().enumerate() {
                let (bx, by) = points[(i + 1) % points.len()];
                // Counts vertical edges right of the centre that cross its height.
                if ax == bx && ax > x && ay.min(by) <= y && ay.max(by) > y {
                    count += (by - ay).signum();
                }
            }
        }
        count
    }

    #[test]
    fn by_hand() {
        let draw = |rows: &[&str]| {
            let (width, height) = (rows[0].len() as i32, rows.len() as i32);
            let inside =
                |x: i32, y: i32| rows[(height - 1 - y) as usize].as_bytes()[x as usize] == b'#';
            outline(width, height, inside, 1000).unwrap()
        };
        assert_eq!(draw(&["..", ".."]), "");
        assert_eq!(draw(&["#"]), "m0 0h1v1h-1z");
        assert_eq!(draw(&["##.", "###"]), "m0 0h3v1h-1v1h-2z");
        assert_eq!(draw(&[".#", "#."]), "m0 0h1v1h-1zm1 1h1v1h-1z");
        assert_eq!(draw(&["###", "#.#", "###"]), "m0 0h3v3h-3zm1 2h1v-1h-1z");
        assert_eq!(outline(9, 9, |x, y| (x + y) % 2 == 0, 20), None);
    }

    proptest! {
        #[test]
        fn paints_exactly_the_cells(width in 1i32..12, height in 1i32..12,
                                    bits in prop::collection::vec(any::<bool>(), 144)) {
            let inside = |x: i32, y: i32| bits[(y * 12 + x) as usize];
            let path = outline(width, height, inside, usize::MAX).unwrap();
            let loops = loops(&path);
            for y in -1..=height {
                for x in -1..=width {
                    let set = x >= 0 && y >= 0 && x < width && y < height && inside(x, y);
                    prop_assert_eq!(winding(&loops, x, y), i32::from(set), "{} {} {}", x, y, path);
                }
            }
        }
    }
}
