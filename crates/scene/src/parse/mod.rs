//! From the text of a scene file to its parts. Errors are noted and reading goes on, so that one run finds them all.

mod body;
mod controller;
mod elastic;
mod elements;
mod event;
mod forces;
mod initial;
mod joint;
mod mass;
mod placement;
pub(crate) mod rotation;
mod shape;
mod simulation;
mod syntax;
mod ties;
mod time;
mod tree;

pub(crate) use body::WORLD;
pub(crate) use ties::{TieDrafts, no_ratio};
pub(crate) use tree::{cycles, order};

use crate::control::ControllerDescription;
use crate::coupling::{Group, Movement, Node};
use crate::description::{InitialDescription, JointDescription, MimicDescription, Part};
use crate::diagnostics::Diagnostic;
use crate::forces::JointForces;
use crate::kind;
use crate::read::{Fields, Sink};
use crate::settings::Settings;
use crate::source::Located;
pub(crate) use controller::Joints;
use elastic::Elastic;
use elements::Elements;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::Vector3;
use std::collections::HashSet;
use toml::Spanned;
use toml::de::DeTable;

/// Version of the scene format.
const VERSION: u64 = 1;

/// What could be read of a scene. Whatever could not has its error in the sink.
#[derive(Debug)]
pub(crate) struct Draft {
    pub(crate) name: Option<String>,
    pub(crate) description: String,
    pub(crate) gravity: Vector3<f64>,
    pub(crate) bodies: Vec<BodyDraft>,
    /// Order in which every body follows its parent, and the parents; `None` if there is no such order.
    pub(crate) tree: Option<Tree>,
    /// Loops and couplings, with bodies as places in the file.
    pub(crate) ties: TieDrafts,
    pub(crate) elements: Elements,
    pub(crate) controller: Option<ControllerDescription>,
    pub(crate) settings: Settings,
}

/// What could be read of a body.
#[derive(Debug)]
pub(crate) struct BodyDraft {
    pub(crate) name: Option<Located<String>>,
    pub(crate) parent: Option<Located<String>>,
    pub(crate) mass: Option<MassProperties>,
    pub(crate) joint: Option<JointDescription>,
    /// Which body of its joint it is, where the joint carries several.
    pub(crate) part: Option<Part>,
    pub(crate) at: Pose<f64>,
    pub(crate) body_at: Pose<f64>,
    pub(crate) initial: Option<InitialDescription>,
    pub(crate) forces: Option<JointForces>,
    /// The motor behind a spring, until the body is made two.
    pub(crate) elastic: Option<Located<Elastic>>,
    /// The motor that it has become two with.
    pub(crate) motor: Option<String>,
    /// What its joint follows.
    pub(crate) mimic: Option<Located<MimicDescription>>,
}

impl BodyDraft {
    /// Whether it is the only body of its joint, or the first.
    pub(crate) fn leads(&self) -> bool {
        self.part.as_ref().is_none_or(|part| part.number == 0)
    }

    /// As couplings look at it, with its parent as a place in the file.
    fn node(&self, parent: Option<usize>) -> Node<'_> {
        let joint = self.joint.as_ref();
        let kind = joint.map_or("", |joint| &joint.kind.value);
        Node {
            joint: joint.map(|joint| &joint.name),
            parent,
            movement: match self.part {
                None => Movement::of(kind),
                Some(_) => Movement::Other(kind),
            },
            mimic: self.mimic.as_ref(),
            motor: self.motor.as_deref(),
        }
    }
}

/// The bodies as a tree.
#[derive(Debug)]
pub(crate) struct Tree {
    /// Places in the file, parents first.
    pub(crate) order: Vec<usize>,
    /// Parent of each body of `order`, as a place in `order`.
    pub(crate) parents: Vec<Option<usize>>,
    /// The bodies, as places in the file, that mimic joints couple.
    pub(crate) groups: Vec<Group>,
}

/// Reads a scene. With syntax errors in it the text is not read further: what they swallow would mislead.
pub(crate) fn draft(text: &str, sink: &mut Sink) -> Option<Draft> {
    if text.trim_start().starts_with('<') {
        let start = text.len() - text.trim_start().len();
        let error = Diagnostic::new(start..start + 1, "not valid TOML: this is XML");
        sink.push(error.help("a robot in URDF is a file whose name ends in `.urdf`"));
        return None;
    }
    let root = table(text, sink)?;
    let mut fields = Fields::new(String::new(), 0..0, root.get_ref());
    Some(scene(&mut fields, sink)).inspect(|_| fields.finish(sink))
}

