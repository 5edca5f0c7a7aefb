//! The freedoms: those of each `basis`, then the coordinates of real factors without one; or those of `local`.

use super::super::ast::{Basis, Name, Target};
use super::super::code;
use super::super::evaluate::Evaluator;
use super::super::names::Form;
use super::once::At;
use super::scope::Scope;
use super::{Context, basis, frame};
use crate::diagnostic::Diagnostic;
use crate::expr::{Expr, Role, Symbol};
use crate::manifold::{Factor, Kind};
use crate::model::{Declared, Freedom, VelocityFrame};

/// Most freedoms: those of a free body.
const MOST_FREEDOMS: usize = 6;

/// The freedoms of a joint.
pub(super) struct Freedoms {
    pub list: Declared<Vec<Freedom>>,
    /// Whether they are those of `local`, with a Phi of their own.
    pub local: bool,
}

/// All freedoms, in order; `None` where they cannot be told.
pub(super) fn freedoms(context: &Context<'_>, scope: &mut Scope<'_, '_, '_>) -> Option<Freedoms> {
    let freedoms = match context.statements.local {
        Some(local) => local_freedoms(context, local, scope)?,
        None => Freedoms {
            list: basis_freedoms(context, scope)?,
            local: false,
        },
    };
    let count = freedoms.list.value.len();
    if count > MOST_FREEDOMS {
        let span = freedoms.list.span.clone();
        let error = Diagnostic::new(
            code::FREEDOMS,
            span,
            format!("{count} freedoms, a joint has at most {MOST_FREEDOMS}"),
        );
        scope.evaluator.report(error.label("too many"));
        return None;
    }
    Some(freedoms)
}

fn basis_freedoms(
    context: &Context<'_>,
    scope: &mut Scope<'_, '_, '_>,
) -> Option<Declared<Vec<Freedom>>> {
    let factors = context.manifold.value.factors();
    let (mut list, mut taken, mut complete) = (vec![], vec![], true);
    for at in &context.statements.bases {
        claim(at.value.elements.iter().map(|(name, _)| name), scope);
        let Some(factor) = basis::factor(at.value, factors, &taken, scope.evaluator) else {
            complete = false;
            continue;
        };
        taken.push(factor);
        let kind = factors[factor].kind;
        match scope.evaluator.bounded("basis", at.span, |evaluator| {
            basis::generators(*at, kind, evaluator)
        }) {
            Some(generators) => list.extend(named(at.value, factor, generators, list.len())),
            None => complete = false,
        }
    }
    for (n, factor) in factors
        .iter()
        .enumerate()
        .filter(|(n, _)| !taken.contains(n))
    {
        match factor.kind {
            Kind::Real(size) => list.extend(coordinates(factor, n, size, list.len())),
            // A basis that could not be read, or names no factor, may be this one's.
            _ if context.file.partial || !complete => complete = false,
            _ => {
                scope.evaluator.report(no_basis(context, factor));
                complete = false;
            }
        }
    }
    let span = context
        .statements
        .bases
        .first()
        .map_or(&context.manifold.span, |at| at.span);
    complete.then(|| Declared {
        value: list,
        span: span.clone(),
    })
}

fn claim<'n>(names: impl Iterator<Item = &'n Name>, scope: &mut Scope<'_, '_, '_>) {
    for name in names {
        scope.claim(name, Form::Snake, "a freedom");
        scope.claim_text(&local_name(&name.text), &name.span, "a local coordinate");
    }
}

fn local_name(freedom: &str) -> String {
    format!("phi_{freedom}")
}

fn freedom(name: &str, number: usize, factor: usize, generator: Vec<Expr>) -> Freedom {
    let local = Symbol::new(Role::Local, number, &local_name(name));
    Freedom {
        name: name.to_owned(),
        local,
        factor,
        generator,
    }
}

fn named(basis: &Basis, factor: usize, generators: Vec<Vec<Expr>>, first: usize) -> Vec<Freedom> {
    let names = basis.elements.iter().map(|(name, _)| name.text.as_str());
    names
        .zip(generators)
        .enumerate()
        .map(|(n, (name, generator))| freedom(name, first + n, factor, generator))
        .collect()
}

/// The freedoms of a real factor without a basis.
fn coordinates(factor: &Factor, index: usize, size: usize, first: usize) -> Vec<Freedom> {
    let unit = |n: usize| (0..size).map(|i| Expr::integer((i == n).into())).collect();
    let symbols = factor.coordinates.iter().enumerate();
    symbols
        .map(|(n, symbol)| freedom(&symbol.name, first + n, index, unit(n)))
        .collect()
}

