//! The author's names: `let`s of the spec and their derivatives, as values that kernels are made of.

use super::shortened;
use crate::expand::{Expansion, Motion};
use crate::expr::{Application, Atom, Expr, Function, Monomial, Role, Symbol, budget};
use crate::kernel::Word;
use crate::manifold::{Ideal, weight};
use crate::matrix::Matrix;
use crate::prepare::Prepared;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// First index of the symbols made here, above those of `let`s.
const FIRST_INDEX: usize = 0x6000;

/// Most term operations for shortening one expression.
const LIMIT: u64 = 20_000;

/// Derivatives, by what they are of and along which degrees of freedom, to their numbers.
type Numbers = BTreeMap<(Symbol, Vec<usize>), usize>;

/// The words of a joint.
#[derive(Clone)]
pub struct Words<'a> {
    ideal: &'a Ideal,
    motion: &'a Motion,
    freedoms: Vec<&'a str>,
    words: Vec<Word>,
    /// How many of them are those in which B was derived: the first.
    derived_in: usize,
    /// Shared between copies, so that a symbol means one value in every kernel.
    numbers: Rc<RefCell<Numbers>>,
    /// Functions that are words themselves.
    functions: BTreeMap<Atom, Symbol>,
    /// Word and direction to the derivative.
    derivatives: BTreeMap<(Symbol, usize), Expr>,
    /// `word − value`.
    definitions: Vec<(Symbol, Expr)>,
    /// Short forms that were found.
    found: RefCell<BTreeMap<Expr, Expr>>,
    /// Whether expressions stay as they were derived: sums of exponentials are scaled as a whole where they are written, which neither
    /// names nor relations between them may come between.
    as_derived: bool,
}

impl<'a> Words<'a> {
    /// The `let`s of the joint.spec, and the names in which B was derived.
    pub fn new(joint: &'a Prepared, expansion: &'a Expansion) -> Self {
        let motion = &expansion.motion;
        let freedoms = joint.spec.freedoms.value.iter();
        let mut words = Self {
            ideal: joint.space.manifold.ideal(),
            motion,
            freedoms: freedoms.map(|freedom| freedom.name.as_str()).collect(),
            words: vec![],
            derived_in: expansion.named().len(),
            numbers: Rc::default(),
            functions: BTreeMap::new(),
            derivatives: BTreeMap::new(),
            definitions: vec![],
            found: RefCell::default(),
            as_derived: has_exponentials(joint),
        };
        for word in expansion.named() {
            let mut word = word.clone();
            word.value = words.shorten(&word.value);
            if word.value.is_plain() {
                let count = word.rates.len();
                word.rates = (0..count).map(|k| motion.along(&word.value, k)).collect();
            }
            words.words.push(word);
        }
        if words.as_derived {
            return words;
        }
        for named in &joint.spec.worded.named {
            words.declare(&named.symbol, &named.value);
        }
        words
    }

    /// No words but those in which B was derived: expressions stay as they were.
    pub fn without_names(&self) -> Self {
        let derived = self.words.iter().take(self.derived_in);
        Self {
            words: derived.cloned().collect(),
            functions: BTreeMap::new(),
            derivatives: BTreeMap::new(),
            definitions: vec![],
            found: RefCell::default(),
            as_derived: true,
            ..self.clone()
        }
    }

    /// These words, of which only those that are functions are looked for.
    pub fn functions_alone(&self) -> Self {
        let declared = self.words.iter().filter(|word| !word.is_derivative());
        Self {
            words: declared.cloned().collect(),
            definitions: vec![],
            derivatives: BTreeMap::new(),
            found: RefCell::default(),
            ..self.clone()
        }
    }

    /// Makes a `let` a word.
    fn declare(&mut self, symbol: &Symbol, value: &Expr) {
        let value = self.shorten(value);
        self.push(symbol.clone(), symbol, vec![], value.clone());
        match single_function(&value) {
            Some(atom) => _ = self.functions.insert(atom, symbol.clone()),
            None => self.define(symbol),
        }
    }

