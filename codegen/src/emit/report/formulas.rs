//! The formulas of a report: names, matrices, and what they mean.

use super::notation::Notation;
use super::series::series;
use super::shared;
use super::statement;
use super::typeset::{Equation, Mark, Math};
use crate::derived::{Derived, Kernel, KernelKind, Step, Word};
use crate::expr::{Expr, Symbol};
use crate::matrix::Matrix;
use std::collections::{BTreeMap, BTreeSet};

/// Up to so many derivatives along ϕ_k are shown one by one; more are summed up in one matrix.
const FEW: usize = 3;

/// A formula on lines of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formula {
    /// What it is.
    pub title: String,
    /// The equations.
    pub equations: Vec<Equation>,
    /// The equations as text, aligned, over several lines.
    pub text: String,
    /// The statement that declares it, where one does.
    pub statement: String,
}

impl Formula {
    fn new(title: &str, equations: Vec<Equation>, statement: String) -> Self {
        let text: Vec<String> = equations.iter().map(Equation::text).collect();
        // Matrices stand apart; lines do not.
        let is_line = text.iter().all(|equation| !equation.contains('\n'));
        Self {
            title: title.into(),
            text: text.join(if is_line { "\n" } else { "\n\n" }),
            equations,
            statement,
        }
    }
}

/// H, X and S: what the documentation of a module shows.
pub fn main_formulas(derived: &Derived) -> Vec<Formula> {
    let kernels = [KernelKind::Pose, KernelKind::TwistMap];
    let formulas = derived.bodies().flat_map(|body| {
        let notation = Notation::new(body);
        let of = |kind: &KernelKind| of_kernel(body, &notation, *kind);
        let formulas = kernels.iter().filter_map(of);
        let names = names(body, &notation, &kernels);
        formulas.chain(names).collect::<Vec<_>>()
    });
    let series = std::iter::once(velocity_map(derived, &Notation::new(derived)));
    formulas.chain(series).collect()
}

/// The formula of one kernel of this body as pages show it; of S₀, S to first order in ϕ. `None` of a kernel that has no formula or is not shown.
pub fn formula(derived: &Derived, kind: KernelKind) -> Option<Formula> {
    let notation = Notation::new(derived);
    match kind {
        KernelKind::VelocityMap => Some(velocity_map(derived, &notation)),
        kind => of_kernel(derived, &notation, kind),
    }
}

/// What the names of the spec that stand in the formulas of these kernels mean, and the derivatives of those.
fn names(derived: &Derived, notation: &Notation, kernels: &[KernelKind]) -> Option<Formula> {
    let of = |kind: &KernelKind| derived.kernel(*kind);
    let steps = kernels
        .iter()
        .filter_map(of)
        .flat_map(|kernel| &kernel.steps);
    let mut used: BTreeSet<Symbol> = steps.flat_map(Step::bound).cloned().collect();
    // Those that stand in the values of others come before them.
    for word in derived.words.iter().rev() {
        if used.contains(&word.symbol) {
            used.extend(word.value.symbols());
        }
    }
    let words = derived.words.iter();
    let words = words.filter(|word| used.contains(&word.symbol));
    let equation = |word: &Word| Equation {
        left: notation.set_symbol(&word.symbol),
        right: notation.set(&word.value),
    };
    let equations: Vec<Equation> = words.map(equation).collect();
    let title = match derived.named.is_empty() {
        true => "Names of the spec, and their derivatives",
        false => "Names: rates of what follows by the relations, and what they are made of",
    };
    (!equations.is_empty()).then(|| Formula::new(title, equations, String::new()))
}

