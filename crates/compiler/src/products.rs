//! What the derivatives of a scene's equations need of a joint type beyond its kernels: products of them and their derivatives along ϕ, in
//! symbols, so that they are simplified modulo the joint's relations.
//!
//! The runtime forms the same products in numbers: `hamel_runtime::joint::Products`.

use super::linkage::Linkage;
use super::prune::{Element, Freedom, Remembered};
use hamel_codegen::WORK_LIMIT;
use hamel_codegen::derived::{Derived, KernelKind, Step, Word};
use hamel_codegen::expr::budget::{self, Exhausted};
use hamel_codegen::expr::{Expr, Role, Symbol};
use hamel_codegen::formula::Program;
use hamel_codegen::matrix::Matrix;
use hamel_runtime::spatial::Pose;
use std::cell::{OnceCell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// First index of the names of derivatives, above those of a joint's own names.
const FIRST_INDEX: usize = 0x7000;

/// One product: its value, and its formulas once something asks for them.
#[derive(Clone, Debug)]
pub struct Product {
    /// The names in its value, each after those in its own.
    pub steps: Vec<Step>,
    /// Its value.
    pub value: Matrix,
    program: OnceCell<Program>,
}

/// A joint type as the scene compiler takes it; where it carries several bodies, as one of them sees it.
#[derive(Clone, Debug)]
pub struct JointType {
    /// Its kernels.
    pub derived: Derived,
    /// Products of them.
    pub products: Products,
    /// The joint as each further body sees it, of the first.
    pub more: Vec<Rc<JointType>>,
    /// Inertias that do not affect the joint, of all its bodies together, for the numbers that were asked for.
    pub(crate) across: RefCell<BTreeMap<Vec<u64>, Option<Vec<Element>>>>,
    /// How the frame of its body may move.
    pub(crate) frames: Remembered<Freedom>,
    /// Its pose at home.
    pub(crate) homes: Remembered<Pose<f64>>,
    /// The links of the joint of a coupling or a loop, as the body sees them: its kernels are theirs.
    pub(crate) linkage: Option<Linkage>,
}

impl JointType {
    /// A joint type with its products.
    ///
    /// # Errors
    /// When these take more work than a spec may.
    pub fn new(derived: Derived) -> Result<Self, Exhausted> {
        let more = derived.more.iter().cloned();
        let more = more.map(|own| Self::new(own).map(Rc::new));
        Ok(Self {
            more: more.collect::<Result<_, _>>()?,
            products: Products::new(&derived)?,
            derived,
            across: RefCell::default(),
            frames: Remembered::default(),
            homes: Remembered::default(),
            linkage: None,
        })
    }

    /// Gives the body its place among the links of a joint. What was derived is of coordinates that all move by themselves: those that follow by ties are no freedoms.
    pub(crate) fn hang(&mut self, linkage: Linkage) {
        let derived = &mut self.derived;
        if !linkage.is_one_link() {
            // What it does not feel is not known then.
            derived.unidentifiable.clear();
        }
        (self.frames, self.homes) = (Remembered::default(), Remembered::default());
        let freedoms = linkage.freedoms();
        (derived.shape.freedoms, derived.shape.speeds) = (freedoms, freedoms);
        derived.spec.freedoms.value.truncate(freedoms);
        derived.speed_names.truncate(freedoms);
        let units = &mut derived.spec.units;
        for units in [
            &mut units.freedoms,
            &mut units.velocities,
            &mut units.speeds,
        ] {
            units.truncate(freedoms);
        }
        self.linkage = Some(linkage);
    }

    /// The formulas of one of its products, in its own names.
    pub fn program<'a>(&self, product: &'a Product) -> &'a Program {
        let value = std::slice::from_ref(&product.value);
        let formulas = || Program::in_names(&product.steps, value, self.derived.names());
        product.program.get_or_init(formulas)
    }
}

/// The products of one joint type, in the symbols of its kernels' arguments.
#[derive(Clone, Debug)]
pub struct Products {
    /// X^c S₀, 6×K.
    pub local_twist_map: Product,
    /// ∂(X̄^c v̄)/∂ϕ at fixed v̄, with X̄^c = X^c S̄: 6×K.
    pub twist_gradient: Product,
    /// ∂(X̄^cᵀ h)/∂ϕ, S×K.
    pub effort_gradient: Product,
    /// ∂c/∂ϕ at fixed v̄, 6×K.
    pub bias_acceleration_gradient: Product,
    /// ∂c/∂v̄, 6×S.
    pub bias_acceleration_slope: Product,
}

impl Products {
    fn new(derived: &Derived) -> Result<Self, Exhausted> {
        budget::scope(WORK_LIMIT, || {
            budget::begin("products of a joint's kernels");
            Self::of(derived)
        })
    }

