//! Impacts: speeds that change at once.

use super::complementarity::{Found, Place, Problem};
use super::contact::{Contact, Side};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector};

/// A rebound below this speed, as a part of the largest one or of 1 SI unit, is none. What bounces ever less comes to rest so: the state differs by no
/// more than that speed, and by less in the coordinates.
const CAPTURE: f64 = 1e-12;

/// A joint at its limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touching {
    pub(super) contact: usize,
    pub(super) side: Side,
}

/// What an impact does.
#[derive(Debug)]
pub(super) struct Impact {
    /// Impulses of the joints that touch, in their order.
    pub(super) impulses: DVector<f64>,
    /// Their speeds after it.
    pub(super) after: Vec<f64>,
}

/// Speeds after the impact of joints that are at limits, and move beyond or not at all; `matrix` is `M̄⁻¹` of their speeds. `None` where the impulses are
/// not determined.
///
/// For each joint `v⁺ ≥ −e v⁻` inwards, an impulse Λ only inwards, and none where the inequality is strict: with one joint it is Newton's law. Energy changes by
/// the sum of `½ Λ (v⁺ + v⁻)`, and where Λ is not 0 the sum of speeds is `(1 − e) v⁻`: it never grows.
pub(super) fn impact(
    contacts: &[Contact],
    touching: &[Touching],
    speeds: &[f64],
    matrix: DMatrix<f64>,
) -> Option<Impact> {
    let largest = speeds.iter().fold(1.0_f64, |most, v| most.max(v.abs()));
    let rebounds = touching.iter().map(|own| {
        let contact = &contacts[own.contact];
        let before = own.side.inwards() * speeds[contact.speed];
        let rebound = contact.restitution * (-before).max(0.0);
        let is_captured = rebound <= CAPTURE * largest;
        own.side.inwards() * if is_captured { 0.0 } else { rebound }
    });
    let rebounds: Vec<f64> = rebounds.collect();
    let before = |i: usize| speeds[contacts[touching[i].contact].speed];
    let size = touching.len();
    let problem = Problem {
        matrix,
        free: DVector::from_fn(size, |i, _| before(i) - rebounds[i]),
        bounds: touching.iter().map(|own| inwards(own.side)).collect(),
    };
    let Found {
        places, efforts, ..
    } = problem.solve(vec![Place::Between; size])?;
    let free = &problem.free + &problem.matrix * &efforts;
    let after = (0..size).map(|i| match places[i] {
        Place::Between => rebounds[i],
        // It leaves faster than it must, and not beyond its limit by rounding.
        _ => {
            let inwards = touching[i].side.inwards();
            inwards * (inwards * (free[i] + rebounds[i])).max(0.0)
        }
    });
    Some(Impact {
        impulses: efforts,
        after: after.collect(),
    })
}

/// Bounds of an impulse that only pushes inwards.
const fn inwards(side: Side) -> (f64, f64) {
    match side {
        Side::Lower => (0.0, f64::INFINITY),
        Side::Upper => (f64::NEG_INFINITY, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::{Touching, impact};
    use crate::hybrid::contact::{Contact, Side};
    use alloc::vec::Vec;
    use nalgebra::DMatrix;

    fn contacts(restitutions: &[f64]) -> (Vec<Contact>, Vec<Touching>) {
        let all = restitutions.iter().enumerate();
        let contacts = all.map(|(index, restitution)| Contact::bouncing(index, *restitution));
        let touching = (0..restitutions.len()).map(|contact| Touching {
            contact,
            side: Side::Lower,
        });
        (contacts.collect(), touching.collect())
    }

    #[test]
    fn one_joint_follows_newton() {
        let (contacts, touching) = contacts(&[0.5]);
        let matrix = DMatrix::from_element(1, 1, 0.25);
        let found = impact(&contacts, &touching, &[-2.0], matrix).expect("determined");
        assert_eq!(found.after, [1.0]);
        // (1 + e) |v| over M̄⁻¹.
        assert_eq!(found.impulses[0], 12.0);
    }

    #[test]
    fn a_joint_is_not_pulled() {
        // The impulse of the first throws the second off: Λ₁ = 2 / 1, v₂ = 0 + 0.5 · 2.
        let (contacts, touching) = contacts(&[1.0, 0.0]);
        let matrix = DMatrix::from_row_slice(2, 2, &[1.0, 0.5, 0.5, 1.0]);
        let found = impact(&contacts, &touching, &[-1.0, 0.0], matrix).expect("determined");
        assert_eq!(found.impulses.as_slice(), [2.0, 0.0]);
        assert_eq!(found.after, [1.0, 1.0]);
    }

    #[test]
    fn a_rebound_of_next_to_nothing_is_none() {
        let (contacts, touching) = contacts(&[0.5]);
        let matrix = DMatrix::from_element(1, 1, 1.0);
        let found = impact(&contacts, &touching, &[-1.9e-12], matrix.clone());
        assert_eq!(found.expect("determined").after, [0.0]);
        let found = impact(&contacts, &touching, &[-2.1e-12], matrix);
        assert!(found.expect("determined").after[0] > 0.0);
    }
}
