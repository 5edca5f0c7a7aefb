//! Compiled equations of a mechanism, with the tree for what they do not hold.

use super::Equations;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use hamel_runtime::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, HamiltonianDerivatives, InverseDerivatives,
    Recursive,
};
use hamel_runtime::joint::MOST_FREEDOMS;
use hamel_runtime::mechanism::{Mechanism, Space, StateError};
use hamel_runtime::scalar::all_finite;
use hamel_runtime::time_function::Moment;

/// A module that does not belong to a mechanism.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompiledError {
    /// Sizes differ.
    #[error(
        "the equations compiled for `{scene}` have {found} {quantity}, the mechanism has {expected}: compile its scene again"
    )]
    Size {
        /// The scene that was compiled.
        scene: &'static str,
        /// What differs.
        quantity: &'static str,
        /// Of the mechanism.
        expected: usize,
        /// Of the module.
        found: usize,
    },
    /// Rates differ.
    #[error(
        "the equations compiled for `{scene}` are those of another mechanism: {place}, `{speed}` of joint `{joint}` has the rate \
         {found:e}, not {expected:e}; compile its scene again"
    )]
    Other {
        /// The scene that was compiled.
        scene: &'static str,
        /// Where they were compared.
        place: &'static str,
        /// The joint.
        joint: String,
        /// The speed.
        speed: &'static str,
        /// By the mechanism.
        expected: f64,
        /// By the module.
        found: f64,
    },
    /// The mechanism itself has no rates wherever they were to be compared.
    #[error(
        "the equations compiled for `{scene}` cannot be compared with those of the mechanism, which have no value {place}, nor near home: {cause}"
    )]
    NoValue {
        /// The scene that was compiled.
        scene: &'static str,
        /// Where they were to be compared first.
        place: &'static str,
        /// Why they have none there.
        cause: DynamicsError,
    },
}

/// Compiled equations of a mechanism: what the module does not have, the tree computes.
#[derive(Clone, Debug)]
pub struct Compiled {
    pub(super) equations: &'static Equations,
    pub(super) tree: Recursive,
    /// τ of the inputs, none, and τ with the efforts at ports that change with time.
    inputs: [vec::Vec<f64>; 3],
    /// When these act.
    moment: Moment,
    /// Whether there are any.
    is_timed: bool,
    /// Rows of derivatives of forward dynamics.
    rows: vec::Vec<f64>,
}

impl Compiled {
    /// The equations for `mechanism`, compared with its own at home; where home has no value, near it.
    ///
    /// # Errors
    /// A module of another mechanism; a mechanism without a value there.
    pub fn new(
        mechanism: Arc<Mechanism>,
        equations: &'static Equations,
    ) -> Result<Self, CompiledError> {
        Self::sized(mechanism, equations)?.compared(None)
    }

    /// The same, compared at the configuration `q` first, where a motion begins: home may be a place where the mechanism has no value.
    ///
    /// # Errors
    /// Those of [`Compiled::new`].
    pub fn starting_at(
        mechanism: Arc<Mechanism>,
        equations: &'static Equations,
        q: &[f64],
    ) -> Result<Self, CompiledError> {
        Self::sized(mechanism, equations)?.compared(Some(q))
    }

    /// Equations that have the sizes of `mechanism`.
    fn sized(
        mechanism: Arc<Mechanism>,
        equations: &'static Equations,
    ) -> Result<Self, CompiledError> {
        let layout = mechanism.layout();
        let sizes = [
            (
                "stored scalars",
                layout.configuration,
                equations.configuration,
            ),
            ("freedoms", layout.freedoms, equations.freedoms),
            ("speeds", layout.speeds, equations.speeds),
        ];
        for (quantity, expected, found) in sizes {
            if expected != found {
                return Err(CompiledError::Size {
                    scene: equations.scene,
                    quantity,
                    expected,
                    found,
                });
            }
        }
        Ok(Self {
            equations,
            rows: vec![0.0; ForwardDerivatives::entries(&mechanism)],
            moment: Moment::default(),
            is_timed: mechanism.has_timed_port_efforts(),
            tree: Recursive::new(mechanism),
            inputs: core::array::from_fn(|_| vec![0.0; equations.freedoms]),
        })
    }

