//! What is derived from a spec: kernels in symbols, and the claims that were proved. The border between derivation and output.

use crate::emit::formula::Program;
use crate::emit::names::Names;
use crate::expr::{Expr, Rational, Role, Symbol};
use crate::matrix::Matrix;
use crate::model::JointSpec;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

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
    /// Q̇(Q, v).
    ConfigurationRate,
    /// Φ(Q, ϕ) at finite ϕ.
    Retract,
    /// ϕ(Q, Q′).
    Local,
    /// Differential D of Φ at finite ϕ.
    RetractDifferential,
    /// Inverse differential of Φ at finite ϕ.
    RetractDifferentialInverse,
    /// The relations of the manifold, as a column: only where the spec declares some.
    Relations,
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
    /// The results with the values of the lines before them in their places, as far as these have formulas.
    pub fn expanded(&self) -> Vec<Matrix> {
        let mut values: BTreeMap<Symbol, Expr> = BTreeMap::new();
        for step in &self.steps {
            if let Step::Let(symbol, value) = step {
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
    /// K: freedoms, size of v and ϕ.
    pub freedoms: usize,
    /// S: speeds v̄.
    pub speeds: usize,
    /// C: nonholonomic constraints.
    pub constraints: usize,
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
    /// v; also the `rate` of [`KernelKind::RetractDifferentialInverse`].
    pub velocity: Vec<Symbol>,
    /// v̄.
    pub speeds: Vec<Symbol>,
    /// p.
    pub momentum: Vec<Symbol>,
    /// h, six of them, moment first.
    pub wrench: Vec<Symbol>,
}

/// How a claim was proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof {
    /// The difference of both sides has normal form 0.
    NormalForm,
    /// A certificate: a minor or determinant whose normal form is a constant other than 0, or a polynomial inverse.
    Certificate,
    /// None: evaluated at points, where it holds, and accepted because the spec says `unproved`.
    Checked,
}

impl Proof {
    /// Name in machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Self::NormalForm => "normal_form",
            Self::Certificate => "certificate",
            Self::Checked => "checked",
        }
    }
}

/// Something that was proved of a joint, or checked where the spec says so.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Stable name, `pose_in_se3` and the like.
    pub name: &'static str,
    /// The claim in the notation of the paper.
    pub statement: String,
    /// How it was proved.
    pub proof: Proof,
    /// The certificate, where there is one; the author's reason for a claim that is not proved.
    pub detail: String,
    /// Points at which a claim that is not proved was evaluated: 0 for proofs.
    pub points: usize,
}

/// A value that kernels name in a line of their own: a `let` of the spec, an entry of one, or a derivative of that.
#[derive(Clone, Debug)]
pub struct Word {
    /// Its name.
    pub symbol: Symbol,
    /// Its value in stored scalars, parameters and the words before it.
    pub value: Expr,
    /// The `let` or its entry: the name itself, but for derivatives.
    pub base: String,
    /// The freedoms along which a derivative is taken, one after the other.
    pub along: Vec<usize>,
}

impl Word {
    /// Whether it is a derivative of a `let`.
    pub fn is_derivative(&self) -> bool {
        !self.along.is_empty()
    }
}

/// A joint with all that follows from its spec.
#[derive(Clone, Debug)]
pub struct Derived {
    /// The spec.
    pub spec: JointSpec,
    /// Sizes.
    pub shape: Shape,
    /// Dimension of what the relations that are checked cut out: k, or more where Q moves in an orbit that they do not describe.
    pub cut_out: usize,
    /// Names of the speeds.
    pub speed_names: Vec<String>,
    /// Symbols of the kernels' arguments.
    pub arguments: Arguments,
    /// All kernels, in the order of [`KernelKind`].
    pub kernels: Vec<Kernel>,
    /// What kernels name in lines of their own, each after those in its value.
    pub words: Vec<Word>,
    /// ∂Φ/∂ϕ of the stored scalars at ϕ = 0, N×K.
    pub tangent: Matrix,
    /// X^c S₀: ϕ̇ at ϕ = 0 to the twist of the child relative to the parent, in the child frame, 6×K.
    pub local_twist_map: Matrix,
    /// X̄^c = X^c S̄: v̄ to the same twist, 6×S.
    pub speed_map: Matrix,
    /// S to first order in ϕ, (32): S₀ + Σ S_k ϕ_k, in S₀-factored form where that is shorter: `(left, right)` with `S = left · right`.
    pub velocity_map_series: (Matrix, Matrix),
    /// N_X: basis of the inertias that the joint cannot feel, `[m, mc_x, mc_y, mc_z, Ixx, Iyy, Izz, Ixy, Ixz, Iyz]`.
    pub imperceptible: Vec<[Rational; 10]>,
    /// All that was proved, and what was checked instead.
    pub claims: Vec<Claim>,
    /// Formulas of kernels that were simplified already: Rust and pages are written from the same.
    pub(crate) programs: Programs,
}

/// Simplified formulas by kernel, kept while nothing changes the kernels.
#[derive(Debug, Default)]
pub(crate) struct Programs(Mutex<Vec<(Kernel, Arc<Program>)>>);

impl Clone for Programs {
    /// A copy starts empty: whoever clones a joint may change its kernels.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Programs {
    /// The formulas of a kernel; `make` simplifies them where that has not been done.
    pub(crate) fn get(&self, kernel: &Kernel, make: impl FnOnce() -> Program) -> Arc<Program> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, program)) = known.iter().find(|(other, _)| other == kernel) {
            return program.clone();
        }
        let program = Arc::new(make());
        known.push((kernel.clone(), program.clone()));
        program
    }
}

impl Derived {
    /// The formulas of one of its kernels, as they are written everywhere.
    pub fn program(&self, kernel: &Kernel) -> Arc<Program> {
        self.programs
            .get(kernel, || self.formulas(&kernel.steps, &kernel.outputs))
    }

    /// The formulas of lines and of the results that follow from them, in the names of this joint.
    pub(crate) fn formulas(&self, steps: &[Step], outputs: &[Matrix]) -> Program {
        let mut names = Names::new(self);
        let bound = steps.iter().flat_map(Step::bound);
        bound.for_each(|symbol| names.claim(symbol));
        Program::new(steps, outputs, names.taken())
    }

    /// The kernel of that kind.
    pub fn kernel(&self, kind: KernelKind) -> Option<&Kernel> {
        self.kernels.iter().find(|kernel| kernel.kind == kind)
    }
}
