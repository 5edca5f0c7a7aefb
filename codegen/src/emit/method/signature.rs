//! The signatures of the trait's methods, and what they mean.

use crate::derived::{Arguments, Kernel, KernelKind, Shape};
use crate::expr::Symbol;

/// An argument of a kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Argument {
    /// Q.
    Configuration,
    /// Q′.
    Target,
    /// ϕ.
    Local,
    /// ξ.
    Displacement,
    /// v.
    Velocity,
    /// S₀⁻¹ v at the moved configuration: the symbols of v under another name.
    Rate,
    /// p.
    Momentum,
    /// v̄.
    Speeds,
    /// h.
    Wrench,
}

impl Argument {
    /// Its name in Rust.
    pub fn name(self) -> &'static str {
        match self {
            Self::Configuration => "q",
            Self::Target => "target",
            Self::Local => "phi",
            Self::Displacement => "xi",
            Self::Velocity => "v",
            Self::Rate => "rate",
            Self::Momentum => "p",
            Self::Speeds => "speeds",
            Self::Wrench => "h",
        }
    }

    /// Its number of scalars.
    pub fn size(self, shape: Shape) -> usize {
        match self {
            Self::Configuration | Self::Target => shape.configuration,
            Self::Local | Self::Velocity | Self::Rate | Self::Momentum => shape.freedoms,
            Self::Displacement => shape.displacements,
            Self::Speeds => shape.speeds,
            Self::Wrench => 6,
        }
    }

    /// Its symbols, in order.
    pub fn symbols(self, arguments: &Arguments) -> &[Symbol] {
        match self {
            Self::Configuration => &arguments.configuration,
            Self::Target => &arguments.target,
            Self::Local => &arguments.local,
            Self::Displacement => &arguments.displacement,
            Self::Velocity | Self::Rate => &arguments.velocity,
            Self::Momentum => &arguments.momentum,
            Self::Speeds => &arguments.speeds,
            Self::Wrench => &arguments.wrench,
        }
    }
}

/// What a kernel returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// A pose.
    Pose,
    /// A matrix.
    Matrix(usize, usize),
    /// A vector.
    Vector(usize),
    /// One matrix for each ϕ_k.
    Slices(usize, usize),
    /// A scalar.
    Scalar,
    /// A row for each port or pin.
    Rows(usize, usize),
    /// A scalar for each port.
    List(usize),
}

/// Name, arguments and result of a method.
#[derive(Clone, Debug)]
pub struct Signature {
    /// Its name.
    pub name: &'static str,
    /// Its arguments after `&self`.
    pub arguments: Vec<Argument>,
    /// Its result.
    pub output: Output,
}

