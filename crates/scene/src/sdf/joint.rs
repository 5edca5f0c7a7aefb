//! A joint of an SDF: how it moves, and what acts there.

use super::content::{Content, Kind, WORLD};
use super::document::{attribute, attribute_node, child, flag, number, place, value, vector};
use super::poses::Poses;
use crate::description::{Closing, MimicDescription, Position};
use crate::diagnostics::Diagnostic;
use crate::forces::{
    FrictionDescription, JointForces, JointSpring, LimitDescription, LimitKind, PerFreedom,
    SpringEnergy,
};
use crate::notice::Notices;
use crate::parse::rotation;
use crate::read::Sink;
use crate::robot::xml::parse;
use crate::robot::{JointFacts, Limits, Stops};
use crate::source::Located;
use crate::suggest::{nearest, one_of};
use crate::text::quoted;
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;
use roxmltree::Node;
use std::f64::consts::PI;

/// Beyond this a limit is none: Gazebo writes ±1e16 for it.
const NO_LIMIT: f64 = 1e15;

/// Types of joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JointType {
    /// Turns about an axis.
    Revolute,
    /// Turns about an axis without limits.
    Continuous,
    /// Slides along an axis.
    Prismatic,
    /// Turns about a point.
    Ball,
    /// Turns about an axis and advances along it.
    Screw,
    /// Turns about two axes, one after the other.
    Universal,
    /// The same.
    Revolute2,
    /// Does not move.
    Fixed,
}

impl JointType {
    const ALL: [(&'static str, Self); 8] = [
        ("revolute", Self::Revolute),
        ("continuous", Self::Continuous),
        ("prismatic", Self::Prismatic),
        ("ball", Self::Ball),
        ("screw", Self::Screw),
        ("universal", Self::Universal),
        ("revolute2", Self::Revolute2),
        ("fixed", Self::Fixed),
    ];

    /// By the name that SDF has for it.
    fn of(name: &str) -> Option<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|(known, _)| *known == name).map(|(_, own)| own)
    }

    /// The elements of its axes.
    pub(super) const fn axes(self) -> &'static [&'static str] {
        match self {
            Self::Ball | Self::Fixed => &[],
            Self::Universal | Self::Revolute2 => &["axis", "axis2"],
            _ => &["axis"],
        }
    }

    /// The joint types of the library that it is made of, one after the other. They act about or along the z axis of their frames.
    pub(super) const fn of_library(self) -> &'static [&'static str] {
        match self {
            Self::Revolute => &["revolute"],
            Self::Continuous => &["revolute_circle"],
            Self::Prismatic => &["prismatic"],
            Self::Ball => &["ball_child"],
            Self::Screw => &["screw"],
            Self::Universal | Self::Revolute2 => &["revolute", "revolute"],
            Self::Fixed => &[],
        }
    }

    /// How it closes a loop, if it can.
    pub(super) const fn closing(self) -> Option<Closing> {
        match self {
            Self::Revolute | Self::Continuous => Some(Closing::Revolute),
            Self::Prismatic => Some(Closing::Prismatic),
            Self::Ball => Some(Closing::Spherical),
            Self::Fixed => Some(Closing::Fixed),
            Self::Universal | Self::Revolute2 => Some(Closing::Universal),
            Self::Screw => None,
        }
    }
}

/// A joint between links.
#[derive(Clone, Debug)]
pub(super) struct Joint<'a, 'i> {
    /// Its place among the entities.
    pub(super) entity: usize,
    /// Its element.
    pub(super) node: Node<'a, 'i>,
    /// Its type.
    pub(super) kind: JointType,
    /// The links that it holds, parent and child; `None` is the world.
    pub(super) ends: [Option<usize>; 2],
}

