//! The freedoms: those of each `basis`, then those of `local`, or the coordinates of real factors without a basis.

use super::super::ast::{Basis, Name, Target};
use super::super::code;
use super::super::evaluate::Evaluator;
use super::super::names::Form;
use super::once::At;
use super::scope::Scope;
use super::{Context, basis, frame, implicit};
use crate::diagnostic::Diagnostic;
use crate::expr::{Expr, Role, Symbol};
use crate::manifold::{Factor, Kind};
use crate::model::{Declared, Freedom, Implicit, VelocityFrame};
use std::ops::Range;

/// Most freedoms: those of a free body.
const MOST_FREEDOMS: usize = 16;

/// The degrees of freedom of a joint.
pub(super) struct Freedoms {
    pub list: Declared<Vec<Freedom>>,
    /// Whether some are those of `local`, which only Phi gives a meaning.
    pub local: bool,
    /// How they move Q on the manifold of the relations, where Phi is not declared.
    pub implicit: Option<Implicit>,
}

/// All degrees of freedom, in order; `None` where they cannot be told.
pub(super) fn freedoms(context: &Context<'_>, scope: &mut Scope<'_, '_, '_>) -> Option<Freedoms> {
    let mut bases = basis_freedoms(context, scope);
    let local = context.statements.local;
    let implicit = implicit::implicit(context, &bases.list, local.map(|names| names.value.len()));
    if implicit.is_some() {
        implicit::without_generators(&mut bases.list);
    }
    let list = match (local, &implicit) {
        (None, Some(Implicit::CrossProduct)) => vec![freedom(implicit::ALONG, 0, 0, vec![])],
        (None, Some(_)) => bases.complete.then_some(bases.list)?,
        (Some(local), by_relations) => {
            local_freedoms(context, local, bases, by_relations.is_some(), scope)?
        }
        (None, None) => coordinate_freedoms(context, bases, scope)?,
    };
    let first = context.statements.bases.first().map(|at| at.span);
    let local_or_implicit = local.is_some() || implicit.is_some();
    let span = first
        .or(local.map(|at| at.span))
        .unwrap_or(&context.manifold.span);
    if let Some(error) = too_many(context, list.len(), span) {
        scope.evaluator.report(error);
        return None;
    }
    Some(Freedoms {
        list: Declared {
            value: list,
            span: span.clone(),
        },
        local: local_or_implicit,
        implicit,
    })
}

/// The error that there are more degrees of freedom than a joint, or its configuration, can have.
fn too_many(context: &Context<'_>, count: usize, span: &Range<usize>) -> Option<Diagnostic> {
    let error = |message| Diagnostic::new(code::FREEDOMS, span.clone(), message).label("too many");
    let dimension = context.manifold.value.dimension();
    let related = !context.statements.relations.is_empty();
    if related && count >= dimension {
        let message = format!(
            "{count} degrees of freedom, and relations leave fewer than {dimension} of the factors"
        );
        return Some(error(message).help(
            "name the directions that are independent by `basis`, or, for one degree of freedom, none; the others follow by the relations",
        ));
    }
    if count > MOST_FREEDOMS {
        return Some(error(format!(
            "{count} degrees of freedom, a joint has at most {MOST_FREEDOMS}"
        )));
    }
    (count > dimension).then(|| {
        error(format!(
            "{count} degrees of freedom on a manifold of dimension {dimension}"
        ))
    })
}

/// The degrees of freedom of the `basis` statements.
struct Bases {
    list: Vec<Freedom>,
    /// Factors that have one.
    taken: Vec<usize>,
    /// Whether every statement could be read.
    complete: bool,
}

fn basis_freedoms(context: &Context<'_>, scope: &mut Scope<'_, '_, '_>) -> Bases {
    let factors = context.manifold.value.factors();
    // Where relations alone say how Q moves, a basis names independent directions.
    let declared = context.statements.target(Target::Retract).is_some();
    let of_subgroup = declared || context.statements.relations.is_empty();
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
            basis::generators(*at, kind, of_subgroup, evaluator)
        }) {
            Some(generators) => list.extend(named(at.value, factor, generators, list.len())),
            None => complete = false,
        }
    }
    Bases {
        list,
        taken,
        complete,
    }
}

