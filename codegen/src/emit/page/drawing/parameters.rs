//! Values of the parameters for a drawing: 1 where that is allowed, else a small number inside the range.

use super::sampler::Sampler;
use crate::derived::Derived;
use crate::emit::combinations::combinations;
use crate::model::Interval;
use num_traits::ToPrimitive;

/// Combinations of values that are tried before a joint is left undrawn.
const MOST_TRIED: usize = 4096;

/// The joint with the first values that meet all conditions and give it a pose at home.
pub fn sampler(derived: &Derived) -> Option<Sampler<'_>> {
    let choices: Vec<Vec<f64>> = derived
        .spec
        .parameters
        .iter()
        .map(|parameter| choices(&parameter.range))
        .collect();
    let tried = combinations(&choices, MOST_TRIED).map(|values| Sampler::new(derived, &values));
    let fits = |sampler: &Sampler<'_>| {
        sampler.meets_requirements() && sampler.pose(&sampler.home()).is_some()
    };
    let mut tried = tried.filter(fits);
    tried.next()
}

/// Values inside the interval, the best for a drawing first.
fn choices(range: &Interval) -> Vec<f64> {
    let common = [1.0, 0.5, 2.0, 0.25, 3.0, -1.0];
    let mut values: Vec<f64> = common
        .into_iter()
        .filter(|value| holds(range, *value))
        .collect();
    let end = |end: &Option<crate::model::End>| end.as_ref().and_then(|end| end.value.to_f64());
    let inner = match (end(&range.lower), end(&range.upper)) {
        (Some(lower), Some(upper)) => 0.5 * (lower + upper),
        (Some(lower), None) => lower + 1.0,
        (None, Some(upper)) => upper - 1.0,
        (None, None) => 1.0,
    };
    values.push(inner);
    values
}

fn holds(range: &Interval, value: f64) -> bool {
    let above = range.lower.as_ref().and_then(|end| end.value.to_f64());
    let below = range.upper.as_ref().and_then(|end| end.value.to_f64());
    above.is_none_or(|lower| value > lower) && below.is_none_or(|upper| value < upper)
}

#[cfg(test)]
mod tests {
    use super::choices;
    use crate::expr::Rational;
    use crate::model::{End, Interval};

    fn end(above: i64, below: i64) -> Option<End> {
        let value = Rational::new(above.into(), below.into());
        Some(End {
            value,
            included: false,
        })
    }

    #[test]
    fn a_value_lies_inside_its_range() {
        let first = |lower, upper| choices(&Interval { lower, upper })[0];
        assert_eq!(first(None, None), 1.0);
        assert_eq!(first(end(0, 1), None), 1.0);
        assert_eq!(first(end(0, 1), end(2, 5)), 0.25);
        assert_eq!(first(end(7, 1), None), 8.0);
        assert_eq!(first(end(1, 10), end(1, 5)), 0.5 * (0.1 + 0.2));
    }
}
