//! `basis`: generators of a subgroup, in the standard basis of a factor's algebra.

use super::super::ast::{Basis, Name, Node};
use super::super::evaluate::Evaluator;
use super::super::value::Value;
use super::super::{code, names};
use super::once::At;
use crate::algebra;
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::manifold::{Factor, Ideal, Kind, LARGEST_REAL};
use crate::matrix::Matrix;
use std::ops::Range;

/// The factor that a basis is of: the one it names, or the first with that algebra that is not yet taken.
pub(super) fn factor(
    basis: &Basis,
    factors: &[Factor],
    taken: &[usize],
    evaluator: &mut Evaluator<'_>,
) -> Option<usize> {
    if !algebras().contains(&basis.algebra.text) {
        evaluator.report(unknown_algebra(&basis.algebra));
        return None;
    }
    let fits =
        |n: &usize| factors[*n].kind.algebra_name().as_deref() == Some(basis.algebra.text.as_str());
    let chosen = match &basis.factor {
        Some(name) => (0..factors.len())
            .find(|&n| factors[n].name == name.text)
            .filter(fits),
        None => (0..factors.len()).find(|n| fits(n) && !taken.contains(n)),
    };
    match chosen {
        Some(n) if taken.contains(&n) => {
            let message = format!("factor `{}` has a basis already", factors[n].name);
            let error = Diagnostic::new(
                code::DUPLICATE_STATEMENT,
                basis.algebra.span.clone(),
                message,
            );
            evaluator.report(error.label("its second basis"));
            None
        }
        Some(n) => Some(n),
        None => {
            evaluator.report(no_factor(basis, factors));
            None
        }
    }
}

fn algebras() -> Vec<String> {
    let groups = [Kind::S1, Kind::Se2, Kind::So3, Kind::Se3];
    let real = (1..=LARGEST_REAL).map(Kind::Real);
    groups
        .into_iter()
        .chain(real)
        .filter_map(Kind::algebra_name)
        .collect()
}

fn unknown_algebra(name: &Name) -> Diagnostic {
    let error = Diagnostic::new(
        code::ALGEBRA,
        name.span.clone(),
        format!("`{}` is not a known Lie algebra", name.text),
    );
    let known = algebras();
    match names::suggestion(&name.text, known.iter().map(String::as_str)) {
        Some(advice) => error.label("not known").help(advice),
        None => error
            .label("not known")
            .help(format!("known are {}", known.join(", "))),
    }
}

fn no_factor(basis: &Basis, factors: &[Factor]) -> Diagnostic {
    let (subject, span) = match &basis.factor {
        Some(name) => (
            format!("factor `{}` with the algebra", name.text),
            &name.span,
        ),
        None => (
            "factor left with the algebra".to_owned(),
            &basis.algebra.span,
        ),
    };
    let describe = |factor: &Factor| match factor.kind.algebra_name() {
        Some(algebra) => format!("`{}` has {algebra}", factor.name),
        None => format!(
            "`{}` is {}, which is no group",
            factor.name,
            factor.kind.name()
        ),
    };
    let message = format!(
        "the configuration has no {subject} `{}`",
        basis.algebra.text
    );
    let error = Diagnostic::new(code::ALGEBRA, span.clone(), message).label("no such factor");
    error.note(factors.iter().map(describe).collect::<Vec<_>>().join(", "))
}

/// Whether the span of the generators is closed under the bracket.
pub(super) fn closes(generators: &[Vec<Expr>], kind: Kind) -> bool {
    let names = vec![""; generators.len()];
    let is_full = generators.len() == kind.dimension();
    is_full || open_bracket(generators, &names, kind, &(0..0)).is_none()
}

/// The generators: coordinates in the standard basis of `kind`, independent, and closed under the bracket where they are to be those of a
/// subgroup.
pub(super) fn generators(
    at: At<'_, Basis>,
    kind: Kind,
    of_subgroup: bool,
    evaluator: &mut Evaluator<'_>,
) -> Option<Vec<Vec<Expr>>> {
    let dimension = kind.dimension();
    let elements = &at.value.elements;
    let values: Vec<&Node> = elements
        .iter()
        .filter_map(|(_, value)| value.as_ref())
        .collect();
    if values.is_empty() && elements.len() == dimension {
        return Some((0..dimension).map(|n| unit(dimension, n)).collect());
    }
    if values.len() < elements.len() || elements.len() > dimension {
        evaluator.report(wrong_number(at, kind, values.len()));
        return None;
    }
    let generators = evaluate(&values, kind, evaluator)?;
    let names: Vec<&str> = elements
        .iter()
        .map(|(name, _)| name.text.as_str())
        .collect();
    let partial = of_subgroup && elements.len() < dimension;
    let open = || {
        partial
            .then(|| open_bracket(&generators, &names, kind, at.span))
            .flatten()
    };
    let error = dependence(&generators, at.span).or_else(open);
    match error {
        None => Some(generators),
        Some(error) => {
            evaluator.report(error);
            None
        }
    }
}

fn unit(size: usize, n: usize) -> Vec<Expr> {
    (0..size).map(|i| Expr::integer((i == n).into())).collect()
}

