//! `H`, `X`, `A`, `S_bar` and `speeds`: shapes, and that A and S_bar belong together.

use super::super::ast::{Name, Node, Target};
use super::super::evaluate::Evaluator;
use super::super::names::{self, Form};
use super::super::value::Value;
use super::super::{code, evaluate};
use super::Context;
use super::once::{At, Once};
use crate::diagnostic::Diagnostic;
use crate::matrix::Matrix;
use crate::model::{Declared, PoseExpr};

/// The optional matrices of a joint.
pub(super) struct Matrices {
    pub twist_map: Option<Declared<Matrix>>,
    pub constraint: Option<Declared<Matrix>>,
    pub speed_basis: Option<Declared<Matrix>>,
    pub speed_names: Option<Declared<Vec<String>>>,
}

/// Evaluates them where the degrees of freedom are not known, for the errors in them.
pub(super) fn evaluate_only(statements: &Once<'_>, evaluator: &mut Evaluator<'_>) {
    for target in [Target::TwistMap, Target::Constraint, Target::SpeedBasis] {
        if let Some(statement) = statements.target(target) {
            value(target.name(), statement, evaluator);
        }
    }
}

/// Evaluates all of them, for a joint of these degrees of freedom.
pub(super) fn matrices(
    context: &Context<'_>,
    freedoms: &[&str],
    evaluator: &mut Evaluator<'_>,
) -> Matrices {
    let bodies = context.statements.body_count();
    let mut read = |target| {
        context
            .statements
            .target(target)
            .and_then(|statement| matrix(target, statement, (freedoms, bodies), evaluator))
    };
    let (twist_map, constraint, speed_basis) = (
        read(Target::TwistMap),
        read(Target::Constraint),
        read(Target::SpeedBasis),
    );
    let k = freedoms.len();
    check_pair(k, &constraint, &speed_basis, evaluator);
    let speed_names = context
        .statements
        .speeds
        .map(|speeds| speed_names(context, k, speeds, &constraint, &speed_basis, evaluator));
    Matrices {
        twist_map,
        constraint,
        speed_basis,
        speed_names,
    }
}

/// The only value of a statement other than Phi.
fn value(name: &str, statement: At<'_, [Node]>, evaluator: &mut Evaluator<'_>) -> Option<Value> {
    let node = statement.value.first()?;
    evaluator.bounded(name, statement.span, |evaluator| evaluator.value(node))
}

/// H, or H of one body, as `name` says: a pose, a rotation alone, or a homogeneous 4×4 matrix.
pub(super) fn pose(
    name: &str,
    statement: At<'_, [Node]>,
    evaluator: &mut Evaluator<'_>,
) -> Option<PoseExpr> {
    let value = value(name, statement, evaluator)?;
    if let Some(pose) = value.as_pose() {
        return Some(pose);
    }
    let span = statement
        .value
        .first()
        .map_or(statement.span, |node| &node.span)
        .clone();
    let Some(matrix) = value.as_shape(4, 4) else {
        let error = Diagnostic::new(
            code::DECLARED_SHAPE,
            span,
            format!("{name} is a pose, found {}", value.describe()),
        )
        .label("not a pose");
        evaluator.report(
            error.help("write pose(R, p), or a product of rot_z(q), trans(p) and their like"),
        );
        return None;
    };
    let last = matrix.block(3, 0, 1, 4);
    if last != Matrix::integers(&[[0, 0, 0, 1]]) {
        let error = Diagnostic::new(code::POSE, span, "the last row of a pose is [0, 0, 0, 1]")
            .label("not a pose");
        evaluator.report(error.note(format!("it is {last}")));
        return None;
    }
    Some(PoseExpr {
        rotation: matrix.block(0, 0, 3, 3),
        translation: matrix.block(0, 3, 3, 1),
    })
}

