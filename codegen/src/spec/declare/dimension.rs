//! Units of the terms of a port, as far as those of parameters and the kinds of factors tell them. Angles count as numbers.

use super::super::ast::Port;
use super::super::code;
use crate::diagnostic::Diagnostic;
use crate::expr::{Application, Atom, Expr, Function, Monomial, Role, Symbol};
use crate::manifold::{Kind, Manifold};
use crate::model::{Parameter, PortValue};
use std::collections::BTreeMap;

/// Units that a port may have.
const OF_PORTS: &[&str] = &["rad", "m"];

/// Units with their powers, none of them 0; that of a number is empty.
type Dimension = BTreeMap<String, i32>;

/// The error that the declared unit is none of a port, or not that of the value; or that terms of the value have different ones.
pub(super) fn error(
    port: &Port,
    value: &PortValue,
    parameters: &[Parameter],
    manifold: &Manifold,
) -> Option<Diagnostic> {
    let (name, unit) = (&port.name.text, &port.unit);
    if !OF_PORTS.contains(&unit.text.as_str()) {
        let message = format!("port `{name}` is in `{}`", unit.text);
        let error = Diagnostic::new(code::UNIT, unit.span.clone(), message);
        return Some(
            error
                .label("no unit of a port")
                .help("a port is an angle in `rad` or a length in `m`"),
        );
    }
    let known = Known {
        parameters,
        manifold,
    };
    let of_value = |message: String, label: &str| {
        Diagnostic::new(code::PORT, port.value.span.clone(), message).label(label.to_owned())
    };
    let (terms, declared): (Vec<Dimension>, _) = match value {
        PortValue::Scalar(value) => (known.of_terms(value), parsed(&unit.text)),
        // A cosine and a sine are numbers, and what they are of is an angle.
        PortValue::Angle { cos, sin } => {
            if unit.text != "rad" {
                let message = format!(
                    "port `{name}` is an angle, and is declared in {}",
                    unit.text
                );
                return Some(of_value(message, "an angle").help("declare it in `rad`"));
            }
            let both = [known.of_terms(cos), known.of_terms(sin)];
            (both.concat(), Dimension::new())
        }
    };
    if let Some(other) = terms.iter().find(|term| **term != terms[0]) {
        let message = format!(
            "port `{name}` adds values of different units, {} and {}",
            in_words(&terms[0]),
            in_words(other)
        );
        return Some(of_value(message, "mixed units"));
    }
    let found = terms.first().filter(|found| **found != declared)?;
    let message = format!(
        "port `{name}` is declared in {}, and its value is in {}",
        unit.text,
        in_words(found)
    );
    Some(of_value(message, "another unit"))
}

/// The unit of each relation that is declared, by its first term whose unit is known; empty where there is none.
pub(super) fn of_relations(parameters: &[Parameter], manifold: &Manifold) -> Vec<String> {
    let known = Known {
        parameters,
        manifold,
    };
    let unit = |relation: &Expr| match known.of_sum(relation) {
        None => String::new(),
        Some(number) if number.is_empty() => "1".to_owned(),
        Some(dimension) => in_words(&dimension),
    };
    manifold.declared().iter().map(unit).collect()
}

/// What tells units.
struct Known<'a> {
    parameters: &'a [Parameter],
    manifold: &'a Manifold,
}

impl Known<'_> {
    /// Those of the terms whose unit is known.
    fn of_terms(&self, sum: &Expr) -> Vec<Dimension> {
        let terms = sum.terms();
        terms.filter_map(|(term, _)| self.of_term(term)).collect()
    }

    /// That of a sum, by its first term that has a known one.
    fn of_sum(&self, sum: &Expr) -> Option<Dimension> {
        sum.terms().find_map(|(term, _)| self.of_term(term))
    }

    fn of_term(&self, term: &Monomial) -> Option<Dimension> {
        let mut product = Dimension::new();
        for (atom, power) in term.factors() {
            let own = match atom {
                Atom::Symbol(symbol) => self.of_symbol(symbol)?,
                Atom::Apply(application) => self.of_function(application)?,
            };
            multiply(&mut product, &own, power);
        }
        Some(product)
    }

    fn of_symbol(&self, symbol: &Symbol) -> Option<Dimension> {
        match symbol.role {
            Role::Parameter => {
                let mut parameters = self.parameters.iter();
                let own = parameters.find(|parameter| parameter.symbol == *symbol)?;
                Some(parsed(&own.unit))
            }
            Role::Coordinate => self.of_coordinate(symbol),
            _ => None,
        }
    }

    /// That of a stored scalar; a real factor may hold anything.
    fn of_coordinate(&self, symbol: &Symbol) -> Option<Dimension> {
        let place = |factor: &crate::manifold::Factor| {
            let n = factor.coordinates.iter().position(|own| own == symbol)?;
            Some((factor.kind, n))
        };
        let is_place = match self.manifold.factors().iter().find_map(place)? {
            (Kind::Real(_), _) => return None,
            // The last column of each row.
            (Kind::Se2, n) => n % 3 == 2,
            (Kind::Se3, n) => n % 4 == 3,
            _ => false,
        };
        Some(parsed(if is_place { "m" } else { "1" }))
    }

    fn of_function(&self, application: &Application) -> Option<Dimension> {
        let argument = || application.arguments.first();
        match application.function {
            Function::Group => self.of_sum(argument()?),
            Function::Recip => {
                let mut inverse = Dimension::new();
                multiply(&mut inverse, &self.of_sum(argument()?)?, -1);
                Some(inverse)
            }
            Function::Sqrt => {
                let square = self.of_sum(argument()?)?;
                let even = square.values().all(|power| power % 2 == 0);
                even.then(|| {
                    square
                        .into_iter()
                        .map(|(u, power)| (u, power / 2))
                        .collect()
                })
            }
            Function::Larger => None,
            // Angles, and functions of numbers.
            _ => Some(Dimension::new()),
        }
    }
}

fn multiply(product: &mut Dimension, by: &Dimension, power: i32) {
    for (unit, own) in by {
        let sum = product.entry(unit.clone()).or_default();
        *sum += own * power;
    }
    product.retain(|_, power| *power != 0);
}

/// `kg*m/s`; angles and numbers have no unit here.
fn parsed(unit: &str) -> Dimension {
    let mut dimension = Dimension::new();
    let mut rest = unit;
    let mut power = 1;
    loop {
        let end = rest.find(['*', '/']).unwrap_or(rest.len());
        let part = &rest[..end];
        if !["1", "rad"].contains(&part) {
            multiply(
                &mut dimension,
                &Dimension::from([(part.to_owned(), 1)]),
                power,
            );
        }
        match rest[end..].chars().next() {
            Some(operator) => power = if operator == '*' { 1 } else { -1 },
            None => return dimension,
        }
        rest = &rest[end + 1..];
    }
}

/// `m`, `kg m^2/s`, or that it is a number.
fn in_words(dimension: &Dimension) -> String {
    let power = |(unit, power): (&String, &i32)| match power.abs() {
        1 => unit.clone(),
        power => format!("{unit}^{power}"),
    };
    let side = |above: bool| -> Vec<String> {
        let own = dimension.iter().filter(|(_, power)| (**power > 0) == above);
        own.map(power).collect()
    };
    match (side(true).join(" "), side(false)) {
        (above, below) if below.is_empty() && above.is_empty() => "rad or 1".to_owned(),
        (above, below) if below.is_empty() => above,
        (above, below) if above.is_empty() => format!("1/{}", below.join("/")),
        (above, below) => format!("{above}/{}", below.join("/")),
    }
}
