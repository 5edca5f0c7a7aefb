//! Bodies that take the same place in like limbs.

use crate::model::Model;
use std::collections::BTreeMap;

/// The place of a body among like ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Member {
    /// The class of bodies that are like it.
    pub class: usize,
    /// Its number in the class: bodies of one limb have the same in all classes that are as large.
    pub limb: usize,
}

/// What a body hangs on: that body, or any one of a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Carrier {
    Body(Option<usize>),
    Class(usize),
}

/// For each body its place among those with like limbs and a like way to the root; none for a body that is alone in this.
pub fn members(model: &Model) -> Vec<Option<Member>> {
    let shapes = shapes(model);
    let mut members: Vec<Option<Member>> = vec![None; model.bodies.len()];
    let mut layer: BTreeMap<(Carrier, usize), Vec<usize>> = BTreeMap::new();
    let mut classes = 0;
    let depths = model.depths();
    for depth in 0..=depths.iter().copied().max().unwrap_or(0) {
        layer.clear();
        for (body, _) in depths.iter().enumerate().filter(|&(_, &own)| own == depth) {
            let parent = model.bodies[body].parent;
            let carrier = match parent.and_then(|parent| members[parent]) {
                Some(member) => Carrier::Class(member.class),
                None => Carrier::Body(parent),
            };
            layer.entry((carrier, shapes[body])).or_default().push(body);
        }
        for alike in layer.values_mut().filter(|alike| alike.len() > 1) {
            let limb = |body: &usize| {
                let parent = model.bodies[*body].parent?;
                members[parent].map(|member| member.limb)
            };
            alike.sort_by_key(limb);
            for (limb, &body) in alike.iter().enumerate() {
                members[body] = Some(Member {
                    class: classes,
                    limb,
                });
            }
            classes += 1;
        }
    }
    members
}

/// For each body a number that those share which carry alike: types of joints, to the leaves.
fn shapes(model: &Model) -> Vec<usize> {
    let mut carried: Vec<Vec<usize>> = vec![vec![]; model.bodies.len()];
    let mut shapes = vec![0; model.bodies.len()];
    let mut known: BTreeMap<(String, usize, bool, Vec<usize>), usize> = BTreeMap::new();
    for (index, body) in model.bodies.iter().enumerate().rev() {
        let mut own = std::mem::take(&mut carried[index]);
        own.sort_unstable();
        let derived = &body.joint.derived;
        let key = (
            derived.spec.name.value.clone(),
            derived.body,
            body.driven,
            own,
        );
        let number = known.len();
        shapes[index] = *known.entry(key).or_insert(number);
        if let Some(parent) = body.parent {
            carried[parent].push(shapes[index]);
        }
    }
    shapes
}
