//! Functions that are not smooth at every argument, and where they are.

use super::Domain;
use crate::expr::curve::{Curve, Outside};
use crate::expr::{Atom, Expr, Function, Rational, Symbol};
use crate::matrix::Matrix;
use crate::model::JointSpec;
use std::collections::BTreeSet;

/// A function that is not smooth at every argument, as it stands in an expression.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Critical {
    /// Quotient, root, logarithm or angle.
    pub function: Function,
    /// Its arguments at ϕ = 0.
    pub arguments: Vec<Expr>,
    /// Its arguments as they are written.
    pub written: Vec<Expr>,
    /// Whether sine and cosine alone are taken of it, which whole turns do not change.
    pub periodic: bool,
}

impl Critical {
    /// Those in what a spec declares and evaluates at a configuration, exceptions included; Φ at ϕ = 0, but where it is Q exp(ϕ), which has a closed form.
    pub fn declared(spec: &JointSpec, exponential: bool) -> BTreeSet<Self> {
        let mut found = match exponential {
            true => BTreeSet::new(),
            false => Self::in_retract(spec),
        };
        spec.matrices()
            .flat_map(Matrix::entries)
            .chain(spec.loci.iter().map(|locus| &locus.value.function))
            .chain(spec.ports.iter().flat_map(|port| port.value.entries()))
            .chain(spec.pins.iter().flat_map(|pin| pin.value.entries()))
            .for_each(|e| Self::collect(e, &[], &mut found));
        found
    }

    /// Those in the declared Φ, at ϕ = 0.
    pub fn in_retract(spec: &JointSpec) -> BTreeSet<Self> {
        let freedoms = spec.freedoms.value.iter();
        let local: Vec<Symbol> = freedoms.map(|freedom| freedom.local.clone()).collect();
        let mut found = BTreeSet::new();
        let entries = spec.retract.iter().flat_map(|declared| &declared.value);
        entries.for_each(|e| Self::collect(e, &local, &mut found));
        found
    }

    /// Those in the expression, inside arguments too, where `local` are zero.
    pub fn collect(expression: &Expr, local: &[Symbol], found: &mut BTreeSet<Self>) {
        for atom in expression.atoms() {
            Self::of_atom(&atom, local, false, found);
        }
    }

    /// What is positive inside a curve that has no value beyond its ends: the distance from each of them.
    fn of_ends(curve: Curve, x: &Expr, local: &[Symbol], found: &mut BTreeSet<Self>) {
        if curve.definition().outside != Outside::Undefined {
            return;
        }
        let inside = [
            x - &curve.end_as_argument(false),
            &curve.end_as_argument(true) - x,
        ];
        found.extend(inside.into_iter().map(|distance| Self {
            function: Function::Curve(curve, 0),
            arguments: vec![distance.at_zero(local)],
            written: vec![distance],
            periodic: false,
        }));
    }

    /// Those in the argument of a curve: angles that it has the same values at after every turn may jump by turns, beside other terms too.
    fn of_argument(curve: Curve, x: &Expr, local: &[Symbol], found: &mut BTreeSet<Self>) {
        for (monomial, coefficient) in x.terms() {
            let term = Expr::term(coefficient.clone(), monomial.clone());
            let turned = multiple(&term).filter(|(_, turns)| curve.repeats_after(turns));
            match turned {
                Some((atom, _)) => Self::of_atom(&atom, local, true, found),
                None => Self::collect(&term, local, found),
            }
        }
    }

