//! A robot's own body in its scans.

use super::{Reading, Scan};
use crate::geometry::Point;
use crate::robot::Footprint;

/// Takes the robot's own body out of its scans.
///
/// Nothing else can be where the robot is: what a beam meets inside of the footprint is a post of
/// the housing, a cable or a gripper. Such a beam says nothing.
///
/// Memory: that of a scan, once the robot has seen itself.
#[derive(Clone, Debug, Default)]
pub(crate) struct OwnBody {
    /// Scratch of [`Self::taken_out`], without meaning between calls.
    scan: Scan,
}

impl OwnBody {
    /// The scan without what lies inside of the footprint. Costs a comparison per beam, and a copy
    /// where something does.
    pub(crate) fn taken_out<'a>(&'a mut self, footprint: &Footprint, scan: &'a Scan) -> &'a Scan {
        let is_own = |&beam: &usize| is_own(footprint, scan, beam);
        let Some(first) = (0..scan.ranges_m.len()).find(is_own) else { return scan };
        self.scan.copy_from(scan);
        for beam in (first..scan.ranges_m.len()).filter(is_own) {
            self.scan.ranges_m[beam] = f64::NAN;
        }
        &self.scan
    }
}

/// True if a beam meets something inside of the footprint.
fn is_own(footprint: &Footprint, scan: &Scan, beam: usize) -> bool {
    let Some(Reading::Hit(range_m)) = scan.reading(beam) else { return false };
    range_m <= footprint.circumscribed_radius_m() && {
        let (sin, cos) = libm::sincos(scan.bearing_rad(beam));
        footprint.covers(Point::new(cos, sin) * range_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// Ahead, to the left, behind, to the right.
    fn scan(ranges_m: [f64; 4]) -> Scan {
        Scan {
            angle_min_rad: 0.0,
            angle_increment_rad: FRAC_PI_2,
            range_min_m: 0.0,
            range_max_m: 3.0,
            ranges_m: ranges_m.to_vec(),
        }
    }

    #[test]
    fn what_is_inside_of_the_footprint_says_nothing() {
        let disc = Footprint::circle(0.2).unwrap();
        let rectangle = Footprint::rectangle(0.6, 0.3).unwrap();
        let ranges_m = [0.19, 0.16, 0.25, f64::INFINITY];
        for (footprint, own) in
            [(disc, [true, true, false, false]), (rectangle, [true, false, true, false])]
        {
            let mut body = OwnBody::default();
            let scan = scan(ranges_m);
            let left = body.taken_out(&footprint, &scan);
            for (beam, own) in own.into_iter().enumerate() {
                let expected = if own { None } else { scan.reading(beam) };
                assert_eq!(left.reading(beam), expected, "{footprint} {beam}");
            }
            assert_eq!((left.angle_increment_rad, left.range_max_m), (FRAC_PI_2, 3.0));
        }
    }

    #[test]
    fn a_scan_of_other_things_is_left_as_it_is() {
        let (mut body, scan) = (OwnBody::default(), scan([0.21, 0.3, f64::NAN, f64::INFINITY]));
        let disc = Footprint::circle(0.2).unwrap();
        assert!(std::ptr::eq(body.taken_out(&disc, &scan), &raw const scan));
        // A point has no body.
        let near = Scan { ranges_m: vec![1e-9; 4], ..scan };
        assert!(std::ptr::eq(body.taken_out(&Footprint::POINT, &near), &raw const near));
    }
}
