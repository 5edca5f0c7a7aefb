//! What dual numbers say of a case.

use super::{DualForm, Equipped, constants, derivatives, matrix, seeded, values};
use crate::random::Case;
use hamel::nalgebra::DMatrix;
use hamel::scalar::Dual;

/// What dual numbers say of a case.
pub struct Expected {
    /// The equations of motion.
    pub form: DualForm,
    /// M̄.
    pub mass: DMatrix<f64>,
    /// How many speeds.
    pub rows: usize,
    /// How many degrees of freedom.
    pub freedoms: usize,
}

impl Expected {
    /// M̄ of a case, column by column.
    pub fn new(equipped: &Equipped) -> Self {
        let case = &equipped.case;
        let form = DualForm::of(&case.mechanism, equipped.actuation.clone(), equipped.lookup);
        let rows = case.speeds.len();
        let (q, rest) = (constants(&case.q), constants(&vec![0.0; rows]));
        let column = |j: usize| {
            let mut unit = rest.clone();
            unit[j].value = 1.0;
            values(&form.inverse(&q, &rest, &unit, false))
        };
        Self {
            mass: matrix(rows, (0..rows).map(column)),
            freedoms: case.mechanism.layout().freedoms,
            form,
            rows,
        }
    }

    /// That of M̄.
    pub fn condition(&self) -> f64 {
        let symmetric = (&self.mass + self.mass.transpose()) * 0.5;
        let eigenvalues = symmetric.symmetric_eigenvalues();
        (eigenvalues.max() / eigenvalues.min()).max(1.0)
    }

    /// M̄⁻¹ times the columns of `right`.
    ///
    /// # Panics
    /// Where M̄ is not positive.
    pub fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let factors = self.mass.clone().cholesky().expect("every body has mass");
        factors.solve(right)
    }

    /// ∂τ̄/∂ϕ and ∂τ̄/∂v̄.
    pub fn inverse(&self, case: &Case, rates: &[f64]) -> [DMatrix<f64>; 2] {
        let (form, q) = (&self.form, constants(&case.q));
        let (v, a) = (constants(&case.speeds), constants(rates));
        let along = |k| derivatives(&form.inverse(&form.moved(&case.q, k), &v, &a, true));
        let faster = |j| derivatives(&form.inverse(&q, &seeded(&case.speeds, j), &a, true));
        [
            matrix(self.rows, (0..self.freedoms).map(along)),
            matrix(self.rows, (0..self.rows).map(faster)),
        ]
    }

    /// ∂(S̄ᵀτ)/∂ϕ and S̄ᵀ.
    pub fn inputs(&self, case: &Case) -> [DMatrix<f64>; 2] {
        let (form, tau) = (&self.form, constants(&case.efforts));
        let along = |k| derivatives(&form.reduced(&form.moved(&case.q, k), &tau));
        let q = constants(&case.q);
        let unit = |k| derivatives(&form.reduced(&q, &seeded(&case.efforts, k)));
        [
            matrix(self.rows, (0..self.freedoms).map(along)),
            matrix(self.rows, (0..self.freedoms).map(unit)),
        ]
    }

    /// ∂p̄̇/∂ϕ and ∂p̄̇/∂p̄, with v̄ moving along with either.
    pub fn rates_of_momenta(
        &self,
        case: &Case,
        by_local: &DMatrix<f64>,
        by_momenta: &DMatrix<f64>,
    ) -> [DMatrix<f64>; 2] {
        let along = |k: usize| {
            let rate = by_local.column(k);
            self.momentum_rates(case, self.form.moved(&case.q, k), rate.as_slice())
        };
        let faster = |j: usize| {
            let rate = by_momenta.column(j);
            self.momentum_rates(case, constants(&case.q), rate.as_slice())
        };
        [
            matrix(self.rows, (0..self.freedoms).map(along)),
            matrix(self.rows, (0..self.rows).map(faster)),
        ]
    }

    /// p̄̇ with v̄ moving along with ϕ or p̄.
    fn momentum_rates(&self, case: &Case, q: Vec<Dual<f64>>, speed_rate: &[f64]) -> Vec<f64> {
        let mut state = self.form.state(&case.q, &case.speeds, &case.efforts);
        state.q = q;
        for (speed, rate) in state.speeds.iter_mut().zip(speed_rate) {
            speed.derivatives = [*rate];
        }
        derivatives(&self.form.momentum_rates(&state))
    }
}
