//! What a joint does not feel of the bodies that it carries, and what that is on its parent.
//!
//! Inertias N_b of the bodies b of one joint can be moved to its parent where, for all configurations Q of the joint and all twists V and directions of
//! gravity g that the parent can have,
//!
//! ```text
//! (i)   Σ X_bᵀ N_b X_b = 0               the joint alone feels nothing of them
//! (ii)  Σ Vᵀ N′_b X′_b = 0               nor while its parent moves
//! (iii) Σ Vᵀ N′_b V  is constant in Q    the parent feels a rigid body
//! (iv)  g · Σ (mc)′_b  is constant in Q  and so does gravity
//! ```
//!
//! with the primes in the parent's frame. The kinetic energy and the derivatives of the potential energy of the mechanism are then those of the inertia Σ N′_b on the
//! parent, for every state; on the world they are none. Where the parent can move in every way, these are the conditions of N_X for a joint with one
//! body.

use super::motions::Motions;
use super::sample::{Place, Samples, transport};
use super::scale::Scale;
use super::span::{Row, Span};
use crate::mechanism::Mechanism;
use crate::spatial::INERTIAL_PARAMETERS;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DVector, SVector};

/// Where each parameter of [`AnyJoint::unidentifiable`](crate::erased::AnyJoint::unidentifiable) stands in the order of this module.
const PLACES: [usize; INERTIAL_PARAMETERS] = [0, 1, 2, 3, 4, 6, 9, 5, 7, 8];

/// Parameters that are left out, in the order of preference; among equals the first.
const ORDER: [&[usize]; 4] = [&[0], &[3, 1, 2], &[6, 9, 4], &[5, 7, 8]];

/// Entries below this part of an element's largest are not divided by.
const SMALL: f64 = 1e-6;
/// Elements of N_X meet the sampled conditions to this part of them: some thousand roundings.
const DERIVED: f64 = 1e-11;
/// Entries of elements below this part of the tolerance, next to the largest or to what was subtracted, are rounding.
const ROUNDING: f64 = 1e-2;
/// Of entries that differ by less than this part, the first is divided by.
const EQUAL: f64 = 1e-9;

/// Inertias of the bodies of one joint that can be moved to its parent.
pub(super) struct Element {
    /// Ten parameters of each body.
    pub(super) entries: DVector<f64>,
    /// The parameter that no other element has, where this one has 1.
    pub(super) pivot: usize,
    /// Whether it is of N_X, which the generator derived from the joint's spec.
    pub(super) is_derived: bool,
}

/// What the bodies of one joint can move to its parent, of which `parent` says how it moves, and the span of the conditions.
pub(super) fn elements(
    mechanism: &Mechanism,
    samples: &Samples,
    parent: &Motions,
    scale: &Scale,
    tolerance: f64,
) -> (Vec<Element>, Span) {
    let size = INERTIAL_PARAMETERS * samples.bodies.len();
    let conditions = Span::new(size, conditions(samples, parent), tolerance);
    let derived = derived(mechanism, samples, scale);
    let holds = |own: &DVector<f64>| (own - conditions.beside(own)).norm() <= DERIVED * own.norm();
    let derived: Vec<_> = derived.into_iter().filter(holds).collect();
    let mut reduced = Reduced::new(ROUNDING * tolerance);
    reduced.add(derived, true);
    reduced.add(conditions.complement(), false);
    (reduced.0, conditions)
}

/// The linear conditions on the parameters of all bodies of a joint, at all of its samples.
fn conditions(samples: &Samples, parent: &Motions) -> Vec<Row> {
    let mut rows = vec![];
    for places in &samples.others {
        let count = places[0].twists.len();
        for k in 0..count {
            let own =
                (k..count).map(|l| joined(places, |b| Place::pair(&b.twists[k], &b.twists[l])));
            rows.extend(own.map(Row::new));
            let carried = parent.twist_basis().map(|v| {
                joined(places, |b| {
                    Place::pair(&b.pose.act_twist_inverse(&v), &b.twists[k])
                })
            });
            rows.extend(carried.map(Row::new));
        }
        let changes = |functional: &DVector<f64>| {
            let read = |b: &Place| b.of_parent(functional);
            Row::difference(&joined(places, read), &joined(&samples.home, read))
        };
        rows.extend(parent.energies.basis().iter().map(changes));
        let weights = parent.gravity.basis().iter().map(|g| {
            let mut functional = DVector::zeros(INERTIAL_PARAMETERS);
            functional.rows_mut(1, 3).copy_from(g);
            changes(&functional)
        });
        rows.extend(weights);
    }
    rows
}

