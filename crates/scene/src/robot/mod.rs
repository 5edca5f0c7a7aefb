//! Robots in the formats of others: [URDF](crate::urdf), [MJCF](crate::mjcf) and [SDF](crate::sdf), read to the same description as a scene file.
//!
//! What is XML is a robot, and its root element tells the format. [`completed`] brings in what stands in other files, [`read`] reads the text.

pub(crate) mod couple;
mod facts;
pub(crate) mod mass;
mod posture;
pub mod srdf;
pub(crate) mod xml;

pub use facts::{JointFacts, Limits};

use crate::description::{SceneDescription, Source};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::notice::Notice;
use crate::read::Sink;
use crate::scene::{Scene, read_file};
use crate::{mjcf, sdf, urdf};
use hamel_runtime::registry::JointRegistry;
use nalgebra::Vector3;
use roxmltree::Document;
use std::collections::HashMap;
use std::path::Path;

/// What the file of a robot does not say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Whether the root link of a URDF moves freely; otherwise it is fixed to the world.
    pub floating_base: bool,
    /// Acceleration of free fall, world axes, m/s²; an MJCF and a world in SDF say their own.
    pub gravity: Vector3<f64>,
    /// Whether a URDF is read although no rigid body has its masses: such an inertia becomes that of a ball with the mean of its principal moments, joints that move
    /// nothing with mass are fixed, and joints that mimic one that is not there move by themselves. Each is reported by a warning. An MJCF says itself what becomes of its masses (`balanceinertia`, `boundmass`, `boundinertia`).
    pub lenient: bool,
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
            lenient: false,
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
    /// What is not simulated, and what the format leaves open.
    pub notices: Vec<Notice>,
    /// What the file says of each joint beyond its motion, in the order of the file.
    pub joints: Vec<JointFacts>,
}

/// The robot that a text describes, in URDF, MJCF or SDF, which its root element says. Messages call the text `source_name`.
///
/// # Errors
/// Numbers of limits that are negative or not finite. All mistakes of the text: XML that is not well-formed, or in another format (xacro is named in the message); missing or malformed elements and attributes; links and joints that
/// make no tree; mass properties that no body can have; a body without mass at the end of a moving joint. A floating base and leniency for a robot in MJCF or SDF, which say themselves what is free.
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
    let import = xml::tree(text, &mut sink).and_then(|document| {
        let source = Source {
            name: source_name.to_owned(),
            text: text.to_owned(),
        };
        match document.root_element().tag_name().name() {
            MJCF => mjcf::import(&document, source, options, &mut sink),
            "sdf" => sdf::import(&document, source, options, &mut sink),
            _ => urdf::import(&document, source, options, &mut sink),
        }
    });
    match import {
        Some(import) if sink.len() == 0 => Ok(import),
        _ => Err(sink.refuse(source_name, text, "the robot cannot be read")),
    }
}

/// The root element of MJCF.
const MJCF: &str = "mujoco";

/// Whether the root element is that of MJCF.
fn is_mjcf(document: &Document<'_>) -> bool {
    document.root_element().has_tag_name(MJCF)
}

/// Whether a file holds a robot rather than a scene: what is XML is read as one, whatever the file's ending, and so is what ends in `.urdf`.
///
/// No scene begins as XML does; other formats than URDF, MJCF and SDF do, and [`read`] names them.
pub fn is_robot(path: &Path, text: &str) -> bool {
    let is_before_xml = |c: char| c.is_whitespace() || c == '\u{feff}';
    let ending = path.extension().unwrap_or_default();
    ending.eq_ignore_ascii_case("urdf") || text.trim_start_matches(is_before_xml).starts_with('<')
}

/// The text of the file `path` with what other files say of its robot: the files that an MJCF includes, and what its meshes weigh; the loops of a URDF ([`urdf::with_loops`]).
///
/// # Errors
/// Files that cannot be read or do not belong to the robot.
pub fn completed(path: &Path, text: String) -> Result<String, Diagnostics> {
    let may_be = text.contains("<mujoco");
    let document = may_be.then(|| Document::parse(&text).ok()).flatten();
    match document.is_some_and(|document| is_mjcf(&document)) {
        true => mjcf::with_files(path, text),
        false => urdf::with_loops(path, text),
    }
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
