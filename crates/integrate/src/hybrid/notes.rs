//! What is reported of the ends of pieces.

use super::contact::{Contact, Phase, Side};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;

/// An impact, or that a joint begins or ceases to be held.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Note {
    /// The body whose joint it is.
    pub(crate) body: usize,
    pub(crate) name: String,
    /// Whether it is an impact.
    pub(super) is_impact: bool,
    /// Whether the joint moves towards larger coordinates, before it where it is at rest after it.
    pub(crate) rising: bool,
}

/// What is reported of one joint; `speeds` are its own before and after.
pub(super) fn of_joint(
    contact: &Contact,
    hit: Option<Side>,
    (before, after): (Phase, Phase),
    speeds: (f64, f64),
) -> Vec<Note> {
    let note = |(joint, what): (&str, String), rising: bool| Note {
        body: contact.body,
        is_impact: false,
        name: format!("{joint}: {what}"),
        rising,
    };
    let at_limit = |verb: &str, side: Side| {
        let (joint, limit) = contact.told(side);
        (joint, format!("{verb} its {limit} limit"))
    };
    let own = |what: &str| (&*contact.joint, String::from(what));
    let mut notes = Vec::new();
    if let Some(side) = hit {
        notes.push(Note {
            is_impact: true,
            ..note(at_limit("hits", side), speeds.0 > 0.0)
        });
    }
    let moves_forward = match after {
        Phase::Slides { forward } => forward,
        _ => speeds.1 > 0.0,
    };
    let what = match (before, after) {
        (before, after) if before == after => None,
        (before, Phase::Sticks) => {
            // The speed at its end has turned round already.
            let forward = match before {
                Phase::Slides { forward } => forward,
                _ => speeds.0 > 0.0,
            };
            Some((own("sticks"), forward))
        }
        (_, Phase::Rests(side)) => Some((at_limit("rests at", side), side == Side::Upper)),
        (Phase::Rests(side), _) => Some((at_limit("leaves", side), side == Side::Lower)),
        (Phase::Sticks, _) => Some((own("slides"), moves_forward)),
        // An impact turns it round, and has been told.
        (Phase::Slides { .. }, Phase::Slides { .. }) if hit.is_none() => {
            Some((own("slides back"), moves_forward))
        }
        _ => None,
    };
    notes.extend(what.map(|(what, rising)| note(what, rising)));
    notes
}
