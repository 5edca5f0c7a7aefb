//! One step of the commutator-free method of order 4: stages compose Φ with combinations of rates, so that no differential of Φ enters.
//!
//! E. Celledoni, A. Marthinsen and B. Owren, *Commutator-free Lie group methods*, 2003. It needs a Φ whose rays are the flows of the
//! joint's own velocities, `Φ(Φ(Q, aϕ), bϕ) = Φ(Q, (a + b)ϕ)`, as Q exp(ϕ) has. A joint with another Φ, or one whose ϕ add up, as angles do, takes its stages
//! in (ϕ, y) instead, with the same nodes and weights.

use super::StepFailure;
use super::flow::{Flow, Rates, multiply, widest};
use super::step_state::{StepState, add};
use super::stepper::{Span, Stepper};
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::mechanism::Body;

/// Nodes of the stages.
const NODES: [f64; 4] = [0.0, 0.5, 0.5, 1.0];

/// How a stage, or the end, is reached from the state: by one Φ after the other, each with weights of the rates of the stages before.
const PATHS: [&[[f64; 4]]; 4] = [
    &[[0.5, 0.0, 0.0, 0.0]],
    &[[0.0, 0.5, 0.0, 0.0]],
    &[[0.5, 0.0, 0.0, 0.0], [-0.5, 0.0, 1.0, 0.0]],
    &[
        [3.0 / 12.0, 2.0 / 12.0, 2.0 / 12.0, -1.0 / 12.0],
        [-1.0 / 12.0, 2.0 / 12.0, 2.0 / 12.0, 3.0 / 12.0],
    ],
];

/// The method at work.
pub(super) struct CommutatorFree {
    /// Whether stages of each body's joint are composed of Φ.
    composed: Vec<bool>,
    /// Rates at the stages from the second on.
    stages: Vec<Rates>,
    /// `S₀⁻¹ v` of the joints that are composed, at each stage.
    local_rates: Vec<Vec<f64>>,
    /// How far ϕ moves to the stage that is being evaluated.
    phi: Vec<f64>,
    /// ϕ there as the sum of what it is composed of.
    sum: Vec<f64>,
    /// One joint's Q, before and after a Φ.
    near: Vec<f64>,
    far: Vec<f64>,
    /// One joint's ϕ.
    part: Vec<f64>,
    /// One joint's D, K×K.
    differential: Vec<f64>,
}

impl CommutatorFree {
    pub(super) fn new(flow: &Flow<'_>) -> Self {
        let mechanism = &flow.mechanism;
        let freedoms = mechanism.layout().freedoms;
        let bodies = mechanism.bodies();
        let longest = bodies.iter().map(|body| body.ranges().configuration.len());
        let (longest, widest) = (longest.max().unwrap_or(0), widest(mechanism));
        Self {
            composed: bodies.iter().map(is_composed).collect(),
            stages: vec![flow.new_rates(); 3],
            local_rates: vec![vec![0.0; freedoms]; 4],
            phi: vec![0.0; freedoms],
            sum: vec![0.0; freedoms],
            near: vec![0.0; longest],
            far: vec![0.0; longest],
            part: vec![0.0; widest],
            differential: vec![0.0; widest * widest],
        }
    }

    /// Moves to the end of a path.
    fn follow(
        &mut self,
        step_state: &mut StepState,
        flow: &Flow<'_>,
        step: f64,
        path: &[[f64; 4]],
    ) -> Result<(), StepFailure> {
        let mut outcome = Ok(());
        self.phi.fill(0.0);
        self.sum.copy_from_slice(&step_state.offset);
        for (index, body) in flow.mechanism.joints() {
            if self.composed[index] && outcome.is_ok() {
                outcome = self.compose(body, step_state, step, path);
            }
        }
        outcome?;
        step_state.check_turns(flow, &self.sum)?;
        let Self {
            composed,
            stages,
            phi: moved,
            ..
        } = self;
        let weights = total(path);
        step_state.move_by(flow, |first, phi, y| {
            let rates = core::iter::once(first).chain(&*stages);
            for (weight, rates) in weights.iter().zip(rates) {
                add(y, step * weight, &rates.y);
                for (index, body) in flow.mechanism.joints() {
                    if !composed[index] {
                        let own = body.ranges().freedoms.clone();
                        add(&mut phi[own.clone()], step * weight, &rates.phi[own]);
                    }
                }
            }
            for (phi, moved) in phi.iter_mut().zip(moved) {
                *phi += *moved;
            }
        })
    }

