//! What turns the midpoint rule into a discrete-gradient method on the port-Hamiltonian form: one number per step.
//!
//! The midpoint rule takes `ϕ̇ = T v̄`, `p̄̇ = J̄22 v̄ − Tᵀ∂H/∂ϕ + τ̄` with `v̄ = ∂H/∂p̄` half-way. A discrete gradient takes other partial derivatives of H: those half-way
//! and a correction along the change over the step, such that their product with the change is that of H (O. Gonzalez, *Time integration and
//! discrete Hamiltonian systems*, 1996), while the structure matrix stays skew. Here, in the metric of the kinetic energy:
//! - `v̄ + λ M̄⁻¹Δp̄` for v̄ under T and J̄22, and in the work done;
//! - `Tᵀ∂H/∂ϕ + λ p̄/h`, along `T⁻¹Δϕ = h v̄`.
//!
//! λ is chosen such that the energy at the end is what it shall be. The energy error has the derivative `−p̄ᵀv̄ − Δp̄ᵀM̄⁻¹Δp̄` by λ, which is zero only at rest: at top speed Δp̄ is small, at turning points p̄ is. The energy is held against that at the beginning of all steps and the work done since, so
//! that rounding does not add up.
//!
//! None of this asks for a fixed step size. λ is of the third power of the step, as the error of the midpoint rule is, and step control judges both together
//! (`collocation::quadrature`). Rounding of the energies over p̄ᵀv̄ is in λ at any length of step; shorter steps would not make it smaller, so that the
//! estimate leaves it out ([`Correction::forget_scatter`]).

use super::StepFailure;
use super::compensation::add_exactly;
use super::flow::{Flow, Rates, multiply, retract};
use super::step_state::{StepState, add};
use super::stepper::Span;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{Dynamics, Recursive};
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::{Body, StateError};
use hamel_runtime::spatial::bracket_dual_product;
use nalgebra::Vector6;

/// The part of the energies that rounding makes of a mechanism of tens of joints. What is left of it adds up to no more, as the energy is
/// always held against that of the beginning; to go after it would shake λ, by as much more as p̄ changes little.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Changes of increments, as parts of the increments, from which on λ is adjusted: the energy of a stiff spring in increments further off would throw
/// λ about.
const NEAR: f64 = 1e-3;

/// The correction at work.
pub(super) struct Correction {
    dynamics: Recursive,
    lambda: f64,
    /// That of the last step taken.
    last: f64,
    /// What the energy at the end of the step being tried is off from what it shall be, and what that of the last step taken was, J.
    rest: f64,
    last_rest: f64,
    /// What rounding of the energies and the rest of the step before make of λ at most.
    scatter: f64,
    /// Whether the next increments were computed with λ, and have converged enough for their energy to mean something.
    is_in_force: bool,
    /// Whether λ needed no change when last looked at.
    is_settled: bool,
    /// Energy at the state as it shall be: what it was at first, and the work done since, J; NaN before the first step.
    energy: f64,
    /// What it is too coarse to hold.
    compensation: f64,
    /// The most that energies have come to, J: what dampers leave of them is known to no more digits than what they took.
    largest: f64,
    /// Work of the step being tried, J.
    work: f64,
    /// Kinetic energy half-way, J.
    kinetic: f64,
    /// Δp̄, and M̄⁻¹ of it.
    change: Vec<f64>,
    faster: Vec<f64>,
    /// `v̄ + λ M̄⁻¹Δp̄`.
    speeds: Vec<f64>,
    /// Q half-way and at the end, ϕ and p̄ at the end.
    middle: Vec<f64>,
    end: Vec<f64>,
    phi: Vec<f64>,
    momenta: Vec<f64>,
    /// `T M̄⁻¹Δp̄` and `J̄22 M̄⁻¹Δp̄ − p̄/h`.
    moved: Rates,
    composites: Vec<Vector6<f64>>,
    matrices: Matrices,
}

/// What potential energies of bodies at Q are rounded by, in roundings, J: the heights of frames and centres of mass may cancel, and energies of bodies too, but not their
/// roundings.
fn potentials(flow: &Flow<'_>, configuration: &[f64], speeds: &[f64]) -> Result<f64, StateError> {
    let mechanism = &flow.mechanism;
    let kinematics = mechanism.kinematics(configuration, speeds)?;
    let bodies = kinematics.bodies.iter().zip(mechanism.bodies());
    let sizes = bodies.map(|(state, body)| {
        let mass = body.mass();
        mass.mass * (state.pose.translation.norm() + mass.com.norm())
    });
    Ok(sizes.sum::<f64>() * mechanism.gravity().norm())
}

