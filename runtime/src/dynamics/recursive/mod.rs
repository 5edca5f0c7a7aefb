//! The same dynamics in O(n): recursions over the tree, without mass matrix, S, γ or derivative in ϕ.
//!
//! All spatial vectors of a body are read at the origin of its joint's child frame, in world axes, so that going from body to body is a shift
//! without a rotation. Outward: `V_i = V_λ + X̄ v̄` and `V̇_i = V̇_λ + X̄ v̄̇ + c + ad_V X̄ v̄`, from `V̇₀ = (0; −g)`.
//! Inward: `F_i = G V̇ − ad_Vᵀ G V + Σ F_child`; `X̄ᵀF` is (24) and (34).
//!
//! Forward dynamics solves `M̄ v̄̇ = S̄ᵀτ − (X̄ᵀF at v̄̇ = 0)` by articulated inertias; `v̄ = M̄⁻¹p̄` uses the same factors.
//!
//! Bodies with a tiny moment of inertia are the exception to world axes (`slender`).
//!
//! After construction nothing allocates.

mod block;
mod coupling;
mod derivatives;
mod elements;
mod frames;
mod hamiltonian;
mod inverse;
mod jacobian;
mod link;
mod loaded;
mod mass;
mod multipliers;
mod operational;
mod pins;
mod readings;
mod refined;
mod regressor;
mod rotors;
mod rows;
mod several;
mod slender;
mod sweeps;

pub use derivatives::{
    ForwardDerivatives, ForwardSecondDerivatives, HamiltonianDerivatives, InverseDerivatives,
    InverseMassMatrix, InverseSecondDerivatives, Sensitivity,
};
pub use frames::FrameReadings;
pub use loaded::LoadedMass;
pub use mass::MassMatrix;
pub use pins::{EffortAtPort, PinError, PinForce};
pub use readings::{Frame, Readings};
pub use refined::Refined;
pub use regressor::JointTorqueRegressor;

use super::{Dynamics, DynamicsError};
use crate::mechanism::{Body, Mechanism, Space, StateError};
use crate::spatial::ArticulatedInertia;
use crate::steps::Pivot;
use crate::time_function::Moment;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use coupling::Coupling;
use link::{Link, Node, Rung};
use nalgebra::Vector6;
use rotors::Rotor;
use rows::Climb;
use several::Group;
use slender::Slender;

/// The recursive form of a mechanism's dynamics, with its workspace: one for each thread.
#[derive(Clone, Debug)]
pub struct Recursive {
    mechanism: Arc<Mechanism>,
    /// Whether S̄ = 1 at every joint.
    holonomic: bool,
    /// Whether every joint is holonomic and nothing but gravity and inputs acts: τ is then all there is to solve for.
    plain: bool,
    /// Whether there are elements, or rotors that add velocity terms.
    acted_on: bool,
    links: Vec<Link>,
    rungs: Vec<Rung>,
    climbs: Vec<Climb>,
    world: Node,
    nodes: Vec<Node>,
    /// X̄ of each body, one column per speed of its joint.
    columns: Vec<Vector6<f64>>,
    /// Composite momenta of the columns.
    momenta: Vec<Vector6<f64>>,
    slender: Vec<Slender>,
    /// Rotors at ports.
    rotors: Vec<Rotor>,
    /// Joints that carry several bodies, or rotors at ports.
    groups: Vec<Group>,
    /// Room for entries with one for each body and each speed of its joint.
    unfolded: Vec<f64>,
    inertias: Vec<ArticulatedInertia<f64>>,
    pivots: Vec<Pivot<f64>>,
    loads: Vec<f64>,
    /// `S̄ᵀτ`, one entry per speed.
    forces: Vec<f64>,
    /// Efforts of the elements alone, one entry per degree of freedom.
    efforts: Vec<f64>,
    /// The same with τ.
    combined: Vec<f64>,
    /// τ of the inputs, one entry per degree of freedom.
    inputs: Vec<f64>,
    /// Wrenches of elements on the bodies, at the child frames' origins, in world axes.
    external: Vec<Vector6<f64>>,
    /// Prescribed rates of driven joints, one entry per speed; zero for the others.
    driven: Vec<f64>,
    coupling: Option<Coupling>,
    /// Efforts at ports that are among the inputs.
    port_efforts: Vec<EffortAtPort>,
    /// When elements act.
    moment: Moment,
}

