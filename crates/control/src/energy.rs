//! Energy shaping and damping injection through the ports of the Hamiltonian form.

use super::error::require;
use super::state::{check_state, store_measures};
use super::{ControlError, Controller, Measure};
use alloc::collections::BTreeSet;
use alloc::format;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, EffortAtPort, Recursive};
use hamel_runtime::elements::{
    self, Action, Element, JointSpring, MotionList, RotationSpring, View,
};
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::Mechanism;

/// The energy that a port adds to the mechanism's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PortSpring {
    /// `½ k |ϕ|²` with ϕ the local coordinates from the goal, or at a port how far it is from its value there, k in N m/rad² or N/m: as strong at half a turn
    /// as it can be, and discontinuous there.
    Log(f64),
    /// `k (3 − tr R)/2` with R the rotation from the goal, k in N m: smooth everywhere, and at rest at half a turn too.
    Trace(f64),
}

/// A joint by which energy goes in and out: u = its τ, y = ∂H/∂p = its v; or a port of the joint: u an effort there, y its rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Port {
    /// The body that the joint carries.
    pub body: usize,
    /// Index of the port among those of the joint; `None` for all of its τ.
    pub port: Option<usize>,
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
    /// u of each port.
    inputs: Vec<[f64; MOST_FREEDOMS]>,
    /// What springs at joints exert.
    exerted: Vec<f64>,
    /// What springs would do to bodies: nothing, as they are at joints.
    wrenches: Vec<nalgebra::Vector6<f64>>,
    motions: MotionList,
}

impl EnergyShaping {
    /// The law that has its least energy at the configuration `goal`, as far as `ports` see to it.
    ///
    /// # Errors
    /// No such body or port; numbers out of range; a wrong size; a joint whose motion is prescribed, or that is given twice as a whole or with the same port.
    pub fn new(
        mechanism: Arc<Mechanism>,
        goal: &[f64],
        ports: Vec<Port>,
        pump: Pump,
    ) -> Result<Self, ControlError> {
        mechanism.check_configuration(goal)?;
        let mut seen = BTreeSet::new();
        for port in &ports {
            if !seen.insert((port.body, port.port)) {
                return Err(ControlError::Joint {
                    joint: mechanism.body(port.body)?.joint_name().into(),
                    reason: "is given twice, as a whole or with the same port: the limit of one would cut off what the other does",
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
            inputs: vec![[0.0; MOST_FREEDOMS]; ports.len()],
            exerted: vec![0.0; layout.freedoms],
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

    /// u of all ports without their limits.
    fn inject(&mut self, q: &[f64], speeds: &[f64]) -> Result<(), ControlError> {
        let surplus = match self.pump.gain {
            0.0 => 0.0,
            gain => gain * (self.energy(q, speeds)? - self.level),
        };
        let view = View::new(&self.mechanism, q, speeds, &self.motions);
        let all = self.ports.iter().zip(&self.springs).zip(&mut self.inputs);
        for ((port, spring), input) in all {
            let damping = port.damping + surplus;
            if let Some(index) = port.port {
                let (.., pull) = spring.port_effort(&view).unwrap_or((0, 0, f64::NAN));
                let (_, rate) = view.port(port.body, index);
                input[0] = pull - damping * rate;
                continue;
            }
            self.exerted.fill(0.0);
            spring.act(
                &view,
                &mut Action::new(&mut self.wrenches, &mut self.exerted),
            );
            let mut buffer = [0.0; MOST_FREEDOMS];
            let output = view.joint_velocity(port.body, &mut buffer);
            let own = self.mechanism.bodies()[port.body].ranges().freedoms.clone();
            for ((u, y), pull) in input.iter_mut().zip(output).zip(&self.exerted[own]) {
                *u = pull - damping * y;
            }
        }
        Ok(())
    }

    /// How many entries u of a port has.
    fn size(&self, port: &Port) -> usize {
        let own = &self.mechanism.bodies()[port.body];
        port.port.map_or(own.ranges().freedoms.len(), |_| 1)
    }

    /// Adds u of a port, with its limit, to τ.
    fn add(&self, index: usize, q: &[f64], efforts: &mut [f64]) {
        let (port, mut input) = (&self.ports[index], self.inputs[index]);
        shorten(port.limit, &mut input[..self.size(port)]);
        let owner = &self.mechanism.bodies()[port.body];
        let own = efforts[owner.ranges().freedoms.clone()].iter_mut();
        let mut row = [1.0; MOST_FREEDOMS];
        if let Some(index) = port.port {
            let row = &mut row[..own.len()];
            owner.joint().port_row(owner.configuration(q), index, row);
            input = [input[0]; MOST_FREEDOMS];
        }
        for ((sum, u), weight) in own.zip(input).zip(row) {
            *sum += weight * u;
        }
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
    let spring: Arc<dyn Element> = match (port.spring, port.port) {
        (PortSpring::Log(stiffness), Some(index)) => {
            require(
                "stiffness of a port",
                stiffness,
                stiffness >= 0.0,
                "at least 0 and finite",
            )?;
            // Of a port that is not there the check tells.
            let value = body.joint().port_value(rest, index);
            Arc::new(elements::PortSpring {
                name,
                body: port.body,
                port: index,
                stiffness,
                damping: 0.0,
                rest: if value.is_finite() { value } else { 0.0 },
            })
        }
        (PortSpring::Trace(_), Some(_)) => {
            return Err(ControlError::Joint {
                joint: joint.into(),
                reason: "has a spring of kind \"trace\" at a port, which is no rotation: give one of kind \"log\"",
            });
        }
        (PortSpring::Log(stiffness), None) => {
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
        (PortSpring::Trace(stiffness), None) => Arc::new(RotationSpring {
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
        self.inject(q, speeds)?;
        efforts.fill(0.0);
        for index in 0..self.ports.len() {
            self.add(index, q, efforts);
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
        check_state(&self.mechanism, q, speeds, &self.exerted)?;
        self.inject(q, speeds)?;
        for (port, input) in self.ports.iter().zip(&self.inputs) {
            bends.push(1.0 - length(&input[..self.size(port)]) / port.limit);
        }
        Ok(())
    }

    fn efforts_at_ports(
        &mut self,
        _time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut Vec<EffortAtPort>,
    ) -> Result<(), ControlError> {
        check_state(&self.mechanism, q, speeds, &self.exerted)?;
        self.inject(q, speeds)?;
        for (port, input) in self.ports.iter().zip(&self.inputs) {
            let Some(index) = port.port else {
                continue;
            };
            let mut effort = [input[0]];
            shorten(port.limit, &mut effort);
            efforts.push(EffortAtPort {
                body: port.body,
                port: index,
                effort: effort[0],
            });
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