/// One joint's matrices.
struct Matrices {
    structure: Vec<f64>,
    basis: Vec<f64>,
    twists: Vec<f64>,
    gradient: Vec<f64>,
    inverse: Vec<f64>,
}

impl Correction {
    pub(super) fn new(flow: &Flow<'_>) -> Self {
        let mechanism = &flow.mechanism;
        let layout = mechanism.layout();
        let (freedoms, speeds) = (vec![0.0; layout.freedoms], vec![0.0; layout.speeds]);
        let configuration = vec![0.0; layout.configuration];
        Self {
            dynamics: Recursive::new(Arc::clone(mechanism)),
            lambda: 0.0,
            last: 0.0,
            rest: 0.0,
            last_rest: 0.0,
            scatter: 0.0,
            is_in_force: false,
            is_settled: false,
            energy: f64::NAN,
            compensation: 0.0,
            largest: 0.0,
            work: 0.0,
            kinetic: 0.0,
            change: speeds.clone(),
            faster: speeds.clone(),
            speeds: speeds.clone(),
            middle: configuration.clone(),
            end: configuration,
            phi: freedoms,
            momenta: speeds,
            moved: flow.new_rates(),
            composites: vec![Vector6::zeros(); mechanism.bodies().len()],
            matrices: Matrices {
                structure: vec![0.0; MOST_FREEDOMS * MOST_FREEDOMS],
                basis: vec![0.0; MOST_FREEDOMS * MOST_FREEDOMS],
                twists: vec![0.0; MOST_FREEDOMS * MOST_FREEDOMS],
                gradient: vec![0.0; MOST_FREEDOMS * MOST_FREEDOMS],
                inverse: vec![0.0; MOST_FREEDOMS * MOST_FREEDOMS],
            },
        }
    }

    /// A step is about to be tried.
    pub(super) fn begin(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
    ) -> Result<(), StepFailure> {
        if self.energy.is_nan() {
            self.energy = flow.energy(&step_state.configuration, &step_state.y)?;
        }
        let potentials = potentials(flow, &step_state.configuration, &self.speeds)?;
        self.largest = self.largest.max(potentials);
        // What an iteration that failed has made of it is no beginning for another one.
        self.lambda = self.last;
        (self.is_in_force, self.is_settled) = (false, false);
        Ok(())
    }

    /// Increments of the size `whole` have last changed by `size`.
    pub(super) fn see(&mut self, size: f64, whole: f64) {
        self.is_in_force = size <= NEAR * whole;
    }

    /// Whether the energy at the end is what it shall be.
    pub(super) const fn is_settled(&self) -> bool {
        self.is_settled
    }

    /// Takes the part that rounding of the energies has in λ out of a `difference` (ϕ, then p̄) over the `step` (s) that was just tried. The rounding may be of this
    /// step or of the one before. In a shorter step it is no smaller; near rest, where the energy hardly changes with p̄, it is large.
    pub(super) fn forget_scatter(&self, step: f64, difference: &mut [f64]) {
        let (turned, pushed) = difference.split_at_mut(self.phi.len());
        // Without any energy at all, that is 0/0, and nothing of λ counts.
        let part = self.lambda.abs().min(self.scatter).copysign(self.lambda);
        self.add_moved(step * part, turned, pushed);
    }

    /// Adds so much of what λ moves; none of it where it is 0, as p̄/h is infinite where a body moves over the shortest steps.
    fn add_moved(&self, weight: f64, phi: &mut [f64], y: &mut [f64]) {
        if weight != 0.0 {
            self.moved.add_to(weight, phi, y);
        }
    }

    /// The step just tried is taken.
    pub(super) fn accept(&mut self) {
        (self.last, self.last_rest) = (self.lambda, self.rest);
        self.largest = self.largest.max(self.energy.abs() + self.kinetic);
        (self.energy, self.compensation) = add_exactly(self.energy, self.work + self.compensation);
    }

