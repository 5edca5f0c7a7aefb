//! Changes of the stages in O(n), by the tree: what is stiff at the joints exactly, the rest left to the iteration.
//!
//! J is taken without what bends: `δϕ̇ = B δv̄`, `M̄ δv̄̇ = −K D δϕ − C δv̄` with the stiffness K and the damping C of each joint's own elements. So
//! `1 − τJ` is solved by `M̄ + τC + τ²KDB`, M̄ with a block more at each joint ([`LoadedMass`]). And A is replaced by the lower triangle of
//! its Crout factors, stage after stage (P. J. van der Houwen and J. J. B. de Swart, *Triangularly implicit iteration methods for
//! ODE-IVP solvers*, 1997), so that all of it is real.

use super::coefficients::Coefficients;
use crate::flow::{Flow, multiply};
use crate::linear::Charts;
use crate::step_state::{StepState, add};
use crate::{Form, StepFailure};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, LoadedMass, Recursive};
use hamel_runtime::elements::JointSlopes;
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::Ranges;
use hamel_runtime::steps::Variation;

/// The tree's own share of J, and the factors for each stage.
pub(super) struct Tree {
    dynamics: Recursive,
    form: Form,
    charts: Charts,
    slopes: JointSlopes,
    variations: Vec<Variation<f64>>,
    /// One for each joint.
    blocks: Vec<Block>,
    /// L of `A = L U` with 1 on U's diagonal, row by row.
    lower: Vec<Vec<f64>>,
    /// One for each stage.
    stages: Vec<Factors>,
    /// For the error estimate, at `τ = h/γ`.
    filter: Option<Factors>,
    /// `h J ΔZ` of the stages before.
    pushed: Vec<Vec<f64>>,
    room: Room,
    freedoms: usize,
}

/// What one joint's elements make of J, column by column.
///
/// Of what loads the mass the symmetric part is taken, throughout: the rates in a residual are of the size of forces over the least of the masses, and only
/// cancel against what the matrix holds itself.
struct Block {
    /// K D, S×K.
    by_phi: Vec<f64>,
    /// K D B, S×S.
    stiffness: Vec<f64>,
    /// C, S×S.
    damping: Vec<f64>,
}

impl Block {
    fn new(ranges: &Ranges) -> Self {
        let (freedoms, speeds) = (ranges.freedoms.len(), ranges.speeds.len());
        Self {
            by_phi: vec![0.0; speeds * freedoms],
            stiffness: vec![0.0; speeds * speeds],
            damping: vec![0.0; speeds * speeds],
        }
    }

    /// `τC + τ²KDB` times x.
    fn load(&self, tau: f64, x: &[f64], out: &mut [f64]) {
        let columns = self.stiffness.chunks_exact(out.len().max(1));
        let columns = columns.zip(self.damping.chunks_exact(out.len().max(1)));
        out.fill(0.0);
        for ((stiffness, damping), x) in columns.zip(x) {
            add(out, tau * tau * x, stiffness);
            add(out, tau * x, damping);
        }
    }
}

/// The factors of `1 − τJ`.
struct Factors {
    /// τ over the step.
    share: f64,
    tau: f64,
    mass: LoadedMass,
}

struct Room {
    /// One entry a speed.
    speeds: Vec<f64>,
    /// One joint's.
    own: [f64; MOST_FREEDOMS],
}

