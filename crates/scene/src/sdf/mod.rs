//! Robots in SDF, the XML format of Gazebo: read to the same description as a scene file.
//!
//! | SDF | here |
//! |---|---|
//! | `<model>` alone, or those of a `<world>` | one scene; names are those of links, with `model::` before them where there are several models |
//! | `<model>` in a model | its links, joints and frames, with `model::` before their names |
//! | `revolute`, `continuous`, `prismatic`, `ball`, `screw` | `revolute`, `revolute_circle`, `prismatic`, `ball_child`, `screw`; body frames are link frames |
//! | `continuous` with a spring | `revolute`: it counts turns |
//! | `universal`, `revolute2` | two `revolute` joints, the second with `_2` behind the name; the body between them has no mass |
//! | `fixed` | the child becomes a part of its parent's body: masses and inertias add up, its frame stays as a named frame |
//! | a link that is the child of no joint | moves on a `free` joint of its name, and begins where it stands; in a `<static>` model it is part of the world |
//! | a joint whose child hangs on another already | closes a loop, which the scene has as one joint of several bodies; or holds its parent, where nothing else does |
//! | `<pose>` with `relative_to`, `rotation_format` and `degrees`, `<frame>`, `expressed_in`, `use_parent_model_frame` | resolved; frames are named frames of the scene |
//! | `<inertial>` | mass, centre of mass and inertia; what is not said is 1 kg, and 1 kg m² about each axis |
//! | `damping`, `friction`, `spring_stiffness`, `spring_reference` | the joint's damping, dry friction and spring |
//! | `<limit>` with `lower` and `upper` | compliant limits, if [`Options::limits`] gives their numbers |
//! | `<mimic>` | `mimic`: the joint follows the other exactly |
//! | `<gravity>` of a world, or of a link | the scene's gravity; a constant force at the centre of mass of a link without |
//! | `<visual>` of a box, a sphere, a cylinder, a capsule or a mesh | a shape for pictures |
//! | sensors, plugins, collision shapes, lights, settings of other simulators | not simulated, and reported as [`Notice`](crate::Notice)s |
//! | `<include>` in a model, `gearbox`, grippers, masses of shapes (`auto`) | refused |
//!
//! A robot begins as the file draws it: every joint is at 0, links that move freely are where they stand, and all are at rest.

mod audit;
mod content;
mod convert;
mod document;
mod joint;
mod mass;
mod poses;
mod schema;
mod shapes;
mod tree;

use crate::coupling::Tie;
use crate::description::{SceneDescription, Source};
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::robot::couple;
use crate::robot::xml::tag;
use crate::robot::{Import, Options};
use crate::scene::stem;
use crate::text::{quoted, visible_line};
use content::Content;
use document::{attribute, child, children, is, place, value, vector};
use nalgebra::Vector3;
use poses::Poses;
use roxmltree::{Document, Node};
use std::path::Path;

/// Major and minor version of SDF.
type Version = (u32, u32);

/// The version that is read where a file says none: the latest.
const LATEST: Version = (1, 12);

/// The free fall of a world that does not say it, m/s².
const OF_WORLDS: Vector3<f64> = Vector3::new(0.0, 0.0, -9.8);

/// The robot of a document in SDF.
pub(crate) fn import(
    document: &Document<'_>,
    source: Source,
    options: &Options,
    sink: &mut Sink,
) -> Option<Import> {
    let root = document.root_element();
    refuse_options(root, options, sink);
    let mut notices = Notices::default();
    let version = version(root, &mut notices);
    audit::audit(root, &mut notices, sink);
    let top = top(root, sink)?;
    if sink.len() > 0 {
        return None;
    }
    let content = Content::read(top, version, sink);
    let poses = Poses::read(&content, sink)?;
    let joints = joint::joints(&content, &poses, &mut notices, sink);
    let gravity = gravity(top, version, options, (&mut notices, sink));
    let file = Path::new(&source.name).file_name().unwrap_or_default();
    let description = format!("Imported from the SDF {}", file.to_string_lossy());
    let named = children(top, "model")
        .next()
        .filter(|_| child(root, "world").is_none())
        .unwrap_or(top);
    let mut scene = SceneDescription {
        description: visible_line(&description),
        name: attribute(named, "name").map_or_else(|| stem(&source.name), str::to_owned),
        gravity,
        ..SceneDescription::empty(source)
    };
    let model = convert::Model {
        content: &content,
        poses: &poses,
        joints: &joints,
        gravity,
        stops: options.limits,
    };
    let facts = convert::fill(model, &mut scene, &mut notices, sink);
    if scene.bodies.is_empty() && sink.len() == 0 {
        let error = Diagnostic::new(tag(root), "nothing in the file moves");
        sink.push(error.help("links move freely, or on joints, in models that are not static"));
    }
    if sink.len() == 0 {
        couple::couple(&mut scene, &mut notices, sink);
    }
    if sink.len() == 0 {
        let help = "give the link an <inertial>, or make the joint fixed";
        let ties: Vec<Tie<'_>> = scene.loops.iter().map(Tie::of_loop).collect();
        couple::refuse_massless(&scene.bodies, &ties, ("body", help), sink);
    }
    (sink.len() == 0).then(|| Import {
        scene,
        notices: notices.into_vec(),
        joints: facts,
    })
}

