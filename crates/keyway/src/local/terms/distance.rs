//! dist(v, omega) of \[You2021, eq. (9)\]: the footprint's distance from obstacles along the
//! trajectory.

pub(in crate::local) const NAME: &str = "distance";

/// The distance of a rollout, limited to the cap \[m\].
pub(in crate::local) const fn raw(distance_m: f64, cap_m: f64) -> f64 {
    if distance_m < cap_m { distance_m } else { cap_m }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_capped() {
        assert_eq!((raw(3.0, 5.0), raw(9.0, 5.0)), (3.0, 5.0));
    }
}
