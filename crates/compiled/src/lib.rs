//! Equations of one mechanism that the scene compiler wrote, behind the trait [`Dynamics`](hamel_runtime::dynamics::Dynamics).
//!
//! [`Equations`] is all that an emitted module needs, without allocator; [`Compiled`] is what integrators take, [`Batch`] computes many states
//! at once.
#![forbid(unsafe_code)]
#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "alloc")]
extern crate alloc;

#[cfg(feature = "alloc")]
mod agreement;
#[cfg(feature = "alloc")]
mod batch;
#[cfg(feature = "alloc")]
mod entry;
#[cfg(feature = "alloc")]
mod functions;
mod instructions;
mod lanes;
mod layout;
mod pairs;
#[cfg(feature = "alloc")]
mod second;
#[cfg(feature = "alloc")]
mod states;
mod transpose;
#[cfg(feature = "alloc")]
mod tree;

#[cfg(feature = "alloc")]
pub use batch::{Batch, BatchError};
#[cfg(feature = "alloc")]
pub use entry::Entry;
#[cfg(feature = "alloc")]
pub use functions::{Function, Functions, WeightedFunction};
pub use instructions::{Plain, Registers};
pub use lanes::{LANES, LaneScalar, Level, ManyStates, OfEight, many_states};
pub use layout::{Lanes, Quantities, States};
pub use pairs::{
    Aligned, BEHIND, Carrying, Meeting, Pairing, Pairs, Places, STRIP, Strip, room_in_lanes,
    room_to_solve,
};
#[cfg(feature = "alloc")]
pub use tree::{Compiled, CompiledError};

/// A function of one state: Q, v̄ and inputs in, results into the last argument; sizes are those of [`Equations`].
pub type OneState = fn(&[f64], &[f64], &[f64], &mut [f64]);

/// The same contracted with weights λ: Q, v̄, inputs and λ in, results into the last argument.
pub type Weighted = fn(&[f64], &[f64], &[f64], &[f64], &mut [f64]);

/// p̄ from Q and v̄, or v̄ from Q and p̄, into the last argument.
pub type MomentumMap = fn(&[f64], &[f64], &mut [f64]);

/// v̄ and p̄̇ from Q, p̄ and τ, into the last two arguments.
pub type MomentumRates = fn(&[f64], &[f64], &[f64], &mut [f64], &mut [f64]);

/// H from Q and p̄.
pub type Hamiltonian = fn(&[f64], &[f64]) -> f64;

/// What an emitted module holds: functions of one scene. The constant `EQUATIONS` of that module.
#[derive(Clone, Copy, Debug)]
pub struct Equations {
    /// Name of the scene.
    pub scene: &'static str,
    /// Stored scalars of Q.
    pub configuration: usize,
    /// Entries of τ.
    pub freedoms: usize,
    /// Entries of v̄.
    pub speeds: usize,
    /// v̄̇ from Q, v̄ and τ, (24), (34), where the module has it.
    pub forward_dynamics: Option<OneState>,
    /// Efforts τ̄ from Q, v̄ and v̄̇, (24), (34), where the module has it.
    pub inverse_dynamics: Option<OneState>,
    /// p̄ = M̄ v̄, where the module has it.
    pub momenta: Option<MomentumMap>,
    /// v̄ = M̄⁻¹ p̄, where the module has it.
    pub speeds_from_momenta: Option<MomentumMap>,
    /// (27), (35), where the module has it.
    pub momentum_rates: Option<MomentumRates>,
    /// H, where the module has it.
    pub hamiltonian: Option<Hamiltonian>,
    /// Derivatives of forward dynamics from Q, v̄ and τ, where the module has them: for each speed a row of `∂v̄̇/∂ϕ`, `∂v̄̇/∂v̄`, `∂v̄̇/∂τ` and v̄̇, and
    /// where constraints couple joints of `∂v̄/∂ϕ` and `∂v̄/∂v̄` of the speeds that they complete.
    pub forward_dynamics_derivatives: Option<OneState>,
    /// Derivatives of inverse dynamics from Q, v̄ and v̄̇, where the module has them: for each speed a row of `∂τ̄/∂ϕ` and `∂τ̄/∂v̄`.
    pub inverse_dynamics_derivatives: Option<OneState>,
    /// λᵀ∂²v̄̇ by rows over (ϕ, v̄, τ) from Q, v̄, τ and λ, where the module has it.
    pub forward_dynamics_second_derivatives: Option<Weighted>,
    /// λᵀ∂²τ̄ of inverse dynamics by rows over (ϕ, v̄, v̄̇) from Q, v̄, v̄̇ and λ, where the module has it.
    pub inverse_dynamics_second_derivatives: Option<Weighted>,
    /// Numbers that derivatives of forward dynamics have: all rows together, 0 without them.
    pub forward_slopes: usize,
    /// M̄ by rows from Q, where the module has it: v̄ and inputs are not read.
    pub mass_matrix: Option<OneState>,
    /// M̄⁻¹ by rows from Q, where the module has it: v̄ and inputs are not read, and rows of joints whose motion is prescribed are 0.
    pub inverse_mass_matrix: Option<OneState>,
    /// Functions of many states, eight at a time.
    pub in_lanes: InLanes,
}

impl Equations {
    /// Numbers that derivatives of inverse dynamics have: all rows together.
    #[cfg(feature = "alloc")]
    const fn inverse_slopes(&self) -> usize {
        let row = self.freedoms.saturating_add(self.speeds);
        self.speeds.saturating_mul(row)
    }
}

/// Functions of many states, where the module was compiled with lanes.
#[derive(Clone, Copy, Debug)]
pub struct InLanes {
    /// v̄̇ from Q, v̄ and τ.
    pub forward_dynamics: Option<ManyStates>,
    /// τ̄ from Q, v̄ and v̄̇.
    pub inverse_dynamics: Option<ManyStates>,
    /// Derivatives of forward dynamics from Q, v̄ and τ.
    pub forward_dynamics_derivatives: Option<ManyStates>,
    /// Derivatives of inverse dynamics from Q, v̄ and v̄̇.
    pub inverse_dynamics_derivatives: Option<ManyStates>,
    /// M̄ from Q, which stands in the places of v̄ and of inputs as well.
    pub mass_matrix: Option<ManyStates>,
    /// M̄⁻¹ from Q, which stands in the places of v̄ and of inputs as well.
    pub inverse_mass_matrix: Option<ManyStates>,
}

impl InLanes {
    /// No function.
    pub const NONE: Self = Self {
        forward_dynamics: None,
        inverse_dynamics: None,
        forward_dynamics_derivatives: None,
        inverse_dynamics_derivatives: None,
        mass_matrix: None,
        inverse_mass_matrix: None,
    };
}
