//! Derivatives of the dynamics by recursion, with respect to local coordinates ϕ (at ϕ = 0), speeds and efforts. Nothing is differenced.
//!
//! All vectors are in world axes. One unit of a local coordinate of joint k moves every body i that the joint carries by the twist
//! `Z = X^c S₀ e`, and changes their motions by
//!
//! ```text
//! δV_i = ad_Z V_i + U             U = ad_{V_λ} Z + ∂X̄ v̄
//! δV̇_i = ad_Z V̇_i + ad_U V_i + W   W = ad_{V̇_λ} Z + ad_{V_λ} U + ad_{V_k} ∂X̄ v̄ + ∂(X̄ v̄̇ + c)
//! ```
//!
//! with U and W the same for all of them (∂ is the derivative of the joint's own kernels in ϕ). One unit of a speed of it, with column X of X̄,
//! does the same with Z = 0, U = X and `W_v = ad_{V_k + V_λ} X + ∂c/∂v̄`. So the wrench that body i takes changes by
//! `−ad_Zᵀ f_i + N_i W + B_i U`, where `B U = N ad_U V − ad_Uᵀ N V − ad_Vᵀ N U` ([`coriolis`]) has twelve numbers. With N, B and F summed over
//! each subtree, for the joints j between the root and k (`⊂`: below it)
//!
//! ```text
//! ∂τ̄_j/∂ϕ_k = X̄_jᵀ (N_k W + B_k U − ad_Zᵀ F_k)                  j above k
//! ∂τ̄_k/∂ϕ_k = X̄_kᵀ (N_k W + B_k U) + ∂X̄ᵀ F_k
//! ∂τ̄_j/∂ϕ_k = Wᵀ (N_j X̄_j) + Uᵀ (B_jᵀ X̄_j)                      j ⊂ k
//! ```
//!
//! which is O(n · depth), a few products a pair. For a joint whose X̄ is constant ∂X̄ and ∂c vanish, and with them all kernels beyond X̄; the other
//! joints have kernels for `∂X̄ v̄`, `∂X̄ᵀ F`, `∂c/∂ϕ` and `∂c/∂v̄`, derived by the generator.
//!
//! Forward dynamics takes the same U and W as loads of the articulated factors: W enters as an additional acceleration of the subtree's base. B is propagated like the articulated inertia, as another 6×3 matrix, with the joints below free. Each column then is one sweep inward along
//! its branch and one outward, O(n), eight columns at a time; M̄ is never formed. Mechanisms of few speeds
//! take `−M̄⁻¹` times the derivatives of inverse dynamics instead, which is as exact and costs less for them ([`factor`]).
//!
//! Elements and rotors add what [`acting`] says. Elements of one's own without slopes ([`Element::slope`](crate::elements::Element::slope)) are not
//! covered: asking for derivatives of such a mechanism is an error. Second derivatives are in [`second`]. Inverse dynamics is that of the tree; under constraints that couple joints, forward
//! dynamics is in [`coupled`] and the port-Hamiltonian form in [`coupled_momenta`].

mod acting;
mod coriolis;
mod coupled;
mod coupled_momenta;
mod dense;
mod energy;
mod factor;
mod finite;
mod fold;
mod forward;
mod hamiltonian;
mod inverse;
mod inverse_mass;
mod momentum_rates;
mod product;
mod second;
mod sweep;

pub use forward::ForwardDerivatives;
pub use hamiltonian::HamiltonianDerivatives;
pub use inverse::InverseDerivatives;
pub use inverse_mass::InverseMassMatrix;
pub use second::{ForwardSecondDerivatives, InverseSecondDerivatives};

use super::Recursive;
use super::link::{Link, Node};
use crate::dynamics::DynamicsError;
use crate::mechanism::{Mechanism, WHOLE, check_size};
use crate::steps::Variation;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::DMatrix;

/// A matrix of derivatives, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivity {
    rows: usize,
    columns: usize,
    entries: Vec<f64>,
}

impl Sensitivity {
    /// Zeros.
    pub fn new(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            entries: vec![0.0; rows * columns],
        }
    }

    /// Number of rows.
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub const fn columns(&self) -> usize {
        self.columns
    }

    /// Entry (i, j); zero for an index out of range.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        match j < self.columns {
            true => self.entries.get(i * self.columns + j).copied(),
            false => None,
        }
        .unwrap_or(0.0)
    }

    /// All entries, row by row.
    pub fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// All entries; allocates.
    pub fn matrix(&self) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.rows, self.columns, &self.entries)
    }

    /// All entries, row by row.
    pub fn entries_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.entries[row * self.columns..(row + 1) * self.columns]
    }

    /// The first of `rest` as a row; what is left of it.
    fn read_row<'a>(&mut self, row: usize, rest: &'a [f64]) -> &'a [f64] {
        let (own, rest) = rest.split_at(self.columns);
        self.row_mut(row).copy_from_slice(own);
        rest
    }

    fn copy_column(&self, column: usize, into: &mut [f64]) {
        for (row, entry) in into.iter_mut().enumerate() {
            *entry = self.entry(row, column);
        }
    }

    fn set_column(&mut self, column: usize, from: &[f64]) {
        for (row, entry) in from.iter().enumerate() {
            self.set(row, column, *entry);
        }
    }

    fn row_mut(&mut self, row: usize) -> &mut [f64] {
        &mut self.entries[row * self.columns..(row + 1) * self.columns]
    }

    fn clear(&mut self) {
        self.entries.fill(0.0);
    }

    fn add_all(&mut self, other: &Self) {
        for (entry, other) in self.entries.iter_mut().zip(&other.entries) {
            *entry += other;
        }
    }

    fn subtract(&mut self, other: &Self) {
        for (entry, other) in self.entries.iter_mut().zip(&other.entries) {
            *entry -= other;
        }
    }

    /// Adds `left right`.
    pub fn add_product(&mut self, left: &Self, right: &Self) {
        product::add_product(left, right, self);
    }

    /// The matrix times `vector`, into `out`.
    ///
    /// # Errors
    /// A `vector` that has not one entry a column, or an `out` that has not one a row.
    pub fn times(&self, vector: &[f64], out: &mut [f64]) -> Result<(), DynamicsError> {
        check_size(WHOLE, "direction", self.columns, vector.len())?;
        check_size(WHOLE, "result", self.rows, out.len())?;
        for (row, out) in out.iter_mut().enumerate() {
            let terms = self.row(row).iter().zip(vector);
            *out = terms.map(|(entry, weight)| entry * weight).sum();
        }
        Ok(())
    }

    /// Adds to entry (i, j).
    pub(crate) fn add(&mut self, i: usize, j: usize, value: f64) {
        self.entries[i * self.columns + j] += value;
    }

    fn set(&mut self, i: usize, j: usize, value: f64) {
        self.entries[i * self.columns + j] = value;
    }
}

