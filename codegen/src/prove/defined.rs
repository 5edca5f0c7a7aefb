//! The claim that everything is defined: no quotient divides by zero, no root or logarithm leaves the positive numbers, no angle jumps.

use super::advice::exception;
use super::{
    Attempt, Identities, LEAVE_OUT, Prover, certified, degenerate, is_of_parameters, refuted,
};
use crate::diagnostic::Diagnostic;
use crate::domain::{Critical, Domain};
use crate::expr::{Expr, Function};
use crate::matrix::Matrix;
use crate::model::{Declared, Locus, Pin, Port, PoseExpr};
use crate::prepare::Prepared;
use crate::spec::code;
use std::collections::BTreeSet;
use std::ops::Range;

/// Longest expression that a message shows in full, in bytes.
const LONGEST: usize = 200;

/// Φ has derivatives at ϕ = 0. They are taken before anything is proved, and mean nothing where it has none.
pub fn retract_is_smooth(joint: &Prepared) -> Result<(), Box<Diagnostic>> {
    let Some(declared) = &joint.spec.retract else {
        return Ok(());
    };
    let domain = Domain::new(&joint.space);
    let found = Critical::in_retract(&joint.spec);
    let open = found.iter().find(|f| domain.smooth(f).is_none());
    match open {
        // Φ = Q exp(ϕ) is evaluated in closed form, however it is written.
        Some(critical) if !joint.exponential => Err(Box::new(refusal(critical, &declared.span))),
        _ => Ok(()),
    }
}

