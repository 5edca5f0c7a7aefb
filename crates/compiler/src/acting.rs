//! Springs and states of joints, as a scene gives them, with the numbers that the joint's own kernels make of them.

use super::graph::{Sym, record};
use super::joint::Joint;
use super::model::Elements;
use super::products::JointType;
use hamel_codegen::derived::{KernelKind, Method};
use hamel_runtime::elements::{JointSpring, PortEffort, PortSpring, RotationSpring};
use hamel_runtime::mechanism::CONFIGURATION_TOLERANCE;
use hamel_scene::{BodyDescription, Coupling, Position, SpringEnergy};
use nalgebra::{DMatrix, DVector, Matrix3};

/// Why a pose is no rest.
const OF_POSE: &str =
    "to find the configuration of a pose takes iterations: give `configuration` or `phi`";

/// The index of a joint's port.
pub fn port_of(body: &BodyDescription, joint: &JointType, name: &str) -> Option<usize> {
    let mut known = joint.derived.spec.ports.iter();
    match &body.joint.coupling {
        Some(coupling) => coupling.port(name),
        None => known.position(|port| port.value.name == name),
    }
}

/// A joint of a scene whose type and parameters are known.
pub struct Held<'a> {
    /// What of it is asked for, in messages.
    pub what: &'static str,
    /// Index of its body.
    pub index: usize,
    /// Its body.
    pub body: &'a BodyDescription,
    /// Its type.
    pub joint: &'a JointType,
    /// Values of the type's parameters.
    pub parameters: &'a [f64],
}

