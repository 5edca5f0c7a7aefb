//! The functions that can be asked for: their names, what they read, and what they leave.

use crate::graph::Argument;
use crate::model::Model;

/// A function of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// v̄̇ from Q, v̄ and τ: (24), (34).
    ForwardDynamics,
    /// The efforts τ̄ that v̄̇ takes at Q and v̄.
    InverseDynamics,
    /// M̄(Q).
    MassMatrix,
    /// The efforts τ̄ at which v̄̇ = 0 at Q and v̄: velocity and gravity terms.
    BiasForces,
    /// v̄ and p̄̇ from Q, p̄ and τ: (27), (35).
    MomentumRates,
    /// p̄ from Q and v̄.
    Momenta,
    /// v̄ from Q and p̄.
    Speeds,
    /// H from Q and p̄.
    Hamiltonian,
    /// Kinetic and potential energy from Q and v̄.
    Energies,
    /// Poses of all bodies from Q.
    Poses,
    /// How v̄̇ changes with ϕ, v̄ and τ, from Q, v̄ and τ.
    ForwardDerivatives,
    /// How the efforts τ̄ change with ϕ and v̄, from Q, v̄ and v̄̇.
    InverseDerivatives,
    /// M̄⁻¹ from Q.
    InverseMassMatrix,
    /// How λᵀv̄̇ bends with ϕ, v̄ and τ, from Q, v̄, τ and λ.
    ForwardSecondDerivatives,
    /// How λᵀτ̄ bends with ϕ, v̄ and v̄̇, from Q, v̄, v̄̇ and λ.
    InverseSecondDerivatives,
}

impl Kind {
    /// All of them.
    pub const ALL: [Self; 15] = [
        Self::ForwardDynamics,
        Self::InverseDynamics,
        Self::MassMatrix,
        Self::BiasForces,
        Self::MomentumRates,
        Self::Momenta,
        Self::Speeds,
        Self::Hamiltonian,
        Self::Energies,
        Self::Poses,
        Self::ForwardDerivatives,
        Self::InverseDerivatives,
        Self::InverseMassMatrix,
        Self::ForwardSecondDerivatives,
        Self::InverseSecondDerivatives,
    ];

    /// Those of a module for which none are named: all but the derivatives, which are longer than all others together, and M̄⁻¹, which
    /// few ask for.
    pub const BY_DEFAULT: [Self; 10] = [
        Self::ForwardDynamics,
        Self::InverseDynamics,
        Self::MassMatrix,
        Self::BiasForces,
        Self::MomentumRates,
        Self::Momenta,
        Self::Speeds,
        Self::Hamiltonian,
        Self::Energies,
        Self::Poses,
    ];

