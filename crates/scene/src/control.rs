//! The `[controller]` of a scene: as the text says it, and as it fits the mechanism.

use crate::build;
use crate::description::Position;
use crate::diagnostics::Diagnostics;
use crate::forces::PerFreedom;
use crate::parse;
use crate::read::Sink;
use crate::scene::{Scene, read_file};
use crate::source::{Located, Span};
use hamel_control::{
    ComputedTorque, ControlError, Controller, Curve, EnergyShaping, Equilibrium, ErrorDynamics,
    PathFollower, PathGains, Port, PortReference, PortSpring, Pump, Reference, Regulator, Weights,
};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::time_function::Law;
use std::path::Path;
use std::sync::Arc;

/// What a `[controller]` says; joints are not yet looked up.
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerDescription {
    /// Where it stands in the file.
    pub span: Span,
    /// Time between two readings of the state, after which efforts are held, s; `None` for feedback at every instant.
    pub period: Option<f64>,
    /// What it does.
    pub law: LawDescription,
}

/// What a controller does.
#[derive(Clone, Debug, PartialEq)]
pub enum LawDescription {
    /// `kind = "computed_torque"`.
    ComputedTorque {
        /// How errors fade.
        error_dynamics: ErrorDynamics,
        /// Where joints are wanted; the others stay where they begin.
        references: Vec<ReferenceDescription>,
    },
    /// `kind = "lqr"`.
    Lqr(RegulatorDescription),
    /// `kind = "energy_shaping"`.
    EnergyShaping {
        /// The joints by which energy goes in and out.
        ports: Vec<PortDescription>,
        /// Where joints are wanted; the others at home.
        goals: Vec<GoalDescription>,
        /// Gain of the energy's own feedback.
        pump: f64,
    },
    /// `kind = "path"`.
    Path {
        /// The joint that is led.
        joint: Located<String>,
        /// The path.
        curve: Curve,
        /// How it is brought back to the path.
        gains: PathGains,
    },
    /// `kind = "mpc"`.
    Mpc {
        /// The goal and what deviations cost.
        regulator: RegulatorDescription,
        /// Periods that it looks ahead.
        horizon: usize,
        /// Largest efforts, one an input.
        limits: Located<PerFreedom>,
    },
}

impl LawDescription {
    /// Names of the kinds, as scene files write them.
    pub const NAMES: [&'static str; 5] =
        ["computed_torque", "lqr", "energy_shaping", "path", "mpc"];

    /// The name of its kind.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::ComputedTorque { .. } => Self::NAMES[0],
            Self::Lqr(_) => Self::NAMES[1],
            Self::EnergyShaping { .. } => Self::NAMES[2],
            Self::Path { .. } => Self::NAMES[3],
            Self::Mpc { .. } => Self::NAMES[4],
        }
    }
}

/// Where one joint is wanted over time.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceDescription {
    /// The joint.
    pub joint: Located<String>,
    /// How it moves.
    pub motion: ReferenceMotion,
}

/// How a joint is wanted to move.
#[derive(Clone, Debug, PartialEq)]
pub enum ReferenceMotion {
    /// By its own speeds.
    Speeds {
        /// Its speeds.
        speeds: Located<Vec<Law>>,
        /// Where the reference begins; `None` for where the joint itself begins.
        start: Option<Position>,
    },
    /// By the values of its ports.
    Ports(Vec<PortReferenceDescription>),
}

/// Where one port is wanted over time.
#[derive(Clone, Debug, PartialEq)]
pub struct PortReferenceDescription {
    /// The port.
    pub name: Located<String>,
    /// Its value at time 0, rad or m; `None` for where it is then.
    pub start: Option<f64>,
    /// How it goes on.
    pub law: Law,
}

/// Where one joint is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalDescription {
    /// The joint.
    pub joint: Located<String>,
    /// Its configuration there.
    pub position: Position,
}

/// A joint by which energy goes in and out.
#[derive(Clone, Debug, PartialEq)]
pub struct PortDescription {
    /// The joint.
    pub joint: Located<String>,
    /// A port of it; `None` for the joint as a whole.
    pub port: Option<Located<String>>,
    /// What it adds to the energy.
    pub spring: PortSpring,
    /// Injected damping.
    pub damping: f64,
    /// Largest effort; infinity for none.
    pub limit: f64,
}

/// A goal, the joints that have inputs, and what deviations cost.
#[derive(Clone, Debug, PartialEq)]
pub struct RegulatorDescription {
    /// The joints that have inputs; `None` for all of them.
    pub actuated: Option<Vec<Located<String>>>,
    /// Where joints are wanted; the others at home.
    pub goals: Vec<GoalDescription>,
    /// Weights of positions (one per degree of freedom), speeds (one per speed) and efforts (one an input).
    pub weights: [Located<PerFreedom>; 3],
}

/// A controller that fits the mechanism of its scene.
#[derive(Clone, Debug)]
pub struct Control {
    /// Time between two readings of the state, after which efforts are held, s; `None` for feedback at every instant.
    pub period: Option<f64>,
    /// What it does, in words.
    pub kind: &'static str,
    pub(crate) law: ControlLaw,
}

