//! Second derivatives against dual numbers of dual numbers.

use super::{Actuation, BOUND, DualForm, Equipped, Expected, Lookup, matrix, relative};
use crate::figures::Largest;
use crate::random::{Case, numbers};
use chacha20::ChaCha8Rng;
use hamel::dynamics::{
    ForwardSecondDerivatives, InverseDerivatives, InverseSecondDerivatives, Recursive,
};
use hamel::nalgebra::{DMatrix, DVector};
use hamel::scalar::Dual;
use rand::SeedableRng;
use std::sync::Arc;

/// A number with its derivatives along two directions.
pub type HyperDual = Dual<Dual<f64>>;

/// The equations of motion at one case.
struct Form<'a> {
    form: DualForm<HyperDual>,
    case: &'a Case,
    freedoms: usize,
    speeds: usize,
}

/// 1 along either of two directions where it is entry `i`.
fn seeded(value: f64, i: usize, (l, k): (usize, usize)) -> HyperDual {
    let along = |n: usize| f64::from(u8::from(n == i));
    Dual::new(Dual::new(value, along(l)), Dual::constant(along(k)))
}

impl<'a> Form<'a> {
    fn new(case: &'a Case, actuation: &Actuation, lookup: Lookup<HyperDual>) -> Self {
        let layout = case.mechanism.layout();
        Self {
            form: DualForm::of(&case.mechanism, actuation.clone(), lookup),
            case,
            freedoms: layout.freedoms,
            speeds: layout.speeds,
        }
    }

    /// Q, and vectors that follow it among the coordinates, moved along two of these.
    fn state<const M: usize>(
        &self,
        vectors: [&[f64]; M],
        along: (usize, usize),
    ) -> (Vec<HyperDual>, [Vec<HyperDual>; M]) {
        let q = self
            .form
            .moved_along(&self.case.q, |k| seeded(0.0, k, along));
        let mut start = self.freedoms;
        let moved = vectors.map(|vector| {
            let first = start;
            start += vector.len();
            let entries = vector.iter().enumerate();
            entries.map(|(i, x)| seeded(*x, first + i, along)).collect()
        });
        (q, moved)
    }

    /// All pairs of so many coordinates.
    fn pairs(size: usize, entry: impl Fn((usize, usize)) -> f64) -> DMatrix<f64> {
        let mut hessian = DMatrix::zeros(size, size);
        for l in 0..size {
            for k in 0..=l {
                hessian[(l, k)] = entry((l, k));
                hessian[(k, l)] = hessian[(l, k)];
            }
        }
        hessian
    }

    /// `λᵀ∂²τ̄` over (ϕ, v̄, v̄̇).
    fn inverse(&self, weights: &[f64]) -> DMatrix<f64> {
        let case = self.case;
        Self::pairs(self.freedoms + 2 * self.speeds, |along| {
            let (q, [v, a]) = self.state([&case.speeds, &case.rates], along);
            second(&self.form.inverse(&q, &v, &a, true), weights)
        })
    }

    /// `λᵀ∂²v̄̇` over (ϕ, v̄, τ): with v̄̇ moved along as far as its first derivatives say, what is left of `ID − S̄ᵀτ` is `−M̄` times the second ones.
    fn forward(
        &self,
        (rates, slopes): (&[f64], &DMatrix<f64>),
        virtual_speeds: &[f64],
    ) -> DMatrix<f64> {
        let case = self.case;
        Self::pairs(2 * self.freedoms + self.speeds, |along| {
            let (q, [v, tau]) = self.state([&case.speeds, &case.efforts], along);
            let (outer, inner) = along;
            let moved = rates.iter().enumerate().map(|(i, rate)| {
                let rate = Dual::new(*rate, slopes[(i, outer)]);
                Dual::new(rate, Dual::constant(slopes[(i, inner)]))
            });
            let moved: Vec<HyperDual> = moved.collect();
            let needed = second(&self.form.inverse(&q, &v, &moved, true), virtual_speeds);
            second(&self.form.reduced(&q, &tau), virtual_speeds) - needed
        })
    }
}

/// The second derivative of a weighted sum.
fn second(values: &[HyperDual], weights: &[f64]) -> f64 {
    let terms = values.iter().zip(weights);
    terms
        .map(|(value, weight)| weight * value.derivative().derivative())
        .sum()
}

/// Weights and a direction of order 1.
fn chosen(case: &Case, size: usize) -> (Vec<f64>, Vec<f64>) {
    let mut random = ChaCha8Rng::seed_from_u64(case.seed + 1);
    let weights = numbers(&mut random, case.speeds.len());
    (weights, numbers(&mut random, size))
}

/// M̄⁻¹ λ, where speeds of joints whose motion is prescribed neither answer nor are asked.
fn answers(case: &Case, mass: &DMatrix<f64>, weights: &[f64]) -> Vec<f64> {
    let joints = case.mechanism.joints();
    let free = joints.filter(|(body, _)| !case.mechanism.is_driven(*body));
    let free: Vec<usize> = free
        .flat_map(|(_, body)| body.ranges().speeds.clone())
        .collect();
    let mut all = vec![0.0; weights.len()];
    if free.is_empty() {
        return all;
    }
    let mass = mass.select_rows(&free).select_columns(&free);
    let asked = DVector::from_iterator(free.len(), free.iter().map(|&speed| weights[speed]));
    let factors = mass.cholesky().expect("every body has mass");
    for (&speed, answer) in free.iter().zip(factors.solve(&asked).iter()) {
        all[speed] = *answer;
    }
    all
}

