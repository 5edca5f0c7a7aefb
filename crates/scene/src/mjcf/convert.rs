//! From the bodies of a model to those of a scene: each joint makes one, bodies without joints are parts of others.

use super::chain;
use super::equality::Followers;
use super::geom::Geom;
use super::joint::Movement;
use super::names::Names;
use super::settings::Settings;
use super::tree::Body;
use crate::coupling::Tie;
use crate::description::{BodyDescription, JointDescription, SceneDescription, Source};
use crate::diagnostics::Diagnostic;
use crate::forces::{FrameDescription, PointSpring, WrenchAxes, WrenchDescription};
use crate::notice::Notices;
use crate::read::Sink;
use crate::robot::mass::{moved, sum};
use crate::robot::xml::tag;
use crate::robot::{Import, JointFacts, Stops, couple};
use crate::scene::stem;
use crate::shape::ShapeDescription;
use crate::source::Located;
use crate::text::visible_line;
use hamel_runtime::spatial::{MassProperties, Pose};
use hamel_runtime::time_function::TimeFunction;
use nalgebra::Vector3;
use roxmltree::Node;
use std::path::Path;

/// A model, read.
pub(super) struct Model<'m, 'a> {
    pub(super) root: Node<'a, 'a>,
    /// The bodies, the world first.
    pub(super) bodies: &'m [Body<'a>],
    /// Their masses in their frames.
    pub(super) masses: &'m [MassProperties],
    /// The joints that follow others.
    pub(super) mimics: Followers,
    pub(super) settings: &'m Settings,
}

/// Where the frame of a body is: on which body of the scene, and its pose there.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    body: Option<usize>,
    pose: Pose<f64>,
}

/// What a scene is made of.
pub(super) struct Converter<'c, 'a> {
    model: &'c Model<'c, 'a>,
    pub(super) notices: &'c mut Notices,
    names: Names,
    anchors: Vec<Anchor>,
    pub(super) bodies: Vec<BodyDescription>,
    /// What each body weighs.
    parts: Vec<Vec<MassProperties>>,
    frames: Vec<FrameDescription>,
    shapes: Vec<ShapeDescription>,
    pub(super) springs: Vec<PointSpring>,
    wrenches: Vec<WrenchDescription>,
    facts: Vec<JointFacts>,
}

/// The model as a scene.
pub(super) fn convert(
    model: &Model<'_, '_>,
    source: Source,
    stops: Option<Stops>,
    mut notices: Notices,
    sink: &mut Sink,
) -> Option<Import> {
    if sink.len() > 0 {
        return None;
    }
    let mut converter = Converter {
        model,
        notices: &mut notices,
        names: Names::of(model.bodies),
        anchors: Vec::new(),
        bodies: Vec::new(),
        parts: Vec::new(),
        frames: Vec::new(),
        shapes: Vec::new(),
        springs: Vec::new(),
        wrenches: Vec::new(),
        facts: Vec::new(),
    };
    for place in 0..model.bodies.len() {
        converter.body(place, stops);
    }
    let file = Path::new(&source.name).file_name().unwrap_or_default();
    let description = format!("Imported from the MJCF {}", file.to_string_lossy());
    let name = model.root.attribute("model");
    let mut scene = SceneDescription {
        description: visible_line(&description),
        name: name.map_or_else(|| stem(&source.name), str::to_owned),
        gravity: model.settings.gravity,
        ..SceneDescription::empty(source)
    };
    let facts = converter.finish(&mut scene);
    if scene.bodies.is_empty() {
        let error = Diagnostic::new(tag(model.root), "no joint of the robot moves");
        sink.push(error.help("with a <freejoint/> a body can move as a whole"));
    }
    couple::couple(&mut scene, &mut notices, sink);
    let help = "give the body an <inertial> or a geom with mass, or take the joint away";
    let ties: Vec<Tie<'_>> = scene.loops.iter().map(Tie::of_loop).collect();
    couple::refuse_massless(&scene.bodies, &ties, ("body", help), sink);
    (sink.len() == 0).then(|| Import {
        scene,
        notices: notices.into_vec(),
        joints: facts,
    })
}

impl Converter<'_, '_> {
    /// A body of the model, whose parent has been read before.
    fn body(&mut self, place: usize, stops: Option<Stops>) {
        let body = &self.model.bodies[place];
        let parent = match body.parent {
            Some(parent) => self.anchors[parent],
            None => Anchor {
                body: None,
                pose: Pose::identity(),
            },
        };
        let stands = Anchor {
            body: parent.body,
            pose: parent.pose * body.pose,
        };
        let anchor = match body.joints.is_empty() {
            true => self.fixed(body, stands),
            false => self.moving(place, stands, stops),
        };
        self.anchors.push(anchor);
        self.fill(place, anchor);
    }