impl Tree {
    pub(super) fn new(method: &Coefficients, flow: &Flow<'_>) -> Self {
        let mechanism = &flow.mechanism;
        let layout = mechanism.layout();
        let lower = crout(method.matrix);
        let factors = |share| Factors {
            share,
            tau: 0.0,
            mass: LoadedMass::new(mechanism),
        };
        let bodies = mechanism.bodies().iter();
        let size = layout.freedoms + layout.speeds;
        let first = method.estimate.and(super::modes::real(method.matrix));
        Self {
            dynamics: Recursive::new(Arc::clone(mechanism)),
            form: flow.form,
            charts: Charts::new(mechanism),
            slopes: JointSlopes::new(mechanism),
            variations: vec![Variation::zero(); mechanism.variations()],
            blocks: bodies.map(|body| Block::new(body.ranges())).collect(),
            stages: (0..lower.len()).map(|i| factors(lower[i][i])).collect(),
            filter: first.map(|value| factors(1.0 / value)),
            pushed: vec![vec![0.0; size]; lower.len()],
            lower,
            room: Room {
                speeds: vec![0.0; layout.speeds],
                own: [0.0; MOST_FREEDOMS],
            },
            freedoms: layout.freedoms,
        }
    }

    /// Whether elements make a joint's forces change with another's motion, which K and C know nothing of.
    pub(super) const fn leaves_out(&self) -> bool {
        self.slopes.leaves_out()
    }

    /// Evaluates K, C, D and B at the state.
    pub(super) fn evaluate(&mut self, step_state: &StepState) {
        let (q, speeds) = (&step_state.configuration, &step_state.rates.speeds);
        self.dynamics
            .stand_loaded(q, speeds, &mut self.variations, &mut self.slopes);
        let mechanism = self.dynamics.mechanism();
        self.charts
            .set(mechanism, &step_state.base, &step_state.offset, speeds);
        for (index, body) in mechanism.joints() {
            let block = &mut self.blocks[index];
            let (freedoms, count) = (body.ranges().freedoms.len(), body.ranges().speeds.len());
            let (by_local, by_speeds) = self.slopes.of(index);
            let (moved, rated) = self.charts.of(index);
            product(by_local, moved, (count, freedoms), &mut block.by_phi);
            block.by_phi.iter_mut().for_each(|entry| *entry = -*entry);
            let by_phi = &block.by_phi;
            product(by_phi, rated, (count, freedoms), &mut block.stiffness);
            block.damping.fill(0.0);
            add(&mut block.damping, -1.0, by_speeds);
            symmetrize(&mut block.stiffness, count);
            symmetrize(&mut block.damping, count);
        }
    }

    /// Factorises for steps of `step`; how many matrices.
    pub(super) fn factorize(
        &mut self,
        step: f64,
        step_state: &StepState,
    ) -> Result<usize, StepFailure> {
        let Self {
            dynamics,
            blocks,
            stages,
            filter,
            ..
        } = self;
        let mut count = 0;
        for factors in stages.iter_mut().chain(filter) {
            let tau = step * factors.share;
            factors.tau = tau;
            count += 1;
            let load = |joint: usize, i: usize, j: usize| {
                let block = &blocks[joint];
                let at = j * block.stiffness.len().isqrt() + i;
                tau * (tau * block.stiffness[at] + block.damping[at])
            };
            let factorized = dynamics.factorize_loaded(load, &mut factors.mass);
            factorized.map_err(|cause| {
                let (q, speeds) = (&step_state.configuration, &step_state.rates.speeds);
                dynamics.mechanism().first_cause(cause, q, speeds)
            })?;
        }
        Ok(count)
    }

    /// Residuals of all stages into the changes that they call for.
    pub(super) fn solve(&mut self, residuals: &mut [Vec<f64>], step: f64) {
        for (i, residual) in residuals.iter_mut().enumerate() {
            for (weight, pushed) in self.lower[i].iter().zip(&self.pushed[..i]) {
                add(residual, *weight, pushed);
            }
            self.pushed[i].copy_from_slice(residual);
            self.solve_stage(Some(i), residual);
            // h J ΔZ, from what has just been solved.
            let factor = step / self.stages[i].tau;
            for (pushed, change) in self.pushed[i].iter_mut().zip(&*residual) {
                *pushed = factor * (change - *pushed);
            }
        }
    }

    /// `(γ − hJ)⁻¹ x` in place.
    pub(super) fn filter(&mut self, x: &mut [f64]) {
        let Some(share) = self.filter.as_ref().map(|factors| factors.share) else {
            return;
        };
        self.solve_stage(None, x);
        x.iter_mut().for_each(|entry| *entry *= share);
    }

