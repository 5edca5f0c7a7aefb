//! Where a mechanism is wanted, as a function of time: speeds by laws, and the configuration that they lead to.

use super::ControlError;
use super::error::{require, size};
use super::state::{check_free, is_holonomic};
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_integrate::Tableau;
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::{Body, Mechanism, Space, StateError};
use hamel_runtime::time_function::Law;
use num_traits::Float;

/// By how much a joint moves between two knots at most, rad or m, and how far its laws turn, rad: one step of order 9 over
/// that is exact to 1e-17 (0.1¹⁰ times the method's error constant).
const REACH: f64 = 0.1;

/// A reference has no more knots than this, summed over its joints: they are kept, and each takes some 2 µs to find.
const MOST_KNOTS: f64 = 1e5;

/// A motion of holonomic joints: `v_ref(t)` by one law a speed, and the `Q_ref(t)` that it leads to from a start.
///
/// Q_ref has no closed form for a joint whose velocities do not commute. It is carried from knot to knot on the joint's own
/// manifold when the reference is made, and from the knot before a time to that time when it is asked for: to rounding, at every time up to the end.
#[derive(Clone, Debug)]
pub struct Reference {
    mechanism: Arc<Mechanism>,
    laws: Vec<Law>,
    end: f64,
    /// Time from knot to knot, s.
    spacing: f64,
    /// The configurations at the knots, one after the other.
    knots: Vec<f64>,
    carrier: Carrier,
}

impl Reference {
    /// The motion that begins at the configuration `start` and has the speeds `laws` (one per speed), from 0 to `end` (s).
    ///
    /// # Errors
    /// A nonholonomic joint, or one whose motion is prescribed; constraints that couple joints; a wrong size; numbers that are not finite; a
    /// configuration off its manifold; a motion of more than 1e5 knots, which are 0.1 rad or m apart.
    pub fn new(
        mechanism: Arc<Mechanism>,
        start: &[f64],
        laws: Vec<Law>,
        end: f64,
    ) -> Result<Self, ControlError> {
        check_free(&mechanism)?;
        if let Some(body) = mechanism.bodies().iter().find(|body| !is_holonomic(body)) {
            return Err(ControlError::Joint {
                joint: body.joint_name().into(),
                reason: "is nonholonomic: it has fewer speeds than degrees of freedom, and so cannot be moved along any reference",
            });
        }
        size(
            "speeds of the reference",
            mechanism.layout().speeds,
            laws.len(),
        )?;
        mechanism.check_configuration(start)?;
        require(
            "end of the reference",
            end,
            end >= 0.0,
            "at least 0 and finite",
        )?;
        let count = knots(&laws, mechanism.bodies().len(), end)?;
        let spacing = match count {
            0 => 1.0,
            count => end / count as f64,
        };
        let mut reference = Self {
            carrier: Carrier::new(&mechanism),
            knots: start.to_vec(),
            mechanism,
            laws,
            end,
            spacing,
        };
        reference.lay(count)?;
        Ok(reference)
    }

    /// Carries the start over all knots.
    fn lay(&mut self, count: usize) -> Result<(), ControlError> {
        let size = self.mechanism.layout().configuration;
        self.knots.resize(size * (count + 1), 0.0);
        for knot in 0..count {
            let (from, to) = self.knots.split_at_mut(size * (knot + 1));
            let from = &from[size * knot..];
            let (start, step) = (knot as f64 * self.spacing, self.spacing);
            let span = Span { start, step };
            self.carrier
                .carry(&self.mechanism, &self.laws, span, from, &mut to[..size]);
            let projected = self.mechanism.project(&mut to[..size]);
            projected.map_err(|cause| self.ends(cause, start))?;
        }
        Ok(())
    }

    /// Why it has no value after `time` (s).
    fn ends(&self, cause: StateError, time: f64) -> ControlError {
        let closes = |name: &str| {
            let mut joints = self.mechanism.joints();
            joints
                .any(|(_, body)| body.joint_name() == name && !body.joint().relations().is_empty())
        };
        match cause {
            StateError::FiniteMap { joint, .. } if closes(&joint) => {
                ControlError::ReferenceEnds { joint, time }
            }
            cause => cause.into(),
        }
    }

    /// The mechanism that it is a motion of.
    pub const fn mechanism(&self) -> &Arc<Mechanism> {
        &self.mechanism
    }

    /// Where it ends, s.
    pub const fn end(&self) -> f64 {
        self.end
    }

    /// Q_ref at `time` (s) into `q`. Before 0 and after the end the laws go on, and the error grows with the distance.
    ///
    /// # Errors
    /// When `q` has the wrong size; a time that is not finite, or so far from the reference that the configuration is not.
    pub fn configuration(&mut self, time: f64, q: &mut [f64]) -> Result<(), ControlError> {
        let length = self.mechanism.layout().configuration;
        size("configuration", length, q.len())?;
        require("time", time, true, "finite")?;
        let last = self.knots.len() / length.max(1);
        // Of a negative or NaN time the cast makes 0.
        let knot = ((time / self.spacing) as usize).min(last.saturating_sub(1));
        let from = &self.knots[length * knot..length * (knot + 1)];
        let start = knot as f64 * self.spacing;
        let span = Span {
            start,
            step: time - start,
        };
        self.carrier
            .carry(&self.mechanism, &self.laws, span, from, q);
        Ok(self
            .mechanism
            .check_vector("configuration", Space::Configuration, q)?)
    }

