//! What constraints that couple joints add to the equations of motion of a tree, in dual numbers.

use hamel::elements::PointConstraint;
use hamel::nalgebra::{DMatrix, DVector, Vector6};
use hamel::scalar::Dual;
use hamel::spatial::join;
use hamel_tests::derivatives::{Expected, constants, matrix, values};
use hamel_tests::random::Case;

/// Constraints `Aᵀ v̄ = 0` on a tree.
pub struct System<'a> {
    pub case: &'a Case,
    pub tree: Expected,
    pub wrenches: Vec<(usize, Vector6<f64>)>,
    /// A, a row a speed.
    pub constraints: DMatrix<f64>,
}

/// The wrenches of the constraints on their bodies, in the axes of the joints' child frames.
fn wrenches(case: &Case) -> Vec<(usize, Vector6<f64>)> {
    let wrench = |constraint: &PointConstraint| {
        let fixed = case.mechanism.bodies()[constraint.body].child_placement();
        let direction = fixed.rotation * constraint.direction.normalize();
        let arm = fixed.transform_point(&constraint.point);
        (constraint.body, join(&arm.cross(&direction), &direction))
    };
    case.mechanism.constraints().iter().map(wrench).collect()
}

impl<'a> System<'a> {
    pub fn new(case: &'a Case, tree: Expected) -> Self {
        let wrenches = wrenches(case);
        let mut system = Self {
            case,
            constraints: DMatrix::zeros(tree.rows, wrenches.len()),
            wrenches,
            tree,
        };
        system.constraints = system.each_speed(&constants(&case.q), values);
        system
    }

    /// `[M −A; Aᵀ 0]`.
    pub fn whole(&self) -> DMatrix<f64> {
        let (a, rows) = (&self.constraints, self.tree.rows);
        let size = rows + a.ncols();
        let mut whole = self.tree.mass.clone().resize(size, size, 0.0);
        whole.view_mut((0, rows), a.shape()).copy_from(&-a);
        whole
            .view_mut((rows, 0), (a.ncols(), rows))
            .copy_from(&a.transpose());
        whole
    }

    /// A at `q`, or how it changes.
    pub fn each_speed(
        &self,
        q: &[Dual<f64>],
        part: impl Fn(&[Dual<f64>]) -> Vec<f64>,
    ) -> DMatrix<f64> {
        let row = |j: usize| {
            let mut unit = constants(&vec![0.0; self.tree.rows]);
            unit[j].value = 1.0;
            part(&self.tree.form.powers(q, &unit, &self.wrenches))
        };
        matrix(self.wrenches.len(), (0..self.tree.rows).map(row)).transpose()
    }

    pub fn dependent(&self) -> &[usize] {
        self.case.mechanism.dependent_speeds()
    }

    /// Dependent speeds that make up for `slips` of the constraints.
    pub fn follow(&self, slips: &[f64]) -> DVector<f64> {
        let square = self.constraints.select_rows(self.dependent()).transpose();
        let solved = square.lu().solve(&-DVector::from_row_slice(slips));
        solved.expect("constraints determine their speeds")
    }

    /// What takes the dependent entries of `forces` to 0 through A.
    pub fn multipliers(&self, forces: &DVector<f64>) -> DVector<f64> {
        let square = self.constraints.select_rows(self.dependent());
        let solved = square.lu().solve(&forces.select_rows(self.dependent()));
        solved.expect("constraints determine their speeds")
    }
}

pub fn condition(matrix: &DMatrix<f64>) -> f64 {
    let singular = matrix.singular_values();
    singular.max() / singular.min()
}