    /// Makes the word known as what its value is, in the words before it and in none.
    fn define(&mut self, symbol: &Symbol) {
        let word = self.words.iter().find(|word| word.symbol == *symbol);
        let value = word
            .map(|word| self.unnamed(&word.value))
            .unwrap_or_default();
        let full = self.unnamed(&self.full(symbol));
        let itself = Expr::symbol(symbol);
        if full != value {
            self.definitions.push((symbol.clone(), &itself - &full));
        }
        self.definitions.push((symbol.clone(), &itself - &value));
    }

    fn add(&mut self, base: &Symbol, along: Vec<usize>, value: Expr) -> Symbol {
        let number = self.number(base, &along);
        let symbol = Symbol::new(Role::Intermediate, number, &self.name(base.name(), &along));
        self.push(symbol.clone(), base, along, value);
        symbol
    }

    fn number(&self, base: &Symbol, along: &[usize]) -> usize {
        let mut numbers = self.numbers.borrow_mut();
        let next = FIRST_INDEX + numbers.len();
        let key = (base.clone(), along.to_vec());
        *numbers.entry(key).or_insert(next)
    }

    fn push(&mut self, symbol: Symbol, base: &Symbol, along: Vec<usize>, value: Expr) {
        // What was short before may be shorter in the new word.
        self.found.get_mut().clear();
        self.words.push(Word {
            symbol,
            value,
            along,
            base: base.clone(),
            rates: vec![],
        });
    }

    /// `lean`, `d_lean_d_wx`, `d2_lean_d_wx_d_wy`.
    fn name(&self, base: &str, along: &[usize]) -> String {
        let order = match along.len() {
            0 => return base.to_owned(),
            1 => String::new(),
            order => order.to_string(),
        };
        let directions = along.iter().map(|&k| format!("_d_{}", self.freedoms[k]));
        format!("d{order}_{base}{}", directions.collect::<String>())
    }

    /// Names the derivatives of the words that a function of Q is made of, so that its own derivatives are found to be made of them.
    pub fn name_derivatives(&mut self, function: &Matrix) {
        let used: BTreeSet<Symbol> = function.entries().iter().flat_map(Expr::symbols).collect();
        let words = self.words.iter().enumerate();
        let used: Vec<usize> = words
            .filter(|(_, word)| used.contains(&word.symbol))
            .map(|(n, _)| n)
            .collect();
        for n in used {
            for k in 0..self.freedoms.len() {
                self.derivative(n, k);
            }
        }
    }

    /// The expression with every word replaced by its value, except for those in which B was derived: what holds for any values of them holds.
    fn expanded(&self, expression: &Expr) -> Expr {
        let mut value = expression.clone();
        for word in self.words.iter().skip(self.derived_in).rev() {
            if value.contains(&word.symbol) {
                let values = BTreeMap::from([(word.symbol.clone(), word.value.clone())]);
                value = value.substitute(&values);
            }
        }
        value
    }

    /// Whether the short form has the value of the expression on the manifold.
    fn is_same(&self, short: &Expr, expression: &Expr) -> bool {
        let difference = short - expression;
        // Most forms differ by relations of the manifold alone, whatever the words mean.
        self.ideal.vanishes(&difference) || self.ideal.vanishes(&self.expanded(&difference))
    }

    /// The value of a word in stored scalars, parameters and functions of them.
    fn full(&self, symbol: &Symbol) -> Expr {
        let word = self.words.iter().find(|word| word.symbol == *symbol);
        let value = word.map(|word| word.value.clone());
        self.expanded(&value.unwrap_or_default())
    }

    /// Whether the author's names can be used.
    pub fn are_used(&self) -> bool {
        !self.as_derived
    }

