//! The equations of motion of a robot, by the general algorithms or compiled for it.

use hamel::Error;
use hamel::compiled::Compiled;
use hamel::dynamics::{Dynamics, ForwardDerivatives, InverseDerivatives, MassMatrix, Recursive};
use hamel::mechanism::Mechanism;
use std::sync::Arc;

/// Numbers of the pose of a body in compiled equations: a rotation by rows, and an origin.
const POSE: usize = 12;

/// The equations of one robot, for one thread.
pub enum Equations {
    /// Those of any mechanism.
    Tree(Box<Tree>),
    /// Functions that were compiled for this one; what they do not tell, their tree does.
    Compiled(Box<Compiled>, Vec<f64>),
}

/// The general algorithms, and room for M̄.
pub struct Tree {
    dynamics: Recursive,
    mass: MassMatrix,
}

impl Equations {
    /// The general algorithms for a mechanism.
    pub fn tree_of(mechanism: &Arc<Mechanism>) -> Self {
        Self::Tree(Box::new(Tree {
            dynamics: Recursive::new(Arc::clone(mechanism)),
            mass: MassMatrix::new(mechanism),
        }))
    }

    /// Those that were compiled.
    pub fn compiled(compiled: &Compiled) -> Self {
        let bodies = compiled.mechanism().bodies().len();
        Self::Compiled(Box::new(compiled.clone()), vec![0.0; POSE * bodies])
    }

    /// The general algorithms.
    pub fn tree(&mut self) -> &mut Recursive {
        match self {
            Self::Tree(own) => &mut own.dynamics,
            Self::Compiled(own, _) => own.tree(),
        }
    }

    /// v̄̇.
    pub fn forward_dynamics(
        &mut self,
        [q, v, tau]: [&[f64]; 3],
        rates: &mut [f64],
    ) -> Result<(), Error> {
        Ok(match self {
            Self::Tree(own) => own.dynamics.forward_dynamics(q, v, tau, rates),
            Self::Compiled(own, _) => own.forward_dynamics(q, v, tau, rates),
        }?)
    }

    /// `S̄ᵀτ`.
    pub fn inverse_dynamics(
        &mut self,
        [q, v, a]: [&[f64]; 3],
        efforts: &mut [f64],
    ) -> Result<(), Error> {
        Ok(match self {
            Self::Tree(own) => own.dynamics.inverse_dynamics(q, v, a, efforts),
            Self::Compiled(own, _) => own.inverse_dynamics(q, v, a, efforts),
        }?)
    }

    /// Inverse dynamics at v̄̇ = 0.
    pub fn bias_forces(&mut self, [q, v]: [&[f64]; 2], bias: &mut [f64]) -> Result<(), Error> {
        Ok(match self {
            Self::Tree(own) => own.dynamics.bias_forces(q, v, bias),
            Self::Compiled(own, _) => own.bias_forces(q, v, bias),
        }?)
    }

    /// M̄ by rows.
    pub fn mass_matrix(&mut self, q: &[f64], rows: &mut [f64]) -> Result<(), Error> {
        match self {
            Self::Tree(own) => {
                own.dynamics.mass_matrix(q, &mut own.mass)?;
                let size = own.mass.size();
                for (index, entry) in rows.iter_mut().enumerate() {
                    *entry = own.mass.entry(index / size, index % size);
                }
                Ok(())
            }
            Self::Compiled(own, _) => Ok(own.mass_matrix(q, rows)?),
        }
    }

    /// v̄̇ and its derivatives.
    pub fn forward_derivatives(
        &mut self,
        [q, v, tau]: [&[f64]; 3],
        out: &mut ForwardDerivatives,
    ) -> Result<(), Error> {
        Ok(match self {
            Self::Tree(own) => own.dynamics.forward_dynamics_derivatives(q, v, tau, out),
            Self::Compiled(own, _) => own.forward_dynamics_derivatives(q, v, tau, out),
        }?)
    }

    /// The derivatives of inverse dynamics.
    pub fn inverse_derivatives(
        &mut self,
        [q, v, a]: [&[f64]; 3],
        out: &mut InverseDerivatives,
    ) -> Result<(), Error> {
        Ok(match self {
            Self::Tree(own) => own.dynamics.inverse_dynamics_derivatives(q, v, a, out),
            Self::Compiled(own, _) => own.inverse_dynamics_derivatives(q, v, a, out),
        }?)
    }

    /// Kinetic and potential energy.
    pub fn energies(&mut self, [q, v]: [&[f64]; 2]) -> Result<[f64; 2], Error> {
        match self {
            Self::Tree(own) => {
                let found = own.dynamics.mechanism().kinematics(q, v)?;
                Ok([found.kinetic_energy(), found.potential_energy()])
            }
            Self::Compiled(own, _) => Ok(own.energies(q, v)?),
        }
    }

    /// Poses of all bodies, 4×4 by rows, with speeds of a mechanism at rest.
    pub fn poses(&mut self, q: &[f64], rest: &[f64], out: &mut [f64]) -> Result<(), Error> {
        match self {
            Self::Tree(own) => {
                let readings = own.dynamics.readings(q, rest)?;
                for (body, out) in out.chunks_exact_mut(16).enumerate() {
                    let matrix = readings.pose(body)?.matrix();
                    for (entry, place) in out.iter_mut().zip(0..16) {
                        *entry = matrix[(place / 4, place % 4)];
                    }
                }
            }
            Self::Compiled(own, numbers) => {
                own.poses(q, numbers)?;
                let poses = numbers.chunks_exact(POSE);
                for (out, pose) in out.chunks_exact_mut(16).zip(poses) {
                    let (rotation, origin) = pose.split_at(9);
                    for (row, out) in out.chunks_exact_mut(4).take(3).enumerate() {
                        out[..3].copy_from_slice(&rotation[3 * row..3 * row + 3]);
                        out[3] = origin[row];
                    }
                    out[12..].copy_from_slice(&[0.0, 0.0, 0.0, 1.0]);
                }
            }
        }
        Ok(())
    }
}
