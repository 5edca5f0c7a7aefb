//! Lists of as many entries as a joint has links.

use super::MOST_LINKS;

/// As many entries as a joint has links, without allocation.
pub(super) struct Filled<E> {
    entries: [E; MOST_LINKS],
    count: usize,
}

impl<E: Copy> Filled<E> {
    pub(super) fn new(empty: E) -> Self {
        Self {
            entries: [empty; MOST_LINKS],
            count: 0,
        }
    }

    pub(super) fn push(&mut self, entry: E) {
        if let Some(place) = self.entries.get_mut(self.count) {
            *place = entry;
            self.count += 1;
        }
    }
}

impl<E> AsRef<[E]> for Filled<E> {
    fn as_ref(&self) -> &[E] {
        &self.entries[..self.count]
    }
}