/// The laws with all that they are made from.
#[derive(Clone, Debug)]
pub(crate) enum ControlLaw {
    ComputedTorque {
        start: Vec<f64>,
        laws: Vec<Law>,
        ports: Vec<PortReference>,
        error_dynamics: ErrorDynamics,
    },
    Lqr(Goal),
    EnergyShaping {
        goal: Vec<f64>,
        ports: Vec<Port>,
        pump: Pump,
    },
    Path {
        body: usize,
        curve: Curve,
        gains: PathGains,
    },
    Mpc {
        goal: Goal,
        horizon: usize,
        period: f64,
        limits: Vec<f64>,
    },
}

/// A goal for a regulator.
#[derive(Clone, Debug)]
pub(crate) struct Goal {
    pub(crate) configuration: Vec<f64>,
    pub(crate) actuated: Vec<usize>,
    pub(crate) weights: Weights,
}

impl Goal {
    fn equilibrium(&self, mechanism: Arc<Mechanism>) -> Result<Equilibrium, ControlError> {
        Equilibrium::new(mechanism, self.configuration.clone(), &self.actuated)
    }
}

impl Control {
    /// The controller in the file `path`, which holds `hamel = 1` and a `[controller]` as a scene does, fitted to `scene` in its place.
    ///
    /// # Errors
    /// A file that cannot be read, and all mistakes of its text; joints that the scene does not have; what the law refuses.
    pub fn load(path: impl AsRef<Path>, scene: &Scene) -> Result<Self, Diagnostics> {
        let (text, name) = read_file(path.as_ref())?;
        Self::parse(&text, &name, scene)
    }

    /// As [`Control::load`], from a text that messages call `source_name`.
    ///
    /// # Errors
    /// As those of [`Control::load`].
    pub fn parse(text: &str, source_name: &str, scene: &Scene) -> Result<Self, Diagnostics> {
        let mut sink = Sink::default();
        let begin = (scene.configuration.as_slice(), scene.settings.t_end);
        let joints = scene.mechanism.joints();
        let joints = joints.map(|(_, body)| body.joint_name()).collect();
        let found = match parse::controller(text, &joints, &mut sink) {
            Some(description) if sink.len() == 0 => {
                build::control(&description, &scene.mechanism, begin, &mut sink)
            }
            _ => None,
        };
        match found {
            Some(control) if sink.len() == 0 => Ok(control),
            _ => Err(sink.refuse(source_name, text, "the controller is not complete")),
        }
    }

    /// The controller, with the memory that it works in, for a simulation until `t_end` (s).
    ///
    /// # Errors
    /// What the law refuses of the mechanism or of its numbers.
    pub fn controller(
        &self,
        mechanism: &Arc<Mechanism>,
        t_end: f64,
    ) -> Result<Box<dyn Controller>, ControlError> {
        let mechanism = Arc::clone(mechanism);
        Ok(match &self.law {
            ControlLaw::ComputedTorque {
                start,
                laws,
                ports,
                error_dynamics,
            } => {
                let reference = Reference::new(mechanism, start, laws.clone(), t_end)?;
                let law = ComputedTorque::new(reference, *error_dynamics)?.at_ports(ports)?;
                Box::new(match self.period {
                    Some(period) => law.held(period)?,
                    None => law,
                })
            }
            ControlLaw::Lqr(goal) => {
                let equilibrium = goal.equilibrium(mechanism)?;
                let law = Regulator::new(equilibrium, &goal.weights)?;
                Box::new(match self.period {
                    Some(period) => law.held(period)?,
                    None => law,
                })
            }
            ControlLaw::EnergyShaping { goal, ports, pump } => {
                Box::new(EnergyShaping::new(mechanism, goal, ports.clone(), *pump)?)
            }
            ControlLaw::Path { body, curve, gains } => {
                Box::new(PathFollower::new(mechanism, *body, *curve, *gains)?)
            }
            ControlLaw::Mpc {
                goal,
                horizon,
                period,
                limits,
            } => {
                let equilibrium = goal.equilibrium(mechanism)?;
                predictive(equilibrium, &goal.weights, *horizon, *period, limits)?
            }
        })
    }
}

#[cfg(feature = "predictive")]
fn predictive(
    equilibrium: Equilibrium,
    weights: &Weights,
    horizon: usize,
    period: f64,
    limits: &[f64],
) -> Result<Box<dyn Controller>, ControlError> {
    use hamel_control::PredictiveRegulator;
    let regulator = PredictiveRegulator::new(equilibrium, weights, horizon, period, limits)?;
    Ok(Box::new(regulator))
}

#[cfg(not(feature = "predictive"))]
fn predictive(
    _: Equilibrium,
    _: &Weights,
    _: usize,
    _: f64,
    _: &[f64],
) -> Result<Box<dyn Controller>, ControlError> {
    Err(ControlError::NoPrediction)
}