impl Held<'_> {
    /// Puts the joint's spring among the elements, if it has one.
    ///
    /// # Errors
    /// A spring that does not fit the joint, or that is not compiled.
    pub fn add_spring(&self, elements: &mut Elements) -> Result<(), String> {
        let Some(spring) = &self.body.forces.spring else {
            return Ok(());
        };
        let name = format!("spring of joint `{}`", self.body.joint.name.value);
        let (body, rest) = (self.index, &spring.value.rest);
        let stiffness = match &spring.value.energy {
            SpringEnergy::Trace(stiffness) => {
                elements.rotation_springs.push(RotationSpring {
                    name,
                    body,
                    stiffness: *stiffness,
                    rest: self.rest_rotation(rest)?,
                });
                return Ok(());
            }
            SpringEnergy::Diagonal(numbers) => numbers
                .spread(self.joint.derived.shape.freedoms)
                .map(|numbers| DMatrix::from_diagonal(&DVector::from_vec(numbers))),
            SpringEnergy::Full(matrix) => Some(matrix.clone()),
        };
        let size = self.joint.derived.shape.freedoms;
        let fits = |matrix: &DMatrix<f64>| matrix.shape() == (size, size);
        let stiffness = stiffness
            .filter(fits)
            .ok_or_else(|| self.refused(&format!("stiffness must have {size} number(s)")))?;
        for kind in [KernelKind::Local, KernelKind::RetractDifferentialInverse] {
            self.in_closed_form(kind)?;
        }
        elements.joint_springs.push(JointSpring {
            name,
            body,
            stiffness: stiffness.transpose().as_slice().to_vec(),
            rest: self.rest(rest)?,
        });
        Ok(())
    }

    /// Puts what acts at the joint's ports among the elements.
    ///
    /// # Errors
    /// Ports that the joint's type does not have.
    pub fn add_ports(&self, elements: &mut Elements) -> Result<(), Vec<String>> {
        let (mut reasons, body) = (vec![], self.index);
        let (joint, kind) = (&self.body.joint.name.value, &self.body.joint.kind.value);
        for forces in &self.body.forces.ports {
            let name = &forces.name.value;
            let Some(port) = port_of(self.body, self.joint, name) else {
                reasons.push(format!(
                    "joint `{joint}`: its type `{kind}` has no port `{name}`"
                ));
                continue;
            };
            if let Some(effort) = &forces.effort {
                // Those that change with time come in with τ.
                let constant = effort.constant().map(|_| PortEffort {
                    name: forces.element("effort", joint),
                    body,
                    port,
                    effort: effort.clone(),
                });
                elements.port_efforts.extend(constant);
            }
            if forces.spring.is_some() || forces.damping > 0.0 {
                let rest = match forces.spring {
                    Some(spring) => spring.rest.map_or_else(|| self.home_value(port), Ok),
                    None => Ok(0.0),
                };
                let rest = rest.map_err(|reason| reasons.push(reason));
                let spring = forces.spring.unwrap_or_default();
                elements.port_springs.push(PortSpring {
                    name: forces.element("spring", joint),
                    body,
                    port,
                    stiffness: spring.stiffness,
                    damping: forces.damping,
                    rest: rest.unwrap_or_default(),
                });
            }
            let limit = forces.compliant_limit(joint, (body, port));
            elements.limits.extend(limit);
        }
        match reasons.is_empty() {
            true => Ok(()),
            false => Err(reasons),
        }
    }

    /// The value of a port at home.
    fn home_value(&self, port: usize) -> Result<f64, String> {
        let home = self.joint.derived.kernel(KernelKind::Home);
        if home.is_some_and(|home| home.method != Method::Formula) {
            let (joint, kind) = (&self.body.joint.name.value, &self.body.joint.kind.value);
            return Err(format!(
                "joint `{joint}`: home of `{kind}` is found by Newton's method, and what ports are there is not compiled: give the `rest` of springs at ports"
            ));
        }
        let home = self.rest(&Position::Home)?;
        let values = self.numbers(self.at(&home, |joint| joint.port_values()))?;
        values
            .get(port)
            .copied()
            .ok_or_else(|| self.refused("it is not finite"))
    }

    fn refused(&self, reason: &str) -> String {
        format!(
            "{} of joint `{}`: {reason}",
            self.what, self.body.joint.name.value
        )
    }

    /// Whether a kernel is a formula: what iterates is not compiled.
    fn in_closed_form(&self, kind: KernelKind) -> Result<(), String> {
        let kernel = self.joint.derived.kernel(kind);
        match kernel.is_some_and(|kernel| kernel.method == Method::Formula) {
            true => Ok(()),
            false => {
                let kind = &self.body.joint.kind.value;
                Err(self.refused(&format!(
                    "the local coordinates of `{kind}` have no closed form, and springs in them are not compiled"
                )))
            }
        }
    }

    /// The rotation of the joint at rest.
    fn rest_rotation(&self, rest: &Position) -> Result<Matrix3<f64>, String> {
        if let Position::Pose(pose) = rest {
            return Ok(pose.value.rotation);
        }
        let rest = self.rest(rest)?;
        let rotation = self.at(&rest, |joint| joint.rotation().iter().copied().collect());
        Ok(Matrix3::from_column_slice(&self.numbers(rotation)?))
    }

    /// The Q of a spring's rest, or of time 0.
    ///
    /// # Errors
    /// Numbers that do not fit the joint; a pose.
    pub fn rest(&self, rest: &Position) -> Result<Vec<f64>, String> {
        if let Some(coupling) = &self.body.joint.coupling {
            return self.rest_of_links(coupling, rest);
        }
        let home = || self.numbers(self.at(&[], |joint| joint.home()));
        match rest {
            Position::Home => home(),
            Position::Configuration(given) => self.projected(&given.value),
            Position::Phi(phi) => {
                let size = self.joint.derived.shape.freedoms;
                self.check_size("phi", size, phi.value.len())?;
                let phi: Vec<Sym> = phi.value.iter().copied().map(Sym::from).collect();
                self.numbers(self.at(&home()?, |joint| joint.retract(&phi)))
            }
            Position::Pose(_) => Err(self.refused(OF_POSE)),
        }
    }

    /// The same of a joint of links, as the tree has it.
    fn rest_of_links(&self, coupling: &Coupling, rest: &Position) -> Result<Vec<f64>, String> {
        let joint = coupling
            .joint()
            .map_err(|fault| self.refused(&fault.to_string()))?;
        let mut home = vec![0.0; joint.layout().configuration];
        joint.home(&mut home);
        match rest {
            Position::Home => Ok(home),
            Position::Configuration(given) => {
                self.check_size("configuration", home.len(), given.value.len())?;
                let mut projected = given.value.clone();
                let project = joint.project(&mut projected);
                project.map_err(|error| self.refused(&error.to_string()))?;
                self.near(&given.value, projected)
            }
            Position::Phi(phi) => {
                let size = self.joint.derived.shape.freedoms;
                self.check_size("phi", size, phi.value.len())?;
                let mut moved = home.clone();
                joint.retract(&home, &phi.value, &mut moved);
                self.numbers(moved.into_iter().map(Sym::from).collect())
            }
            Position::Pose(_) => Err(self.refused(OF_POSE)),
        }
    }

    fn check_size(&self, key: &str, size: usize, found: usize) -> Result<(), String> {
        match found == size {
            true => Ok(()),
            false => Err(self.refused(&format!("`{key}` must have {size} number(s)"))),
        }
    }

    /// A configuration given outright, freed of its rounding.
    fn projected(&self, given: &[f64]) -> Result<Vec<f64>, String> {
        let size = self.joint.derived.shape.configuration;
        self.check_size("configuration", size, given.len())?;
        self.in_closed_form(KernelKind::Project)?;
        let projected = self.numbers(self.at(given, |joint| joint.project()))?;
        self.near(given, projected)
    }

    /// The nearest point of the manifold, where what is given is on it up to rounding.
    fn near(&self, given: &[f64], projected: Vec<f64>) -> Result<Vec<f64>, String> {
        let away = given.iter().zip(&projected).map(|(a, b)| (a - b).abs());
        match away.fold(0.0, f64::max) {
            away if away <= CONFIGURATION_TOLERANCE => Ok(projected),
            away => Err(self.refused(&format!(
                "it is off the joint's manifold by {away:e}, more than {CONFIGURATION_TOLERANCE:e}"
            ))),
        }
    }

    /// What the joint's kernels make of a configuration in numbers.
    fn at(&self, q: &[f64], read: impl FnOnce(&Joint<'_>) -> Vec<Sym>) -> Vec<Sym> {
        let q: Vec<Sym> = q.iter().copied().map(Sym::from).collect();
        record(|| read(&Joint::new(self.joint, self.parameters, &q, &[]))).0
    }

    fn numbers(&self, values: Vec<Sym>) -> Result<Vec<f64>, String> {
        let finite = |value: Sym| value.number().filter(|number| number.is_finite());
        let numbers: Option<Vec<f64>> = values.into_iter().map(finite).collect();
        numbers.ok_or_else(|| self.refused("it is not finite"))
    }
}
