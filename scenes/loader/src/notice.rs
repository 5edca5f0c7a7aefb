//! What a file says and the simulation leaves out: told beside the scene, never dropped in silence.

use std::fmt;

/// Names of elements that a notice shows; the others are counted.
const MOST_SHOWN: usize = 4;

/// Something that a file says and that has no effect on the simulation, or that the format leaves open.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// What it is, in words.
    pub message: String,
    /// The elements that it is about, such as "joint `elbow`", in the order of the file.
    pub elements: Vec<String>,
}

impl fmt::Display for Notice {
    /// The message, and the first few of the elements.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)?;
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
pub(crate) struct Notices(Vec<Notice>);

impl Notices {
    /// Adds an element to the notice of that message.
    pub(crate) fn add(&mut self, message: impl Into<String>, element: impl Into<String>) {
        let (message, element) = (message.into(), element.into());
        match self.0.iter_mut().find(|notice| notice.message == message) {
            Some(notice) => notice.elements.push(element),
            None => self.0.push(Notice {
                message,
                elements: vec![element],
            }),
        }
    }

    /// The notices, in the order of their first elements.
    pub(crate) fn into_vec(self) -> Vec<Notice> {
        self.0
    }
}
