//! Derivatives where joints carry several bodies: found for each body with a joint of its own, then summed over the bodies of each joint.
//!
//! A mechanism whose joints carry several bodies is a tree of joints with one body each, in which the bodies of a joint happen to have the same
//! coordinates. What is linear in the bodies is so found by the same code, with a row and a column for each body, and *folded*.

use super::Sensitivity;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::link::Link;
use crate::dynamics::recursive::several::groups;
use crate::mechanism::Mechanism;
use core::ops::Range;

/// Whether any joint of `mechanism` carries several bodies, or has rotors at ports.
pub(super) fn is_folded(mechanism: &Mechanism) -> bool {
    groups(mechanism).next().is_some()
}

/// Room for derivatives in ϕ and in v̄ with a row for each body and each speed of its joint; `None` where each joint carries one body.
pub(super) fn room(mechanism: &Mechanism) -> Option<[Sensitivity; 2]> {
    let (columns, variations) = (mechanism.columns(), mechanism.variations());
    is_folded(mechanism).then(|| {
        [
            Sensitivity::new(columns, variations),
            Sensitivity::new(columns, columns),
        ]
    })
}

impl Recursive {
    /// Sums derivatives in ϕ over the bodies of each joint.
    pub(super) fn fold_locals(&self, unfolded: &Sensitivity, out: &mut Sensitivity) {
        self.fold_matrix(unfolded, out, |link| (&link.variations, &link.freedoms));
    }

    /// Sums derivatives in v̄ over the bodies of each joint.
    pub(super) fn fold_speeds(&self, unfolded: &Sensitivity, out: &mut Sensitivity) {
        self.fold_matrix(unfolded, out, |link| (&link.columns, &link.speeds));
    }

    /// Sums a matrix with a row for each body and speed over the bodies of each joint; `places` says where the columns of a body are, and where their
    /// sums go.
    fn fold_matrix(
        &self,
        unfolded: &Sensitivity,
        out: &mut Sensitivity,
        places: impl Fn(&Link) -> (&Range<usize>, &Range<usize>),
    ) {
        out.clear();
        for of_row in &self.links {
            for (row, sum) in of_row.columns.clone().zip(of_row.speeds.clone()) {
                let (entries, sums) = (unfolded.row(row), out.row_mut(sum));
                for of_column in &self.links {
                    let (from, to) = places(of_column);
                    for (sum, entry) in sums[to.clone()].iter_mut().zip(&entries[from.clone()]) {
                        *sum += entry;
                    }
                }
            }
        }
    }
}
