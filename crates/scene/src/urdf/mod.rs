//! Robots in URDF, the XML format of ROS: read to the same description as a scene file.
//!
//! | URDF | here |
//! |---|---|
//! | `revolute`, `continuous`, `prismatic` | `revolute`, `revolute_circle`, `prismatic`; the axis is turned onto z by `at`, and back by `body_at`, so that body frames are link frames |
//! | `fixed` | the child link becomes a part of its parent's body: masses and inertias add up, its frame stays as a named frame |
//! | `floating`, `spherical` | `free`, `ball_child`: velocities in child axes |
//! | `planar` | `planar`: turns about the axis and slides across it, velocities in child axes; x and y of the plane are those of the joint's frame where its axis is z, else where the shortest rotation from z to the axis takes them |
//! | root link | fixed to the world, or on a `free` joint: [`Options::floating_base`] |
//! | `<inertial>` absent | no mass |
//! | `<visual>` of a box, a sphere, a cylinder or a capsule | a shape for pictures; meshes are reported as [`Notice`](crate::Notice)s |
//! | `<limit lower upper>` of `revolute` and `prismatic` | compliant limits, if [`Options::limits`] gives their numbers |
//! | `<dynamics damping friction>` | damping; dry friction of `revolute` and `prismatic` |
//! | `<mimic>` | `mimic`: the joint follows the other exactly, and both are one joint of several bodies |
//! | `<loop>`, `<coupling>`, `independent` of `<joint>` (URDF+, arXiv 2411.19753) | `[[loop]]`, `[[coupling]]`: the joints of a loop are one joint of several bodies |
//! | a YAML file of the same name beside it (Extended URDF, arXiv 2504.04767): [`with_loops`] | loops, which joints are independent, universal and spherical joints |
//! | other limits, safety controllers, transmissions, collision shapes, unknown elements | not simulated, and reported as [`Notice`](crate::Notice)s |
//!
//! A state is not part of a URDF: every joint is at home (angles, displacements 0) and at rest.

mod audit;
mod convert;
mod document;
mod extended;
mod foreign;
mod joint;
mod lenient;
mod mass;
mod masses;
mod robot;
mod schema;
mod shapes;
mod supplement;
mod ties;
mod tree;

// Names by which readers of URDF know what is now for robots of all formats.
pub use crate::robot::{
    Import, JointFacts, Limits, Options, Stops, completed, is_robot, load, read,
};
pub use extended::with_loops;
pub(crate) use foreign::of_prefix;

use crate::description::Source;
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::text::visible_line;
use audit::Audit;
use document::tag;
use robot::Robot;
use roxmltree::{Document, Node};

/// The robot of a document in URDF.
pub(crate) fn import(
    document: &Document<'_>,
    source: Source,
    options: &Options,
    sink: &mut Sink,
) -> Option<Import> {
    if let Some(refusal) = foreign::refusal(document) {
        sink.push(refusal);
        return None;
    }
    let root = document.root_element();
    let mut notices = Notices::default();
    let version = version(root, &mut notices);
    for file in document.root().children().filter_map(|node| node.pi()) {
        if file.target == extended::TARGET {
            let file = visible_line(file.value.unwrap_or_default());
            let message = format!(
                "its loops, its motors in them, and joints of other types are those of {file}"
            );
            notices.add(message, "<robot>");
        }
    }
    let mut audit = Audit {
        sink,
        notices: &mut notices,
        version,
    };
    audit.root(root, &schema::ROBOT);
    if sink.len() > 0 {
        return None;
    }
    let mut robot = Robot::read(root)?;
    if robot.links.is_empty() {
        sink.push(Diagnostic::new(tag(root), "the robot has no link"));
        return None;
    }
    if options.lenient {
        lenient::fix_massless(&mut robot, &mut notices);
    }
    convert::convert(&robot, version, source, options, notices, sink)
}

/// Versions of URDF, in their order.
const VERSIONS: [(u32, u32); 3] = [(1, 0), (1, 1), (1, 2)];

/// Version of URDF: 1.0 where the file does not say; the nearest known one before it, with a notice, where what it says is not known.
fn version(root: Node<'_, '_>, notices: &mut Notices) -> (u32, u32) {
    let [oldest, ..] = VERSIONS;
    let Some(text) = root.attribute("version") else {
        return oldest;
    };
    let (major, minor) = text.trim().split_once('.').unwrap_or((text.trim(), "0"));
    let given = major.parse().ok().zip(minor.parse().ok());
    let before = |known: &&(u32, u32)| given.is_some_and(|given| **known <= given);
    let found = *VERSIONS.iter().rfind(before).unwrap_or(&oldest);
    if given != Some(found) {
        let (text, (major, minor)) = (visible_line(text), found);
        let message =
            format!("version `{text}` of URDF is not known: it is read as {major}.{minor}");
        notices.add(message, "<robot>");
    }
    found
}
