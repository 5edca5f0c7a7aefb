//! `elastic`: a motor that drives the joint of a body through a spring. The body becomes two: the motor, on a joint of the same type, and the
//! body itself, which hangs on the motor by that type once more.

use super::BodyDraft;
use super::forces::per_freedom;
use crate::description::{InitialDescription, JointDescription};
use crate::diagnostics::Diagnostic;
use crate::forces::{
    JointForces, JointSpring, LimitDescription, LimitKind, PerFreedom, SpringEnergy,
};
use crate::read::{Sink, Value};
use crate::source::{Located, Span};
use crate::{Motion, Position};
use hamel_runtime::spatial::{MassProperties, Pose};

/// What a motor's name ends in, after that of its joint.
const MOTOR: &str = ".motor";

/// A motor and the spring behind its gear.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Elastic {
    stiffness: PerFreedom,
    damping: Option<PerFreedom>,
    /// That of the rotor seen from the joint: its own times the square of the ratio.
    inertia: PerFreedom,
    backlash: f64,
}

/// Reads the key.
pub(super) fn elastic(value: &Value<'_>, sink: &mut Sink) -> Option<Located<Elastic>> {
    let mut fields = value.table(sink)?;
    let stiffness = fields.required("stiffness", sink);
    let stiffness = stiffness.and_then(|stiffness| per_freedom(&stiffness, sink));
    let damping = match fields.optional("damping") {
        Some(damping) => per_freedom(&damping, sink).map(|damping| Some(damping.value)),
        None => Some(None),
    };
    let rotor = fields.required("rotor", sink);
    let rotor = rotor.and_then(|rotor| per_freedom(&rotor, sink));
    let ratio = match fields.optional("ratio") {
        // The inertia of the rotor as the joint feels it is ratio² times its own: a motor without inertia has no motion.
        Some(value) => value
            .number_within(|number| number > 0.0, "above 0", sink)
            .map(|number| number.value),
        None => Some(1.0),
    };
    let backlash = match fields.optional("backlash") {
        Some(value) => value.not_negative(sink).map(|number| number.value),
        None => Some(0.0),
    };
    fields.finish(sink);
    let (stiffness, backlash, ratio) = (stiffness?.value, backlash?, ratio?);
    if backlash > 0.0 && matches!(stiffness, PerFreedom::Each(_)) {
        let message = format!(
            "{}: with `backlash` its stiffness is one number",
            value.path()
        );
        sink.push(Diagnostic::new(value.span(), message));
        return None;
    }
    let elastic = Elastic {
        stiffness,
        damping: damping?,
        inertia: scaled(rotor?.value, ratio * ratio),
        backlash,
    };
    Some(Located::new(elastic, value.span()))
}

fn scaled(numbers: PerFreedom, factor: f64) -> PerFreedom {
    match numbers {
        PerFreedom::All(number) => PerFreedom::All(factor * number),
        PerFreedom::Each(numbers) => {
            PerFreedom::Each(numbers.into_iter().map(|number| factor * number).collect())
        }
    }
}

/// The bodies with a motor before each one that has an elastic joint.
pub(super) fn expand(drafts: Vec<BodyDraft>, sink: &mut Sink) -> Vec<BodyDraft> {
    let mut all = Vec::with_capacity(drafts.len());
    for mut draft in drafts {
        if let Some(elastic) = draft.elastic.take() {
            all.extend(motor(&mut draft, &elastic, sink));
        }
        all.push(draft);
    }
    all
}

/// The motor of a body, which hangs on it from then on; `None` where the body could not be read.
fn motor(draft: &mut BodyDraft, elastic: &Located<Elastic>, sink: &mut Sink) -> Option<BodyDraft> {
    let joint = draft.joint.as_ref()?;
    let mut forces = draft.forces.take()?;
    let span = &elastic.span;
    let taken = [
        ("spring", forces.spring.is_some()),
        ("limit", forces.limit.is_some()),
        ("armature", forces.armature.is_some()),
        ("mimic", draft.mimic.is_some()),
    ];
    for (key, _) in taken.into_iter().filter(|(_, is_given)| *is_given) {
        let message = format!(
            "joint `{}`: `{key}` and `elastic` do not go together",
            joint.name.value
        );
        let error = Diagnostic::new(span.clone(), message);
        sink.push(error.help(
            "give the motor as a body of its own, without mass and with an armature, on a joint of the same type",
        ));
    }
    let name = Located::new(
        format!("{}{MOTOR}", joint.name.value),
        joint.name.span.clone(),
    );
    forces.armature = Some(Located::new(elastic.value.inertia.clone(), span.clone()));
    let motor = BodyDraft {
        parent: draft.parent.replace(name.clone()),
        mass: Some(nothing()),
        joint: Some(JointDescription {
            name: name.clone(),
            ..joint.clone()
        }),
        at: std::mem::replace(&mut draft.at, Pose::identity()),
        body_at: Pose::identity(),
        initial: draft.initial.replace(InitialDescription {
            position: Position::Home,
            motion: Motion::Rest,
        }),
        forces: Some(forces),
        elastic: None,
        motor: None,
        mimic: None,
        part: None,
        name: Some(name),
    };
    draft.motor = motor.name.as_ref().map(|name| name.value.clone());
    draft.forces = Some(behind(&elastic.value, span));
    Some(motor)
}

fn nothing() -> MassProperties {
    MassProperties {
        mass: 0.0,
        com: nalgebra::Vector3::zeros(),
        inertia_com: nalgebra::Matrix3::zeros(),
    }
}

/// What acts between the motor and the body.
fn behind(elastic: &Elastic, span: &Span) -> JointForces {
    let located = |damping: &PerFreedom| Located::new(damping.clone(), span.clone());
    let damping = elastic.damping.as_ref().map(located);
    let half = 0.5 * elastic.backlash;
    match elastic.stiffness {
        PerFreedom::All(stiffness) if half > 0.0 => {
            let limit = LimitDescription {
                lower: Some(-half),
                upper: Some(half),
                kind: LimitKind::Compliant {
                    stiffness,
                    damping: 0.0,
                },
            };
            JointForces {
                limit: Some(Located::new(limit, span.clone())),
                damping,
                ..JointForces::default()
            }
        }
        _ => {
            let spring = JointSpring {
                rest: Position::Home,
                energy: SpringEnergy::Diagonal(elastic.stiffness.clone()),
            };
            JointForces {
                spring: Some(Located::new(spring, span.clone())),
                damping,
                ..JointForces::default()
            }
        }
    }
}