impl Prover<'_> {
    /// What is declared is smooth; that what is derived from it is so, too, comes after the claims that this rests on.
    pub(super) fn declared_is_defined(&self) -> Attempt {
        let declared = self.joint.critical();
        let open = declared.iter().find(|f| self.domain.smooth(f).is_none());
        match open {
            Some(open) => {
                let span = self.statement_with(open);
                let error = self.with_other_end(refusal(open, &span), open, &declared);
                let mut ports = self.joint.spec.ports.iter();
                let is_port = ports.any(|port| port.span == span);
                Err(Box::new(match is_port && open.function == Function::Atan2 {
                    true => error.note("a port that is an angle up to whole turns is declared by its direction: an element of S1 or SO2, or `[c, s]`"),
                    false => error,
                }))
            }
            None => Ok(None),
        }
    }

    /// The error of a curve's end with that of its other end, where nothing keeps the joint from that one either; and whether home is at one.
    fn with_other_end(
        &self,
        error: Diagnostic,
        open: &Critical,
        declared: &BTreeSet<Critical>,
    ) -> Diagnostic {
        let Function::Curve(curve, _) = open.function else {
            return error;
        };
        let ends = declared.iter().filter(|f| f.function == open.function);
        let others = ends.filter(|f| *f != open && self.domain.smooth(f).is_none());
        let mut error = error;
        let mut arguments = open.arguments.clone();
        for other in others {
            let Some(argument) = other.arguments.first() else {
                continue;
            };
            let written = in_words(&exception(argument));
            error = error.note(format!("it ends where {written} is 0 as well"));
            arguments.push(argument.clone());
        }
        let mut arguments = arguments.iter();
        match arguments.any(|end| degenerate::is_at_home(end, self.joint, &self.domain)) {
            true => error.note(format!(
                "home is at an end of `{}`: give another one by `home = …;`",
                curve.name()
            )),
            false => error,
        }
    }

    /// Every quotient, root, logarithm and angle in what is evaluated at Q is smooth there.
    pub(super) fn is_defined(&self) -> Attempt {
        let (declared, derived) = (self.joint.critical(), self.derived_functions());
        let count = declared.union(&derived).count();
        if count == 0 {
            return Ok(None);
        }
        let is_open = |f: &&Critical| self.domain.smooth(f).is_none();
        let open = declared.iter().find(is_open).or_else(|| {
            let mut derived = derived.difference(&declared);
            derived.find(|f| !self.follows(f, &declared) && is_open(f))
        });
        if let Some(open) = open {
            return Err(Box::new(refusal(open, &self.statement_with(open))));
        }
        let spec = &self.joint.spec;
        let all = match (spec.ports.is_empty(), spec.pins.is_empty()) {
            (true, true) => "H, Φ, X, S, A and S̄ are smooth at Q",
            (false, true) => "H, Φ, X, S, A, S̄ and ports are smooth at Q",
            (true, false) => "H, Φ, X, S, A, S̄ and pins are smooth at Q",
            (false, false) => "H, Φ, X, S, A, S̄, ports and pins are smooth at Q",
        };
        let mut statement = self.where_it_holds(all);
        let sides = self.sides();
        if !sides.is_empty() {
            let sides: Vec<String> = sides.iter().map(|side| format!("{side} > 0")).collect();
            statement += &format!(", on the side of home alone: where {}", sides.join(" and "));
        }
        Ok(Some(certified(
            "defined",
            &statement,
            &format!(
                "quotients, roots, logarithms and angles in them: {count}; all are smooth at their arguments"
            ),
        )))
    }

    /// The statement of the spec in which the function stands; that of H, from which most is derived, where it stands in none.
    fn statement_with(&self, critical: &Critical) -> Range<usize> {
        let joint = self.joint;
        let of_matrix = |declared: &Declared<Matrix>| {
            (declared.value.entries().to_vec(), declared.span.clone())
        };
        let of_pose = |pose: &Declared<PoseExpr>| {
            (pose.value.entries().cloned().collect(), pose.span.clone())
        };
        let matrices = [
            &joint.spec.twist_map,
            &joint.spec.constraint,
            &joint.spec.speed_basis,
        ];
        let of_locus =
            |locus: &Declared<Locus>| (vec![locus.value.function.clone()], locus.span.clone());
        let of_port = |port: &Declared<Port>| {
            let entries = port.value.entries().into_iter().cloned();
            (entries.collect(), port.span.clone())
        };
        let of_pin =
            |pin: &Declared<Pin>| (pin.value.entries().cloned().collect(), pin.span.clone());
        let poses = joint.spec.poses().map(of_pose);
        let statements = poses
            .chain(matrices.into_iter().flatten().map(of_matrix))
            .chain(joint.space.loci.iter().map(of_locus))
            .chain(joint.spec.ports.iter().map(of_port))
            .chain(joint.spec.pins.iter().map(of_pin));
        let holds = |entries: &[Expr]| {
            let mut found = BTreeSet::new();
            entries
                .iter()
                .for_each(|e| Critical::collect(e, &[], &mut found));
            found.contains(critical)
        };
        let in_retract = || {
            let declared = joint.spec.retract.as_ref()?;
            let found = Critical::in_retract(&joint.spec);
            found.contains(critical).then(|| declared.span.clone())
        };
        let found = statements.into_iter().find(|(entries, _)| holds(entries));
        found
            .map(|(_, span)| span)
            .or_else(in_retract)
            .unwrap_or(joint.spec.pose.span.clone())
    }

    /// Functions with a singular argument in what is derived and evaluated at a configuration.
    fn derived_functions(&self) -> BTreeSet<Critical> {
        let x = self.x;
        let mut found = BTreeSet::new();
        let matrices = [&x.twist_map, &x.twist_map_child]
            .into_iter()
            .chain([&x.jacobian.base, &x.jacobian.child])
            .chain([&x.velocity_map.base, &x.velocity_map_inverse])
            .chain(&x.velocity_map.slopes)
            .chain([&x.nonholonomic.constraint, &x.nonholonomic.speed_basis])
            .chain([&x.port_map])
            .chain(x.flow.iter().flat_map(|flow| [&flow.tangent, &flow.normal]));
        collect(matrices, &mut found);
        found
    }

    /// Whether a function is smooth because declared ones are, whose arguments it holds in another form.
    fn follows(&self, critical: &Critical, declared: &BTreeSet<Critical>) -> bool {
        let [argument] = critical.arguments.as_slice() else {
            return false;
        };
        let of_quotient = critical.function == Function::Recip;
        let mut known =
            declared
                .iter()
                .flat_map(|other| match (other.function, other.arguments.as_slice()) {
                    (Function::Recip, [x]) if of_quotient => vec![x.clone()],
                    (Function::Sqrt | Function::Ln, [x]) if of_quotient => {
                        vec![x.clone(), x.sqrt()]
                    }
                    (Function::Sqrt | Function::Ln, [x]) => vec![x.clone()],
                    (Function::Atan2, [y, x]) if of_quotient => vec![&y.square() + &x.square()],
                    _ => vec![],
                });
        // A quotient needs no sign; roots and logarithms do, which a multiple may not have.
        known.any(|x| {
            x == *argument
                || self.ideal.vanishes(&(&x - argument))
                || of_quotient && self.are_multiples(&x, argument)
        })
    }

    /// Whether one is a multiple of the other on the manifold, by a constant that is not 0.
    fn are_multiples(&self, a: &Expr, b: &Expr) -> bool {
        let coefficient = |e: &Expr| {
            let normal = self.ideal.normal_form(e);
            let (monomial, coefficient) = normal.leading()?;
            let coefficient = Expr::term(coefficient.clone(), monomial.split().1);
            self.domain.is_unit(&coefficient).then_some(coefficient)
        };
        match (coefficient(a), coefficient(b)) {
            (Some(of_a), Some(of_b)) => self.ideal.vanishes(&(&(a * &of_b) - &(b * &of_a))),
            _ => false,
        }
    }
}