    /// v_ref at `time` (s), one entry per speed.
    pub fn speeds(&self, time: f64) -> impl Iterator<Item = f64> + '_ {
        self.laws.iter().map(move |law| law.velocity(time))
    }

    /// v̇_ref at `time` (s), one entry per speed.
    pub fn accelerations(&self, time: f64) -> impl Iterator<Item = f64> + '_ {
        self.laws.iter().map(move |law| law.acceleration(time))
    }
}

/// How many stretches the motion is cut into.
fn knots(laws: &[Law], joints: usize, end: f64) -> Result<usize, ControlError> {
    let mut pace = 0.0_f64;
    for law in laws {
        let numbers = [law.rate, law.amplitude, law.frequency, law.phase];
        for number in numbers {
            require("a number of the reference", number, true, "finite")?;
        }
        let speed = law.rate.abs() + (law.amplitude * law.frequency).abs();
        pace = pace.max(speed).max(law.frequency.abs());
    }
    let count = Float::ceil(end * pace / REACH);
    let all = count * joints as f64;
    require(
        "the way of the reference, in steps of 0.1 rad or m of each joint,",
        all,
        all <= MOST_KNOTS,
        "at most 1e5",
    )?;
    Ok(count as usize)
}

/// A stretch of time, s.
#[derive(Clone, Copy)]
struct Span {
    start: f64,
    step: f64,
}

/// One step of order 9 of the kinematics alone, joint by joint.
#[derive(Clone, Debug)]
struct Carrier {
    tableau: &'static Tableau,
    /// ϕ̇ of one joint at each stage.
    stages: Vec<[f64; MOST_FREEDOMS]>,
    /// S₀⁻¹ of one joint.
    inverse: Vec<f64>,
    /// Q of all joints at a stage.
    moved: Vec<f64>,
}

impl Carrier {
    fn new(mechanism: &Mechanism) -> Self {
        let tableau = &Tableau::VERNER_9;
        Self {
            tableau,
            stages: vec![[0.0; MOST_FREEDOMS]; tableau.nodes.len()],
            inverse: vec![0.0; MOST_FREEDOMS * MOST_FREEDOMS],
            moved: vec![0.0; mechanism.layout().configuration],
        }
    }

    /// Moves `from` at the start of `span` to its end, under `laws`.
    fn carry(
        &mut self,
        mechanism: &Mechanism,
        laws: &[Law],
        span: Span,
        from: &[f64],
        to: &mut [f64],
    ) {
        for (_, body) in mechanism.joints() {
            let own = &laws[body.ranges().speeds.clone()];
            let configuration = body.ranges().configuration.clone();
            self.carry_joint(
                body,
                own,
                span,
                body.configuration(from),
                &mut to[configuration],
            );
        }
    }

    fn carry_joint(&mut self, body: &Body, laws: &[Law], span: Span, from: &[f64], to: &mut [f64]) {
        let size = laws.len();
        for stage in 0..self.stages.len() {
            let phi = self.combine(self.tableau.matrix[stage], span.step);
            let time = span.start + span.step * self.tableau.nodes[stage];
            self.stages[stage] = self.rate(body, laws, time, from, &phi[..size]);
        }
        let phi = self.combine(self.tableau.weights, span.step);
        body.joint().retract(from, &phi[..size], to);
    }

    fn combine(&self, weights: &[f64], step: f64) -> [f64; MOST_FREEDOMS] {
        let mut phi = [0.0; MOST_FREEDOMS];
        for (weight, stage) in weights.iter().zip(&self.stages) {
            for (phi, rate) in phi.iter_mut().zip(stage) {
                *phi += step * weight * rate;
            }
        }
        phi
    }

    /// `ϕ̇ = D⁻¹ S₀(Q′)⁻¹ v_ref(t)` at Q′ = Φ(from, ϕ).
    fn rate(
        &mut self,
        body: &Body,
        laws: &[Law],
        time: f64,
        from: &[f64],
        phi: &[f64],
    ) -> [f64; MOST_FREEDOMS] {
        let (joint, size) = (body.joint(), phi.len());
        let moved = &mut self.moved[..from.len()];
        joint.retract(from, phi, moved);
        let inverse = &mut self.inverse[..size * size];
        joint.velocity_map_inverse(moved, inverse);
        let (mut local, mut rate) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
        for (column, law) in inverse.chunks_exact(size.max(1)).zip(laws) {
            let velocity = law.velocity(time);
            for (sum, entry) in local.iter_mut().zip(column) {
                *sum += entry * velocity;
            }
        }
        joint.retract_differential_inverse(from, phi, &local[..size], &mut rate[..size]);
        rate
    }
}
