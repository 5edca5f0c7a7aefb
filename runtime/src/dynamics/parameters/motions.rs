//! How a body can move at all: spans over every configuration and velocity of the joints that carry it.

use super::sample::{Place, Samples};
use super::span::{Row, Span};
use alloc::vec::Vec;
use nalgebra::{DVector, Vector3, Vector6};

/// What a body can do, read in its body frame. Each span is over all states of the joints between it and the world.
#[derive(Clone, Debug)]
pub(super) struct Motions {
    /// Its twists V: 6 entries.
    pub(super) twists: Span,
    /// The functionals `Vᵀ N V` of its ten parameters.
    pub(super) energies: Span,
    /// Directions of gravity.
    pub(super) gravity: Span,
}

impl Motions {
    /// The world: it stands still.
    pub(super) fn world(gravity: &Vector3<f64>) -> Self {
        let gravity = match gravity.norm() > 0.0 {
            true => alloc::vec![Row::new(DVector::from_column_slice(
                gravity.normalize().as_slice()
            ))],
            false => Vec::new(),
        };
        Self {
            twists: Span::new(6, Vec::new(), 0.0),
            energies: Span::new(10, Vec::new(), 0.0),
            gravity: Span::new(3, gravity, 0.0),
        }
    }

    /// A body that can move in every way.
    fn free() -> Self {
        Self {
            twists: Span::full(6),
            energies: Span::full(10),
            gravity: Span::full(3),
        }
    }

    /// Whether nothing that it carries feels less than it would on a free body.
    pub(super) fn is_free(&self) -> bool {
        self.twists.is_full() && self.energies.is_full() && self.gravity.is_full()
    }

    /// A basis of its twists.
    pub(super) fn twist_basis(&self) -> impl Iterator<Item = Vector6<f64>> + Clone {
        let basis = self.twists.basis().iter();
        basis.map(|own| Vector6::from_column_slice(own.as_slice()))
    }

    /// What one of the bodies of a joint can do, where its parent can do this.
    pub(super) fn of_child(&self, samples: &Samples, body: usize, tolerance: f64) -> Self {
        if self.is_free() {
            return Self::free();
        }
        let (mut twists, mut energies, mut gravity) = (Vec::new(), Vec::new(), Vec::new());
        let home = core::iter::once(&samples.home[body]);
        // Twists of home are not evened: it adds what the parent does alone.
        for place in home {
            self.carry(place, &mut twists, &mut energies, &mut gravity);
        }
        for places in &samples.others {
            let place = &places[body];
            self.carry(place, &mut twists, &mut energies, &mut gravity);
            let own = &place.twists;
            twists.extend(own.iter().map(row_of));
            for (k, twist) in own.iter().enumerate() {
                let carried = self.carried_twists(place);
                energies.extend(carried.map(|v| Row::new(Place::pair(&v, twist))));
                let pairs = own[k..].iter();
                energies.extend(pairs.map(|other| Row::new(Place::pair(twist, other))));
            }
        }
        Self {
            twists: Span::new(6, twists, tolerance),
            energies: Span::new(10, energies, tolerance),
            gravity: Span::new(3, gravity, tolerance),
        }
    }

    /// The twists of the parent, read in the child's frame.
    pub(super) fn carried_twists(&self, place: &Place) -> impl Iterator<Item = Vector6<f64>> {
        self.twist_basis()
            .map(|own| place.pose.act_twist_inverse(&own))
    }

    /// What the child does where its joint is at rest.
    fn carry(
        &self,
        place: &Place,
        twists: &mut Vec<Row>,
        energies: &mut Vec<Row>,
        gravity: &mut Vec<Row>,
    ) {
        twists.extend(self.carried_twists(place).map(|own| row_of(&own)));
        let basis = self.energies.basis().iter();
        energies.extend(basis.map(|own| Row::new(place.of_parent(own))));
        let basis = self.gravity.basis().iter();
        gravity.extend(basis.map(|own| {
            let turned = place.pose.rotation.tr_mul(own);
            Row::new(DVector::from_column_slice(turned.as_slice()))
        }));
    }
}

fn row_of(twist: &Vector6<f64>) -> Row {
    Row::new(DVector::from_column_slice(twist.as_slice()))
}
