//! From links and joints to bodies: moving joints make bodies, fixed joints join links to one.

use super::document::{child, place, tag};
use super::joint;
use super::masses::Part;
use super::robot::Robot;
use super::tree::{self, Links, name_span};
use super::{Import, Options, Stops, lenient, mass, masses, shapes};
use crate::coupling::Tie;
use crate::description::{
    BodyDescription, InitialDescription, JointDescription, MimicDescription, SceneDescription,
    Source,
};
use crate::diagnostics::Diagnostic;
use crate::forces::{FrameDescription, JointForces, PerFreedom};
use crate::notice::Notices;
use crate::parse::WORLD;
use crate::read::Sink;
use crate::robot::JointFacts;
use crate::robot::couple::refuse_massless;
use crate::robot::mass::moved;
use crate::scene::stem;
use crate::settings::Settings;
use crate::shape::ShapeDescription;
use crate::source::{Located, Span};
use crate::text::visible_line;
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::{MassProperties, Pose};
use std::path::Path;

/// The robot as a scene.
pub(super) fn convert(
    robot: &Robot<'_, '_>,
    version: (u32, u32),
    source: Source,
    options: &Options,
    mut notices: Notices,
    sink: &mut Sink,
) -> Option<Import> {
    let errors_before = sink.len();
    let mut mimics: Vec<_> = robot.joints.iter().map(joint::mimic).collect();
    if options.lenient {
        lenient::free(robot, &mut mimics, &mut notices);
    }
    let links = tree::links(robot, &mimics, sink);
    let facts = facts(robot, version, sink);
    let links = links?;
    let errors_before_masses = sink.len();
    let mut converter = Converter::new((robot, &mimics), version, &mut notices, sink);
    converter.root(&links, options);
    for &link in links.order.iter().skip(1) {
        converter.link(link, &links, (&facts, options.limits));
    }
    let anchors = std::mem::take(&mut converter.anchors);
    let Converter {
        mut bodies,
        frames,
        parts,
        shapes,
        ..
    } = converter;
    // A mass that was refused is missing on what moves.
    let complete = sink.len() == errors_before_masses;
    let bodies_and_parts = (&mut *bodies, &*parts);
    masses::settle(robot, bodies_and_parts, options.lenient, &mut notices, sink);
    let anchored = |link: usize| anchors.get(link).copied().flatten();
    let on_body = |link: usize| anchored(link).map(|anchor| (anchor.body, anchor.pose));
    let (loops, couplings) = links.ties.placed(version, on_body, sink);
    if complete {
        let help = "give the link an <inertial>, or make the joint fixed";
        let ties = loops.iter().map(Tie::of_loop);
        let ties = ties.chain(couplings.iter().map(Tie::of_coupling));
        refuse_massless(&bodies, &ties.collect::<Vec<_>>(), ("link", help), sink);
    }
    if bodies.is_empty() && sink.len() == errors_before {
        let error = Diagnostic::new(tag(robot.links[0].node), "no joint of the robot moves");
        sink.push(error.help("with a floating base it can move as a whole"));
    }
    if sink.len() > errors_before {
        return None;
    }
    let file = Path::new(&source.name).file_name().unwrap_or_default();
    let description = format!("Imported from the URDF {}", file.to_string_lossy());
    Some(Import {
        scene: SceneDescription {
            description: visible_line(&description),
            name: robot.name.map_or_else(|| stem(&source.name), str::to_owned),
            gravity: options.gravity,
            bodies,
            loops,
            couplings,
            frames,
            shapes,
            settings: Settings::default(),
            ..SceneDescription::empty(source)
        },
        notices: notices.into_vec(),
        joints: facts,
    })
}

/// What the file says of every joint beyond its motion, checked.
fn facts(robot: &Robot<'_, '_>, version: (u32, u32), sink: &mut Sink) -> Vec<JointFacts> {
    let joints = robot.joints.iter();
    let facts: Vec<JointFacts> = joints.map(|joint| joint::facts(joint, version)).collect();
    for (facts, joint) in facts.iter().zip(&robot.joints) {
        let losses = [("damping", facts.damping), ("friction", facts.friction)];
        for (what, value) in losses.into_iter().filter(|(_, value)| *value < 0.0) {
            let message = format!(
                "joint `{}`: `{what}` is {:?}, but must be at least 0",
                facts.name,
                Number(value)
            );
            sink.push(Diagnostic::new(
                place(joint.node, "dynamics", what),
                message,
            ));
        }
    }
    facts
}

