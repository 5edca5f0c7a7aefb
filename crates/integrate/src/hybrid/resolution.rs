//! Whether a guard's values at the ends of the parts of a step tell what it does between them.

use crate::event_location::PARTS;

/// A guard that nothing crosses is trusted where its fourth difference is within this part of the least of its values; one that is crossed, of the largest.
const RESOLVED: f64 = 0.25;

/// What a parabola through three values may miss between them, as a part of the third differences: 1/(9√3), and some.
const MISSED: f64 = 0.1;

/// The largest third difference, and the fourth.
fn differences(values: &[f64; PARTS + 1]) -> (f64, f64) {
    let [a, b, c, d, e] = *values;
    let thirds = [d - 3.0 * c + 3.0 * b - a, e - 3.0 * d + 3.0 * c - b];
    let third = thirds.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    (third, (a - 4.0 * b + 6.0 * c - 4.0 * d + e).abs())
}

/// Whether they do not; `is_first` where the piece that the guard ends begins with the step, and the guard may begin at 0.
pub(crate) fn is_unresolved(values: &[f64; PARTS + 1], is_first: bool) -> bool {
    let (third, fourth) = differences(values);
    let later = &values[1..];
    let least = later.iter().fold(f64::INFINITY, |least, v| least.min(*v));
    let most = later.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    if least < 0.0 {
        return fourth > RESOLVED * most;
    }
    // Where it begins at 0 it has its least value there, and rises.
    let begins = is_first && values[0] < RESOLVED * values[1];
    let mut triples = values.windows(3).skip(usize::from(begins));
    fourth > RESOLVED * least
        || triples.any(|triple| dip(triple).is_some_and(|dip| dip < MISSED * third + fourth))
}

/// Whether a guard comes down to less than what it changes by, and goes up again.
pub(crate) fn may_dip(values: &[f64; PARTS + 1]) -> bool {
    let most = values
        .iter()
        .fold(f64::NEG_INFINITY, |most, v| most.max(*v));
    let mut dips = values.windows(3).filter_map(dip);
    dips.any(|dip| dip < most - dip)
}

/// The least value of the parabola through three values next to each other, where it lies between them.
fn dip(values: &[f64]) -> Option<f64> {
    let &[a, b, c] = values else { return None };
    let (slope, bend) = (0.5 * (c - a), c - 2.0 * b + a);
    (slope.abs() < bend).then(|| b - 0.5 * slope * slope / bend)
}

#[cfg(test)]
mod tests {
    use super::is_unresolved;

    fn values(f: impl Fn(f64) -> f64, step: f64) -> [f64; 5] {
        [0.0, 1.0, 2.0, 3.0, 4.0].map(|i| f(0.25 * i * step))
    }

    #[test]
    fn a_dip_between_values_is_seen() {
        // Below 0 within 1e-3 of 0.6, where no value is.
        let dips = |t: f64| (t - 0.6) * (t - 0.6) - 1e-6;
        assert!(is_unresolved(&values(dips, 1.0), false));
        // As far above 0 as below before.
        let clears = |t: f64| (t - 0.6) * (t - 0.6) + 1e-6;
        assert!(!is_unresolved(&values(clears, 1.0), false));
    }

    #[test]
    fn swings_must_be_followed() {
        let swings = |t: f64| 1.5 + t.sin();
        assert!(is_unresolved(&values(swings, 12.0), false));
        assert!(!is_unresolved(&values(swings, 1.0), false));
        // Far from 0 it does not matter.
        assert!(!is_unresolved(&values(|t| 100.0 + t.sin(), 12.0), false));
    }

    #[test]
    fn a_guard_may_begin_at_0() {
        let begins = |t: f64| t * t + 0.1 * t * t * t;
        assert!(!is_unresolved(&values(begins, 1.0), true));
        assert!(is_unresolved(&values(begins, 1.0), false));
    }

    #[test]
    fn a_guard_that_is_crossed_needs_the_part_alone() {
        assert!(!is_unresolved(&values(|t| 0.7 - t * t, 1.0), false));
    }
}
