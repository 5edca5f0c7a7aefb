//! Which of the joints at rest are held, and which give way.

use super::complementarity::{Found, Place, Problem};
use super::contact::{Contact, Phase};
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, DVector};

/// Joints at rest, and how they would move if nothing held them.
pub(super) struct Resting<'a> {
    pub(super) contacts: &'a [Contact],
    /// Their indices.
    pub(super) members: &'a [usize],
    pub(super) q: &'a [f64],
    /// W, the block of M̄⁻¹ of their speeds.
    pub(super) matrix: DMatrix<f64>,
    /// c, their accelerations where no effort holds them.
    pub(super) free: DVector<f64>,
    /// Where efforts have just exceeded what holds a joint: below the lower bound or above the upper one.
    pub(super) exceeded: &'a dyn Fn(usize) -> Option<Place>,
}

impl Resting<'_> {
    /// What each of them does, in their order; `None` where that is not determined.
    ///
    /// A joint whose friction is larger at rest than in motion has the larger one until it is exceeded, and the smaller one from then on: those that are
    /// exceeded first give way, and others after them only where that exceeds theirs. With friction of one size there is one solution anyway.
    pub(super) fn phases(&self) -> Option<Vec<Phase>> {
        let places = self.members.iter().map(|&index| (self.exceeded)(index));
        let places = places.map(|place| place.unwrap_or(Place::Between));
        let mut places: Vec<Place> = places.collect();
        let mut slips = vec![false; places.len()];
        for _ in 0..=places.len() {
            for (slips, place) in slips.iter_mut().zip(&places) {
                *slips |= *place != Place::Between;
            }
            let bounds = self.members.iter().zip(&slips).map(|(&index, &slips)| {
                let contact = &self.contacts[index];
                contact.bounds(self.q, slips)
            });
            let problem = Problem {
                matrix: self.matrix.clone(),
                free: self.free.clone(),
                bounds: bounds.collect(),
            };
            let Found {
                places: found,
                is_still,
                ..
            } = problem.solve(places)?;
            places = found;
            // What is held by all that there is, and needs no more, stays.
            let pairs = self.members.iter().zip(places.iter_mut().zip(is_still));
            for (&index, (place, is_still)) in pairs {
                if is_still && (self.exceeded)(index).is_none() {
                    *place = Place::Between;
                }
            }
            let mut found = places.iter().zip(&slips);
            if found.all(|(place, slips)| *slips || *place == Place::Between) {
                return Some(self.phases_of(&places));
            }
        }
        None
    }

    fn phases_of(&self, places: &[Place]) -> Vec<Phase> {
        let pairs = self.members.iter().zip(places);
        let phases = pairs.map(|(&index, place)| {
            let contact = &self.contacts[index];
            let forward = match place {
                Place::Between => {
                    let at = contact.at(self.q);
                    return at.map_or(Phase::Sticks, Phase::Rests);
                }
                // Efforts at their lower bound give way towards larger coordinates.
                Place::AtLower => true,
                Place::AtUpper => false,
            };
            match contact.has_friction() {
                true => Phase::Slides { forward },
                false => Phase::Free,
            }
        });
        phases.collect()
    }
}
