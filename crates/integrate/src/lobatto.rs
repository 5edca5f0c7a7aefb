//! Lobatto's quadrature on [0, 1], and polynomials in the basis of Legendre.
//!
//! A polynomial z on a step of unit length is determined by its change Δ over the step and its slopes ż at the nodes: with
//! `ż = Σ c_k P_k`, c₀ is Δ, and z is `z₀ + τ Δ + Σ_{k ≥ 1} c_k ∫P_k`, whose integrals vanish at both ends.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;
use num_traits::Float;

/// The highest degree of polynomials: as many nodes at most.
pub(super) const MOST_DEGREE: usize = 12;

/// Values of P_0, P_1, … at one point.
pub(super) type Values = [f64; MOST_DEGREE + 1];

/// The rule with a given number of nodes.
#[derive(Clone, Debug)]
pub(super) struct Lobatto {
    /// From 0 to 1, ascending.
    pub(super) nodes: Vec<f64>,
    /// With the sum 1.
    pub(super) weights: Vec<f64>,
    /// Row k − 1: from the slopes at all nodes to c_k, for k from 1 on.
    pub(super) transform: Vec<Vec<f64>>,
}

impl Lobatto {
    /// The rule with `count` nodes, from 3 to [`MOST_DEGREE`].
    pub(super) fn new(count: usize) -> Self {
        let last = count - 1;
        let roots: Vec<f64> = (0..count).map(|i| node(last, i)).collect();
        let weight = |x: &f64| {
            let value = legendre(*x)[last];
            1.0 / ((last * count) as f64 * value * value)
        };
        let weights: Vec<f64> = roots.iter().map(weight).collect();
        let row = |k: usize| {
            let values: Vec<f64> = roots.iter().map(|&x| legendre(x)[k]).collect();
            let terms = values.iter().zip(&weights);
            let norm: f64 = terms.clone().map(|(p, b)| b * p * p).sum();
            terms.map(|(p, b)| b * p / norm).collect()
        };
        Self {
            transform: (1..count).map(row).collect(),
            nodes: roots.iter().map(|x| 0.5 * (1.0 + x)).collect(),
            weights,
        }
    }

    /// The interior node whose slope the others and the change determine: the weight there is the largest, or as good as.
    pub(super) fn middle(&self) -> usize {
        self.nodes.len() / 2
    }

    /// `slopes[middle]` from the others and from the change.
    pub(super) fn complete(&self, change: &[f64], slopes: &mut [Vec<f64>]) {
        let middle = self.middle();
        let (before, rest) = slopes.split_at_mut(middle);
        let Some((own, after)) = rest.split_first_mut() else {
            return;
        };
        own.copy_from_slice(change);
        let others = before.iter().chain(&*after);
        let weights = self.weights[..middle]
            .iter()
            .chain(&self.weights[middle + 1..]);
        for (slope, weight) in others.zip(weights) {
            super::step_state::add(own, -weight, slope);
        }
        for entry in own {
            *entry /= self.weights[middle];
        }
    }
}

/// P_0, P_1, … at `x` in [−1, 1].
fn legendre(x: f64) -> Values {
    let mut values = [1.0; MOST_DEGREE + 1];
    values[1] = x;
    for k in 1..MOST_DEGREE {
        let n = k as f64;
        values[k + 1] = ((2.0 * n + 1.0) * x * values[k] - n * values[k - 1]) / (n + 1.0);
    }
    values
}

/// Entry k: the integral of P_k from 0 to `tau`, with P_k read on [0, 1]; the first is `tau`.
pub(super) fn integrals(tau: f64) -> Values {
    let values = legendre(2.0 * tau - 1.0);
    let mut integrals = [0.0; MOST_DEGREE + 1];
    integrals[0] = tau;
    for k in 1..MOST_DEGREE {
        integrals[k] = (values[k + 1] - values[k - 1]) / (2 * (2 * k + 1)) as f64;
    }
    integrals
}

/// Node i of the rule on [−1, 1] with `last + 1` nodes: the ends, and the extrema of P_last between them, by Newton's method from those of Chebyshev's
/// polynomial.
fn node(last: usize, i: usize) -> f64 {
    if i == 0 || i == last {
        return if i == 0 { -1.0 } else { 1.0 };
    }
    let mut x = -Float::cos(PI * i as f64 / last as f64);
    // Four steps reach rounding at all degrees here.
    for _ in 0..8 {
        let values = legendre(x);
        x -= (x * values[last] - values[last - 1]) / ((last + 1) as f64 * values[last]);
    }
    x
}

/// Room for slopes at all nodes of the largest rule, or for all coefficients.
pub(super) fn rows(size: usize) -> Vec<Vec<f64>> {
    vec![vec![0.0; size]; MOST_DEGREE]
}

#[cfg(test)]
mod tests {
    use super::{Lobatto, MOST_DEGREE, integrals, rows};

    /// τ^n.
    fn power(tau: f64, n: usize) -> f64 {
        tau.powi(i32::try_from(n).expect("small"))
    }

    #[test]
    fn quadrature_is_exact_up_to_its_degree() {
        for count in 3..=MOST_DEGREE {
            let rule = Lobatto::new(count);
            for n in 0..=2 * count - 3 {
                let terms = rule.nodes.iter().zip(&rule.weights);
                let sum: f64 = terms.map(|(&x, b)| b * power(x, n)).sum();
                // A dozen rounded terms below 1.
                assert!(
                    (sum * (n + 1) as f64 - 1.0).abs() < 1e-14,
                    "{count}, {n}: {sum}"
                );
            }
        }
    }

    /// Monomials come back from their slopes at all nodes but one, and their change.
    #[test]
    fn polynomials_come_back_from_slopes_and_change() {
        for count in 3..=MOST_DEGREE {
            let rule = Lobatto::new(count);
            for n in 1..=count {
                let mut slopes = rows(1);
                for (slope, &x) in slopes.iter_mut().zip(&rule.nodes) {
                    slope[0] = n as f64 * power(x, n - 1);
                }
                slopes[rule.middle()][0] = f64::NAN;
                rule.complete(&[1.0], &mut slopes[..count]);
                for tau in [0.0, 0.1, 0.5, 0.83, 1.0] {
                    let weights = integrals(tau);
                    let coefficient = |row: &Vec<f64>| -> f64 {
                        row.iter().zip(&slopes).map(|(t, s)| t * s[0]).sum()
                    };
                    let terms = rule.transform.iter().zip(&weights[1..]);
                    let bent: f64 = terms.map(|(row, w)| w * coefficient(row)).sum();
                    // Slopes up to 12, in sums of a dozen terms.
                    let error = (tau + bent - power(tau, n)).abs();
                    assert!(
                        error < 1e-13,
                        "{count} nodes, degree {n}, at {tau}: {error:e}"
                    );
                }
            }
        }
    }
}
