//! Where a joint lives, and what cannot vanish there.
//!
//! A rank or an inverse needs functions that have no common zero: on the manifold, for every admissible value of the
//! parameters, away from the loci that the spec excepts. Random points never show that. A certificate does: a constant, a sum of
//! positive terms, or 1 as a combination of the functions and the relations.

mod constant;
mod critical;
mod factors;
mod harmonics;
mod parallel;
mod quadratics;
mod roots;
mod sign;
mod squares;
mod subdivision;
mod unit_vectors;
mod univariate;

pub use self::constant::{ConstantSign, LAST_PRECISION, sign as sign_of_constant};
pub use self::critical::{Critical, Smooth};
pub use self::sign::{positive_parameters, vanishing_parameters};
pub use self::squares::squares;

use self::sign::Signs;
use crate::expr::{Atom, Expr, Function, Monomial, Rational, Role, Symbol, budget};
use crate::manifold::{Ideal, cleared_by_squares, unified_all};
use crate::matrix::combinations;
use crate::model::ConfigurationSpace;
use num_traits::One;
use std::collections::{BTreeMap, BTreeSet};

/// Most term operations that one search for a certificate may take.
const CERTIFICATE_LIMIT: u64 = 60_000;

/// Most loci of which products are formed.
const MOST_LOCI_IN_PRODUCTS: usize = 4;

/// The manifold without the loci, and what is known of signs on it.
#[derive(Clone, Debug)]
pub struct Domain<'a> {
    ideal: &'a Ideal,
    loci: Vec<Expr>,
    signs: Signs,
    /// Parameters of which the range holds 0.
    vanishing: BTreeSet<Symbol>,
    /// The stored scalars at home.
    home: BTreeMap<Symbol, Expr>,
    /// Whether the manifold, loci included, is known to be connected.
    connected: bool,
    /// The relations that the spec declares.
    declared: &'a [Expr],
    /// Unit vectors of the plane in Q.
    circles: Vec<parallel::Circle>,
    /// Further polynomials that are 0, of symbols that are no scalars of Q.
    known: Vec<Expr>,
}

/// Why some functions have no common zero.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Certificate {
    /// One of them is a constant that is not zero.
    Constant(Expr),
    /// One of them is a sum of positive terms, or bounded away from zero.
    Positive(Expr),
    /// With the relations they generate a polynomial in one scalar that has no zero where that scalar lies.
    OneScalar {
        /// How many functions there are.
        functions: usize,
    },
    /// Where they vanish, unit vectors are parallel, which contradicts the relations.
    Parallel {
        /// How many functions there are.
        functions: usize,
    },
    /// They and the relations generate 1.
    NoCommonZero {
        /// How many functions there are.
        functions: usize,
        /// Whether the loci were needed.
        except: bool,
    },
}

impl Certificate {
    /// Whether it holds on the loci, too.
    fn holds_on_loci(&self) -> bool {
        !matches!(self, Self::NoCommonZero { except: true, .. })
    }
}

impl std::fmt::Display for Certificate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Constant(value) => write!(f, "= {value}"),
            Self::Positive(value) => write!(f, "= {value}, which is of one sign"),
            Self::OneScalar { functions } => {
                let what = number(*functions);
                write!(
                    f,
                    "where {what} vanished, so would a polynomial in one scalar between −1 and 1, and it has no zero there"
                )
            }
            Self::Parallel { functions } => write!(
                f,
                "where {} vanished, unit vectors would be parallel, which contradicts the relations whatever their signs",
                number(*functions)
            ),
            Self::NoCommonZero { functions, except } => {
                let what = number(*functions);
                let where_it_holds = if *except {
                    " away from the declared loci"
                } else {
                    ""
                };
                write!(
                    f,
                    "{what} and the manifold's relations generate 1{where_it_holds}"
                )
            }
        }
    }
}

/// So many functions, in words.
fn number(functions: usize) -> String {
    match functions {
        1 => "it".to_owned(),
        count => format!("{count} functions"),
    }
}