    /// `(1 − τJ)⁻¹ x` in place, with the factors of a stage or of the filter.
    fn solve_stage(&mut self, stage: Option<usize>, x: &mut [f64]) {
        let Self {
            dynamics,
            form,
            charts,
            blocks,
            stages,
            filter,
            room,
            freedoms,
            ..
        } = self;
        let Some(Factors { tau, mass, .. }) = (match stage {
            Some(stage) => stages.get_mut(stage),
            None => filter.as_mut(),
        }) else {
            return;
        };
        let tau = *tau;
        let (turned, pushed) = x.split_at_mut(*freedoms);
        let mechanism = Arc::clone(dynamics.mechanism());
        let joints = || {
            let joints = mechanism.joints();
            joints.map(|(index, body)| (index, body.ranges()))
        };
        // What the springs give way to: −τ K D r_ϕ, and what loads the mass beside M̄.
        for (index, ranges) in joints() {
            let (own, speeds) = (ranges.freedoms.clone(), ranges.speeds.clone());
            let out = &mut room.speeds[speeds.clone()];
            let part = &mut room.own[..speeds.len()];
            out.fill(0.0);
            multiply(&blocks[index].by_phi, &turned[own], part);
            add(out, -tau, part);
            match form {
                Form::Hamiltonian => {
                    add(out, 1.0, &pushed[speeds.clone()]);
                    pushed[speeds].copy_from_slice(out);
                }
                Form::Lagrangian => {
                    blocks[index].load(tau, &pushed[speeds], part);
                    add(out, -1.0, part);
                }
            }
        }
        dynamics.solve_loaded(mass, &mut room.speeds);
        for (index, ranges) in joints() {
            let (own, speeds) = (ranges.freedoms.clone(), ranges.speeds.clone());
            let found = &mut room.speeds[speeds.clone()];
            if *form == Form::Lagrangian {
                add(found, 1.0, &pushed[speeds.clone()]);
            }
            let part = &mut room.own[..own.len()];
            multiply(charts.of(index).1, found, part);
            add(&mut turned[own], tau, part);
            if *form == Form::Lagrangian {
                pushed[speeds].copy_from_slice(found);
                continue;
            }
            // M̄ of what has been found, without M̄.
            let part = &mut room.own[..speeds.len()];
            blocks[index].load(tau, found, part);
            add(&mut pushed[speeds], -1.0, part);
        }
    }
}

/// L of `A = L U` with 1 on U's diagonal.
fn crout(matrix: &[&[f64]]) -> Vec<Vec<f64>> {
    let size = matrix.len();
    let mut lower = vec![vec![0.0; size]; size];
    let mut upper = lower.clone();
    for j in 0..size {
        for i in j..size {
            let known = (0..j).map(|k| lower[i][k] * upper[k][j]);
            lower[i][j] = matrix[i][j] - known.sum::<f64>();
        }
        for k in j..size {
            let known = (0..j).map(|m| lower[j][m] * upper[m][k]);
            upper[j][k] = (matrix[j][k] - known.sum::<f64>()) / lower[j][j];
        }
    }
    lower
}

/// `out = left · right`, column by column, for a left matrix of the given size.
fn product(left: &[f64], right: &[f64], (rows, inner): (usize, usize), out: &mut [f64]) {
    let columns = right.chunks_exact(inner.max(1));
    for (out, column) in out.chunks_exact_mut(rows.max(1)).zip(columns) {
        multiply(left, column, out);
    }
}

/// Makes a square matrix its symmetric part.
fn symmetrize(matrix: &mut [f64], size: usize) {
    for i in 0..size {
        for j in 0..i {
            let mean = 0.5 * (matrix[i * size + j] + matrix[j * size + i]);
            matrix[i * size + j] = mean;
            matrix[j * size + i] = mean;
        }
    }
}
