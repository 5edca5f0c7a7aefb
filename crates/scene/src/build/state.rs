//! The state of one joint at time 0, solved from whatever the file gives.

use super::forces::{self, Acting};
use super::joint;
use crate::description::{
    InitialDescription, JointDescription, Motion, Position, TwistDescription, TwistFrame,
};
use crate::diagnostics::Diagnostic;
use crate::forces::JointForces;
use crate::read::Sink;
use crate::source::{Located, Span};
use crate::suggest::{all_of, nearest};
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::mechanism::{BodySpec, Mechanism, StateError};
use hamel_runtime::registry::JointRegistry;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::Vector3;
use std::sync::Arc;

/// A joint and its state.
#[derive(Debug)]
pub(crate) struct State {
    pub(crate) joint: Arc<dyn AnyJoint>,
    pub(crate) configuration: Vec<f64>,
    pub(crate) speeds: Vec<f64>,
    pub(crate) acting: Acting,
}

/// Builds the joint and solves for its state.
pub(crate) fn state(
    description: &JointDescription,
    initial: &InitialDescription,
    forces: &JointForces,
    registry: &JointRegistry,
    sink: &mut Sink,
) -> Option<State> {
    let stand = stand(description, registry, sink)?;
    let solved = stand.solved(initial);
    let solved = solved.map_err(|error| sink.push(error)).ok();
    let acting = forces::acting(&stand, initial, forces, sink);
    let (configuration, speeds) = solved?;
    stand
        .check_limit(&configuration, forces)
        .map_err(|error| sink.push(error))
        .ok()?;
    Some(State {
        joint: stand.joint,
        configuration,
        speeds,
        acting: acting?,
    })
}

/// The joint alone.
pub(crate) fn stand(
    description: &JointDescription,
    registry: &JointRegistry,
    sink: &mut Sink,
) -> Option<Stand> {
    let joint = joint::joint(description, registry, sink)?;
    Stand::of(&description.name.value, joint, &description.span)
        .map_err(|error| sink.push(error))
        .ok()
}

/// The joint alone, between the world and bodies without mass: its state is solved there, so that the errors of one joint do
/// not hide those of another.
#[derive(Debug)]
pub(crate) struct Stand {
    pub(super) name: String,
    mechanism: Mechanism,
    pub(super) joint: Arc<dyn AnyJoint>,
}

impl Stand {
    /// The joint called `name`, which messages find at `span`.
    pub(super) fn of(
        name: &str,
        joint: Arc<dyn AnyJoint>,
        span: &Span,
    ) -> Result<Self, Diagnostic> {
        let name = String::from(name);
        let all = core::iter::once(Arc::clone(&joint)).chain(joint.more());
        let bodies = all.enumerate().map(|(number, joint)| BodySpec {
            name: match number {
                0 => name.clone(),
                _ => format!("{name} {number}"),
            },
            joint_name: name.clone(),
            parent: None,
            joint,
            placement: Pose::identity(),
            child_placement: Pose::identity(),
            mass: MassProperties::massless(),
        });
        let mechanism = Mechanism::new(Vector3::zeros(), bodies.collect()).map_err(|errors| {
            let errors: Vec<String> = errors.iter().map(ToString::to_string).collect();
            Diagnostic::new(span.clone(), errors.join("; "))
        })?;
        Ok(Self {
            name,
            mechanism,
            joint,
        })
    }

    /// The configuration and the speeds that `initial` means.
    fn solved(&self, initial: &InitialDescription) -> Result<(Vec<f64>, Vec<f64>), Diagnostic> {
        let configuration = self.configuration(&initial.position)?;
        let speeds = self.speeds(&configuration, &initial.motion)?;
        Ok((configuration, speeds))
    }

    /// The same, within the limits at which the joint is hit.
    pub(crate) fn state(
        &self,
        initial: &InitialDescription,
        forces: &JointForces,
    ) -> Result<(Vec<f64>, Vec<f64>), Diagnostic> {
        let state = self.solved(initial)?;
        self.check_limit(&state.0, forces)?;
        Ok(state)
    }

    fn check_limit(&self, q: &[f64], forces: &JointForces) -> Result<(), Diagnostic> {
        match &forces.limit {
            Some(limit) => forces::check_limit(self, q, (limit, &forces.limit_of)),
            None => Ok(()),
        }
    }

    /// Whether the child can turn at home.
    pub(super) fn turns(&self) -> bool {
        let mut twists = vec![0.0; 6 * self.joint.layout().freedoms];
        let home = self.mechanism.home();
        self.joint.twist_map_child(&home, &mut twists);
        // Columns of an angular and a linear part.
        twists
            .chunks(6)
            .any(|twist| twist[..3].iter().any(|&rate| rate != 0.0))
    }

