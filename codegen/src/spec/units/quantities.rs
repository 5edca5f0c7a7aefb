//! Units of expressions: each term is a product of quantities whose units are declared, or looked for.

use super::system::Form;
use super::{Analysis, Blame, Equation, Role, Wanted};
use crate::expr::{Application, Atom, Expr, Function, Monomial, Rational, Symbol};
use crate::units::{COMPARED, Dimension};
use num_traits::One;

/// A term, and its unit.
pub(super) struct Term {
    pub unit: Form,
    pub text: String,
    /// Whether no number that stands in it, or may be thought of, could have the unit that is missing.
    pub is_strict: bool,
    /// Whether it is a number times something, or a number.
    has_number: bool,
    /// Whether its declared quantities are more than a number.
    has_length: bool,
    /// The coordinate that it is, in some direction.
    alone: Option<Symbol>,
    /// Whether it is a number or a direction and nothing else, or stands beside one.
    beside_number: bool,
}

impl Analysis<'_> {
    /// Says that all terms of a sum have this unit.
    pub(super) fn fixed(&mut self, blame: &Blame, sum: &Expr, unit: &Form) {
        for term in self.terms(blame, sum) {
            self.equations.push(Equation {
                of_lengths: [&term.unit, unit]
                    .iter()
                    .any(|unit| unit.has_known(&COMPARED)),
                unit: term.unit.over(unit),
                is_strict: term.is_strict,
                blame: blame.clone(),
                wanted: Wanted::Unit(unit.clone()),
                alone: term.alone,
                beside_number: term.beside_number,
                term: term.text,
            });
        }
    }

    /// Says that the terms of a sum have one unit, and gives it.
    pub(super) fn alike(&mut self, blame: &Blame, sum: &Expr) -> Form {
        if let Some(known) = self.sums.get(sum) {
            return known.clone();
        }
        let terms = self.terms(blame, sum);
        if let [one] = terms.as_slice()
            && one.is_strict
        {
            return one.unit.clone();
        }
        let unit = self.new_unknown();
        self.sums.insert(sum.clone(), unit.clone());
        let first = terms.iter().find(|term| term.is_strict);
        let first = first.map(|term| (term.unit.clone(), term.text.clone()));
        for term in terms {
            let wanted = match &first {
                Some((unit, text)) => Wanted::LikeTerm(unit.clone(), text.clone()),
                None => Wanted::Unit(unit.clone()),
            };
            self.equations.push(Equation {
                of_lengths: term.unit.has_known(&COMPARED),
                unit: term.unit.over(&unit),
                is_strict: term.is_strict,
                blame: blame.clone(),
                wanted,
                alone: term.alone,
                beside_number: term.beside_number,
                term: term.text,
            });
        }
        unit
    }

    fn terms(&mut self, blame: &Blame, sum: &Expr) -> Vec<Term> {
        let terms = sum.terms();
        let mut terms: Vec<Term> = terms
            .map(|(monomial, coefficient)| self.term(blame, monomial, coefficient))
            .collect();
        let all_have_lengths = terms.iter().all(|term| term.has_length);
        let some_have_lengths = terms.iter().any(|term| term.has_length);
        let has_number = terms.iter().any(|term| term.beside_number);
        for term in &mut terms {
            term.beside_number = has_number;
            term.is_strict |= match term.has_number {
                true => blame.role != Role::Condition && all_have_lengths,
                false => some_have_lengths,
            };
        }
        terms
    }

    fn term(&mut self, blame: &Blame, monomial: &Monomial, coefficient: &Rational) -> Term {
        let (mut unit, mut declared) = (Form::default(), Form::default());
        let mut is_declared = false;
        for (atom, power) in monomial.factors() {
            let power = Rational::from(i64::from(power));
            let own = self.atom(blame, atom);
            unit.multiply(&own, &power);
            if self.declares(atom) {
                is_declared = true;
                declared.multiply(&own, &power);
            }
        }
        let alone = self.alone(monomial);
        let mut factors = monomial.factors();
        let has_number = monomial.is_one()
            || !coefficient.abs().is_one()
            || factors.any(|(atom, _)| self.is_number(atom));
        Term {
            is_strict: !has_number && (is_declared || alone.is_some()),
            alone,
            has_number,
            has_length: declared.has_known(&COMPARED),
            beside_number: monomial
                .main()
                .iter()
                .all(|(atom, _)| self.is_direction(atom))
                && !is_declared,
            text: shortened(&Expr::term(coefficient.clone(), monomial.clone())),
            unit,
        }
    }

    /// The coordinate that a term is, in one direction or another: `x`, `x * cos(a)`.
    fn alone(&self, monomial: &Monomial) -> Option<Symbol> {
        if !monomial.units().is_empty() {
            return None;
        }
        let mut others = monomial
            .main()
            .iter()
            .filter(|(atom, _)| !self.is_direction(atom));
        match (others.next(), others.next()) {
            (Some((Atom::Symbol(symbol), 1)), None) => {
                self.quantities.contains(symbol).then(|| symbol.clone())
            }
            _ => None,
        }
    }

    /// Whether it is an entry of a rotation, or a sine or cosine.
    fn is_direction(&self, atom: &Atom) -> bool {
        match atom {
            Atom::Symbol(symbol) => self.symbols.get(symbol) == Some(&Form::default()),
            Atom::Apply(application) => {
                matches!(application.function, Function::Cos | Function::Sin)
            }
        }
    }

    fn atom(&mut self, blame: &Blame, atom: &Atom) -> Form {
        match atom {
            Atom::Symbol(symbol) => self.symbols.get(symbol).cloned().unwrap_or_default(),
            Atom::Apply(application) => self.application(blame, application),
        }
    }

    fn application(&mut self, blame: &Blame, application: &Application) -> Form {
        let arguments = application.arguments.as_slice();
        let part = &blame.of_part();
        match (application.function, arguments) {
            (Function::Group, [x]) => self.alike(part, x),
            (Function::Recip, [x]) => Form::default().over(&self.alike(part, x)),
            (Function::Sqrt, [x]) => {
                let mut root = Form::default();
                let half = Rational::new(1.into(), 2.into());
                root.multiply(&self.alike(part, x), &half);
                root
            }
            (Function::Atan2, [y, x]) => {
                let unit = self.alike(part, x);
                let blame = part.within("atan2");
                self.fixed(&blame, y, &unit);
                Form::known(Dimension::angle())
            }
            (Function::Cos | Function::Sin, [x]) => {
                let role = blame.role.of_argument();
                let blame = blame.within("a sine or cosine").of(role);
                self.fixed(&blame, x, &Form::known(Dimension::angle()));
                Form::default()
            }
            (
                Function::Exp
                | Function::Ln
                | Function::Sinh
                | Function::Cosh
                | Function::Sech
                | Function::Tanh
                | Function::LnCosh,
                [x],
            ) => {
                let blame = blame.within("an exponential or logarithm");
                self.fixed(&blame.of(Role::Angle), x, &Form::default());
                Form::default()
            }
            // Its argument is that of a call.
            (Function::Curve(curve, order), _) => self.curve(curve, order),
            _ => Form::default(),
        }
    }

    /// Whether this is π, or a parameter or curve without unit.
    fn is_number(&self, atom: &Atom) -> bool {
        let is_curve = match atom {
            Atom::Apply(application) => matches!(application.function, Function::Curve(..)),
            Atom::Symbol(_) => false,
        };
        (atom.is_unit() || is_curve) && !self.declares(atom)
    }

    /// Whether its unit is declared in the spec.
    fn declares(&self, atom: &Atom) -> bool {
        match atom {
            Atom::Symbol(symbol) => self.declared.contains(symbol),
            Atom::Apply(application) => match application.function {
                Function::Curve(curve, order) => self.has_unit(curve, order),
                Function::Group | Function::Recip | Function::Sqrt => {
                    let arguments = application.arguments.iter();
                    let mut atoms = arguments.flat_map(Expr::atoms);
                    atoms.any(|atom| self.declares(&atom))
                }
                _ => false,
            },
        }
    }
}

/// Most characters of a term in a message.
const LONGEST: usize = 60;

/// The beginning of a term that is long.
fn shortened(term: &Expr) -> String {
    let text = term.to_string();
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}
