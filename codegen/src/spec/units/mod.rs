//! Units of a joint: the exponents of metre, kilogram and second of everything that its spec declares, by linear equations between them.
//!
//! Parameters, curves and ports have the unit that is declared; entries of rotations, and of factors that are rotations, are numbers; displacements of H
//! and of motions, and points of pins, are lengths. Terms of a sum are alike, arguments of sine and cosine are angles, and an angle is a number.
//! What real coordinates, ϕ, v and speeds are follows by elimination.
//!
//! Numbers, and parameters and curves of unit 1, are without unit where that fits. A number may also stand for a quantity: then it has the unit that is missing, as in
//! `trans_z(0.3 * cos(a))`, unless every term of its sum holds a declared length. A product without number and without declared quantity counts as one with
//! the number 1 before it, as in `trans([x, x * x, 0])`. Equations of such terms are tried last, and those that do not fit are let go; so are those of statements in which a number
//! stands as a term, an entry or a decimal: it may be a quantity, and what is multiplied out does not tell.

mod declarations;
mod message;
mod quantities;
mod system;
mod written;

use self::system::{Form, System};
use self::written::Statements;
use crate::diagnostic::Diagnostic;
use crate::expr::curve::Curve;
use crate::expr::{self, Expr, Rational, Symbol};
use crate::model::JointSpec;
use crate::units::{ANGLE, COMPARED, Dimension, Units};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// The units of what the spec declares.
///
/// # Errors
/// Each statement whose terms have other units than they should, with the first of its contradictions.
pub(super) fn of_spec(spec: &JointSpec) -> Result<Units, Vec<Diagnostic>> {
    let mut analysis = Analysis::new(spec);
    let asked = analysis.declarations();
    let (system, errors) = analysis.solved();
    if !errors.is_empty() {
        return Err(errors);
    }
    let angles = analysis.angles();
    let tell = |units: &[Form]| -> Vec<Option<Dimension>> {
        units
            .iter()
            .map(|unit| told(&system, &angles, unit))
            .collect()
    };
    Ok(Units {
        coordinates: tell(&asked.coordinates),
        freedoms: tell(&asked.freedoms),
        velocities: tell(&asked.velocities),
        speeds: tell(&asked.speeds),
        relations: tell(&asked.relations),
    })
}

/// A unit by both systems: that of angles only counts where it is whole.
fn told(system: &System, angles: &System, unit: &Form) -> Option<Dimension> {
    let (_, mut dimension) = system.value(unit)?.split();
    if let Some(angle) = angles.value(unit) {
        let (power, _) = angle.split();
        let is_angle = dimension.vanishes(&COMPARED) && power == Rational::from(1);
        if is_angle {
            dimension = Dimension::angle();
        }
    }
    Some(dimension)
}

/// The units that [`Units`] tells.
struct Asked {
    coordinates: Vec<Form>,
    freedoms: Vec<Form>,
    velocities: Vec<Form>,
    speeds: Vec<Form>,
    relations: Vec<Form>,
}

/// What an equation says of, for its message.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Blame {
    /// `port `a``, `H of `rod``.
    element: String,
    /// The function that takes the terms.
    within: Option<&'static str>,
    role: Role,
    span: Range<usize>,
}

/// What a coordinate that stands alone in an equation counts as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// An angle, because it is the argument of a sine.
    Angle,
    /// The angle of a rotation of H, because the sine is an entry of that rotation.
    Turn,
    /// A length, because H moves by it.
    Length,
    /// What is declared.
    Declared,
    /// An entry of a rotation of H, a number.
    Rotation,
    /// What a condition compares, where numbers may have units.
    Condition,
}

impl Blame {
    fn new(element: impl Into<String>, span: &Range<usize>) -> Self {
        Self {
            element: element.into(),
            within: None,
            role: Role::Declared,
            span: span.clone(),
        }
    }

    fn of(self, role: Role) -> Self {
        Self { role, ..self }
    }

    /// A part of it that is no term: a sine in it is no entry of a rotation.
    fn of_part(&self) -> Self {
        let role = match self.role {
            Role::Rotation => Role::Declared,
            other => other,
        };
        self.clone().of(role)
    }

    /// The argument of a function in it.
    fn within(&self, function: &'static str) -> Self {
        Self {
            within: Some(function),
            ..self.clone()
        }
    }
}

impl Role {
    /// That of the argument of a function in an expression with this role.
    fn of_argument(self) -> Self {
        match self {
            Self::Rotation => Self::Turn,
            _ => Self::Angle,
        }
    }

    /// Whether a coordinate alone may be a number of the unit that is missing.
    fn admits_numbers(self) -> bool {
        !matches!(self, Self::Declared | Self::Rotation)
    }
}

/// The unit that a term should have.
enum Wanted {
    Unit(Form),
    /// That of another term, with its text.
    LikeTerm(Form, String),
}