/// Ten numbers of each body, one after the other.
fn joined(places: &[Place], read: impl Fn(&Place) -> DVector<f64>) -> DVector<f64> {
    let numbers: Vec<f64> = places
        .iter()
        .flat_map(|place| read(place).data.as_vec().clone())
        .collect();
    DVector::from_vec(numbers)
}

/// N_X of each body of a joint, as the joint has it, in body frames.
fn derived(mechanism: &Mechanism, samples: &Samples, scale: &Scale) -> Vec<DVector<f64>> {
    let mut all = vec![];
    for (number, body) in mechanism.bodies()[samples.bodies.clone()]
        .iter()
        .enumerate()
    {
        let to_body = transport(&scale.pose(body.child_placement()).inverse());
        for element in body.joint().unidentifiable() {
            let mut own = SVector::<f64, INERTIAL_PARAMETERS>::zeros();
            for (entry, place) in element.iter().zip(PLACES) {
                own[place] = entry / scale.unit(place);
            }
            let mut entries = DVector::zeros(INERTIAL_PARAMETERS * samples.bodies.len());
            let start = INERTIAL_PARAMETERS * number;
            let moved = to_body * own;
            entries
                .rows_mut(start, INERTIAL_PARAMETERS)
                .copy_from(&moved);
            all.push(entries);
        }
    }
    all
}

/// Elements of which each alone has 1 at a parameter of its own.
struct Reduced(Vec<Element>, f64);

impl Reduced {
    /// None yet; entries below the part `rounding` of what was subtracted are none.
    fn new(rounding: f64) -> Self {
        Self(vec![], rounding)
    }

    /// Adds what `rows` span beside the elements that are there.
    fn add(&mut self, mut rows: Vec<DVector<f64>>, is_derived: bool) {
        for row in &mut rows {
            row.normalize_mut();
            for done in &self.0 {
                subtract(row, &done.entries, done.pivot, self.1);
            }
        }
        // What is left of rows that were there before.
        rows.retain(|row| row.amax() > SMALL);
        for class in ORDER {
            while let Some((number, pivot)) = largest(&rows, class) {
                let mut entries = rows.swap_remove(number);
                entries /= entries[pivot];
                let limit = self.1 * entries.amax();
                entries.apply(|entry| *entry = if entry.abs() <= limit { 0.0 } else { *entry });
                let done = self.0.iter_mut().map(|done| &mut done.entries);
                for other in rows.iter_mut().chain(done) {
                    subtract(other, &entries, pivot, self.1);
                }
                rows.retain(|row| row.amax() > SMALL);
                self.0.push(Element {
                    entries,
                    pivot,
                    is_derived,
                });
            }
        }
    }
}

/// Takes a multiple of another row away, so that the entry at its pivot is 0.
pub(super) fn subtract(row: &mut DVector<f64>, other: &DVector<f64>, pivot: usize, rounding: f64) {
    let factor = row[pivot];
    if factor == 0.0 {
        return;
    }
    for (entry, own) in row.iter_mut().zip(other) {
        let (before, part) = (*entry, factor * own);
        *entry = before - part;
        if entry.abs() <= rounding * (before.abs() + part.abs()) {
            *entry = 0.0;
        }
    }
    row[pivot] = 0.0;
}

/// Where rows have their largest entry at a parameter of this class, as a part of the row's largest; of the last body among equals.
fn largest(rows: &[DVector<f64>], class: &[usize]) -> Option<(usize, usize)> {
    let bodies = rows
        .first()
        .map_or(0, |row| row.len() / INERTIAL_PARAMETERS);
    let mut best = (SMALL, None);
    for body in (0..bodies).rev() {
        for parameter in class {
            let place = INERTIAL_PARAMETERS * body + parameter;
            for (number, row) in rows.iter().enumerate() {
                let part = row[place].abs() / row.amax();
                if part > best.0 * (1.0 + EQUAL) {
                    best = (part, Some((number, place)));
                }
            }
        }
    }
    best.1
}