/// All formulas of a page.
pub(super) fn formulas(derived: &Derived, notation: &Notation) -> Vec<Formula> {
    let before = [
        KernelKind::Pose,
        KernelKind::TwistMap,
        KernelKind::TwistMapChild,
    ];
    let after = [
        KernelKind::VelocityMapInverse,
        KernelKind::VelocityMapGradient,
        KernelKind::Gamma,
        KernelKind::J22,
        KernelKind::Constraint,
        KernelKind::SpeedBasis,
        KernelKind::SpeedBasisGradient,
        KernelKind::PortMap,
        KernelKind::ConfigurationRate,
        KernelKind::Relations,
        KernelKind::TangentBasis,
        KernelKind::NormalBasis,
        KernelKind::BiasAcceleration,
        KernelKind::BiasMomentum,
    ];
    let of = |kind: &KernelKind| of_kernel(derived, notation, *kind);
    let all = [&before[..], &after].concat();
    let names = names(derived, notation, &all);
    let first: Vec<Formula> = names
        .into_iter()
        .chain(before.iter().filter_map(of))
        .collect();
    let others = derived.more.iter().flat_map(|body| {
        let notation = Notation::new(body);
        let of = |kind: &KernelKind| of_kernel(body, &notation, *kind);
        before.iter().filter_map(of).collect::<Vec<_>>()
    });
    let series = std::iter::once(velocity_map(derived, notation));
    first
        .into_iter()
        .chain(others)
        .chain(series)
        .chain(after.iter().filter_map(of))
        .collect()
}

fn velocity_map(derived: &Derived, notation: &Notation) -> Formula {
    let series = series(derived, notation);
    let gradient = derived.kernel(KernelKind::VelocityMapGradient);
    let arguments = vec![Math::Letter('Q'), Math::Sign(','), Math::Letter('ϕ')];
    let left = Math::Row(vec![Math::Letter('S'), Math::Row(arguments).grouped()]);
    let right = match gradient.is_some_and(all_zero) {
        true => series.product,
        false => {
            let square = Math::Letter('ϕ').raised_to(Math::integer(2)).grouped();
            let higher = Math::Row(vec![Math::Letter('O'), square]);
            Math::Row(vec![series.product, Math::Sign('+'), higher])
        }
    };
    let parts = series.parts.iter();
    let parts = parts.map(|(name, matrix)| notation.equation(name.clone(), matrix));
    Formula::new(
        "ϕ̇ to v, to first order in ϕ, (32)",
        std::iter::once(Equation { left, right })
            .chain(parts)
            .collect(),
        String::new(),
    )
}

/// The formula of a kernel; nothing for parts of nonholonomic joints where there are none, and for kernels without formulas.
fn of_kernel(derived: &Derived, notation: &Notation, kind: KernelKind) -> Option<Formula> {
    // What the runtime solves for has no formula.
    let kernel = derived
        .kernel(kind)
        .filter(|kernel| !kernel.outputs.is_empty())?;
    let body = derived.body_name().filter(|_| kind.is_of_body());
    let (name, title) = heading(kind, body)?;
    let title = match body {
        Some(body) => format!("{body}. {title}"),
        None => title.to_owned(),
    };
    let only_nonholonomic = [
        KernelKind::Constraint,
        KernelKind::SpeedBasis,
        KernelKind::SpeedBasisGradient,
    ];
    if derived.shape.constraints == 0 && only_nonholonomic.contains(&kind) {
        return None;
    }
    let name = match cross_product(derived, kernel) {
        Some(short) => name.equals(short),
        None => name,
    };
    let equations = equations(derived, notation, kernel, &name);
    let statement = statement(derived, kind).unwrap_or_default();
    (!equations.is_empty()).then(|| Formula::new(&title, equations, statement))
}

