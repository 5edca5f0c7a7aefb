//! A scene ready to simulate, and the ways to one.

use crate::build;
use crate::control::Control;
use crate::description::{
    BodyDescription, CouplingDescription, JointDescription, LoopDescription, SceneDescription,
    Source,
};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::event::{EventDescription, SceneEvent};
use crate::notice::{Notice, Notices};
use crate::parse::{self, BodyDraft, Draft, Tree};
use crate::read::Sink;
use crate::robot;
use crate::settings::Settings;
use crate::shape::ShapeDescription;
use crate::text;
use hamel_integrate::State;
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::registry::JointRegistry;
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

/// The text of a file, and what messages call it.
///
/// # Errors
/// A file that cannot be read, is not UTF-8 or holds nothing.
pub fn read_file(path: &Path) -> Result<(String, String), Diagnostics> {
    let (bytes, name) = read_bytes(path)?;
    let text = text::from_utf8(bytes)
        .map_err(|reason| refuse(&name, format!("cannot read {name}: {reason}")))?;
    // One error, not one for each thing that it lacks: such a file is one that is being written, or was not written to its end.
    match text.trim().is_empty() {
        true => Err(refuse(&name, format!("{name} is empty"))),
        false => Ok((text, name)),
    }
}

/// The bytes of a file, and what messages call it.
pub(crate) fn read_bytes(path: &Path) -> Result<(Vec<u8>, String), Diagnostics> {
    let name = path.display().to_string();
    match limited(path) {
        Ok(bytes) => Ok((bytes, name)),
        Err(error) => Err(refuse(&name, format!("cannot read {name}: {error}"))),
    }
}

fn refuse(name: &str, message: String) -> Diagnostics {
    Diagnostics::new(name, "", vec![Diagnostic::without_place(message)])
}

/// The bytes of a file that is not larger than any scene or robot: devices have no end.
fn limited(path: &Path) -> io::Result<Vec<u8>> {
    let file = File::open(path)?;
    // Room for all of it, so that it is read at once: who saves it meanwhile is less likely to be met half way.
    let size = file.metadata()?.len().min(LARGEST_FILE);
    let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or(0) + 1);
    file.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
    match bytes.len() as u64 > LARGEST_FILE {
        true => Err(io::Error::other(format!(
            "it is larger than {} MiB",
            LARGEST_FILE >> 20
        ))),
        false => Ok(bytes),
    }
}

/// The largest file that is read, in bytes: a million bodies take less than half of it.
const LARGEST_FILE: u64 = 512 << 20;

/// What is said of a scene that cannot be read, should no error say more.
const INCOMPLETE: &str = "the scene is not complete";

/// A mechanism with its state at time 0 and its simulation settings.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the scene.
    pub name: String,
    /// What the scene shows; may be empty.
    pub description: String,
    /// The mechanism, with its named frames. Its bodies stand in the order of the file, except that parents come first and that those of a joint follow each other.
    pub mechanism: Arc<Mechanism>,
    /// Configurations Q of all joints at time 0, one joint after the other.
    pub configuration: Vec<f64>,
    /// Speeds v̄ of all joints at time 0, one joint after the other.
    pub speeds: Vec<f64>,
    /// What is to be noticed on the way.
    pub events: Vec<SceneEvent>,
    /// What stands for bodies in pictures.
    pub shapes: Vec<ShapeDescription>,
    /// What controls the mechanism, if anything does.
    pub control: Option<Control>,
    /// Simulation settings.
    pub settings: Settings,
    /// What the scene says and the simulation leaves out.
    pub notices: Vec<Notice>,
}

impl Scene {
    /// The state at time 0, where an integration begins.
    pub fn start(&self) -> State {
        State {
            time: 0.0,
            configuration: self.configuration.clone(),
            speeds: self.speeds.clone(),
        }
    }

    /// What the text of a scene file says by itself, joints not yet looked up. Messages call the text `source_name`; a scene
    /// without a name takes that of the file.
    ///
    /// # Errors
    /// All mistakes of the text that show without knowing the joints.
    pub fn from_toml(text: &str, source_name: &str) -> Result<SceneDescription, Diagnostics> {
        let mut sink = Sink::default();
        let draft = parse::draft(text, &mut sink);
        let source = Source {
            name: source_name.to_owned(),
            text: text.to_owned(),
        };
        describe(draft, sink, source)
    }

    /// A scene from its text: [`Scene::from_toml`] and [`SceneDescription::build`] in one.
    ///
    /// # Errors
    /// All mistakes of the text, those about joints among them.
    pub fn parse(
        text: &str,
        source_name: &str,
        registry: &JointRegistry,
    ) -> Result<Self, Diagnostics> {
        let mut sink = Sink::default();
        let draft = parse::draft(text, &mut sink);
        if sink.len() > 0 {
            if let Some(draft) = &draft {
                check_joints(draft, registry, &mut sink);
            }
            return Err(sink.refuse(source_name, text, INCOMPLETE));
        }
        let source = Source {
            name: source_name.to_owned(),
            text: text.to_owned(),
        };
        describe(draft, sink, source)?.build(registry)
    }