/// What the joint of a link has of its coupling.
fn coupled(link: usize, links: &Links<'_, '_>) -> joint::Coupled {
    let group = links.group(link);
    let own = group.and_then(|group| group.members.iter().find(|(own, _)| *own == link));
    joint::Coupled {
        home: group
            .is_none_or(|group| group.ties.is_empty())
            .then(|| own.map_or(0.0, |(_, law)| law.offset)),
        by_one: group.is_none_or(|group| group.is_of_one() || !group.ties.is_empty()),
    }
}

/// Where a link frame is: on which body, and its pose there.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    body: Option<usize>,
    pose: Pose<f64>,
}

struct Converter<'c, 'a, 'i> {
    robot: &'c Robot<'a, 'i>,
    /// What each joint follows.
    mimics: &'c [Option<Located<MimicDescription>>],
    version: (u32, u32),
    notices: &'c mut Notices,
    sink: &'c mut Sink,
    anchors: Vec<Option<Anchor>>,
    bodies: Vec<BodyDescription>,
    /// The links that make each body.
    parts: Vec<Vec<Part>>,
    frames: Vec<FrameDescription>,
    shapes: Vec<ShapeDescription>,
}

impl<'c, 'a, 'i> Converter<'c, 'a, 'i> {
    fn new(
        (robot, mimics): (&'c Robot<'a, 'i>, &'c [Option<Located<MimicDescription>>]),
        version: (u32, u32),
        notices: &'c mut Notices,
        sink: &'c mut Sink,
    ) -> Self {
        Self {
            anchors: vec![None; robot.links.len()],
            robot,
            mimics,
            version,
            notices,
            sink,
            bodies: Vec::new(),
            parts: Vec::new(),
            frames: Vec::new(),
            shapes: Vec::new(),
        }
    }

    /// The root link, which hangs on no joint of the file.
    fn root(&mut self, links: &Links<'_, '_>, options: &Options) {
        let Some(&root) = links.order.first() else {
            return;
        };
        if !options.floating_base {
            let anchor = Anchor {
                body: None,
                pose: Pose::identity(),
            };
            return self.attach(root, anchor);
        }
        let mut name = String::from("floating_base");
        while self.robot.joint_names.contains(&*name) {
            name.push('_');
        }
        let joint = (name, "free", name_span(self.robot.links[root].node));
        self.body(
            root,
            None,
            joint,
            [Pose::identity(); 2],
            JointForces::default(),
        );
    }

    /// A link that hangs on a joint.
    fn link(
        &mut self,
        link: usize,
        links: &Links<'_, '_>,
        (facts, stops): (&[JointFacts], Option<Stops>),
    ) {
        let Some((index, parent)) = links.parents[link] else {
            return;
        };
        let joint = self.robot.joints[index];
        let owner = format!("joint `{}`", joint.name);
        let origin = joint::origin(&owner, joint.node, self.version, self.sink);
        let axis = joint::axis(&joint, self.sink).map(Pose::from_rotation);
        let Some(parent) = self.anchors[parent] else {
            return;
        };
        // An error there must not hide those of the links below.
        let origin = parent.pose * origin.unwrap_or_else(Pose::identity);
        let axis = axis.unwrap_or_else(Pose::identity);
        let Some(kind) = joint.kind.of_library() else {
            let message = "fixed joints join links to one body, on which the link is a named frame";
            self.notices.add(message, &owner);
            if child(joint.node, "mimic").is_some() {
                self.notices
                    .add("fixed joints follow none: their mimic has no effect", owner);
            }
            let body = parent.body;
            return self.attach(link, Anchor { body, pose: origin });
        };
        let coupled = coupled(link, links);
        let stops = stops.filter(|_| coupled.by_one);
        let limit = stops.and_then(|stops| joint::stopped(&joint, &facts[index], stops));
        joint::tell(&joint, coupled, (&facts[index], &limit), self.notices);
        let damping = Some(facts[index].damping).filter(|&damping| damping != 0.0);
        let span = place(joint.node, "dynamics", "damping");
        let forces = JointForces {
            damping: damping.map(|damping| Located::new(PerFreedom::All(damping), span)),
            limit: limit.map(|limit| {
                let span = place(joint.node, "limit", "lower");
                Located::new(limit, span)
            }),
            friction: joint::friction(&joint, &facts[index])
                .filter(|_| coupled.by_one)
                .map(|friction| Located::new(friction, place(joint.node, "dynamics", "friction"))),
            ..JointForces::default()
        };
        let joint = (joint.name.to_owned(), kind, tag(joint.node));
        self.body(
            link,
            parent.body,
            joint,
            [origin * axis, axis.inverse()],
            forces,
        );
        if let (Some(body), Some(mimic)) = (self.bodies.last_mut(), self.mimics.get(index)) {
            body.mimic.clone_from(mimic);
        }
    }

