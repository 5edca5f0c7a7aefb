//! The links as a tree: names that are unique, joints between links that exist, one root, no cycle.

use super::document::{place, tag};
use super::robot::{Joint, JointType, Robot};
use super::ties::{Ties, ties};
use crate::coupling::{self, Group, Movement, Node as Member, groups};
use crate::description::MimicDescription;
use crate::diagnostics::Diagnostic;
use crate::parse::{cycles, order};
use crate::read::Sink;
use crate::source::{Located, Span};
use crate::suggest::{Suggestions, all_of};
use roxmltree::Node;
use std::collections::HashMap;

/// The links in order.
pub(super) struct Links<'a, 'i> {
    /// Links, parents first and otherwise as in the file. The first is the root.
    pub(super) order: Vec<usize>,
    /// For each link of the file its joint and its parent link; `None` for the root.
    pub(super) parents: Vec<Option<(usize, usize)>>,
    /// What closes loops and couples joints.
    pub(super) ties: Ties<'a, 'i>,
    /// The links that mimic joints couple, and that loops close.
    groups: Vec<Group>,
    /// For each link of the file the group that it is in.
    places: Vec<Option<usize>>,
}

impl Links<'_, '_> {
    /// What couples a link with others, if something does.
    pub(super) fn group(&self, link: usize) -> Option<&Group> {
        self.groups.get((*self.places.get(link)?)?)
    }
}

/// Orders the links; `mimics` are those of the joints.
pub(super) fn links<'a, 'i>(
    robot: &Robot<'a, 'i>,
    mimics: &[Option<Located<MimicDescription>>],
    sink: &mut Sink,
) -> Option<Links<'a, 'i>> {
    let errors_before = sink.len();
    let named = robot.links.iter().map(|link| (link.name, link.node));
    let names = unique("links", named, sink);
    let named = robot.joints.iter().map(|joint| (joint.name, joint.node));
    unique("joints", named, sink);
    let parents = parents(robot, &names, sink);
    if sink.len() > errors_before {
        return None;
    }
    let links: Vec<Option<usize>> = parents.iter().map(|p| Some((*p)?.1)).collect();
    let mut order = order(&links);
    cycles(&links, &order)
        .iter()
        .for_each(|cycle| sink.push(cycle_error(robot, &parents, cycle)));
    roots(robot, &links, sink);
    if sink.len() > errors_before {
        return None;
    }
    let rigid = Rigid::new(robot, &parents, &order);
    let ties = ties(robot, &names, &parents, sink)?;
    let elements = ties
        .nodes()
        .map(|node| (node.attribute("name").unwrap_or(""), node));
    unique("loops or couplings", elements, sink);
    let names: Vec<Option<Located<String>>> = names_of_joints(robot, &parents);
    let members = parents.iter().zip(&names).map(|(hangs_on, name)| Member {
        joint: name.as_ref(),
        parent: hangs_on.map(|(_, parent)| rigid.of[parent]),
        movement: hangs_on.map_or(Movement::Fixed, |(joint, _)| movement(&robot.joints[joint])),
        mimic: hangs_on.and_then(|(joint, _)| mimics.get(joint)?.as_ref()),
        motor: None,
    });
    let members: Vec<Member<'_>> = members.collect();
    let held = ties.of_links(|link| rigid.of[link]);
    let groups = groups(&members, &held, "robot", sink)?;
    if !groups.is_empty() {
        order = rigid.order(&parents, &groups);
    }
    let mut places = vec![None; parents.len()];
    for (place, group) in groups.iter().enumerate() {
        group
            .members
            .iter()
            .for_each(|(link, _)| places[*link] = Some(place));
    }
    Some(Links {
        order,
        parents,
        ties,
        groups,
        places,
    })
}

/// Links that fixed joints join to one body, which couplings look at as one.
struct Rigid {
    /// For each link the one that moves its body: itself, or the next above that no fixed joint carries.
    of: Vec<usize>,
    /// For each of these the links of its body, parents first.
    links: Vec<Vec<usize>>,
}

impl Rigid {
    /// `order` has all links, parents first.
    fn new(robot: &Robot<'_, '_>, parents: &[Option<(usize, usize)>], order: &[usize]) -> Self {
        let mut of: Vec<usize> = (0..parents.len()).collect();
        let mut links = vec![Vec::new(); parents.len()];
        for &link in order {
            if let Some((joint, parent)) = parents[link]
                && robot.joints[joint].kind == JointType::Fixed
            {
                of[link] = of[parent];
            }
            links[of[link]].push(link);
        }
        Self { of, links }
    }

    /// All links, parents first: the bodies of a group follow each other, and the links of each body.
    fn order(&self, parents: &[Option<(usize, usize)>], groups: &[Group]) -> Vec<usize> {
        let carried = |link: &Option<(usize, usize)>| link.map(|(_, parent)| self.of[parent]);
        let parents: Vec<Option<usize>> = parents.iter().map(carried).collect();
        let bodies = coupling::order(&parents, groups);
        let links = bodies.into_iter().flat_map(|link| &self.links[link]);
        links.copied().collect()
    }
}

/// The name of the joint of each link, where it stands.
fn names_of_joints(
    robot: &Robot<'_, '_>,
    parents: &[Option<(usize, usize)>],
) -> Vec<Option<Located<String>>> {
    let name = |joint: usize| {
        let joint = &robot.joints[joint];
        Located::new(joint.name.to_owned(), name_span(joint.node))
    };
    let names = parents.iter();
    names
        .map(|parent| parent.map(|(joint, _)| name(joint)))
        .collect()
}