    /// Whether a word stands for no more than another symbol, so that its value is written in its place.
    pub fn is_another_name(&self, word: &Word) -> bool {
        let derived = &self.words[..self.derived_in.min(self.words.len())];
        word.value.is_plain() && derived.iter().any(|other| other.symbol == word.symbol)
    }

    /// The words, each after those in its value.
    pub fn words(&self) -> &[Word] {
        &self.words
    }

    /// The expression with the functions that are words in place of their names.
    fn unnamed(&self, expression: &Expr) -> Expr {
        let values = self.functions.iter();
        let values = values.map(|(atom, symbol)| (symbol.clone(), Expr::atom(atom.clone())));
        expression.substitute(&values.collect())
    }

    /// The expression with names in place of the functions that are words, inside functions too.
    fn named(&self, expression: &Expr) -> Expr {
        let changed = expression.atoms().into_iter().filter_map(|atom| {
            let value = match (self.functions.get(&atom), &atom) {
                (Some(symbol), _) => Expr::symbol(symbol),
                (None, Atom::Symbol(_)) => return None,
                (None, Atom::Apply(application)) => self.with_named_arguments(application),
            };
            (value != Expr::atom(atom.clone())).then_some((atom, value))
        });
        expression.replace_atoms(&changed.collect())
    }

    fn with_named_arguments(&self, application: &Application) -> Expr {
        let arguments = application.arguments.iter();
        let arguments: Vec<Expr> = match application.function {
            // What is divided by stays as it stands.
            Function::Recip => arguments.map(|argument| self.named(argument)).collect(),
            _ => arguments.map(|argument| self.shorten(argument)).collect(),
        };
        Expr::applied(application.function, &arguments)
    }

    /// A short form of an expression in words: one whose difference from it has normal form 0, as the proofs have it.
    pub fn shorten(&self, expression: &Expr) -> Expr {
        if expression.is_plain() {
            return expression.clone();
        }
        if let Some(known) = self.found.borrow().get(expression) {
            return known.clone();
        }
        let short = self.find_short(expression);
        if !budget::is_exhausted() {
            let mut found = self.found.borrow_mut();
            found.insert(expression.clone(), short.clone());
        }
        short
    }

    fn find_short(&self, expression: &Expr) -> Expr {
        if self.as_derived {
            return self.ideal.simplest(expression);
        }
        let plain = self.unnamed(&opened(expression));
        let short =
            budget::scope(LIMIT, || self.shortest(&plain)).unwrap_or_else(|_| plain.clone());
        // A difference loses the digits of a sum of squares that is small: 1 − R₃₃² near R₃₃ = 1.
        if adds_squares(&plain) && !adds_squares(&short) {
            return self.named(&plain);
        }
        let is_same = || budget::scope(LIMIT, || self.is_same(&short, &plain)).unwrap_or(false);
        match short != plain && is_same() {
            true => self.named(&short),
            false => self.named(&plain),
        }
    }

    /// The shorter of an expression and its normal form, each with multiples of relations subtracted.
    fn shortest(&self, plain: &Expr) -> Expr {
        let own = self.subtracted(plain);
        let normal = self.ideal.simplest(plain);
        if normal == *plain {
            return own;
        }
        let normal = self.subtracted(&normal);
        match weight(&normal) < weight(&own) {
            true => normal,
            false => own,
        }
    }

    fn subtracted(&self, expression: &Expr) -> Expr {
        let mut functions = expression.related_functions();
        functions.extend(self.functions.keys().cloned());
        let stated = self.ideal.stated().iter().map(|relation| (None, relation));
        let defined = self.definitions.iter();
        let defined = defined.map(|(name, relation)| (Some(name), relation));
        shortened(expression, &functions, stated.chain(defined))
    }

    /// Entry by entry.
    pub fn shorten_each(&self, matrix: &Matrix) -> Matrix {
        matrix.map(|entry| self.shorten(entry))
    }

