//! Motions with dry friction and limits of joints: smooth pieces, and what happens between them.
//!
//! In a piece each joint with friction or limits has a [`Phase`]. One that is held, by friction or at a limit, is driven at speed 0, so that its speed is
//! exactly 0 and its coordinate exactly constant in any form, arithmetic and method; one that slides has the constant effort of its friction added to τ. A
//! piece ends where one of its [`Guards`] turns negative, which is located as events are. Then:
//! 1. joints that are at a limit and move beyond it hit it: an impact ([`impact`]) of all joints that touch their limits;
//! 2. joints at rest are held or give way as a complementarity problem says ([`release`]): accelerations are `a = c + W x` with the efforts x that hold
//!    them, W the block of M̄⁻¹ of these joints, and x is between what friction and limits can do.

mod complementarity;
mod contact;
mod fault;
mod guards;
mod hits;
mod holding;
mod impact;
mod modes;
mod notes;
mod release;
pub(super) mod resolution;
mod transition;

pub(super) use contact::Sliding;
pub(super) use guards::{Guard, Guards};
pub(super) use notes::Note;

use super::StepFailure;
use super::flow::Flow;
use alloc::format;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use contact::{Contact, Phase};
use hamel_runtime::dynamics::{EffortAtPort, Recursive};
use hamel_runtime::mechanism::Mechanism;
use holding::Holding;
use modes::Modes;

/// How far a step reaches, as a part of a bounce.
const BEYOND: f64 = 1.5;

/// Pieces shorter than this part of the whole motion are counted.
const SHORT: f64 = 1e-9;

/// So many of them may follow each other: bounces that lose a thousandth of their speed come to rest in 10⁴.
const MOST_SHORT: usize = 10_000;

/// What a motion with friction and limits is made of.
pub(super) struct Hybrid<'a> {
    contacts: Vec<Contact>,
    phases: Vec<Phase>,
    modes: Modes<'a>,
    /// The equations of motion with no joint held.
    free: Recursive,
    /// The same without gravity and elements: columns of M̄⁻¹.
    bare: Recursive,
    /// How long a piece is short, s.
    short: f64,
    /// Short pieces until now, and when the last one began.
    count: usize,
    last: f64,
}

impl Hybrid<'_> {
    /// For a motion over `span` (s); `None` where no joint has friction or limits.
    pub(super) fn new(mechanism: &Arc<Mechanism>, span: f64) -> Option<Self> {
        let contacts = Contact::all(mechanism);
        if contacts.is_empty() {
            return None;
        }
        Some(Self {
            phases: vec![Phase::Free; contacts.len()],
            modes: Modes::new(mechanism),
            free: Recursive::new(Arc::clone(mechanism)),
            bare: Recursive::new(Arc::new(mechanism.without_loads())),
            short: SHORT * span,
            count: 0,
            last: f64::NEG_INFINITY,
            contacts,
        })
    }

    /// A step that reaches beyond the next impact of every joint that has just bounced, s, as its speed and acceleration have it.
    pub(super) fn flight(&self, q: &[f64], speeds: &[f64], rates: &[f64]) -> f64 {
        let flights = self.contacts.iter().filter_map(|contact| {
            let inwards = contact.at(q)?.inwards();
            let (leaves, returns) = (
                speeds[contact.speed] * inwards,
                -rates[contact.speed] * inwards,
            );
            (leaves > 0.0 && returns > 0.0).then(|| BEYOND * 2.0 * leaves / returns)
        });
        flights.fold(f64::INFINITY, f64::min)
    }

    /// Efforts of friction at ports, at a time, `q` and v̄. Friction that holds a joint is shared out among its places by what each can hold; a joint at a limit is held by the
    /// limit alone.
    pub(super) fn efforts_at_ports(
        &self,
        flow: &mut Flow<'_>,
        (time, q, speeds): (f64, &[f64], &[f64]),
    ) -> Result<Vec<EffortAtPort>, StepFailure> {
        let mut holding: Option<Holding> = None;
        let mut efforts = Vec::new();
        for (contact, phase) in self.contacts.iter().zip(&self.phases) {
            match phase {
                Phase::Slides { forward } => efforts.extend(contact.sliding_at_ports(q, *forward)),
                Phase::Sticks if contact.has_friction_at_ports() => {
                    let holding = match &mut holding {
                        Some(holding) => holding,
                        none => none.insert(Holding::at(flow, (time, q, speeds))?),
                    };
                    efforts.extend(contact.sticking_at_ports(q, holding.effort(contact)));
                }
                Phase::Sticks | Phase::Rests(_) | Phase::Free => {}
            }
        }
        Ok(efforts)
    }

    /// Guards that tell by less time than this are trusted as they are, s.
    pub(super) const fn short(&self) -> f64 {
        self.short
    }
}

/// Their names: `` `a` ``, or `` `a`, `b` and `c` ``.
fn names(contacts: &[Contact], of: impl IntoIterator<Item = usize>) -> String {
    let of = of.into_iter();
    let names: Vec<_> = of.map(|i| format!("`{}`", contacts[i].joint)).collect();
    match names.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, first)) => format!("{} and {last}", first.join(", ")),
        None => String::new(),
    }
}
