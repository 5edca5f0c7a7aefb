//! Actuators: efforts are inputs of a scene, and of motors their limits are read. What else they do is reported.

use super::defaults::{Defaults, MAIN};
use super::element::{Element, Lines, label};
use super::tree::Body;
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use roxmltree::Node;
use std::collections::HashMap;

/// The places of the joints that have names: of their bodies, and among the joints of these.
pub(super) type Places = HashMap<String, (usize, usize)>;

/// Those of a model.
pub(super) fn joints(bodies: &[Body<'_>]) -> Places {
    let mut places = Places::new();
    for (place, body) in bodies.iter().enumerate() {
        for (number, joint) in body.joints.iter().enumerate() {
            if let Some(name) = joint.element.name() {
                places.insert(name.value, (place, number));
            }
        }
    }
    places
}

/// The joint that an attribute names.
pub(super) fn found(
    owner: &str,
    element: &Element<'_>,
    attribute: &str,
    places: &Places,
    sink: &mut Sink,
) -> Option<(usize, usize)> {
    let name = element.text(attribute)?;
    if let Some(place) = places.get(name) {
        return Some(*place);
    }
    let message = format!("{owner}: its `{attribute}` is `{name}`, which is no joint");
    let error = Diagnostic::new(element.span(attribute), message);
    let mut known: Vec<&str> = places.keys().map(String::as_str).collect();
    known.sort_unstable();
    sink.unknown(error, name, &known, "a joint is");
    None
}

/// Reads the limits of motors into their joints, and tells what is not simulated.
pub(super) fn limit<'a>(
    root: Node<'a, 'a>,
    bodies: &mut [Body<'_>],
    (defaults, lines): (&Defaults<'a>, &Lines),
    places: &Places,
    (notices, sink): (&mut Notices, &mut Sink),
) {
    let sections = root.children().filter(|node| node.has_tag_name("actuator"));
    let mut efforts: HashMap<(usize, usize), Option<f64>> = HashMap::new();
    for node in sections
        .flat_map(|section| section.children())
        .filter(Node::is_element)
    {
        let owner = label(node, lines);
        let element = defaults.element(node, MAIN, sink);
        let place = found(&owner, &element, "joint", places, sink);
        let number = |name: &str| element.number(name).unwrap_or(0.0);
        if number("armature") != 0.0 || number("damping") != 0.0 {
            notices.warn(
                "armatures and damping of actuators are not simulated: those of joints are",
                &owner,
            );
        }
        if !is_motor(&element) {
            notices.add(
                "actuators other than motors are not simulated: efforts are inputs",
                &owner,
            );
        } else if place.is_none() {
            notices.add("motors are read at joints alone", &owner);
        }
        if let Some(place) = place.filter(|_| is_motor(&element)) {
            let own = effort(&element);
            let sum = efforts.entry(place).or_insert(Some(0.0));
            *sum = sum.zip(own).map(|(sum, own)| sum + own);
        }
    }
    for ((body, number), effort) in efforts {
        let joint = &mut bodies[body].joints[number];
        joint.effort = match (joint.effort, effort) {
            (Some(joint), Some(motors)) => Some(joint.min(motors)),
            (one, other) => one.or(other),
        };
    }
}

/// Whether an actuator exerts what it is told to.
fn is_motor(element: &Element<'_>) -> bool {
    let is = |name: &str, wanted: &str| element.text(name).is_none_or(|text| text == wanted);
    match element.node.tag_name().name() {
        "motor" => true,
        "general" => is("gaintype", "fixed") && is("biastype", "none") && is("dyntype", "none"),
        _ => false,
    }
}

/// The largest effort of a motor, N m or N; `None` without a limit.
fn effort(element: &Element<'_>) -> Option<f64> {
    let range = |range: &str, limited: &str| {
        let [low, high] = element.vector(range)?;
        let limits = element.switch(limited).unwrap_or([low, high] != [0.0; 2]);
        limits.then(|| f64::abs(low).max(f64::abs(high)))
    };
    let gear = element.number("gear").unwrap_or(1.0).abs();
    let gain = match element.node.tag_name().name() {
        "motor" => 1.0,
        _ => element.number("gainprm").unwrap_or(1.0).abs(),
    };
    let control = range("ctrlrange", "ctrllimited").map(|control| control * gain);
    let force = range("forcerange", "forcelimited");
    let least = match (control, force) {
        (Some(control), Some(force)) => Some(control.min(force)),
        (one, other) => one.or(other),
    };
    least.map(|least| least * gear)
}
