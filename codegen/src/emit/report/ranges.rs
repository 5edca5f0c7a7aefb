//! Intervals in words.

use crate::model::{End, Interval};

/// `lead > 0`, `0 ≤ tilt < 1`, or `lead ≠ 0` where the spec has no range.
pub fn in_words(name: &str, range: &Interval) -> String {
    let below = |end: &End| if end.included { "≤" } else { "<" };
    let above = |end: &End| if end.included { "≥" } else { ">" };
    match (&range.lower, &range.upper) {
        (None, None) => format!("{name} ≠ 0"),
        (Some(lower), None) => format!("{name} {} {}", above(lower), lower.value),
        (None, Some(upper)) => format!("{name} {} {}", below(upper), upper.value),
        (Some(lower), Some(upper)) => format!(
            "{} {} {name} {} {}",
            lower.value,
            below(lower),
            below(upper),
            upper.value
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::in_words;
    use crate::expr::Rational;
    use crate::model::{End, Interval};

    #[test]
    fn every_kind_of_interval_has_words() {
        let end = |value: i64, included| {
            let value = Rational::from_integer(value.into());
            Some(End { value, included })
        };
        let words = |lower, upper| in_words("a", &Interval { lower, upper });
        assert_eq!(words(None, None), "a ≠ 0");
        assert_eq!(words(end(0, false), None), "a > 0");
        assert_eq!(words(end(0, true), None), "a ≥ 0");
        assert_eq!(words(None, end(2, false)), "a < 2");
        assert_eq!(words(end(0, true), end(2, false)), "0 ≤ a < 2");
    }
}
