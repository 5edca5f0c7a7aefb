//! What Theorems 2 and 3 need of a mechanism at one configuration, to first order in ϕ.

use super::tree::Tree;
use crate::mechanism::{Body, Mechanism, Space, StateError};
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{DMatrix, DVector};

/// M, V, S, A and S̄ of a mechanism with their derivatives in ϕ, all at ϕ = 0.
///
/// With K degrees of freedom, S̄ speeds and C constraints in total. Slice k of a `…_gradient` is the derivative along ϕ_k.
#[derive(Clone, Debug)]
pub struct Expansion {
    /// M, K×K.
    pub mass_matrix: DMatrix<f64>,
    /// ∂M/∂ϕ, K slices of K×K.
    pub mass_matrix_gradient: Vec<DMatrix<f64>>,
    /// V in gravity, zero at the world's origin, J.
    pub potential: f64,
    /// ∂V/∂ϕ, K.
    pub potential_gradient: DVector<f64>,
    /// S = blockdiag S_i, K×K, (23).
    pub velocity_map: DMatrix<f64>,
    /// S⁻¹, K×K.
    pub velocity_map_inverse: DMatrix<f64>,
    /// ∂S/∂ϕ, K slices of K×K.
    pub velocity_map_gradient: Vec<DMatrix<f64>>,
    /// A = blockdiag A_i, K×C, and beside it the constraints that couple joints.
    pub constraint: DMatrix<f64>,
    /// S̄, K×S: blockdiag S̄_i; where constraints couple joints, its range is what they leave, in the independent speeds.
    pub speed_basis: DMatrix<f64>,
    /// ∂S̄/∂ϕ, K slices of K×S.
    pub speed_basis_gradient: Vec<DMatrix<f64>>,
    /// The independent among the speeds of the joints: all of them where no constraint couples joints.
    pub independent: Vec<usize>,
}

impl Expansion {
    pub(super) fn new(mechanism: &Mechanism, q: &[f64]) -> Result<Self, StateError> {
        let layout = mechanism.layout();
        mechanism.check_vector("configuration", Space::Configuration, q)?;
        if let Some(cause) = mechanism.no_value(q, &vec![0.0; layout.speeds]) {
            return Err(cause);
        }
        let (freedoms, speeds) = (layout.freedoms, layout.speeds);
        let mut expansion = Self {
            mass_matrix: DMatrix::zeros(freedoms, freedoms),
            mass_matrix_gradient: vec![DMatrix::zeros(freedoms, freedoms); freedoms],
            potential: 0.0,
            potential_gradient: DVector::zeros(freedoms),
            velocity_map: DMatrix::zeros(freedoms, freedoms),
            velocity_map_inverse: DMatrix::zeros(freedoms, freedoms),
            velocity_map_gradient: vec![DMatrix::zeros(freedoms, freedoms); freedoms],
            constraint: DMatrix::zeros(freedoms, layout.constraints),
            speed_basis: DMatrix::zeros(freedoms, speeds),
            speed_basis_gradient: vec![DMatrix::zeros(freedoms, speeds); freedoms],
            independent: (0..speeds)
                .filter(|speed| !mechanism.dependent_speeds().contains(speed))
                .collect(),
        };
        for (_, body) in mechanism.joints() {
            expansion.add_velocity_maps(body, body.configuration(q));
            expansion.add_constraint(body, body.configuration(q));
        }
        let tree = Tree::new(mechanism, q, &expansion.velocity_map);
        expansion.add_bodies(mechanism, &tree);
        expansion.add_armature(mechanism);
        expansion.add_port_armature(mechanism, q);
        expansion.couple(mechanism, &tree);
        Ok(expansion)
    }

    /// S, S⁻¹ and ∂S/∂ϕ of one joint, into their blocks.
    fn add_velocity_maps(&mut self, body: &Body, q: &[f64]) {
        let (joint, own) = (body.joint(), body.ranges().freedoms.clone());
        let size = own.len();
        set_block(&mut self.velocity_map, &own, &own, |out| {
            joint.velocity_map(q, out)
        });
        set_block(&mut self.velocity_map_inverse, &own, &own, |out| {
            joint.velocity_map_inverse(q, out);
        });
        let mut slices = vec![0.0; size * size * size];
        joint.velocity_map_gradient(q, &mut slices);
        set_gradient_blocks(&mut self.velocity_map_gradient, &own, &own, &slices);
    }

