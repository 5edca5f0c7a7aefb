//! The kernels of a joint as each of its bodies sees it, in words: those of Q and v alone once, H and twists of each.

use super::kernels::{as_derived, shortened};
use super::verify::have_values_of;
use super::words::Words;
use crate::expand::{self, Expansion};
use crate::kernel::{Kernel, KernelKind, Word};
use crate::prepare::Prepared;

/// Kernels, and the words that they use.
pub type Written = (Vec<Kernel>, Vec<Word>);

/// A joint as one of its bodies sees it.
pub struct View {
    /// The joint with that body alone.
    pub joint: Prepared,
    /// What follows for it.
    pub expansion: Expansion,
    /// Its kernels, as they were derived: of the first body all, of others those that are theirs alone.
    pub kernels: Vec<Kernel>,
}

/// The kernels of each body with what they compute in few operations, and under the names that the spec gives.
///
/// Where the result has another value than what was derived, it is dropped: the kernels are then those that were derived.
pub fn in_words(joint: &Prepared, first: &View, others: &[View]) -> (Written, Vec<Written>) {
    let words = Words::new(joint, &first.expansion);
    let shared = first.in_words(&words, &first.kernels);
    let others = others.iter().map(|view| {
        let derived = [of_all(&first.kernels), view.kernels.clone()].concat();
        beside(&shared, view.in_words(&words, &derived))
    });
    let others = others.collect();
    (shared, others)
}

/// The kernels that belong to Q and v alone.
fn of_all(kernels: &[Kernel]) -> Vec<Kernel> {
    let kernels = kernels.iter().filter(|kernel| !kernel.kind.is_of_body());
    kernels.cloned().collect()
}

/// The kernels of a further body beside those that it shares with the first.
fn beside(shared: &Written, (own, used): Written) -> Written {
    let own = own.into_iter().filter(|kernel| kernel.kind.is_of_body());
    let mut kernels: Vec<Kernel> = of_all(&shared.0).into_iter().chain(own).collect();
    kernels.sort_by_key(|kernel| kernel.kind);
    // A word means one value in all of them; those of this body are made of its own and of shared ones.
    let is_new = |word: &Word| shared.1.iter().all(|other| other.symbol != word.symbol);
    let used = used.into_iter().filter(is_new);
    (kernels, shared.1.iter().cloned().chain(used).collect())
}

impl View {
    /// That of a body, with the kernels that are its own.
    pub fn of_body(joint: &Prepared, expansion: &Expansion, body: usize) -> Self {
        let (joint, expansion) = (joint.carrying(body), expansion.carrying(body));
        Self {
            kernels: expand::of_body(&joint, &expansion),
            joint,
            expansion,
        }
    }

    /// Its kernels in words, where these have the values of the derived ones.
    fn in_words(&self, words: &Words<'_>, derived: &[Kernel]) -> Written {
        let (joint, expansion) = (&self.joint, &self.expansion);
        // All that is written here: S̄ serves to write what is made of X̄.
        let is_own = |kernel: &&Kernel| {
            let mut own = self.kernels.iter();
            kernel.kind == KernelKind::SpeedBasis || own.any(|other| other.kind == kernel.kind)
        };
        let kernels: Vec<Kernel> = derived.iter().filter(is_own).cloned().collect();
        if words.are_used() {
            let (written, used) = shortened(joint, expansion, words.clone(), kernels.clone());
            if have_values_of(&written, derived, joint, expansion) {
                return (written, used);
            }
        }
        as_derived(joint, expansion, kernels, &words.without_names())
    }
}
