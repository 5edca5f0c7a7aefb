//! What ends a smooth piece of a motion: functions that are positive as long as it lasts.

use super::contact::{Contact, Phase, Side};
use super::holding::Holding;
use crate::StepFailure;
use crate::dense::Instant;
use crate::flow::Flow;
use alloc::vec::Vec;

/// By what part of itself an effort must exceed what can be held before a joint gives way: at its beginning a piece is not beyond its own end by rounding.
const MARGIN: f64 = 1e-11;

/// One end of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Guard {
    /// The speed of a sliding joint changes its sign.
    Reverses { contact: usize, forward: bool },
    /// A joint comes to its limit.
    Reaches { contact: usize, side: Side },
    /// What holds a joint is more than there can be: below the lower bound of it, or above the upper one.
    Releases {
        contact: usize,
        above: bool,
        bound: f64,
    },
}

impl Guard {
    pub(super) const fn contact(self) -> usize {
        match self {
            Self::Reverses { contact, .. }
            | Self::Reaches { contact, .. }
            | Self::Releases { contact, .. } => contact,
        }
    }

    pub(crate) const fn is_of_holding(self) -> bool {
        matches!(self, Self::Releases { .. })
    }
}

/// Those of one piece.
pub(crate) struct Guards {
    pub(crate) list: Vec<Guard>,
    contacts: Vec<Contact>,
    holding: Holding,
}

impl Guards {
    /// Of the piece in which the joints do this, with the efforts that hold some of them at its beginning.
    pub(super) fn new(
        contacts: &[Contact],
        phases: &[Phase],
        q: &[f64],
        (holding, efforts): (Holding, &[f64]),
    ) -> Self {
        let mut list = Vec::new();
        for (index, (contact, phase)) in contacts.iter().zip(phases).enumerate() {
            if let Phase::Slides { forward } = *phase {
                list.push(Guard::Reverses {
                    contact: index,
                    forward,
                });
            }
            if phase.is_held() {
                let bounds = contact.bounds(q, false);
                releases(index, bounds, efforts[contact.speed], &mut list);
                continue;
            }
            let sides = Side::BOTH.into_iter();
            let limited = sides.filter(|side| contact.limit(*side).is_some());
            list.extend(limited.map(|side| Guard::Reaches {
                contact: index,
                side,
            }));
        }
        Self {
            list,
            contacts: contacts.to_vec(),
            holding,
        }
    }

    /// Whether any joint is held.
    pub(crate) fn holds(&self) -> bool {
        self.list.iter().any(|guard| guard.is_of_holding())
    }

    /// The value of one.
    pub(crate) fn value(
        &mut self,
        index: usize,
        flow: &mut Flow<'_>,
        instant: &Instant<'_>,
    ) -> Result<f64, StepFailure> {
        let guard = self.list[index];
        if guard.is_of_holding() {
            self.holding.find(flow, instant.state())?;
        }
        Ok(self.read(guard, instant))
    }

    /// The values of all, each given to `take` with its index.
    pub(crate) fn values(
        &mut self,
        flow: &mut Flow<'_>,
        instant: &Instant<'_>,
        mut take: impl FnMut(usize, f64),
    ) -> Result<(), StepFailure> {
        if self.holds() {
            self.holding.find(flow, instant.state())?;
        }
        for (index, guard) in self.list.iter().enumerate() {
            take(index, self.read(*guard, instant));
        }
        Ok(())
    }

    fn read(&self, guard: Guard, instant: &Instant<'_>) -> f64 {
        let own = &self.contacts[guard.contact()];
        match guard {
            Guard::Reverses { forward, .. } => match forward {
                true => instant.speeds[own.speed],
                false => -instant.speeds[own.speed],
            },
            Guard::Reaches { side, .. } => {
                let limit = own.limit(side).unwrap_or(f64::NAN);
                // From the base point, which is the limit after an impact: the smallest of bounces keep their digits.
                let gap = (instant.base[own.coordinate] - limit) + instant.phi[own.freedom];
                side.inwards() * gap
            }
            Guard::Releases { above, bound, .. } => {
                let effort = self.holding.effort(own);
                if above {
                    bound - effort
                } else {
                    effort - bound
                }
            }
        }
    }
}

/// The ends of a joint's being held by efforts within `bounds`, of which `effort` is the first.
fn releases(contact: usize, (lower, upper): (f64, f64), effort: f64, list: &mut Vec<Guard>) {
    let room = |bound: f64| MARGIN * bound.abs().max(effort.abs()).max(f64::MIN_POSITIVE);
    if lower.is_finite() {
        list.push(Guard::Releases {
            contact,
            above: false,
            bound: lower.min(effort) - room(lower),
        });
    }
    if upper.is_finite() {
        list.push(Guard::Releases {
            contact,
            above: true,
            bound: upper.max(effort) + room(upper),
        });
    }
}