/// `p~` or `−v~`, where a Boltzmann–Hamel term is a cross product, as (32) makes it for a ball.
fn cross_product(derived: &Derived, kernel: &Kernel) -> Option<Math> {
    let (symbols, letter) = match kernel.kind {
        KernelKind::Gamma => (&derived.arguments.velocity, 'v'),
        KernelKind::J22 => (&derived.arguments.momentum, 'p'),
        _ => return None,
    };
    let vector: Vec<Expr> = symbols.iter().map(Expr::symbol).collect();
    let (matrix, tilde) = (kernel.outputs.first()?, Matrix::tilde(vector.get(..3)?));
    let negative = tilde.map(|entry| -entry);
    let name = Math::Letter(letter).marked(Mark::Tilde);
    match (vector.len(), *matrix == tilde, *matrix == negative) {
        (3, true, _) => Some(name),
        (3, _, true) => Some(name.negative()),
        _ => None,
    }
}

/// What a kernel is called, and what it is; `body` is the name of the body that it belongs to, where that has one.
fn heading(kind: KernelKind, body: Option<&str>) -> Option<(Math, &'static str)> {
    let letter = Math::Letter;
    let of_body = |c| match body {
        Some(body) => letter(c).with_index(Math::Word(body.into())),
        None => letter(c),
    };
    let partial = |of: Math| Math::Partial(Box::new(of), Box::new(letter('ϕ')));
    let basis = || letter('S').marked(Mark::Bar);
    Some(match kind {
        KernelKind::Pose => (
            of_body('H'),
            "Pose: child coordinates to parent coordinates",
        ),
        KernelKind::TwistMap => (of_body('X'), "v to twist, in the parent frame"),
        KernelKind::TwistMapChild => {
            let adjoint = Math::Word("Ad".into()).with_index(of_body('H').inverse());
            let product = Math::product([adjoint, of_body('X')]);
            (product, "v to twist, in the child frame")
        }
        KernelKind::VelocityMapInverse => {
            let inverse = letter('S').with_index(Math::integer(0)).inverse();
            (inverse, "v to ϕ̇ at ϕ = 0")
        }
        KernelKind::VelocityMapGradient => (partial(letter('S')), "Derivatives of S at ϕ = 0"),
        KernelKind::Gamma => (
            summed(Math::product(
                ['γ', 'v'].map(|c| letter(c).with_index(letter('k'))),
            )),
            "Boltzmann–Hamel term of the Lagrangian form, (17)",
        ),
        KernelKind::J22 => (
            letter('J').with_index(Math::integer(22)),
            "Gyroscopic matrix of the Hamiltonian form, (28)",
        ),
        KernelKind::Constraint => (letter('A'), "Constraint: Aᵀ v = 0"),
        KernelKind::SpeedBasis => (basis(), "Speeds to v"),
        KernelKind::SpeedBasisGradient => (
            partial(basis()),
            "Derivatives of the basis of speeds at ϕ = 0",
        ),
        KernelKind::PortMap => (letter('P'), "v to the rates of the ports"),
        KernelKind::ConfigurationRate => (
            letter('Q').marked(Mark::Dot),
            "Rate of the stored scalars, (31)",
        ),
        KernelKind::Relations => (letter('r'), "Relations that Q meets: r = 0"),
        KernelKind::TangentBasis => (letter('B'), "Directions of v: Q⁻¹Q̇ = B v"),
        KernelKind::NormalBasis => (
            letter('N'),
            "Directions along which Φ comes back onto the relations: Φ = Q exp(B ϕ + N λ)",
        ),
        KernelKind::BiasAcceleration => (
            letter('c'),
            "Velocity product term of the recursive forms, in the child frame",
        ),
        KernelKind::BiasMomentum => (
            Math::product([
                letter('X').marked(Mark::Bar).marked(Mark::Dot).transposed(),
                letter('h'),
            ]),
            "Its dual, for a momentum h in the child frame",
        ),
        _ => return None,
    })
}

fn summed(term: Math) -> Math {
    Math::product([Math::Letter('Σ'), term])
}

