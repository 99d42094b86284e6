//! The ranges of a scan, read in place from a driver's memory.

/// Ranges of all beams of a scan \[m\], owned or borrowed, in single or double precision.
pub trait Ranges {
    /// Borrows the ranges.
    fn as_ranges(&self) -> RangesRef<'_>;
}

/// Borrowed ranges of all beams of a scan \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RangesRef<'a> {
    /// In single precision, as in ROS `sensor_msgs/LaserScan`.
    F32(&'a [f32]),
    /// In double precision.
    F64(&'a [f64]),
}

impl RangesRef<'_> {
    /// Number of beams.
    pub const fn len(self) -> usize {
        match self {
            Self::F32(ranges_m) => ranges_m.len(),
            Self::F64(ranges_m) => ranges_m.len(),
        }
    }

    /// True without beams.
    pub const fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Range of a beam \[m\]; `None` if the beam does not exist.
    pub fn get(self, beam: usize) -> Option<f64> {
        match self {
            Self::F32(ranges_m) => ranges_m.get(beam).copied().map(f64::from),
            Self::F64(ranges_m) => ranges_m.get(beam).copied(),
        }
    }

    /// Ranges of all beams \[m\], in order.
    pub fn iter(self) -> impl Iterator<Item = f64> {
        (0..self.len()).filter_map(move |beam| self.get(beam))
    }
}

impl Ranges for RangesRef<'_> {
    fn as_ranges(&self) -> RangesRef<'_> {
        *self
    }
}

impl Ranges for [f32] {
    fn as_ranges(&self) -> RangesRef<'_> {
        RangesRef::F32(self)
    }
}

impl Ranges for [f64] {
    fn as_ranges(&self) -> RangesRef<'_> {
        RangesRef::F64(self)
    }
}

impl<T> Ranges for Vec<T>
where
    [T]: Ranges,
{
    fn as_ranges(&self) -> RangesRef<'_> {
        self.as_slice().as_ranges()
    }
}

impl<R: Ranges + ?Sized> Ranges for &R {
    fn as_ranges(&self) -> RangesRef<'_> {
        (**self).as_ranges()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sense::{Reading, Scan};

    #[test]
    fn single_precision_says_the_same_where_it_is() {
        let single: [f32; 4] = [0.5, f32::INFINITY, f32::NAN, 12.0];
        let ranges_m = single.as_slice();
        let scan = Scan { range_max_m: 10.0, ranges_m, ..Scan::default() };
        let readings: Vec<_> = (0..5).map(|beam| scan.reading(beam)).collect();
        let (hit, free) = (Some(Reading::Hit(0.5)), Some(Reading::Free(10.0)));
        assert_eq!(readings, [hit, free, None, None, None]);
        let double: Vec<f64> = ranges_m.as_ranges().iter().collect();
        let own = Scan { range_max_m: 10.0, ranges_m: double, ..Scan::default() };
        for beam in 0..5 {
            assert_eq!(own.reading(beam), scan.borrowed().reading(beam));
        }
        assert!(RangesRef::F32(&[]).is_empty() && !ranges_m.as_ranges().is_empty());
    }
}
