//! Which kernels of a joint are zero, the identity or constant, known where it is compiled.

/// What is known of a kernel's value at compile time, so that an algorithm can skip what it need not compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// Identically zero.
    Zero,
    /// The identity matrix, or the identity map.
    Identity,
    /// The same at every configuration.
    Constant,
    /// Depends on the configuration.
    General,
}

impl Structure {
    /// Whether the kernel vanishes identically.
    pub const fn is_zero(self) -> bool {
        matches!(self, Self::Zero)
    }

    /// Whether the kernel is the identity.
    pub const fn is_identity(self) -> bool {
        matches!(self, Self::Identity)
    }

    /// Whether the kernel is the same at every configuration.
    pub const fn is_constant(self) -> bool {
        !matches!(self, Self::General)
    }
}

/// The [`Structure`] of each kernel that can be trivial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Structures {
    /// X in the parent frame.
    pub twist_map: Structure,
    /// X in the child frame.
    pub twist_map_child: Structure,
    /// ∂X^c/∂ϕ.
    pub twist_map_child_gradient: Structure,
    /// S₀.
    pub velocity_map: Structure,
    /// ∂S/∂ϕ.
    pub velocity_map_gradient: Structure,
    /// Σ γ_k v_k, and with it J22.
    pub gamma: Structure,
    /// S̄: identity for a holonomic joint.
    pub speed_basis: Structure,
    /// ∂S̄/∂ϕ.
    pub speed_basis_gradient: Structure,
    /// Differential of Φ at finite ϕ.
    pub retract_differential: Structure,
    /// The nearest configuration on the manifold: the identity where the manifold has no relations.
    pub project: Structure,
    /// Residual of the manifold's relations: zero where it has none.
    pub residual: Structure,
    /// c = Ẋ̄^c v̄.
    pub bias_acceleration: Structure,
    /// Ẋ̄^cᵀ h.
    pub bias_momentum: Structure,
    /// X̄^c = X^c S̄.
    pub speed_map: Structure,
}

impl Structures {
    /// Of a joint all of whose kernels are trivial: X is constant, v = ϕ̇, Φ(Q, ϕ) = Q + ϕ, no constraint and no relation. What a
    /// joint has beyond that is listed before `..Structures::TRIVIAL`.
    pub const TRIVIAL: Self = Self {
        twist_map: Structure::Constant,
        twist_map_child: Structure::Constant,
        twist_map_child_gradient: Structure::Zero,
        velocity_map: Structure::Identity,
        velocity_map_gradient: Structure::Zero,
        gamma: Structure::Zero,
        speed_basis: Structure::Identity,
        speed_basis_gradient: Structure::Zero,
        retract_differential: Structure::Identity,
        project: Structure::Identity,
        residual: Structure::Zero,
        bias_acceleration: Structure::Zero,
        bias_momentum: Structure::Zero,
        speed_map: Structure::Constant,
    };

    /// Of a joint all of whose kernels depend on the configuration. What a joint has less than that is listed before `..Structures::GENERAL`.
    pub const GENERAL: Self = Self {
        twist_map: Structure::General,
        twist_map_child: Structure::General,
        twist_map_child_gradient: Structure::General,
        velocity_map: Structure::General,
        velocity_map_gradient: Structure::General,
        gamma: Structure::General,
        speed_basis: Structure::General,
        speed_basis_gradient: Structure::General,
        retract_differential: Structure::General,
        project: Structure::General,
        residual: Structure::General,
        bias_acceleration: Structure::General,
        bias_momentum: Structure::General,
        speed_map: Structure::General,
    };
}