    /// The derivatives of inverse dynamics in ϕ and v̄ at (q, v̄, v̄̇) into `out`, as [`Recursive::inverse_dynamics_derivatives`] has them.
    ///
    /// # Errors
    /// A wrong size; results that were made for another mechanism; something that acts on the mechanism whose derivatives are not known.
    pub fn inverse_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        accelerations: &[f64],
        out: &mut InverseDerivatives,
    ) -> Result<(), DynamicsError> {
        let inverse = self.equations.inverse_dynamics_derivatives;
        if let Some(inverse) = inverse.filter(|_| !self.is_timed) {
            self.check(q, [("speeds", speeds), ("accelerations", accelerations)])?;
            let count = speeds.len() * (self.equations.freedoms + speeds.len());
            let rows = &mut self.rows[..count];
            inverse(q, speeds, accelerations, rows);
            if all_finite(rows) {
                return out.read(rows);
            }
        }
        self.tree
            .inverse_dynamics_derivatives(q, speeds, accelerations, out)
    }

    /// Whether `q` and vectors with one entry per speed have their sizes, and are finite.
    fn check<const N: usize>(
        &self,
        q: &[f64],
        vectors: [(&'static str, &[f64]); N],
    ) -> Result<(), StateError> {
        let mechanism = self.tree.mechanism();
        mechanism.check_vector("configuration", Space::Configuration, q)?;
        let mut vectors = vectors.into_iter();
        vectors.try_for_each(|(quantity, own)| mechanism.check_vector(quantity, Space::Speeds, own))
    }

    /// Whether `room` for results has one entry per speed.
    fn check_room(&self, quantity: &'static str, room: &[f64]) -> Result<(), StateError> {
        let mechanism = self.tree.mechanism();
        mechanism.check_room(quantity, Space::Speeds, room)
    }

    /// Whether τ has one entry per degree of freedom, and is finite.
    fn check_efforts(&self, efforts: &[f64]) -> Result<(), StateError> {
        let mechanism = self.tree.mechanism();
        mechanism.check_vector("efforts", Space::Freedoms, efforts)
    }

    /// τ with the efforts at ports that change with time, of which the module is not told.
    pub(super) fn with_timed<'t>(&'t mut self, q: &[f64], efforts: &'t [f64]) -> &'t [f64] {
        if !self.is_timed {
            return efforts;
        }
        let [.., all] = &mut self.inputs;
        all.copy_from_slice(efforts);
        let mechanism = self.tree.mechanism();
        mechanism.add_timed_port_efforts(self.moment, q, all);
        all
    }

    /// `p̄̇ += S̄ᵀτ`: they are affine in τ, which depends on the v̄ that come with them.
    fn add_inputs(&self, q: &[f64], rates: &mut [f64]) {
        for (index, body) in self.tree.mechanism().joints() {
            let ranges = body.ranges();
            let mut reduced = [0.0; MOST_FREEDOMS];
            let reduced = &mut reduced[..ranges.speeds.len()];
            let tau = &self.inputs[0][ranges.freedoms.clone()];
            if self.tree.mechanism().is_driven(index) {
                rates[ranges.speeds.clone()].copy_from_slice(&tau[..ranges.speeds.len()]);
                continue;
            }
            body.joint()
                .reduce_efforts(body.configuration(q), tau, reduced);
            for (rate, effort) in rates[ranges.speeds.clone()].iter_mut().zip(&*reduced) {
                *rate += effort;
            }
        }
    }
}

impl Dynamics for Compiled {
    fn mechanism(&self) -> &Arc<Mechanism> {
        self.tree.mechanism()
    }

    fn set_moment(&mut self, moment: Moment) {
        self.moment = moment;
        self.tree.set_moment(moment);
    }

    fn complete_speeds(&mut self, q: &[f64], speeds: &mut [f64]) -> Result<(), DynamicsError> {
        self.tree.complete_speeds(q, speeds)
    }

    fn forward_dynamics(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let Some(forward) = self.equations.forward_dynamics else {
            return self.tree.forward_dynamics(q, speeds, efforts, rates);
        };
        self.check(q, [("speeds", speeds)])?;
        self.check_efforts(efforts)?;
        self.check_room("rates", rates)?;
        forward(q, speeds, self.with_timed(q, efforts), rates);
        if all_finite(rates) {
            return Ok(());
        }
        // The tree says which joint it is, and why.
        self.tree.forward_dynamics(q, speeds, efforts, rates)
    }

    fn momenta(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        momenta: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let Some(map) = self.equations.momenta else {
            return self.tree.momenta(q, speeds, momenta);
        };
        self.check(q, [("speeds", speeds)])?;
        self.check_room("momenta", momenta)?;
        map(q, speeds, momenta);
        if all_finite(momenta) {
            return Ok(());
        }
        self.tree.momenta(q, speeds, momenta)
    }

    fn speeds(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        speeds: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let Some(map) = self.equations.speeds_from_momenta else {
            return self.tree.speeds(q, momenta, speeds);
        };
        self.check(q, [("momenta", momenta)])?;
        self.check_room("speeds", speeds)?;
        map(q, momenta, speeds);
        if all_finite(speeds) {
            return Ok(());
        }
        self.tree.speeds(q, momenta, speeds)
    }

    fn momentum_rates(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &mut dyn FnMut(&[f64], &mut [f64]),
        speeds: &mut [f64],
        rates: &mut [f64],
    ) -> Result<(), DynamicsError> {
        let Some(momentum_rates) = self.equations.momentum_rates else {
            return self.tree.momentum_rates(q, momenta, efforts, speeds, rates);
        };
        self.check(q, [("momenta", momenta)])?;
        self.check_room("speeds", speeds)?;
        self.check_room("rates", rates)?;
        let [inputs, none, _] = &mut self.inputs;
        momentum_rates(q, momenta, none, speeds, rates);
        if !(all_finite(speeds) && all_finite(rates)) {
            return self.tree.momentum_rates(q, momenta, efforts, speeds, rates);
        }
        inputs.fill(0.0);
        efforts(speeds, inputs);
        self.check_efforts(&self.inputs[0])?;
        if self.is_timed {
            let mechanism = self.tree.mechanism();
            mechanism.add_timed_port_efforts(self.moment, q, &mut self.inputs[0]);
        }
        let [inputs, ..] = &self.inputs;
        match self.tree.mechanism().constraints() {
            [] => self.add_inputs(q, rates),
            // What inputs make of dependent speeds falls to others: the module knows how.
            _ => momentum_rates(q, momenta, inputs, speeds, rates),
        }
        Ok(())
    }

    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError> {
        let Some(hamiltonian) = self.equations.hamiltonian else {
            return self.tree.hamiltonian(q, momenta);
        };
        self.check(q, [("momenta", momenta)])?;
        let energy = hamiltonian(q, momenta);
        match energy.is_finite() {
            true => Ok(energy),
            false => self.tree.hamiltonian(q, momenta),
        }
    }

    fn forward_dynamics_derivatives(
        &mut self,
        q: &[f64],
        speeds: &[f64],
        efforts: &[f64],
        out: &mut ForwardDerivatives,
    ) -> Result<(), DynamicsError> {
        let forward = self.equations.forward_dynamics_derivatives;
        if let Some(forward) = forward.filter(|_| !self.is_timed) {
            self.check(q, [("speeds", speeds)])?;
            self.check_efforts(efforts)?;
            forward(q, speeds, efforts, &mut self.rows);
            if all_finite(&self.rows) {
                return out.read(&self.rows);
            }
        }
        // The tree says which joint it is, and why.
        self.tree
            .forward_dynamics_derivatives(q, speeds, efforts, out)
    }

    fn hamiltonian_derivatives(
        &mut self,
        q: &[f64],
        momenta: &[f64],
        efforts: &[f64],
        out: &mut HamiltonianDerivatives,
    ) -> Result<(), DynamicsError> {
        self.tree.hamiltonian_derivatives(q, momenta, efforts, out)
    }
}
