//! Kernels in symbols: what a joint computes, before it has the form of any language.

use crate::expr::{Expr, Role, Symbol};
use crate::matrix::Matrix;
use std::collections::{BTreeMap, BTreeSet};

/// The kernels of a joint, in the order in which they are emitted: one method each of the runtime's `Joint` trait.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum KernelKind {
    /// The stored scalars of the home configuration.
    Home,
    /// H(Q).
    Pose,
    /// X(Q).
    TwistMap,
    /// X^c(Q).
    TwistMapChild,
    /// ∂X^c/∂ϕ.
    TwistMapChildGradient,
    /// S₀(Q).
    VelocityMap,
    /// S₀⁻¹(Q).
    VelocityMapInverse,
    /// ∂S/∂ϕ.
    VelocityMapGradient,
    /// Σ_k γ_k v_k.
    Gamma,
    /// J22(Q, p).
    J22,
    /// A(Q).
    Constraint,
    /// S̄(Q).
    SpeedBasis,
    /// ∂S̄/∂ϕ.
    SpeedBasisGradient,
    /// P(Q): v to the rates of the ports.
    PortMap,
    /// The values of the ports.
    PortValues,
    /// Points and axes of the pins, in the frame that the joint hangs on.
    Pins,
    /// Q̇(Q, v).
    ConfigurationRate,
    /// Φ(Q, ϕ) at finite ϕ.
    Retract,
    /// ϕ(Q, Q′).
    Local,
    /// B(Q): v to the displacement rate Q⁻¹Q̇, where relations alone say how Q moves.
    TangentBasis,
    /// N(Q): the displacements along which Φ comes back onto the manifold of the relations.
    NormalBasis,
    /// Q exp(ξ) at a finite displacement ξ.
    Displaced,
    /// dexp(ξ): ξ̇ to Q′⁻¹Q̇′ at Q′ = Q exp(ξ), where it is not the identity.
    DisplacedDifferential,
    /// ξ = log(Q⁻¹Q′).
    Displacement,
    /// Differential D of Φ at finite ϕ.
    RetractDifferential,
    /// Inverse differential of Φ at finite ϕ.
    RetractDifferentialInverse,
    /// The relations of the manifold, as a column: only where the spec declares some.
    Relations,
    /// ∂φ(Q): displacements of Q to changes of the declared relations, where these alone say how Q moves.
    RelationGradient,
    /// N (∂φ N)⁻¹: for each declared relation the displacement along N that changes it at unit rate, and no other, where relations alone say how Q moves.
    RelationDisplacements,
    /// The twists of the body at these displacements, in the child frame.
    RelationTwists,
    /// The rates of the ports at these displacements.
    RelationPorts,
    /// Projection onto the manifold.
    Project,
    /// Residual of the manifold's relations.
    Residual,
    /// The functions whose zeros the joint must stay away from, as a column.
    Singularity,
    /// c = Ẋ̄^c v̄.
    BiasAcceleration,
    /// Ẋ̄^cᵀ h.
    BiasMomentum,
}

impl KernelKind {
    /// Whether it is different for each body of a joint; others belong to Q and v alone.
    pub fn is_of_body(self) -> bool {
        matches!(
            self,
            Self::Pose
                | Self::TwistMap
                | Self::TwistMapChild
                | Self::TwistMapChildGradient
                | Self::BiasAcceleration
                | Self::BiasMomentum
                | Self::RelationTwists
        )
    }
}

/// What is known of a kernel's value at compile time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// Identically zero.
    Zero,
    /// The identity matrix or map.
    Identity,
    /// Independent of the configuration.
    Constant,
    /// Depends on the configuration.
    General,
}

impl Structure {
    /// That of a kernel with these results.
    pub fn of(outputs: &[Matrix]) -> Self {
        let entries = || outputs.iter().flat_map(Matrix::entries);
        let moves = |entry: &Expr| {
            let symbols = entry.symbols();
            let moving = [Role::Coordinate, Role::Intermediate];
            symbols.iter().any(|symbol| moving.contains(&symbol.role))
        };
        match outputs {
            _ if outputs.iter().all(Matrix::is_zero) => Self::Zero,
            [output] if output.rows() == output.columns() && output.is_identity() => Self::Identity,
            _ if !entries().any(moves) => Self::Constant,
            _ => Self::General,
        }
    }
}

/// A function of the runtime that a kernel calls where no formula serves at every argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Primitive {
    /// 3×3 rotation matrix to its rotation vector (3 outputs): `Scalar::rotation_vector`.
    RotationVector,
    /// Quaternion (w, x, y, z) to the rotation vector of its rotation (3 outputs): `Scalar::quaternion_vector`.
    QuaternionVector,
    /// 3×3 matrix near SO(3) to the nearest rotation matrix (9 outputs, row by row): `spatial::nearest_rotation`.
    NearestRotation,
}

/// One line of a kernel before its result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Step {
    /// Binds a name (`Role::Intermediate`) to a value.
    Let(Symbol, Expr),
    /// Binds names to the results of a runtime function.
    Call {
        /// The function.
        primitive: Primitive,
        /// Its argument.
        argument: Matrix,
        /// Its results.
        outputs: Vec<Symbol>,
    },
}