/// SDF says itself what moves freely.
fn refuse_options(root: Node<'_, '_>, options: &Options, sink: &mut Sink) {
    let refused = [
        (
            options.floating_base,
            "a floating base is asked for, but a robot in SDF says itself what moves freely",
            "take away the joint that holds the link to the world",
        ),
        (
            options.lenient,
            "the robot is to be read leniently, which is for URDF",
            "correct the numbers in the file",
        ),
    ];
    for (_, message, help) in refused.into_iter().filter(|(is_asked, _, _)| *is_asked) {
        sink.push(Diagnostic::new(tag(root), message).help(help));
    }
}

/// What holds the models: the world of the file, or the whole.
fn top<'a, 'i>(root: Node<'a, 'i>, sink: &mut Sink) -> Option<Node<'a, 'i>> {
    let tops: Vec<Node<'a, 'i>> = root
        .children()
        .filter(|node| is(*node, "world") || is(*node, "model"))
        .collect();
    match tops.as_slice() {
        [] => {
            sink.push(Diagnostic::new(
                tag(root),
                "the file has no <model> and no <world>",
            ));
            None
        }
        [one] if is(*one, "world") => Some(*one),
        [_] => Some(root),
        [first, second, ..] => {
            let message = "the file has several models or worlds beside each other";
            let error = Diagnostic::new(tag(*second), message).label("the second one");
            sink.push(
                error
                    .context(tag(*first), "the first one")
                    .help("several models stand in one <world>"),
            );
            None
        }
    }
}

/// The version that a file says.
fn version(root: Node<'_, '_>, notices: &mut Notices) -> Version {
    let said = attribute(root, "version").map(str::trim);
    let parts = said.and_then(|said| said.split_once('.'));
    let numbers = parts.and_then(|(major, minor)| major.parse().ok().zip(minor.parse().ok()));
    let known = numbers.filter(|version: &Version| version.0 == 1);
    known.unwrap_or_else(|| {
        let (major, minor) = LATEST;
        let said = said.map_or("no version".to_owned(), |said| {
            format!("version `{}`", visible_line(said))
        });
        notices.warn(format!("SDF of {said} is read as {major}.{minor}"), "<sdf>");
        LATEST
    })
}

/// Free fall: what the world says, until SDF 1.5 in its `<physics>`; for a model alone what is asked for.
fn gravity(
    top: Node<'_, '_>,
    version: Version,
    options: &Options,
    (notices, sink): (&mut Notices, &mut Sink),
) -> Vector3<f64> {
    if !is(top, "world") {
        return options.gravity;
    }
    let of_old = child(top, "physics")
        .filter(|physics| version < (1, 6) && child(*physics, "gravity").is_some());
    let says = child(top, "gravity").map_or(of_old, |_| Some(top));
    let Some(says) = says else {
        let message = "the world does not say its gravity: it is 9.8 m/s² against z, as SDF has it";
        notices.add(message, "<world>");
        return OF_WORLDS;
    };
    vector(says, "gravity").unwrap_or_else(|| {
        let said = quoted(value(says, "gravity").unwrap_or_default());
        let message = format!("<gravity> is {said}, not 3 finite numbers");
        sink.push(Diagnostic::new(place(says, "gravity"), message));
        OF_WORLDS
    })
}
