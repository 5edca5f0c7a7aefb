//! The indeterminates of the polynomial ring: symbols, and functions applied to expressions.

use super::Expr;
use super::curve::Curve;
use rustc_hash::FxHasher;
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::hash::{Hash, Hasher};
use std::sync::Arc;

/// What a symbol stands for. The order of the variants is the order of elimination: later ones are larger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// A parameter of the joint: an element of the field of coefficients, never zero.
    Parameter,
    /// A parameter, or its inverse, that is an indeterminate: see `manifold::Reduction`.
    Constant,
    /// A stored scalar of the configuration Q.
    Coordinate,
    /// A stored scalar of a second configuration Q′.
    Target,
    /// A local coordinate ϕ.
    Local,
    /// A displacement ξ of Q in the group in which a manifold of relations lies: Q′ = Q exp(ξ).
    Displacement,
    /// A joint velocity v.
    Velocity,
    /// A speed v̄.
    Speed,
    /// A momentum p.
    Momentum,
    /// A momentum wrench h.
    Wrench,
    /// A parameter of a spatial inertia.
    Inertia,
    /// An intermediate value of a kernel.
    Intermediate,
}

/// A named indeterminate.
#[derive(Clone, Debug)]
pub struct Symbol {
    /// What it stands for.
    pub role: Role,
    /// Position among the symbols of its role.
    pub index: u16,
    names: Arc<Names>,
}

/// What a symbol is called.
#[derive(Debug)]
struct Names {
    name: String,
    /// In the spec, where that writes it in another way.
    spelling: Option<String>,
}

impl Symbol {
    /// The symbol `name`, number `index` of its role.
    pub fn new(role: Role, index: usize, name: &str) -> Self {
        Self {
            role,
            index: u16::try_from(index).unwrap_or(u16::MAX),
            names: Arc::new(Names {
                name: name.to_owned(),
                spelling: None,
            }),
        }
    }

    /// Name, an ASCII Rust identifier.
    pub fn name(&self) -> &str {
        &self.names.name
    }

    /// How the spec writes it: `Q[1, 2]`, `phi.turn`. The name for what no spec writes.
    pub fn spelling(&self) -> &str {
        self.names.spelling.as_deref().unwrap_or(self.name())
    }

    /// The same symbol, which the spec writes so.
    #[must_use]
    pub fn spelled(self, spelling: &str) -> Self {
        Self {
            names: Arc::new(Names {
                name: self.name().to_owned(),
                spelling: Some(spelling.to_owned()),
            }),
            ..self
        }
    }

    /// The symbols `prefix1 … prefixN` of one role.
    pub fn series(role: Role, prefix: &str, count: usize) -> Vec<Self> {
        (0..count)
            .map(|i| Self::new(role, i, &format!("{prefix}{}", i + 1)))
            .collect()
    }
}

impl PartialEq for Symbol {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Symbol {}

impl PartialOrd for Symbol {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Symbol {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.role, self.index)
            .cmp(&(other.role, other.index))
            .then_with(|| match Arc::ptr_eq(&self.names, &other.names) {
                true => Ordering::Equal,
                false => self.name().cmp(other.name()),
            })
    }
}

impl Hash for Symbol {
    fn hash<H: Hasher>(&self, state: &mut H) {
        // Names differ where these do not only between joints.
        (self.role, self.index).hash(state);
    }
}

