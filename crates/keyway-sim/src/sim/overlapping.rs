//! Overlaps between many discs.

use keyway::geometry::Disc;

/// Returns for each disc the later discs in the list that it overlaps or touches, in their order.
///
/// The discs are sorted by their left ends on the x axis. Each is compared only with discs that
/// begin before it ends. So the cost grows with the discs that share a strip and with the
/// overlaps.
pub(super) fn overlapping(discs: &[Disc]) -> Vec<Vec<usize>> {
    let begins = |(disc, index): (&Disc, usize)| (disc.centre.x - disc.radius_m, index, *disc);
    let mut along: Vec<(f64, usize, Disc)> = discs.iter().zip(0..).map(begins).collect();
    along.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut later = vec![Vec::new(); discs.len()];
    for (place, &(_, one, Disc { centre, radius_m, .. })) in along.iter().enumerate() {
        let end = centre.x + radius_m;
        let beside = along[place + 1..].iter().take_while(|(begin, ..)| *begin <= end);
        for (_, other, disc) in beside {
            let radii_m = radius_m + disc.radius_m;
            if (centre - disc.centre).norm_sq() <= radii_m * radii_m {
                later[one.min(*other)].push(one.max(*other));
            }
        }
    }
    for others in &mut later {
        others.sort_unstable();
    }
    later
}

#[cfg(test)]
mod tests {
    use super::*;
    use keyway::geometry::{Disc, Point};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn all_pairs_that_overlap_are_found(
            discs in prop::collection::vec((-9.0..9.0f64, -9.0..9.0f64, 0.0..3.0f64), 0..40), is_level in any::<bool>(),
        ) {
            let disc = |&(x, y, radius_m): &(f64, f64, f64)| {
                let on_line = |at: f64| if is_level { at.round() } else { at };
                Disc::new(Point::new(on_line(x), on_line(y)), on_line(radius_m))
            };
            let discs: Vec<Disc> = discs.iter().map(disc).collect();
            let meets = |a: usize, b: usize| {
                let radii_m = discs[a].radius_m + discs[b].radius_m;
                (discs[a].centre - discs[b].centre).norm_sq() <= radii_m * radii_m
            };
            let of_one = |a: usize| (a + 1..discs.len()).filter(|&b| meets(a, b)).collect();
            let all: Vec<Vec<usize>> = (0..discs.len()).map(of_one).collect();
            prop_assert_eq!(overlapping(&discs), all);
        }
    }
}
