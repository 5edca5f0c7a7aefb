//! What acts at joints and on bodies, on its way into the mechanism.

use super::state::Stand;
use crate::description::{InitialDescription, Motion};
use crate::diagnostics::Diagnostic;
use crate::forces::{
    FrictionDescription, JointForces, JointSpring, LimitDescription, LimitKind, LimitOwner,
    PerFreedom, PortForces, SpringEnergy,
};
use crate::read::Sink;
use crate::source::{Located, Span};
use hamel_runtime::elements::{has_one_freedom, is_one_coordinate};
use hamel_runtime::mechanism::{CONFIGURATION_TOLERANCE, speed_of_rotor};
use hamel_runtime::shown::Number;
use hamel_runtime::time_function::TimeFunction;
use nalgebra::{DMatrix, DVector};

/// What acts at one joint, in numbers that fit it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Acting {
    /// Spring.
    pub(crate) spring: Option<Spring>,
    /// Damping, one number per degree of freedom; empty without.
    pub(crate) damping: Vec<f64>,
    /// Armature, one number per degree of freedom; empty without.
    pub(crate) armature: Vec<f64>,
    /// Efforts τ, one per degree of freedom; empty without.
    pub(crate) effort: Vec<TimeFunction>,
    /// Prescribed speeds, one function a speed; empty without.
    pub(crate) motion: Vec<TimeFunction>,
    /// Dry friction.
    pub(crate) friction: Option<FrictionDescription>,
    /// Ends of the joint's range.
    pub(crate) limit: Option<LimitDescription>,
    /// Stops that give way at other joints of its coupling.
    pub(crate) further_limits: Vec<LimitDescription>,
    /// What acts at its ports, by their indices.
    pub(crate) ports: Vec<(usize, PortForces)>,
}

impl Acting {
    /// Inertias of rotors at the ports, of which the joint has so many.
    pub(crate) fn port_armature(&self, ports: usize) -> Vec<f64> {
        let mut inertias = vec![0.0; ports];
        for (port, forces) in &self.ports {
            inertias[*port] = forces.armature;
        }
        inertias
    }
}

/// A spring at a joint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spring {
    /// Configuration at which it is at rest, on the joint's manifold.
    pub(crate) rest: Vec<f64>,
    /// Its stiffness.
    pub(crate) stiffness: Stiffness,
}

/// Stiffness of a spring at a joint.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Stiffness {
    /// K of the energy `½ ϕᵀKϕ`.
    Log(DMatrix<f64>),
    /// k of the energy `k (3 − tr R)/2`.
    Trace(f64),
}

/// Fits what acts to the joint on the stand; every error is noted.
pub(super) fn acting(
    stand: &Stand,
    initial: &InitialDescription,
    forces: &JointForces,
    sink: &mut Sink,
) -> Option<Acting> {
    let errors_before = sink.len();
    let mut noted = |error: Diagnostic| sink.push(error);
    let damping = spread(stand, "damping", forces.damping.as_ref());
    let armature = armature(stand, forces.armature.as_ref());
    let effort = effort(stand, forces.effort.as_ref());
    let spring = forces.spring.as_ref().map(|found| spring(stand, found));
    let motion = motion(stand, initial, forces.motion.as_ref());
    let friction = of_one_freedom(stand, "friction", forces.friction.as_ref());
    let limit = of_one_coordinate(stand, "a limit", forces.limit.as_ref());
    let further = forces.further_limits.iter().map(|own| own.value);
    let ports = forces.ports.iter().filter_map(|own| {
        let port = stand.port(&own.name).map_err(&mut noted).ok()?;
        let what = format!("friction at port `{}`", own.name.value);
        let friction = of_one_freedom(stand, &what, own.friction.as_ref());
        friction.map_err(&mut noted).ok()?;
        Some((port, own.clone()))
    });
    let ports = ports.collect();
    let acting = Acting {
        damping: damping.map_err(&mut noted).unwrap_or_default(),
        armature: armature.map_err(&mut noted).unwrap_or_default(),
        effort: effort.map_err(&mut noted).unwrap_or_default(),
        spring: spring.transpose().map_err(&mut noted).unwrap_or_default(),
        motion: motion.map_err(&mut noted).unwrap_or_default(),
        friction: friction.map_err(&mut noted).unwrap_or_default(),
        limit: limit.map_err(&mut noted).unwrap_or_default(),
        further_limits: further.collect(),
        ports,
    };
    (sink.len() == errors_before).then_some(acting)
}