    /// Corrects `rates` half-way, where `step_state` has come to by `increment` (ϕ, then p̄).
    pub(super) fn apply(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        span: Span,
        increment: &[f64],
        rates: &mut Rates,
    ) -> Result<(), StepFailure> {
        let (turned, pushed) = increment.split_at(step_state.offset.len());
        self.middle.copy_from_slice(flow.configuration());
        self.change.fill(0.0);
        add(&mut self.change, 2.0, pushed);
        flow.speeds_of(&self.middle, &self.change, &mut self.faster)?;
        self.speeds.copy_from_slice(&rates.speeds);
        add(&mut self.speeds, self.lambda, &self.faster);
        self.dynamics
            .set_moment(flow.moment(span.time + 0.5 * span.step));
        self.work = span.step * self.power(flow);
        self.dynamics
            .composite_momenta(&self.middle, &rates.speeds, &mut self.composites);
        let twice = step_state
            .next_y
            .iter()
            .zip(&rates.speeds)
            .map(|(p, v)| p * v);
        self.kinetic = 0.5 * twice.sum::<f64>();
        if self.is_in_force {
            self.adjust(step_state, flow, turned)?;
        }
        self.move_by_structure(step_state, flow, span.step, &rates.speeds);
        self.add_moved(self.lambda, &mut rates.phi, &mut rates.y);
        Ok(())
    }

    /// λ by what the energy at the end lacks, as it now is.
    fn adjust(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        turned: &[f64],
    ) -> Result<(), StepFailure> {
        self.phi.copy_from_slice(&step_state.offset);
        add(&mut self.phi, 2.0, turned);
        self.momenta.copy_from_slice(&step_state.y);
        add(&mut self.momenta, 1.0, &self.change);
        retract(&flow.mechanism, &step_state.base, &self.phi, &mut self.end);
        let found = flow.energy(&self.end, &self.momenta)?;
        if !found.is_finite() {
            let at = (&*self.end, &*self.speeds);
            return Err(flow.mechanism.infinite_energy(at).into());
        }
        let own = self.change.iter().zip(&self.faster);
        let carried = 2.0 * self.kinetic + own.map(|(p, v)| p * v).sum::<f64>();
        let error = (found - self.energy) - (self.work + self.compensation);
        let rounding = ROUNDING * self.largest.max(found.abs() + self.kinetic);
        self.rest = error;
        self.scatter = (rounding + self.last_rest.abs()) / carried.abs();
        self.is_settled = error.abs() <= rounding || carried.abs() <= rounding;
        if !self.is_settled {
            self.lambda += error / carried;
        }
        Ok(())
    }

    /// The power of inputs and elements half-way, W.
    fn power(&mut self, flow: &Flow<'_>) -> f64 {
        let mut power = 0.0;
        if !flow.mechanism.elements().is_empty() {
            // Elements see the bodies move as they do with the corrected speeds.
            self.dynamics
                .composite_momenta(&self.middle, &self.speeds, &mut self.composites);
            power += self.dynamics.element_power_here(&self.middle, &self.speeds);
        }
        for (_, body) in flow.mechanism.joints() {
            let efforts = flow.last_efforts();
            power += self
                .matrices
                .power(body, &self.middle, &self.speeds, efforts);
        }
        power
    }

    /// `(T, J̄22) M̄⁻¹Δp̄` and `−p̄/h`.
    fn move_by_structure(
        &mut self,
        step_state: &StepState,
        flow: &mut Flow<'_>,
        step: f64,
        speeds: &[f64],
    ) {
        let (base, phi) = (&step_state.base, &step_state.phi);
        flow.local_rates(base, phi, &self.faster, &mut self.moved.phi);
        for (index, body) in flow.mechanism.joints() {
            let own = body.ranges().speeds.clone();
            let carried = &self.composites[flow.mechanism.carried(index)];
            let bodies = &flow.mechanism.bodies()[flow.mechanism.carried(index)];
            let momenta = (
                &step_state.next_y[own.clone()],
                carried,
                &speeds[own.clone()],
            );
            let (faster, out) = (&self.faster[own.clone()], &mut self.moved.y[own]);
            let rotors = flow.mechanism.port_armature(index);
            let structure = self
                .matrices
                .structure((body, bodies), &self.middle, momenta, rotors);
            multiply(structure, faster, out);
        }
        // Over the shortest steps p̄/h is a number where 1/h is not.
        for (rate, momentum) in self.moved.y.iter_mut().zip(&step_state.next_y) {
            *rate -= momentum / step;
        }
    }
}

