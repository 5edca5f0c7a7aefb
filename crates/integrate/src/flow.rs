//! The vector field in (ϕ, y) around a base point, for both forms.

use super::Form;
use super::StepFailure;
use super::hybrid::Sliding;
use super::inputs::{Given, HeldInputs};
use super::step_state::add;
use alloc::boxed::Box;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::{Deref, DerefMut};
use hamel_runtime::dynamics::{Dynamics, DynamicsError, EffortAtPort};
use hamel_runtime::mechanism::{CONSTRAINT_TOLERANCE, Mechanism, Space};
use hamel_runtime::scalar::all_finite;
use hamel_runtime::time_function::Moment;

/// ϕ̇, ẏ and v̄ at one stage.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    pub(super) phi: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) speeds: Vec<f64>,
}

impl Rates {
    /// Becomes a copy of others of the same mechanism, in its own room.
    pub(super) fn copy_from(&mut self, other: &Self) {
        self.phi.copy_from_slice(&other.phi);
        self.y.copy_from_slice(&other.y);
        self.speeds.copy_from_slice(&other.speeds);
    }

    /// The first body of whose joint ϕ̇ or ẏ is not finite.
    pub(super) fn first_infinite(&self, mechanism: &Mechanism) -> Option<usize> {
        if all_finite(&self.phi) & all_finite(&self.y) {
            return None;
        }
        mechanism.bodies().iter().position(|body| {
            let ranges = body.ranges();
            let (phi, y) = (
                &self.phi[ranges.freedoms.clone()],
                &self.y[ranges.speeds.clone()],
            );
            !(all_finite(phi) && all_finite(y))
        })
    }

    /// Adds `weight` times ϕ̇ and ẏ.
    pub(super) fn add_to(&self, weight: f64, phi: &mut [f64], y: &mut [f64]) {
        add(phi, weight, &self.phi);
        add(y, weight, &self.y);
    }

    /// The room of all three.
    pub(super) fn parts(&mut self) -> RatesMut<'_> {
        RatesMut {
            phi: &mut self.phi,
            y: &mut self.y,
            speeds: &mut self.speeds,
        }
    }

    /// Room for those of a mechanism.
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let layout = mechanism.layout();
        Self {
            phi: vec![0.0; layout.freedoms],
            y: vec![0.0; layout.speeds],
            speeds: vec![0.0; layout.speeds],
        }
    }
}

/// Room for [`Rates`], wherever it is.
#[derive(Debug)]
pub(super) struct RatesMut<'a> {
    pub(super) phi: &'a mut [f64],
    pub(super) y: &'a mut [f64],
    pub(super) speeds: &'a mut [f64],
}

/// Equations of motion of the caller's, or made for a piece of the motion.
pub(super) enum Equations<'a> {
    Lent(&'a mut dyn Dynamics),
    Own(Box<dyn Dynamics>),
}

impl<'a> Deref for Equations<'a> {
    type Target = dyn Dynamics + 'a;

    fn deref(&self) -> &Self::Target {
        match self {
            Self::Lent(dynamics) => *dynamics,
            Self::Own(dynamics) => &**dynamics,
        }
    }
}

impl DerefMut for Equations<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        match self {
            Self::Lent(dynamics) => *dynamics,
            Self::Own(dynamics) => &mut **dynamics,
        }
    }
}

/// The equations of motion with their inputs, as a vector field.
pub(super) struct Flow<'a> {
    dynamics: Equations<'a>,
    given: Given<'a>,
    pub(super) mechanism: Arc<Mechanism>,
    pub(super) form: Form,
    pub(super) evaluations: usize,
    configuration: Vec<f64>,
    efforts: Vec<f64>,
    /// The inputs of the last [`Flow::hold`], which stand until the next; `None` where inputs follow the state.
    held: Option<HeldInputs>,
    /// Efforts of friction at the joints that slide: they are added to the inputs.
    friction: Vec<Sliding>,
    /// A time within the piece of all functions of time that the present step is in.
    pub(super) within: f64,
}

impl<'a> Flow<'a> {
    pub(super) fn new(dynamics: &'a mut dyn Dynamics, given: Given<'a>, form: Form) -> Self {
        let mechanism = Arc::clone(dynamics.mechanism());
        let layout = *mechanism.layout();
        Self {
            dynamics: Equations::Lent(dynamics),
            given,
            form,
            evaluations: 0,
            configuration: vec![0.0; layout.configuration],
            efforts: vec![0.0; layout.freedoms],
            held: None,
            friction: Vec::new(),
            within: 0.0,
            mechanism,
        }
    }

