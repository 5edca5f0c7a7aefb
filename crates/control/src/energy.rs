//! Energy shaping and damping injection through the ports of the Hamiltonian form.

use super::error::require;
use super::state::{check_state, store_measures};
use super::{ControlError, Controller, Measure};
use alloc::collections::BTreeSet;
use alloc::format;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, Recursive};
use hamel_runtime::elements::{Action, Element, JointSpring, MotionList, RotationSpring, View};
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::Mechanism;

/// The energy that a port adds to the mechanism's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PortSpring {
    /// `½ k |ϕ|²` with ϕ the local coordinates from the goal, k in N m/rad² or N/m: as strong at half a turn as it can be, and discontinuous there.
    Log(f64),
    /// `k (3 − tr R)/2` with R the rotation from the goal, k in N m: smooth everywhere, and at rest at half a turn too.
    Trace(f64),
}

/// A joint by whose port energy goes in and out: u = its τ, y = ∂H/∂p = its v.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Port {
    /// The body that the joint carries.
    pub body: usize,
    /// What it adds to the energy.
    pub spring: PortSpring,
    /// `d` of the injected damping `−d y`, N m s/rad or N s/m; not negative.
    pub damping: f64,
    /// The largest |u|, N m or N; infinity for none.
    pub limit: f64,
}

/// Feeds a mechanism until it has the energy of its goal, and drains what is above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pump {
    /// `g` of `−g (H_d − H_d*) y`, N m s/(rad J) or N s/(m J); not negative. 0 for none.
    pub gain: f64,
}

/// `u = −∂V_s/∂Q − (d + g (H_d − H_d*)) y` at each port.
///
/// With the springs' V_s the closed loop is Hamiltonian again, with `H_d = H + V_s`, and with passive joints as well: nothing has to match. Where nothing else does
/// work on the mechanism (no damper, wrench or prescribed motion) it loses `Ḣ_d = −Σ (d + g (H_d − H_d*)) |y|²`, as long as no port is at its limit. So it settles where H_d is least as long as g = 0; with d = 0 and
/// g > 0 it comes to the energy of the goal at rest, `H_d*`, and swings a pendulum up.
///
/// (R. Ortega, A. J. van der Schaft, B. Maschke and G. Escobar, *Interconnection and damping assignment passivity-based control of port-controlled
/// Hamiltonian systems*, 2002, with J_d = J; K. J. Åström and K. Furuta, *Swinging up a pendulum by energy control*, 2000.)
#[derive(Clone, Debug)]
pub struct EnergyShaping {
    dynamics: Recursive,
    mechanism: Arc<Mechanism>,
    ports: Vec<Port>,
    springs: Vec<Arc<dyn Element>>,
    pump: Pump,
    /// H_d*, J.
    level: f64,
    momenta: Vec<f64>,
    /// What springs would do to bodies: nothing, as they are at joints.
    wrenches: Vec<nalgebra::Vector6<f64>>,
    motions: MotionList,
}

impl EnergyShaping {
    /// The law that has its least energy at the configuration `goal`, as far as `ports` see to it.
    ///
    /// # Errors
    /// No such body; numbers out of range; a wrong size; a joint whose motion is prescribed, or that has two ports.
    pub fn new(
        mechanism: Arc<Mechanism>,
        goal: &[f64],
        ports: Vec<Port>,
        pump: Pump,
    ) -> Result<Self, ControlError> {
        mechanism.check_configuration(goal)?;
        let mut seen = BTreeSet::new();
        for port in &ports {
            if !seen.insert(port.body) {
                return Err(ControlError::Joint {
                    joint: mechanism.body(port.body)?.joint_name().into(),
                    reason: "has two ports: the limit of one would cut off what the other does",
                });
            }
        }
        let gain = pump.gain;
        require(
            "gain of the pump",
            gain,
            gain >= 0.0,
            "at least 0 and finite",
        )?;
        let springs: Result<Vec<_>, ControlError> = ports
            .iter()
            .map(|port| spring(&mechanism, goal, port))
            .collect();
        let layout = *mechanism.layout();
        let mut shaping = Self {
            dynamics: Recursive::new(Arc::clone(&mechanism)),
            ports,
            springs: springs?,
            pump,
            level: 0.0,
            momenta: vec![0.0; layout.speeds],
            wrenches: vec![nalgebra::Vector6::zeros(); mechanism.bodies().len()],
            motions: MotionList(Vec::new()),
            mechanism,
        };
        shaping.level = shaping.energy(goal, &vec![0.0; layout.speeds])?;
        Ok(shaping)
    }

    /// H_d at `q` and v̄, J.
    ///
    /// # Errors
    /// A wrong size; a singular mass matrix.
    pub fn energy(&mut self, q: &[f64], speeds: &[f64]) -> Result<f64, ControlError> {
        self.dynamics.momenta(q, speeds, &mut self.momenta)?;
        let energy = self.dynamics.hamiltonian(q, &self.momenta)?;
        let view = View::new(&self.mechanism, q, speeds, &self.motions);
        let springs = self.springs.iter().map(|spring| spring.energy(&view));
        Ok(energy + springs.sum::<f64>())
    }

