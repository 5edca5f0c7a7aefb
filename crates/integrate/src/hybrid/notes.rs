//! What is told of the ends of pieces.

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

/// What is told of one joint; `speeds` are its own before and after.
pub(super) fn of_joint(
    contact: &Contact,
    hit: Option<Side>,
    (before, after): (Phase, Phase),
    speeds: (f64, f64),
) -> Vec<Note> {
    let note = |what: String, rising: bool| Note {
        body: contact.body,
        is_impact: false,
        name: format!("{}: {what}", contact.joint),
        rising,
    };
    let mut notes = Vec::new();
    if let Some(side) = hit {
        let what = format!("hits its {} limit", side.name());
        notes.push(Note {
            is_impact: true,
            ..note(what, speeds.0 > 0.0)
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
            Some(("sticks".into(), forward))
        }
        (_, Phase::Rests(side)) => {
            let what = format!("rests at its {} limit", side.name());
            Some((what, side == Side::Upper))
        }
        (Phase::Rests(side), _) => {
            let what = format!("leaves its {} limit", side.name());
            Some((what, side == Side::Lower))
        }
        (Phase::Sticks, _) => Some(("slides".into(), moves_forward)),
        // An impact turns it round, and has been told.
        (Phase::Slides { .. }, Phase::Slides { .. }) if hit.is_none() => {
            Some(("slides back".into(), moves_forward))
        }
        _ => None,
    };
    notes.extend(what.map(|(what, rising)| note(what, rising)));
    notes
}