/// The joints of what moves, as far as they are sound.
pub(super) fn joints<'a, 'i>(
    content: &Content<'a, 'i>,
    poses: &Poses,
    notices: &mut Notices,
    sink: &mut Sink,
) -> Vec<Joint<'a, 'i>> {
    let of_kind = content.of(Kind::Joint).collect::<Vec<_>>();
    let joints = of_kind.into_iter().filter_map(|entity| {
        let node = content.entities[entity].node;
        let kind = kind(content, entity, sink);
        let parent = content.named_in(entity, "parent", sink)?;
        let ends = [parent, entity].map(|end| poses.link(end));
        if ends[0] == ends[1] && kind.is_some() {
            if ends[0].is_none() {
                notices.add(
                    "joints between what does not move are left out",
                    content.called(entity),
                );
                return None;
            }
            let on = ends[0].map_or_else(String::new, |link| content.called(link));
            let message = format!(
                "{}: its parent and its child are both on {on}",
                content.called(entity)
            );
            sink.push(Diagnostic::new(place(node, "child"), message));
            return None;
        }
        if ends[1].is_none() && kind.is_some() {
            let message = format!(
                "{}: its child does not move: it is the world, or in a static model",
                content.called(entity)
            );
            let error = Diagnostic::new(place(node, "child"), message);
            sink.push(error.help(
                "what a joint hangs on is its parent: exchange the two, and turn the axis round",
            ));
            return None;
        }
        Some(Joint {
            entity,
            node,
            kind: kind?,
            ends,
        })
    });
    joints.collect()
}

fn kind(content: &Content<'_, '_>, entity: usize, sink: &mut Sink) -> Option<JointType> {
    let said = attribute_node(content.entities[entity].node, "type")?;
    let found = JointType::of(said.value());
    if found.is_none() {
        let names = || JointType::ALL.iter().map(|(name, _)| *name);
        let message = format!(
            "{}: its type is {}, which is not read",
            content.called(entity),
            quoted(said.value())
        );
        let error = Diagnostic::new(said.range_value(), message);
        sink.push(match nearest(said.value(), names()) {
            Some(near) => error.label(format!("did you mean `{near}`?")),
            None => error.help(format!("a type is {}", one_of(names()))),
        });
    }
    found
}