    /// A body without joints is a frame on another.
    fn fixed(&mut self, body: &Body<'_>, anchor: Anchor) -> Anchor {
        if let Some(name) = &body.name {
            self.frames.push(FrameDescription {
                name: name.clone(),
                body: anchor.body,
                at: anchor.pose,
            });
        }
        anchor
    }

    /// A body on its joints, one after the other.
    fn moving(&mut self, place: usize, stands: Anchor, stops: Option<Stops>) -> Anchor {
        let body = &self.model.bodies[place];
        let span = body.node.map_or(0..0, tag);
        let own = match &body.name {
            Some(name) => name.clone(),
            None => Located::new(self.names.body(format!("body_{place}")), span),
        };
        let count = body.joints.len();
        let mut before = stands;
        for (number, joint) in body.joints.iter().enumerate() {
            let name = joint.element.name().map(|name| name.value);
            let name = name.unwrap_or_else(|| {
                let wanted = match count {
                    1 => own.value.clone(),
                    _ => format!("{}_{}", own.value, number + 1),
                };
                self.names.joint(wanted)
            });
            let free = joint.movement == Movement::Free;
            let ([at, body_at], parent) = match free {
                // Its coordinates are its pose in the world.
                true => ([Pose::identity(); 2], None),
                false => {
                    let [at, body_at] = joint.frames();
                    ([before.pose * at, body_at], before.body)
                }
            };
            let mimic = self.model.mimics.get(&(place, number)).cloned();
            let forces = self.forces(joint, &before.pose, stops);
            self.tell(&name, joint, stops);
            self.facts.push(chain::facts(&name, joint));
            let follows = mimic.is_some();
            self.bodies.push(BodyDescription {
                name: match number + 1 == count {
                    true => own.clone(),
                    false => Located::new(self.names.body(format!("{name}_link")), joint.span()),
                },
                parent,
                mass: MassProperties::massless(),
                joint: JointDescription {
                    name: Located::new(name, joint.span()),
                    kind: Located::new(joint.movement.kind().to_owned(), joint.span()),
                    parameters: Vec::new(),
                    coupling: None,
                    span: joint.span(),
                },
                part: None,
                at,
                body_at,
                initial: match follows {
                    true => Default::default(),
                    false => chain::initial(joint, &before.pose),
                },
                forces,
                mimic,
            });
            self.parts.push(Vec::new());
            before = Anchor {
                body: Some(self.bodies.len() - 1),
                pose: Pose::identity(),
            };
        }
        before
    }

    /// Gives what stands in a body to that of the scene.
    fn fill(&mut self, place: usize, anchor: Anchor) {
        let body = &self.model.bodies[place];
        let mass = moved(&self.model.masses[place], &anchor.pose);
        if let Some(carrier) = anchor.body {
            self.parts[carrier].push(mass);
            let lift = -self.model.settings.gravity * (mass.mass * body.gravcomp);
            if lift != Vector3::zeros() {
                self.wrenches.push(WrenchDescription {
                    body: carrier,
                    point: mass.com,
                    force: <[f64; 3]>::from(lift).map(TimeFunction::from),
                    moment: [0.0; 3].map(TimeFunction::from),
                    axes: WrenchAxes::World,
                });
            }
        }
        for geom in &body.geoms {
            self.shape(geom, anchor);
        }
        for (name, pose) in &body.sites {
            let wanted = match self.names.has_body(&name.value) {
                true => format!("{}_site", name.value),
                false => name.value.clone(),
            };
            let own = self.names.body(wanted);
            if own != name.value {
                let message =
                    "a body has the name of a site, whose frame is called with `_site` after it";
                self.notices.add(message, format!("site `{}`", name.value));
            }
            self.frames.push(FrameDescription {
                name: Located::new(own, name.span.clone()),
                body: anchor.body,
                at: anchor.pose * *pose,
            });
        }
    }

    fn shape(&mut self, geom: &Geom, anchor: Anchor) {
        match geom.shape() {
            Ok(geometry) => self.shapes.push(ShapeDescription {
                body: anchor.body,
                at: anchor.pose * geom.pose,
                geometry,
                color: geom.color(),
            }),
            Err(Some(why)) => self.notices.add(why, geom.owner.clone()),
            Err(None) => {}
        }
    }

    /// Fills the scene.
    fn finish(self, scene: &mut SceneDescription) -> Vec<JointFacts> {
        scene.bodies = self.bodies;
        for (body, parts) in scene.bodies.iter_mut().zip(&self.parts) {
            body.mass = sum(parts);
        }
        scene.frames = self.frames;
        scene.shapes = self.shapes;
        scene.springs = self.springs;
        scene.wrenches = self.wrenches;
        self.facts
    }
}