    /// A, S̄ and ∂S̄/∂ϕ of one joint, into their blocks.
    fn add_constraint(&mut self, body: &Body, q: &[f64]) {
        let (joint, ranges) = (body.joint(), body.ranges());
        let (own, speeds) = (&ranges.freedoms, &ranges.speeds);
        set_block(&mut self.constraint, own, &ranges.constraints, |out| {
            joint.constraint(q, out)
        });
        set_block(&mut self.speed_basis, own, speeds, |out| {
            joint.speed_basis(q, out)
        });
        let mut slices = vec![0.0; own.len() * own.len() * speeds.len()];
        joint.speed_basis_gradient(q, &mut slices);
        set_gradient_blocks(&mut self.speed_basis_gradient, own, speeds, &slices);
    }

    /// Rotor inertias on the diagonal of M. They are constant in Q, so that ∂M/∂ϕ has no part of theirs; where v is no rate of coordinates,
    /// S and ∂S/∂ϕ bring in what a rotor exerts, as they do for every other part of M.
    fn add_armature(&mut self, mechanism: &Mechanism) {
        for (index, body) in mechanism.joints() {
            let freedoms = body.ranges().freedoms.clone();
            for (k, inertia) in freedoms.zip(mechanism.armature(index)) {
                self.mass_matrix[(k, k)] += inertia;
            }
        }
    }

    /// Rotors at ports: `a PᵀP` in M, and `a (∂PᵀP + Pᵀ∂P)` in ∂M/∂ϕ.
    fn add_port_armature(&mut self, mechanism: &Mechanism, q: &[f64]) {
        for (index, body) in mechanism.joints() {
            let (own, joint) = (body.ranges().freedoms.clone(), body.joint());
            let (size, q) = (own.len(), body.configuration(q));
            let mut row = DVector::zeros(size);
            let mut slopes = DMatrix::zeros(size, size);
            for (port, &inertia) in mechanism.port_armature(index).iter().enumerate() {
                joint.port_row(q, port, row.as_mut_slice());
                joint.port_row_gradient(q, port, slopes.as_mut_slice());
                let corner = ((own.start, own.start), (size, size));
                let mut mass = self.mass_matrix.view_mut(corner.0, corner.1);
                mass += &row * row.transpose() * inertia;
                for (gradient, slope) in self.mass_matrix_gradient[own.clone()]
                    .iter_mut()
                    .zip(slopes.column_iter())
                {
                    let half = slope * row.transpose() * inertia;
                    let mut gradient = gradient.view_mut(corner.0, corner.1);
                    gradient += &half + half.transpose();
                }
            }
        }
    }

    /// M = Σ JᵀGJ, ∂M/∂ϕ = Σ ∂JᵀGJ + JᵀG∂J, V and ∂V/∂ϕ, over the bodies.
    fn add_bodies(&mut self, mechanism: &Mechanism, tree: &Tree) {
        for (body, motion) in mechanism.bodies().iter().zip(&tree.bodies) {
            let inertia = body.joint_inertia().matrix();
            let momentum = inertia * &motion.jacobian;
            self.mass_matrix += motion.jacobian.tr_mul(&momentum);
            for (k, slope) in motion.jacobian_gradient.iter().enumerate() {
                if let Some(slope) = slope {
                    let half = slope.tr_mul(&momentum);
                    self.mass_matrix_gradient[k] += &half + half.transpose();
                }
            }
            let weight = motion.weight(mechanism.gravity(), body.joint_inertia());
            self.potential -= motion.gravity_work(mechanism.gravity(), body.joint_inertia());
            let slope = motion.jacobian.tr_mul(&weight);
            self.potential_gradient -= self.velocity_map.tr_mul(&slope);
        }
    }
}

/// One joint's kernel, written by `fill` column by column, into its block.
fn set_block(
    matrix: &mut DMatrix<f64>,
    rows: &Range<usize>,
    columns: &Range<usize>,
    fill: impl FnOnce(&mut [f64]),
) {
    let mut block = DMatrix::zeros(rows.len(), columns.len());
    fill(block.as_mut_slice());
    matrix
        .view_mut((rows.start, columns.start), block.shape())
        .copy_from(&block);
}

/// The K slices of one joint's derivative into their blocks; slice k of the joint is slice `rows.start + k` of all.
fn set_gradient_blocks(
    gradient: &mut [DMatrix<f64>],
    rows: &Range<usize>,
    columns: &Range<usize>,
    slices: &[f64],
) {
    let size = (rows.len() * columns.len()).max(1);
    for (k, slice) in rows.clone().zip(slices.chunks_exact(size)) {
        set_block(&mut gradient[k], rows, columns, |out| {
            out.copy_from_slice(slice)
        });
    }
}
