//! Central differences of order 6, on straight lines and on the manifolds of joints: an oracle that knows no derivative.
//!
//! Points are reached through Φ (`retract`), differences of points are taken through its inverse (`local`).

use hamel::mechanism::Mechanism;
use hamel::nalgebra::DMatrix;

/// Weights of f(h) − f(−h), f(2h) − f(−2h), f(3h) − f(−3h), over h: the error is `h⁶ f⁽⁷⁾ / 140`.
const WEIGHTS: [f64; 3] = [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0];

/// A step for functions that vary over lengths of order 1: rounding 2^-53 / h and truncation h⁶ f⁽⁷⁾ / 140 are both near
/// 1e-13 where f⁽⁷⁾ is of the order of 10 f.
pub const STEP: f64 = 1.0 / 128.0;

/// A step for functions that bend more: linkages near a dead point, of which h⁶ f⁽⁷⁾ is 8e-4 with [`STEP`], and 8⁶ times less with an eighth of it.
pub const FINE: f64 = STEP / 8.0;

/// `df/dt` at 0, with `h = step`.
pub fn derivative(step: f64, f: impl Fn(f64) -> DMatrix<f64>) -> DMatrix<f64> {
    let mut sum: Option<DMatrix<f64>> = None;
    for (i, weight) in WEIGHTS.iter().enumerate() {
        let t = step * (i + 1) as f64;
        let term = (f(t) - f(-t)) * (weight / step);
        sum = Some(match sum {
            Some(sum) => sum + term,
            None => term,
        });
    }
    sum.unwrap_or_else(|| f(0.0) * 0.0)
}

/// Φ(q, ϕ) of all joints, `phi` one entry per degree of freedom.
pub fn moved(mechanism: &Mechanism, q: &[f64], phi: &[f64]) -> Vec<f64> {
    let mut target = q.to_vec();
    for (_, body) in mechanism.joints() {
        let ranges = body.ranges();
        let own = &mut target[ranges.configuration.clone()];
        body.joint()
            .retract(body.configuration(q), &phi[ranges.freedoms.clone()], own);
    }
    target
}

/// The ϕ with Φ(q, ϕ) = `target`, all joints.
pub fn local(mechanism: &Mechanism, q: &[f64], target: &[f64]) -> Vec<f64> {
    let mut phi = vec![0.0; mechanism.layout().freedoms];
    for (_, body) in mechanism.joints() {
        let own = &mut phi[body.ranges().freedoms.clone()];
        body.joint()
            .local(body.configuration(q), body.configuration(target), own)
            .expect("two configurations near each other");
    }
    phi
}

/// `∂f/∂ϕ` at ϕ = 0 for a function of the configuration: slice k along ϕ_k.
pub fn gradient(
    mechanism: &Mechanism,
    q: &[f64],
    f: impl Fn(&[f64]) -> DMatrix<f64>,
) -> Vec<DMatrix<f64>> {
    gradient_with(STEP, mechanism, q, f)
}

/// As [`gradient`], with a step of one's own.
pub fn gradient_with(
    step: f64,
    mechanism: &Mechanism,
    q: &[f64],
    f: impl Fn(&[f64]) -> DMatrix<f64>,
) -> Vec<DMatrix<f64>> {
    let freedoms = mechanism.layout().freedoms;
    let along = |k: usize| {
        derivative(step, |t| {
            let mut phi = vec![0.0; freedoms];
            phi[k] = t;
            f(&moved(mechanism, q, &phi))
        })
    };
    (0..freedoms).map(along).collect()
}

/// ϕ̇ at `t = 0` of a path of configurations, K×1; ϕ is counted from `path(0)`.
pub fn local_rate(
    mechanism: &Mechanism,
    step: f64,
    path: impl Fn(f64) -> Vec<f64>,
) -> DMatrix<f64> {
    let base = path(0.0);
    derivative(step, |t| {
        let phi = local(mechanism, &base, &path(t));
        DMatrix::from_column_slice(phi.len(), 1, &phi)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::difference;
    use crate::random::{cases, library};
    use hamel::nalgebra::DVector;

    fn scalar(value: f64) -> DMatrix<f64> {
        DMatrix::from_element(1, 1, value)
    }

    /// The rule is exact up to degree 6, so that rounding is all that is left, and at degree 7 its error is 36 h⁶.
    #[test]
    fn polynomials_up_to_degree_6_are_exact() {
        let polynomial = |t: f64| 2.0 + 3.0 * t - t.powi(2) + 5.0 * t.powi(5) - 4.0 * t.powi(6);
        let slope = derivative(0.5, |t| scalar(polynomial(t)))[0];
        // Terms up to 4 · 1.5⁶ = 46, times ε, over h.
        assert!((slope - 3.0).abs() < 46.0 * f64::EPSILON / 0.5, "{slope}");
        let slope = derivative(0.5, |t| scalar(t.powi(7)))[0];
        assert!((slope - 36.0 * 0.5_f64.powi(6)).abs() < 1e-14, "{slope}");
    }

    /// Halving h takes the error down by 2⁶.
    #[test]
    fn order_is_six() {
        let error =
            |step: f64| (derivative(step, |t| scalar((1.0 + t).sin()))[0] - 1.0_f64.cos()).abs();
        let order = (error(0.4) / error(0.2)).log2();
        // The next term of the error is of relative size h² / 4: 0.04, which moves the order by 0.05.
        assert!((order - 6.0).abs() < 0.1, "order {order}");
    }

    #[test]
    fn a_path_through_retract_has_the_rate_it_was_given() {
        for case in cases(&library(), 4, 14) {
            let mut random_rate = case.efforts.clone();
            random_rate.iter_mut().for_each(|rate| *rate *= 2.0);
            let path = |t: f64| {
                let phi: Vec<f64> = random_rate.iter().map(|rate| rate * t).collect();
                moved(&case.mechanism, &case.q, &phi)
            };
            let rate = local_rate(&case.mechanism, STEP, path);
            // ε |q| / h with |q| up to 3, and 30 for the logarithm of a rotation of that size.
            let bound = 30.0 * 3.0 * f64::EPSILON / STEP;
            assert!(difference(rate.as_slice(), &random_rate) < bound);
        }
    }

    /// The gradient of Q itself is Q̇ of (31).
    #[test]
    fn gradient_of_the_configuration_is_the_kinematic_equation() {
        for case in cases(&library(), 4, 14) {
            let gradient = gradient(&case.mechanism, &case.q, |q| {
                DMatrix::from_column_slice(q.len(), 1, q)
            });
            let rate = DVector::from_column_slice(&case.efforts);
            let found = gradient
                .iter()
                .zip(&rate)
                .map(|(slice, rate)| slice * *rate);
            let found = found.fold(DMatrix::zeros(case.q.len(), 1), |sum, term| sum + term);
            let mut expected = vec![0.0; case.q.len()];
            for (_, body) in case.mechanism.joints() {
                let (ranges, q) = (body.ranges(), body.configuration(&case.q));
                let size = ranges.freedoms.len();
                let mut map = DMatrix::zeros(size, size);
                body.joint().velocity_map(q, map.as_mut_slice());
                let v = map * rate.rows(ranges.freedoms.start, size);
                let own = &mut expected[ranges.configuration.clone()];
                body.joint().configuration_rate(q, v.as_slice(), own);
            }
            // Rounding ε |q| / h = 3 · 2.2e-16 · 128 = 9e-14 a degree of freedom, six of them.
            assert!(difference(found.as_slice(), &expected) < 6e-13);
        }
    }
}