    /// The scene in the file `path`, or the robot in it ([`robot::is_robot`]): on a fixed base, at home and at rest.
    ///
    /// # Errors
    /// A file that cannot be read or is not UTF-8, and all mistakes of its text.
    pub fn load(path: impl AsRef<Path>, registry: &JointRegistry) -> Result<Self, Diagnostics> {
        let path = path.as_ref();
        let (text, name) = read_file(path)?;
        if robot::is_robot(path, &text) {
            let text = robot::completed(path, text)?;
            return robot::read(&text, &name, &robot::Options::default())?.build(registry);
        }
        Self::parse(&text, &name, registry)
    }
}

impl SceneDescription {
    /// Looks the joints up in `registry`, solves for their state at time 0, and puts the mechanism together.
    ///
    /// # Errors
    /// Unknown joint types or parameters, initial states that a joint cannot take, and whatever the mechanism refuses; all
    /// at once.
    pub fn build(&self, registry: &JointRegistry) -> Result<Scene, Diagnostics> {
        let mut notices = Notices::default();
        let coupled = self.coupled_with(&mut notices)?;
        let mut sink = Sink::default();
        let states = build::states(&coupled.bodies, registry, &mut sink);
        let scene = states.and_then(|states| build::scene(&coupled, states, &mut sink));
        let scene = scene.map(|scene| Scene {
            notices: notices.into_vec(),
            ..scene
        });
        scene.ok_or_else(|| {
            let joints = coupled.bodies.iter().filter(|body| body.leads());
            check_events(
                &coupled.events,
                joints.map(|body| &body.joint),
                registry,
                &mut sink,
            );
            self.refuse(sink)
        })
    }

    pub(crate) fn refuse(&self, sink: Sink) -> Diagnostics {
        sink.refuse(&self.source.name, &self.source.text, INCOMPLETE)
    }
}

/// Looks for errors about joints where other errors have been found already.
fn check_joints(draft: &Draft, registry: &JointRegistry, sink: &mut Sink) {
    for body in draft.bodies.iter().filter(|body| body.leads()) {
        if let Some(joint) = &body.joint {
            let initial = body.initial.clone().unwrap_or_default();
            let forces = body.forces.clone().unwrap_or_default();
            build::state(joint, &initial, &forces, registry, sink);
        }
    }
    // Couplings and loops make one joint of several, whose names are known when they are made.
    let is_coupled = draft.bodies.iter().any(|body| body.mimic.is_some()) || !draft.ties.is_empty();
    if !is_coupled {
        let joints = draft.bodies.iter().filter(|body| body.leads());
        let joints = joints.filter_map(|body| body.joint.as_ref());
        check_events(&draft.elements.events, joints, registry, sink);
    }
}

/// Looks for events of what their joints do not have; of joints that cannot be built nothing is said here.
fn check_events<'a>(
    events: &[EventDescription],
    joints: impl Iterator<Item = &'a JointDescription>,
    registry: &JointRegistry,
    sink: &mut Sink,
) {
    let joints: HashMap<&str, &JointDescription> = joints
        .map(|joint| (joint.name.value.as_str(), joint))
        .collect();
    let built = |name: &str| {
        let joint = joints.get(name)?;
        build::joint(joint, registry, &mut Sink::default())
    };
    build::check_events(events, built, sink);
}

/// The description that a draft without errors makes.
fn describe(
    draft: Option<Draft>,
    sink: Sink,
    source: Source,
) -> Result<SceneDescription, Diagnostics> {
    let complete = draft.and_then(complete);
    match complete {
        Some((draft, bodies, (loops, couplings))) if sink.len() == 0 => Ok(SceneDescription {
            name: draft.name.unwrap_or_else(|| stem(&source.name)),
            description: draft.description,
            gravity: draft.gravity,
            bodies,
            loops,
            couplings,
            frames: draft.elements.frames,
            springs: draft.elements.springs,
            wrenches: draft.elements.wrenches,
            constraints: draft.elements.constraints,
            events: draft.elements.events,
            shapes: draft.elements.shapes,
            controller: draft.controller,
            settings: draft.settings,
            ..SceneDescription::empty(source)
        }),
        _ => Err(sink.refuse(&source.name, &source.text, INCOMPLETE)),
    }
}

/// Name of a file without folder and ending.
pub(crate) fn stem(source_name: &str) -> String {
    let stem = Path::new(source_name).file_stem();
    let stem = stem.map_or_else(|| source_name.into(), |stem| stem.to_string_lossy());
    text::visible_line(&stem)
}

type Ties = (Vec<LoopDescription>, Vec<CouplingDescription>);

/// The bodies in the order of the tree; `None` if a part of one could not be read.
fn complete(mut draft: Draft) -> Option<(Draft, Vec<BodyDescription>, Ties)> {
    let Tree { order, parents, .. } = draft.tree.take()?;
    let mut rank = vec![0; order.len()];
    order
        .iter()
        .enumerate()
        .for_each(|(own, &place)| rank[place] = own);
    let ties = std::mem::take(&mut draft.ties).ranked(|place| rank[place]);
    let mut drafts: Vec<Option<BodyDraft>> = draft.bodies.drain(..).map(Some).collect();
    let bodies = order.iter().zip(parents).map(|(&place, parent)| {
        let body = drafts.get_mut(place)?.take()?;
        Some(BodyDescription {
            name: body.name?,
            parent,
            mass: body.mass?,
            joint: body.joint?,
            part: body.part,
            at: body.at,
            body_at: body.body_at,
            initial: body.initial?,
            forces: body.forces?,
            mimic: body.mimic,
        })
    });
    let bodies: Option<Vec<_>> = bodies.collect();
    Some((draft, bodies?, ties))
}
