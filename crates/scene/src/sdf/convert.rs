//! From links and joints to bodies: moving joints make bodies, fixed joints join links to one, and joints beyond a tree close loops.

use super::content::{Content, Kind, WORLD};
use super::document::{child, flag, number};
use super::joint::{Joint, JointType};
use super::poses::Poses;
use super::tree::{self, Hangs};
use super::{mass, shapes};
use crate::description::{
    BodyDescription, InitialDescription, JointDescription, LoopDescription, LoopEnd, Motion,
    Position, SceneDescription,
};
use crate::diagnostics::Diagnostic;
use crate::forces::{FrameDescription, JointForces, WrenchAxes, WrenchDescription};
use crate::notice::Notices;
use crate::parse::order;
use crate::read::Sink;
use crate::robot::mass::{moved, sum};
use crate::robot::xml::tag;
use crate::robot::{JointFacts, Stops};
use crate::source::{Located, Span};
use hamel_runtime::spatial::{MassProperties, Pose};
use hamel_runtime::time_function::TimeFunction;
use nalgebra::{Matrix3, Vector3};
use std::collections::HashSet;

/// What is read of a file.
#[derive(Clone, Copy)]
pub(super) struct Model<'m, 'a, 'i> {
    pub(super) content: &'m Content<'a, 'i>,
    pub(super) poses: &'m Poses,
    pub(super) joints: &'m [Joint<'a, 'i>],
    pub(super) gravity: Vector3<f64>,
    pub(super) stops: Option<Stops>,
}

/// Where the frame of a link is: on which body of the scene, and its pose there.
#[derive(Clone, Copy, Debug)]
struct Anchor {
    body: Option<usize>,
    pose: Pose<f64>,
}

impl Anchor {
    /// The frame of the world itself.
    fn of_world() -> Self {
        Self {
            body: None,
            pose: Pose::identity(),
        }
    }
}

/// The scene is filled with what the model holds.
pub(super) fn fill(
    model: Model<'_, '_, '_>,
    scene: &mut SceneDescription,
    notices: &mut Notices,
    sink: &mut Sink,
) -> Vec<JointFacts> {
    let hangs_on = tree::hangs_on(model.content, model.joints);
    let parents = hangs_on.iter().map(|hangs| {
        let Hangs { joint, reversed } = (*hangs)?;
        model.joints[joint].ends[usize::from(reversed)]
    });
    let parents: Vec<Option<usize>> = parents.collect();
    let order = order(&parents);
    let mut converter = Converter {
        model,
        scene,
        notices,
        sink,
        anchors: vec![None; model.content.entities.len()],
        parts: Vec::new(),
        facts: Vec::new(),
        taken: model.content.all_names(),
    };
    let is_link = |own: &usize| model.content.entities[*own].kind == Kind::Link;
    for link in order.into_iter().filter(is_link) {
        match hangs_on[link] {
            Some(hangs) => converter.hang(link, &model.joints[hangs.joint], hangs.reversed),
            None => converter.stand(link),
        }
    }
    let in_tree = hangs_on.into_iter().flatten();
    let in_tree: HashSet<usize> = in_tree.map(|hangs| hangs.joint).collect();
    for (place, joint) in model.joints.iter().enumerate() {
        if !in_tree.contains(&place) {
            converter.close(joint);
        }
    }
    converter.frames();
    converter.finish()
}

struct Converter<'c, 'm, 'a, 'i> {
    model: Model<'m, 'a, 'i>,
    scene: &'c mut SceneDescription,
    notices: &'c mut Notices,
    sink: &'c mut Sink,
    /// Of each entity that is a link.
    anchors: Vec<Option<Anchor>>,
    /// What each body weighs.
    parts: Vec<Vec<MassProperties>>,
    facts: Vec<JointFacts>,
    /// Names of bodies and frames.
    taken: HashSet<String>,
}

impl Converter<'_, '_, '_, '_> {
    fn name(&self, entity: usize) -> Located<String> {
        let content = self.model.content;
        Located::new(content.shown(entity).to_owned(), content.span(entity))
    }