fn spread(
    stand: &Stand,
    key: &str,
    numbers: Option<&Located<PerFreedom>>,
) -> Result<Vec<f64>, Diagnostic> {
    match numbers {
        None => Ok(Vec::new()),
        Some(numbers) => each(stand, key, &numbers.value, &numbers.span),
    }
}

/// Armatures turn with v; at a nonholonomic joint only with what is a speed, as what it feels of others depends on its S̄, and is not simulated.
fn armature(stand: &Stand, numbers: Option<&Located<PerFreedom>>) -> Result<Vec<f64>, Diagnostic> {
    match numbers {
        Some(numbers) if stand.joint.layout().constraints > 0 => {
            let inertia = spread(stand, "armature", Some(numbers))?;
            let varies =
                |&(k, a): &(usize, &f64)| *a != 0.0 && speed_of_rotor(&*stand.joint, k).is_none();
            let Some((k, a)) = inertia.iter().enumerate().find(varies) else {
                return Ok(inertia);
            };
            let (name, kind) = (&stand.name, stand.joint.name());
            let freedom = stand.joint.freedoms().get(k).copied().unwrap_or_default();
            let message = format!(
                "joint `{name}`: armature {a} at `{freedom}` of the nonholonomic joint `{kind}`, whose rate is not one of its speeds; it \
                 must be 0 there"
            );
            Err(Diagnostic::new(numbers.span.clone(), message))
        }
        numbers => spread(stand, "armature", numbers),
    }
}

/// One number a degree of freedom.
fn each(
    stand: &Stand,
    key: &str,
    numbers: &PerFreedom,
    span: &Span,
) -> Result<Vec<f64>, Diagnostic> {
    let freedoms = stand.joint.freedoms();
    if let PerFreedom::Each(numbers) = numbers {
        stand.check_count(key, numbers.len(), span, freedoms)?;
    }
    Ok(numbers.spread(freedoms.len()).unwrap_or_default())
}

fn effort(
    stand: &Stand,
    effort: Option<&Located<Vec<TimeFunction>>>,
) -> Result<Vec<TimeFunction>, Diagnostic> {
    let Some(effort) = effort else {
        return Ok(Vec::new());
    };
    let freedoms = stand.joint.freedoms();
    stand.check_count("effort", effort.value.len(), &effort.span, freedoms)?;
    Ok(effort.value.clone())
}

fn spring(stand: &Stand, spring: &Located<JointSpring>) -> Result<Spring, Diagnostic> {
    let freedoms = stand.joint.freedoms();
    let key = "spring.stiffness";
    let stiffness = match &spring.value.energy {
        SpringEnergy::Trace(_) if !stand.turns() => {
            let message = format!(
                "joint `{}`: a spring of kind \"trace\" acts on the rotation, and the joint does not turn",
                stand.name
            );
            return Err(Diagnostic::new(spring.span.clone(), message));
        }
        SpringEnergy::Trace(stiffness) => Stiffness::Trace(*stiffness),
        SpringEnergy::Diagonal(numbers) => {
            let numbers = each(stand, key, numbers, &spring.span)?;
            Stiffness::Log(DMatrix::from_diagonal(&DVector::from_vec(numbers)))
        }
        SpringEnergy::Full(matrix) => {
            stand.check_count(key, matrix.nrows(), &spring.span, freedoms)?;
            Stiffness::Log(matrix.clone())
        }
    };
    Ok(Spring {
        rest: stand.configuration(&spring.value.rest)?,
        stiffness,
    })
}

