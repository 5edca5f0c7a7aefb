//! Theorems 2 and 3, and simulations, on random trees of this crate's joints.

use hamel::erased::AnyJoint;
use hamel::registry::JointRegistry;
use hamel_downstream::WITH_KNOTS;
use hamel_tests::{motion, random};
use std::sync::Arc;

fn kinds() -> Vec<Arc<dyn AnyJoint>> {
    let mut registry = JointRegistry::new();
    registry
        .extend(hamel_downstream::of_trees())
        .expect("distinct names");
    random::kinds(&registry)
}

/// The laws compare with differences of high order.
fn without_knots() -> Vec<Arc<dyn AnyJoint>> {
    let mut kinds = kinds();
    kinds.retain(|kind| !WITH_KNOTS.contains(&kind.name()));
    kinds
}

hamel_tests::reference_form_tests!(crate::dynamics::without_knots());

#[test]
fn energy_is_kept_in_simulation() {
    motion::energy_is_kept(&kinds());
}

#[test]
fn both_forms_make_the_same_motion() {
    motion::forms_agree(&kinds());
}