/// The keys of a file. Where there are none, that is the one error: such a file is one that is being written, or was not written to its end.
fn table<'a>(text: &'a str, sink: &mut Sink) -> Option<Spanned<DeTable<'a>>> {
    let (root, errors) = DeTable::parse_recoverable(text);
    if !errors.is_empty() {
        match kind::no_scene(text) {
            Some(error) => sink.push(error),
            None => syntax::report(text, &errors, sink),
        }
        return None;
    }
    if root.get_ref().is_empty() {
        let error = Diagnostic::new(0..0, "the file holds nothing but comments");
        sink.push(error.help(format!("begin it with `hamel = {VERSION}`")));
        return None;
    }
    Some(root)
}

/// The joints of bodies, a coupling as one; `None` where some could not be read, which may be the ones that are spoken of.
fn joints(bodies: &[BodyDraft], groups: &[Group]) -> Option<Vec<String>> {
    let coupled = groups.iter().flat_map(|group| &group.members);
    let coupled: HashSet<usize> = coupled.map(|(place, _)| *place).collect();
    let own = bodies.iter().enumerate();
    let own = own.filter(|(place, body)| body.leads() && !coupled.contains(place));
    let name = |body: &BodyDraft| Some(body.joint.as_ref()?.name.value.clone());
    let mut names: Vec<String> = own.map(|(_, body)| name(body)).collect::<Option<_>>()?;
    let joined = groups.iter();
    names.extend(joined.map(|group| group.name(|place| name(&bodies[place]).unwrap_or_default())));
    Some(names)
}

/// Reads a file that holds a controller and nothing else.
pub(crate) fn controller(
    text: &str,
    joints: &Joints<'_>,
    sink: &mut Sink,
) -> Option<ControllerDescription> {
    let root = table(text, sink)?;
    let mut fields = Fields::new(String::new(), 0..0, root.get_ref());
    version(&mut fields, sink);
    let found = controller::controller(&mut fields, Some(joints), sink);
    if found.is_none() && sink.len() == 0 {
        let error = Diagnostic::new(0..0, "the file has no controller");
        sink.push(error.help("a controller is a table that begins with `[controller]`"));
    }
    fields.finish(sink);
    found
}

fn scene(fields: &mut Fields<'_>, sink: &mut Sink) -> Draft {
    version(fields, sink);
    let name = fields.optional("name").and_then(|name| name.text(sink));
    let description = fields.optional("description");
    let gravity = gravity(fields, sink);
    let bodies = elastic::expand(bodies(fields, sink), sink);
    let mut ties = ties::ties(fields, sink);
    let tree = tree::tree(&bodies, &mut ties, sink);
    let groups = tree.as_ref().map_or(&[][..], |tree| &tree.groups);
    let names = joints(&bodies, groups);
    let names = names.as_ref().map(|names| names.iter().map(String::as_str));
    let joints: Option<Joints<'_>> = names.map(Iterator::collect);
    let elements = elements::elements(fields, (&bodies, joints.as_ref()), tree.as_ref(), sink);
    let controller = controller::controller(fields, joints.as_ref(), sink);
    Draft {
        name: name.map(|name| name.value),
        description: description
            .and_then(|text| text.prose(sink))
            .map_or_else(String::new, |text| text.value),
        gravity: gravity.unwrap_or_else(Vector3::zeros),
        tree,
        ties,
        elements,
        controller,
        bodies,
        settings: simulation::settings(fields, sink),
    }
}

fn version(fields: &mut Fields<'_>, sink: &mut Sink) {
    let Some(version) = fields.optional("hamel") else {
        let error = Diagnostic::new(fields.span(), "the version of the format is missing");
        sink.push(error.help(format!("begin the file with `hamel = {VERSION}`")));
        return;
    };
    let Some(version) = version.count(sink) else {
        return;
    };
    if version.value != VERSION {
        let message = format!(
            "`hamel` is {}, but this program reads version {VERSION} of the scene format",
            version.value
        );
        let error = Diagnostic::new(version.span, message);
        sink.push(error.help("a file of a later version is read by a later program"));
    }
}

fn gravity(fields: &mut Fields<'_>, sink: &mut Sink) -> Option<Vector3<f64>> {
    let Some(gravity) = fields.optional("gravity") else {
        let error = Diagnostic::new(fields.span(), "`gravity` is missing");
        sink.push(error.help("it is a vector in world axes, m/s²: `gravity = [0.0, 0.0, -9.81]`"));
        return None;
    };
    Some(gravity.vector(sink)?.value)
}

fn bodies(fields: &mut Fields<'_>, sink: &mut Sink) -> Vec<BodyDraft> {
    let Some(value) = fields.optional("body") else {
        let error = Diagnostic::new(fields.span(), "the scene has no body");
        sink.push(error.help("a body is a table that begins with `[[body]]`"));
        return Vec::new();
    };
    let tables = value.tables(sink).unwrap_or_default();
    let tables = tables.into_iter().enumerate();
    tables
        .flat_map(|(index, (span, table))| {
            let fields = Fields::new(format!("body {}: ", index + 1), span, table);
            body::bodies(fields, sink)
        })
        .collect()
}