    /// u of all ports without their limits, into `efforts`.
    fn inject(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), ControlError> {
        let surplus = match self.pump.gain {
            0.0 => 0.0,
            gain => gain * (self.energy(q, speeds)? - self.level),
        };
        efforts.fill(0.0);
        let view = View::new(&self.mechanism, q, speeds, &self.motions);
        for (port, spring) in self.ports.iter().zip(&self.springs) {
            spring.act(&view, &mut Action::new(&mut self.wrenches, efforts));
            let mut buffer = [0.0; MOST_FREEDOMS];
            let output = view.joint_velocity(port.body, &mut buffer);
            let own = self.mechanism.bodies()[port.body].ranges().freedoms.clone();
            for (u, y) in efforts[own].iter_mut().zip(output) {
                *u -= (port.damping + surplus) * y;
            }
        }
        Ok(())
    }

    /// H_d*: the energy of the goal at rest, J.
    pub const fn level(&self) -> f64 {
        self.level
    }
}

/// V_s of one port, as the spring that it is.
fn spring(
    mechanism: &Mechanism,
    goal: &[f64],
    port: &Port,
) -> Result<Arc<dyn Element>, ControlError> {
    let body = mechanism.body(port.body)?;
    let joint = body.joint_name();
    if mechanism.is_driven(port.body) {
        return Err(ControlError::Joint {
            joint: joint.into(),
            reason: "has a prescribed motion",
        });
    }
    let damping = port.damping;
    require(
        "damping of a port",
        damping,
        damping >= 0.0,
        "at least 0 and finite",
    )?;
    if port.limit.is_nan() || port.limit <= 0.0 {
        return Err(ControlError::Value {
            quantity: "limit of a port",
            value: port.limit,
            requirement: "above 0",
        });
    }
    let name = format!("port of joint `{joint}`");
    let rest = body.configuration(goal);
    let spring: Arc<dyn Element> = match port.spring {
        PortSpring::Log(stiffness) => {
            require(
                "stiffness of a port",
                stiffness,
                stiffness >= 0.0,
                "at least 0 and finite",
            )?;
            let size = body.ranges().freedoms.len();
            let diagonal = |i: usize| {
                if i.is_multiple_of(size + 1) {
                    stiffness
                } else {
                    0.0
                }
            };
            Arc::new(JointSpring {
                name,
                body: port.body,
                stiffness: (0..size * size).map(diagonal).collect(),
                rest: rest.to_vec(),
            })
        }
        PortSpring::Trace(stiffness) => Arc::new(RotationSpring {
            name,
            body: port.body,
            stiffness,
            rest: body.joint().pose(rest).rotation,
        }),
    };
    spring.check(mechanism)?;
    Ok(spring)
}

impl Controller for EnergyShaping {
    fn efforts(
        &mut self,
        _time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) -> Result<(), ControlError> {
        check_state(&self.mechanism, q, speeds, efforts)?;
        self.inject(q, speeds, efforts)?;
        for port in &self.ports {
            let own = self.mechanism.bodies()[port.body].ranges().freedoms.clone();
            shorten(port.limit, &mut efforts[own]);
        }
        Ok(())
    }

    fn bends(
        &mut self,
        _time: f64,
        q: &[f64],
        speeds: &[f64],
        bends: &mut Vec<f64>,
    ) -> Result<(), ControlError> {
        if self.ports.iter().all(|port| port.limit.is_infinite()) {
            return Ok(());
        }
        let mut efforts = vec![0.0; self.mechanism.layout().freedoms];
        check_state(&self.mechanism, q, speeds, &efforts)?;
        self.inject(q, speeds, &mut efforts)?;
        for port in &self.ports {
            let own = self.mechanism.bodies()[port.body].ranges().freedoms.clone();
            bends.push(1.0 - length(&efforts[own]) / port.limit);
        }
        Ok(())
    }

    fn measures(&self) -> &'static [Measure] {
        &[Measure {
            name: "energy above the goal",
            unit: "J",
        }]
    }

    fn measure(
        &mut self,
        _time: f64,
        q: &[f64],
        speeds: &[f64],
        values: &mut [f64],
    ) -> Result<(), ControlError> {
        let found = [self.energy(q, speeds)? - self.level];
        store_measures(&found, values)
    }
}

/// |u| of one port.
fn length(input: &[f64]) -> f64 {
    num_traits::Float::sqrt(input.iter().map(|u| u * u).sum::<f64>())
}

/// Shortens u to the limit.
fn shorten(limit: f64, input: &mut [f64]) {
    let length = length(input);
    if length > limit {
        let shorter = limit / length;
        input.iter_mut().for_each(|u| *u *= shorter);
    }
}