/// A unit that is 1.
struct Equation {
    unit: Form,
    /// Whether it compares other things than angles and numbers.
    of_lengths: bool,
    /// Whether a spec in which it is not is wrong.
    is_strict: bool,
    blame: Blame,
    wanted: Wanted,
    /// The term that it is about.
    term: String,
    /// The coordinate that this is, in some direction.
    alone: Option<Symbol>,
    /// Whether a term of the same sum is only a number or a direction, so that the sum counts in multiples of one unit.
    beside_number: bool,
}

/// What is known of units, and what is said of them.
struct Analysis<'s> {
    spec: &'s JointSpec,
    symbols: BTreeMap<Symbol, Form>,
    /// Parameters with a unit.
    declared: BTreeSet<Symbol>,
    /// Real coordinates, displacements and ϕ.
    quantities: BTreeSet<Symbol>,
    /// Units of sums inside functions.
    sums: BTreeMap<Expr, Form>,
    unknowns: usize,
    equations: Vec<Equation>,
}

impl<'s> Analysis<'s> {
    fn new(spec: &'s JointSpec) -> Self {
        let mut analysis = Self {
            spec,
            symbols: BTreeMap::new(),
            declared: BTreeSet::new(),
            quantities: BTreeSet::new(),
            sums: BTreeMap::new(),
            unknowns: 0,
            equations: vec![],
        };
        for parameter in &spec.parameters {
            let unit = Form::known(Dimension::parsed(&parameter.unit));
            analysis.symbols.insert(parameter.symbol.clone(), unit);
            // One without unit is a number that the scene writes.
            if parameter.unit != "1" {
                analysis.declared.insert(parameter.symbol.clone());
            }
        }
        analysis
    }

    /// A coordinate, or a ϕ.
    fn quantity(&mut self, symbol: &Symbol, unit: Form) {
        self.quantities.insert(symbol.clone());
        self.symbols.insert(symbol.clone(), unit);
    }

    fn new_unknown(&mut self) -> Form {
        self.unknowns += 1;
        Form::unknown(self.unknowns)
    }

    /// Whether a curve's derivative of this order has a unit.
    fn has_unit(&self, curve: Curve, order: u8) -> bool {
        let mut declared = self.spec.curves.iter();
        let declared = declared.find(|declared| declared.curve == curve);
        declared.is_some_and(|declared| {
            let [argument, value] = &declared.units;
            value != "1" || order > 0 && argument != "1"
        })
    }

    /// That of a curve's derivative of this order.
    fn curve(&self, curve: Curve, order: u8) -> Form {
        let mut declared = self.spec.curves.iter();
        let Some(declared) = declared.find(|declared| declared.curve == curve) else {
            return Form::default();
        };
        let [argument, mut unit] = declared
            .units
            .each_ref()
            .map(|unit| Dimension::parsed(unit));
        unit.add(&argument, &Rational::from(-i64::from(order)));
        Form::known(unit)
    }

    /// All equations together: those that must hold, then those that may; and the errors of those that must and do not.
    fn solved(&self) -> (System, Vec<Diagnostic>) {
        let mut system = System::new(COMPARED);
        let mut errors: Vec<Diagnostic> = vec![];
        let (numbers, statements) = (self.numbers(), Statements::new(&self.spec.source));
        let is_strict = |equation: &&Equation| {
            let is_number =
                |symbol: &Symbol| numbers.contains(symbol) || symbol.role == expr::Role::Local;
            let is_number = equation.alone.as_ref().is_some_and(is_number);
            let is_let_go = is_number && equation.blame.role.admits_numbers()
                || statements.has_quantity(&equation.blame.span);
            equation.is_strict && !is_let_go
        };
        let (strict, mut others): (Vec<_>, Vec<_>) = self.equations.iter().partition(is_strict);
        // What moves H by a length is one, whatever functions take it as a number besides.
        others.sort_by_key(|equation| {
            let is_number = |symbol| numbers.contains(symbol);
            equation.blame.role == Role::Angle && equation.alone.as_ref().is_some_and(is_number)
        });
        for equation in strict {
            if let Err(excess) = system.say(&equation.unit)
                && errors.iter().all(|error| error.span != equation.blame.span)
            {
                let error = message::error(equation, &excess, &system);
                errors.push(match self.unscaled(equation) {
                    Some(symbol) => error.help(message::scale(symbol)),
                    None => error,
                });
            }
        }
        for equation in others {
            // One that does not fit has a number with a unit in it.
            _ = system.say(&equation.unit);
        }
        (system, errors)
    }

    /// Coordinates that stand alone both as an angle and as a length, as in `trans([x, sin(x), 0])`: they are numbers, of radians and of metres.
    /// One by which H itself turns and moves is none: in `trans_x(x) * rot_z(x)` the metres per radian are missing.
    fn numbers(&self) -> BTreeSet<&Symbol> {
        let (turning, moving) = (self.alone_as(&[Role::Turn]), self.alone_as(&[Role::Length]));
        let mut numbers = self.alone_as(&[Role::Angle, Role::Turn]);
        numbers.retain(|symbol| {
            let is_unscaled = self.is_displacement(symbol) && turning.contains(symbol);
            moving.contains(symbol) && !is_unscaled
        });
        numbers
    }

