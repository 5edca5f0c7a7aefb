//! Equalities: joints that follow others, as mimic joints do. Others are reported.

use super::actuator::{Places, found};
use super::defaults::{Defaults, MAIN};
use super::element::{Element, Lines, label};
use super::tree::Body;
use crate::description::MimicDescription;
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::source::Located;
use roxmltree::Node;
use std::collections::HashMap;

/// A joint, by its body and its place there, with what it follows.
pub(super) type Follower = ((usize, usize), Located<MimicDescription>);

/// All of them.
pub(super) type Followers = HashMap<(usize, usize), Located<MimicDescription>>;

/// The joints that follow others.
pub(super) fn mimics<'a>(
    root: Node<'a, 'a>,
    bodies: &[Body<'_>],
    places: &Places,
    (defaults, lines): (&Defaults<'a>, &Lines),
    (notices, sink): (&mut Notices, &mut Sink),
) -> Followers {
    let sections = root.children().filter(|node| node.has_tag_name("equality"));
    let mut mimics = Followers::new();
    for node in sections
        .flat_map(|section| section.children())
        .filter(Node::is_element)
    {
        let owner = format!(
            "<{}> in line {}",
            node.tag_name().name(),
            lines.of(node.range().start)
        );
        if node.attribute("active") == Some("false") {
            notices.add("equalities that are not active are left out", owner);
            continue;
        }
        if !node.has_tag_name("joint") {
            notices.warn(
                "equalities other than those of joints are not simulated",
                owner,
            );
            continue;
        }
        let element = Element {
            node,
            chain: vec![node],
        };
        // The class of an equality says nothing that is read here, but must be one.
        defaults.named(node, "class", MAIN, sink);
        match mimic(&label(node, lines), &element, bodies, places, sink) {
            Some(Ok((place, _))) if mimics.contains_key(&place) => {
                notices.warn(
                    "a joint follows one other: further equalities of it are not simulated",
                    owner,
                );
            }
            Some(Ok((place, mimic))) => {
                mimics.insert(place, mimic);
            }
            Some(Err(why)) => notices.warn(why, owner),
            None => {}
        }
    }
    mimics
}

/// What an equality of joints says; why it is left out; `None` where it is wrong.
fn mimic(
    owner: &str,
    element: &Element<'_>,
    bodies: &[Body<'_>],
    places: &Places,
    sink: &mut Sink,
) -> Option<Result<Follower, &'static str>> {
    let own = found(owner, element, "joint1", places, sink)?;
    let Some(name) = element.text("joint2") else {
        return Some(Err("equalities that hold a joint still are not simulated"));
    };
    let other = found(owner, element, "joint2", places, sink)?;
    let mut coefficients = [0.0, 1.0, 0.0, 0.0, 0.0];
    let said = element.numbers("polycoef").unwrap_or_default();
    coefficients
        .iter_mut()
        .zip(said)
        .for_each(|(known, said)| *known = said);
    let joint = |(body, number): (usize, usize)| &bodies[body].joints[number];
    for (attribute, place) in [("joint1", own), ("joint2", other)] {
        if !joint(place).movement.has_axis() {
            let message = format!("{owner}: its `{attribute}` is neither a hinge nor a slide");
            sink.push(Diagnostic::new(element.span(attribute), message));
            return None;
        }
    }
    let [offset, multiplier, higher @ ..] = coefficients;
    if higher.iter().any(|coefficient| *coefficient != 0.0) {
        return Some(Err(
            "equalities whose polynomial is not linear are not simulated",
        ));
    }
    if multiplier == 0.0 {
        return Some(Err("equalities that hold a joint still are not simulated"));
    }
    // Of the coordinates without their references.
    let offset = offset + joint(own).reference - multiplier * joint(other).reference;
    let mimic = MimicDescription {
        joint: Located::new(name.to_owned(), element.span("joint2")),
        multiplier,
        offset,
    };
    Some(Ok((own, Located::new(mimic, element.span("joint1")))))
}