    /// Begins a body with a link.
    fn body(
        &mut self,
        link: usize,
        parent: Option<usize>,
        (joint, kind, span): (String, &str, Span),
        [at, body_at]: [Pose<f64>; 2],
        forces: JointForces,
    ) {
        let body = self.bodies.len();
        self.bodies.push(BodyDescription {
            part: None,
            mimic: None,
            name: self.name(link),
            parent,
            mass: MassProperties::massless(),
            joint: JointDescription {
                name: Located::new(joint, span.clone()),
                kind: Located::new(kind.to_owned(), span.clone()),
                parameters: Vec::new(),
                coupling: None,
                span,
            },
            at,
            body_at,
            initial: InitialDescription::default(),
            forces,
        });
        self.parts.push(Vec::new());
        let anchor = Anchor {
            body: Some(body),
            pose: Pose::identity(),
        };
        self.refuse_world(link);
        self.place(link, anchor);
    }

    /// Adds a link to what is already there.
    fn attach(&mut self, link: usize, anchor: Anchor) {
        let name = self.robot.links[link].name;
        let is_world = name == WORLD && anchor.body.is_none() && anchor.pose == Pose::identity();
        if !is_world {
            self.refuse_world(link);
            self.frames.push(FrameDescription {
                name: self.name(link),
                body: anchor.body,
                at: anchor.pose,
            });
        }
        self.place(link, anchor);
    }

    /// A link that moves, or stands elsewhere, may not have the name of the world.
    fn refuse_world(&mut self, link: usize) {
        if self.robot.links[link].name != WORLD {
            return;
        }
        let is_root = self.anchors.iter().all(Option::is_none);
        let why = match is_root {
            true => "it is the root of the robot, and the base is to float",
            false => "it is not the root of the robot",
        };
        let message = format!("link `{WORLD}` cannot be the inertial frame: {why}");
        let error = Diagnostic::new(self.name(link).span, message);
        self.sink.push(error.help(format!(
            "`{WORLD}` is the inertial frame: give the link another name"
        )));
    }

    /// Notes where a link is, and gives its mass and its shapes to that body.
    fn place(&mut self, link: usize, anchor: Anchor) {
        self.anchors[link] = Some(anchor);
        let (node, owner) = (self.robot.links[link].node, self.owner(link));
        let Anchor { body, pose } = anchor;
        let materials = &self.robot.materials;
        let shapes = shapes::of_link(node, &owner, materials, (body, &pose), self.notices);
        self.shapes.extend(shapes);
        let Some(mass) = self.mass(link) else { return };
        match anchor.body {
            Some(body) => self.parts[body].push(Part {
                link,
                mass: moved(&mass, &anchor.pose),
            }),
            None => self.notices.add(
                "links fixed to the world do not move: their masses have no effect",
                self.owner(link),
            ),
        }
    }

    /// Mass properties in link axes; `None` without an `<inertial>` and with one that is refused.
    fn mass(&mut self, link: usize) -> Option<MassProperties> {
        let inertial = self.robot.links[link].inertial()?;
        let owner = self.owner(link);
        let origin = joint::origin(&owner, inertial, self.version, self.sink)?;
        let mass = mass::of_inertial(inertial)?;
        if mass.mass < 0.0 {
            let message = format!(
                "{owner}: mass is {:?} kg: it must be at least 0",
                Number(mass.mass)
            );
            let place = place(inertial, "mass", "value");
            self.sink.push(Diagnostic::new(place, message));
            return None;
        }
        Some(moved(&mass, &origin))
    }

    fn owner(&self, link: usize) -> String {
        format!("link `{}`", self.robot.links[link].name)
    }

    fn name(&self, link: usize) -> Located<String> {
        let link = self.robot.links[link];
        Located::new(link.name.to_owned(), name_span(link.node))
    }
}