/// Those of the bases, then the coordinates of real factors without one; every other factor needs a basis.
fn coordinate_freedoms(
    context: &Context<'_>,
    bases: Bases,
    scope: &mut Scope<'_, '_, '_>,
) -> Option<Vec<Freedom>> {
    let Bases {
        mut list,
        taken,
        mut complete,
    } = bases;
    let factors = context.manifold.value.factors().iter().enumerate();
    for (n, factor) in factors.filter(|(n, _)| !taken.contains(n)) {
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
    complete.then_some(list)
}

fn claim<'n>(names: impl Iterator<Item = &'n Name>, scope: &mut Scope<'_, '_, '_>) {
    for name in names {
        scope.claim(name, Form::Snake, "a degree of freedom");
        scope.claim_text(&local_name(&name.text), &name.span, "a local coordinate");
    }
}

fn local_name(freedom: &str) -> String {
    format!("phi_{freedom}")
}

fn freedom(name: &str, number: usize, factor: usize, generator: Vec<Expr>) -> Freedom {
    let local = Symbol::new(Role::Local, number, &local_name(name));
    let local = local.spelled(&format!("phi.{name}"));
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

/// The degrees of freedom of a real factor without a basis.
fn coordinates(factor: &Factor, index: usize, size: usize, first: usize) -> Vec<Freedom> {
    let unit = |n: usize| (0..size).map(|i| Expr::integer((i == n).into())).collect();
    let symbols = factor.coordinates.iter().enumerate();
    symbols
        .map(|(n, symbol)| freedom(symbol.name(), first + n, index, unit(n)))
        .collect()
}

fn no_basis(context: &Context<'_>, factor: &Factor) -> Diagnostic {
    let message = format!(
        "factor `{}` has no basis, so that its degrees of freedom have no names and no directions",
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
        None => error
            .help("it is no group: name its degrees of freedom by `local a, b;` and declare Phi"),
    }
}

/// Those of the bases, then those of `local a, b;`, which only Phi gives a meaning.
fn local_freedoms(
    context: &Context<'_>,
    local: At<'_, [Name]>,
    bases: Bases,
    by_relations: bool,
    scope: &mut Scope<'_, '_, '_>,
) -> Option<Vec<Freedom>> {
    claim(local.value.iter(), scope);
    let declared = context.statements.target(Target::Retract).is_some();
    if !declared && !by_relations && !context.file.partial {
        let error = Diagnostic::new(
            code::MISSING,
            local.span.clone(),
            "`local` needs Phi declared",
        );
        scope.evaluator.report(
            error
                .label("no meaning without it")
                .help("Phi says how the configuration moves with these coordinates"),
        );
    }
    let mut list = bases.list;
    for name in local.value {
        list.push(freedom(&name.text, list.len(), 0, vec![]));
    }
    bases.complete.then_some(list)
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
                let declared = statements.local.is_some();
                evaluator.report(meaningless(velocity, declared, freedoms.local));
            } else if !velocity.value && statements.body_count() > 1 {
                evaluator.report(of_no_body(velocity));
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

fn meaningless(velocity: At<'_, bool>, local: bool, by_relations: bool) -> Diagnostic {
    let message = match (local, by_relations) {
        (true, _) => "with `local`, v is the rate of the local coordinates, or what X says",
        (false, true) => {
            "v of a joint with relations is the rate along the directions that `basis` names, or along the one that the relations leave, or what X says"
        }
        (false, false) => {
            "v of a joint in real coordinates is the rate of its coordinates, in no frame"
        }
    };
    let error = Diagnostic::new(code::VELOCITY_UNUSED, velocity.span.clone(), message);
    error
        .label("means nothing here")
        .help("remove this statement")
}

/// The error that velocities in parent axes are those of one body.
fn of_no_body(velocity: At<'_, bool>) -> Diagnostic {
    let message =
        "the parent frame in which v is read is that of one body, and this joint carries several";
    Diagnostic::new(code::PARENT_FRAME, velocity.span.clone(), message)
        .label("of which body?")
        .help("read v in the child frame, or declare X in its place, the twists of all bodies one below the other")
}

fn undeclared(freedoms: &Freedoms) -> Diagnostic {
    let message = "the frame in which v is read is not declared, and none is implied";
    let error = Diagnostic::new(code::VELOCITY_MISSING, freedoms.list.span.clone(), message)
        .label("v belongs to this basis");
    error
        .note("v multiplies the basis: in the child frame with `velocity in child`, in the parent frame with `velocity in parent`; these are different velocities")
        .help("add `velocity in child;` or `velocity in parent;`, or declare X")
}