/// A function that is an indeterminate of its own, with a relation or a derivative that the ring knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Function {
    /// The circle constant; no arguments.
    Pi,
    /// Cosine.
    Cos,
    /// Sine.
    Sin,
    /// Exponential function.
    Exp,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic secant, the reciprocal of the hyperbolic cosine.
    Sech,
    /// Hyperbolic tangent.
    Tanh,
    /// Logarithm of the hyperbolic cosine.
    LnCosh,
    /// Natural logarithm.
    Ln,
    /// `ln(1 + x e^m)` of x and m ≥ 0: in formulas as they are written only, where a sum would lose the digits of a small x, or overflow.
    Ln1p,
    /// The larger of two numbers: in formulas as they are written only, as a scale on which the value does not depend, so that its rate
    /// counts as 0.
    Larger,
    /// `atan2(y, x)`.
    Atan2,
    /// Square root.
    Sqrt,
    /// Stumpff function `c_k`.
    Stumpff(u8),
    /// `n`-th derivative of the coefficient of `ad²` in `dexp⁻¹`.
    DexpInverse(u8),
    /// A curve of the spec, or its derivative of this order.
    Curve(Curve, u8),
    /// Reciprocal.
    Recip,
    /// The identity: a sum that is kept together, so that products with it are not multiplied out.
    Group,
}

/// A function with its arguments.
#[derive(Clone, Debug)]
pub struct Application {
    /// The function.
    pub function: Function,
    /// Its arguments, in normal form of the ring without relations.
    pub arguments: Vec<Expr>,
    hash: u64,
    symbols: BTreeSet<Symbol>,
    related: BTreeSet<Atom>,
}

impl Application {
    /// The function to look for: what is known of its arguments is found by [`Application::complete`].
    pub(super) fn new(function: Function, arguments: Vec<Expr>) -> Self {
        let mut hasher = FxHasher::default();
        (function, &arguments).hash(&mut hasher);
        Self {
            function,
            arguments,
            hash: hasher.finish(),
            symbols: BTreeSet::new(),
            related: BTreeSet::new(),
        }
    }

    /// The same with what is asked of it often.
    pub(super) fn complete(mut self) -> Self {
        self.symbols = self.arguments.iter().flat_map(Expr::symbols).collect();
        let related = self.arguments.iter().flat_map(Expr::related_functions);
        self.related = related.collect();
        self
    }

    /// A number that is the same for equal functions.
    pub(super) fn hash(&self) -> u64 {
        self.hash
    }

    /// All symbols in its arguments, those inside functions included.
    pub fn symbols(&self) -> &BTreeSet<Symbol> {
        &self.symbols
    }

    /// The functions with relations in its arguments: see [`Expr::related_functions`].
    pub(super) fn related(&self) -> &BTreeSet<Atom> {
        &self.related
    }
}

impl PartialEq for Application {
    fn eq(&self, other: &Self) -> bool {
        self.hash == other.hash
            && self.function == other.function
            && self.arguments == other.arguments
    }
}

impl Eq for Application {}

impl PartialOrd for Application {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Application {
    fn cmp(&self, other: &Self) -> Ordering {
        (self.function.cmp(&other.function)).then_with(|| self.arguments.cmp(&other.arguments))
    }
}

impl Hash for Application {
    fn hash<H: Hasher>(&self, state: &mut H) {
        state.write_u64(self.hash);
    }
}

/// An indeterminate. Symbols stand before functions.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Atom {
    /// A symbol.
    Symbol(Symbol),
    /// A function applied to expressions.
    Apply(Arc<Application>),
}

impl PartialOrd for Atom {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Atom {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Symbol(a), Self::Symbol(b)) => a.cmp(b),
            (Self::Symbol(_), Self::Apply(_)) => Ordering::Less,
            (Self::Apply(_), Self::Symbol(_)) => Ordering::Greater,
            // Equal arguments are mostly one object: comparing nested ones entry by entry is felt.
            (Self::Apply(a), Self::Apply(b)) if Arc::ptr_eq(a, b) => Ordering::Equal,
            (Self::Apply(a), Self::Apply(b)) => a.cmp(b),
        }
    }
}

impl Atom {
    /// Whether this is an invertible constant of the field of coefficients: a parameter or π.
    pub fn is_unit(&self) -> bool {
        match self {
            Self::Symbol(symbol) => symbol.role == Role::Parameter,
            Self::Apply(application) => application.function == Function::Pi,
        }
    }
}
