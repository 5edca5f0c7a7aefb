//! Who follows whom, which loops are closed, and what moves between: the groups of bodies that move as one joint.

use super::follow::{composed, direct};
use super::forest::{Forest, Seed};
use super::tie::{Tie, followed};
use crate::description::MimicDescription;
use crate::read::Sink;
use crate::source::Located;

/// How a body moves on its joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Movement<'a> {
    /// Not at all.
    Fixed,
    /// About z, by an angle.
    Turn,
    /// About z, by an angle up to whole turns.
    Circle,
    /// Along z.
    Slide,
    /// By a joint of another type.
    Other(&'a str),
}

impl<'a> Movement<'a> {
    /// That of a joint type of the library.
    pub(crate) fn of(kind: &'a str) -> Self {
        match kind {
            "revolute" => Self::Turn,
            "revolute_circle" => Self::Circle,
            "prismatic" => Self::Slide,
            other => Self::Other(other),
        }
    }

    /// The type that cannot be coupled, if it is none that can.
    pub(super) fn other(self) -> Option<&'a str> {
        match self {
            Self::Fixed => Some("fixed"),
            Self::Other(kind) => Some(kind),
            _ => None,
        }
    }
}

/// A body, or the link of a robot that a joint moves, as far as couplings look at it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<'a> {
    /// The name of its joint; `None` of what stands for no joint.
    pub(crate) joint: Option<&'a Located<String>>,
    /// What it hangs on: never what is fixed to another node.
    pub(crate) parent: Option<usize>,
    /// How it moves.
    pub(crate) movement: Movement<'a>,
    /// What it follows.
    pub(crate) mimic: Option<&'a Located<MimicDescription>>,
    /// The motor behind whose spring it is: its joint is then the spring's deflection.
    pub(crate) motor: Option<&'a str>,
}

/// `y = ratio · y of the leader + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Law {
    /// The node that is followed, which follows none; itself of one that follows none.
    pub(crate) leader: usize,
    pub(crate) ratio: f64,
    pub(crate) offset: f64,
}

/// Nodes that move as one joint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// What it hangs on.
    pub(crate) base: Option<usize>,
    /// The nodes, each after what it hangs on, with their laws.
    pub(crate) members: Vec<(usize, Law)>,
    /// The ties that hold them together, except for those that laws express, by place and name.
    pub(crate) ties: Vec<(usize, String)>,
}

impl Group {
    /// The nodes that follow none, in their order: one a coordinate.
    pub(crate) fn leaders(&self) -> Vec<usize> {
        let own = self.members.iter();
        let own = own.filter(|(node, law)| law.leader == *node);
        own.map(|(node, _)| *node).collect()
    }

    /// The name of its joint: that of its leader, or those of all, with a plus between; of loops, theirs.
    pub(crate) fn name(&self, joint: impl Fn(usize) -> String) -> String {
        let names: Vec<String> = match self.ties.is_empty() {
            true => self.leaders().into_iter().map(joint).collect(),
            false => self.ties.iter().map(|(_, name)| name.clone()).collect(),
        };
        names.join("+")
    }

    /// The nodes that only move together: all that ties hold, or those that follow one.
    pub(crate) fn bound(&self) -> Vec<Vec<usize>> {
        let places = |leader: Option<usize>| {
            let own = self.members.iter();
            let own = own.filter(|(_, law)| leader.is_none_or(|leader| law.leader == leader));
            own.map(|(node, _)| *node).collect()
        };
        match self.ties.is_empty() {
            true => self
                .leaders()
                .into_iter()
                .map(|own| places(Some(own)))
                .collect(),
            false => vec![places(None)],
        }
    }

    /// Whether all of its joints follow one.
    pub(crate) fn is_of_one(&self) -> bool {
        self.ties.is_empty() && self.leaders().len() <= 1
    }
}

/// The groups that followers make with what they follow, and loops of what they close; none without both. `None` where there is an error, which is noted.
pub(crate) fn groups(
    nodes: &[Node<'_>],
    ties: &[Tie<'_>],
    elements: &str,
    sink: &mut Sink,
) -> Option<Vec<Group>> {
    if nodes.iter().all(|node| node.mimic.is_none()) && ties.is_empty() {
        return Some(Vec::new());
    }
    let errors_before = sink.len();
    let mut direct = direct(nodes, elements, sink);
    let tree = Forest::new(nodes, ties);
    let ways: Vec<_> = ties.iter().map(|tie| tree.ways(tie)).collect();
    let open = followed(nodes, ties, &ways, &mut direct, sink);
    if sink.len() > errors_before {
        return None;
    }
    let laws = composed(nodes, &direct, sink);
    if sink.len() > errors_before {
        return None;
    }
    let followers = laws.iter().enumerate();
    let followers = followers.filter(|(node, law)| law.leader != *node);
    let followers = followers.map(|(node, law)| Seed::Follower(node, law.leader));
    let closed = open.iter().map(|&tie| Seed::Tie(tie, ways[tie].concat()));
    let seeds: Vec<Seed> = followers.chain(closed).collect();
    let found = tree.gathered(&seeds, sink)?;
    let groups = found.into_iter().map(|members| {
        let mut group = tree.group(&members, &laws);
        let own = open.iter().filter(|tie| {
            let mut moved = ways[**tie].iter().flatten();
            moved.next().is_some_and(|node| members.contains(node))
        });
        group.ties = own
            .map(|&tie| (tie, ties[tie].name.value.clone()))
            .collect();
        group
    });
    let groups: Vec<Group> = groups.collect();
    for group in &groups {
        tree.check(group, sink);
    }
    (sink.len() == errors_before).then_some(groups)
}

/// The name of a node's joint.
pub(super) fn name<'a>(nodes: &[Node<'a>], node: usize) -> &'a str {
    let named = nodes.get(node).and_then(|own| own.joint);
    named.map_or("", |name| &name.value)
}
