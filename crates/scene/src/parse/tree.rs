//! The bodies as a tree: names that are unique, parents that exist, no cycle; bodies stand in the file in any order.

use super::body::WORLD;
use super::ties::TieDrafts;
use super::{BodyDraft, Tree};
use crate::coupling::{self, Group, Node, groups};
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::source::Located;
use std::cmp::Reverse;
use std::collections::hash_map::Entry;
use std::collections::{BinaryHeap, HashMap};

/// Bodies of a cycle that its message names.
const MOST_SHOWN: usize = 12;

/// Orders the bodies, parents first and otherwise as the file has them.
pub(super) fn tree(bodies: &[BodyDraft], ties: &mut TieDrafts, sink: &mut Sink) -> Option<Tree> {
    let errors_before = sink.len();
    let places = unique(bodies.iter().map(|body| body.name.as_ref()), "bodies", sink);
    let joints = bodies.iter().enumerate().map(|(place, body)| {
        let name = &body.joint.as_ref().filter(|_| body.leads())?.name;
        // A joint that took its name from its body shares the body's error.
        let inherited = body.name.as_ref() == Some(name);
        let told = inherited && places.get(name.value.as_str()) != Some(&place);
        (!told).then_some(name)
    });
    unique(joints, "joints", sink);
    let parents = parents(bodies, &places, sink)?;
    let last = last_parents(bodies, &parents);
    let mut order = order(&last);
    for cycle in cycles(&parents, &order) {
        sink.push(cycle_error(bodies, &cycle));
    }
    if sink.len() > errors_before {
        return None;
    }
    let names = bodies
        .iter()
        .filter_map(|body| Some(&*body.name.as_ref()?.value));
    let known: Vec<&str> = names.chain([WORLD]).collect();
    ties.found(|name| places.get(name).copied(), &known, sink)?;
    let groups = coupled(bodies, &parents, ties, sink)?;
    if !groups.is_empty() {
        order = coupling::order(&last, &groups);
    }
    let mut rank = vec![0; order.len()];
    for (position, &place) in order.iter().enumerate() {
        rank[place] = position;
    }
    let parent_of = |place: usize| parents[place].map(|parent| rank[parent]);
    Some(Tree {
        parents: order.iter().map(|&place| parent_of(place)).collect(),
        order,
        groups,
    })
}

/// What mimic joints, loops and couplings make one; nothing where a joint could not be read.
fn coupled(
    bodies: &[BodyDraft],
    parents: &[Option<usize>],
    ties: &TieDrafts,
    sink: &mut Sink,
) -> Option<Vec<Group>> {
    if bodies.iter().any(|body| body.joint.is_none()) {
        return Some(Vec::new());
    }
    let nodes = bodies.iter().zip(parents);
    let nodes: Vec<Node<'_>> = nodes.map(|(body, parent)| body.node(*parent)).collect();
    groups(&nodes, &ties.ties(), "scene", sink)
}

/// Where each name stands first; every repetition is an error.
fn unique<'a>(
    names: impl Iterator<Item = Option<&'a Located<String>>>,
    elements: &str,
    sink: &mut Sink,
) -> HashMap<&'a str, usize> {
    let mut first: HashMap<&str, (usize, &Located<String>)> = HashMap::new();
    for (place, name) in names.enumerate() {
        let Some(name) = name else { continue };
        match first.entry(name.value.as_str()) {
            Entry::Vacant(entry) => _ = entry.insert((place, name)),
            Entry::Occupied(entry) => {
                let message = format!("two {elements} are called `{}`", name.value);
                let error = Diagnostic::new(name.span.clone(), message).label("the second one");
                sink.push(error.context(entry.get().1.span.clone(), "the first one"));
            }
        }
    }
    let places = first.into_iter().map(|(name, (place, _))| (name, place));
    places.collect()
}

/// Parent of each body, as a place in the file. `None` overall if one is unknown, so that a cycle cannot be judged.
fn parents(
    bodies: &[BodyDraft],
    places: &HashMap<&str, usize>,
    sink: &mut Sink,
) -> Option<Vec<Option<usize>>> {
    let names = bodies
        .iter()
        .filter_map(|body| Some(body.name.as_ref()?.value.as_str()));
    let names: Vec<&str> = names.chain([WORLD]).collect();
    let parents: Vec<_> = bodies
        .iter()
        .map(|body| parent(body, &names, places, sink))
        .collect();
    parents.into_iter().collect()
}