impl Recursive {
    /// Whether results were made for a tree like the mechanism's own, of these `branches`.
    fn check_branches(&self, branches: &[Branch]) -> Result<(), DynamicsError> {
        let fits = |(branch, link): (&Branch, &Link)| {
            branch.parent == link.parent.unwrap_or(WORLD)
                && branch.freedoms == (link.variations.start, link.variations.end)
                && branch.speeds == (link.columns.start, link.columns.end)
        };
        let is_own = branches.len() == self.links.len();
        match is_own && branches.iter().zip(&self.links).all(fits) {
            true => Ok(()),
            false => Err(DynamicsError::ForeignResults),
        }
    }

    /// [`Recursive::check_branches`], and whether derivatives cover all that acts on the mechanism.
    fn check_differentiable(&self, branches: &[Branch]) -> Result<(), DynamicsError> {
        self.check_branches(branches)?;
        let mut elements = self.mechanism.elements().iter();
        match elements.find(|element| element.slope().is_none()) {
            Some(element) => Err(DynamicsError::NotDifferentiable {
                what: "an element without slopes",
                name: element.name().into(),
            }),
            None => Ok(()),
        }
    }

    /// [`Recursive::check_branches`], and whether second derivatives cover all that acts on the mechanism.
    fn check_twice_differentiable(&self, branches: &[Branch]) -> Result<(), DynamicsError> {
        self.check_differentiable(branches)?;
        let mut elements = self.mechanism.elements().iter();
        match elements.find(|element| element.curvature().is_none()) {
            Some(element) => Err(DynamicsError::NotTwiceDifferentiable {
                what: "an element without curvatures",
                name: element.name().into(),
            }),
            None => Ok(()),
        }
    }

    /// Whether results have room for the constraints that couple joints: for so many.
    fn check_coupled(&self, room: usize) -> Result<(), DynamicsError> {
        match room == self.mechanism.constraints().len() {
            true => Ok(()),
            false => Err(DynamicsError::ForeignResults),
        }
    }

    /// The variations of the joint under body `index` at (q, v̄, v̄̇), one per degree of freedom, after [`Recursive::advance`].
    pub(in crate::dynamics::recursive) fn vary(
        &self,
        index: usize,
        state: (&[f64], &[f64], &[f64]),
        out: &mut [Variation<f64>],
    ) {
        let link = &self.links[index];
        let parent = link
            .parent
            .map_or(&self.world, |parent| &self.nodes[parent]);
        let (q, speeds, accelerations) = state;
        let accelerations = match accelerations.is_empty() {
            true => accelerations,
            false => &accelerations[link.speeds.clone()],
        };
        link.joint.vary(
            (
                &q[link.configuration.clone()],
                &speeds[link.speeds.clone()],
                accelerations,
            ),
            (&self.nodes[index].motion, &parent.motion),
            &self.columns[link.columns.clone()],
            out,
        );
    }
}

/// A wrench or momentum in the axes of the child frame.
fn in_child(node: &Node, wrench: &nalgebra::Vector6<f64>) -> nalgebra::Vector6<f64> {
    crate::spatial::turn_back(&node.motion.placement.rotation, wrench)
}

/// Where the degrees of freedom and speeds of each body's joint stand among the variations and columns of all bodies, and what it hangs on.
#[derive(Clone, Copy, Debug)]
struct Branch {
    /// `usize::MAX` for the world.
    parent: usize,
    freedoms: (usize, usize),
    speeds: (usize, usize),
    /// Whether any column of X̄ has an angular part, and whether any has a linear one.
    parts: (bool, bool),
    /// Whether any body but the next one hangs on it.
    forks: bool,
}

/// The parent of a body that hangs on the world.
const WORLD: usize = usize::MAX;

fn branches(mechanism: &Mechanism) -> Vec<Branch> {
    let branch = |body: &crate::mechanism::Body| {
        let ranges = body.ranges();
        Branch {
            parent: body.parent().unwrap_or(WORLD),
            freedoms: (ranges.variations.start, ranges.variations.end),
            speeds: (ranges.columns.start, ranges.columns.end),
            parts: body.joint().parts(),
            forks: false,
        }
    };
    let mut branches: Vec<_> = mechanism.bodies().iter().map(branch).collect();
    for body in 0..branches.len() {
        let parent = branches[body].parent;
        if parent != WORLD && parent + 1 != body {
            branches[parent].forks = true;
        }
    }
    branches
}
