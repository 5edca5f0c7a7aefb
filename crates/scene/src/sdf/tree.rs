//! The links as trees: of each link the joint that it hangs on. What is left are joints that close loops.

use super::content::{Content, Kind, WORLD};
use super::joint::{Joint, JointType};
use std::collections::HashSet;

/// A joint that a link hangs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Hangs {
    /// Its place among the joints.
    pub(super) joint: usize,
    /// Whether the link is the joint's parent, which hangs on its child.
    pub(super) reversed: bool,
}

/// What each entity hangs on, where it is a link that hangs on something.
///
/// Joints are followed from the world, then from links that are the child of no joint, as far as they go: fixed joints before others, and otherwise as the file has them. A link that is the child of
/// no joint may still be held by one, as its parent: where the child is part of a tree already, the joint is followed from there.
pub(super) fn hangs_on(content: &Content<'_, '_>, joints: &[Joint<'_, '_>]) -> Vec<Option<Hangs>> {
    let count = content.entities.len();
    let mut search = Search {
        joints,
        leave: vec![Vec::new(); count],
        seen: vec![false; count],
        hangs: vec![None; count],
    };
    for fixed in [true, false] {
        let own = joints.iter().enumerate();
        let own = own.filter(|(_, joint)| (joint.kind == JointType::Fixed) == fixed);
        for (place, joint) in own {
            search.leave[joint.ends[0].unwrap_or(WORLD)].push(place);
        }
    }
    search.begin(WORLD);
    let children: HashSet<usize> = joints.iter().filter_map(|joint| joint.ends[1]).collect();
    let links = content.of(Kind::Link);
    let (held, free): (Vec<usize>, Vec<usize>) = links.partition(|link| children.contains(link));
    // Those of a ring have no beginning.
    for link in free.into_iter().chain(held) {
        if !search.seen[link] {
            search.begin(link);
        }
    }
    search.hangs
}

struct Search<'s, 'a, 'i> {
    joints: &'s [Joint<'a, 'i>],
    /// The joints of which each entity is the parent.
    leave: Vec<Vec<usize>>,
    seen: Vec<bool>,
    hangs: Vec<Option<Hangs>>,
}

impl Search<'_, '_, '_> {
    /// Follows all joints from a link, or from the world.
    fn begin(&mut self, start: usize) {
        self.spread(start);
        let mut goes_on = true;
        while goes_on {
            goes_on = false;
            for (joint, own) in self.joints.iter().enumerate() {
                let [Some(parent), Some(child)] = own.ends else {
                    continue;
                };
                if self.seen[child] && !self.seen[parent] {
                    self.hangs[parent] = Some(Hangs {
                        joint,
                        reversed: true,
                    });
                    self.spread(parent);
                    goes_on = true;
                }
            }
        }
    }

    /// Follows joints from parents to children.
    fn spread(&mut self, start: usize) {
        self.seen[start] = true;
        let mut way = vec![(start, 0)];
        while let Some((at, next)) = way.last_mut() {
            let Some(&joint) = self.leave[*at].get(*next) else {
                way.pop();
                continue;
            };
            *next += 1;
            let child = self.joints[joint].ends[1].filter(|child| !self.seen[*child]);
            if let Some(child) = child {
                self.seen[child] = true;
                self.hangs[child] = Some(Hangs {
                    joint,
                    reversed: false,
                });
                way.push((child, 0));
            }
        }
    }
}
