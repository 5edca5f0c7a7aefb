//! Compiled derivatives against the tree's.

use super::Functions;
use super::point::{BOUND, Evaluate, Point, of_solutions};
use hamel::dynamics::{
    Dynamics, ForwardDerivatives, InverseDerivatives, InverseMassMatrix, MassMatrix, Recursive,
    Sensitivity,
};
use hamel_compiler::functions::Kind;
use std::sync::Arc;

/// Size of the terms that cancel where a matrix of derivatives is 0, such as ∂τ̄/∂v̄ of a pendulum: speeds and efforts of random states are about 1.
pub(super) const TERMS: f64 = 1.0;

/// A matrix: its number of columns, and its entries by rows.
type Part<'a> = (usize, &'a [f64]);

fn of(matrix: &Sensitivity) -> Part<'_> {
    (matrix.columns(), matrix.entries())
}

impl Point {
    /// Both functions of derivatives have the tree's values.
    ///
    /// # Panics
    /// Where one has not.
    pub fn derivatives_agree(self) {
        let model = self.model.clone();
        self.derivatives_agree_with(&Functions::new(&model));
    }

    /// The same of functions that are kept for further states.
    ///
    /// # Panics
    /// Where one has not.
    pub fn derivatives_agree_with(self, functions: &Functions<'_>) {
        self.derivatives_agree_by(&|how, q, v, u| functions.evaluate(how, q, v, u));
    }

    /// The same of what stands in for them.
    ///
    /// # Panics
    /// Where one has not.
    pub fn derivatives_agree_by(mut self, by: Evaluate<'_>) {
        let mut tree = Recursive::new(Arc::clone(&self.mechanism));
        tree.complete_speeds(&self.q, &mut self.speeds)
            .expect("constraints determine them");
        let mut inverse = InverseDerivatives::new(&self.mechanism);
        let rates = &self.inputs[..self.speeds.len()];
        tree.inverse_dynamics_derivatives(&self.q, &self.speeds, rates, &mut inverse)
            .expect("all that acts has slopes");
        let parts = [inverse.by_local(), inverse.by_speeds()].map(of);
        self.parts_agree(by, (Kind::InverseDerivatives, rates), &parts, BOUND);

        let mut mass = MassMatrix::new(&self.mechanism);
        tree.mass_matrix(&self.q, &mut mass).expect("sizes fit");
        let mut forward = ForwardDerivatives::new(&self.mechanism);
        tree.forward_dynamics_derivatives(&self.q, &self.speeds, &self.inputs, &mut forward)
            .expect("M̄ is regular");
        let mut parts = vec![
            of(forward.by_local()),
            of(forward.by_speeds()),
            of(forward.by_efforts()),
            (1, forward.rates()),
        ];
        let completed = forward.completed_speeds();
        parts.extend(completed.into_iter().flatten().map(of));
        let bound = of_solutions(mass.matrix());
        self.parts_agree(by, (Kind::ForwardDerivatives, &self.inputs), &parts, bound);

        // Where constraints alone keep M̄ of the tree from being singular there is no such matrix.
        let mut inverse = InverseMassMatrix::new(&self.mechanism);
        if tree.inverse_mass_matrix(&self.q, &mut inverse).is_ok() {
            let parts = [(self.speeds.len(), inverse.entries())];
            self.parts_agree(by, (Kind::InverseMassMatrix, &[]), &parts, bound);
        }
    }

    /// Matrices that stand side by side in the rows of a function are these.
    fn parts_agree(
        &self,
        by: Evaluate<'_>,
        (kind, inputs): (Kind, &[f64]),
        parts: &[Part<'_>],
        bound: f64,
    ) {
        let width: usize = parts.iter().map(|(columns, _)| columns).sum();
        for loops in self.loops_of_derivatives() {
            let how = (kind, loops);
            let found = by(how, &self.q, &self.speeds, inputs);
            assert_eq!(found.len(), width * self.speeds.len(), "{how:?}");
            let mut start = 0;
            for (number, (columns, entries)) in parts.iter().enumerate() {
                let rows = found.chunks_exact(width.max(1));
                let own = rows.flat_map(|row| &row[start..start + columns]);
                let own: Vec<f64> = own.copied().collect();
                let what = format!("{how:?}, part {number}");
                self.close_beside(TERMS, &what, &own, entries, bound);
                start += columns;
            }
        }
    }
}
