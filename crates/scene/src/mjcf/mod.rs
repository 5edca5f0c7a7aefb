//! Robots in MJCF, the XML format of MuJoCo: read to the same description as a scene file.
//!
//! | MJCF | here |
//! |---|---|
//! | `hinge`, `slide` | `revolute`, `prismatic`, with the coordinate that MuJoCo has: it is `ref` where the body stands as the file says |
//! | `ball`, `free`, `<freejoint>` | `ball_child`, `free` |
//! | several joints of a body | a chain in their order; the bodies between them have no mass, and are called by their joints with `_link` |
//! | a body without joints | a part of the body that it hangs on: masses and inertias add up, its frame stays as a named frame; so do sites |
//! | `<default>`, `class`, `childclass`, `<frame>`, `<include>` | resolved |
//! | `<inertial>`, or masses of geoms, meshes among them, with `<compiler>`'s bounds | mass, centre of mass and inertia |
//! | `stiffness`, `springref`, `damping`, `armature`, `frictionloss` | the joint's spring, damping, armature and dry friction |
//! | `range` of `hinge` and `slide` | compliant limits, if [`Options::limits`] gives their numbers |
//! | `gravcomp` | a constant force at the centre of mass |
//! | `<equality>`'s `<joint>`, linear | `mimic`: the joint follows the other exactly |
//! | actuators | not simulated: efforts are inputs; those of motors have limits ([`JointFacts`](crate::robot::JointFacts)) |
//! | contacts, tendons, sensors, keyframes, other equalities, plugins | not simulated, and reported as [`Notice`](crate::Notice)s with their lines |
//!
//! A robot begins as the file draws it: every joint is at its `ref`, free bodies are where they stand, and all are at rest.

mod actuator;
mod assets;
mod audit;
mod bulk;
mod chain;
mod convert;
mod defaults;
mod element;
mod equality;
mod geom;
mod include;
mod inertia;
mod joint;
mod mesh;
mod names;
mod notes;
mod placement;
mod schema;
mod settings;
mod solid;
mod tree;

pub use include::with_files;

use crate::description::Source;
use crate::diagnostics::Diagnostic;
use crate::notice::Notices;
use crate::read::Sink;
use crate::robot::xml::tag;
use crate::robot::{Import, Options};
use assets::Assets;
use defaults::Defaults;
use element::Lines;
use roxmltree::Document;
use settings::Settings;
use tree::Reader;

/// The robot of a document in MJCF.
pub(crate) fn import(
    document: &Document<'_>,
    source: Source,
    options: &Options,
    sink: &mut Sink,
) -> Option<Import> {
    let root = document.root_element();
    let lines = Lines::new(&source.text);
    if options.floating_base {
        let error = Diagnostic::new(
            tag(root),
            "a floating base is asked for, but a robot in MJCF says itself what moves freely",
        );
        sink.push(error.help("give the body a <freejoint/>"));
    }
    if options.lenient {
        let error = Diagnostic::new(
            tag(root),
            "the robot is to be read leniently, but MJCF has settings of its own for masses that no rigid body has",
        );
        sink.push(
            error.help(
                "set `balanceinertia=\"true\"`, `boundmass` and `boundinertia` of <compiler>",
            ),
        );
    }
    audit::audit(root, &lines, sink);
    if sink.len() > 0 {
        return None;
    }
    let mut notices = Notices::default();
    let settings = Settings::read(root, &mut notices, sink);
    let defaults = Defaults::read(root, sink);
    let assets = Assets::read(root, &defaults, sink);
    let by = (&settings, &defaults, &lines, &assets);
    let mut bodies = Reader::new(by, &mut notices, sink).bodies(root);
    notes::tell(root, &bodies, &settings, &lines, &mut notices);
    let masses = inertia::masses(&bodies, &settings, sink);
    let joints = actuator::joints(&bodies);
    actuator::limit(
        root,
        &mut bodies,
        (&defaults, &lines),
        &joints,
        (&mut notices, sink),
    );
    let mimics = match settings.equalities {
        true => equality::mimics(
            root,
            &bodies,
            &joints,
            (&defaults, &lines),
            (&mut notices, sink),
        ),
        false => equality::Followers::new(),
    };
    let model = convert::Model {
        root,
        bodies: &bodies,
        masses: &masses,
        mimics,
        settings: &settings,
    };
    convert::convert(&model, source, options.limits, notices, sink)
}
