//! What a file says and the simulation leaves out: reported beside the scene, never dropped in silence.

use std::collections::HashMap;
use std::fmt;

/// Names of elements that a notice shows; the others are counted.
const MOST_SHOWN: usize = 4;

/// How much a notice matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The mechanism moves otherwise than the file says.
    Warning,
    /// Good to know.
    Note,
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Warning => "warning",
            Self::Note => "note",
        })
    }
}

/// Something that a file says and that has no effect on the simulation, or that the format leaves open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// How much it matters.
    pub severity: Severity,
    /// What it is, in words.
    pub message: String,
    /// The elements that it is about, such as "joint `elbow`", in the order of the file.
    pub elements: Vec<String>,
}

impl fmt::Display for Notice {
    /// Severity and message, and the first few of the elements: `warning: dry friction is not simulated: joint `elbow``.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.severity, self.message)?;
        let shown = self.elements.len().min(MOST_SHOWN);
        for (index, element) in self.elements[..shown].iter().enumerate() {
            let mark = if index == 0 { ": " } else { ", " };
            write!(f, "{mark}{element}")?;
        }
        match self.elements.len() - shown {
            0 => Ok(()),
            more => write!(f, " and {more} more"),
        }
    }
}

/// Collects notices, one for each message.
#[derive(Debug, Default)]
pub(crate) struct Notices {
    notices: Vec<Notice>,
    /// Their places by their messages, of which there may be as many as elements.
    places: HashMap<String, usize>,
}

impl Notices {
    /// Adds an element to the note of that message.
    pub(crate) fn add(&mut self, message: impl Into<String>, element: impl Into<String>) {
        self.add_as(Severity::Note, message.into(), element.into());
    }

    /// Adds an element to the warning of that message.
    pub(crate) fn warn(&mut self, message: impl Into<String>, element: impl Into<String>) {
        self.add_as(Severity::Warning, message.into(), element.into());
    }

    fn add_as(&mut self, severity: Severity, message: String, element: String) {
        match self.places.get(&message) {
            Some(&place) => {
                let elements = &mut self.notices[place].elements;
                // What is told twice of one element is told once.
                if elements.last() != Some(&element) {
                    elements.push(element);
                }
            }
            None => {
                self.places.insert(message.clone(), self.notices.len());
                self.notices.push(Notice {
                    severity,
                    message,
                    elements: vec![element],
                });
            }
        }
    }

    /// The notices, warnings before notes, and otherwise in the order of their first elements.
    pub(crate) fn into_vec(mut self) -> Vec<Notice> {
        self.notices.sort_by_key(|notice| notice.severity);
        self.notices
    }
}