fn no_basis(context: &Context<'_>, factor: &Factor) -> Diagnostic {
    let message = format!(
        "factor `{}` has no basis, so that its freedoms have no names and no directions",
        factor.name
    );
    let error = Diagnostic::new(code::BASIS_MISSING, context.manifold.span.clone(), message)
        .label(format!("{} without a basis", factor.kind.name()));
    match factor.kind.algebra_name() {
        Some(algebra) => {
            let names: Vec<String> = (1..=factor.kind.dimension())
                .map(|n| format!("e{n}"))
                .collect();
            error.help(format!("add `basis {} of {algebra};`", names.join(", ")))
        }
        None => {
            error.help("it is no group: name its freedoms by `local a, b;` and declare Phi and X")
        }
    }
}

/// `local a, b;`: freedoms that only Phi gives a meaning.
fn local_freedoms(
    context: &Context<'_>,
    local: At<'_, [Name]>,
    scope: &mut Scope<'_, '_, '_>,
) -> Option<Freedoms> {
    claim(local.value.iter(), scope);
    let statements = context.statements;
    let missing: Vec<&str> = [Target::Retract, Target::TwistMap]
        .into_iter()
        .filter(|target| statements.target(*target).is_none() && !context.file.partial)
        .map(Target::name)
        .collect();
    if !missing.is_empty() {
        let message = format!("`local` needs {} declared", missing.join(" and "));
        let error = Diagnostic::new(code::MISSING, local.span.clone(), message)
            .label("no meaning without them");
        scope.evaluator.report(
            error.help(
                "Phi says how the configuration moves with these coordinates, X what v means",
            ),
        );
    }
    if let Some(basis) = statements.bases.first() {
        let error = Diagnostic::new(
            code::BASIS_MISSING,
            basis.span.clone(),
            "a joint has either `basis` or `local`",
        );
        scope.evaluator.report(
            error
                .label("beside `local`")
                .help("with `local`, Phi alone says what the freedoms are"),
        );
    }
    let dimension = context.manifold.value.dimension();
    if local.value.len() > dimension {
        let message = format!(
            "{} local coordinates on a manifold of dimension {dimension}",
            local.value.len()
        );
        scope
            .evaluator
            .report(Diagnostic::new(code::FREEDOMS, local.span.clone(), message).label("too many"));
        return None;
    }
    let list = local
        .value
        .iter()
        .enumerate()
        .map(|(n, name)| freedom(&name.text, n, 0, vec![]))
        .collect();
    Some(Freedoms {
        list: Declared {
            value: list,
            span: local.span.clone(),
        },
        local: true,
    })
}

/// The frame of v: never implied where it matters, never declared where it means nothing.
pub(super) fn velocity(
    context: &Context<'_>,
    freedoms: &Freedoms,
    evaluator: &mut Evaluator<'_>,
) -> Declared<VelocityFrame> {
    let statements = context.statements;
    let needed = freedoms.frame_needed(&context.manifold.value);
    let twist_map = statements.target(Target::TwistMap);
    match (statements.velocity, twist_map) {
        (Some(velocity), _) => {
            if !needed {
                evaluator.report(meaningless(velocity, freedoms.local));
            }
            Declared {
                value: frame(*velocity.value),
                span: velocity.span.clone(),
            }
        }
        (None, Some(twist_map)) => Declared {
            value: VelocityFrame::Rates,
            span: twist_map.span.clone(),
        },
        (None, None) => {
            if needed && !context.file.partial {
                evaluator.report(undeclared(freedoms));
            }
            Declared {
                value: VelocityFrame::Rates,
                span: context.manifold.span.clone(),
            }
        }
    }
}

fn meaningless(velocity: At<'_, bool>, local: bool) -> Diagnostic {
    let message = match local {
        true => "with `local`, X says what v means",
        false => "v of a joint in real coordinates is the rate of its coordinates, in no frame",
    };
    let error = Diagnostic::new(code::VELOCITY_UNUSED, velocity.span.clone(), message);
    error
        .label("means nothing here")
        .help("remove this statement")
}

fn undeclared(freedoms: &Freedoms) -> Diagnostic {
    let message = "the frame in which v is read is not declared, and none is implied";
    let error = Diagnostic::new(code::VELOCITY_MISSING, freedoms.list.span.clone(), message)
        .label("v belongs to this basis");
    error
        .note("in the child frame the twist is Ad_H of the basis, in the parent frame it is the basis itself; they are different velocities")
        .help("add `velocity in child;` or `velocity in parent;`, or declare X")
}
