//! One step of an explicit method, linearised in local coordinates: `x′ = F(x, τ)` with the A and B of `δx′ = A δx + B δτ`.
//!
//! A state moves by `δx = (δϕ, δy)`, y = v̄ or p̄: Q to Φ(Q, δϕ), y to y + δy; and δx′ is read in the same way about the state that the step
//! reaches. So no coordinates enter that the state does not have. τ is held over the step.
//!
//! Nothing is differenced. A stage stands at `Q_i = Φ(Q, ϕ_i)` and y_i; what moves the start moves it by
//!
//! ```text
//! ξ_i = T_i δϕ + D_i δϕ_i       in local coordinates about Q_i
//! δϕ̇_i = G_i δϕ + P_i δϕ_i + S⁻¹S̄ δv̄_i
//! δẏ_i = ∂ẏ/∂ϕ ξ_i + ∂ẏ/∂y δy_i + ∂ẏ/∂τ δτ
//! ```
//!
//! with the first line's and the second's matrices from each joint's own kernels ([`crate::chart`]), the third's from the derivatives of the
//! dynamics. The tableau combines them as it combines ϕ̇ and ẏ. This is the derivative of the step, truncation error and all, that
//! [`integrate`](super::integrate) takes from x; steps after it may stand on an older base point, which makes a difference of the order of that error.

mod charts;
mod equations;

use super::flow::{Rates, retract};
use super::turns::Turns;
use super::{Form, StepFailure, Tableau};
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
pub(super) use charts::Charts;
pub(super) use equations::Equations;
use hamel_runtime::dynamics::{Dynamics, DynamicsError, Recursive, Sensitivity};
use hamel_runtime::mechanism::{Mechanism, Space};

/// One step and its A and B, with the workspace for them: one for each thread. After construction nothing allocates.
#[derive(Clone, Debug)]
pub struct LinearStep {
    dynamics: Recursive,
    equations: Equations,
    tableau: &'static Tableau,
    /// What is wrong with its coefficients.
    fault: Option<String>,
    turns: Turns,
    charts: Charts,
    stages: Vec<Stage>,
    phi: Vec<f64>,
    configuration: Vec<f64>,
    y: Vec<f64>,
    /// δϕ_i and δy_i.
    change: Change,
    /// ξ_i.
    local: Sensitivity,
    /// δv̄_i.
    faster: Sensitivity,
    by_state: Sensitivity,
    by_efforts: Sensitivity,
}

/// Derivatives of something in ϕ's and something in y's place: a column for each δϕ, δy and δτ.
#[derive(Clone, Debug)]
pub(super) struct Change {
    pub(super) phi: Sensitivity,
    pub(super) y: Sensitivity,
}

/// ϕ̇ and ẏ at one stage, and their derivatives.
#[derive(Clone, Debug)]
struct Stage {
    rates: Rates,
    slopes: Change,
}

/// What a step starts from: q, y = v̄ or p̄, τ.
#[derive(Clone, Copy, Debug)]
struct Start<'a> {
    q: &'a [f64],
    y: &'a [f64],
    efforts: &'a [f64],
    step: f64,
}

impl Change {
    pub(super) fn new(freedoms: usize, speeds: usize) -> Self {
        let width = 2 * freedoms + speeds;
        Self {
            phi: Sensitivity::new(freedoms, width),
            y: Sensitivity::new(speeds, width),
        }
    }

    /// Of the start: y moves with δy, ϕ is 0 there.
    pub(super) fn reset(&mut self) {
        self.phi.entries_mut().fill(0.0);
        self.y.entries_mut().fill(0.0);
        let (freedoms, width) = (self.phi.rows(), self.y.columns());
        let rows = self.y.entries_mut().chunks_exact_mut(width.max(1));
        for (j, row) in rows.enumerate() {
            row[freedoms + j] = 1.0;
        }
    }

    fn add(&mut self, weight: f64, slopes: &Self) {
        add(self.phi.entries_mut(), weight, slopes.phi.entries());
        add(self.y.entries_mut(), weight, slopes.y.entries());
    }
}

