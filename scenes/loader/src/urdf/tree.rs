//! The links as a tree: names that are unique, joints between links that exist, one root, no cycle.

use super::document::{place, tag};
use crate::diagnostics::Diagnostic;
use crate::parse::{cycles, order};
use crate::read::Sink;
use crate::suggest::{all_of, nearest};
use roxmltree::Node;
use std::collections::HashMap;
use urdf_rs::{Joint, Link, Robot};

/// A robot as its parser and its document have it: entries of one index belong together.
pub(super) struct Parsed<'a, 'i> {
    /// What the parser read.
    pub(super) robot: &'a Robot,
    /// The `<link>` elements.
    pub(super) links: Vec<Node<'a, 'i>>,
    /// The `<joint>` elements.
    pub(super) joints: Vec<Node<'a, 'i>>,
}

/// The links in order.
#[derive(Debug)]
pub(super) struct Links {
    /// Links, parents first and otherwise as in the file. The first is the root.
    pub(super) order: Vec<usize>,
    /// For each link of the file its joint and its parent link; `None` for the root.
    pub(super) parents: Vec<Option<(usize, usize)>>,
}

/// Orders the links.
pub(super) fn links(parsed: &Parsed<'_, '_>, sink: &mut Sink) -> Option<Links> {
    let errors_before = sink.len();
    let robot = parsed.robot;
    let names = unique(
        "links",
        robot.links.iter().map(|l| &l.name),
        &parsed.links,
        sink,
    );
    unique(
        "joints",
        robot.joints.iter().map(|j| &j.name),
        &parsed.joints,
        sink,
    );
    let parents = parents(parsed, &names, sink);
    if sink.len() > errors_before {
        return None;
    }
    let links: Vec<Option<usize>> = parents.iter().map(|p| Some((*p)?.1)).collect();
    let order = order(&links);
    cycles(&links, &order)
        .iter()
        .for_each(|cycle| sink.push(cycle_error(parsed, &parents, cycle)));
    roots(parsed, &links, sink);
    (sink.len() == errors_before).then_some(Links { order, parents })
}

fn unique<'r>(
    elements: &str,
    names: impl Iterator<Item = &'r String>,
    nodes: &[Node<'_, '_>],
    sink: &mut Sink,
) -> HashMap<&'r str, usize> {
    let mut places: HashMap<&str, usize> = HashMap::new();
    for (index, name) in names.enumerate() {
        let first = *places.entry(name).or_insert(index);
        if first == index {
            continue;
        }
        let span = |index: usize| match nodes[index].attribute_node("name") {
            Some(name) => name.range_value(),
            None => tag(nodes[index]),
        };
        let message = format!("two {elements} are called `{name}`");
        let error = Diagnostic::new(span(index), message).label("the second one");
        sink.push(error.context(span(first), "the first one"));
    }
    places
}

/// Joint and parent of each link.
fn parents(
    parsed: &Parsed<'_, '_>,
    names: &HashMap<&str, usize>,
    sink: &mut Sink,
) -> Vec<Option<(usize, usize)>> {
    let mut parents: Vec<Option<(usize, usize)>> = vec![None; parsed.links.len()];
    for (index, joint) in parsed.robot.joints.iter().enumerate() {
        let node = parsed.joints[index];
        let ends = [("parent", &joint.parent.link), ("child", &joint.child.link)];
        let ends = ends.map(|(end, link)| match names.get(link.as_str()) {
            Some(&link) => Some(link),
            None => {
                sink.push(unknown_link(joint, node, end, link, &parsed.robot.links));
                None
            }
        });
        let [Some(parent), Some(child)] = ends else {
            continue;
        };
        match parents[child] {
            Some((other, _)) => sink.push(second_parent(parsed, child, index, other)),
            None => parents[child] = Some((index, parent)),
        }
    }
    parents
}

fn unknown_link(
    joint: &Joint,
    node: Node<'_, '_>,
    end: &str,
    link: &str,
    links: &[Link],
) -> Diagnostic {
    let message = format!(
        "joint `{}`: its {end} `{link}` is not a link of the robot",
        joint.name
    );
    let error = Diagnostic::new(place(node, end, "link"), message);
    let names = links.iter().map(|link| link.name.as_str());
    match nearest(link, names.clone()) {
        Some(near) => error.label(format!("did you mean `{near}`?")),
        None => error.help(format!("its links are {}", all_of(names))),
    }
}

fn second_parent(parsed: &Parsed<'_, '_>, link: usize, joint: usize, other: usize) -> Diagnostic {
    let (link, joints) = (&parsed.robot.links[link].name, &parsed.robot.joints);
    let message = format!(
        "link `{link}` hangs on two joints, `{}` and `{}`",
        joints[other].name, joints[joint].name
    );
    let span = |joint: usize| place(parsed.joints[joint], "child", "link");
    Diagnostic::new(span(joint), message)
        .label("the second one")
        .context(span(other), "the first one")
        .help("the links of a URDF are a tree: it cannot say that a loop is closed")
}

fn cycle_error(
    parsed: &Parsed<'_, '_>,
    parents: &[Option<(usize, usize)>],
    cycle: &[usize],
) -> Diagnostic {
    const MOST_SHOWN: usize = 12;
    let name = |&link: &usize| format!("`{}`", parsed.robot.links[link].name);
    let mut chain: Vec<String> = cycle.iter().take(MOST_SHOWN).map(name).collect();
    if cycle.len() > MOST_SHOWN {
        chain.push(format!("({} more)", cycle.len() - MOST_SHOWN));
    }
    chain.extend(cycle.first().map(name));
    let message = format!("the links' parents form a cycle: {}", chain.join(" → "));
    let joint = cycle.first().and_then(|&link| parents[link]);
    let span = joint.map_or(0..0, |(joint, _)| {
        place(parsed.joints[joint], "parent", "link")
    });
    Diagnostic::new(span, message)
}

fn roots(parsed: &Parsed<'_, '_>, parents: &[Option<usize>], sink: &mut Sink) {
    let is_root = |link: &usize| parents[*link].is_none();
    let roots: Vec<usize> = (0..parents.len()).filter(is_root).collect();
    if let [first, second, ..] = roots.as_slice() {
        let names = roots
            .iter()
            .map(|&root| parsed.robot.links[root].name.as_str());
        let message = format!(
            "the robot has {} root links: {}",
            roots.len(),
            all_of(names)
        );
        sink.push(
            Diagnostic::new(tag(parsed.links[*second]), message)
                .label("no joint has this link as its child")
                .context(tag(parsed.links[*first]), "nor this one")
                .help("a URDF is one tree: every link but one is the child of a joint"),
        );
    }
}