fn movement(joint: &Joint<'_, '_>) -> Movement<'static> {
    match joint.kind.of_library().map(Movement::of) {
        None => Movement::Fixed,
        Some(Movement::Other(_)) => Movement::Other(joint.kind.name()),
        Some(movement) => movement,
    }
}

/// The place of every name among the elements.
fn unique<'a>(
    elements: &str,
    named: impl Iterator<Item = (&'a str, Node<'a, 'a>)>,
    sink: &mut Sink,
) -> HashMap<&'a str, usize> {
    let mut places: HashMap<&str, (usize, Node)> = HashMap::new();
    for (index, (name, node)) in named.enumerate() {
        let (first, first_node) = *places.entry(name).or_insert((index, node));
        if first == index {
            continue;
        }
        let message = format!("two {elements} are called `{name}`");
        let error = Diagnostic::new(name_span(node), message).label("the second one");
        sink.push(error.context(name_span(first_node), "the first one"));
    }
    places
        .into_iter()
        .map(|(name, (index, _))| (name, index))
        .collect()
}

/// Where the name of a link or a joint stands.
pub(super) fn name_span(node: Node<'_, '_>) -> Span {
    let name = node.attribute_node("name");
    name.map_or_else(|| tag(node), |name| name.range_value())
}

/// Joint and parent of each link.
fn parents(
    robot: &Robot<'_, '_>,
    names: &HashMap<&str, usize>,
    sink: &mut Sink,
) -> Vec<Option<(usize, usize)>> {
    let mut parents: Vec<Option<(usize, usize)>> = vec![None; robot.links.len()];
    let known: Vec<&str> = robot.links.iter().map(|link| link.name).collect();
    let mut suggestions = Suggestions::default();
    for (index, joint) in robot.joints.iter().enumerate() {
        let ends = [("parent", joint.parent), ("child", joint.child)];
        let ends = ends.map(|(end, link)| match names.get(link) {
            Some(&link) => Some(link),
            None => {
                let near = suggestions.nearest(link, &known);
                sink.push(unknown_link(joint, (end, link), near, &known));
                None
            }
        });
        let [Some(parent), Some(child)] = ends else {
            continue;
        };
        match parents[child] {
            Some((other, _)) => sink.push(second_parent(robot, child, index, other)),
            None => parents[child] = Some((index, parent)),
        }
    }
    parents
}

fn unknown_link(
    joint: &Joint<'_, '_>,
    (end, link): (&str, &str),
    near: Option<&str>,
    known: &[&str],
) -> Diagnostic {
    let message = format!(
        "joint `{}`: its {end} `{link}` is not a link of the robot",
        joint.name
    );
    let error = Diagnostic::new(place(joint.node, end, "link"), message);
    match near {
        Some(near) => error.label(format!("did you mean `{near}`?")),
        None => error.help(format!("its links are {}", all_of(known.iter().copied()))),
    }
}

fn second_parent(robot: &Robot<'_, '_>, link: usize, joint: usize, other: usize) -> Diagnostic {
    let (link, joints) = (robot.links[link].name, &robot.joints);
    let message = format!(
        "link `{link}` hangs on two joints, `{}` and `{}`",
        joints[other].name, joints[joint].name
    );
    let span = |joint: usize| place(robot.joints[joint].node, "child", "link");
    Diagnostic::new(span(joint), message)
        .label("the second one")
        .context(span(other), "the first one")
        .help("the links of a URDF are a tree: what closes a loop is a <loop>, with predecessor and successor")
}

fn cycle_error(
    robot: &Robot<'_, '_>,
    parents: &[Option<(usize, usize)>],
    cycle: &[usize],
) -> Diagnostic {
    const MOST_SHOWN: usize = 12;
    let name = |&link: &usize| format!("`{}`", robot.links[link].name);
    let mut chain: Vec<String> = cycle.iter().take(MOST_SHOWN).map(name).collect();
    if cycle.len() > MOST_SHOWN {
        chain.push(format!("({} more)", cycle.len() - MOST_SHOWN));
    }
    chain.extend(cycle.first().map(name));
    let message = format!("the links' parents form a cycle: {}", chain.join(" → "));
    let joint = cycle.first().and_then(|&link| parents[link]);
    let span = joint.map_or(0..0, |(joint, _)| {
        place(robot.joints[joint].node, "parent", "link")
    });
    Diagnostic::new(span, message)
}

fn roots(robot: &Robot<'_, '_>, parents: &[Option<usize>], sink: &mut Sink) {
    let is_root = |link: &usize| parents[*link].is_none();
    let roots: Vec<usize> = (0..parents.len()).filter(is_root).collect();
    if let [first, second, ..] = roots.as_slice() {
        let names = roots.iter().map(|&root| robot.links[root].name);
        let message = format!(
            "the robot has {} root links: {}",
            roots.len(),
            all_of(names)
        );
        sink.push(
            Diagnostic::new(tag(robot.links[*second].node), message)
                .label("no joint has this link as its child")
                .context(tag(robot.links[*first].node), "nor this one")
                .help("a URDF is one tree: every link but one is the child of a joint"),
        );
    }
}
