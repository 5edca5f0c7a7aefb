//! Who follows whom, and what moves between: the groups of bodies that move as one joint.

use crate::description::MimicDescription;
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::source::Located;
use crate::suggest::all_of;
use hamel_runtime::joint::{MOST_COORDINATES, MOST_LINKS};
use hamel_runtime::shown::Number;
use std::collections::{HashMap, HashSet};

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
    fn other(self) -> Option<&'a str> {
        match self {
            Self::Fixed => Some("fixed"),
            Self::Other(kind) => Some(kind),
            _ => None,
        }
    }
}

/// A body, or a link of a robot, as far as couplings look at it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<'a> {
    /// The name of its joint; `None` of what stands for no joint.
    pub(crate) joint: Option<&'a Located<String>>,
    /// What it hangs on.
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
    /// The nodes, each after what it hangs on, with the laws of those that move.
    pub(crate) members: Vec<(usize, Option<Law>)>,
}

impl Group {
    /// The nodes that follow none, in their order: one a coordinate.
    pub(crate) fn leaders(&self) -> Vec<usize> {
        let own = self.members.iter();
        let own = own.filter(|(node, law)| law.is_some_and(|law| law.leader == *node));
        own.map(|(node, _)| *node).collect()
    }

    /// The name of its joint: that of its leader, or those of all, with a plus between.
    pub(crate) fn name(&self, joint: impl Fn(usize) -> String) -> String {
        let names: Vec<String> = self.leaders().into_iter().map(joint).collect();
        names.join("+")
    }
}

/// The groups that followers make with what they follow; none without followers. `None` where there is an error, which is noted.
pub(crate) fn groups(nodes: &[Node<'_>], elements: &str, sink: &mut Sink) -> Option<Vec<Group>> {
    if nodes.iter().all(|node| node.mimic.is_none()) {
        return Some(Vec::new());
    }
    let errors_before = sink.len();
    let direct = direct(nodes, elements, sink);
    let laws = composed(nodes, &direct, sink);
    if sink.len() > errors_before {
        return None;
    }
    let tree = Forest::new(nodes);
    let found = tree.gathered(&laws, sink)?;
    let groups = found.into_iter().map(|members| tree.group(&members, &laws));
    let groups: Vec<Group> = groups.collect();
    for group in &groups {
        tree.check(group, sink);
    }
    (sink.len() == errors_before).then_some(groups)
}

fn name<'a>(nodes: &[Node<'a>], node: usize) -> &'a str {
    let named = nodes.get(node).and_then(|own| own.joint);
    named.map_or("", |name| &name.value)
}

