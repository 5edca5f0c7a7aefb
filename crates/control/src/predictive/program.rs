//! `min ½ zᵀ H z + gᵀ z` with every entry of z between bounds.

use crate::ControlError;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettingsBuilder, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus,
};
use nalgebra::{DMatrix, DVector, DVectorView};

/// A program and its solver, which keeps its memory from one to the next.
pub(super) struct Program {
    hessian: DMatrix<f64>,
    gradient: DVector<f64>,
    /// What z may grow by, and then what it may shrink by.
    bounds: Vec<f64>,
    solver: DefaultSolver<f64>,
}

impl Program {
    /// A program of `size` numbers.
    pub(super) fn new(size: usize) -> Result<Self, ControlError> {
        // Every place of the upper triangle is there from the start: later programs only change numbers.
        let full = upper(&DMatrix::from_element(size, size, 1.0));
        let starts = (0..=size).map(|column| column * (column + 1) / 2).collect();
        let rows = (0..size).flat_map(|column| 0..=column).collect();
        let hessian = CscMatrix::new(size, size, starts, rows, full);
        let settings = DefaultSettingsBuilder::default()
            .verbose(false)
            .presolve_enable(false)
            .build()
            .map_err(|error| ControlError::Optimizer(error.to_string()))?;
        let bounds = vec![1.0; 2 * size];
        let solver = DefaultSolver::new(
            &hessian,
            &vec![0.0; size],
            &both_sides(size),
            &bounds,
            &[NonnegativeConeT(2 * size)],
            settings,
        )
        .map_err(|error| ControlError::Optimizer(error.to_string()))?;
        Ok(Self {
            hessian: DMatrix::zeros(size, size),
            gradient: DVector::zeros(size),
            bounds,
            solver,
        })
    }

    /// Forgets the costs.
    pub(super) fn clear(&mut self) {
        self.hessian.fill(0.0);
        self.gradient.fill(0.0);
    }

    /// Adds `½ (x + G z)ᵀ W (x + G z)`.
    pub(super) fn add(&mut self, map: &DMatrix<f64>, weight: &DMatrix<f64>, x: &[f64]) {
        let weighted = weight * map;
        self.hessian.gemm_tr(1.0, map, &weighted, 1.0);
        let x = DVectorView::from_slice(x, x.len());
        self.gradient.gemv_tr(1.0, &weighted, &x, 1.0);
    }

    /// Adds `½ weight (input + z)²` of one entry of z.
    pub(super) fn weigh(&mut self, place: usize, weight: f64, input: f64) {
        self.hessian[(place, place)] += weight;
        self.gradient[place] += weight * input;
    }

    /// How much one entry of z may grow, and how much it may shrink.
    pub(super) fn bound(&mut self, place: usize, [grow, shrink]: [f64; 2]) {
        let size = self.gradient.len();
        self.bounds[place] = grow;
        self.bounds[size + place] = shrink;
    }

    /// z at the minimum, or what the solver says.
    pub(super) fn solve(&mut self) -> Result<&[f64], String> {
        let (solver, hessian) = (&mut self.solver, upper(&self.hessian));
        solver
            .update_P(&hessian)
            .and_then(|()| solver.update_q(self.gradient.data.as_vec()))
            .and_then(|()| solver.update_b(&self.bounds))
            .map_err(|error| error.to_string())?;
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved | SolverStatus::AlmostSolved => Ok(&solver.solution.x),
            status => Err(status.to_string()),
        }
    }
}

/// The upper triangle, column by column.
fn upper(matrix: &DMatrix<f64>) -> Vec<f64> {
    let columns = 0..matrix.ncols();
    let entries = columns.flat_map(|column| (0..=column).map(move |row| (row, column)));
    entries.map(|place| matrix[place]).collect()
}

/// `[I; −I]`.
fn both_sides(size: usize) -> CscMatrix<f64> {
    let starts = (0..=size).map(|column| 2 * column).collect();
    let rows = (0..size).flat_map(|row| [row, size + row]).collect();
    CscMatrix::new(2 * size, size, starts, rows, [1.0, -1.0].repeat(size))
}
