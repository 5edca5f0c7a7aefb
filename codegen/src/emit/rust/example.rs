//! Values of parameters for tests and examples.

use crate::emit::combinations::combinations;
use crate::expr::evaluate_f64;
use crate::model::{Interval, JointSpec};
use num_traits::ToPrimitive;

/// The first value, and how much the next ones differ: equal values would hide terms such as a² − b².
const FIRST: f64 = 0.7;
const STEP: f64 = 0.15;

/// A value well below the others, as the length of a crank beside those of its linkage.
const SMALL: f64 = 0.2;

/// Sizes that are tried for each parameter where none of the simple choices meets the requirements.
const SIZES: [f64; 9] = [0.7, 1.9, 0.3, 4.5, 0.1, 12.0, 0.02, 40.0, 1.1];

/// Most combinations of sizes that are tried.
const MOST_TRIED: usize = 60_000;

/// Values inside the ranges of the parameters that meet the requirements, no two alike: in ascending order, in descending order, in ascending order with one
/// that is small, or in the first combination that does; `None` where none was found.
pub fn parameters(spec: &JointSpec) -> Option<Vec<f64>> {
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
    let ordered = [values(&|i| i), values(&|i| count - 1 - i)];
    let with_small = (0..count).map(|small| {
        let mut values = values(&|i| i);
        values[small] = within(&spec.parameters[small].range, SMALL);
        values
    });
    let ranges = spec.parameters.iter().map(|parameter| &parameter.range);
    let choices: Vec<Vec<f64>> = ranges
        .map(|range| SIZES.map(|size| within(range, size)).to_vec())
        .collect();
    let others = combinations(&choices, MOST_TRIED).filter(|values| differ(values));
    let mut tried = ordered.into_iter().chain(with_small).chain(others);
    tried.find(|values| is_allowed(spec, values))
}

fn differ(values: &[f64]) -> bool {
    (1..values.len()).all(|i| !values[..i].contains(&values[i]))
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

#[cfg(test)]
mod tests {
    use super::{is_allowed, parameters};
    use crate::spec;

    fn found(declared: &str, require: &str) -> Option<Vec<f64>> {
        let source = format!(
            "hamel = 1;\njoint test({declared}) {{ {require} config q: R1; H = trans_x(q); }}"
        );
        let joint = spec::parse(&source, "test.joint").expect("a valid spec");
        let values = parameters(&joint);
        assert!(values.iter().all(|values| is_allowed(&joint, values)));
        values
    }

    #[test]
    fn examples_meet_the_requirements() {
        let three = "a: m > 0, b: m > 0, c: m > 0";
        assert_eq!(
            found(three, "require b > a; require c > b;"),
            Some(vec![0.7, 0.85, 1.0])
        );
        assert_eq!(
            found(three, "require a > b; require b > c;"),
            Some(vec![1.0, 0.85, 0.7])
        );
        assert_eq!(
            found(three, "require a > b; require c > a;"),
            Some(vec![0.7, 0.2, 1.0])
        );
        for require in [
            "require a > b + c;",
            "require c > a + b;",
            "require b > 10 * a; require b > 10 * c;",
        ] {
            assert!(found(three, require).is_some(), "{require}");
        }
        assert_eq!(
            found(
                "a: m > 0, b: m > 0",
                "require a > 100 * b; require a < 101 * b;"
            ),
            None
        );
        assert_eq!(
            found("a: m in 0..=1, b: m > 0", "require a > b;").map(|values| values.len()),
            Some(2)
        );
    }
}
