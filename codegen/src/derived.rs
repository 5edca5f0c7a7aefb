//! What is derived from a spec: kernels in symbols, and the claims that were proved. The border between derivation and output.

use crate::expand::PinDrive;
use crate::expr::{Expr, Rational, Symbol};
use crate::formula::{Names, Program};
use crate::matrix::Matrix;
use crate::model::{ConfigurationSpace, JointSpec};
use std::collections::BTreeMap;
use std::sync::OnceLock;

pub use crate::kernel::{
    Arguments, Kernel, KernelKind, Method, Primitive, Shape, Step, Structure, Word,
};
pub use crate::prove::{Claim, Proof};

/// A joint with all that follows from its spec.
///
/// Where it carries several bodies, this is the joint as the first of them sees it; `more` holds it as the others do. What belongs to Q and v
/// alone is the same in all.
#[derive(Clone, Debug)]
pub struct Derived {
    /// The spec, with the pose and the declared twists of this body alone.
    pub spec: JointSpec,
    /// Which of its bodies this is.
    pub body: usize,
    /// The joint as each further body sees it.
    pub more: Vec<Derived>,
    /// Where the joint lives. It must not come to what the spec excepts, or else to the border of the side on which its functions have a value.
    pub space: ConfigurationSpace,
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
    /// The names in which B was derived where relations alone say how Q moves, each after those in its value: `tangent`, `local_twist_map` and
    /// `speed_map` hold them.
    pub named: Vec<Word>,
    /// ∂Φ/∂ϕ of the stored scalars at ϕ = 0, N×K.
    pub tangent: Matrix,
    /// X^c S₀: ϕ̇ at ϕ = 0 to the twist of the child relative to the parent, in the child frame, 6×K.
    pub local_twist_map: Matrix,
    /// X̄^c = X^c S̄: v̄ to the same twist, 6×S.
    pub speed_map: Matrix,
    /// S to first order in ϕ, (32): S₀ + Σ S_k ϕ_k, in S₀-factored form where that is shorter: `(left, right)` with `S = left · right`.
    pub velocity_map_series: (Matrix, Matrix),
    /// The degrees of freedom that move no body, by their places.
    pub still: Vec<usize>,
    /// The speeds that move no body, by their places.
    pub still_speeds: Vec<usize>,
    /// The efforts that act at each pin.
    pub pin_drives: Vec<Vec<PinDrive>>,
    /// N_X: basis of the inertias that do not affect the joint, `[m, mc_x, mc_y, mc_z, Ixx, Iyy, Izz, Ixy, Ixz, Iyz]`.
    pub unidentifiable: Vec<[Rational; 10]>,
    /// All that was proved, and what was checked instead.
    pub claims: Vec<Claim>,
    /// The formulas of each kernel, as they are written everywhere.
    pub(crate) programs: Programs,
}

/// The formulas of kernels. Of a further body, those of Q and v alone are made when they are first asked for: they are seldom needed twice.
pub(crate) type Programs = BTreeMap<KernelKind, OnceLock<Program>>;

/// The formulas of kernels in the names of their joint, those of all kinds that are `written` here.
pub(crate) fn programs(
    spec: &JointSpec,
    arguments: &Arguments,
    words: &[Word],
    kernels: &[Kernel],
    written: impl Fn(KernelKind) -> bool,
) -> Programs {
    let names = Names::new(&spec.parameters, arguments, words);
    let program = |kernel: &Kernel| {
        let program = || Program::in_names(&kernel.steps, &kernel.outputs, names.clone());
        let program = written(kernel.kind).then(program);
        (
            kernel.kind,
            program.map_or_else(OnceLock::new, OnceLock::from),
        )
    };
    kernels.iter().map(program).collect()
}

/// That of a kernel that a joint does not have.
const NOTHING: &Program = &Program {
    bindings: vec![],
    outputs: vec![],
};

impl Derived {
    /// The name of this body, where the spec gives it one.
    pub fn body_name(&self) -> Option<&str> {
        self.spec.bodies.get(self.body).map(String::as_str)
    }