impl Step {
    /// The symbols that it binds.
    pub fn bound(&self) -> &[Symbol] {
        match self {
            Self::Let(symbol, _) => std::slice::from_ref(symbol),
            Self::Call { outputs, .. } => outputs,
        }
    }

    /// How many expressions it evaluates.
    pub fn formulas(&self) -> usize {
        match self {
            Self::Let(..) => 1,
            Self::Call { argument, .. } => argument.entries().len(),
        }
    }
}

/// How a kernel gets its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// By its formulas.
    Formula,
    /// By a K×K solve of the runtime, with the derivatives of Φ: D and D⁻¹ where Φ is not exp.
    Solve,
    /// By Newton's method of the runtime, from the value of its formulas or from 0.
    Newton,
}

/// One kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Kernel {
    /// Which one.
    pub kind: KernelKind,
    /// Lines before the result, in order.
    pub steps: Vec<Step>,
    /// The result: one matrix; for [`KernelKind::Pose`] rotation and translation; for gradients one slice for each ϕ_k;
    /// for [`KernelKind::Residual`] the column of relations, whose Euclidean norm is the kernel's value; for
    /// [`KernelKind::Singularity`] the column of functions, whose least absolute value is, and, where there are any, a second one of
    /// functions that are positive on the side of home, beyond which it is 0.
    pub outputs: Vec<Matrix>,
    /// How the value is found.
    pub method: Method,
    /// What is known at compile time.
    pub structure: Structure,
}

impl Kernel {
    /// The arguments that the results are made of, by way of the lines before them.
    pub fn arguments(&self) -> BTreeSet<Symbol> {
        let of = |matrix: &Matrix| -> BTreeSet<Symbol> {
            matrix.entries().iter().flat_map(Expr::symbols).collect()
        };
        let mut needed: BTreeSet<Symbol> = self.outputs.iter().flat_map(of).collect();
        for step in self.steps.iter().rev() {
            let mut is_needed = false;
            for symbol in step.bound() {
                is_needed |= needed.remove(symbol);
            }
            match step {
                _ if !is_needed => {}
                Step::Let(_, value) => needed.extend(value.symbols()),
                Step::Call { argument, .. } => needed.extend(of(argument)),
            }
        }
        needed
    }

    /// The results with the values of the lines before them in their places, as far as these have formulas.
    pub fn expanded(&self) -> Vec<Matrix> {
        self.expanded_but(&[])
    }

    /// The same with these names left as they are.
    pub fn expanded_but(&self, kept: &[Word]) -> Vec<Matrix> {
        let is_kept = |symbol: &Symbol| kept.iter().any(|word| word.symbol == *symbol);
        let mut values: BTreeMap<Symbol, Expr> = BTreeMap::new();
        for step in &self.steps {
            if let Step::Let(symbol, value) = step
                && !is_kept(symbol)
            {
                let value = value.substitute(&values);
                values.insert(symbol.clone(), value);
            }
        }
        let put_in = |output: &Matrix| output.map(|entry| entry.substitute(&values));
        self.outputs.iter().map(put_in).collect()
    }
}

/// Sizes of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// N: stored scalars of Q.
    pub configuration: usize,
    /// K: degrees of freedom, size of v and ϕ.
    pub freedoms: usize,
    /// S: speeds v̄.
    pub speeds: usize,
    /// C: nonholonomic constraints.
    pub constraints: usize,
    /// G: dimension of the group in which a manifold of relations lies; 0 where Φ needs none.
    pub displacements: usize,
    /// How many ports there are.
    pub ports: usize,
    /// How many pins there are.
    pub pins: usize,
}

/// The symbols that stand for the arguments of the kernels.
#[derive(Clone, Debug)]
pub struct Arguments {
    /// Q.
    pub configuration: Vec<Symbol>,
    /// Q′ of [`KernelKind::Local`].
    pub target: Vec<Symbol>,
    /// ϕ.
    pub local: Vec<Symbol>,
    /// ξ; none where Φ is not by relations alone.
    pub displacement: Vec<Symbol>,
    /// v; also the `rate` of [`KernelKind::RetractDifferentialInverse`].
    pub velocity: Vec<Symbol>,
    /// v̄.
    pub speeds: Vec<Symbol>,
    /// p.
    pub momentum: Vec<Symbol>,
    /// h, six of them, moment first.
    pub wrench: Vec<Symbol>,
}

/// A value that kernels name in a line of their own: a `let` of the spec, an entry of one, or a derivative of that.
#[derive(Clone, Debug)]
pub struct Word {
    /// Its name.
    pub symbol: Symbol,
    /// Its value in stored scalars, parameters and the words before it.
    pub value: Expr,
    /// The `let` or its entry: the name itself, except for derivatives.
    pub base: Symbol,
    /// The degrees of freedom along which a derivative is taken, one after the other.
    pub along: Vec<usize>,
    /// Its derivatives along each ϕ_k, where more is known of them than the chain rule tells: in words.
    pub rates: Vec<Expr>,
}

impl Word {
    /// Whether it is a derivative of a `let`.
    pub fn is_derivative(&self) -> bool {
        !self.along.is_empty()
    }
}
