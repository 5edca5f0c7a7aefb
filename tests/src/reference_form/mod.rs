//! Theorems 2 and 3 on random trees of 1 to 12 joints of given kinds, against Newton–Euler, differences, and
//! the laws of mechanics.

pub mod equations;
pub mod kinds;
pub mod matrices;
pub mod power;

use crate::random::{Case, cases};
use hamel::dynamics::reference::Expansion;
use hamel::dynamics::{Recursive, Reference};
use hamel::erased::AnyJoint;
use hamel::nalgebra::DVector;
use std::sync::Arc;

/// Trees of each law: twelve sizes, every kind at the root of several.
const TREES: u64 = 84;
const LARGEST: usize = 12;

/// A case with its expansion and vectors.
struct Point {
    case: Case,
    reference: Reference,
    expansion: Expansion,
    /// v̄.
    speeds: DVector<f64>,
    /// v̄̇, as good as any other.
    rates: DVector<f64>,
    /// τ.
    efforts: DVector<f64>,
    /// v = S̄ v̄.
    v: DVector<f64>,
    /// v̇ = S̄ v̄̇ + S̄̇ v̄.
    v_rate: DVector<f64>,
}

impl Point {
    fn new(case: Case) -> Self {
        let reference = Reference::new(Arc::clone(&case.mechanism));
        let expansion = reference.expansion(&case.q).expect("sizes fit");
        let speeds = DVector::from_column_slice(&case.speeds);
        let rates = DVector::from_column_slice(&case.rates);
        let v = &expansion.speed_basis * &speeds;
        let v_rate =
            &expansion.speed_basis * &rates + expansion.speed_basis_rate(&speeds) * &speeds;
        let efforts = DVector::from_column_slice(&case.efforts);
        Self {
            case,
            reference,
            expansion,
            speeds,
            rates,
            efforts,
            v,
            v_rate,
        }
    }

    /// The recursion, run at this point with the given v̄̇, and S̄ᵀτ that it finds.
    fn newton_euler(&self, rates: &DVector<f64>) -> (Recursive, DVector<f64>) {
        let mut recursion = Recursive::new(Arc::clone(&self.case.mechanism));
        let mut efforts = vec![0.0; rates.len()];
        recursion
            .inverse_dynamics(
                &self.case.q,
                &self.case.speeds,
                rates.as_slice(),
                &mut efforts,
            )
            .expect("sizes fit");
        (recursion, DVector::from_vec(efforts))
    }

    /// v̄̇ of (34) under τ.
    fn accelerations(&self) -> DVector<f64> {
        self.expansion
            .reduced_accelerations(&self.case.mechanism, &self.speeds, &self.efforts)
            .expect("every body has mass")
    }

    /// `d/dt M̄ = S̄ᵀṀS̄ + S̄̇ᵀMS̄ + S̄ᵀMS̄̇`.
    fn reduced_mass_rate(&self) -> hamel::nalgebra::DMatrix<f64> {
        let Expansion {
            mass_matrix,
            speed_basis,
            ..
        } = &self.expansion;
        let half = self
            .expansion
            .speed_basis_rate(&self.speeds)
            .tr_mul(&(mass_matrix * speed_basis));
        let inner = self.expansion.mass_matrix_rate(&self.v) * speed_basis;
        speed_basis.tr_mul(&inner) + &half + half.transpose()
    }
}

fn points(kinds: &[Arc<dyn AnyJoint>]) -> impl Iterator<Item = Point> + '_ {
    cases(kinds, LARGEST, TREES).map(Point::new)
}

/// One test for each law, over the joints that the expression gives: a `Vec<Arc<dyn AnyJoint>>` of distinct kinds.
#[macro_export]
macro_rules! reference_form_tests {
    ($kinds:expr) => {
        $crate::reference_form_tests! {
            $kinds =>
            mod kinds { trees_are_of_all_kinds }
            mod equations {
                theorem_2_is_newton_euler
                theorem_3_is_newton_euler
                hamiltonian_form_of_theorem_2
                hamiltonian_form_of_theorem_3
                constraint_forces_are_those_of_the_joint_wrench
            }
            mod matrices {
                mass_matrix_is_symmetric_positive_and_gives_the_kinetic_energy
                derivatives_in_phi_are_those_of_differences
                coriolis_matrices
            }
            mod power { lagrangian_form hamiltonian_form along_the_motion }
        }
    };
    ($kinds:expr => $(mod $topic:ident { $($law:ident)* })*) => {
        fn reference_form_kinds() -> Vec<std::sync::Arc<dyn $crate::hamel::erased::AnyJoint>> {
            $kinds
        }
        $(mod $topic {
            $(#[test]
            fn $law() {
                $crate::reference_form::$topic::$law(&super::reference_form_kinds());
            })*
        })*
    };
}
