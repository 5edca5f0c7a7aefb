//! Equality on a manifold: normal forms modulo its relations and those of the functions that occur.

use super::dependence;
use super::quotients::{cleared, quotient_in};
use super::reduction::Reduction;
use super::{angles, canonical};
use crate::expr::{Application, Atom, Expr, Function, Monomial, Rational, Role, Symbol, budget};
use crate::matrix::Matrix;
use rustc_hash::FxHashMap;
use std::cell::{OnceCell, RefCell};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

/// Most term operations that the search for a shorter form of one expression may take.
const SIMPLIFICATION_LIMIT: u64 = 10_000;

/// Most manifolds whose bases are kept.
const MOST_KNOWN: usize = 32;

thread_local! {
    /// Relations of known manifolds with their bases, the last used first.
    static KNOWN: RefCell<VecDeque<(Vec<Expr>, Arc<Reduction>)>> = RefCell::default();
}

/// The ideal of a manifold's relations, with its Gröbner basis.
#[derive(Clone, Debug, Default)]
pub struct Ideal {
    own: Arc<Reduction>,
    /// The relations as they are stated, among which short ones are found sooner than in the basis.
    stated: Arc<[Expr]>,
    /// Where it is that of some of these alone: rules by which to rewrite modulo all of them, found when they are first needed.
    incomplete: Option<OnceCell<Arc<Reduction>>>,
    /// Parameters that are positive, so that the root of their square is the parameter itself.
    positive: BTreeSet<Symbol>,
    /// Parameters that may be 0, by which nothing is divided.
    vanishing: BTreeSet<Symbol>,
    /// Arguments of roots, in normal form, that are squares on the manifold, with what they are squares of, nowhere negative.
    squares: Vec<(Expr, Expr)>,
    /// Bases extended by the relations of the functions that an expression holds, by those functions.
    extended: RefCell<BTreeMap<BTreeSet<Atom>, Arc<Reduction>>>,
    /// Functions with their arguments in normal form.
    settled: RefCell<FxHashMap<Arc<Application>, Expr>>,
}

impl Ideal {
    /// The ideal of the relations.
    pub fn new(relations: &[Expr]) -> Self {
        Self {
            own: Arc::new(Reduction::new(relations)),
            stated: relations.into(),
            ..Self::default()
        }
    }

    /// The ideal of `known` relations alone, where a basis of all would take too long: what vanishes modulo these does so on the manifold, but
    /// of what does not nothing is said. The others rewrite: sums of them, times numbers, vanish.
    pub fn incomplete(known: &[Expr], all: &[Expr]) -> Self {
        Self {
            stated: all.into(),
            incomplete: Some(OnceCell::new()),
            ..Self::new(known)
        }
    }

    /// The ideal of the relations of known factors; its basis is kept for the next manifold of the same.
    pub fn of_known(relations: Vec<Expr>) -> Self {
        let stated = relations.clone().into();
        let own = KNOWN.with_borrow_mut(|known| {
            let place = known.iter().position(|(of, _)| *of == relations);
            let entry = match place.and_then(|place| known.remove(place)) {
                Some(entry) => entry,
                None => {
                    let reduction = Reduction::new(&relations);
                    (relations, Arc::new(reduction))
                }
            };
            let own = entry.1.clone();
            known.push_front(entry);
            known.truncate(MOST_KNOWN);
            own
        });
        Self {
            own,
            stated,
            ..Self::default()
        }
    }

    /// The same ideal where these parameters are known to be positive, and those may be 0.
    #[must_use]
    pub fn with_signs(mut self, positive: BTreeSet<Symbol>, vanishing: BTreeSet<Symbol>) -> Self {
        self.positive = positive;
        self.vanishing = vanishing;
        self.incomplete = self.incomplete.map(|_| OnceCell::new());
        self.extended = RefCell::default();
        self.settled = RefCell::default();
        self
    }

    /// The same ideal where arguments of roots are squares: each with what it is the square of, which is nowhere negative.
    #[must_use]
    pub fn with_squares(mut self, squares: &[(Expr, Expr)]) -> Self {
        let normal = |(argument, root): &(Expr, Expr)| (self.normal_form(argument), root.clone());
        self.squares = squares.iter().map(normal).collect();
        self.extended = RefCell::default();
        self.settled = RefCell::default();
        self
    }

    /// The reduced Gröbner basis of the manifold's own relations.
    pub fn basis(&self) -> &[Expr] {
        self.own.basis()
    }

    /// Whether no configuration satisfies the relations.
    pub fn is_contradictory(&self) -> bool {
        self.own.is_trivial()
    }