    /// A link that hangs on no joint: it moves freely, or belongs to a model that does not move.
    fn stand(&mut self, link: usize) {
        let stands = self.model.poses.of(link, WORLD);
        if self.model.content.entities[link].is_static {
            let anchor = Anchor {
                body: None,
                pose: stands,
            };
            return self.attach(link, anchor);
        }
        let name = self.name(link);
        let initial = InitialDescription {
            position: Position::Pose(Located::new(stands, name.span.clone())),
            motion: Motion::Rest,
        };
        self.body(
            name.clone(),
            None,
            (name, "free"),
            [Pose::identity(); 2],
            JointForces::default(),
        );
        if let Some(body) = self.scene.bodies.last_mut() {
            body.initial = initial;
        }
        self.begin(link);
    }

    /// A link that hangs on a joint: its child, or where it is reversed its parent, whose motion in the child is the opposite one about the same axis.
    fn hang(&mut self, link: usize, joint: &Joint<'_, '_>, reversed: bool) {
        let (content, poses) = (self.model.content, self.model.poses);
        // Where the link is, of a joint on the world: the world itself.
        let parent = joint.ends[usize::from(reversed)];
        let anchor = match parent {
            Some(parent) => self.anchors[parent],
            None => Some(Anchor::of_world()),
        };
        let Some(anchor) = anchor else { return };
        let at = anchor.pose * poses.of(joint.entity, parent.unwrap_or(WORLD));
        let back = poses.of(link, joint.entity);
        if joint.kind == JointType::Fixed {
            let message = "fixed joints join links to one body, on which the link is a named frame";
            self.notices.add(message, content.called(joint.entity));
            return self.attach(
                link,
                Anchor {
                    body: anchor.body,
                    pose: at * back,
                },
            );
        }
        self.tell(joint, self.model.stops.is_some());
        if reversed && joint.kind == JointType::Ball {
            let message = "the parent hangs on the child: orientation and velocities of the joint are those of the parent in it";
            self.notices.add(message, content.called(joint.entity));
        }
        let mut axes = joint.kind.axes().to_vec();
        let mut turns: Vec<Option<Pose<f64>>> = axes
            .iter()
            .map(|axis| joint.turned(axis, (content, poses), self.sink))
            .collect();
        if reversed {
            let over = Pose::from_rotation(Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)));
            axes.reverse();
            turns.reverse();
            turns
                .iter_mut()
                .flatten()
                .for_each(|turned| *turned = *turned * over);
        }
        let kinds = joint.kind.of_library();
        let (mut body, mut at) = (anchor.body, at);
        for (number, kind) in kinds.iter().enumerate() {
            let turned = turns
                .get(number)
                .copied()
                .flatten()
                .unwrap_or_else(Pose::identity);
            let is_last = number + 1 == kinds.len();
            let name = match is_last {
                true => self.name(link),
                false => Located::new(self.between(joint), content.span(joint.entity)),
            };
            let axis = axes.get(number).copied().unwrap_or("axis");
            let own = content.axis_name(joint.entity, axis).to_owned();
            let facts = joint.facts(axis, &own, self.sink);
            let forces = joint.forces(axis, &facts, self.model.stops);
            self.facts.push(facts);
            // A spring knows how often it has been wound up, which a circle does not.
            let is_wound = joint.kind == JointType::Continuous && forces.spring.is_some();
            let kind = if is_wound { "revolute" } else { kind };
            let after = if is_last { back } else { Pose::identity() };
            let own = Located::new(own, content.span(joint.entity));
            self.body(
                name,
                body,
                (own, kind),
                [at * turned, turned.inverse() * after],
                forces,
            );
            let mimic = joint.mimic(axis, content, self.sink);
            if let Some(made) = self.scene.bodies.last_mut() {
                made.mimic = mimic;
                if joint.kind == JointType::Screw {
                    let lead = Located::new("lead".to_owned(), content.span(joint.entity));
                    let number = joint.lead(content, self.notices, self.sink);
                    made.joint.parameters = vec![(lead, number)];
                }
            }
            (body, at) = (Some(self.scene.bodies.len() - 1), Pose::identity());
        }
        self.begin(link);
    }

    /// A new name for the body between two axes.
    fn between(&mut self, joint: &Joint<'_, '_>) -> String {
        let mut name = format!("{}_link", self.model.content.shown(joint.entity));
        while !self.taken.insert(name.clone()) {
            name.push('_');
        }
        name
    }

    /// Adds a body without mass.
    fn body(
        &mut self,
        name: Located<String>,
        parent: Option<usize>,
        (joint, kind): (Located<String>, &str),
        [at, body_at]: [Pose<f64>; 2],
        forces: JointForces,
    ) {
        let span: Span = joint.span.clone();
        self.scene.bodies.push(BodyDescription {
            name,
            parent,
            mass: MassProperties::massless(),
            joint: JointDescription {
                name: joint,
                kind: Located::new(kind.to_owned(), span.clone()),
                parameters: Vec::new(),
                coupling: None,
                span,
            },
            part: None,
            at,
            body_at,
            initial: InitialDescription::default(),
            forces,
            mimic: None,
        });
        self.parts.push(Vec::new());
    }

    /// The last body is that of a link.
    fn begin(&mut self, link: usize) {
        let anchor = Anchor {
            body: Some(self.scene.bodies.len() - 1),
            pose: Pose::identity(),
        };
        self.put(link, anchor);
    }

    /// A link that does not move on what carries it.
    fn attach(&mut self, link: usize, anchor: Anchor) {
        let name = self.name(link);
        self.scene.frames.push(FrameDescription {
            name,
            body: anchor.body,
            at: anchor.pose,
        });
        self.put(link, anchor);
    }

    /// Gives what belongs to a link to its body.
    fn put(&mut self, link: usize, anchor: Anchor) {
        let content = self.model.content;
        let node = content.entities[link].node;
        self.anchors[link] = Some(anchor);
        let shown = shapes::of_link(
            content,
            self.model.poses,
            link,
            (anchor.body, &anchor.pose),
            self.notices,
        );
        self.scene.shapes.extend(shown);
        let Some(body) = anchor.body else { return };
        if flag(node, "kinematic") == Some(true) {
            let message = format!(
                "{}: links that forces do not move are not simulated",
                content.called(link)
            );
            let error = Diagnostic::new(content.place(link, "kinematic"), message);
            self.sink
                .push(error.help("fix the link to the world by a joint, or leave <kinematic> out"));
        }
        if let Some(decay) = child(node, "velocity_decay")
            && ["linear", "angular"]
                .iter()
                .any(|what| number(decay, what).is_some_and(|rate| rate != 0.0))
        {
            self.notices
                .warn("<velocity_decay> is not simulated", content.called(link));
        }
        let Some(own) = mass::of_link(content, link, self.notices, self.sink) else {
            return;
        };
        let own = moved(&own, &anchor.pose);
        self.parts[body].push(own);
        let lift = -self.model.gravity * own.mass;
        if flag(node, "gravity") == Some(false) && lift != Vector3::zeros() {
            self.scene.wrenches.push(WrenchDescription {
                body,
                point: own.com,
                force: <[f64; 3]>::from(lift).map(TimeFunction::from),
                moment: [0.0; 3].map(TimeFunction::from),
                axes: WrenchAxes::World,
            });
        }
    }

    /// A joint that closes a loop.
    fn close(&mut self, joint: &Joint<'_, '_>) {
        let (content, poses) = (self.model.content, self.model.poses);
        let owner = content.called(joint.entity);
        let Some(closing) = joint.kind.closing() else {
            let message = format!("{owner} closes a loop, which a screw cannot");
            return self
                .sink
                .push(Diagnostic::new(content.span(joint.entity), message));
        };
        let axes = joint.kind.axes();
        let turned = |axis: Option<&&str>, sink: &mut Sink| match axis {
            Some(axis) => joint.turned(axis, (content, poses), sink),
            None => Some(Pose::identity()),
        };
        if let Some(mimic) = axes
            .iter()
            .find_map(|axis| child(joint.axis(axis)?, "mimic"))
        {
            let message = format!("{owner} closes a loop, and cannot follow another joint as well");
            self.sink.push(Diagnostic::new(tag(mimic), message));
            return;
        }
        let turns = [
            turned(axes.first(), self.sink),
            turned(axes.last(), self.sink),
        ];
        let ends = [0, 1].map(|end| {
            let link = joint.ends[end];
            let anchor = link.map_or(Some(Anchor::of_world()), |link| self.anchors[link])?;
            let at = anchor.pose * poses.of(joint.entity, link.unwrap_or(WORLD)) * turns[end]?;
            Some(LoopEnd {
                body: anchor.body,
                at,
            })
        });
        let [Some(first), Some(second)] = ends else {
            return;
        };
        if first.body == second.body {
            let message = "joints between what is one body are left out";
            return self.notices.add(message, owner);
        }
        self.tell(joint, false);
        let acts = axes.iter().any(|axis| {
            let forces = joint.facts(axis, content.shown(joint.entity), self.sink);
            forces.damping != 0.0
                || forces.friction != 0.0
                || child(joint.node, axis)
                    .and_then(|axis| child(child(axis, "dynamics")?, "spring_stiffness"))
                    .is_some()
        });
        if acts {
            self.notices.warn(
                "springs, damping and friction are not simulated of a joint that closes a loop",
                owner,
            );
        }
        self.scene.loops.push(LoopDescription {
            name: self.name(joint.entity),
            closing,
            ends: [first, second],
            independent: Vec::new(),
        });
    }

    /// The frames that the file names.
    fn frames(&mut self) {
        let (content, poses) = (self.model.content, self.model.poses);
        for frame in content.of(Kind::Frame) {
            let link = poses.link(frame);
            let anchor = link.map_or(Some(Anchor::of_world()), |link| self.anchors[link]);
            let Some(anchor) = anchor else { continue };
            let name = self.name(frame);
            self.scene.frames.push(FrameDescription {
                name,
                body: anchor.body,
                at: anchor.pose * poses.of(frame, link.unwrap_or(WORLD)),
            });
        }
    }

    /// Tells what of a joint is not simulated.
    fn tell(&mut self, joint: &Joint<'_, '_>, stops: bool) {
        let owner = self.model.content.called(joint.entity);
        let is_ball = joint.kind == JointType::Ball;
        // A ball has no axis, but what is said of one acts there.
        let axes = if is_ball {
            &["axis"]
        } else {
            joint.kind.axes()
        };
        for axis in axes {
            let dynamics = joint.axis(axis).and_then(|axis| child(axis, "dynamics"));
            if is_ball
                && dynamics.is_some_and(|dynamics| {
                    number(dynamics, "spring_stiffness").is_some_and(|k| k != 0.0)
                })
            {
                self.notices
                    .warn("springs of ball joints are not simulated", &owner);
            }
            let facts = joint.facts(axis, "", &mut Sink::default());
            let limits = facts.limits.as_ref();
            let stops = stops && joint.has_one_coordinate();
            let stands_beyond = limits
                .and_then(|limits| limits.position)
                .is_some_and(|[lower, upper]| lower > 0.0 || upper < 0.0);
            if limits.is_some_and(|limits| limits.position.is_some()) && !stops {
                self.notices.warn(
                    "limits of position are not simulated: the joint moves past them",
                    &owner,
                );
            }
            if stops && stands_beyond {
                self.notices.warn("the joint begins at home, 0, which is beyond its limits: the stop pushes it back", &owner);
            }
            if limits.is_some_and(|limits| limits.velocity.is_some() || limits.effort.is_some()) {
                self.notices
                    .add("limits of velocity and effort are not simulated", &owner);
            }
            if facts.friction != 0.0 && !joint.has_one_coordinate() {
                self.notices.warn("dry friction is simulated of joints with angles or displacements between limits alone", &owner);
            }
            if joint.axis(axis).is_none() && !is_ball {
                self.notices
                    .add("the axis is not given: it is z, the default of SDF", &owner);
            }
        }
    }

    /// Adds up the masses.
    fn finish(self) -> Vec<JointFacts> {
        for (body, parts) in self.scene.bodies.iter_mut().zip(&self.parts) {
            body.mass = sum(parts);
        }
        self.facts
    }
}
