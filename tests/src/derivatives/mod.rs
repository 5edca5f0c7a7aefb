//! Derivatives of the dynamics by recursion against dual numbers, on any mechanism: what the suites of the library's joints and of others share.

mod dual;
mod expected;
mod laws;
pub mod second;

pub use dual::{Actuation, DualForm, DualState, Kernels, Lookup, behind, library_kernels, of};
pub use expected::Expected;
pub use laws::{energies, forward_dynamics, inverse_dynamics, port_hamiltonian_form};

use crate::figures::{difference, size};
use crate::random::Case;
use hamel::nalgebra::{DMatrix, DVector};
use hamel::scalar::Dual;

/// What is asked of every derivative, relative to its largest entry or to 1; times the condition of M̄ where that is solved with.
pub const BOUND: f64 = 1e-12;

/// A case with what the mechanism carries.
pub struct Equipped {
    /// The case, its mechanism equipped.
    pub case: Case,
    /// What it carries.
    pub actuation: Actuation,
    /// Where the kernels of its joints are found.
    pub lookup: Lookup,
}

impl Equipped {
    /// A case on joints of the library, whose mechanism carries the equipment already.
    pub fn new(case: Case, actuation: Actuation) -> Self {
        Self {
            case,
            actuation,
            lookup: library_kernels,
        }
    }

    /// A case with elements of all kinds and rotors at every joint.
    pub fn fully(case: Case) -> Self {
        let actuation = Actuation::random(&case.mechanism, &case.q, case.seed);
        let mechanism = actuation.equip(&case.mechanism);
        Self::new(Case { mechanism, ..case }, actuation)
    }

    /// The same on joints of another crate.
    pub fn on(self, lookup: Lookup) -> Self {
        Self { lookup, ..self }
    }

    /// For messages.
    pub fn place(&self) -> String {
        let case = &self.case;
        let bodies = case.mechanism.bodies();
        let root = bodies[0].joint().name();
        let elements = case.mechanism.elements().len();
        let count = bodies.len();
        format!(
            "case {} of {count} bodies on {root}, {elements} elements",
            case.seed
        )
    }
}

/// Cases as they are, and cases with elements of all kinds and rotors at every joint.
pub fn bare_and_equipped(
    bare: impl Iterator<Item = Case>,
    equipped: impl Iterator<Item = Case>,
) -> Vec<Equipped> {
    let bare = bare.map(|case| Equipped::new(case, Actuation::default()));
    bare.chain(equipped.map(Equipped::fully)).collect()
}

/// The infinitesimal parts.
pub fn derivatives(values: &[Dual<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.derivative()).collect()
}

/// The parts without infinitesimals.
pub fn values(values: &[Dual<f64>]) -> Vec<f64> {
    values.iter().map(|value| value.value).collect()
}

/// Without infinitesimals.
pub fn constants(values: &[f64]) -> Vec<Dual<f64>> {
    values.iter().map(|value| Dual::constant(*value)).collect()
}

/// `values` with the infinitesimal at one place.
pub fn seeded(values: &[f64], place: usize) -> Vec<Dual<f64>> {
    let mut seeded = constants(values);
    seeded[place].derivatives = [1.0];
    seeded
}

/// Of the given columns.
///
/// # Panics
/// Where they are not of one size.
pub fn matrix(rows: usize, columns: impl Iterator<Item = Vec<f64>>) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = columns.map(DVector::from_vec).collect();
    match columns.is_empty() {
        true => DMatrix::zeros(rows, 0),
        false => DMatrix::from_columns(&columns),
    }
}

/// Relative to the largest entry, or to 1: states, forces and inertias are of order 1, and some derivatives vanish.
pub fn relative(found: &DMatrix<f64>, expected: &DMatrix<f64>) -> f64 {
    difference(found.as_slice(), expected.as_slice()) / size(expected.as_slice()).max(1.0)
}