/// The outer `None` is an error, the inner one the world.
fn parent(
    body: &BodyDraft,
    names: &[&str],
    places: &HashMap<&str, usize>,
    sink: &mut Sink,
) -> Option<Option<usize>> {
    let parent = body.parent.as_ref()?;
    if parent.value == WORLD {
        return Some(None);
    }
    if let Some(&place) = places.get(parent.value.as_str()) {
        return Some(Some(place));
    }
    let owner = body.name.as_ref().map_or("", |name| name.value.as_str());
    let message = format!(
        "body `{owner}`: parent {:?} is not a body of the scene",
        parent.value
    );
    let error = Diagnostic::new(parent.span.clone(), message);
    sink.unknown(error, &parent.value, names, "a parent is");
    None
}

/// The parents, but the last body of its joint in place of each: what hangs on any of them comes after all of them.
fn last_parents(bodies: &[BodyDraft], parents: &[Option<usize>]) -> Vec<Option<usize>> {
    let number = |place: usize| bodies.get(place)?.part.as_ref().map(|part| part.number);
    let last = |place: usize| {
        let own = number(place)?;
        let follow = (place + 1..).take_while(|&next| number(next).is_some_and(|next| next > own));
        Some(place + follow.count())
    };
    let parents = parents.iter();
    parents
        .map(|parent| parent.map(|place| last(place).unwrap_or(place)))
        .collect()
}

/// Every body whose ancestors lead to the world, parents first; among those that could come next, the first in the file.
pub(crate) fn order(parents: &[Option<usize>]) -> Vec<usize> {
    let mut children = vec![Vec::new(); parents.len()];
    let mut ready = BinaryHeap::new();
    for (place, parent) in parents.iter().enumerate() {
        match parent {
            Some(parent) => children[*parent].push(place),
            None => ready.push(Reverse(place)),
        }
    }
    let mut order = Vec::with_capacity(parents.len());
    while let Some(Reverse(place)) = ready.pop() {
        order.push(place);
        ready.extend(children[place].iter().map(|&child| Reverse(child)));
    }
    order
}

/// The cycles among the bodies that `order` could not reach, each once, from its first body in the file.
pub(crate) fn cycles(parents: &[Option<usize>], order: &[usize]) -> Vec<Vec<usize>> {
    let mut seen = vec![false; parents.len()];
    for &place in order {
        seen[place] = true;
    }
    let mut cycles = Vec::new();
    for start in 0..parents.len() {
        let mut path = Vec::new();
        let mut at = start;
        while !seen[at] {
            seen[at] = true;
            path.push(at);
            at = parents[at].unwrap_or(at);
        }
        if let Some(entry) = path.iter().position(|&place| place == at) {
            let mut cycle = path.split_off(entry);
            let first = (0..cycle.len()).min_by_key(|&i| cycle[i]).unwrap_or(0);
            cycle.rotate_left(first);
            cycles.push(cycle);
        }
    }
    cycles
}

fn cycle_error(bodies: &[BodyDraft], cycle: &[usize]) -> Diagnostic {
    let name = |place: usize| bodies[place].name.as_ref().map_or("", |name| &name.value);
    let chain = cycle.iter().chain(cycle.first());
    let mut chain: Vec<String> = chain.map(|&place| format!("`{}`", name(place))).collect();
    if chain.len() > MOST_SHOWN {
        let left_out = chain.len() - MOST_SHOWN;
        let middle = MOST_SHOWN / 2..MOST_SHOWN / 2 + left_out;
        chain.splice(middle, [format!("({left_out} more)")]);
    }
    let message = format!("the bodies' parents form a cycle: {}", chain.join(" → "));
    let span = cycle
        .first()
        .and_then(|&place| bodies[place].parent.as_ref())
        .map_or(0..0, |parent| parent.span.clone());
    Diagnostic::new(span, message)
        .help("one body of a cycle must have the world, or a body outside, as its parent")
}

#[cfg(test)]
mod tests {
    use super::{cycles, order};

    #[test]
    fn parents_come_first_and_the_file_decides_the_rest() {
        let parents = [Some(2), None, Some(1), Some(1)];
        assert_eq!(order(&parents), [1, 2, 0, 3]);
        assert!(cycles(&parents, &order(&parents)).is_empty());
    }

    #[test]
    fn each_cycle_is_found_once_and_its_tail_is_not_part_of_it() {
        let parents = [Some(1), Some(2), Some(1), None, Some(4), Some(0)];
        assert_eq!(order(&parents), [3]);
        assert_eq!(cycles(&parents, &[3]), [vec![1, 2], vec![4]]);
    }
}
