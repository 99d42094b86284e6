//! An open list for values that are propagated with at least a certain growth.

/// Waiting points in buckets of values. A bucket is as wide as the least growth, so the points in
/// the lowest one cannot become lower, and may be taken in any order.
#[derive(Debug, Default)]
pub(super) struct Buckets {
    waiting: Vec<Vec<u32>>,
    /// Index of the first bucket that may hold anything.
    first: usize,
    per_value: f32,
}

impl Buckets {
    /// Number of regular buckets; larger values wait in a last one.
    const MOST: usize = 1 << 14;

    /// Empties all buckets; the memory is kept.
    pub(super) fn clear(&mut self, least_growth: f32) {
        self.waiting.iter_mut().for_each(Vec::clear);
        self.first = 0;
        self.per_value = 1.0 / least_growth;
    }

    pub(super) fn push(&mut self, value: f32, point: u32) {
        let bucket = ((value * self.per_value) as usize).min(Self::MOST);
        if bucket >= self.waiting.len() {
            self.waiting.resize_with(bucket + 1, Vec::new);
        }
        self.waiting[bucket].push(point);
    }

    /// Removes one of the points in the lowest bucket.
    pub(super) fn pop(&mut self) -> Option<u32> {
        while let Some(bucket) = self.waiting.get_mut(self.first) {
            if let Some(point) = bucket.pop() {
                return Some(point);
            }
            self.first += 1;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lower_buckets_come_first() {
        let mut buckets = Buckets::default();
        for _ in 0..2 {
            buckets.clear(0.5);
            for (value, point) in [(3.2, 7), (0.1, 1), (1.9, 4), (1e30, 9), (0.4, 2)] {
                buckets.push(value, point);
            }
            let order: Vec<_> = std::iter::from_fn(|| buckets.pop()).collect();
            assert_eq!(order, [2, 1, 4, 7, 9]);
        }
    }
}
