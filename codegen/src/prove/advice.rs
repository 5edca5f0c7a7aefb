//! What to do where a rank or an inverse is lost.

use super::{LEAVE_OUT, LONGEST, Prover, degenerate, is_of_parameters};
use crate::expr::{Atom, Expr, Function, Monomial, Rational, Role};

impl Prover<'_> {
    /// What to do about the zeros of a function: an `except`, unless home is one of them or parameters alone decide.
    pub(super) fn end_there(&self, function: &Expr) -> String {
        if is_of_parameters(function) {
            return LEAVE_OUT.to_owned();
        }
        if function.symbols().is_empty() {
            return "write the numbers in a form whose sign is decided: no configuration changes it".to_owned();
        }
        if degenerate::is_at_home(function, self.joint, &self.domain) {
            return "home is such a configuration, so that `except` cannot leave it out: choose another home or another form".to_owned();
        }
        let written = self.regular_exception(function).to_string();
        match written.len() <= LONGEST {
            true => format!("if the joint ends there, declare it: `except {written} = 0;`"),
            false => "if the joint ends there, declare it: `except … = 0;` with a function that vanishes there".to_owned(),
        }
    }

    /// A shorter function with the same zeros: the factors that all terms share, where nothing else vanishes.
    fn regular_exception(&self, function: &Expr) -> Expr {
        let shared = shared_factors(function);
        let rest = function.exact_quotient(&shared);
        match rest.is_some_and(|rest| self.domain.nonzero(&rest).is_some()) {
            true => exception(&shared),
            false => exception(function),
        }
    }

    /// What to do where the matrix `what` loses rank with the determinant `gram`.
    pub(super) fn full_rank(&self, gram: &Expr, what: &str) -> String {
        match what {
            "A" => self.other_columns(gram, what, "S_bar"),
            "S_bar" => self.other_columns(gram, what, "A"),
            _ => self.end_there(gram),
        }
    }

    /// The same for A or S_bar, of which `other` is the other one.
    fn other_columns(&self, gram: &Expr, what: &str, other: &str) -> String {
        let spec = &self.joint.spec;
        let mut advice = vec![self.end_there(gram)];
        if is_of_parameters(gram) {
            return advice.remove(0);
        }
        let parameters = parameters(gram);
        if !parameters.is_empty() {
            advice.push(format!(
                "or, if only some values of {} allow it, leave these out by their ranges or by `require`",
                parameters.join(", ")
            ));
        }
        advice.push(format!(
            "or take other columns of {what}: divide one by a factor that all its entries share, or replace one that becomes a multiple of another"
        ));
        if spec.constraint.is_some() && spec.speed_basis.is_some() {
            advice.push(format!(
                "or leave {what} out: it is then derived from {other}"
            ));
        }
        advice.join("\n")
    }
}

/// A shorter function with the same zeros: of a single term those factors that may vanish, each once; else the least multiple with whole coefficients, the first
/// of them positive.
pub(super) fn exception(function: &Expr) -> Expr {
    let Some((monomial, _)) = function.single_term() else {
        return with_whole_coefficients(function);
    };
    let never_vanishes = |atom: &Atom| match atom {
        Atom::Apply(application) => {
            matches!(application.function, Function::Recip | Function::Exp)
        }
        Atom::Symbol(_) => false,
    };
    let atoms = monomial.main().iter().map(|(atom, _)| atom);
    let factors = atoms.filter(|atom| !never_vanishes(atom));
    factors.fold(Expr::one(), |product, atom| {
        &product * &Expr::atom(atom.clone())
    })
}

/// The product of what all terms of a sum have as factors.
fn shared_factors(function: &Expr) -> Expr {
    let monomials: Vec<&Monomial> = function.terms().map(|(monomial, _)| monomial).collect();
    let Some((first, others)) = monomials.split_first() else {
        return Expr::one();
    };
    let power_in = |monomial: &Monomial, atom: &Atom| {
        let mut factors = monomial.main().iter();
        let own = factors.find(|(factor, _)| factor == atom);
        own.map_or(0, |(_, power)| *power)
    };
    first
        .main()
        .iter()
        .fold(Expr::one(), |product, (atom, power)| {
            let least = others.iter().map(|other| power_in(other, atom)).min();
            let shared = least.map_or(*power, |least| least.min(*power));
            &product * &Expr::atom(atom.clone()).pow(shared)
        })
}

fn with_whole_coefficients(function: &Expr) -> Expr {
    let mut coefficients = function.terms().map(|(_, coefficient)| coefficient);
    let Some(first) = coefficients.next().map(Rational::abs) else {
        return function.clone();
    };
    let shared = coefficients.fold(first, |shared, next| shared.common_part(next));
    let factor = match function.to_string().starts_with('-') {
        true => -shared.recip(),
        false => shared.recip(),
    };
    function.scaled(&factor, &Monomial::one())
}

/// The parameters of a function, as the spec names them.
fn parameters(function: &Expr) -> Vec<String> {
    let symbols = function.symbols().into_iter();
    let own = symbols.filter(|symbol| matches!(symbol.role, Role::Parameter | Role::Constant));
    own.map(|symbol| format!("`{}`", symbol.spelling()))
        .collect()
}