/// What each node follows itself.
fn direct(nodes: &[Node<'_>], elements: &str, sink: &mut Sink) -> Vec<Option<Law>> {
    let named = nodes.iter().enumerate();
    let named = named.filter_map(|(index, node)| Some((node.joint?.value.as_str(), index)));
    let places: HashMap<&str, usize> = named.collect();
    let known: Vec<&str> = nodes
        .iter()
        .filter_map(|node| Some(&*node.joint?.value))
        .collect();
    let all = nodes.iter().enumerate().map(|(index, node)| {
        let mimic = node.mimic?;
        let (own, followed) = (name(nodes, index), &mimic.value.joint);
        let refuse = |message: String| Diagnostic::new(followed.span.clone(), message);
        let Some(&leader) = places.get(followed.value.as_str()) else {
            let message = format!("joint `{own}`: it mimics `{}`, which is no joint of the {elements}", followed.value);
            sink.unknown(refuse(message), &followed.value, &known, "a joint is");
            return None;
        };
        let (kind, others) = (node.movement.other(), nodes[leader].movement.other());
        let wrong = if leader == index {
            Some(format!("joint `{own}`: it mimics itself"))
        } else if let Some(kind) = kind {
            Some(format!("joint `{own}`: it mimics `{}`, and is of type `{kind}`", followed.value))
        } else if let Some(kind) = others {
            Some(format!("joint `{own}`: it mimics `{}`, which is of type `{kind}`", followed.value))
        } else if let Some(motor) = nodes[leader].motor {
            Some(format!(
                "joint `{own}`: it mimics `{}`, which is elastic: its coordinate is the deflection of the spring behind `{motor}`",
                followed.value
            ))
        } else {
            None
        };
        if let Some(message) = wrong {
            sink.push(refuse(message).help(
                "what mimics, and what is mimicked, is another joint of type `revolute`, `revolute_circle` or `prismatic`",
            ));
            return None;
        }
        let law = Law {
            leader,
            ratio: mimic.value.multiplier,
            offset: mimic.value.offset,
        };
        if law.ratio == 0.0 {
            let message = format!("joint `{own}`: the `multiplier` of its mimic is 0: it would stand still");
            sink.push(Diagnostic::new(mimic.span.clone(), message).help("leave the joint out, and fix the body to its parent"));
            return None;
        }
        Some(law)
    });
    all.collect()
}

/// What each node follows in the end: of what follows none itself. Circles are errors.
fn composed(nodes: &[Node<'_>], direct: &[Option<Law>], sink: &mut Sink) -> Vec<Law> {
    let own = |leader: usize| Law {
        leader,
        ratio: 1.0,
        offset: 0.0,
    };
    let mut laws: Vec<Option<Law>> = vec![None; direct.len()];
    for start in 0..direct.len() {
        let (mut path, mut at) = (Vec::new(), start);
        let mut on_path = HashMap::new();
        while let (None, Some(law)) = (laws[at], direct[at]) {
            if let Some(&entry) = on_path.get(&at) {
                sink.push(circle(nodes, &path[entry..]));
                break;
            }
            on_path.insert(at, path.len());
            path.push(at);
            at = law.leader;
        }
        let mut last = *laws[at].get_or_insert(own(at));
        for &node in path.iter().rev() {
            let Some(law) = direct[node] else { continue };
            last = Law {
                leader: last.leader,
                ratio: law.ratio * last.ratio,
                offset: law.ratio * last.offset + law.offset,
            };
            if !(last.ratio.is_finite() && last.offset.is_finite() && last.ratio != 0.0) {
                sink.push(out_of_range(nodes, node, &last));
                last = own(node);
            }
            laws[node] = Some(last);
        }
    }
    let laws = laws.into_iter().enumerate();
    laws.map(|(node, law)| law.unwrap_or_else(|| own(node)))
        .collect()
}

fn circle(nodes: &[Node<'_>], path: &[usize]) -> Diagnostic {
    let names = path.iter().chain(path.first()).take(13);
    let names: Vec<String> = names
        .map(|&node| format!("`{}`", name(nodes, node)))
        .collect();
    let message = format!("joints mimic each other in a circle: {}", names.join(" → "));
    let first = path.first().and_then(|&node| nodes[node].mimic);
    let span = first.map_or(0..0, |mimic| mimic.value.joint.span.clone());
    Diagnostic::new(span, message).help("one of them must mimic none")
}

fn out_of_range(nodes: &[Node<'_>], node: usize, law: &Law) -> Diagnostic {
    let (own, leader) = (name(nodes, node), name(nodes, law.leader));
    let message = format!(
        "joint `{own}`: in the end it follows `{leader}` by the multiplier {:?} and the offset {:?}: both must be finite, and the multiplier not 0",
        Number(law.ratio),
        Number(law.offset)
    );
    let span = nodes[node].mimic.map_or(0..0, |mimic| mimic.span.clone());
    Diagnostic::new(span, message)
}

/// Nodes, each once.
#[derive(Default)]
struct Set {
    nodes: Vec<usize>,
    known: HashSet<usize>,
    /// How many of them move.
    moving: usize,
}

/// The nodes as the tree that they are.
struct Forest<'n, 'a> {
    nodes: &'n [Node<'a>],
    depths: Vec<usize>,
}

impl<'n, 'a> Forest<'n, 'a> {
    fn new(nodes: &'n [Node<'a>]) -> Self {
        let mut depths: Vec<Option<usize>> = vec![None; nodes.len()];
        for start in 0..nodes.len() {
            let (mut path, mut at) = (vec![], Some(start));
            while let Some(node) = at.filter(|&node| depths[node].is_none()) {
                path.push(node);
                at = nodes[node].parent;
            }
            let mut depth = at
                .and_then(|node| depths[node])
                .map_or(0, |depth| depth + 1);
            for &node in path.iter().rev() {
                depths[node] = Some(depth);
                depth += 1;
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
    fn gathered(&self, laws: &[Law], sink: &mut Sink) -> Option<Vec<Vec<usize>>> {
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

    fn group(&self, set: &[usize], laws: &[Law]) -> Group {
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
    fn check(&self, group: &Group, sink: &mut Sink) {
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
                sink.push(Diagnostic::new(span.clone(), message).help(
                    "what moves between must be of type `revolute`, `revolute_circle` or `prismatic`",
                ));
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