    /// The joint as each of its bodies sees it, in order.
    pub fn bodies(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.more)
    }

    /// The formulas of one of its kernels.
    pub fn program(&self, kernel: &Kernel) -> &Program {
        let (Some(program), Some(own)) =
            (self.programs.get(&kernel.kind), self.kernel(kernel.kind))
        else {
            return NOTHING;
        };
        program.get_or_init(|| Program::in_names(&own.steps, &own.outputs, self.names()))
    }

    /// The names of its symbols in every kernel.
    pub fn names(&self) -> Names {
        Names::new(&self.spec.parameters, &self.arguments, &self.words)
    }

    /// Puts a kernel in the place of that of its kind, with its formulas.
    pub fn replace(&mut self, kernel: Kernel) {
        let program = Program::in_names(&kernel.steps, &kernel.outputs, self.names());
        self.programs.insert(kernel.kind, program.into());
        self.kernels.retain(|other| other.kind != kernel.kind);
        self.kernels.push(kernel);
        self.kernels.sort_by_key(|kernel| kernel.kind);
    }

    /// Whether row k of S̄ is that of a unit matrix, and row k of S does not change with ϕ: v_k is a speed, and the rate of its own coordinate.
    pub fn rate_is_a_speed(&self, k: usize) -> bool {
        let row =
            |m: &Matrix| -> Vec<Expr> { (0..m.columns()).map(|j| m.at(k, j).clone()).collect() };
        let is_unit = |m: &Matrix| {
            let row = row(m);
            let zeros = row.iter().filter(|entry| entry.is_zero()).count();
            row.contains(&Expr::one()) && zeros + 1 == row.len()
        };
        let is_zero = |m: &Matrix| row(m).iter().all(Expr::is_zero);
        let outputs = |kind| self.kernel(kind).map_or(&[][..], |kernel| &kernel.outputs);
        outputs(KernelKind::SpeedBasis).iter().all(is_unit)
            && outputs(KernelKind::VelocityMapGradient).iter().all(is_zero)
    }

    /// Which columns of S̄ the spec's names of speeds are, in words, where S̄ is derived from A and the spec does not show it.
    pub fn named_columns_in_words(&self) -> Option<String> {
        let spec = &self.spec;
        if spec.speed_names.is_none() || spec.speed_basis.is_some() || spec.constraint.is_none() {
            return None;
        }
        let basis = self.kernel(KernelKind::SpeedBasis)?.outputs.first()?;
        let names = self.speed_names.iter().enumerate();
        let columns: Vec<String> = names
            .map(|(j, name)| {
                let entries = basis.column(j).into_iter();
                let entries: Vec<String> = entries.map(|entry| entry.to_string()).collect();
                format!("{name} = [{}]", entries.join(", "))
            })
            .collect();
        Some(format!(
            "S_bar is derived from A, and its columns are {}: give S_bar to choose others",
            columns.join(", ")
        ))
    }

    /// What moves no body, in words: degrees of freedom, and the speeds that make these alone. `None` where everything moves it.
    pub fn still_in_words(&self) -> Option<String> {
        let named = |k: &usize| {
            let freedom = self.spec.freedoms.value.get(*k)?;
            Some(freedom.name.clone())
        };
        let freedoms: Vec<String> = self.still.iter().filter_map(named).collect();
        let speeds = self.still_speeds.iter();
        let speeds: Vec<&str> = speeds
            .filter_map(|&j| self.speed_names.get(j))
            .map(String::as_str)
            .collect();
        (!freedoms.is_empty()).then(|| {
            let speeds = match speeds.as_slice() {
                [] => "every speed moves it".to_owned(),
                [speed] => format!("the speed {speed} moves nothing else"),
                _ => format!("the speeds {} move nothing else", speeds.join(", ")),
            };
            let move_none = match freedoms.as_slice() {
                [freedom] => format!("{freedom} moves no body"),
                _ => format!("{} move no body", freedoms.join(", ")),
            };
            format!("{move_none}; {speeds}")
        })
    }

    /// How many relations the spec declares, and how many those of the factors are, which stand before them.
    pub fn relation_counts(&self) -> [usize; 2] {
        let declared = self.space.manifold.declared().len();
        let relations = self.kernel(KernelKind::Relations);
        let all = relations.and_then(|kernel| kernel.outputs.first());
        [declared, all.map_or(0, |column| column.rows() - declared)]
    }

    /// Rank of the derivatives of the relations on the manifold: N less the dimension that they cut out, without what known factors
    /// that no relation names contribute to it.
    pub fn codimension(&self) -> usize {
        let relations = self.kernel(KernelKind::Relations);
        let entries = relations.iter().flat_map(|kernel| &kernel.outputs);
        let named: Vec<Symbol> = entries
            .flat_map(|column| column.entries())
            .flat_map(|entry| entry.symbols())
            .collect();
        let factors = self.space.manifold.factors().iter();
        let apart: usize = factors
            .filter(|factor| !factor.coordinates.iter().any(|q| named.contains(q)))
            .map(|factor| factor.coordinates.len() - factor.kind.dimension())
            .sum();
        self.shape.configuration - self.cut_out - apart
    }

    /// The kernel of that kind.
    pub fn kernel(&self, kind: KernelKind) -> Option<&Kernel> {
        self.kernels.iter().find(|kernel| kernel.kind == kind)
    }
}
