//! All impacts of one instant.

use super::contact::Side;
use super::fault::Fault;
use super::impact::{Touching, impact};
use super::{Hybrid, names};
use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::Dynamics;

/// Joints that touch their limits at one instant may throw each other back so often: where each time takes a hundredth of their speeds, they rest after 2800.
const MOST_IMPACTS: usize = 10_000;

impl Hybrid<'_> {
    /// Impacts of the joints that are at their limits, until none of them moves beyond: which limit each one hits.
    ///
    /// Joints that move away have no part in an impact. Where it throws one of them back against its limit, that is the next impact.
    pub(super) fn hit(
        &mut self,
        q: &[f64],
        speeds: &mut [f64],
    ) -> Result<Vec<Option<Side>>, Fault> {
        let mut hits = vec![None; self.contacts.len()];
        let at_limits = self.at_limits(q);
        let inward = |own: &Touching, speeds: &[f64]| {
            own.side.inwards() * speeds[self.contacts[own.contact].speed]
        };
        if at_limits.iter().all(|own| inward(own, speeds) >= 0.0) {
            return Ok(hits);
        }
        let members: Vec<usize> = at_limits.iter().map(|own| own.contact).collect();
        let (columns, matrix) = self.inverse_mass(q, &members)?;
        let contacts = &self.contacts;
        let undecided = |reason: String| Fault::Undecided {
            what: "impact",
            joints: names(contacts, members.iter().copied()),
            reason,
        };
        let inward = |i: &usize, speeds: &[f64]| {
            at_limits[*i].side.inwards() * speeds[contacts[members[*i]].speed]
        };
        for _ in 0..MOST_IMPACTS {
            let all = 0..members.len();
            let stay: Vec<usize> = all.filter(|i| inward(i, speeds) <= 0.0).collect();
            if !stay.iter().any(|i| inward(i, speeds) < 0.0) {
                return Ok(hits);
            }
            let touching: Vec<Touching> = stay.iter().map(|&i| at_limits[i]).collect();
            let own = matrix.select_rows(&stay).select_columns(&stay);
            let found = impact(contacts, &touching, speeds, own);
            let found = found.ok_or_else(|| {
                undecided("the impulses are not determined: the joints depend on each other".into())
            })?;
            for (&i, impulse) in stay.iter().zip(&found.impulses) {
                if *impulse != 0.0 {
                    hits[members[i]] = Some(at_limits[i].side);
                }
                for (speed, rate) in speeds.iter_mut().zip(&columns[i]) {
                    *speed += impulse * rate;
                }
            }
            for (&i, after) in stay.iter().zip(&found.after) {
                speeds[contacts[members[i]].speed] = *after;
            }
            self.free.complete_speeds(q, speeds)?;
        }
        Err(undecided(format!(
            "they throw each other back more than {MOST_IMPACTS} times at once"
        )))
    }

    /// The joints that are at limits.
    fn at_limits(&self, q: &[f64]) -> Vec<Touching> {
        let contacts = self.contacts.iter().enumerate();
        let at_limits = contacts.filter_map(|(contact, own)| {
            let side = own.at(q)?;
            Some(Touching { contact, side })
        });
        at_limits.collect()
    }
}
