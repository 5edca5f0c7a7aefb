//! Values of parameters for tests and examples.

use crate::expr::evaluate_f64;
use crate::model::{Interval, JointSpec};
use num_traits::ToPrimitive;

/// The first value, and how much the next ones differ: equal values would hide terms such as a² − b².
const FIRST: f64 = 0.7;
const STEP: f64 = 0.15;

/// Values inside the ranges of the parameters, no two alike: in ascending order, or in descending order where the requirements hold only so.
pub fn parameters(spec: &JointSpec) -> Vec<f64> {
    let count = spec.parameters.len();
    let of_place = |place: usize| {
        // Whole hundredths, so that the text is short.
        (100.0 * (FIRST + STEP * place as f64)).round() / 100.0
    };
    let values = |place: &dyn Fn(usize) -> usize| -> Vec<f64> {
        let ranges = spec.parameters.iter().map(|parameter| &parameter.range);
        let inside = ranges
            .enumerate()
            .map(|(i, range)| within(range, of_place(place(i))));
        inside.collect()
    };
    let ascending = values(&|i| i);
    match is_allowed(spec, &ascending) {
        true => ascending,
        false => values(&|i| count - 1 - i),
    }
}

/// A point of an interval: `size` from the only end, or that part of the way from end to end, a little shortened.
fn within(range: &Interval, size: f64) -> f64 {
    let end = |end: &Option<crate::model::End>| end.as_ref().and_then(|end| end.value.to_f64());
    match (end(&range.lower), end(&range.upper)) {
        (None, None) => size,
        (Some(lower), None) => lower + size,
        (None, Some(upper)) => upper - size,
        (Some(lower), Some(upper)) => lower + (upper - lower) * size / (1.0 + size),
    }
}

fn is_allowed(spec: &JointSpec, values: &[f64]) -> bool {
    let value = |symbol: &crate::expr::Symbol| {
        values
            .get(usize::from(symbol.index))
            .copied()
            .unwrap_or(f64::NAN)
    };
    let holds = |margin: &crate::expr::Expr| evaluate_f64(margin, &value) > 0.0;
    spec.requirements
        .iter()
        .all(|requirement| holds(&requirement.value.value))
}