impl LinearStep {
    /// Room for steps of the method of `tableau` ([`Scheme::tableau`](super::Scheme::tableau)) in the equations of `mechanism`; the step's length
    /// comes with each call.
    pub fn new(mechanism: &Arc<Mechanism>, form: Form, tableau: &'static Tableau) -> Self {
        let layout = *mechanism.layout();
        let (freedoms, speeds) = (layout.freedoms, layout.speeds);
        let stage = Stage {
            rates: Rates::new(mechanism),
            slopes: Change::new(freedoms, speeds),
        };
        Self {
            dynamics: Recursive::new(Arc::clone(mechanism)),
            equations: Equations::new(mechanism, form),
            turns: Turns::new(mechanism),
            charts: Charts::new(mechanism),
            stages: vec![stage; tableau.nodes.len()],
            tableau,
            fault: tableau.fault(),
            phi: vec![0.0; freedoms],
            configuration: vec![0.0; layout.configuration],
            y: vec![0.0; speeds],
            change: Change::new(freedoms, speeds),
            local: Sensitivity::new(freedoms, 2 * freedoms + speeds),
            faster: Sensitivity::new(speeds, 2 * freedoms + speeds),
            by_state: Sensitivity::new(freedoms + speeds, freedoms + speeds),
            by_efforts: Sensitivity::new(freedoms + speeds, freedoms),
        }
    }

    /// Takes one step of `step` (s) from (q, y) under efforts τ that are held, and its derivatives. y is v̄ in the Lagrangian and p̄ in the
    /// Hamiltonian form, one entry per speed; τ has one entry per degree of freedom.
    ///
    /// # Errors
    /// A step that is not positive and finite; a state of the wrong size, not finite or off the joints' manifolds; a singular mass matrix; a
    /// joint that turns by more than π; a joint whose motion is prescribed, and what else derivatives do not cover.
    pub fn linearize(
        &mut self,
        q: &[f64],
        y: &[f64],
        efforts: &[f64],
        step: f64,
    ) -> Result<(), StepFailure> {
        let start = Start {
            q,
            y,
            efforts,
            step,
        };
        self.check(&start)?;
        self.turns.set(self.dynamics.mechanism(), q);
        let tableau = self.tableau;
        for (i, weights) in tableau.matrix.iter().enumerate() {
            self.combine(&start, weights)?;
            self.evaluate(&start, i)?;
        }
        self.combine(&start, tableau.weights)?;
        let mechanism = Arc::clone(self.dynamics.mechanism());
        // The speeds only enter ϕ̇, which nothing asks for here.
        let speeds = &self.stages[0].rates.speeds;
        self.charts.set(&mechanism, q, &self.phi, speeds);
        self.charts.localize(&self.change.phi, &mut self.local);
        self.charts.carry(&mut self.local);
        self.complete(efforts)?;
        self.store();
        Ok(())
    }

    /// Where constraints couple joints, the speeds of the state reached that depend on the others, and how they change; momenta that do are 0.
    fn complete(&mut self, efforts: &[f64]) -> Result<(), StepFailure> {
        let follow = matches!(self.equations, Equations::Lagrangian(_));
        if !follow || self.dynamics.mechanism().constraints().is_empty() {
            return Ok(());
        }
        let rates = &mut self.stages[0].rates;
        let reached = (&self.configuration[..], &self.y[..], efforts);
        self.equations
            .evaluate(&mut self.dynamics, reached, rates)?;
        self.y.copy_from_slice(&rates.speeds);
        let Change { y, .. } = &mut self.change;
        self.equations.hasten(&self.local, y, &mut self.faster);
        y.entries_mut().copy_from_slice(self.faster.entries());
        Ok(())
    }

    /// A, square with a row and a column for each δϕ and then for each δy.
    pub const fn by_state(&self) -> &Sensitivity {
        &self.by_state
    }

    /// B: rows as A has them, a column for each effort.
    pub const fn by_efforts(&self) -> &Sensitivity {
        &self.by_efforts
    }