impl Recursive {
    /// The recursive form of `mechanism`.
    pub fn new(mechanism: Arc<Mechanism>) -> Self {
        let world = Node::world(mechanism.gravity());
        let count = mechanism.bodies().len();
        let holonomic = |body: &Body| body.joint().structures().speed_basis.is_identity();
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        let columns = mechanism.columns();
        let links = Link::all(&mechanism);
        let rungs: Vec<Rung> = mechanism.bodies().iter().map(Rung::new).collect();
        Self {
            holonomic: mechanism.bodies().iter().all(holonomic),
            plain: false,
            acted_on: false,
            slender: Slender::all(&links),
            rotors: Rotor::all(&mechanism),
            groups: Group::all(&mechanism),
            unfolded: vec![0.0; columns],
            links,
            climbs: Climb::all(&rungs, &link::parents(&mechanism, |ranges| &ranges.columns)),
            rungs,
            nodes: vec![world.clone(); count],
            world,
            columns: vec![Vector6::zeros(); columns],
            momenta: vec![Vector6::zeros(); columns],
            inertias: vec![ArticulatedInertia::zero(); count],
            pivots: vec![Pivot::zero(); speeds],
            loads: vec![0.0; speeds],
            forces: vec![0.0; speeds],
            efforts: vec![0.0; freedoms],
            combined: vec![0.0; freedoms],
            inputs: vec![0.0; freedoms],
            external: vec![Vector6::zeros(); count],
            driven: vec![0.0; speeds],
            coupling: Coupling::new(&mechanism),
            port_efforts: Vec::new(),
            moment: Moment::default(),
            mechanism,
        }
        .classified()
    }

    /// What the sweeps can leave out.
    fn classified(mut self) -> Self {
        self.acted_on = !self.mechanism.elements().is_empty()
            || !self.rotors.is_empty()
            || self.links.iter().any(Link::turns_rotors);
        self.plain = self.holonomic
            && !self.acted_on
            && self.coupling.is_none()
            && self.mechanism.drives().is_empty();
        self
    }

    /// Places all frames: what the other readings of one configuration start from.
    ///
    /// # Errors
    /// When `q` has the wrong size, or is not finite; the frames of such a `q` have no value.
    pub fn set_configuration(&mut self, q: &[f64]) -> Result<(), StateError> {
        self.with_inputs(q, &[], |dynamics| {
            dynamics.place(q);
            Ok(())
        })
    }