impl Signature {
    /// The signature of a kernel.
    pub fn new(kernel: &Kernel, shape: Shape) -> Self {
        use Argument::{
            Configuration, Displacement, Local, Momentum, Rate, Speeds, Target, Velocity, Wrench,
        };
        use Output::{List, Matrix, Pose, Rows, Scalar, Slices, Vector};
        let (n, k, s, c) = (
            shape.configuration,
            shape.freedoms,
            shape.speeds,
            shape.constraints,
        );
        let (g, q) = (shape.displacements, || vec![Configuration]);
        let relations = kernel
            .outputs
            .first()
            .map_or(0, crate::matrix::Matrix::rows);
        let (name, arguments, output) = match kernel.kind {
            KernelKind::Home => ("home", vec![], Vector(n)),
            KernelKind::Pose => ("pose", q(), Pose),
            KernelKind::TwistMap => ("twist_map", q(), Matrix(6, k)),
            KernelKind::TwistMapChild => ("twist_map_child", q(), Matrix(6, k)),
            KernelKind::TwistMapChildGradient => ("twist_map_child_gradient", q(), Slices(6, k)),
            KernelKind::VelocityMap => ("velocity_map", q(), Matrix(k, k)),
            KernelKind::VelocityMapInverse => ("velocity_map_inverse", q(), Matrix(k, k)),
            KernelKind::VelocityMapGradient => ("velocity_map_gradient", q(), Slices(k, k)),
            KernelKind::Gamma => ("gamma", vec![Configuration, Velocity], Matrix(k, k)),
            KernelKind::J22 => ("j22", vec![Configuration, Momentum], Matrix(k, k)),
            KernelKind::Constraint => ("constraint", q(), Matrix(k, c)),
            KernelKind::SpeedBasis => ("speed_basis", q(), Matrix(k, s)),
            KernelKind::SpeedBasisGradient => ("speed_basis_gradient", q(), Slices(k, s)),
            KernelKind::PortMap => ("port_map", q(), Rows(shape.ports, k)),
            KernelKind::PortValues => ("port_values", q(), List(shape.ports)),
            KernelKind::Pins => ("pins", q(), Rows(shape.pins, 9)),
            KernelKind::ConfigurationRate => (
                "configuration_rate",
                vec![Configuration, Velocity],
                Vector(n),
            ),
            KernelKind::Retract => ("retract", vec![Configuration, Local], Vector(n)),
            KernelKind::Local => ("local", vec![Configuration, Target], Vector(k)),
            KernelKind::TangentBasis => ("tangent_basis", q(), Matrix(g, k)),
            KernelKind::NormalBasis => ("normal_basis", q(), Matrix(g, g - k)),
            KernelKind::Displaced => ("displaced", vec![Configuration, Displacement], Vector(n)),
            KernelKind::DisplacedDifferential => {
                ("displaced_differential", vec![Displacement], Matrix(g, g))
            }
            KernelKind::Displacement => ("displacement", vec![Configuration, Target], Vector(g)),
            KernelKind::RetractDifferential => (
                "retract_differential",
                vec![Configuration, Local],
                Matrix(k, k),
            ),
            KernelKind::RetractDifferentialInverse => (
                "retract_differential_inverse",
                vec![Configuration, Local, Rate],
                Vector(k),
            ),
            KernelKind::Project => ("project", q(), Vector(n)),
            KernelKind::Residual => ("residual", q(), Scalar),
            KernelKind::Relations => ("relations", q(), Vector(relations)),
            KernelKind::RelationGradient => ("relation_gradient", q(), Matrix(g - k, g)),
            KernelKind::RelationDisplacements => ("relation_displacements", q(), Matrix(g, g - k)),
            KernelKind::RelationTwists => ("relation_twists", q(), Rows(g - k, 6)),
            KernelKind::RelationPorts => ("relation_ports", q(), List(shape.ports * (g - k))),
            KernelKind::Singularity => ("singularity", q(), Scalar),
            KernelKind::BiasAcceleration => {
                ("bias_acceleration", vec![Configuration, Speeds], Vector(6))
            }
            KernelKind::BiasMomentum => (
                "bias_momentum",
                vec![Configuration, Speeds, Wrench],
                Vector(s),
            ),
        };
        Self {
            name,
            arguments,
            output,
        }
    }
}