impl Matrices {
    /// J̄22 of one joint, S×S, of its own p̄ and the momenta of all that hangs on each of its bodies, which a joint with constraints feels in full:
    /// the sum over the bodies of `X̄ᵀ ad*_{X̄} h + E T − TᵀEᵀ` with `E = ∂(X̄ᵀh)/∂ϕ` and `T = S₀⁻¹S̄`; of a rotor with the momentum a w at a port, `E = ∂(p̄ᵀ a w)/∂ϕ`.
    fn structure(
        &mut self,
        (body, carried): (&Body, &[Body]),
        q: &[f64],
        (momenta, composites, velocity): (&[f64], &[Vector6<f64>], &[f64]),
        rotors: &[f64],
    ) -> &[f64] {
        let (joint, q) = (body.joint(), body.configuration(q));
        let (freedoms, speeds) = (body.ranges().freedoms.len(), body.ranges().speeds.len());
        let out = &mut self.structure[..speeds * speeds];
        out.fill(0.0);
        if joint.structures().speed_basis.is_identity() {
            if !joint.structures().gamma.is_zero() {
                joint.j22(q, momenta, out);
            }
            return out;
        }
        let basis = &mut self.basis[..freedoms * speeds];
        let inverse = &mut self.inverse[..freedoms * freedoms];
        let twists = &mut self.twists[..6 * freedoms];
        let gradient = &mut self.gradient[..speeds * freedoms];
        joint.speed_basis(q, basis);
        joint.velocity_map_inverse(q, inverse);
        let columns = || basis.chunks_exact(freedoms.max(1));
        for (body, composite) in carried.iter().zip(composites) {
            body.joint().twist_map_child(q, twists);
            body.joint().effort_gradient(q, composite, gradient);
            let twist = |own: &[f64]| {
                let mut sum = [0.0; 6];
                multiply(twists, own, &mut sum);
                Vector6::from(sum)
            };
            for (b, own) in columns().enumerate() {
                let (mut rate, mut moved) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
                let (rate, moved) = (&mut rate[..freedoms], &mut moved[..speeds]);
                multiply(inverse, own, rate);
                multiply(gradient, rate, moved);
                let turned = bracket_dual_product(&twist(own), composite);
                for (a, other) in columns().enumerate() {
                    out[b * speeds + a] += moved[a] + twist(other).dot(&turned);
                    out[a * speeds + b] -= moved[a];
                }
            }
        }
        for (port, &inertia) in rotors.iter().enumerate() {
            let mut row = [0.0; MOST_FREEDOMS];
            let row = &mut row[..freedoms];
            joint.port_row(q, port, row);
            let rate = |own: &[f64]| own.iter().zip(&*row).map(|(s, p)| s * p).sum::<f64>();
            let turning: f64 = columns().zip(velocity).map(|(own, v)| rate(own) * v).sum();
            for b in 0..speeds {
                let (mut unit, mut moved) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
                unit[b] = 1.0;
                let (unit, moved) = (&unit[..speeds], &mut moved[..speeds]);
                joint.port_row_rate(q, unit, port, moved);
                for a in 0..speeds {
                    let entry = inertia * turning * moved[a];
                    out[b * speeds + a] += entry;
                    out[a * speeds + b] -= entry;
                }
            }
        }
        out
    }

    /// Power of the efforts at one joint, W.
    fn power(&mut self, body: &Body, q: &[f64], speeds: &[f64], efforts: &[f64]) -> f64 {
        let (joint, ranges) = (body.joint(), body.ranges());
        let basis = &mut self.basis[..ranges.freedoms.len() * ranges.speeds.len()];
        joint.speed_basis(body.configuration(q), basis);
        let columns = basis.chunks_exact(ranges.freedoms.len().max(1));
        let efforts = &efforts[ranges.freedoms.clone()];
        let terms = columns.zip(&speeds[ranges.speeds.clone()]);
        let effort = |column: &[f64]| column.iter().zip(efforts).map(|(b, t)| b * t).sum::<f64>();
        terms.map(|(column, speed)| effort(column) * speed).sum()
    }
}