    /// Functions at whose zeros the inputs bend, at time `time`, `q` and the v̄ of `y`, in place of those in `bends`; none where inputs are held.
    pub(super) fn input_bends(
        &mut self,
        time: f64,
        (q, y): (&[f64], &[f64]),
        bends: &mut Vec<f64>,
    ) -> Result<(), DynamicsError> {
        bends.clear();
        if self.given.bends.is_none() || self.held.is_some() {
            return Ok(());
        }
        let mut speeds = y.to_vec();
        self.all_speeds_of(q, y, &mut speeds)?;
        if let Some(input_bends) = &mut self.given.bends {
            input_bends(time, q, &speeds, bends);
        }
        Ok(())
    }

    /// Inputs at time `time`, `q` and v̄, held from now on.
    pub(super) fn hold(&mut self, time: f64, q: &[f64], speeds: &[f64]) {
        let mut efforts = vec![0.0; self.mechanism.layout().freedoms];
        self.given.fill(time, q, speeds, &mut efforts);
        let at_ports = self.given.at_ports(time, q, speeds);
        self.held = Some(HeldInputs::new(&self.mechanism, q, efforts, at_ports));
    }

    /// What of the inputs acts at ports, at time `time`, `q` and v̄ or as held.
    pub(super) fn inputs_at_ports(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
    ) -> Vec<EffortAtPort> {
        match &self.held {
            Some(held) => held.at_ports().to_vec(),
            None => self.given.at_ports(time, q, speeds),
        }
    }

    /// Whether the rates at a state are the same at all times, until the next [`Flow::hold`].
    pub(super) fn is_autonomous(&self) -> bool {
        let is_constant = self.given.inputs.is_none() || self.held.is_some();
        is_constant && !self.mechanism.changes_with_time()
    }

    /// Whether no inputs and no friction act.
    pub(super) fn is_left_alone(&self) -> bool {
        self.given.inputs.is_none() && self.friction.is_empty()
    }

    /// A time of the present step, for functions of time.
    pub(super) const fn moment(&self, time: f64) -> Moment {
        Moment {
            time,
            within: self.within,
        }
    }

    /// The equations of motion.
    pub(super) fn dynamics(&mut self) -> &mut dyn Dynamics {
        &mut *self.dynamics
    }