/// What a kernel maps to what.
pub fn meaning(kind: KernelKind) -> &'static str {
    match kind {
        KernelKind::Home => "The home configuration.",
        KernelKind::Pose => "H(Q): child coordinates to parent coordinates.",
        KernelKind::TwistMap => {
            "X(Q): v to the twist of the child relative to the parent, in the parent frame (Definition 1)."
        }
        KernelKind::TwistMapChild => "X^c(Q) = Ad_H⁻¹ X: v to the same twist, in the child frame.",
        KernelKind::TwistMapChildGradient => {
            "∂X^c/∂ϕ at ϕ = 0; slice k is the derivative along ϕ_k."
        }
        KernelKind::VelocityMap => "S₀(Q): ϕ̇ to v at ϕ = 0 (23).",
        KernelKind::VelocityMapInverse => "S₀⁻¹(Q): v to ϕ̇ at ϕ = 0.",
        KernelKind::VelocityMapGradient => "∂S/∂ϕ at ϕ = 0 (23), (32); slice k is ∂S/∂ϕ_k.",
        KernelKind::Gamma => "Σ_k γ_k v_k (17): stands on the left of (24).",
        KernelKind::J22 => "J22(Q, p) (28): stands on the right of (27).",
        KernelKind::Constraint => "A(Q) with Aᵀ v = 0 (Definition 2).",
        KernelKind::SpeedBasis => "S̄(Q): speeds v̄ to v (Definition 2, (15)).",
        KernelKind::SpeedBasisGradient => "∂S̄/∂ϕ at ϕ = 0; slice k is the derivative along ϕ_k.",
        KernelKind::PortMap => "P(Q), a row for each port: v to its rate.",
        KernelKind::PortValues => {
            "The values of the ports; an angle that does not count turns is between −π and π."
        }
        KernelKind::Pins => {
            "For each pin its point, the axis about which the first body turns and that along which it slides, in the parent frame; 0 for an axis that it does not have."
        }
        KernelKind::ConfigurationRate => "Q̇(Q, v) (31): the rates of the stored scalars.",
        KernelKind::Retract => {
            "Φ(Q, ϕ) at finite ϕ: the stored scalars of the moved configuration."
        }
        KernelKind::Local => "The ϕ with Φ(Q, ϕ) = `target`, on the principal branch.",
        KernelKind::TangentBasis => "B(Q): v to the displacement rate Q⁻¹Q̇.",
        KernelKind::NormalBasis => {
            "N(Q): displacements along which Φ comes back onto the manifold of the relations."
        }
        KernelKind::Displaced => "Q exp(ξ) at a finite displacement ξ.",
        KernelKind::DisplacedDifferential => {
            "dexp(ξ): rates of ξ to the displacement rate Q′⁻¹Q̇′ at Q′ = Q exp(ξ)."
        }
        KernelKind::Displacement => "The displacement ξ with Q exp(ξ) = `target`.",
        KernelKind::RetractDifferential => {
            "D at finite ϕ: ϕ̇ to `rate` = S₀(Q′)⁻¹ v at Q′ = Φ(Q, ϕ); S(Q, ϕ) = S₀(Q′) D."
        }
        KernelKind::RetractDifferentialInverse => {
            "ϕ̇ at finite ϕ from `rate` = S₀(Q′)⁻¹ v at Q′ = Φ(Q, ϕ), for |ϕ| < 2π."
        }
        KernelKind::Project => "The configuration on the manifold that is nearest to `q`.",
        KernelKind::Residual => {
            "Root of the sum of squares of the manifold's relations: 0 on the manifold."
        }
        KernelKind::Relations => "The relations of the manifold: 0 on it.",
        KernelKind::RelationGradient => {
            "∂φ(Q): the displacement rate Q⁻¹Q̇ to the rates of the relations that the spec declares."
        }
        KernelKind::RelationDisplacements => {
            "N (∂φ N)⁻¹: for each relation the displacement rate along N at which it changes at unit rate, and no other."
        }
        KernelKind::RelationTwists => {
            "The twist of the body, in the child frame, at the displacement rate of each relation, with H as written."
        }
        KernelKind::RelationPorts => {
            "The rates of the ports at the displacement rate of each relation: those of the first relation, then of the next."
        }
        KernelKind::Singularity => {
            "Least absolute value of the functions whose zeros the joint must stay away from."
        }
        KernelKind::BiasAcceleration => {
            "c(Q, v̄) = d/dt(X^c S̄) v̄: velocity product term of the recursive forms, in the child frame."
        }
        KernelKind::BiasMomentum => {
            "(d/dt(X^c S̄))ᵀ h for a momentum h (moment; linear) in the child frame."
        }
    }
}
