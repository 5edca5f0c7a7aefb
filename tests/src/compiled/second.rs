//! Compiled second derivatives against the tree's.

use super::Functions;
use super::point::{BOUND, Evaluate, Point, condition, of_solutions};
use super::slopes::TERMS;
use hamel::dynamics::{
    Dynamics, ForwardSecondDerivatives, InverseSecondDerivatives, MassMatrix, Recursive,
    Sensitivity,
};
use hamel_compiler::functions::Kind;
use std::sync::Arc;

/// How many times as large as those of one solution with M̄ errors may be: μ, v̄̇ and its first derivatives are solved for, one from the other.
const SOLUTIONS: f64 = 4.0;

/// Condition of M̄ from which on doubles leave too few digits for comparison: solutions that are made of solutions lose them twice. Of a tip 1e8 times as heavy as what
/// carries it, the Hessian of the tree is another one after each rounding of Q.
const WORST: f64 = 1e7;

impl Point {
    /// Both functions of second derivatives have the tree's values; forward dynamics under constraints that couple joints has none.
    ///
    /// # Panics
    /// Where one has not.
    pub fn second_derivatives_agree(self) {
        let model = self.model.clone();
        let functions = Functions::new(&model);
        self.second_derivatives_agree_by(&|how, q, v, u| functions.evaluate(how, q, v, u));
    }

    /// The same of what stands in for them; their inputs are those of the first derivatives, then λ.
    ///
    /// # Panics
    /// Where one has not.
    pub fn second_derivatives_agree_by(mut self, by: Evaluate<'_>) {
        let mut tree = Recursive::new(Arc::clone(&self.mechanism));
        tree.complete_speeds(&self.q, &mut self.speeds)
            .expect("constraints determine them");
        let count = self.speeds.len();
        let weights = self.inputs.iter().rev().take(count).map(|u| 0.5 + u.sin());
        let weights: Vec<f64> = weights.collect();
        let with_weights = |inputs: &[f64]| [inputs, &weights].concat();

        let rates = &self.inputs[..count];
        let mut inverse = InverseSecondDerivatives::new(&self.mechanism);
        tree.inverse_dynamics_second_derivatives(
            &self.q,
            &self.speeds,
            rates,
            &weights,
            &mut inverse,
        )
        .expect("all that acts has second derivatives");
        let inputs = with_weights(rates);
        let kind = Kind::InverseSecondDerivatives;
        self.hessian_agrees(by, (kind, &inputs), inverse.hessian(), BOUND);

        if !self.model.coupling.constraints.is_empty() {
            return;
        }
        let mut mass = MassMatrix::new(&self.mechanism);
        tree.mass_matrix(&self.q, &mut mass).expect("sizes fit");
        let bound = SOLUTIONS * of_solutions(mass.matrix());
        // Rounding may leave an eigenvalue below 0.
        if !(0.0..=WORST).contains(&condition(mass.matrix())) {
            return;
        }
        let mut forward = ForwardSecondDerivatives::new(&self.mechanism);
        tree.forward_dynamics_second_derivatives(
            &self.q,
            &self.speeds,
            &self.inputs,
            &weights,
            &mut forward,
        )
        .expect("M̄ is regular");
        let inputs = with_weights(&self.inputs);
        let kind = Kind::ForwardSecondDerivatives;
        self.hessian_agrees(by, (kind, &inputs), forward.hessian(), bound);
    }

    fn hessian_agrees(
        &self,
        by: Evaluate<'_>,
        (kind, inputs): (Kind, &[f64]),
        expected: &Sensitivity,
        bound: f64,
    ) {
        for loops in self.loops_of_derivatives() {
            let how = (kind, loops);
            let found = by(how, &self.q, &self.speeds, inputs);
            let what = format!("{how:?}");
            self.close_beside(TERMS, &what, &found, expected.entries(), bound);
        }
    }
}