fn matrix(
    target: Target,
    statement: At<'_, [Node]>,
    (freedoms, bodies): (&[&str], usize),
    evaluator: &mut Evaluator<'_>,
) -> Option<Declared<Matrix>> {
    let k = freedoms.len();
    let value = value(target.name(), statement, evaluator)?;
    let matrix = match (target, &value) {
        (Target::TwistMap, _) => value.as_shape(6 * bodies, k),
        (_, Value::List(entries)) if entries.len() == k => value.as_shape(k, 1),
        _ => value
            .as_matrix()
            .filter(|matrix| matrix.rows() == k && (1..k).contains(&matrix.columns())),
    };
    if matrix.is_none() {
        let span = statement
            .value
            .first()
            .map_or(statement.span, |node| &node.span)
            .clone();
        let shape = match target {
            Target::TwistMap if bodies > 1 => format!(
                "the shape {}×{k}, a twist of each body, one below the other, for each degree of freedom",
                6 * bodies
            ),
            Target::TwistMap => format!("the shape 6×{k}, a twist for each degree of freedom"),
            Target::Constraint => format!(
                "{k} rows, one for each degree of freedom, and fewer columns, one for each constraint"
            ),
            _ => format!(
                "{k} rows, one for each degree of freedom, and fewer columns, one for each speed"
            ),
        };
        let message = format!(
            "{} is {}; it must have {shape}",
            target.name(),
            value.describe()
        );
        let error = Diagnostic::new(code::DECLARED_SHAPE, span, message).label("wrong shape");
        evaluator.report(error.note(format!(
            "the degrees of freedom are {}",
            freedoms.join(", ")
        )));
    }
    Some(Declared {
        value: matrix?,
        span: statement.span.clone(),
    })
}

/// The columns of A and of S_bar, where both stand, add up to the degrees of freedom.
fn check_pair(
    k: usize,
    constraint: &Option<Declared<Matrix>>,
    speed_basis: &Option<Declared<Matrix>>,
    evaluator: &mut Evaluator<'_>,
) {
    if let (Some(a), Some(s)) = (constraint, speed_basis)
        && a.value.columns() + s.value.columns() != k
    {
        let (constraints, speeds) = (a.value.columns(), s.value.columns());
        let message = format!(
            "the columns of A ({constraints}) and of S_bar ({speeds}) do not add up to the degrees of freedom ({k})"
        );
        let error = Diagnostic::new(code::CONSTRAINT, s.span.clone(), message);
        evaluator.report(error.label(format!("expected columns: {}", k - constraints)));
    }
}

/// k̄, where A or S_bar decides it.
fn speed_count(
    freedoms: usize,
    constraint: &Option<Declared<Matrix>>,
    speed_basis: &Option<Declared<Matrix>>,
) -> Option<usize> {
    let allowed = speed_basis.as_ref().map(|s| s.value.columns());
    allowed.or_else(|| Some(freedoms - constraint.as_ref()?.value.columns()))
}

fn speed_names(
    context: &Context<'_>,
    freedoms: usize,
    speeds: At<'_, [Name]>,
    constraint: &Option<Declared<Matrix>>,
    speed_basis: &Option<Declared<Matrix>>,
    evaluator: &mut Evaluator<'_>,
) -> Declared<Vec<String>> {
    let mut list: Vec<String> = vec![];
    for name in speeds.value {
        evaluator
            .errors
            .extend(names::check(name, Form::Snake, evaluate::FUNCTIONS));
        if list.contains(&name.text) {
            let error = Diagnostic::new(
                code::DUPLICATE_NAME,
                name.span.clone(),
                format!("speed `{}` is named twice", name.text),
            );
            evaluator.report(error.label("named again here"));
        }
        list.push(name.text.clone());
    }
    let count = speed_count(freedoms, constraint, speed_basis);
    let is_derived = constraint.is_some() && speed_basis.is_none();
    let of = |target| context.statements.target(target).is_none();
    let holonomic = of(Target::SpeedBasis) && of(Target::Constraint) && !context.file.partial;
    let message = match count {
        Some(count) if count != list.len() => {
            let names = match list.len() {
                1 => "1 name".to_owned(),
                several => format!("{several} names"),
            };
            Some(format!("{names} for {count} speeds"))
        }
        None if holonomic => Some("names of speeds without A or S_bar".to_owned()),
        _ => None,
    };
    if let Some(message) = message {
        let error =
            Diagnostic::new(code::SPEEDS, speeds.span.clone(), message).label("these speeds");
        evaluator.report(error.help(match is_derived {
            true => "A leaves as many speeds as v has entries and A no columns; S_bar is derived from A: give S_bar to choose its columns, which `speeds` names in order",
            false => "`speeds` names the columns of S_bar, in order",
        }));
    }
    Declared {
        value: list,
        span: speeds.span.clone(),
    }
}