impl<'a> Joint<'a, '_> {
    /// Its element `axis` or `axis2`.
    pub(super) fn axis(&self, name: &str) -> Option<Node<'a, '_>> {
        child(self.node, name)
    }

    /// The rotation in the joint's frame that turns z onto an axis.
    pub(super) fn turned(
        &self,
        name: &str,
        (content, poses): (&Content<'_, '_>, &Poses),
        sink: &mut Sink,
    ) -> Option<Pose<f64>> {
        let axis = self.axis(name);
        let said = axis
            .and_then(|axis| vector(axis, "xyz"))
            .unwrap_or_else(Vector3::z);
        let frame = self.frame_of_axis(axis, content, sink)?;
        let in_joint = poses.of(frame, self.entity).rotation * said;
        let span = axis.map_or_else(|| content.span(self.entity), |axis| place(axis, "xyz"));
        let path = format!("{}: its {name}", content.called(self.entity));
        rotation::from_axis(&path, Located::new(in_joint, span), sink).map(Pose::from_rotation)
    }

    /// The frame in which an axis is reported: that of the joint, where nothing else is said; before version 1.5 that of the model.
    fn frame_of_axis(
        &self,
        axis: Option<Node<'_, '_>>,
        content: &Content<'_, '_>,
        sink: &mut Sink,
    ) -> Option<usize> {
        let model = content.entities[self.entity].model;
        let xyz = axis.and_then(|axis| child(axis, "xyz"));
        let said = xyz.and_then(|xyz| attribute_node(xyz, "expressed_in"));
        if let Some(said) = said.filter(|said| !said.value().is_empty()) {
            let what = format!("{}: its axis is expressed in", content.called(self.entity));
            return content.find(said.value(), model, (&what, said.range_value()), sink);
        }
        let of_model = axis.and_then(|axis| flag(axis, "use_parent_model_frame"));
        if of_model == Some(true) && content.version >= (1, 7) {
            let message = format!(
                "{}: <use_parent_model_frame> is of SDF before 1.7",
                content.called(self.entity)
            );
            let span = axis.map_or(0..0, |axis| place(axis, "use_parent_model_frame"));
            let help = "say `expressed_in=\"__model__\"` of <xyz>";
            sink.push(Diagnostic::new(span, message).help(help));
        }
        Some(match of_model.unwrap_or(content.version < (1, 5)) {
            true => model,
            false => self.entity,
        })
    }

    /// The lead of a screw, m in one turn; 1 where nothing is said, as libsdformat has it.
    pub(super) fn lead(
        &self,
        content: &Content<'_, '_>,
        notices: &mut Notices,
        sink: &mut Sink,
    ) -> f64 {
        let of_gazebo = || Some(-2.0 * PI / number(self.node, "thread_pitch")?);
        let said = number(self.node, "screw_thread_pitch").or_else(of_gazebo);
        if said.is_some_and(|lead| !lead.is_finite()) {
            let message = format!("{}: its <thread_pitch> is 0", content.called(self.entity));
            let error = Diagnostic::new(place(self.node, "thread_pitch"), message);
            sink.push(error.help("it is −2π rad over the advance in one turn; say `screw_thread_pitch`, which is that advance in m"));
        }
        said.unwrap_or_else(|| {
            let message = "screws without a pitch advance by 1 m in a turn, as SDF has it";
            notices.warn(message, content.called(self.entity));
            1.0
        })
    }

    /// What the file says of an axis beyond its motion; `name` is that of the joint in the scene. Negative losses are errors.
    pub(super) fn facts(&self, axis: &str, name: &str, sink: &mut Sink) -> JointFacts {
        let node = self.axis(axis);
        let dynamics = node.and_then(|axis| child(axis, "dynamics"));
        let mut loss = |what: &str| {
            let found = dynamics
                .and_then(|dynamics| number(dynamics, what))
                .unwrap_or(0.0);
            if found < 0.0 {
                let message = format!(
                    "joint `{name}`: <{what}> is {:?}, but must be at least 0",
                    Number(found)
                );
                let span = dynamics.map_or(0..0, |dynamics| place(dynamics, what));
                sink.push(Diagnostic::new(span, message));
            }
            found
        };
        let (damping, friction) = (loss("damping"), loss("friction"));
        let limit = node.and_then(|axis| child(axis, "limit"));
        let bound = |what: &str| parse(value(limit?, what)?).filter(|bound| bound.abs() < NO_LIMIT);
        let position = [bound("lower"), bound("upper")];
        if let [Some(lower), Some(upper)] = position
            && lower > upper
        {
            let message = format!(
                "joint `{name}`: <lower> is {:?}, above <upper>, which is {:?}",
                Number(lower),
                Number(upper)
            );
            let span = limit.map_or(0..0, |limit| place(limit, "lower"));
            sink.push(Diagnostic::new(span, message));
        }
        let position = (position != [None; 2] && self.kind != JointType::Continuous).then(|| {
            [
                position[0].unwrap_or(f64::NEG_INFINITY),
                position[1].unwrap_or(f64::INFINITY),
            ]
        });
        // A negative one is none.
        let most = |what: &str| bound(what).filter(|most| *most >= 0.0);
        let limits = Limits {
            position,
            velocity: most("velocity"),
            effort: most("effort"),
        };
        let is_limited = limits
            != Limits {
                position: None,
                velocity: None,
                effort: None,
            };
        JointFacts {
            name: name.to_owned(),
            limits: is_limited.then_some(limits),
            damping,
            friction,
        }
    }

    /// What acts at an axis.
    pub(super) fn forces(
        &self,
        axis: &str,
        facts: &JointFacts,
        stops: Option<Stops>,
    ) -> JointForces {
        let node = self.axis(axis);
        let dynamics = node.and_then(|axis| child(axis, "dynamics"));
        let at = |what: &str| dynamics.map_or(0..0, |dynamics| place(dynamics, what));
        let said = |what: &str| {
            dynamics
                .and_then(|dynamics| number(dynamics, what))
                .filter(|found| *found != 0.0)
        };
        let spring = said("spring_stiffness").filter(|_| self.kind != JointType::Ball);
        let spring = spring.map(|stiffness| {
            let rest = said("spring_reference");
            JointSpring {
                rest: rest.map_or(Position::Home, |rest| {
                    Position::Phi(Located::new(vec![rest], at("spring_reference")))
                }),
                energy: SpringEnergy::Diagonal(PerFreedom::All(stiffness)),
            }
        });
        let friction =
            (facts.friction != 0.0 && self.has_one_coordinate()).then_some(FrictionDescription {
                sliding: facts.friction,
                sticking: facts.friction,
            });
        let span = node.map_or(0..0, |axis| place(axis, "limit"));
        JointForces {
            spring: spring.map(|spring| Located::new(spring, at("spring_stiffness"))),
            damping: (facts.damping != 0.0)
                .then(|| Located::new(PerFreedom::All(facts.damping), at("damping"))),
            friction: friction.map(|friction| Located::new(friction, at("friction"))),
            limit: self
                .limit(facts, stops)
                .map(|limit| Located::new(limit, span)),
            ..JointForces::default()
        }
    }

    fn limit(&self, facts: &JointFacts, stops: Option<Stops>) -> Option<LimitDescription> {
        let position = facts
            .limits
            .as_ref()?
            .position
            .filter(|_| self.has_one_coordinate())?;
        let [lower, upper] = position.map(|end| Some(end).filter(|end| end.is_finite()));
        let Stops { stiffness, damping } = stops?;
        Some(LimitDescription {
            lower,
            upper,
            kind: LimitKind::Compliant { stiffness, damping },
        })
    }

    /// Whether what its axes become has a single coordinate that is a number, which limits and friction need.
    pub(super) fn has_one_coordinate(&self) -> bool {
        matches!(
            self.kind,
            JointType::Revolute
                | JointType::Prismatic
                | JointType::Universal
                | JointType::Revolute2
        )
    }

    /// The joint that an axis follows: `q = multiplier (leader − reference) + offset`.
    pub(super) fn mimic(
        &self,
        axis: &str,
        content: &Content<'_, '_>,
        sink: &mut Sink,
    ) -> Option<Located<MimicDescription>> {
        let mimic = child(self.axis(axis)?, "mimic")?;
        let followed = attribute_node(mimic, "joint")?;
        let model = content.entities[self.entity].model;
        let what = format!("{}: it follows", content.called(self.entity));
        let leader = content.find(
            followed.value(),
            model,
            (&what, followed.range_value()),
            sink,
        )?;
        if content.entities[leader].kind != Kind::Joint || leader == WORLD {
            let message = format!("{what} {}, which is no joint", content.called(leader));
            sink.push(Diagnostic::new(followed.range_value(), message));
            return None;
        }
        let followed_axis = attribute(mimic, "axis")
            .filter(|axis| !axis.is_empty())
            .unwrap_or("axis");
        let has_axis = followed_axis == "axis"
            || child(content.entities[leader].node, followed_axis).is_some();
        if !["axis", "axis2"].contains(&followed_axis) || !has_axis {
            let message = format!(
                "{what} {} of {}, which has no such axis",
                quoted(followed_axis),
                content.called(leader)
            );
            let span = attribute_node(mimic, "axis").map_or(0..0, |axis| axis.range_value());
            sink.push(Diagnostic::new(span, message));
            return None;
        }
        let name = content.axis_name(leader, followed_axis).to_owned();
        let multiplier = number(mimic, "multiplier")?;
        let [offset, reference] =
            ["offset", "reference"].map(|what| number(mimic, what).unwrap_or(0.0));
        let description = MimicDescription {
            joint: Located::new(name, followed.range_value()),
            multiplier,
            offset: offset - multiplier * reference,
        };
        Some(Located::new(description, crate::robot::xml::tag(mimic)))
    }
}
