//! What the trees of the suite are made of.

use super::{LARGEST, points};
use hamel::erased::AnyJoint;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The suite would say less if the trees did.
///
/// # Panics
/// Where a size or a kind of joint is rare.
pub fn trees_are_of_all_kinds(kinds: &[Arc<dyn AnyJoint>]) {
    let mut off_root = BTreeMap::new();
    let mut sizes = [0; LARGEST + 1];
    for point in points(kinds) {
        let mechanism = &point.case.mechanism;
        sizes[mechanism.joints().count()] += 1;
        for (_, body) in mechanism.joints() {
            let (at_root, inside) = off_root.entry(body.joint().name()).or_insert((0, 0));
            *(if body.parent().is_none() {
                at_root
            } else {
                inside
            }) += 1;
        }
    }
    assert!(sizes[1..].iter().all(|&count| count >= 5), "{sizes:?}");
    assert_eq!(off_root.len(), kinds.len());
    assert!(
        off_root
            .values()
            .all(|&(at_root, inside)| at_root > 0 && inside > 3),
        "{off_root:?}"
    );
}
