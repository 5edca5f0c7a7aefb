//! The same dynamics in O(n): recursions over the tree, without mass matrix, S, γ or derivative in ϕ.
//!
//! All spatial vectors of a body are read at the origin of its joint's child frame, in world axes, so that going from body to body is a shift
//! without a rotation. Outward: `V_i = V_λ + X̄ v̄` and `V̇_i = V̇_λ + X̄ v̄̇ + c + ad_V X̄ v̄`, from `V̇₀ = (0; −g)`.
//! Inward: `F_i = G V̇ − ad_Vᵀ G V + Σ F_child`; `X̄ᵀF` is (24) and (34).
//!
//! Forward dynamics solves `M̄ v̄̇ = S̄ᵀτ − (X̄ᵀF at v̄̇ = 0)` by articulated inertias; `v̄ = M̄⁻¹p̄` uses the same factors.
//!
//! After construction nothing allocates.

mod hamiltonian;
mod inverse;
mod jacobian;
mod link;
mod mass;
mod readings;
mod sweeps;

pub use mass::MassMatrix;
pub use readings::{Frame, Readings};

use super::{Dynamics, DynamicsError};
use crate::mechanism::{Body, Mechanism, StateError, WHOLE, check_size};
use crate::spatial::ArticulatedInertia;
use crate::steps::Pivot;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use link::{Link, Node, Rung};
use nalgebra::Vector6;

/// The recursive form of a mechanism's dynamics, with its workspace: one for each thread.
#[derive(Clone, Debug)]
pub struct Recursive {
    mechanism: Arc<Mechanism>,
    /// Whether S̄ is the identity for every joint.
    holonomic: bool,
    links: Vec<Link>,
    rungs: Vec<Rung>,
    world: Node,
    nodes: Vec<Node>,
    /// X̄, one column a speed.
    columns: Vec<Vector6<f64>>,
    /// Composite momenta of the columns, one a speed.
    momenta: Vec<Vector6<f64>>,
    inertias: Vec<ArticulatedInertia<f64>>,
    pivots: Vec<Pivot<f64>>,
    loads: Vec<f64>,
    /// `S̄ᵀτ`, one entry a speed.
    forces: Vec<f64>,
    /// τ, one entry a freedom.
    efforts: Vec<f64>,
}

impl Recursive {
    /// The recursive form of `mechanism`.
    pub fn new(mechanism: Arc<Mechanism>) -> Self {
        let world = Node::world(mechanism.gravity());
        let count = mechanism.bodies().len();
        let (speeds, freedoms) = (mechanism.layout().speeds, mechanism.layout().freedoms);
        Self {
            holonomic: mechanism.bodies().iter().all(is_holonomic),
            links: Link::all(mechanism.bodies()),
            rungs: mechanism.bodies().iter().map(Rung::new).collect(),
            nodes: vec![world.clone(); count],
            world,
            columns: vec![Vector6::zeros(); speeds],
            momenta: vec![Vector6::zeros(); speeds],
            inertias: vec![ArticulatedInertia::zero(); count],
            pivots: vec![Pivot::zero(); speeds],
            loads: vec![0.0; speeds],
            forces: vec![0.0; speeds],
            efforts: vec![0.0; freedoms],
            mechanism,
        }
    }

    /// Places all frames: what the other readings of one configuration start from.
    ///
    /// # Errors
    /// When `q` has the wrong size.
    pub fn set_configuration(&mut self, q: &[f64]) -> Result<(), StateError> {
        self.check(q, &[])?;
        self.place(q);
        Ok(())
    }

    fn check(&self, q: &[f64], vectors: &[(&'static str, usize)]) -> Result<(), StateError> {
        let layout = self.mechanism.layout();
        check_size(WHOLE, "configuration", layout.configuration, q.len())?;
        vectors
            .iter()
            .try_for_each(|&(quantity, found)| check_size(WHOLE, quantity, layout.speeds, found))
    }

    fn check_efforts(&self, efforts: &[f64]) -> Result<(), StateError> {
        let freedoms = self.mechanism.layout().freedoms;
        check_size(WHOLE, "efforts", freedoms, efforts.len())
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

    /// Loads of the forces, against the wrenches of the nodes, to rates.
    fn solve(&mut self, forces: &[f64], rates: &mut [f64]) -> Result<(), DynamicsError> {
        self.eliminate(forces)?;
        self.resolve(rates);
        Ok(())
    }
}

fn is_holonomic(body: &Body) -> bool {
    body.joint().structures().speed_basis.is_identity()
}

impl Dynamics for Recursive {
    fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    fn accelerations(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check(q, &[("speeds", speeds.len()), ("rates", rates.len())])?;
        self.check_efforts(efforts)?;
        self.advance(q, speeds, None);
        if self.holonomic {
            return self.solve(efforts, rates);
        }
        self.reduce_efforts(q, efforts);
        let forces = core::mem::take(&mut self.forces);
        let solved = self.solve(&forces, rates);
        self.forces = forces;
        solved
    }

    fn momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check(q, &[("speeds", speeds.len()), ("momenta", momenta.len())])?;
        self.weigh(q);
        self.set_twists(speeds);
        self.set_momenta();
        self.gather(momenta);
        Ok(())
    }

    fn speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check(q, &[("momenta", momenta.len()), ("speeds", speeds.len())])?;
        self.weigh(q);
        self.solve(momenta, speeds)
    }

    fn momentum_rates(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &mut dyn FnMut(&[f64], &mut [f64]),
        speeds: &mut [f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.check(q, &[("rates", rates.len())])?;
        self.speeds(q, momenta, speeds)?;
        let mut tau = core::mem::take(&mut self.efforts);
        efforts(speeds, &mut tau);
        self.reduce_efforts(q, &tau);
        self.efforts = tau;
        self.momentum_rates_at(q, speeds, rates);
        Ok(())
    }

    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError> {
        let mut speeds = core::mem::take(&mut self.forces);
        let solved = self.speeds(q, momenta, &mut speeds);
        let kinetic: f64 = momenta.iter().zip(&speeds).map(|(p, v)| 0.5 * p * v).sum();
        self.forces = speeds;
        solved.map(|()| kinetic + self.potential_energy_here())
    }
}