    /// `task` with `q` and vectors with one entry per speed. That they have their sizes is checked before it, that they are finite after it: by
    /// then they are in the cache, while a look at all of them beforehand would wait for memory.
    #[inline]
    fn with_inputs<E: From<StateError>>(
        &mut self,
        q: &[f64],
        vectors: &[(&'static str, &[f64])],
        task: impl FnOnce(&mut Self) -> Result<(), E>,
    ) -> Result<(), E> {
        self.mechanism
            .check_room("configuration", Space::Configuration, q)?;
        for (quantity, own) in vectors {
            self.check_room(quantity, own)?;
        }
        let done = task(self);
        self.check(q, vectors)?;
        done
    }

    /// Whether `q` and vectors with one entry per speed have their sizes, and are finite.
    fn check(&self, q: &[f64], vectors: &[(&'static str, &[f64])]) -> Result<(), StateError> {
        let mechanism = &self.mechanism;
        mechanism.check_vector("configuration", Space::Configuration, q)?;
        let mut vectors = vectors.iter();
        vectors.try_for_each(|(quantity, own)| mechanism.check_vector(quantity, Space::Speeds, own))
    }

    /// Whether `room` for results has one entry per speed.
    fn check_room(&self, quantity: &'static str, room: &[f64]) -> Result<(), StateError> {
        self.mechanism.check_room(quantity, Space::Speeds, room)
    }

    /// Whether τ has one entry per degree of freedom, and is finite; where it is not, and a kernel at (q, v̄) is not either, that is the cause.
    fn check_efforts(&self, q: &[f64], speeds: &[f64], tau: &[f64]) -> Result<(), StateError> {
        let checked = self.mechanism.check_vector("efforts", Space::Freedoms, tau);
        checked.map_err(|error| match &error {
            StateError::NotFinite { .. } => self.mechanism.no_value(q, speeds).unwrap_or(error),
            _ => error,
        })
    }

    /// `task` at (q, v̄), and whether its results are finite, each with one entry per speed; an error is traced back to what is not finite first.
    fn finite<const N: usize>(
        &mut self,
        (q, speeds): (&[f64], &[f64]),
        names: [&'static str; N],
        results: [&mut [f64]; N],
        task: impl FnOnce(&mut Self, [&mut [f64]; N]) -> Result<(), DynamicsError>,
    ) -> Result<(), DynamicsError> {
        let mut results = results;
        let done = task(self, results.each_mut().map(|own| &mut **own));
        done.map_err(|error| self.mechanism.first_cause(error, q, speeds))?;
        let named: [_; N] = core::array::from_fn(|i| (names[i], Space::Speeds, &*results[i]));
        Ok(self.mechanism.check_finite((q, speeds), &named)?)
    }

    /// `S̄ᵀτ` of every joint.
    fn reduce_efforts(&mut self, q: &[f64], efforts: &[f64]) {
        for link in &self.links {
            link.joint.reduce_efforts(
                &q[link.configuration.clone()],
                &efforts[link.freedoms.clone()],
                &mut self.forces[link.speeds.clone()],
            );
        }
    }

    /// p̄̇ at the speeds that have just been found of momenta, into `rates`.
    fn rates_of_momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut dyn FnMut(&[f64], &mut [f64]),
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let mut tau = core::mem::take(&mut self.inputs);
        tau.fill(0.0);
        efforts(speeds, &mut tau);
        if let Err(cause) = self.check_efforts(q, speeds, &tau) {
            self.inputs = tau;
            return Err(cause.into());
        }
        self.act(q, speeds, Some(&tau));
        let coupled = self.with_coupling(|dynamics, coupling| {
            dynamics.coupled_rates(q, speeds, rates, coupling);
        });
        if coupled.is_none() {
            self.momentum_rates_at(q, speeds, rates);
        }
        self.set_driven_rates(&tau);
        self.copy_driven(&self.driven, rates);
        self.inputs = tau;
        Ok(())
    }

    /// Loads of the forces, against the wrenches of the nodes, to rates.
    fn solve(&mut self, forces: &[f64], rates: &mut [f64]) -> Result<(), DynamicsError> {
        self.eliminate(forces)?;
        self.resolve(rates);
        Ok(())
    }
}

impl Recursive {
    /// Runs `task` with the workspace of the constraints, if there are any.
    fn with_coupling<R>(&mut self, task: impl FnOnce(&mut Self, &mut Coupling) -> R) -> Option<R> {
        let mut coupling = self.coupling.take()?;
        let result = task(self, &mut coupling);
        self.coupling = Some(coupling);
        Some(result)
    }
}

impl Recursive {
    /// v̄̇ of arguments that have been checked.
    fn solve_accelerations(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        if self.plain {
            self.advance(q, speeds, None);
            return self.solve(efforts, rates);
        }
        let coupled = self.with_coupling(|dynamics, coupling| {
            dynamics.coupled_accelerations(q, speeds, efforts, rates, coupling)
        });
        if let Some(result) = coupled {
            return result;
        }
        self.set_driven_rates(efforts);
        let driven = core::mem::take(&mut self.driven);
        self.advance(q, speeds, Some(&driven));
        self.act(q, speeds, Some(efforts));
        self.relieve();
        let forces = core::mem::take(&mut self.forces);
        let solved = self.solve(&forces, rates);
        self.forces = forces;
        self.driven = driven;
        self.copy_driven(&self.driven, rates);
        solved
    }

    /// p̄ of arguments that have been checked.
    fn weigh_momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let coupled = self.with_coupling(|dynamics, coupling| {
            dynamics.coupled_momenta(q, speeds, momenta, coupling)
        });
        if let Some(result) = coupled {
            return result;
        }
        self.weigh(q);
        self.set_twists(speeds);
        self.set_momenta();
        self.gather(momenta);
        self.add_armature(speeds, momenta);
        self.copy_driven(speeds, momenta);
        Ok(())
    }

    /// v̄ of arguments that have been checked.
    fn solve_speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let coupled = self.with_coupling(|dynamics, coupling| {
            dynamics.coupled_speeds(q, momenta, speeds, coupling)
        });
        if let Some(result) = coupled {
            return result;
        }
        self.weigh(q);
        if self.mechanism.drives().is_empty() {
            return self.solve(momenta, speeds);
        }
        let mut driven = core::mem::take(&mut self.driven);
        self.copy_driven(momenta, &mut driven);
        self.set_twists(&driven);
        self.set_momenta();
        let solved = self.solve(momenta, speeds);
        self.copy_driven(&driven, speeds);
        self.driven = driven;
        self.set_twists(speeds);
        solved
    }
}

/// What stands for speeds where none are known yet.
const RESTING: &[f64] = &[];

impl Dynamics for Recursive {
    fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    fn set_moment(&mut self, moment: Moment) {
        self.moment = moment;
    }

    fn complete_speeds(&mut self, q: &[f64], speeds: &mut [f64]) -> Result<(), DynamicsError> {
        self.check(q, &[("speeds", speeds)])?;
        if self.coupling.is_none() {
            return Ok(());
        }
        self.finite((q, RESTING), ["speed"], [speeds], |dynamics, [speeds]| {
            dynamics
                .with_coupling(|dynamics, coupling| dynamics.complete(q, speeds, coupling))
                .unwrap_or(Ok(()))
        })
    }

    fn forward_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check_room("rates", rates)?;
        self.mechanism
            .check_room("efforts", Space::Freedoms, efforts)?;
        self.with_inputs(q, &[("speeds", speeds)], |dynamics| {
            let names = ["acceleration"];
            dynamics.finite((q, speeds), names, [rates], |dynamics, [rates]| {
                let done = dynamics.solve_accelerations(q, speeds, efforts, rates);
                dynamics.check_efforts(q, speeds, efforts)?;
                done
            })
        })
    }

    fn momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check_room("momenta", momenta)?;
        self.with_inputs(q, &[("speeds", speeds)], |dynamics| {
            let names = ["momentum"];
            dynamics.finite((q, speeds), names, [momenta], |dynamics, [momenta]| {
                dynamics.weigh_momenta(q, speeds, momenta)
            })
        })
    }