fn wrong_number(at: At<'_, Basis>, kind: Kind, values: usize) -> Diagnostic {
    let (count, dimension) = (at.value.elements.len(), kind.dimension());
    let algebra = &at.value.algebra.text;
    let message = match (count > dimension, values) {
        (true, _) => {
            format!("{count} elements in a basis of `{algebra}`, which has dimension {dimension}")
        }
        (_, 0) => format!("{count} names for the {dimension} standard directions of `{algebra}`"),
        _ => "some elements of this basis have values and some have none".to_owned(),
    };
    let error = Diagnostic::new(code::DEPENDENT, at.span.clone(), message).label("this basis");
    error.help(format!(
        "name all {dimension} directions, or give each element a value: `w = [{}]`",
        directions(dimension)
    ))
}

fn directions(dimension: usize) -> String {
    let entries: Vec<&str> = (1..=dimension)
        .map(|n| if n == dimension { "1" } else { "0" })
        .collect();
    entries.join(", ")
}

/// Values of the elements, in which `e1`, `e2`, … are the standard directions.
fn evaluate(values: &[&Node], kind: Kind, evaluator: &mut Evaluator<'_>) -> Option<Vec<Vec<Expr>>> {
    let dimension = kind.dimension();
    let directions = (1..=dimension)
        .map(|n| (format!("e{n}"), Value::column(unit(dimension, n - 1))))
        .collect();
    evaluator.with_names(directions, |evaluator| {
        let columns: Vec<Option<Vec<Expr>>> = values
            .iter()
            .map(|node| element(node, dimension, evaluator))
            .collect();
        columns.into_iter().collect()
    })
}

fn element(node: &Node, dimension: usize, evaluator: &mut Evaluator<'_>) -> Option<Vec<Expr>> {
    let value = evaluator.value(node)?;
    let Some(column) = value.as_shape(dimension, 1) else {
        let message = format!(
            "a basis element has {dimension} coordinates, found {}",
            value.describe()
        );
        let error =
            Diagnostic::new(code::DECLARED_SHAPE, node.span.clone(), message).label("wrong shape");
        evaluator.report(
            error.help("give its coordinates in the standard basis, or a sum of e1, e2, …"),
        );
        return None;
    };
    if !column.is_constant() {
        let error = Diagnostic::new(
            code::NOT_CONSTANT,
            node.span.clone(),
            "a basis element depends on the configuration",
        );
        evaluator.report(
            error
                .label("not constant")
                .help("its coordinates are numbers and parameters"),
        );
        return None;
    }
    Some(column.entries().to_vec())
}

/// Determinant of the Gram matrix, a sum of squares of minors: zero exactly for dependent columns, and free of quotients.
fn gram(generators: &[Vec<Expr>]) -> Expr {
    let columns = Matrix::from_columns(generators.first().map_or(0, Vec::len), generators);
    let ideal = Ideal::default();
    columns
        .transpose()
        .times(&columns)
        .determinant(&|e| ideal.normal_form(e))
}

/// The error that the elements are dependent, if they are.
fn dependence(generators: &[Vec<Expr>], span: &Range<usize>) -> Option<Diagnostic> {
    gram(generators).is_zero().then(|| {
        let columns = Matrix::from_columns(generators.first().map_or(0, Vec::len), generators);
        let error = Diagnostic::new(
            code::DEPENDENT,
            span.clone(),
            "the elements of this basis are linearly dependent",
        );
        error
            .label("this basis")
            .note(format!("their coordinates, column by column:\n{columns}"))
    })
}

/// The error that a bracket of two elements is no combination of the elements, if so.
fn open_bracket(
    generators: &[Vec<Expr>],
    names: &[&str],
    kind: Kind,
    span: &Range<usize>,
) -> Option<Diagnostic> {
    let matrices: Vec<Matrix> = generators
        .iter()
        .map(|generator| algebra::hat(kind, generator))
        .collect();
    let bracket =
        |i: usize, j: usize| algebra::vee(kind, &algebra::commutator(&matrices[i], &matrices[j]));
    let mut pairs = (0..names.len())
        .flat_map(|j| (0..j).map(move |i| (i, j)))
        .map(|(i, j)| (i, j, bracket(i, j)));
    let (i, j, bracket) = pairs.find(|(.., bracket)| {
        !gram(&[generators, std::slice::from_ref(bracket)].concat()).is_zero()
    })?;
    let pair = format!("[{}, {}]", names[i], names[j]);
    let message = format!("the basis does not close: {pair} is no combination of its elements");
    let error = Diagnostic::new(code::NOT_CLOSED, span.clone(), message)
        .label("not the basis of a subgroup");
    let error = error.note(format!(
        "{pair} = {}{}",
        list(&bracket),
        residual(generators, &bracket)
    ));
    Some(error.help("add that direction, or describe the joint by coordinates of its own"))
}

fn list(entries: &[Expr]) -> String {
    let entries: Vec<String> = entries.iter().map(Expr::to_string).collect();
    format!("({})", entries.join(", "))
}

/// The part of the bracket outside the span, where it is a matter of numbers.
fn residual(generators: &[Vec<Expr>], bracket: &[Expr]) -> String {
    let columns = Matrix::from_columns(bracket.len(), generators);
    let numbers = columns
        .entries()
        .iter()
        .all(|entry| entry.as_rational().is_some());
    match algebra::coordinates_in(&columns, bracket) {
        Err(outside) if numbers => format!(", of which {} lies outside", list(&outside)),
        _ => String::new(),
    }
}