    /// The normal form: zero exactly for the expressions that vanish modulo the relations, or modulo those of them that it knows.
    pub fn normal_form(&self, expression: &Expr) -> Expr {
        if expression.related_functions().is_empty() {
            return self.own.normal_form(expression);
        }
        let settled = self.settled(expression);
        let functions = settled.related_functions();
        let known = self.extended.borrow().get(&functions).cloned();
        let reduction = known.unwrap_or_else(|| self.extend(functions));
        reduction.normal_form(&settled)
    }

    /// The expression with the arguments of its functions in normal form, so that functions of equal arguments are equal.
    fn settled(&self, expression: &Expr) -> Expr {
        let changed: BTreeMap<Atom, Expr> = expression
            .atoms()
            .into_iter()
            .filter_map(|atom| {
                let Atom::Apply(application) = &atom else {
                    return None;
                };
                let value = self.settled_function(application);
                (value != Expr::atom(atom.clone())).then_some((atom, value))
            })
            .collect();
        angles::unified(&expression.replace_atoms(&changed))
    }

    /// The function with its arguments in normal form; found once.
    fn settled_function(&self, application: &Arc<Application>) -> Expr {
        if let Some(known) = self.settled.borrow().get(application) {
            return known.clone();
        }
        let value = self.settle_function(application);
        // What is made after the budget is spent means nothing.
        if !budget::is_exhausted() {
            let mut settled = self.settled.borrow_mut();
            settled.insert(application.clone(), value.clone());
        }
        value
    }

    fn settle_function(&self, application: &Application) -> Expr {
        let arguments = application
            .arguments
            .iter()
            .map(|argument| self.normal_form(argument));
        match application.function {
            Function::Group => return arguments.sum(),
            Function::Sqrt => return self.root(&arguments.sum()),
            _ => {}
        }
        Expr::applied(application.function, &arguments.collect::<Vec<_>>())
    }

    /// Whether the expression vanishes on the manifold, wherever it is defined: its numerator has normal form 0.
    pub fn vanishes(&self, expression: &Expr) -> bool {
        let normal = self.normal_form(expression);
        normal.is_zero() || {
            let numerator = self.numerator(&normal);
            let normal = self.normal_form(&numerator);
            normal.is_zero() || self.vanishes_as_stated(&normal) || self.vanishes_by_laws(&normal)
        }
    }

    /// The same by the relations that are no part of the basis, as they are stated.
    fn vanishes_as_stated(&self, numerator: &Expr) -> bool {
        let Some(rules) = &self.incomplete else {
            return false;
        };
        let rules = rules.get_or_init(|| {
            let rules = self.own.with(&[], &self.stated, &self.vanishing);
            Arc::new(rules.in_echelon())
        });
        rules.normal_form(numerator).is_zero()
    }

    /// The same by laws between several functions.
    fn vanishes_by_laws(&self, numerator: &Expr) -> bool {
        let applies = |atom: &Atom| matches!(atom, Atom::Apply(application) if application.function != Function::Pi);
        if numerator
            .atoms()
            .iter()
            .filter(|atom| applies(atom))
            .count()
            == 0
        {
            return false;
        }
        let by_exponentials = self.numerator(&canonical::by_exponentials(numerator));
        let (rewritten, relations) = canonical::rewritten(&by_exponentials, self);
        if rewritten == *numerator && relations.is_empty() {
            return false;
        }
        // New quotients come from exponents and logarithms.
        let rewritten = self.numerator(&rewritten);
        match relations.is_empty() {
            true => self.normal_form(&rewritten).is_zero(),
            false => {
                let functions = rewritten.related_functions();
                let known = relations_of(&functions, |function| function != Function::Recip);
                let all = [known, relations].concat();
                let reduction = self.own.with(&all, &[], &self.vanishing);
                reduction.normal_form(&rewritten).is_zero()
            }
        }
    }

    /// What the expression is the square of, nowhere negative, where that is known.
    pub fn known_root(&self, expression: &Expr) -> Option<Expr> {
        let normal = self.normal_form(expression);
        let number = || Some(Expr::rational(normal.as_rational()?.square_root()?));
        let known = self.squares.iter().find(|(known, _)| *known == normal);
        known.map(|(_, root)| root.clone()).or_else(number)
    }

    /// The expression times all its denominators: it vanishes where the expression does.
    fn numerator(&self, expression: &Expr) -> Expr {
        let mut numerator = self.settled(expression);
        while let Some((atom, denominator)) = quotient_in(&numerator) {
            if budget::is_exhausted() {
                break;
            }
            numerator = cleared(&numerator, &atom, &denominator);
        }
        numerator
    }