impl<'a> Domain<'a> {
    /// The domain of a joint.
    pub fn new(space: &'a ConfigurationSpace) -> Self {
        Self {
            ideal: space.manifold.ideal(),
            loci: space
                .loci
                .iter()
                .map(|locus| locus.value.function.clone())
                .collect(),
            signs: Signs::new(space),
            vanishing: vanishing_parameters(&space.parameters),
            home: space.home_values(),
            connected: space.manifold.declared().is_empty(),
            declared: space.manifold.declared(),
            circles: unit_vectors::circles(space.manifold.factors()),
            known: vec![],
        }
    }

    /// The same where symbols that are no scalars of Q solve these equations.
    #[must_use]
    pub fn knowing(&self, known: Vec<Expr>) -> Self {
        Self {
            known,
            ..self.clone()
        }
    }

    /// Equality on the manifold.
    pub fn ideal(&self) -> &'a Ideal {
        self.ideal
    }

    /// A certificate that the expressions have no common zero; `None` where none was found.
    pub fn no_common_zero(&self, expressions: &[Expr]) -> Option<Certificate> {
        budget::scope(CERTIFICATE_LIMIT, || self.search(expressions))
            .ok()
            .flatten()
    }

    /// A certificate that the expression has no zero.
    pub fn nonzero(&self, expression: &Expr) -> Option<Certificate> {
        self.no_common_zero(std::slice::from_ref(expression))
    }

    /// Whether the expression is one term of a rational and parameters that are never 0.
    pub fn is_unit(&self, e: &Expr) -> bool {
        e.is_unit() && !e.contains_any(&self.vanishing)
    }

    /// Whether no parameter that may be 0 stands in a denominator.
    fn is_finite_at_zeros(&self, expression: &Expr) -> bool {
        let mut units = expression
            .terms()
            .flat_map(|(monomial, _)| monomial.units());
        units.all(|(atom, power)| {
            let vanishes = matches!(atom, Atom::Symbol(symbol) if self.vanishing.contains(symbol));
            *power > 0 || !vanishes
        })
    }

    /// Whether another form of a short expression shows that it is positive.
    pub(super) fn has_positive_form(&self, expression: &Expr) -> bool {
        self.signs.has_positive_form(expression)
    }

    /// Whether the expression is positive everywhere.
    pub fn is_positive(&self, expression: &Expr) -> bool {
        let normal = self.ideal.normal_form(expression);
        let has_sign = |e: &Expr| self.signs.is_positive(e) || self.signs.is_positive(&-e);
        self.signs.is_positive(expression)
            || self.signs.is_positive(&normal)
            || [expression, &normal]
                .iter()
                .any(|e| e.polynomial_root().is_some_and(|root| has_sign(&root)))
            || self.is_positive_in_one_scalar(expression)
            || self.signs.is_positive_on_cells(&normal)
    }

    /// Whether the expression, without its quotients, is a positive polynomial in one scalar between −1 and 1.
    fn is_positive_in_one_scalar(&self, expression: &Expr) -> bool {
        let numerator = || self.ideal.normal_form(&cleared_by_squares(expression));
        let sign = |e: &Expr| self.signs.of(e);
        let found = budget::scope(CERTIFICATE_LIMIT, || {
            univariate::sign_of(&numerator(), self.signs.bounded(), sign)
        });
        found.ok().flatten() == Some(true)
    }

    /// Constants of which no number of bits decided the sign.
    pub fn undecided(&self) -> Vec<Expr> {
        let mut constants = self.signs.undecided();
        // What is 0 by the laws of its functions needs no sign.
        constants.retain(|constant| !self.ideal.vanishes(constant));
        constants
    }

    /// Whether the expression is negative nowhere.
    pub fn is_not_negative(&self, expression: &Expr) -> bool {
        let normal = self.ideal.normal_form(expression);
        let by_terms =
            self.signs.is_not_negative(expression) || self.signs.is_not_negative(&normal);
        by_terms || self.ideal.known_root(&normal).is_some()
    }

    /// Whether no parameter that may be 0 is a factor of the only term.
    fn has_unit_factor(&self, expression: &Expr) -> bool {
        let mut units = expression
            .terms()
            .flat_map(|(monomial, _)| monomial.units());
        units.all(|(atom, _)| !matches!(atom, Atom::Symbol(s) if self.vanishing.contains(s)))
    }

    /// Whether it is the product of some of the loci's functions on the manifold, apart from a factor of parameters that is never 0.
    fn is_product_of_loci(&self, expression: &Expr) -> bool {
        let normal = |e: &Expr| {
            let normal = self.ideal.normal_form(e);
            let (monomial, coefficient) = normal.leading()?;
            let unit = Expr::term(coefficient.clone(), monomial.split().1);
            let inverse = unit.recip().filter(|_| self.is_unit(&unit))?;
            Some(&normal * &inverse)
        };
        let count = self.loci.len().min(MOST_LOCI_IN_PRODUCTS);
        let mut choices = (1..=count).flat_map(|size| combinations(count, size));
        let Some(own) = normal(expression) else {
            return false;
        };
        choices.any(|chosen| {
            let factors = chosen.iter().map(|&n| &self.loci[n]);
            let product = factors.fold(Expr::one(), |product, locus| &product * locus);
            normal(&product).as_ref() == Some(&own)
        })
    }

    /// Whether the functions have no common zero because unit vectors would be parallel there.
    fn are_parallel_nowhere(&self, functions: &[Expr]) -> bool {
        let conditions = self.signs.positive_conditions();
        let roots = conditions.flat_map(|e| [Some(e.clone()), e.polynomial_root()]);
        let roots: Vec<Expr> = roots.flatten().collect();
        let is_never_zero = |e: &Expr| {
            let rest = factors::without(e, &roots);
            self.is_unit(&rest) || self.signs.is_positive(&rest) || self.signs.is_positive(&-&rest)
        };
        parallel::is_excluded(functions, self.declared, &self.circles, is_never_zero)
    }

    /// Looks for a certificate with one base angle in all that is compared: `cos 2x` in a locus is `2 cos² x − 1` beside `cos x`.
    fn search(&self, expressions: &[Expr]) -> Option<Certificate> {
        if self.loci.is_empty() {
            return self.found(expressions);
        }
        let all = [expressions, &self.loci].concat();
        let all = unified_all(&all);
        let (expressions, loci) = all.split_at(expressions.len());
        match loci == self.loci {
            true => self.found(expressions),
            false => {
                let unified = Self {
                    loci: loci.to_vec(),
                    ..self.clone()
                };
                unified.found(expressions)
            }
        }
    }

    /// [`Domain::search`] of expressions as they stand.
    fn found(&self, expressions: &[Expr]) -> Option<Certificate> {
        let normal = |e: &Expr| self.ideal.normal_form(e);
        let all: Vec<Expr> = expressions
            .iter()
            .map(normal)
            .filter(|e| !e.is_zero())
            .collect();
        if let Some(unit) = all.iter().find(|e| self.is_unit(e)) {
            return Some(Certificate::Constant(unit.clone()));
        }
        let functions = all.len();
        let written: Vec<Expr> = self.loci.iter().map(normal).collect();
        let beside_loci = |e: &Expr| factors::without(e, self.loci.iter().chain(&written));
        // The least work: what follows may take more than it is given.
        let is_of_loci = |e: &Expr| self.is_unit(&beside_loci(e)) || self.is_product_of_loci(e);
        if !self.loci.is_empty() && all.iter().any(is_of_loci) {
            return Some(Certificate::NoCommonZero {
                functions,
                except: true,
            });
        }
        if self.are_parallel_nowhere(expressions) {
            return Some(Certificate::Parallel { functions });
        }
        let of_one_sign = |e: &&Expr| self.signs.is_positive(e) || self.signs.is_positive(&-*e);
        // On a manifold of relations sums have no sign that their terms show, and to look for one takes long.
        let bounded = self.signs.bounded();
        let sign = |e: &Expr| self.signs.of(e);
        let alone = |e: &Expr| univariate::is_never_zero(self.ideal, e, bounded, sign);
        if self.vanishing.is_empty() && !self.connected && all.iter().any(alone) {
            return Some(Certificate::OneScalar { functions });
        }
        if let Some(signed) = expressions.iter().chain(&all).find(of_one_sign) {
            return Some(Certificate::Positive(signed.clone()));
        }
        let conditions = || self.signs.positive_conditions();
        let essential = |e: &Expr| {
            let rest = factors::without(&factors::vanishing_arguments(e), conditions());
            let rest = match factors::content(&rest) {
                Some((content, rest)) if of_one_sign(&&content) => rest,
                _ => rest,
            };
            rest.polynomial_root().unwrap_or(rest)
        };
        let mut generators: Vec<Expr> = all.iter().map(essential).collect();
        let never_zero = |e: &&Expr| self.is_unit(e) || of_one_sign(e);
        if let Some(found) = generators.iter().position(|e| never_zero(&e)) {
            return Some(Certificate::Positive(all[found].clone()));
        }
        let is_beside_loci = |e: &Expr| never_zero(&&beside_loci(e));
        // What divides a locus vanishes there alone, unless the quotient is infinite where a parameter is 0.
        let divides_locus = |e: &Expr| {
            let quotients = self.loci.iter().chain(&written);
            let mut quotients = quotients.filter_map(|locus| locus.exact_quotient(e));
            quotients.any(|quotient| self.is_finite_at_zeros(&quotient))
        };
        let mut as_written = expressions.iter().chain(&all);
        if generators.iter().any(is_beside_loci) || as_written.any(divides_locus) {
            return Some(Certificate::NoCommonZero {
                functions,
                except: true,
            });
        }
        let under_root = |e: &Expr| under_root(e).filter(|_| self.has_unit_factor(e));
        let under_roots: Vec<Expr> = expressions.iter().filter_map(under_root).collect();
        generators.extend(under_roots.iter().cloned());
        // A sum of terms that are never negative vanishes only where each of them does.
        for e in expressions.iter().chain(&all).chain(&under_roots) {
            generators.extend(self.signs.zero_terms(e).into_iter().flatten());
        }
        generators.extend(self.known.iter().cloned());
        let found = |except| Some(Certificate::NoCommonZero { functions, except });
        let has_no_zero = |generators: &[Expr]| {
            let has_sign = |e: &Expr| of_one_sign(&e);
            let ideal = self.ideal;
            ideal.has_no_zero_with(generators, &self.vanishing, has_sign)
        };
        if functions > 0 && has_no_zero(&generators) {
            return found(false);
        }
        let essential = generators.clone();
        generators.extend(self.loci.iter().enumerate().map(away_from));
        if !self.loci.is_empty() && has_no_zero(&generators) {
            return found(true);
        }
        if functions > 0
            && self.vanishing.is_empty()
            && univariate::exclude(self.ideal, &essential, bounded, sign)
        {
            return Some(Certificate::OneScalar { functions });
        }
        let on_cells =
            |e: &&Expr| self.signs.is_positive_on_cells(e) || self.signs.is_positive_on_cells(&-*e);
        all.iter()
            .find(on_cells)
            .cloned()
            .map(Certificate::Positive)
    }
}

/// The argument of the root, where the expression is a constant times powers of one: both vanish together.
fn under_root(expression: &Expr) -> Option<Expr> {
    let (monomial, _) = expression
        .leading()
        .filter(|_| expression.terms().len() == 1)?;
    match monomial.main() {
        [(Atom::Apply(application), _)] if application.function == Function::Sqrt => {
            application.arguments.first().cloned()
        }
        _ => None,
    }
}

/// `1 − t g`: has a solution t exactly where g is not 0.
fn away_from((index, locus): (usize, &Expr)) -> Expr {
    let t = Symbol::new(Role::Intermediate, index, "inverse_of_locus");
    &Expr::one() - &(&Expr::symbol(&t) * locus)
}

/// The expression of one monomial.
fn of_monomial(monomial: Monomial) -> Expr {
    Expr::term(Rational::one(), monomial)
}