    fn of_atom(atom: &Atom, local: &[Symbol], periodic: bool, found: &mut BTreeSet<Self>) {
        let Atom::Apply(application) = atom else {
            return;
        };
        let (function, arguments) = (application.function, &application.arguments);
        if let (Function::Cos | Function::Sin, [angle]) = (function, arguments.as_slice())
            && let Some(turned) = whole_multiple(angle)
        {
            return Self::of_atom(&turned, local, true, found);
        }
        if let (Function::Curve(curve, _), [x]) = (function, arguments.as_slice()) {
            Self::of_argument(curve, x, local, found);
            return Self::of_ends(curve, x, local, found);
        }
        for argument in arguments {
            Self::collect(argument, local, found);
        }
        if matches!(
            function,
            Function::Recip | Function::Sqrt | Function::Ln | Function::Atan2
        ) {
            found.insert(Self {
                function,
                arguments: arguments.iter().map(|e| e.at_zero(local)).collect(),
                written: arguments.clone(),
                periodic,
            });
        }
    }
}

/// The function of which the expression is a whole multiple.
fn whole_multiple(expression: &Expr) -> Option<Atom> {
    let (atom, times) = multiple(expression)?;
    times.is_integer().then_some(atom)
}

/// The function of which the expression is a multiple, and how many times it is that.
fn multiple(expression: &Expr) -> Option<(Atom, Rational)> {
    let (monomial, coefficient) = expression.single_term()?;
    match (monomial.main(), monomial.units()) {
        ([(atom @ Atom::Apply(_), 1)], []) => Some((atom.clone(), coefficient.clone())),
        _ => None,
    }
}

/// Whether the expression holds no function with a singular argument.
fn is_defined_everywhere(expression: &Expr) -> bool {
    let mut found = BTreeSet::new();
    Critical::collect(expression, &[], &mut found);
    found.is_empty()
}

/// Where a function is smooth.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Smooth {
    /// On the whole domain.
    Everywhere,
    /// Where this is positive, which it is at home and, off the loci, as far as one can go from there.
    BesideHome(Expr),
}

impl Domain<'_> {
    /// Where the function is shown to be smooth; `None` where that is open.
    pub fn smooth(&self, critical: &Critical) -> Option<Smooth> {
        match (critical.function, critical.arguments.as_slice()) {
            (Function::Recip, [x]) => {
                let is_nonzero = self.nonzero(x).is_some()
                    || [x, &-x].into_iter().any(|x| self.has_positive_form(x));
                is_nonzero.then_some(Smooth::Everywhere)
            }
            (Function::Atan2, arguments) if critical.periodic => {
                self.no_common_zero(arguments).map(|_| Smooth::Everywhere)
            }
            // The angle jumps from π to −π where y passes through 0 at a negative x.
            (Function::Atan2, [y, x]) => match self.nonzero(y) {
                Some(_) => Some(Smooth::Everywhere),
                None => self.positive_off_loci(x),
            },
            (_, [x]) => self.positive_off_loci(x),
            _ => None,
        }
    }

    /// What must be positive for the functions to be smooth, beside the loci: it changes its sign beyond them.
    pub fn sides<'c>(&self, functions: impl IntoIterator<Item = &'c Critical>) -> Vec<Expr> {
        let smooth = functions.into_iter().filter_map(|f| self.smooth(f));
        let sides = smooth.filter_map(|smooth| match smooth {
            Smooth::Everywhere => None,
            Smooth::BesideHome(side) => Some(side),
        });
        let distinct: BTreeSet<Expr> = sides.collect();
        distinct.into_iter().collect()
    }

    fn positive_off_loci(&self, x: &Expr) -> Option<Smooth> {
        if self.is_positive(x) || self.has_positive_form(x) {
            return Some(Smooth::Everywhere);
        }
        let certificate = self.nonzero(x)?;
        if self.is_not_negative(x) {
            return Some(Smooth::Everywhere);
        }
        // What is not 0 keeps its sign on the component of home.
        let positive = self.is_positive(&x.substitute(&self.home));
        // A function that is not defined on the loci may change its sign there without a zero: 1/x.
        let passes_loci = self.loci.is_empty() || is_defined_everywhere(x);
        let whole = self.connected && certificate.holds_on_loci() && passes_loci;
        positive.then(|| match whole {
            true => Smooth::Everywhere,
            false => Smooth::BesideHome(x.clone()),
        })
    }
}