    /// ∂/∂ϕ_k of an expression in words, itself in words.
    pub fn along(&mut self, expression: &Expr, k: usize) -> Expr {
        let mut rates = BTreeMap::new();
        for symbol in expression.symbols() {
            if let Some(n) = self.words.iter().position(|word| word.symbol == symbol) {
                let rate = self.derivative(n, k);
                rates.insert(symbol, rate);
            }
        }
        let motion = self.motion;
        let rate = |symbol: &Symbol| match rates.get(symbol) {
            Some(rate) => rate.clone(),
            None => motion.along(&Expr::symbol(symbol), k),
        };
        let slope = expression.along(&rate);
        self.shorten(&slope)
    }

    /// Entry by entry.
    pub fn along_each(&mut self, matrix: &Matrix, k: usize) -> Matrix {
        matrix.map(|entry| self.along(entry, k))
    }

    fn derivative(&mut self, n: usize, k: usize) -> Expr {
        let Word {
            symbol,
            value,
            mut along,
            base,
            rates,
        } = self.words[n].clone();
        if let Some(known) = rates.get(k) {
            return known.clone();
        }
        let key = (symbol.clone(), k);
        if let Some(known) = self.derivatives.get(&key) {
            return known.clone();
        }
        let slope = self.along(&value, k);
        let slope = match slope.is_plain() || budget::is_exhausted() {
            true => slope,
            false => {
                along.push(k);
                let derivative = self.add(&base, along, slope);
                self.define(&derivative);
                Expr::symbol(&derivative)
            }
        };
        self.derivatives.insert(key, slope.clone());
        slope
    }
}

/// The function, if the value is nothing else.
fn single_function(value: &Expr) -> Option<Atom> {
    let (monomial, coefficient) = value.single_term()?;
    let one = crate::expr::Rational::from(1);
    match monomial.main() {
        [(atom @ Atom::Apply(application), 1)]
            if *coefficient == one
                && monomial.units().is_empty()
                && application.function != Function::Recip =>
        {
            Some(atom.clone())
        }
        _ => None,
    }
}

/// Whether no term cancels another: one term, or several of one sign and of even powers.
fn adds_squares(expression: &Expr) -> bool {
    let is_square = |monomial: &Monomial| monomial.factors().all(|(_, power)| power % 2 == 0);
    let signs: BTreeSet<bool> = expression.terms().map(|(_, c)| c.is_negative()).collect();
    let mut monomials = expression.terms().map(|(monomial, _)| monomial);
    expression.terms().len() <= 1 || signs.len() == 1 && monomials.all(is_square)
}

/// The expression without sums that are kept together.
pub(super) fn opened(expression: &Expr) -> Expr {
    let groups = expression
        .atoms()
        .into_iter()
        .filter_map(|atom| match &atom {
            Atom::Apply(application) if application.function == Function::Group => {
                let sum = opened(&application.arguments[0]);
                Some((atom, sum))
            }
            _ => None,
        });
    expression.replace_atoms(&groups.collect())
}

/// Whether exponentials, or functions that are made of them, occur in what the spec declares.
fn has_exponentials(joint: &Prepared) -> bool {
    let moved = joint
        .spec
        .retract
        .iter()
        .flat_map(|declared| &declared.value);
    let matrices = joint.spec.matrices();
    let mut entries = matrices.flat_map(Matrix::entries).chain(moved);
    entries.any(holds_exponential)
}

fn holds_exponential(expression: &Expr) -> bool {
    expression.atoms().iter().any(|atom| match atom {
        Atom::Symbol(_) => false,
        Atom::Apply(application) => {
            let function = application.function;
            let is_exponential = matches!(
                function,
                Function::Exp
                    | Function::Sinh
                    | Function::Cosh
                    | Function::Sech
                    | Function::Tanh
                    | Function::LnCosh
                    | Function::Ln
            );
            is_exponential || application.arguments.iter().any(holds_exponential)
        }
    })
}