    /// How far ϕ of one joint moves on a path.
    fn compose(
        &mut self,
        body: &Body,
        step_state: &StepState,
        step: f64,
        path: &[[f64; 4]],
    ) -> Result<(), StepFailure> {
        let (joint, ranges) = (body.joint(), body.ranges());
        let own = ranges.freedoms.clone();
        let near = &mut self.near[..ranges.configuration.len()];
        let far = &mut self.far[..near.len()];
        let part = &mut self.part[..own.len()];
        near.copy_from_slice(body.configuration(&step_state.configuration));
        for weights in path {
            part.fill(0.0);
            for (weight, rates) in weights.iter().zip(&self.local_rates) {
                add(part, step * weight, &rates[own.clone()]);
            }
            add(&mut self.sum[own.clone()], 1.0, part);
            joint.retract(near, part, far);
            near.copy_from_slice(far);
        }
        let found = joint.local(body.configuration(&step_state.base), near, part);
        found.map_err(|cause| body.finite_map(cause))?;
        for ((moved, phi), before) in self.phi[own.clone()]
            .iter_mut()
            .zip(part)
            .zip(&step_state.offset[own])
        {
            *moved = *phi - before;
        }
        Ok(())
    }

    /// `S₀⁻¹ v = D ϕ̇` at stage i of the joints that are composed, from the rates in ϕ.
    fn localize(&mut self, step_state: &StepState, flow: &Flow<'_>, i: usize) {
        let (rates, phi) = match i {
            0 => (&step_state.rates, &step_state.offset),
            _ => (&self.stages[i - 1], &step_state.phi),
        };
        for (index, body) in flow.mechanism.joints() {
            if !self.composed[index] {
                continue;
            }
            let own = body.ranges().freedoms.clone();
            let differential = &mut self.differential[..own.len() * own.len()];
            let base = body.configuration(&step_state.base);
            body.joint()
                .retract_differential(base, &phi[own.clone()], differential);
            let into = &mut self.local_rates[i][own.clone()];
            multiply(differential, &rates.phi[own], into);
        }
    }
}

impl Stepper for CommutatorFree {
    fn attempt(
        &mut self,
        step_state: &mut StepState,
        flow: &mut Flow<'_>,
        Span { time, step }: Span,
    ) -> Result<(), StepFailure> {
        self.localize(step_state, flow, 0);
        for i in 1..NODES.len() {
            self.follow(step_state, flow, step, PATHS[i - 1])?;
            let at = time + step * NODES[i];
            step_state.evaluate_there(flow, at, self.stages[i - 1].parts())?;
            self.localize(step_state, flow, i);
        }
        self.follow(step_state, flow, step, PATHS[3])
    }

    fn error(
        &mut self,
        _step_state: &mut StepState,
        _flow: &mut Flow<'_>,
        _span: Span,
        _tolerance: f64,
    ) -> Result<(f64, usize), StepFailure> {
        Ok((0.0, 0))
    }

    fn order(&self) -> u32 {
        4
    }
}

/// The weights of all parts of a path together.
fn total(path: &[[f64; 4]]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for weights in path {
        add(&mut sum, 1.0, weights);
    }
    sum
}

/// Whether stages of a joint are composed of Φ: its rays are flows, and ϕ of them do not add up.
///
/// Where they do, ϕ of a composition is the sum, which says how often an angle has turned; Φ and its inverse would tell an angle within half a turn.
fn is_composed(body: &Body) -> bool {
    let adds = body.joint().structures().retract_differential.is_identity();
    !adds && rays_are_flows(body)
}

/// Whether `Φ(Φ(Q, ϕ), ϕ) = Φ(Q, 2ϕ)`, at home and a ϕ without symmetry.
fn rays_are_flows(body: &Body) -> bool {
    let (joint, ranges) = (body.joint(), body.ranges());
    let home = body.home();
    let phi: Vec<f64> = (0..ranges.freedoms.len())
        .map(|i| 0.1 + 0.07 * i as f64)
        .collect();
    let twice: Vec<f64> = phi.iter().map(|entry| 2.0 * entry).collect();
    let (mut once, mut composed, mut direct) = (home.clone(), home.clone(), home.clone());
    joint.retract(&home, &phi, &mut once);
    joint.retract(&once, &phi, &mut composed);
    joint.retract(&home, &twice, &mut direct);
    let pairs = composed.iter().zip(&direct);
    // Rounding of two Φ of size 1 is thousands of times less; what a Φ of another kind lacks, ϕ³, millions of times more.
    pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) < 1e-12
}
