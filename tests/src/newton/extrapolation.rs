//! Gragg's, Bulirsch's and Stoer's method: midpoint steps extrapolated to order 2 × columns.

use super::number::{Real, real};

/// An extrapolated midpoint method with step control.
#[derive(Clone, Copy, Debug)]
pub struct Extrapolation {
    /// Its order is twice that.
    pub columns: usize,
    /// Error of one step: absolute, and relative to entries above 1.
    pub tolerance: f64,
}

/// Part of the step that the estimate of the error would allow.
const SAFETY: f64 = 0.8;
/// A step may change by this factor.
const CHANGE: (f64, f64) = (0.2, 3.0);
/// A step of this part of the whole motion is no step.
const LEAST: f64 = 1e-12;

impl Extrapolation {
    /// Moves an autonomous system's state from one time to a later one, s, and tells how many evaluations that took; `None` where steps shrink to
    /// nothing.
    pub fn advance(
        &self,
        rates: &impl Fn(&[Real], &mut [Real]),
        state: &mut Vec<Real>,
        start: f64,
        end: f64,
    ) -> Option<usize> {
        let duration = end - start;
        let (mut time, end) = (real(start), real(end));
        let mut step = duration / 64.0;
        let mut steps = 0;
        while time < end {
            let left = f64::from(end - time);
            let length = match step >= left {
                true => end - time,
                // A step that left a little would leave a step of rounding.
                false => real(step.min(left - 0.5 * step.min(left))),
            };
            let (next, error) = self.step(rates, state, length);
            steps += 1;
            let taken = f64::from(length);
            let order = (2 * self.columns - 1) as f64;
            let factor = SAFETY * (self.tolerance / error).powf(1.0 / order);
            step = taken * factor.clamp(CHANGE.0, CHANGE.1);
            if error <= self.tolerance {
                time += length;
                *state = next;
            } else if step.is_nan() || step <= LEAST * duration {
                return None;
            }
        }
        Some(steps * self.columns * (self.columns + 1))
    }

    /// One step, and the difference of the last two columns.
    fn step(
        &self,
        rates: &impl Fn(&[Real], &mut [Real]),
        state: &[Real],
        length: Real,
    ) -> (Vec<Real>, f64) {
        let mut row: Vec<Vec<Real>> = Vec::new();
        let mut error = f64::INFINITY;
        let mut start = vec![real(0.0); state.len()];
        rates(state, &mut start);
        for j in 0..self.columns {
            let count = 2 * (j + 1);
            let mut entry = midpoint(rates, state, &start, length, count);
            for l in 1..=j {
                let ratio = real((j + 1) as f64) / real((j + 1 - l) as f64);
                let weight = real(1.0) / (ratio * ratio - real(1.0));
                let next: Vec<Real> = entry
                    .iter()
                    .zip(&row[l - 1])
                    .map(|(&fine, &coarse)| fine + (fine - coarse) * weight)
                    .collect();
                if l == j {
                    error = difference(&next, &entry);
                }
                row[l - 1] = entry;
                entry = next;
            }
            row.push(entry);
        }
        (row.pop().unwrap_or_default(), error)
    }
}

/// `count` midpoint steps, an even number, from `state` with derivative `start`.
fn midpoint(
    rates: &impl Fn(&[Real], &mut [Real]),
    state: &[Real],
    start: &[Real],
    length: Real,
    count: usize,
) -> Vec<Real> {
    let step = length / real(count as f64);
    let twice = step * real(2.0);
    let mut before = state.to_vec();
    let mut now: Vec<Real> = state
        .iter()
        .zip(start)
        .map(|(&y, &f)| y + step * f)
        .collect();
    let mut slope = vec![real(0.0); state.len()];
    for _ in 1..count {
        rates(&now, &mut slope);
        for (y, &f) in before.iter_mut().zip(&slope) {
            *y += twice * f;
        }
        std::mem::swap(&mut before, &mut now);
    }
    now
}

/// The largest difference of entries, relative to entries above 1.
fn difference(a: &[Real], b: &[Real]) -> f64 {
    let larger = |m: f64, x: f64| if x <= m { m } else { x };
    let errors = a.iter().zip(b).map(|(&x, &y)| {
        let size = f64::from(x).abs().max(1.0);
        f64::from(x - y).abs() / size
    });
    errors.fold(0.0, larger)
}
