//! Theorems 2 and 3 on random trees of 1 to 12 joints of all types of the library, against Newton–Euler, differences, and
//! the laws of mechanics.

mod equations;
mod matrices;
mod power;

use hamel::dynamics::reference::Expansion;
use hamel::dynamics::{NewtonEuler, Reference};
use hamel::nalgebra::DVector;
use hamel_tests::random::{Case, cases, library};
use std::sync::Arc;

/// Trees of each law: twelve sizes, every library joint at the root of several.
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
    fn newton_euler(&self, rates: &DVector<f64>) -> (NewtonEuler, DVector<f64>) {
        let mut recursion = NewtonEuler::new(Arc::clone(&self.case.mechanism));
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

fn points() -> impl Iterator<Item = Point> {
    let kinds = library();
    let all: Vec<Case> = cases(&kinds, LARGEST, TREES).collect();
    all.into_iter().map(Point::new)
}

/// The suite would say less if the trees did.
#[test]
fn trees_are_of_all_kinds() {
    let mut off_root = std::collections::BTreeMap::new();
    let mut sizes = [0; LARGEST + 1];
    for point in points() {
        let bodies = point.case.mechanism.bodies();
        sizes[bodies.len()] += 1;
        for body in bodies {
            let (at_root, inside) = off_root.entry(body.joint().name()).or_insert((0, 0));
            *(if body.parent().is_none() {
                at_root
            } else {
                inside
            }) += 1;
        }
    }
    assert!(sizes[1..].iter().all(|&count| count >= 5), "{sizes:?}");
    assert_eq!(off_root.len(), hamel_joints::ENTRIES.len());
    assert!(
        off_root
            .values()
            .all(|&(at_root, inside)| at_root > 0 && inside > 3),
        "{off_root:?}"
    );
}