/// What the kernel's values are; with names for what they share where they are long.
fn equations(
    derived: &Derived,
    notation: &Notation,
    kernel: &Kernel,
    name: &Math,
) -> Vec<Equation> {
    let whole = |room| whole_equations(derived, notation, kernel, name, room);
    let room = match kernel.kind {
        KernelKind::Pose => usize::MAX,
        _ => shared::LONGEST,
    };
    if let Some(equations) = whole(room) {
        return equations;
    }
    let names: Vec<Math> = match kernel.outputs.len() {
        1 => vec![name.clone()],
        slices => (1..=slices)
            .map(|k| along(name, Math::integer(k)))
            .collect(),
    };
    shared::equations(derived, notation, kernel, &names)
        .or_else(|| whole(usize::MAX))
        .unwrap_or_default()
}

/// The equations as they stand; nothing where their right sides have no room together.
fn whole_equations(
    derived: &Derived,
    notation: &Notation,
    kernel: &Kernel,
    name: &Math,
    mut room: usize,
) -> Option<Vec<Equation>> {
    let mut one = |matrix: &Matrix| {
        let equation = notation.equation_within(name.clone(), matrix, &mut room)?;
        Some(vec![equation])
    };
    match (kernel.kind, in_words(derived, kernel).as_slice()) {
        (_, []) => Some(vec![]),
        (KernelKind::Pose, [rotation, translation]) => one(&homogeneous(rotation, translation)),
        (KernelKind::VelocityMapGradient | KernelKind::SpeedBasisGradient, slices) => {
            gradient(derived, notation, name, slices, room)
        }
        (_, [only]) => one(only),
        _ => Some(vec![]),
    }
}

/// The kernel's values with its lines in their places, except for those that are names of the spec.
fn in_words(derived: &Derived, kernel: &Kernel) -> Vec<Matrix> {
    let mut values: BTreeMap<Symbol, Expr> = BTreeMap::new();
    for step in &kernel.steps {
        if let Step::Let(symbol, value) = step
            && !shared::is_word(derived, symbol)
        {
            values.insert(symbol.clone(), value.substitute(&values));
        }
    }
    let outputs = kernel.outputs.iter();
    outputs
        .map(|output| output.map(|entry| entry.substitute(&values)))
        .collect()
}

/// Slice by slice where they are few; else one matrix linear in ϕ, the coefficients of which are the slices.
fn gradient(
    derived: &Derived,
    notation: &Notation,
    name: &Math,
    slices: &[Matrix],
    mut room: usize,
) -> Option<Vec<Equation>> {
    let mut one = |name: Math, matrix: &Matrix| notation.equation_within(name, matrix, &mut room);
    let zero = Matrix::zeros(1, 1);
    if slices.iter().all(Matrix::is_zero) {
        return Some(vec![one(name.clone(), &zero)?]);
    }
    if slices.len() <= FEW {
        let each = slices.iter().enumerate();
        let each = each.map(|(k, slice)| one(along(name, Math::integer(k + 1)), slice));
        return each.collect();
    }
    let (k, first) = (
        Math::Letter('k'),
        Matrix::zeros(slices[0].rows(), slices[0].columns()),
    );
    let terms = slices.iter().zip(&derived.arguments.local);
    let sum = terms.fold(first, |sum, (slice, local)| {
        sum.plus(&slice.scale(&Expr::symbol(local)))
    });
    let term = Math::product([Math::Letter('ϕ').with_index(k.clone()), along(name, k)]);
    Some(vec![one(summed(term), &sum)?])
}

/// The derivative along one ϕ.
fn along(name: &Math, index: Math) -> Math {
    match name {
        Math::Partial(above, below) => Math::Partial(
            above.clone(),
            Box::new(below.as_ref().clone().with_index(index)),
        ),
        other => other.clone(),
    }
}

fn homogeneous(rotation: &Matrix, translation: &Matrix) -> Matrix {
    let last = Matrix::from_fn(1, 4, |_, j| Expr::integer((j == 3).into()));
    rotation.beside(translation).stack(&last)
}

fn all_zero(kernel: &Kernel) -> bool {
    kernel.outputs.iter().all(Matrix::is_zero)
}
