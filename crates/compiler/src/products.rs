//! What the derivatives of a scene's equations need of a joint type beyond its kernels: products of them and their derivatives along ϕ, in
//! symbols, so that they are simplified modulo the joint's relations.
//!
//! The runtime forms the same products in numbers: `hamel_runtime::joint::Products`.

use hamel_codegen::WORK_LIMIT;
use hamel_codegen::derived::{Derived, KernelKind};
use hamel_codegen::expr::budget::{self, Exhausted};
use hamel_codegen::expr::{Expr, Symbol};
use hamel_codegen::formula::Program;
use hamel_codegen::matrix::Matrix;
use std::cell::OnceCell;
use std::rc::Rc;

/// One product: its value, and its formulas once something asks for them.
#[derive(Clone, Debug)]
pub struct Product {
    /// Its value.
    pub value: Matrix,
    program: OnceCell<Program>,
}

impl Product {
    fn new(value: Matrix) -> Self {
        Self {
            value,
            program: OnceCell::new(),
        }
    }
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
        })
    }

    /// The formulas of one of its products, in its own names.
    pub fn program<'a>(&self, product: &'a Product) -> &'a Program {
        let value = std::slice::from_ref(&product.value);
        let formulas = || Program::in_names(&[], value, self.derived.names());
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
        let bias = bias.and_then(|kernel| kernel.expanded().into_iter().next());
        let bias = bias.unwrap_or_else(|| Matrix::zeros(6, 1));
        let along = |column: &Matrix| Product::new(along_each(derived, column));
        Self {
            local_twist_map: Product::new(derived.local_twist_map.clone()),
            twist_gradient: along(&map.times(&speeds)),
            effort_gradient: along(&map.transpose().times(&wrench)),
            bias_acceleration_gradient: along(&bias),
            bias_acceleration_slope: Product::new(by_each(derived, &bias, &arguments.speeds)),
        }
    }
}

/// The derivatives of a column along each ϕ_k at ϕ = 0, beside each other.
fn along_each(derived: &Derived, column: &Matrix) -> Matrix {
    let coordinates = &derived.arguments.configuration;
    let along = |k: usize| {
        let rate = |symbol: &Symbol| match coordinates.iter().position(|known| known == symbol) {
            Some(n) => derived.tangent.at(n, k).clone(),
            None => Expr::zero(),
        };
        column.map(|entry| entry.along(&rate)).entries().to_vec()
    };
    beside(
        derived,
        column.rows(),
        (0..derived.shape.freedoms).map(along),
    )
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