    /// Q′, as the step reaches it.
    pub fn configuration(&self) -> &[f64] {
        &self.configuration
    }

    /// y′: v̄ or p̄ as the step reaches it.
    pub fn y(&self) -> &[f64] {
        &self.y
    }

    fn check(&self, start: &Start<'_>) -> Result<(), StepFailure> {
        let Start {
            q,
            y,
            efforts,
            step,
        } = *start;
        if !(step > 0.0 && step.is_finite()) {
            return Err(StepFailure::Length { step });
        }
        let mechanism = self.dynamics.mechanism();
        if let Some(drive) = mechanism.drives().first() {
            // Its acceleration is a function of time, which no step is told here.
            return Err(StepFailure::Dynamics(DynamicsError::NotDifferentiable {
                what: "a joint whose motion is prescribed",
                name: drive.name.clone(),
            }));
        }
        mechanism.check_configuration(q)?;
        mechanism.check_speeds(self.equations.y(), y)?;
        if let Some(reason) = &self.fault {
            return Err(StepFailure::Tableau {
                reason: reason.clone(),
            });
        }
        Ok(mechanism.check_vector("efforts", Space::Freedoms, efforts)?)
    }

    /// ϕ, Q and y of a stage, and how they change.
    fn combine(&mut self, start: &Start<'_>, weights: &[f64]) -> Result<(), StepFailure> {
        self.phi.fill(0.0);
        self.y.copy_from_slice(start.y);
        self.change.reset();
        for (weight, stage) in weights.iter().zip(&self.stages) {
            if *weight != 0.0 {
                let weight = start.step * weight;
                add(&mut self.phi, weight, &stage.rates.phi);
                add(&mut self.y, weight, &stage.rates.y);
                self.change.add(weight, &stage.slopes);
            }
        }
        let mechanism = self.dynamics.mechanism();
        self.turns.check(mechanism, &self.phi, &self.y)?;
        retract(mechanism, start.q, &self.phi, &mut self.configuration);
        Ok(())
    }

    /// The rates of stage i, and how they change.
    fn evaluate(&mut self, start: &Start<'_>, i: usize) -> Result<(), StepFailure> {
        let mechanism = Arc::clone(self.dynamics.mechanism());
        let Stage { rates, slopes } = &mut self.stages[i];
        let at = (&self.configuration[..], &self.y[..], start.efforts);
        self.equations.evaluate(&mut self.dynamics, at, rates)?;
        self.charts
            .set(&mechanism, start.q, &self.phi, &rates.speeds);
        self.charts.rates(&rates.speeds, &mut rates.phi);
        let found = [
            (
                "rate of the local coordinates",
                Space::Freedoms,
                &*rates.phi,
            ),
            ("acceleration", Space::Speeds, &*rates.y),
        ];
        mechanism.check_finite((&self.configuration, &rates.speeds), &found)?;
        self.charts.localize(&self.change.phi, &mut self.local);
        self.charts.carry(&mut self.local);
        self.equations
            .differentiate(&self.local, &self.change.y, &mut self.faster, &mut slopes.y);
        self.charts
            .differentiate(&self.change.phi, &self.faster, &mut slopes.phi);
        self.charts.drag(&mut slopes.phi);
        Ok(())
    }

    /// ξ and δy of the state reached into A and B.
    fn store(&mut self) {
        let states = self.by_state.columns();
        let freedoms = self.by_efforts.columns();
        let rows = [&self.local, &self.change.y]
            .into_iter()
            .flat_map(|part| part.entries().chunks_exact(part.columns().max(1)));
        let into = self.by_state.entries_mut().chunks_exact_mut(states.max(1));
        let forced = self
            .by_efforts
            .entries_mut()
            .chunks_exact_mut(freedoms.max(1));
        for ((row, into), forced) in rows.zip(into).zip(forced) {
            into.copy_from_slice(&row[..states]);
            forced.copy_from_slice(&row[states..]);
        }
    }
}

fn add(sum: &mut [f64], weight: f64, terms: &[f64]) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += weight * term;
    }
}