    /// The coordinate that this equation takes for an angle of H and another one for a length, or the other way round.
    fn unscaled<'e>(&self, equation: &'e Equation) -> Option<&'e Symbol> {
        let other = match equation.blame.role {
            Role::Turn => Role::Length,
            Role::Length => Role::Turn,
            _ => return None,
        };
        let symbol = equation.alone.as_ref()?;
        self.alone_as(&[other]).contains(symbol).then_some(symbol)
    }

    /// Coordinates that stand alone with one of these roles.
    fn alone_as(&self, roles: &[Role]) -> BTreeSet<&Symbol> {
        let own = self
            .equations
            .iter()
            .filter(|equation| equation.is_strict && roles.contains(&equation.blame.role));
        own.filter_map(|equation| equation.alone.as_ref()).collect()
    }

    /// Whether H moves by this coordinate alone, and not by multiples of one unit.
    fn is_displacement(&self, symbol: &Symbol) -> bool {
        self.equations.iter().any(|equation| {
            equation.blame.role == Role::Length
                && equation.alone.as_ref() == Some(symbol)
                && !equation.beside_number
        })
    }

    /// Which of the quantities are angles: by equations between angles and numbers first, because a length may be that of an angle as well as of a number.
    fn angles(&self) -> System {
        let mut system = System::new(ANGLE);
        let mut equations: Vec<&Equation> = self.equations.iter().collect();
        equations.sort_by_key(|equation| (equation.of_lengths, !equation.unit.has_known(&ANGLE)));
        for equation in equations {
            // An angle is a number: nothing is wrong where it counts as both.
            _ = system.say(&equation.unit);
        }
        system
    }
}

#[cfg(test)]
mod tests {
    use crate::spec::parse;
    use crate::units::Dimension;

    /// Units of Q; `?` where they are not determined.
    fn coordinates(declared: &str) -> Vec<String> {
        let source = format!("hamel = 1; joint test{declared}");
        let spec = parse(&source, "test").unwrap_or_else(|errors| panic!("{errors}"));
        let units = spec.units.coordinates.iter();
        let told = units.map(|unit| unit.as_ref().map(Dimension::in_units));
        told.map(|unit| unit.unwrap_or_else(|| "?".into()))
            .collect()
    }

    #[test]
    fn what_the_spec_does_not_determine_has_no_unit() {
        let steered = " { config q: R1, steer: R1; H = trans_z(q); }";
        assert_eq!(coordinates(steered), ["m", "?"]);
    }

    #[test]
    fn numbers_have_the_unit_that_is_missing() {
        for (declared, units) in [
            (" { config q: R1; H = trans_z(0.3 * cos(q)); }", "rad"),
            (" { config x: R1; H = trans([x, x * x, 0]); }", "m"),
            (" { config x: R1; H = trans([x, sin(x), 0]); }", "m"),
            (" { config q: R1; H = rot_z(q) * trans_z(1 * q); }", "rad"),
            (
                " { config x: R1; H = trans([x, sin(x), 0]) * rot_z(atan(cos(x))); }",
                "m",
            ),
            // Lengths are multiples of the radius, which is 1 m.
            (
                " { config q: R1; H = trans([cos(q) + q * sin(q), sin(q) - q * cos(q), 0]) * rot_z(q); }",
                "rad",
            ),
            (
                " { config q: R1; bodies rack, gear; H.rack = trans_x(0.02 * q); H.gear = rot_z(q); }",
                "rad",
            ),
            (
                " { curve f(1): 1 = cubic natural through [0, 0], [1, 2], [2, 0]; config x: R1; H = trans([x, f(x), 0]); }",
                "m",
            ),
            (
                "(a: 1) { config q: R1; H = rot_z(q) * trans_z(a * q); }",
                "rad",
            ),
            (
                "(l: m) { config q: R1; H = rot_z(q) * trans_x(l + 0.3); }",
                "rad",
            ),
            (
                "(l: m) { config x: R1; H = trans([x, l * sin(x / l), 0]); }",
                "m",
            ),
        ] {
            assert_eq!(coordinates(declared), [units], "{declared}");
        }
    }

    #[test]
    fn units_go_through_relations_and_curves() {
        let through = "(l: m) {
            curve f(mm): deg = cubic natural through [0, 0], [10, 30], [20, 90];
            config  x: R1, y: R1, q: R1;
            relation x = 2 * y;
            relation q * l = x;
            home    = 0, 0, 0;
            basis   along of r1(y);
            H = rot_z(f(x));
        }";
        assert_eq!(coordinates(through), ["m", "m", "1"]);
    }
}