    /// The square root: taken where the argument is a known square, or that of positive parameters.
    fn root(&self, argument: &Expr) -> Expr {
        if let Some((_, root)) = self.squares.iter().find(|(known, _)| known == argument) {
            return root.clone();
        }
        let of_square = || {
            let (monomial, coefficient) =
                argument.leading().filter(|_| argument.terms().len() == 1)?;
            let root = Expr::rational(coefficient.clone()).sqrt().as_rational()?;
            monomial
                .units()
                .iter()
                .try_fold(Expr::rational(root), |product, (atom, power)| {
                    let known =
                        matches!(atom, Atom::Symbol(symbol) if self.positive.contains(symbol));
                    let base = Expr::atom(atom.clone());
                    let base = if *power < 0 { base.recip()? } else { base };
                    (known && power % 2 == 0)
                        .then(|| &product * &base.pow(power.unsigned_abs() / 2))
                })
        };
        let is_unit = argument
            .leading()
            .is_some_and(|(monomial, _)| monomial.is_unit());
        is_unit
            .then(of_square)
            .flatten()
            .unwrap_or_else(|| argument.sqrt())
    }

    /// Entry by entry.
    pub fn normal_forms(&self, matrix: &Matrix) -> Matrix {
        matrix.map(|entry| self.normal_form(entry))
    }

    /// The shorter of an expression and its normal form; the expression as it stands where they are alike.
    ///
    /// A normal form with other angles or exponents than the expression has is not taken: y and π/2 − y are as good for a proof, but in doubles
    /// the sine of a small y loses its digits when it is the cosine of the other.
    pub fn simplest(&self, expression: &Expr) -> Expr {
        let normal = budget::scope(SIMPLIFICATION_LIMIT, || self.normal_form(expression));
        match normal {
            Ok(normal)
                if weight(&normal) < weight(expression)
                    && angles_and_exponents(&normal)
                        .is_subset(&angles_and_exponents(expression)) =>
            {
                normal
            }
            _ => expression.clone(),
        }
    }

    /// The relations of the manifold as they are stated, among which short ones are found sooner than in the basis.
    pub(crate) fn stated(&self) -> &[Expr] {
        &self.stated
    }

    /// Entry by entry.
    pub fn simplest_entries(&self, matrix: &Matrix) -> Matrix {
        matrix.map(|entry| self.simplest(entry))
    }

    /// Whether the expressions have no common zero on the manifold, shown by 1, or a function of parameters of which `is_nonzero` says
    /// that it is never 0, being among the combinations of their numerators. Nothing is divided by the `vanishing` parameters, so that
    /// this holds where they are 0, too.
    pub fn has_no_zero_with(
        &self,
        expressions: &[Expr],
        vanishing: &BTreeSet<Symbol>,
        is_nonzero: impl Fn(&Expr) -> bool,
    ) -> bool {
        let numerators: Vec<Expr> = expressions.iter().map(|e| self.numerator(e)).collect();
        let numerators = angles::unified_all(&numerators);
        let functions: BTreeSet<Atom> = numerators
            .iter()
            .flat_map(Expr::related_functions)
            .collect();
        let relations = relations_of(&functions, |function| function != Function::Recip);
        let all = [relations, numerators].concat();
        let own = self.own.relations();
        if own.iter().chain(&all).all(|e| !e.contains_any(vanishing)) {
            let reduction = self.own.with(&all, &[], &BTreeSet::new());
            let mut of_parameters = reduction.relations().into_iter().filter(Expr::is_constant);
            return reduction.is_trivial() || of_parameters.any(|e| is_nonzero(&e));
        }
        let undivided = own
            .into_iter()
            .chain(all)
            .filter(|e| !divides(e, vanishing));
        let polynomials: Vec<Expr> = undivided.map(|e| indeterminate(&e, vanishing)).collect();
        Reduction::new(&polynomials).is_trivial()
    }