/// What joints with a single degree of freedom alone can have.
fn of_one_freedom<T: Copy>(
    stand: &Stand,
    what: &str,
    found: Option<&Located<T>>,
) -> Result<Option<T>, Diagnostic> {
    let Some(found) = found.filter(|_| !has_one_freedom(&*stand.joint)) else {
        return Ok(found.map(|found| found.value));
    };
    let (name, kind, layout) = (&stand.name, stand.joint.name(), stand.joint.layout());
    let message = format!(
        "joint `{name}`: {what} needs a single degree of freedom, and `{kind}` has {}{}",
        layout.freedoms,
        if layout.constraints > 0 {
            ", with constraints"
        } else {
            ""
        }
    );
    let error = Diagnostic::new(found.span.clone(), message);
    Err(error.help("give `damping`"))
}

/// What joints with a single coordinate alone can have.
fn of_one_coordinate<T: Copy>(
    stand: &Stand,
    what: &str,
    found: Option<&Located<T>>,
) -> Result<Option<T>, Diagnostic> {
    let Some(found) = found else {
        return Ok(None);
    };
    if is_one_coordinate(&*stand.joint) {
        return Ok(Some(found.value));
    }
    let message = format!(
        "joint `{}`: {what} needs a single coordinate whose rate is the speed, and `{}` has none",
        stand.name,
        stand.joint.name()
    );
    Err(Diagnostic::new(found.span.clone(), message))
}

fn motion(
    stand: &Stand,
    initial: &InitialDescription,
    motion: Option<&Located<Vec<TimeFunction>>>,
) -> Result<Vec<TimeFunction>, Diagnostic> {
    let Some(motion) = motion else {
        return Ok(Vec::new());
    };
    let speeds = stand.joint.speeds();
    stand.check_count("motion.speeds", motion.value.len(), &motion.span, speeds)?;
    if initial.motion != Motion::Rest {
        let message = format!(
            "joint `{}`: its motion is prescribed, and so are its speeds at time 0",
            stand.name
        );
        let error = Diagnostic::new(motion.span.clone(), message);
        return Err(
            error.help("leave `velocity`, `speeds`, `twist` and `rates` out of its `initial`")
        );
    }
    Ok(motion.value.clone())
}

/// Whether the joint begins within its limits, where these are hit; stops that give way may be pressed at first.
pub(super) fn check_limit(
    stand: &Stand,
    q: &[f64],
    (limit, of): (&Located<LimitDescription>, &[Option<LimitOwner>; 2]),
) -> Result<(), Diagnostic> {
    // Of other joints it is said elsewhere that they can have none.
    let ([value], [coordinate]) = (q, stand.joint.coordinates()) else {
        return Ok(());
    };
    if let LimitKind::Compliant { .. } = limit.value.kind {
        return Ok(());
    }
    let room = |limit: f64| CONFIGURATION_TOLERANCE * limit.abs().max(1.0);
    let (lower, upper) = (limit.value.lower, limit.value.upper);
    let below = lower.filter(|&lower| *value < lower - room(lower));
    let above = upper.filter(|&upper| *value > upper + room(upper));
    let [lower_of, upper_of] = of;
    let (side, end, of) = match (below, above) {
        (Some(lower), _) => ("lower", lower, lower_of),
        (_, Some(upper)) => ("upper", upper, upper_of),
        _ => return Ok(()),
    };
    if let Some(owner) = of {
        return Err(beyond(stand, q, owner));
    }
    let (name, value, end) = (&stand.name, Number(*value), Number(end));
    let message = format!(
        "joint `{name}`: its coordinate `{coordinate}` is {value:?} at time 0, beyond its {side} limit {end:?}"
    );
    Err(Diagnostic::new(limit.span.clone(), message))
}

/// A joint of a coupling that begins beyond its limit.
fn beyond(stand: &Stand, q: &[f64], owner: &LimitOwner) -> Diagnostic {
    let LimitOwner { joint, end, .. } = owner;
    let side = if owner.is_upper { "upper" } else { "lower" };
    let (value, limit) = (stand.joint.port_value(q, owner.port), Number(end.value));
    let message = format!(
        "joint `{joint}`: it is at {:?} at time 0, beyond its {side} limit {limit:?}",
        Number(value)
    );
    Diagnostic::new(end.span.clone(), message)
}
