//! The bodies as the tree that they are: what moves between joints that follow each other.

use super::graph::{Group, Law, Movement, Node, name};
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::suggest::all_of;
use hamel_runtime::joint::{MOST_COORDINATES, MOST_LINKS};
use std::collections::{HashMap, HashSet};

/// Nodes, each once.
#[derive(Default)]
struct Set {
    nodes: Vec<usize>,
    known: HashSet<usize>,
    /// How many of them move.
    moving: usize,
}

/// The nodes as the tree that they are.
pub(super) struct Forest<'n, 'a> {
    nodes: &'n [Node<'a>],
    depths: Vec<usize>,
}

impl<'n, 'a> Forest<'n, 'a> {
    /// The nodes with their depths.
    pub(super) fn new(nodes: &'n [Node<'a>]) -> Self {
        let mut depths: Vec<Option<usize>> = vec![None; nodes.len()];
        for start in 0..nodes.len() {
            let (mut path, mut at) = (vec![], Some(start));
            while let Some(node) = at.filter(|&node| depths[node].is_none()) {
                path.push(node);
                at = nodes[node].parent;
            }
            let first = at
                .and_then(|node| depths[node])
                .map_or(0, |depth| depth + 1);
            for (depth, &node) in (first..).zip(path.iter().rev()) {
                depths[node] = Some(depth);
            }
        }
        let depths = depths.into_iter().map(|depth| depth.unwrap_or(0));
        Self {
            nodes,
            depths: depths.collect(),
        }
    }

    fn moves(&self, node: usize) -> bool {
        self.nodes[node].movement != Movement::Fixed
    }

    /// Sets of nodes that move together. Of one that is too large the first nodes are named, and nothing else is looked at.
    pub(super) fn gathered(&self, laws: &[Law], sink: &mut Sink) -> Option<Vec<Vec<usize>>> {
        let followers = laws.iter().enumerate();
        let followers = followers.filter(|(node, law)| law.leader != *node);
        let mut sets: Vec<Set> = Vec::new();
        let mut of: HashMap<usize, usize> = HashMap::new();
        for (node, law) in followers {
            let mut waiting = vec![node, law.leader];
            let mut set = Set::default();
            // What is met of other sets becomes part of this one, and what stands between comes in.
            while let Some(next) = waiting.pop() {
                if let Some(other) = of.get(&next).and_then(|&other| sets.get_mut(other)) {
                    let other = std::mem::take(other);
                    other.nodes.iter().for_each(|node| _ = of.remove(node));
                    waiting.extend(other.nodes);
                }
                if !self.take(&mut set, next) {
                    sink.push(self.too_many(node, law));
                    return None;
                }
                if waiting.is_empty() {
                    let Some(between) = self.between(&set) else {
                        sink.push(self.too_many(node, law));
                        return None;
                    };
                    waiting = between.nodes;
                }
            }
            of.extend(set.nodes.iter().map(|&own| (own, sets.len())));
            sets.push(set);
        }
        let sets = sets.into_iter().map(|set| set.nodes);
        Some(sets.filter(|nodes| !nodes.is_empty()).collect())
    }

    /// Adds a node to a set; whether it is not too large then.
    fn take(&self, set: &mut Set, node: usize) -> bool {
        if set.known.insert(node) {
            set.nodes.push(node);
            set.moving += usize::from(self.moves(node));
        }
        set.moving <= MOST_LINKS
    }

    /// The nodes on the way from a set to what all of it hangs on that are not in it; `None` where they are too many.
    fn between(&self, set: &Set) -> Option<Set> {
        let mut more = Set::default();
        let mut base = self.nodes[*set.nodes.first()?].parent;
        for &own in &set.nodes {
            let mut at = self.nodes[own].parent;
            while at != base {
                let depth = |node: Option<usize>| node.map_or(0, |node| self.depths[node] + 1);
                let deeper = match depth(at) >= depth(base) {
                    true => &mut at,
                    false => &mut base,
                };
                let Some(passed) = *deeper else { break };
                *deeper = self.nodes[passed].parent;
                if !set.known.contains(&passed) && !self.take(&mut more, passed) {
                    return None;
                }
            }
        }
        Some(more)
    }

    fn too_many(&self, node: usize, law: &Law) -> Diagnostic {
        let (own, leader) = (name(self.nodes, node), name(self.nodes, law.leader));
        let message = format!(
            "joint `{own}`: more than {MOST_LINKS} joints are coupled with it, which follows `{leader}`, and move between them"
        );
        let span = self.nodes[node]
            .mimic
            .map_or(0..0, |mimic| mimic.span.clone());
        Diagnostic::new(span, message).help(format!("a coupling is of at most {MOST_LINKS} joints"))
    }

    /// A set in order, with the laws of what moves.
    pub(super) fn group(&self, set: &[usize], laws: &[Law]) -> Group {
        let mut members = set.to_vec();
        members.sort_by_key(|&node| (self.depths[node], node));
        let base = members.first().and_then(|&first| self.nodes[first].parent);
        let law = |node: usize| self.moves(node).then_some(laws[node]);
        Group {
            base,
            members: members.into_iter().map(|node| (node, law(node))).collect(),
        }
    }

    /// Whether one joint can be all of them.
    pub(super) fn check(&self, group: &Group, sink: &mut Sink) {
        let mut followers = group.members.iter();
        let follower = followers
            .find_map(|&(node, law)| Some((node, law?)).filter(|(node, law)| law.leader != *node));
        let Some((follower, law)) = follower else {
            return;
        };
        let (own, leader) = (name(self.nodes, follower), name(self.nodes, law.leader));
        let span = self.nodes[follower]
            .mimic
            .map_or(0..0, |mimic| mimic.span.clone());
        for &(node, _) in &group.members {
            if let Movement::Other(kind) = self.nodes[node].movement {
                let between = name(self.nodes, node);
                let message = format!(
                    "joint `{own}`: between it and `{leader}`, which it follows, moves joint `{between}` of type `{kind}`"
                );
                sink.push(
                    Diagnostic::new(span.clone(), message)
                        .help("what moves between must turn about an axis or slide along one"),
                );
            }
        }
        let leaders = group.leaders();
        if leaders.len() > MOST_COORDINATES {
            let names = leaders.iter().map(|&node| name(self.nodes, node));
            let message = format!(
                "joint `{own}`: with `{leader}`, which it follows, and what moves between, {} joints move independently: {}",
                leaders.len(),
                all_of(names)
            );
            sink.push(
                Diagnostic::new(span, message)
                    .help(format!("a coupling has at most {MOST_COORDINATES} of them")),
            );
        }
    }
}
