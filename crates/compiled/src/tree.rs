//! Compiled equations of a mechanism, with the tree for what they do not hold.

use super::functions::Functions;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, HamiltonianDerivatives, Recursive,
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
    /// Other numbers differ.
    #[error(
        "the equations compiled for `{scene}` are those of another mechanism: {place}, {quantity} has an entry {found:e}, not {expected:e}; \
         compile its scene again"
    )]
    Value {
        /// The scene that was compiled.
        scene: &'static str,
        /// Where they were compared.
        place: &'static str,
        /// Of what they are.
        quantity: &'static str,
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
    pub(super) functions: Arc<Functions>,
    pub(super) tree: Recursive,
    /// τ of the inputs, and none.
    inputs: [Vec<f64>; 2],
    pub(super) timed: Timed,
    /// Rows of derivatives.
    pub(super) rows: Vec<f64>,
    /// v̄ and p̄̇ one after the other.
    both: Vec<f64>,
}

/// Efforts at ports that change with time, which the functions are not given.
#[derive(Clone, Debug)]
pub(super) struct Timed {
    pub are_there: bool,
    /// When they act.
    moment: Moment,
    /// τ with them.
    efforts: Vec<f64>,
}

impl Timed {
    fn new(mechanism: &Mechanism) -> Self {
        Self {
            are_there: mechanism.has_timed_port_efforts(),
            moment: Moment::default(),
            efforts: vec![0.0; mechanism.layout().freedoms],
        }
    }

    /// τ with them.
    pub(super) fn added<'t>(
        &'t mut self,
        mechanism: &Mechanism,
        q: &[f64],
        efforts: &'t [f64],
    ) -> &'t [f64] {
        if !self.are_there {
            return efforts;
        }
        self.efforts.copy_from_slice(efforts);
        mechanism.add_timed_port_efforts(self.moment, q, &mut self.efforts);
        &self.efforts
    }
}

impl Compiled {
    /// The equations for `mechanism`, of an emitted module or a library, compared with its own at home; where home has no value, near it.
    ///
    /// # Errors
    /// Equations of another mechanism; a mechanism without a value there.
    pub fn new(
        mechanism: Arc<Mechanism>,
        functions: impl Into<Functions>,
    ) -> Result<Self, CompiledError> {
        Self::sized(mechanism, functions.into())?.compared(None)
    }

    /// The same, compared at the configuration `q` first, where a motion begins: home may be a place where the mechanism has no value.
    ///
    /// # Errors
    /// Those of [`Compiled::new`].
    pub fn starting_at(
        mechanism: Arc<Mechanism>,
        functions: impl Into<Functions>,
        q: &[f64],
    ) -> Result<Self, CompiledError> {
        Self::sized(mechanism, functions.into())?.compared(Some(q))
    }

    /// The general algorithms over the mechanism, for what the functions do not tell.
    pub const fn tree(&mut self) -> &mut Recursive {
        &mut self.tree
    }

    /// Equations that have the sizes of `mechanism`.
    fn sized(mechanism: Arc<Mechanism>, functions: Functions) -> Result<Self, CompiledError> {
        let layout = mechanism.layout();
        let sizes = [
            (
                "stored scalars",
                layout.configuration,
                functions.configuration,
            ),
            ("freedoms", layout.freedoms, functions.freedoms),
            ("speeds", layout.speeds, functions.speeds),
        ];
        for (quantity, expected, found) in sizes {
            if expected != found {
                return Err(CompiledError::Size {
                    scene: functions.scene,
                    quantity,
                    expected,
                    found,
                });
            }
        }
        Ok(Self {
            rows: vec![0.0; ForwardDerivatives::entries(&mechanism)],
            both: vec![0.0; 2 * layout.speeds],
            timed: Timed::new(&mechanism),
            inputs: [(); 2].map(|()| vec![0.0; layout.freedoms]),
            tree: Recursive::new(mechanism),
            functions: Arc::new(functions),
        })
    }

    /// Whether `q` and vectors with one entry per speed have their sizes, and are finite.
    pub(super) fn check<const N: usize>(
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
    pub(super) fn check_room(
        &self,
        quantity: &'static str,
        room: &[f64],
    ) -> Result<(), StateError> {
        let mechanism = self.tree.mechanism();
        mechanism.check_room(quantity, Space::Speeds, room)
    }

    /// Whether τ has one entry per degree of freedom, and is finite.
    fn check_efforts(&self, efforts: &[f64]) -> Result<(), StateError> {
        let mechanism = self.tree.mechanism();
        mechanism.check_vector("efforts", Space::Freedoms, efforts)
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
        self.timed.moment = moment;
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
        let Some(forward) = &self.functions.forward_dynamics else {
            return self.tree.forward_dynamics(q, speeds, efforts, rates);
        };
        self.check(q, [("speeds", speeds)])?;
        self.check_efforts(efforts)?;
        self.check_room("rates", rates)?;
        let efforts_now = self.timed.added(self.tree.mechanism(), q, efforts);
        forward(q, speeds, efforts_now, rates);
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
        let Some(map) = &self.functions.momenta else {
            return self.tree.momenta(q, speeds, momenta);
        };
        self.check(q, [("speeds", speeds)])?;
        self.check_room("momenta", momenta)?;
        map(q, speeds, &[], momenta);
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
        let Some(map) = &self.functions.speeds_from_momenta else {
            return self.tree.speeds(q, momenta, speeds);
        };
        self.check(q, [("momenta", momenta)])?;
        self.check_room("speeds", speeds)?;
        map(q, momenta, &[], speeds);
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
        let Some(momentum_rates) = &self.functions.momentum_rates else {
            return self.tree.momentum_rates(q, momenta, efforts, speeds, rates);
        };
        self.check(q, [("momenta", momenta)])?;
        self.check_room("speeds", speeds)?;
        self.check_room("rates", rates)?;
        let size = speeds.len();
        let [inputs, none] = &mut self.inputs;
        momentum_rates(q, momenta, none, &mut self.both);
        if !all_finite(&self.both) {
            return self.tree.momentum_rates(q, momenta, efforts, speeds, rates);
        }
        speeds.copy_from_slice(&self.both[..size]);
        rates.copy_from_slice(&self.both[size..]);
        inputs.fill(0.0);
        efforts(speeds, inputs);
        let mechanism = self.tree.mechanism();
        mechanism.check_vector("efforts", Space::Freedoms, inputs)?;
        if self.timed.are_there {
            mechanism.add_timed_port_efforts(self.timed.moment, q, inputs);
        }
        match mechanism.constraints() {
            [] => self.add_inputs(q, rates),
            // What inputs make of dependent speeds falls to others: the functions know how.
            _ => {
                momentum_rates(q, momenta, inputs, &mut self.both);
                speeds.copy_from_slice(&self.both[..size]);
                rates.copy_from_slice(&self.both[size..]);
            }
        }
        Ok(())
    }

    fn hamiltonian(&mut self, q: &[f64], momenta: &[f64]) -> Result<f64, DynamicsError> {
        let Some(hamiltonian) = &self.functions.hamiltonian else {
            return self.tree.hamiltonian(q, momenta);
        };
        self.check(q, [("momenta", momenta)])?;
        let mut energy = [0.0];
        hamiltonian(q, momenta, &[], &mut energy);
        match energy[0].is_finite() {
            true => Ok(energy[0]),
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
        let forward = self.functions.forward_dynamics_derivatives.as_ref();
        if let Some(forward) = forward.filter(|_| !self.timed.are_there) {
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
