//! Joints that follow others, and those that loops close: the bodies of a coupling stand side by side, and what a coupling cannot have is left out. And bodies without mass.

use crate::coupling::{Group, Node, Tie, groups, order};
use crate::description::{BodyDescription, SceneDescription};
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::robot::mass::is_nothing;

/// Puts the bodies of each coupling side by side.
pub(crate) fn couple(scene: &mut SceneDescription, notices: &mut Notices, sink: &mut Sink) {
    let nodes: Vec<Node<'_>> = scene.bodies.iter().map(Node::of).collect();
    let ties: Vec<Tie<'_>> = scene.loops.iter().map(Tie::of_loop).collect();
    let Some(found) = groups(&nodes, &ties, "robot", sink) else {
        return;
    };
    if found.is_empty() {
        return;
    }
    found
        .iter()
        .filter(|group| !group.is_of_one())
        .for_each(|group| {
            let members = group.members.iter().map(|(place, _)| *place);
            members.for_each(|place| leave_out(&mut scene.bodies[place], notices));
        });
    settle(scene, &found);
}

/// Leaves out what joints of a coupling with several independent ones cannot have.
fn leave_out(body: &mut BodyDescription, notices: &mut Notices) {
    let owner = format!("joint `{}`", body.joint.name.value);
    if body.forces.friction.take().is_some() {
        notices.warn("dry friction is not simulated of joints that are coupled with several independent ones", &owner);
    }
    if body.forces.limit.take().is_some() {
        notices.warn(
            "limits are not simulated of joints that are coupled with several independent ones",
            &owner,
        );
    }
}

/// Brings the bodies in order, and all that refers to them.
fn settle(scene: &mut SceneDescription, found: &[Group]) {
    let parents: Vec<Option<usize>> = scene.bodies.iter().map(|body| body.parent).collect();
    let order = order(&parents, found);
    let mut rank = vec![0; order.len()];
    order
        .iter()
        .enumerate()
        .for_each(|(own, place)| rank[*place] = own);
    let ranked = |place: &mut Option<usize>| *place = place.map(|place| rank[place]);
    let mut bodies: Vec<Option<BodyDescription>> = scene.bodies.drain(..).map(Some).collect();
    scene.bodies = order
        .iter()
        .filter_map(|place| bodies[*place].take())
        .collect();
    scene
        .bodies
        .iter_mut()
        .for_each(|body| ranked(&mut body.parent));
    scene
        .frames
        .iter_mut()
        .for_each(|frame| ranked(&mut frame.body));
    scene
        .shapes
        .iter_mut()
        .for_each(|shape| ranked(&mut shape.body));
    for end in scene.loops.iter_mut().flat_map(|own| &mut own.ends) {
        ranked(&mut end.body);
    }
    for spring in &mut scene.springs {
        ranked(&mut spring.from.body);
        ranked(&mut spring.to.body);
    }
    scene
        .wrenches
        .iter_mut()
        .for_each(|wrench| wrench.body = rank[wrench.body]);
}

/// Refuses bodies that move without mass on them or on what hangs on them, and without an armature: M would be singular. Those that only move together need one mass between
/// them. Errors call a body `what`, and end with `help`.
pub(crate) fn refuse_massless(
    bodies: &[BodyDescription],
    ties: &[Tie<'_>],
    (what, help): (&str, &str),
    sink: &mut Sink,
) {
    let massive = bodies.iter().map(|body| !is_nothing(&body.mass));
    let mut massive: Vec<bool> = massive.collect();
    for (index, body) in bodies.iter().enumerate().rev() {
        if let Some(parent) = body.parent.filter(|_| massive[index]) {
            massive[parent] = true;
        }
    }
    // An armature is inertia of its own joint alone.
    for (massive, body) in massive.iter_mut().zip(bodies) {
        *massive |= body.forces.armature.is_some();
    }
    let nodes: Vec<Node<'_>> = bodies.iter().map(Node::of).collect();
    // What makes no group is told elsewhere.
    let found = groups(&nodes, ties, "robot", &mut Sink::default()).unwrap_or_default();
    for own in found.iter().flat_map(Group::bound) {
        let any = own.iter().any(|&body| massive[body]);
        own.iter().for_each(|&body| massive[body] |= any);
    }
    for (body, _) in bodies.iter().zip(massive).filter(|(_, massive)| !massive) {
        let (name, joint) = (&body.name.value, &body.joint.name.value);
        let message = format!(
            "{what} `{name}` moves on joint `{joint}`, but neither it nor what hangs on it has mass: its acceleration would not be determined"
        );
        let error = Diagnostic::new(body.name.span.clone(), message);
        sink.push(error.help(help));
    }
}
