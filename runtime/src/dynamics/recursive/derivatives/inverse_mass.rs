//! M̄⁻¹ of the tree, from the factors of the articulated recursion; M̄ itself is never formed.
//!
//! Trees of few speeds take the product `RᵀR` of [`factor`](super::factor), others the symmetric responses to unit forces of [`sweep`](super::sweep),
//! eight at a time. Joints that carry several bodies and slender bodies have factors of their own: their trees take one unit force after the other.

use super::factor::{FEW, Factors};
use super::fold::is_folded;
use super::sweep::{Push, Sweep, Tree};
use super::{Branch, Sensitivity, branches};
use crate::dynamics::DynamicsError;
use crate::dynamics::recursive::Recursive;
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::recursive::slender::has_slender;
use crate::mechanism::Mechanism;
use crate::spatial::shift_wrench;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, Vector3, Vector6};

/// M̄⁻¹ of one mechanism, and the workspace that computing it takes.
#[derive(Clone, Debug)]
pub struct InverseMassMatrix {
    inverse: Sensitivity,
    branches: Vec<Branch>,
    way: Way,
}

/// How it is computed.
#[derive(Clone, Debug)]
enum Way {
    Product(Factors),
    Sweeps {
        sweep: Sweep,
        /// A unit force on each speed.
        units: Vec<Push>,
        /// Zeros: nothing moves.
        drags: Vec<Vector3<f64>>,
    },
    RowByRow,
}

impl InverseMassMatrix {
    /// Room for the inverse mass matrix of `mechanism`.
    pub fn new(mechanism: &Mechanism) -> Self {
        let speeds = mechanism.layout().speeds;
        let branches = branches(mechanism);
        let way = match speeds {
            _ if is_folded(mechanism) || has_slender(mechanism) => Way::RowByRow,
            ..=FEW => Way::Product(Factors::new(&branches, speeds)),
            _ => Way::Sweeps {
                sweep: Sweep::new(branches.len(), speeds),
                units: vec![Push::none(); speeds],
                drags: vec![Vector3::zeros(); speeds],
            },
        };
        Self {
            inverse: Sensitivity::new(speeds, speeds),
            branches,
            way,
        }
    }

    /// Number of rows: of speeds.
    pub const fn size(&self) -> usize {
        self.inverse.rows()
    }

    /// Entry (i, j); zero for an index out of range.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        self.inverse.entry(i, j)
    }

    /// All entries, row by row.
    pub fn entries(&self) -> &[f64] {
        self.inverse.entries()
    }

    /// All entries; allocates.
    pub fn matrix(&self) -> DMatrix<f64> {
        self.inverse.matrix()
    }
}

impl Recursive {
    /// M̄⁻¹ of the tree at `q` into `out`; constraints that couple joints do not reduce it. Joints whose motion is prescribed do not give way: their rows and columns are
    /// zero.
    ///
    /// # Errors
    /// A singular mass matrix; `q` of a wrong size; results that were made for another mechanism.
    pub fn inverse_mass_matrix(
        &mut self,
        q: &[f64],
        out: &mut InverseMassMatrix,
    ) -> Result<(), DynamicsError> {
        self.check(q, &[])?;
        self.check_branches(&out.branches)?;
        self.weigh(q);
        self.articulate()?;
        let InverseMassMatrix {
            inverse,
            branches,
            way,
        } = out;
        match way {
            Way::Product(factors) => self.invert_few(factors, inverse),
            Way::RowByRow => self.invert_row_by_row(inverse),
            Way::Sweeps {
                sweep,
                units,
                drags,
            } => {
                self.push_units(units);
                let tree = Tree {
                    branches,
                    nodes: &self.nodes,
                    columns: &self.columns,
                    pivots: &self.pivots,
                    drags,
                };
                sweep.respond_symmetrically(&tree, units, inverse);
            }
        }
        Ok(())
    }

    /// M̄⁻¹ into `out`, after [`Recursive::articulate`]; twists, wrenches and loads are lost.
    pub(super) fn invert_row_by_row(&mut self, out: &mut Sensitivity) {
        for body in 0..self.links.len() {
            if !self.links[body].leads {
                continue;
            }
            let speeds = self.links[body].speeds.clone();
            for speed in speeds.clone() {
                self.inverse_row(&mut out.row_mut(speed)[..speeds.end], body, speed);
            }
        }
        for row in 0..out.rows() {
            for column in 0..row {
                out.set(column, row, out.entry(row, column));
            }
        }
    }

    /// One row of M̄⁻¹, up to the last speed of `body`: the rates under a unit force on `speed`, one of its joint's.
    fn inverse_row(&mut self, row: &mut [f64], body: usize, speed: usize) {
        let (mut next, mut wrench) = (Some(body), Vector6::zeros());
        self.loads[..row.len()].fill(0.0);
        while let Some(index) = next {
            let link = &self.links[index];
            let speeds = link.speeds.clone();
            let mut unit = [0.0; MOST_FREEDOMS];
            if speeds.contains(&speed) {
                unit[speed - speeds.start] = 1.0;
            }
            next = link.parent;
            let unit = &unit[..speeds.len()];
            if let Some(group) = link.group {
                wrench = self.yield_member(index, group, &wrench, unit);
                continue;
            }
            match link.slender {
                None => link.joint.reduce(
                    &mut wrench,
                    &self.columns[link.columns.clone()],
                    &self.pivots[speeds.clone()],
                    unit,
                    &mut self.loads[speeds],
                ),
                Some(number) => wrench = self.reduce_slender(index, number, &wrench, unit),
            }
            wrench = shift_wrench(&wrench, &self.nodes[index].motion.placement.offset);
        }
        self.resolve_up_to(body, row);
    }
}