    /// From now on the equations of a mechanism with the same joints; those until now.
    pub(super) fn replace_equations(&mut self, equations: Equations<'a>) -> Equations<'a> {
        self.mechanism = Arc::clone(equations.mechanism());
        core::mem::replace(&mut self.dynamics, equations)
    }

    /// From now on these efforts of friction.
    pub(super) fn set_friction(&mut self, friction: Vec<Sliding>) {
        self.friction = friction;
    }

    /// Room for the rates of one stage.
    pub(super) fn new_rates(&self) -> Rates {
        Rates::new(&self.mechanism)
    }

    /// y of an initial v̄: v̄ itself or `p̄ = M̄ v̄`.
    pub(super) fn initial(&mut self, q: &[f64], speeds: &[f64]) -> Result<Vec<f64>, DynamicsError> {
        let mut y = speeds.to_vec();
        self.check_constraints(q, speeds, &mut y)?;
        if self.form == Form::Hamiltonian {
            self.dynamics.momenta(q, speeds, &mut y)?;
        }
        Ok(y)
    }

    /// Whether the speeds are such as the constraints that couple joints allow; `y` becomes what they make of them.
    fn check_constraints(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        y: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.dynamics.complete_speeds(q, y)?;
        let limit = speeds.iter().fold(1.0_f64, |m, v| m.max(v.abs())) * CONSTRAINT_TOLERANCE;
        let dependent = self.mechanism.dependent_speeds().iter();
        for (&speed, constraint) in dependent.zip(self.mechanism.constraints()) {
            let value = (speeds[speed] - y[speed]).abs();
            if value.is_nan() || value > limit {
                return Err(DynamicsError::ConstraintViolated {
                    constraint: constraint.name.clone(),
                    value,
                    limit,
                });
            }
        }
        Ok(())
    }

    /// Whether y is v̄, as in the Lagrangian form.
    pub(super) fn y_is_speeds(&self) -> bool {
        self.form == Form::Lagrangian
    }

    /// The v̄ that `y` amounts to at `q`.
    pub(super) fn speeds_of(
        &mut self,
        q: &[f64],
        y: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        match self.form {
            Form::Lagrangian => speeds.copy_from_slice(y),
            Form::Hamiltonian => self.dynamics.speeds(q, y, speeds)?,
        }
        Ok(())
    }

    /// The same, with those that constraints couple to the others.
    pub(super) fn all_speeds_of(
        &mut self,
        q: &[f64],
        y: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        self.speeds_of(q, y, speeds)?;
        match self.form {
            Form::Lagrangian => self.dynamics.complete_speeds(q, speeds),
            Form::Hamiltonian => Ok(()),
        }
    }

    /// Rates at time `time`, at `Φ(base, phi)` and `y`.
    pub(super) fn evaluate(
        &mut self,
        time: f64,
        base: &[f64],
        phi: &[f64],
        y: &[f64],
        mut rates: RatesMut<'_>,
    ) -> Result<(), StepFailure> {
        self.evaluations += 1;
        retract(&self.mechanism, base, phi, &mut self.configuration);
        self.dynamic_rates(time, y, &mut rates)?;
        self.local_rates(base, phi, rates.speeds, rates.phi);
        let found = [
            (
                "rate of the local coordinates",
                Space::Freedoms,
                &*rates.phi,
            ),
            ("acceleration", Space::Speeds, &*rates.y),
        ];
        let at = (&*self.configuration, &*rates.speeds);
        Ok(self.mechanism.check_finite(at, &found)?)
    }

    /// The name of the joint under a body.
    pub(super) fn joint_name(&self, body: usize) -> String {
        let bodies = self.mechanism.bodies();
        bodies.get(body).map_or("", |body| body.joint_name()).into()
    }

    /// The joint whose ϕ or y stands in a row of both.
    pub(super) fn row_name(&self, row: usize) -> String {
        let freedoms = self.mechanism.layout().freedoms;
        let owns = |body: &&hamel_runtime::mechanism::Body| {
            let ranges = body.ranges();
            match row.checked_sub(freedoms) {
                None => ranges.freedoms.contains(&row),
                Some(speed) => ranges.speeds.contains(&speed),
            }
        };
        let body = self.mechanism.bodies().iter().find(owns);
        body.map_or("", |body| body.joint_name()).into()
    }

    /// Q at which the equations were evaluated last.
    pub(super) fn configuration(&self) -> &[f64] {
        &self.configuration
    }

    /// τ as the equations were evaluated with it last.
    pub(super) fn last_efforts(&self) -> &[f64] {
        &self.efforts
    }

    /// H at `q` and y, the momenta, J.
    pub(super) fn energy(&mut self, q: &[f64], y: &[f64]) -> Result<f64, DynamicsError> {
        self.dynamics.hamiltonian(q, y)
    }

    /// Rates at `q` that differ from `rates` in their base points alone: now `base`, with `q = Φ(base, phi)`.
    pub(super) fn recentre(&mut self, q: &[f64], base: &[f64], phi: &[f64], rates: &mut Rates) {
        self.configuration.copy_from_slice(q);
        self.local_rates(base, phi, &rates.speeds, &mut rates.phi);
    }

    /// τ of inputs, friction and functions of time at time `time`, `q` and v̄.
    pub(super) fn given_efforts(
        &mut self,
        time: f64,
        q: &[f64],
        speeds: &[f64],
        efforts: &mut [f64],
    ) {
        let moment = self.moment(time);
        let inputs = (&mut self.given, self.held.as_ref());
        fill(inputs, &self.mechanism, (time, q, speeds), efforts);
        add_friction(&self.friction, q, efforts);
        self.mechanism.add_timed_efforts(moment, efforts);
        self.dynamics.set_moment(moment);
    }

    /// τ at time `time`, `q` and v̄, with the accelerations of driven joints, as [`Dynamics::forward_dynamics`] takes them.
    pub(super) fn efforts(&mut self, time: f64, q: &[f64], speeds: &[f64], efforts: &mut [f64]) {
        self.given_efforts(time, q, speeds, efforts);
        let moment = self.moment(time);
        self.mechanism.prescribe_accelerations(moment, efforts);
    }

    /// What one unit of each speed adds to y at `q`: 1, or what it adds to its own momentum.
    pub(super) fn units(&mut self, q: &[f64]) -> Result<Vec<f64>, DynamicsError> {
        let count = self.mechanism.layout().speeds;
        let mut units = vec![1.0; count];
        if self.form == Form::Lagrangian {
            return Ok(units);
        }
        let (mut speeds, mut momenta) = (vec![0.0; count], vec![0.0; count]);
        for (i, unit) in units.iter_mut().enumerate() {
            speeds[i] = 1.0;
            self.dynamics.momenta(q, &speeds, &mut momenta)?;
            speeds[i] = 0.0;
            // The momentum of a speed that constraints determine is 0.
            if momenta[i] > 0.0 {
                *unit = momenta[i];
            }
        }
        Ok(units)
    }

    /// v̄ and ẏ at the current configuration.
    fn dynamic_rates(
        &mut self,
        time: f64,
        y: &[f64],
        rates: &mut RatesMut<'_>,
    ) -> Result<(), DynamicsError> {
        let moment = self.moment(time);
        let Self {
            dynamics,
            given,
            mechanism,
            configuration,
            efforts,
            held,
            friction,
            ..
        } = self;
        dynamics.set_moment(moment);
        let mut fill = |speeds: &[f64], efforts: &mut [f64]| {
            let inputs = (&mut *given, held.as_ref());
            fill(inputs, mechanism, (time, configuration, speeds), efforts);
            add_friction(friction, configuration, efforts);
            mechanism.add_timed_efforts(moment, efforts);
            mechanism.prescribe_accelerations(moment, efforts);
        };
        match self.form {
            Form::Lagrangian => {
                rates.speeds.copy_from_slice(y);
                dynamics.complete_speeds(configuration, rates.speeds)?;
                fill(rates.speeds, efforts);
                dynamics.forward_dynamics(configuration, rates.speeds, efforts, rates.y)
            }
            Form::Hamiltonian => {
                let mut fill = |speeds: &[f64], out: &mut [f64]| {
                    fill(speeds, efforts);
                    out.copy_from_slice(efforts);
                };
                dynamics.momentum_rates(configuration, y, &mut fill, rates.speeds, rates.y)
            }
        }
    }

    /// ϕ̇ of all joints, at the Q at which the equations were evaluated last: `Φ(base, phi)`.
    pub(super) fn local_rates(&self, base: &[f64], phi: &[f64], speeds: &[f64], rates: &mut [f64]) {
        for (_, body) in self.mechanism.joints() {
            let ranges = body.ranges();
            let own = ranges.freedoms.clone();
            body.joint().local_rate(
                body.configuration(base),
                &phi[own.clone()],
                body.configuration(&self.configuration),
                &speeds[ranges.speeds.clone()],
                &mut rates[own],
            );
        }
    }
}

/// Inputs as they are held, or else as they follow the state.
fn fill(
    (given, held): (&mut Given<'_>, Option<&HeldInputs>),
    mechanism: &Mechanism,
    (time, q, speeds): (f64, &[f64], &[f64]),
    efforts: &mut [f64],
) {
    match held {
        Some(held) => held.efforts_at(mechanism, q, efforts),
        None => given.fill(time, q, speeds, efforts),
    }
}

fn add_friction(friction: &[Sliding], q: &[f64], efforts: &mut [f64]) {
    for own in friction {
        own.add(q, efforts);
    }
}

/// The largest number of degrees of freedom of a joint.
pub(super) fn widest(mechanism: &Mechanism) -> usize {
    let bodies = mechanism.bodies().iter();
    let widest = bodies.map(|body| body.ranges().freedoms.len()).max();
    widest.unwrap_or(0)
}

/// `Φ(base, phi)` of all joints.
pub(super) fn retract(mechanism: &Mechanism, base: &[f64], phi: &[f64], moved: &mut [f64]) {
    for (_, body) in mechanism.joints() {
        let ranges = body.ranges();
        body.joint().retract(
            body.configuration(base),
            &phi[ranges.freedoms.clone()],
            &mut moved[ranges.configuration.clone()],
        );
    }
}

/// `out = matrix · x`, the matrix column by column.
pub(super) fn multiply(matrix: &[f64], x: &[f64], out: &mut [f64]) {
    out.fill(0.0);
    for (column, &weight) in matrix.chunks_exact(out.len().max(1)).zip(x) {
        for (sum, &entry) in out.iter_mut().zip(column) {
            *sum += entry * weight;
        }
    }
}