    fn speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check_room("speeds", speeds)?;
        self.with_inputs(q, &[("momenta", momenta)], |dynamics| {
            let names = ["speed"];
            dynamics.finite((q, RESTING), names, [speeds], |dynamics, [speeds]| {
                dynamics.solve_speeds(q, momenta, speeds)
            })
        })
    }

    fn momentum_rates(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &mut dyn FnMut(&[f64], &mut [f64]),
        speeds: &mut [f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check_room("rates", rates)?;
        self.speeds(q, momenta, speeds)?;
        let speeds = &*speeds;
        self.finite(
            (q, speeds),
            ["momentum rate"],
            [rates],
            |dynamics, [rates]| dynamics.rates_of_momenta(q, speeds, efforts, rates),
        )
    }

    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError> {
        let mut speeds = core::mem::take(&mut self.forces);
        let solved = self.speeds(q, momenta, &mut speeds);
        let energy = solved.map(|()| self.energy_here(q, &speeds));
        self.forces = speeds;
        energy
    }

    fn forward_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        out: &mut ForwardDerivatives,
    ) -> Result<(), DynamicsError> {
        Self::forward_dynamics_derivatives(self, q, speeds, efforts, out)
    }

    fn hamiltonian_derivatives(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError> {
        Self::hamiltonian_derivatives(self, q, momenta, efforts, out)
    }
}
