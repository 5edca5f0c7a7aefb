//! The bodies as the tree that they are: what moves between joints that follow each other.

use super::graph::{Group, Law, Movement, Node, name};
use super::tie::Tie;
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::source::Span;
use crate::suggest::all_of;
use hamel_runtime::joint::{MOST_COORDINATES, MOST_LINKS};
use std::collections::{HashMap, HashSet};

/// Nodes, each once.
#[derive(Default)]
struct Set {
    nodes: Vec<usize>,
    known: HashSet<usize>,
}

impl Set {
    /// Adds a node; whether the set is not too large then.
    fn take(&mut self, node: usize) -> bool {
        if self.known.insert(node) {
            self.nodes.push(node);
        }
        self.nodes.len() <= MOST_LINKS
    }
}

/// What begins a set of nodes that move together.
#[derive(Clone, Debug)]
pub(super) enum Seed {
    /// A node and what it follows.
    Follower(usize, usize),
    /// A tie, by its place, and the nodes on the ways to its ends.
    Tie(usize, Vec<usize>),
}

/// The nodes on the ways from the last node that carries both ends of a tie to these, that one not among them.
pub(super) type Ways = [Vec<usize>; 2];

/// The nodes as the tree that they are.
pub(super) struct Forest<'n, 'a> {
    nodes: &'n [Node<'a>],
    ties: &'n [Tie<'a>],
    depths: Vec<usize>,
}

impl<'n, 'a> Forest<'n, 'a> {
    /// The nodes with their depths.
    pub(super) fn new(nodes: &'n [Node<'a>], ties: &'n [Tie<'a>]) -> Self {
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
            ties,
            depths: depths.collect(),
        }
    }

    /// The ways to the ends of a tie.
    pub(super) fn ways(&self, tie: &Tie<'_>) -> Ways {
        let (mut ends, mut ways) = (tie.ends, Ways::default());
        let depth = |node: Option<usize>| node.map_or(0, |node| self.depths[node] + 1);
        while ends[0] != ends[1] {
            let deeper = usize::from(depth(ends[0]) < depth(ends[1]));
            let Some(passed) = ends[deeper] else { break };
            ways[deeper].push(passed);
            ends[deeper] = self.nodes[passed].parent;
        }
        ways
    }

    /// Sets of nodes that move together. Of one that is too large the first nodes are named, and nothing else is looked at.
    pub(super) fn gathered(&self, seeds: &[Seed], sink: &mut Sink) -> Option<Vec<Vec<usize>>> {
        let mut sets: Vec<Set> = Vec::new();
        let mut of: HashMap<usize, usize> = HashMap::new();
        for seed in seeds {
            let mut waiting = match seed {
                Seed::Follower(node, leader) => vec![*node, *leader],
                Seed::Tie(_, nodes) => nodes.clone(),
            };
            let mut set = Set::default();
            // What is met of other sets becomes part of this one, and what stands between comes in.
            while let Some(next) = waiting.pop() {
                if let Some(other) = of.get(&next).and_then(|&other| sets.get_mut(other)) {
                    let other = std::mem::take(other);
                    other.nodes.iter().for_each(|node| _ = of.remove(node));
                    waiting.extend(other.nodes);
                }
                if !set.take(next) {
                    sink.push(self.too_many(seed));
                    return None;
                }
                if waiting.is_empty() {
                    let Some(between) = self.between(&set) else {
                        sink.push(self.too_many(seed));
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
                if !set.known.contains(&passed) && !more.take(passed) {
                    return None;
                }
            }
        }
        Some(more)
    }

    fn too_many(&self, seed: &Seed) -> Diagnostic {
        let (span, message) = match seed {
            Seed::Follower(node, leader) => {
                let (own, leader) = (name(self.nodes, *node), name(self.nodes, *leader));
                let message = format!(
                    "joint `{own}`: more than {MOST_LINKS} joints are coupled with it, which follows `{leader}`, and move between them"
                );
                (self.cause(*node), message)
            }
            Seed::Tie(tie, _) => {
                let tie = &self.ties[*tie];
                let message = format!(
                    "{}: more than {MOST_LINKS} joints move in it and in what shares joints with it",
                    tie.called()
                );
                (tie.name.span.clone(), message)
            }
        };
        Diagnostic::new(span, message).help(format!("a coupling is of at most {MOST_LINKS} joints"))
    }

    /// Where the file says that a node follows another.
    fn cause(&self, node: usize) -> Span {
        let mimic = self.nodes[node].mimic.map(|mimic| mimic.span.clone());
        let of_node = |tie: &&Tie<'_>| tie.law.is_some() && tie.ends.contains(&Some(node));
        let tie = || self.ties.iter().find(of_node);
        mimic
            .or_else(|| Some(tie()?.name.span.clone()))
            .unwrap_or(0..0)
    }

    /// A set in order, with its laws.
    pub(super) fn group(&self, set: &[usize], laws: &[Law]) -> Group {
        let mut members = set.to_vec();
        members.sort_by_key(|&node| (self.depths[node], node));
        let base = members.first().and_then(|&first| self.nodes[first].parent);
        Group {
            base,
            members: members.into_iter().map(|node| (node, laws[node])).collect(),
            ties: Vec::new(),
        }
    }

    /// Whether one joint can be all of them.
    pub(super) fn check(&self, group: &Group, sink: &mut Sink) {
        let Some((span, owner)) = self.owner(group) else {
            return;
        };
        for &(node, _) in &group.members {
            if let Movement::Other(kind) = self.nodes[node].movement {
                let between = name(self.nodes, node);
                let message = format!("{owner}, moves joint `{between}` of type `{kind}`");
                sink.push(
                    Diagnostic::new(span.clone(), message)
                        .help("what moves between must turn about an axis or slide along one"),
                );
            }
        }
        let leaders = group.leaders();
        if group.ties.is_empty() && leaders.len() > MOST_COORDINATES {
            let names = leaders.iter().map(|&node| name(self.nodes, node));
            let between = owner.replacen("between it and", "with", 1);
            let message = format!(
                "{between}, and what moves between, {} joints move independently: {}",
                leaders.len(),
                all_of(names)
            );
            sink.push(
                Diagnostic::new(span, message)
                    .help(format!("a coupling has at most {MOST_COORDINATES} of them")),
            );
        }
    }

    /// Where a group begins in the file, and what messages about what moves in it begin with.
    fn owner(&self, group: &Group) -> Option<(Span, String)> {
        let mut members = group.members.iter().copied();
        let follower = members.find(|(node, law)| law.leader != *node);
        if let Some((follower, law)) = follower {
            let (own, leader) = (name(self.nodes, follower), name(self.nodes, law.leader));
            let owner = format!("joint `{own}`: between it and `{leader}`, which it follows");
            return Some((self.cause(follower), owner));
        }
        let (tie, _) = group.ties.first()?;
        let tie = &self.ties[*tie];
        let owner = format!(
            "{}: between its joints and those that share some with it",
            tie.called()
        );
        Some((tie.name.span.clone(), owner))
    }
}