impl Identities<'_> {
    /// What is positive wherever the joint lives, beside the loci.
    pub(super) fn sides(&self) -> Vec<Expr> {
        let declared = self.joint.critical();
        self.domain.sides(&declared)
    }
}

fn collect<'m>(matrices: impl Iterator<Item = &'m Matrix>, found: &mut BTreeSet<Critical>) {
    let entries = matrices.flat_map(Matrix::entries);
    entries.for_each(|e| Critical::collect(e, &[], found));
}

fn refusal(critical: &Critical, span: &Range<usize>) -> Diagnostic {
    let [argument, rest @ ..] = critical.arguments.as_slice() else {
        return refuted(
            code::NOT_DEFINED,
            span,
            "a function without arguments",
            "here",
        );
    };
    let moves = critical.arguments != critical.written;
    let vanishes = critical.arguments.iter().all(Expr::is_zero);
    if moves && vanishes {
        return at_base(critical, span);
    }
    let written = match critical.function {
        Function::Curve(..) => in_words(&exception(argument)),
        _ => in_words(argument),
    };
    let message = match (critical.function, rest) {
        (Function::Recip, _) => format!("a quotient by {written}, which may be 0"),
        (Function::Curve(curve, _), _) => format!(
            "the curve `{}` ends where {written} is 0, and nothing keeps the joint from going there",
            curve.name()
        ),
        (Function::Ln, _) => {
            format!("the logarithm of {written}, which is not shown to be positive")
        }
        (Function::Atan2, [x, ..]) if critical.periodic => format!(
            "the angle of the point ({}, {written}), which is not shown to keep off the origin",
            in_words(x)
        ),
        (Function::Atan2, [x, ..]) => format!(
            "the angle of the point ({}, {written}), which is not shown to keep off the origin and off the negative axis, where it jumps",
            in_words(x)
        ),
        _ => format!("the root of {written}, which is not smooth where that is 0"),
    };
    let short = |text: String| match text.len() <= LONGEST {
        true => text,
        false => "…".to_owned(),
    };
    let locus = match (critical.function, rest) {
        (Function::Atan2, [x]) if critical.periodic => {
            short((&argument.square() + &x.square()).to_string())
        }
        (Function::Atan2, _) => "…".to_owned(),
        (Function::Curve(..) | Function::Recip, _) => short(exception(argument).to_string()),
        // Roots and logarithms have a value on the side where it is positive.
        _ => short(argument.to_string()),
    };
    let otherwise = match critical.function {
        Function::Curve(..) => "`continue linear` gives the curve values beyond its ends",
        _ => "ranges of parameters and `require` help to show that it does not vanish",
    };
    let help = match is_of_parameters(argument) && rest.iter().all(is_of_parameters) {
        true => LEAVE_OUT.to_owned(),
        false => format!("if the joint ends there, declare it: `except {locus} = 0;`; {otherwise}"),
    };
    refuted(code::NOT_DEFINED, span, &message, "the joint needs it").help(help)
}

/// The expression; a long one by its number of terms and its symbols.
fn in_words(expression: &Expr) -> String {
    let text = expression.to_string();
    if text.len() <= LONGEST {
        return text;
    }
    let symbols = expression.symbols();
    let names: Vec<&str> = symbols.iter().map(|symbol| symbol.spelling()).collect();
    let count = expression.terms().len();
    format!("a sum of {count} terms in {}", names.join(", "))
}

/// The function is singular at ϕ = 0 itself.
fn at_base(critical: &Critical, span: &Range<usize>) -> Diagnostic {
    let written: Vec<String> = critical.written.iter().map(Expr::to_string).collect();
    let written = written.join(", ");
    let message = match critical.function {
        Function::Recip => format!("Φ divides by {written}, which is 0 at ϕ = 0"),
        Function::Curve(curve, _) => {
            format!("Φ takes the curve `{}` at its end", curve.name())
        }
        Function::Ln => format!("Φ takes the logarithm of {written}, which is 0 at ϕ = 0"),
        Function::Atan2 => format!("Φ takes atan2({written}), and both are 0 at ϕ = 0"),
        _ => format!("Φ takes the root of {written}, which is 0 at ϕ = 0"),
    };
    refuted(
        code::NOT_DEFINED,
        span,
        &message,
        "has no derivatives at ϕ = 0",
    )
    .help("write Φ by functions that are smooth there: exp(phi), or a sum divided by its norm")
}
