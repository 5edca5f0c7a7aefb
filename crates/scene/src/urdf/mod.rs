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
//! | `<visual>` of a box, a sphere, a cylinder or a capsule | a shape for pictures; meshes are told as [`Notice`]s |
//! | `<limit lower upper>` of `revolute` and `prismatic` | compliant limits, if [`Options::limits`] gives their numbers |
//! | `<dynamics damping friction>` | damping; dry friction of `revolute` and `prismatic` |
//! | `<mimic>` | `mimic`: the joint follows the other exactly, and both are one joint of several bodies |
//! | `<loop>`, `<coupling>`, `independent` of `<joint>` (URDF+, arXiv 2411.19753) | `[[loop]]`, `[[coupling]]`: the joints of a loop are one joint of several bodies |
//! | a YAML file of the same name beside it (Extended URDF, arXiv 2504.04767): [`completed`] | loops, which joints are independent, universal and spherical joints |
//! | other limits, safety controllers, transmissions, collision shapes, unknown elements | not simulated, and told as [`Notice`]s |
//!
//! A state is not part of a URDF: every joint is at home (angles, displacements 0) and at rest.

mod audit;
mod convert;
mod document;
mod extended;
mod foreign;
mod joint;
mod mass;
mod masses;
mod robot;
mod schema;
mod shapes;
mod ties;
mod tree;

pub use extended::completed;
pub use joint::{JointFacts, Limits};

use crate::description::{SceneDescription, Source};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::notice::{Notice, Notices};
use crate::read::Sink;
use crate::scene::{Scene, read_file};
use crate::text::visible_line;
use audit::Audit;
use document::tag;
use hamel_runtime::registry::JointRegistry;
use nalgebra::Vector3;
use robot::Robot;
use roxmltree::{Document, Node};
use std::collections::HashMap;
use std::path::Path;

/// What a URDF does not say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Whether the root link moves freely; otherwise it is fixed to the world.
    pub floating_base: bool,
    /// Acceleration of free fall, world axes, m/s².
    pub gravity: Vector3<f64>,
    /// What makes compliant limits of the joints' limits of position; `None` leaves these out.
    pub limits: Option<Stops>,
}

/// Numbers of compliant limits, the same for all joints: see [`LimitKind::Compliant`](crate::LimitKind::Compliant).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops {
    /// k, N m/rad or N/m; at least 0.
    pub stiffness: f64,
    /// d, s/rad or s/m; at least 0.
    pub damping: f64,
}

impl Default for Options {
    /// A fixed base, and 9.81 m/s² against z.
    fn default() -> Self {
        Self {
            floating_base: false,
            gravity: Vector3::new(0.0, 0.0, -9.81),
            limits: None,
        }
    }
}

/// A robot as a scene, and what the scene leaves out.
#[derive(Clone, Debug)]
pub struct Import {
    /// The robot at home and at rest.
    pub scene: SceneDescription,
    /// What is not simulated, and what URDF leaves open.
    pub notices: Vec<Notice>,
    /// What the file says of each joint beyond its motion, in the order of the file.
    pub joints: Vec<JointFacts>,
}

/// The robot that a text in URDF describes. Messages call the text `source_name`.
///
/// # Errors
/// Numbers of limits that are negative or not finite. All mistakes of the text: XML that is not well-formed, or in another format (xacro, SDF and MJCF are told by name); missing or malformed elements and attributes; links and joints that
/// make no tree; mass properties that no body can have; a link without mass at the end of a moving joint.
pub fn read(text: &str, source_name: &str, options: &Options) -> Result<Import, Diagnostics> {
    let mut sink = Sink::default();
    if let Some(Stops { stiffness, damping }) = options.limits {
        let numbers = [("stiffness", stiffness), ("damping", damping)];
        let wrong = numbers
            .into_iter()
            .filter(|(_, number)| !(number.is_finite() && *number >= 0.0));
        for (what, number) in wrong {
            let message =
                format!("the {what} of limits is {number}: it must be finite and at least 0");
            sink.push(Diagnostic::without_place(message));
        }
    }
    let import = document::tree(text, &mut sink).and_then(|document| {
        let source = Source {
            name: source_name.to_owned(),
            text: text.to_owned(),
        };
        import(&document, source, options, &mut sink)
    });
    match import {
        Some(import) if sink.len() == 0 => Ok(import),
        _ => Err(sink.refuse(source_name, text, "the robot cannot be read")),
    }
}

/// Whether a file holds a robot rather than a scene: what is XML is read as URDF, whatever the file's ending, and so is what ends in `.urdf`.
///
/// No scene begins as XML does; other formats of robots do, and [`read`] names them.
pub fn is_robot(path: &Path, text: &str) -> bool {
    let is_before_xml = |c: char| c.is_whitespace() || c == '\u{feff}';
    let ending = path.extension().unwrap_or_default();
    ending.eq_ignore_ascii_case("urdf") || text.trim_start_matches(is_before_xml).starts_with('<')
}

/// The robot in the file `path`.
///
/// # Errors
/// A file that cannot be read or is not UTF-8, and those of [`completed`] and [`read`].
pub fn load(path: impl AsRef<Path>, options: &Options) -> Result<Import, Diagnostics> {
    let path = path.as_ref();
    let (text, name) = read_file(path)?;
    read(&completed(path, text)?, &name, options)
}

impl Import {
    /// The scene, built; its notices and those of the import together.
    ///
    /// # Errors
    /// Those of [`SceneDescription::build`].
    pub fn build(&self, registry: &JointRegistry) -> Result<Scene, Diagnostics> {
        let mut scene = self.scene.build(registry)?;
        scene.notices.splice(0..0, self.notices.iter().cloned());
        Ok(scene)
    }

    /// The scene as the text of a scene file, with the notices and what else the file says of the joints as comments.
    pub fn to_toml(&self) -> String {
        let mut head = Vec::new();
        if !self.notices.is_empty() {
            head.push(String::from(
                "What the robot's file says and the scene does not, or what it leaves open:",
            ));
            head.extend(self.notices.iter().map(|notice| format!("- {notice}")));
        }
        let facts = self.joints.iter().map(|joint| (&*joint.name, joint));
        let facts: HashMap<&str, &JointFacts> = facts.collect();
        self.scene.to_toml(&head, |name| {
            let own = facts.get(name);
            own.map_or_else(Vec::new, |facts| facts.lines())
        })
    }
}

fn import(
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
    let robot = Robot::read(root)?;
    if robot.links.is_empty() {
        sink.push(Diagnostic::new(tag(root), "the robot has no link"));
        return None;
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