    /// Its name, in emitted code as well.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ForwardDynamics => "forward_dynamics",
            Self::InverseDynamics => "inverse_dynamics",
            Self::MassMatrix => "mass_matrix",
            Self::BiasForces => "bias_forces",
            Self::MomentumRates => "momentum_rates",
            Self::Momenta => "momenta",
            Self::Speeds => "speeds_from_momenta",
            Self::Hamiltonian => "hamiltonian",
            Self::Energies => "energies",
            Self::Poses => "poses",
            Self::ForwardDerivatives => "forward_dynamics_derivatives",
            Self::InverseDerivatives => "inverse_dynamics_derivatives",
            Self::InverseMassMatrix => "inverse_mass_matrix",
            Self::ForwardSecondDerivatives => "forward_dynamics_second_derivatives",
            Self::InverseSecondDerivatives => "inverse_dynamics_second_derivatives",
        }
    }

    /// What it computes, in a sentence.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::ForwardDynamics => "Accelerations v̄̇ from Q, v̄ and τ, (24), (34).",
            Self::InverseDynamics => {
                "Efforts τ̄ = S̄ᵀτ that the accelerations take at Q and v̄, (24), (34)."
            }
            Self::MassMatrix => "Mass matrix M̄ by rows.",
            Self::BiasForces => {
                "Bias forces: efforts τ̄ = S̄ᵀτ at which v̄̇ = 0 at Q and v̄ (velocity and gravity terms)."
            }
            Self::MomentumRates => "v̄ and p̄̇ from Q, p̄ and τ, (27), (35).",
            Self::Momenta => "Momenta p̄ = M̄ v̄.",
            Self::Speeds => "v̄ = M̄⁻¹ p̄.",
            Self::Hamiltonian => "H = ½ p̄ᵀ M̄⁻¹ p̄ + V, J.",
            Self::Energies => "Kinetic and potential energy, J.",
            Self::Poses => {
                "For each body its rotation to world axes by rows, and its origin in the world, m."
            }
            Self::ForwardDerivatives => {
                "For each speed ∂v̄̇/∂ϕ, ∂v̄̇/∂v̄ and ∂v̄̇/∂τ in local coordinates ϕ about Q, then v̄̇; where constraints couple joints ∂v̄/∂ϕ and ∂v̄/∂v̄ \
                 of the speeds that they complete after these."
            }
            Self::InverseDerivatives => {
                "For each speed ∂τ̄/∂ϕ and ∂τ̄/∂v̄ of inverse dynamics in local coordinates ϕ about Q; ∂τ̄/∂v̄̇ is M̄."
            }
            Self::InverseMassMatrix => {
                "Inverse mass matrix M̄⁻¹ by rows; joints whose motion is prescribed do not give way: their rows are 0."
            }
            Self::ForwardSecondDerivatives => {
                "λᵀ∂²v̄̇ by rows: the Hessian of λᵀv̄̇ over local coordinates ϕ about Q, v̄ and τ."
            }
            Self::InverseSecondDerivatives => {
                "λᵀ∂²τ̄ by rows: the Hessian of λᵀτ̄ of inverse dynamics over local coordinates ϕ about Q, v̄ and v̄̇."
            }
        }
    }

    /// What it reads.
    pub(super) fn arguments(self) -> &'static [Argument] {
        match self {
            Self::ForwardDynamics | Self::ForwardDerivatives => {
                &[Argument::Configuration, Argument::Speeds, Argument::Efforts]
            }
            Self::InverseDynamics | Self::InverseDerivatives => &[
                Argument::Configuration,
                Argument::Speeds,
                Argument::Accelerations,
            ],
            Self::MassMatrix | Self::InverseMassMatrix | Self::Poses => &[Argument::Configuration],
            Self::BiasForces | Self::Momenta | Self::Energies => {
                &[Argument::Configuration, Argument::Speeds]
            }
            Self::MomentumRates => &[
                Argument::Configuration,
                Argument::Momenta,
                Argument::Efforts,
            ],
            Self::Speeds | Self::Hamiltonian => &[Argument::Configuration, Argument::Momenta],
            Self::ForwardSecondDerivatives => &[
                Argument::Configuration,
                Argument::Speeds,
                Argument::Efforts,
                Argument::Weights,
            ],
            Self::InverseSecondDerivatives => &[
                Argument::Configuration,
                Argument::Speeds,
                Argument::Accelerations,
                Argument::Weights,
            ],
        }
    }

    /// Whether the runtime takes it for many states.
    pub const fn is_batched(self) -> bool {
        matches!(
            self,
            Self::ForwardDynamics
                | Self::InverseDynamics
                | Self::ForwardDerivatives
                | Self::InverseDerivatives
                | Self::MassMatrix
                | Self::InverseMassMatrix
        )
    }

    /// The columns of its result; none for a vector.
    pub(super) fn columns(self, model: &Model) -> Option<usize> {
        let [_, freedoms, speeds] = model.sizes();
        match self {
            Self::MassMatrix | Self::InverseMassMatrix | Self::MomentumRates => Some(speeds.max(1)),
            Self::Poses => Some(12),
            Self::ForwardDerivatives => {
                let coupled = !model.coupling.constraints.is_empty();
                let own = 2 * freedoms + speeds + 1;
                Some(own + if coupled { freedoms + speeds } else { 0 })
            }
            Self::InverseDerivatives => Some((freedoms + speeds).max(1)),
            Self::ForwardSecondDerivatives => Some((2 * freedoms + speeds).max(1)),
            Self::InverseSecondDerivatives => Some((freedoms + 2 * speeds).max(1)),
            _ => None,
        }
    }
}
