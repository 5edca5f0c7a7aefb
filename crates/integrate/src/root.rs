//! Where a function crosses zero.

use num_traits::Float;

/// The end `b` of an interval, no longer than `width`, over which `f` changes its sign, or a point where it is 0.
///
/// By the method ITP of I. F. D. Oliveira and R. H. C. Takahashi (*An enhancement of the bisection method average performance preserving minmax
/// optimality*, 2020), with κ₁ = 0.2 / (b − a), κ₂ = 2 and n₀ = 1: at most one evaluation more than bisection takes, and few where f is smooth.
/// `from` and `to` are ends of an interval with the values there, of different sign or 0 in `from`.
pub(super) fn cross<E>(
    (mut a, mut at_a): (f64, f64),
    (mut b, mut at_b): (f64, f64),
    width: f64,
    mut f: impl FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    if at_a == 0.0 {
        return Ok(a);
    }
    let slack = 0.2 / (b - a);
    let halvings = Float::ceil(Float::log2((b - a) / width)).max(0.0);
    // What is left of the longest interval that bisection and one step more would have.
    let mut allowed = 0.5 * width * Float::exp2(halvings + 1.0);
    while b - a > width {
        let middle = 0.5 * (a + b);
        let linear = (at_b * a - at_a * b) / (at_b - at_a);
        let away = middle - linear;
        let truncation = slack * (b - a) * (b - a);
        let truncated = if truncation <= away.abs() {
            linear + truncation.copysign(away)
        } else {
            middle
        };
        let radius = allowed - 0.5 * (b - a);
        let x = if (truncated - middle).abs() <= radius {
            truncated
        } else {
            middle - radius.copysign(away)
        };
        // Neighbouring numbers, or an f that makes no sense of an end.
        let x = if x > a && x < b { x } else { middle };
        if !(x > a && x < b) {
            break;
        }
        let at_x = f(x)?;
        if at_x == 0.0 {
            return Ok(x);
        }
        if (at_x > 0.0) == (at_b > 0.0) {
            (b, at_b) = (x, at_x);
        } else {
            (a, at_a) = (x, at_x);
        }
        allowed *= 0.5;
    }
    Ok(b)
}

#[cfg(test)]
mod tests {
    use super::cross;

    /// The root in [0, 1], and how many evaluations it took.
    fn solve(f: impl Fn(f64) -> f64) -> (f64, usize) {
        let mut count = 0;
        let root = cross((0.0, f(0.0)), (1.0, f(1.0)), f64::EPSILON, |x| {
            count += 1;
            Ok::<_, ()>(f(x))
        });
        (root.expect("nothing fails"), count)
    }

    #[test]
    fn roots_are_found_to_rounding() {
        for root in [1e-9_f64, 0.1, 0.5, 0.7, 1.0 - 1e-9] {
            let (found, count) = solve(|x| (x - root) * (2.0 + x).exp());
            assert!((found - root).abs() <= f64::EPSILON, "{root}: {found}");
            // Superlinear: a fourth of what bisection takes.
            assert!(count <= 14, "{root}: {count} evaluations");
        }
    }

    #[test]
    fn no_function_takes_more_than_bisection_and_one() {
        let functions: [fn(f64) -> f64; 3] = [
            |x| if x < 0.3 { -1e-12 } else { 1e12 },
            |x| (x - 0.3).powi(9),
            |x| 1.0 - 1.0 / (x + 1e-12) * 0.3,
        ];
        for f in functions {
            let (found, count) = solve(f);
            assert!((found - 0.3).abs() < 1e-2, "{found}");
            assert!(count <= 53, "{count}");
        }
    }

    #[test]
    fn a_zero_at_the_beginning_is_the_root() {
        let found = cross((0.0, 0.0), (1.0, -1.0), 1e-16, |_| Err("needless"));
        assert_eq!(found, Ok(0.0));
    }
}