/// What is measured of every Hessian.
struct Figures([Largest; 3]);

impl Figures {
    fn new(name: &'static str) -> Self {
        Self([name, "symmetry", "Hessian–vector product"].map(Largest::new))
    }

    /// A Hessian, and its product with a direction, beside what is expected.
    fn meet(
        &mut self,
        (found, product): (&DMatrix<f64>, &[f64]),
        (expected, direction): (&DMatrix<f64>, &[f64]),
        (condition, place): (f64, &str),
    ) {
        let Self([values, symmetry, products]) = self;
        let place = || place.to_string();
        values.meet(relative(found, expected) / condition, place());
        symmetry.meet(relative(found, &found.transpose()) / condition, place());
        let whole = found * DVector::from_column_slice(direction);
        let product = DVector::from_column_slice(product);
        let [product, whole] =
            [product, whole].map(|own| matrix(own.len(), [own.as_slice().to_vec()].into_iter()));
        products.meet(relative(&product, &whole), place());
    }

    fn judge(&self) {
        self.0.iter().for_each(|worst| worst.assert_within(BOUND));
    }
}

/// `λᵀ∂²τ̄`.
///
/// # Panics
/// With the figure and the case, where a bound does not hold.
pub fn inverse_dynamics(all: impl IntoIterator<Item = Equipped>, lookup: Lookup<HyperDual>) {
    let mut figures = Figures::new("λᵀ∂²τ̄");
    for equipped in all {
        let case = &equipped.case;
        let form = Form::new(case, &equipped.actuation, lookup);
        let size = form.freedoms + 2 * form.speeds;
        let (weights, direction) = chosen(case, size);
        let mut found = InverseSecondDerivatives::new(&case.mechanism);
        Recursive::new(Arc::clone(&case.mechanism))
            .inverse_dynamics_second_derivatives(
                &case.q,
                &case.speeds,
                &case.rates,
                &weights,
                &mut found,
            )
            .expect("nothing else acts");
        let mut product = vec![0.0; size];
        found.times(&direction, &mut product).expect("sizes fit");
        figures.meet(
            (&found.hessian().matrix(), &product),
            (&form.inverse(&weights), &direction),
            (1.0, &equipped.place()),
        );
    }
    figures.judge();
}

/// `λᵀ∂²v̄̇`.
///
/// # Panics
/// With the figure and the case, where a bound does not hold.
pub fn forward_dynamics(all: impl IntoIterator<Item = Equipped>, lookup: Lookup<HyperDual>) {
    let mut figures = Figures::new("λᵀ∂²v̄̇");
    for equipped in all {
        let case = &equipped.case;
        let form = Form::new(case, &equipped.actuation, lookup);
        let size = 2 * form.freedoms + form.speeds;
        let (weights, direction) = chosen(case, size);
        let mut found = ForwardSecondDerivatives::new(&case.mechanism);
        Recursive::new(Arc::clone(&case.mechanism))
            .forward_dynamics_second_derivatives(
                &case.q,
                &case.speeds,
                &case.efforts,
                &weights,
                &mut found,
            )
            .expect("nothing else acts");
        let mut product = vec![0.0; size];
        found.times(&direction, &mut product).expect("sizes fit");
        let oracle = Expected::new(&equipped);
        // First derivatives are held to dual numbers by a law of their own.
        let (first, rows) = (found.first(), form.speeds);
        let parts = [first.by_local(), first.by_speeds(), first.by_efforts()];
        let parts = parts.map(|part| part.matrix());
        let columns = parts.iter().flat_map(|part| part.column_iter());
        let slopes = matrix(rows, columns.map(|own| own.iter().copied().collect()));
        let rates = first.rates();
        let virtual_speeds = answers(case, &oracle.mass, &weights);
        let expected = form.forward((rates, &slopes), &virtual_speeds);
        figures.meet(
            (&found.hessian().matrix(), &product),
            (&expected, &direction),
            (oracle.condition(), &equipped.place()),
        );
    }
    figures.judge();
}

/// That `E_l E_k` of λᵀτ̄ alone is not its Hessian: the largest of what the charts of the joints add, relative to the Hessian.
///
/// # Panics
/// Where sizes do not fit.
pub fn share_of_charts(equipped: &Equipped) -> f64 {
    let case = &equipped.case;
    let (weights, _) = chosen(case, 0);
    let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
    let mut first = InverseDerivatives::new(&case.mechanism);
    let mut found = InverseSecondDerivatives::new(&case.mechanism);
    let (q, v, a) = (&case.q, &case.speeds, &case.rates);
    dynamics
        .inverse_dynamics_derivatives(q, v, a, &mut first)
        .expect("nothing else acts");
    dynamics
        .inverse_dynamics_second_derivatives(q, v, a, &weights, &mut found)
        .expect("nothing else acts");
    let gradient = first
        .by_local()
        .matrix()
        .tr_mul(&DVector::from_vec(weights));
    let largest = case.mechanism.joints().map(|(_, body)| {
        let own = &gradient.as_slice()[body.ranges().freedoms.clone()];
        let mut terms = vec![0.0; own.len() * own.len()];
        body.joint()
            .chart_terms(body.configuration(q), own, &mut terms);
        terms
            .iter()
            .fold(0.0, |most: f64, term| most.max(term.abs()))
    });
    largest.fold(0.0, f64::max) / found.hessian().matrix().amax().max(1.0)
}