    fn of(derived: &Derived) -> Self {
        let arguments = &derived.arguments;
        let speeds = Matrix::symbols(&arguments.speeds);
        let wrench = Matrix::symbols(&arguments.wrench);
        let map = &derived.speed_map;
        let bias = derived.kernel(KernelKind::BiasAcceleration);
        let bias = bias.map(|kernel| kernel.expanded_but(&derived.named));
        let bias = bias.and_then(|outputs| outputs.into_iter().next());
        let bias = bias.unwrap_or_else(|| Matrix::zeros(6, 1));
        let names = Names::new(derived);
        let along = |column: &Matrix| names.product(names.along_each(column));
        let by_speeds = by_each(derived, &bias, &arguments.speeds);
        Self {
            local_twist_map: names.product(derived.local_twist_map.clone()),
            twist_gradient: along(&map.times(&speeds)),
            effort_gradient: along(&map.transpose().times(&wrench)),
            bias_acceleration_gradient: along(&bias),
            bias_acceleration_slope: names.product(by_speeds),
        }
    }
}

/// The names in which a joint's B was derived, and their derivatives along each ϕ_k, as names of their own where these are not known in names.
struct Names<'a> {
    derived: &'a Derived,
    /// Values of names, each after those in it.
    values: Vec<(Symbol, Expr)>,
    /// By k and name, the derivative.
    rates: Vec<BTreeMap<Symbol, Expr>>,
}

impl<'a> Names<'a> {
    fn new(derived: &'a Derived) -> Self {
        let words = derived.named.iter();
        let mut names = Self {
            derived,
            values: words.map(|w| (w.symbol.clone(), w.value.clone())).collect(),
            rates: vec![],
        };
        for k in 0..derived.shape.freedoms {
            names.differentiate(k);
        }
        names
    }

    fn differentiate(&mut self, k: usize) {
        let known = |word: &Word| Some((word.symbol.clone(), word.rates.get(k)?.clone()));
        self.rates
            .push(self.derived.named.iter().filter_map(known).collect());
        for word in &self.derived.named {
            if word.rates.is_empty() {
                let rate = word.value.along(&|symbol| self.rate(symbol, k));
                let name = format!("{}_along_{}", word.symbol.name(), k + 1);
                let symbol =
                    Symbol::new(Role::Intermediate, FIRST_INDEX + self.values.len(), &name);
                self.rates[k].insert(word.symbol.clone(), Expr::symbol(&symbol));
                self.values.push((symbol, rate));
            }
        }
    }

    /// The derivative of a symbol along ϕ_k at ϕ = 0.
    fn rate(&self, symbol: &Symbol, k: usize) -> Expr {
        let coordinates = &self.derived.arguments.configuration;
        match coordinates.iter().position(|known| known == symbol) {
            Some(n) => self.derived.tangent.at(n, k).clone(),
            None => self.rates[k].get(symbol).cloned().unwrap_or_default(),
        }
    }

    /// The derivatives of a column along each ϕ_k at ϕ = 0, beside each other.
    fn along_each(&self, column: &Matrix) -> Matrix {
        let along = |k: usize| {
            let moved = column.map(|entry| entry.along(&|symbol| self.rate(symbol, k)));
            moved.entries().to_vec()
        };
        let columns = (0..self.derived.shape.freedoms).map(along);
        beside(self.derived, column.rows(), columns)
    }

    /// The product with this value, and the names in it.
    fn product(&self, value: Matrix) -> Product {
        let mut used: BTreeSet<Symbol> = value.entries().iter().flat_map(Expr::symbols).collect();
        let mut steps = vec![];
        for (symbol, value) in self.values.iter().rev() {
            if used.contains(symbol) {
                used.extend(value.symbols());
                steps.push(Step::Let(symbol.clone(), value.clone()));
            }
        }
        steps.reverse();
        Product {
            steps,
            value,
            program: OnceCell::new(),
        }
    }
}

/// The derivatives of a column by each of the symbols, beside each other.
fn by_each(derived: &Derived, column: &Matrix, symbols: &[Symbol]) -> Matrix {
    let by = |symbol: &Symbol| column.derivative(symbol).entries().to_vec();
    beside(derived, column.rows(), symbols.iter().map(by))
}

fn beside(derived: &Derived, rows: usize, columns: impl Iterator<Item = Vec<Expr>>) -> Matrix {
    let columns: Vec<Vec<Expr>> = columns.collect();
    let ideal = derived.space.manifold.ideal();
    ideal.simplest_entries(&Matrix::from_columns(rows, &columns))
}