    /// The configuration that `position` means.
    pub(super) fn configuration(&self, position: &Position) -> Result<Vec<f64>, Diagnostic> {
        match position {
            Position::Home => Ok(self.mechanism.home()),
            Position::Configuration(q) => self.projected(q),
            Position::Phi(phi) => {
                self.check_size("phi", phi, self.joint.freedoms())?;
                let found = self.mechanism.configuration_from_local(0, &phi.value);
                let found = found.map_err(refusal(&phi.span))?;
                // Huge numbers overflow on the way.
                let checked = self.mechanism.check_configuration(&found);
                checked.map_err(refusal(&phi.span)).map(|()| found)
            }
            Position::Pose(pose) => {
                let found = self.mechanism.configuration_from_pose(0, &pose.value);
                found.map_err(refusal(&pose.span))
            }
        }
    }

    /// A configuration given outright, freed of its rounding.
    fn projected(&self, q: &Located<Vec<f64>>) -> Result<Vec<f64>, Diagnostic> {
        self.check_size("configuration", q, self.joint.coordinates())?;
        let checked = self.mechanism.check_configuration(&q.value);
        checked.map_err(refusal(&q.span))?;
        let mut projected = q.value.clone();
        match self.mechanism.project(&mut projected) {
            Ok(()) => Ok(projected),
            Err(error) => Err(refusal(&q.span)(error)),
        }
    }

    fn speeds(&self, q: &[f64], motion: &Motion) -> Result<Vec<f64>, Diagnostic> {
        match motion {
            Motion::Rest => Ok(vec![0.0; self.joint.layout().speeds]),
            Motion::Speeds(speeds) => {
                self.check_size("speeds", speeds, self.joint.speeds())?;
                Ok(speeds.value.clone())
            }
            Motion::Velocity(velocity) => {
                self.check_size("velocity", velocity, self.joint.freedoms())?;
                self.allowed(q, &velocity.value, &velocity.span)
            }
            Motion::Rates(rates) => {
                let own = rates.value.iter();
                let own = own.map(|own| Ok((self.port(&own.name)?, own.rate)));
                let own: Vec<(usize, f64)> = own.collect::<Result<_, Diagnostic>>()?;
                let found = self.mechanism.speeds_from_port_rates(0, q, &own);
                found.map_err(refusal(&rates.span))
            }
            Motion::Twist(twist) => {
                let child = self.child_twist(q, &twist.value);
                let found = self.mechanism.velocity_from_twist(0, q, &child);
                self.allowed(q, &found.map_err(refusal(&twist.span))?, &twist.span)
            }
        }
    }

    /// The index of the port of that name.
    pub(super) fn port(&self, name: &Located<String>) -> Result<usize, Diagnostic> {
        let found = self.mechanism.port_index(0, &name.value);
        found.ok_or_else(|| {
            let (joint, kind, given) = (&self.name, self.joint.name(), &name.value);
            let message =
                format!("joint `{joint}`: a joint of type `{kind}` has no port `{given}`");
            let error = Diagnostic::new(name.span.clone(), message);
            let ports = || self.joint.ports().iter().map(|port| port.name);
            match nearest(given, ports()) {
                Some(near) => error.label(format!("did you mean `{near}`?")),
                None if ports().next().is_none() => error.label("it has none"),
                None => error.help(format!("its ports are {}", all_of(ports()))),
            }
        })
    }

    fn allowed(&self, q: &[f64], velocity: &[f64], span: &Span) -> Result<Vec<f64>, Diagnostic> {
        let speeds = self.mechanism.speeds_from_velocity(0, q, velocity);
        speeds.map_err(refusal(span)).map_err(|error| {
            error.help(format!(
                "its degrees of freedom are {}",
                self.joint.freedoms().join(", ")
            ))
        })
    }

    fn child_twist(&self, q: &[f64], given: &TwistDescription) -> nalgebra::Vector6<f64> {
        match given.frame {
            TwistFrame::Child => given.twist,
            TwistFrame::Parent => self.joint.pose(q).act_twist_inverse(&given.twist),
        }
    }

    fn check_size(
        &self,
        key: &str,
        values: &Located<Vec<f64>>,
        entries: &[&str],
    ) -> Result<(), Diagnostic> {
        self.check_count(key, values.value.len(), &values.span, entries)
    }

    /// Whether as many numbers are given under `key` as the joint has `entries`.
    pub(super) fn check_count(
        &self,
        key: &str,
        found: usize,
        span: &Span,
        entries: &[&str],
    ) -> Result<(), Diagnostic> {
        let expected = entries.len();
        if found == expected {
            return Ok(());
        }
        let message = format!(
            "joint `{}`: `{key}` has size {found}, not {expected}",
            self.name
        );
        let kind = self.joint.name();
        let entries = entries.join(", ");
        let help = format!("`{key}` of a joint of type `{kind}` is [{entries}]");
        Err(Diagnostic::new(span.clone(), message).help(help))
    }
}

/// What the joint says of a value at `span`.
fn refusal(span: &Span) -> impl Fn(StateError) -> Diagnostic {
    move |error| Diagnostic::new(span.clone(), error.to_string())
}
