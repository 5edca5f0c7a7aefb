//! What acts at a joint.

use super::convert::Converter;
use super::joint::{Joint, Movement};
use crate::description::{InitialDescription, Motion, Position};
use crate::forces::{
    BodyPoint, FrictionDescription, JointForces, JointSpring, LimitDescription, LimitKind,
    PerFreedom, PointSpring, SpringEnergy,
};
use crate::robot::{JointFacts, Limits, Stops};
use crate::source::Located;
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;

/// Where a joint begins; `pose` is that of a body that moves freely.
pub(super) fn initial(joint: &Joint<'_>, pose: &Pose<f64>) -> InitialDescription {
    let span = joint.span();
    let position = match joint.movement {
        Movement::Free => Position::Pose(Located::new(*pose, span)),
        _ if joint.reference != 0.0 => Position::Phi(Located::new(vec![joint.reference], span)),
        _ => Position::Home,
    };
    InitialDescription {
        position,
        motion: Motion::Rest,
    }
}

/// What the file says of a joint beyond its motion.
pub(super) fn facts(name: &str, joint: &Joint<'_>) -> JointFacts {
    let position = joint.range.filter(|_| joint.movement.has_axis());
    let limits = Limits {
        position,
        velocity: None,
        effort: joint.effort,
    };
    JointFacts {
        name: name.to_owned(),
        limits: (position.is_some() || joint.effort.is_some()).then_some(limits),
        damping: joint.damping,
        friction: joint.friction,
    }
}

impl Converter<'_, '_> {
    /// What acts at the joint of the body that comes next, whose pose at rest is `pose` where it moves freely.
    pub(super) fn forces(
        &mut self,
        joint: &Joint<'_>,
        pose: &Pose<f64>,
        stops: Option<Stops>,
    ) -> JointForces {
        let at = |name: &str| joint.element.span(name);
        let all = |value: f64, name: &str| {
            (value != 0.0).then(|| Located::new(PerFreedom::All(value), at(name)))
        };
        let has_axis = joint.movement.has_axis();
        let limit = joint
            .range
            .filter(|_| has_axis)
            .zip(stops)
            .map(|([lower, upper], stops)| LimitDescription {
                lower: Some(lower),
                upper: Some(upper),
                kind: LimitKind::Compliant {
                    stiffness: stops.stiffness,
                    damping: stops.damping,
                },
            });
        let friction = (joint.friction != 0.0 && has_axis).then_some(FrictionDescription {
            sliding: joint.friction,
            sticking: joint.friction,
        });
        JointForces {
            spring: (joint.stiffness != 0.0)
                .then(|| Located::new(self.spring(joint, pose), at("stiffness"))),
            damping: all(joint.damping, "damping"),
            armature: all(joint.armature, "armature").filter(|_| joint.movement != Movement::Free),
            friction: friction.map(|own| Located::new(own, at("frictionloss"))),
            limit: limit.map(|own| Located::new(own, at("range"))),
            ..JointForces::default()
        }
    }

    /// The spring of a joint. Of a body that moves freely it turns it back, and another one draws its origin back.
    fn spring(&mut self, joint: &Joint<'_>, pose: &Pose<f64>) -> JointSpring {
        let k = joint.stiffness;
        let rest = match joint.movement {
            Movement::Free => Position::Pose(Located::new(*pose, joint.span())),
            _ if joint.rest != 0.0 => Position::Phi(Located::new(
                vec![joint.rest],
                joint.element.span("springref"),
            )),
            _ => Position::Home,
        };
        if joint.movement != Movement::Free {
            let energy = SpringEnergy::Diagonal(PerFreedom::All(k));
            return JointSpring { rest, energy };
        }
        self.springs.push(PointSpring {
            from: BodyPoint {
                body: Some(self.bodies.len()),
                point: Vector3::zeros(),
            },
            to: BodyPoint {
                body: None,
                point: pose.translation,
            },
            stiffness: k,
            damping: 0.0,
            length: 0.0,
        });
        JointSpring {
            rest,
            energy: SpringEnergy::Diagonal(PerFreedom::Each(vec![k, k, k, 0.0, 0.0, 0.0])),
        }
    }

    /// Tells what of a joint is not simulated.
    pub(super) fn tell(&mut self, name: &str, joint: &Joint<'_>, stops: Option<Stops>) {
        let owner = format!("joint `{name}`");
        let has_axis = joint.movement.has_axis();
        let limited = joint.range.is_some();
        let beyond = |[lower, upper]: [f64; 2]| !(lower..=upper).contains(&joint.reference);
        let is_beyond = stops.is_some() && has_axis && joint.range.is_some_and(beyond);
        for (holds, message) in [
            (
                limited && (stops.is_none() || !has_axis),
                "limits of position are not simulated: the joint moves past them",
            ),
            (
                is_beyond,
                "the joint begins at its `ref`, which is beyond its limits: the stop pushes it back",
            ),
            (
                joint.friction != 0.0 && !has_axis,
                "dry friction is simulated of hinges and slides alone",
            ),
            (
                joint.armature != 0.0 && joint.movement == Movement::Free,
                "the armature of a free joint is not simulated",
            ),
            (
                joint.bent,
                "springs and dampers are simulated with the first of their coefficients alone: they are linear",
            ),
            (
                joint
                    .element
                    .vector::<2>("springdamper")
                    .is_some_and(|own| own != [0.0; 2]),
                "`springdamper` is not read: say `stiffness` and `damping`",
            ),
        ] {
            if holds {
                self.notices.warn(message, &owner);
            }
        }
        if joint.effort.is_some() {
            self.notices
                .add("limits of velocity and effort are not simulated", &owner);
        }
    }
}