    /// The coefficients, from that of degree 0 on, of a polynomial in one stored scalar that vanishes wherever the expressions do on the
    /// manifold: functions of parameters, not all 0. `None` where there is none of that degree or less, or functions occur.
    pub fn in_one_scalar(
        &self,
        expressions: &[Expr],
        scalar: &Symbol,
        degree: usize,
    ) -> Option<Vec<Expr>> {
        let numerators: Vec<Expr> = expressions.iter().map(|e| self.numerator(e)).collect();
        let polynomial = |e: &Expr| e.related_functions().is_empty();
        if !numerators.iter().all(polynomial) {
            return None;
        }
        let reduction = self.own.with(&numerators, &[], &BTreeSet::new());
        let scalar = Expr::symbol(scalar);
        let mut power = Expr::one();
        let mut rows: Vec<dependence::Row> = vec![];
        for n in 0..=degree {
            let normal = reduction.normal_form(&power);
            if let Some(found) = dependence::add(&mut rows, &normal, n) {
                return Some(found);
            }
            power = &normal * &scalar;
        }
        None
    }

    /// Whether its basis holds where those parameters are 0, too: whether it follows from the relations without division by them.
    pub fn follows_undivided(&self, relations: &[Expr], vanishing: &BTreeSet<Symbol>) -> bool {
        if self.incomplete.is_some() {
            // Those of known factors hold no parameters.
            return true;
        }
        let free = |e: &Expr| indeterminate(e, vanishing);
        let undivided = Self::new(&relations.iter().map(free).collect::<Vec<_>>());
        let mut basis = self.own.relations().into_iter();
        basis.all(|e| !divides(&e, vanishing) && undivided.vanishes(&free(&e)))
    }

    /// Sines and roots complete the basis; quotients only rewrite, since their completion grows.
    fn extend(&self, functions: BTreeSet<Atom>) -> Arc<Reduction> {
        let relations = relations_of(&functions, |function| function != Function::Recip);
        let rules = relations_of(&functions, |function| function == Function::Recip);
        let reduction = self.own.with(&relations, &rules, &self.vanishing);
        let reduction = Arc::new(reduction);
        if !budget::is_exhausted() {
            let mut extended = self.extended.borrow_mut();
            extended.insert(functions, reduction.clone());
        }
        reduction
    }
}

/// The expression with the parameters as indeterminates, which may be 0.
fn indeterminate(expression: &Expr, parameters: &BTreeSet<Symbol>) -> Expr {
    let stand_in = |symbol: &Symbol| {
        let name = format!("{}_or_zero", symbol.name());
        Expr::symbol(&Symbol::new(Role::Constant, symbol.index.into(), &name))
    };
    let values = parameters.iter().map(|p| (p.clone(), stand_in(p)));
    expression.substitute(&values.collect())
}

/// Whether a term of the polynomial is divided by one of the parameters.
fn divides(expression: &Expr, parameters: &BTreeSet<Symbol>) -> bool {
    let mut factors = expression
        .terms()
        .flat_map(|(monomial, _)| monomial.units());
    factors.any(
        |(atom, power)| matches!(atom, Atom::Symbol(s) if *power < 0 && parameters.contains(s)),
    )
}

/// The relations of those functions that are wanted, each once.
fn relations_of(functions: &BTreeSet<Atom>, wanted: impl Fn(Function) -> bool) -> Vec<Expr> {
    let mut relations: Vec<Expr> = vec![];
    for atom in functions {
        let Atom::Apply(application) = atom else {
            continue;
        };
        if wanted(application.function) {
            let found = Expr::atom(atom.clone()).atom_relations();
            relations.extend(
                found
                    .into_iter()
                    .filter(|r| !relations.contains(r))
                    .collect::<Vec<_>>(),
            );
        }
    }
    relations
}

/// The angles and exponents of sines, cosines, exponentials and hyperbolic functions.
fn angles_and_exponents(expression: &Expr) -> BTreeSet<Expr> {
    let algebraic = [Function::Sqrt, Function::Recip, Function::Group];
    let argument = |atom: &Atom| match atom {
        Atom::Apply(application) if !algebraic.contains(&application.function) => {
            application.arguments.first().cloned()
        }
        _ => None,
    };
    let functions = expression.related_functions();
    functions.iter().filter_map(argument).collect()
}

/// Number of operations to write the expression as it stands, each function of it once.
pub(crate) fn weight(expression: &Expr) -> usize {
    let of_term = |(monomial, _): (&Monomial, &Rational)| {
        let powers = monomial
            .factors()
            .map(|(_, power)| power.unsigned_abs() as usize);
        1 + powers.sum::<usize>()
    };
    let functions = expression
        .atoms()
        .into_iter()
        .filter_map(|atom| match atom {
            Atom::Apply(application) => {
                Some(application.arguments.iter().map(weight).sum::<usize>())
            }
            Atom::Symbol(_) => None,
        });
    expression.terms().map(of_term).sum::<usize>() + functions.sum::<usize>()
}
