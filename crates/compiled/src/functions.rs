//! The functions of one scene as [`Compiled`](super::Compiled) calls them: those of an emitted module, or of a library that a program has loaded.

use super::Equations;
use alloc::boxed::Box;
use core::fmt;

/// A function of one state, which may carry data: what it reads, then where its results go. Arguments that it does not have are not read.
pub type Function = Box<dyn Fn(&[f64], &[f64], &[f64], &mut [f64]) + Send + Sync>;

/// The same with weights λ after the inputs.
pub type WeightedFunction = Box<dyn Fn(&[f64], &[f64], &[f64], &[f64], &mut [f64]) + Send + Sync>;

/// Functions of one scene: what [`Equations`] are of an emitted module, for functions that carry data, and a few more.
///
/// All are called with Q, v̄ or p̄, and inputs, in this order; those of second derivatives with λ after these.
#[derive(Default)]
pub struct Functions {
    /// Name of the scene.
    pub scene: &'static str,
    /// Stored scalars of Q.
    pub configuration: usize,
    /// Entries of τ.
    pub freedoms: usize,
    /// Entries of v̄.
    pub speeds: usize,
    /// v̄̇ from Q, v̄ and τ.
    pub forward_dynamics: Option<Function>,
    /// Efforts τ̄ from Q, v̄ and v̄̇.
    pub inverse_dynamics: Option<Function>,
    /// Efforts τ̄ at v̄̇ = 0 from Q and v̄.
    pub bias_forces: Option<Function>,
    /// M̄ by rows from Q.
    pub mass_matrix: Option<Function>,
    /// Kinetic and potential energy from Q and v̄, J.
    pub energies: Option<Function>,
    /// For each body its rotation to world axes by rows, and its origin, m, from Q.
    pub poses: Option<Function>,
    /// p̄ from Q and v̄.
    pub momenta: Option<Function>,
    /// v̄ from Q and p̄.
    pub speeds_from_momenta: Option<Function>,
    /// v̄, then p̄̇, from Q, p̄ and τ.
    pub momentum_rates: Option<Function>,
    /// H from Q and p̄, J.
    pub hamiltonian: Option<Function>,
    /// Derivatives of forward dynamics from Q, v̄ and τ, laid out as in [`Equations::forward_dynamics_derivatives`].
    pub forward_dynamics_derivatives: Option<Function>,
    /// Derivatives of inverse dynamics from Q, v̄ and v̄̇, laid out as in [`Equations::inverse_dynamics_derivatives`].
    pub inverse_dynamics_derivatives: Option<Function>,
    /// λᵀ∂²v̄̇ from Q, v̄, τ and λ, laid out as in [`Equations::forward_dynamics_second_derivatives`].
    pub forward_dynamics_second_derivatives: Option<WeightedFunction>,
    /// λᵀ∂²τ̄ from Q, v̄, v̄̇ and λ, laid out as in [`Equations::inverse_dynamics_second_derivatives`].
    pub inverse_dynamics_second_derivatives: Option<WeightedFunction>,
}

impl From<&'static Equations> for Functions {
    fn from(equations: &'static Equations) -> Self {
        let speeds = equations.speeds;
        Self {
            scene: equations.scene,
            configuration: equations.configuration,
            freedoms: equations.freedoms,
            speeds,
            forward_dynamics: equations.forward_dynamics.map(|own| Box::new(own) as _),
            inverse_dynamics: equations.inverse_dynamics.map(|own| Box::new(own) as _),
            bias_forces: None,
            mass_matrix: equations.mass_matrix.map(|own| Box::new(own) as _),
            energies: None,
            poses: None,
            momenta: equations.momenta.map(of_two),
            speeds_from_momenta: equations.speeds_from_momenta.map(of_two),
            momentum_rates: equations.momentum_rates.map(|own| {
                Box::new(move |q: &[f64], p: &[f64], u: &[f64], out: &mut [f64]| {
                    let (v, rates) = out.split_at_mut(speeds);
                    own(q, p, u, v, rates);
                }) as _
            }),
            hamiltonian: equations.hamiltonian.map(|own| {
                Box::new(move |q: &[f64], p: &[f64], _: &[f64], out: &mut [f64]| {
                    out.fill(own(q, p));
                }) as _
            }),
            forward_dynamics_derivatives: equations
                .forward_dynamics_derivatives
                .map(|own| Box::new(own) as _),
            inverse_dynamics_derivatives: equations
                .inverse_dynamics_derivatives
                .map(|own| Box::new(own) as _),
            forward_dynamics_second_derivatives: equations
                .forward_dynamics_second_derivatives
                .map(|own| Box::new(own) as _),
            inverse_dynamics_second_derivatives: equations
                .inverse_dynamics_second_derivatives
                .map(|own| Box::new(own) as _),
        }
    }
}

/// A function without inputs.
fn of_two(own: super::MomentumMap) -> Function {
    Box::new(move |q, v, _, out| own(q, v, out))
}

impl fmt::Debug for Functions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Functions")
            .field("scene", &self.scene)
            .field("configuration", &self.configuration)
            .field("freedoms", &self.freedoms)
            .field("speeds", &self.speeds)
            .finish_non_exhaustive()
    }
}
