//! Sums, products and quotients of values.

use super::super::value::Value;
use super::super::{Fallible, code};
use super::misfit;
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::manifold::Kind;
use crate::matrix::Matrix;
use crate::model::PoseExpr;
use std::ops::Range;

/// `-a`
pub(super) fn negative(a: &Value, span: &Range<usize>) -> Fallible<Value> {
    scaled(a, &Expr::integer(-1))
        .ok_or_else(|| Box::new(misfit(span, format!("{} has no negative", a.describe()))))
}

/// `a + b`, or `a − b`.
pub(super) fn add(a: &Value, minus: bool, b: &Value, span: &Range<usize>) -> Fallible<Value> {
    let sign = if minus {
        Expr::integer(-1)
    } else {
        Expr::one()
    };
    let sum = |a: &[Expr], b: &[Expr]| -> Vec<Expr> {
        a.iter().zip(b).map(|(a, b)| a + &(b * &sign)).collect()
    };
    let fitting = match (a, b) {
        (Value::Scalar(a), Value::Scalar(b)) => Some(Value::Scalar(a + &(b * &sign))),
        (Value::Tangent(kind, a), Value::Tangent(other, b)) if kind == other => {
            Some(Value::Tangent(*kind, sum(a, b)))
        }
        (Value::List(a), Value::List(b)) if a.len() == b.len() => Some(Value::List(sum(a, b))),
        _ => matching(a, b).map(|(a, b)| Value::Matrix(a.plus(&b.scale(&sign)))),
    };
    fitting.ok_or_else(|| {
        let verb = if minus { "subtract" } else { "add" };
        let message = format!("cannot {verb} {} and {}", a.describe(), b.describe());
        Box::new(misfit(span, message))
    })
}

/// Two matrices of one shape; a list takes the shape of the other.
fn matching(a: &Value, b: &Value) -> Option<(Matrix, Matrix)> {
    let shaped = |value: &Value, other: &Matrix| value.as_shape(other.rows(), other.columns());
    match (a, b) {
        (Value::Scalar(_), _) | (_, Value::Scalar(_)) => None,
        (Value::List(_), _) => b.as_summand().and_then(|b| Some((shaped(a, &b)?, b))),
        (_, Value::List(_)) => a
            .as_summand()
            .and_then(|a| Some((a.clone(), shaped(b, &a)?))),
        _ => (a.as_summand().zip(b.as_summand())).filter(|(a, b)| a.shape() == b.shape()),
    }
}

/// `a · b`, or `a / b`.
pub(super) fn multiply(
    a: &Value,
    divides: bool,
    b: &Value,
    span: &Range<usize>,
) -> Fallible<Value> {
    if divides {
        return divide(a, b, span);
    }
    let product = match (a, b) {
        (_, Value::Scalar(factor)) => scaled(a, factor),
        (Value::Scalar(factor), _) => scaled(b, factor),
        (Value::Element(kind, a), Value::Element(other, b)) if kind == other => {
            Some(Value::Element(*kind, a.times(b)))
        }
        _ if a.is_pose() || b.is_pose() => pose_product(a, b),
        _ => matrix_product(a, b),
    };
    product.ok_or_else(|| Box::new(product_misfit(a, b, span)))
}

fn product_misfit(a: &Value, b: &Value, span: &Range<usize>) -> Diagnostic {
    let error = misfit(
        span,
        format!("cannot multiply {} by {}", a.describe(), b.describe()),
    );
    let group = |value: &Value| matches!(value, Value::Element(Kind::S1 | Kind::S3 | Kind::Se2, _));
    match (a, b) {
        (_, Value::Tangent(..)) | (Value::Tangent(..), _) => {
            error.help("write exp(…) for the group element of an algebra element")
        }
        _ if group(a) || group(b) => {
            error.help("rot(Q), rot_z(Q) and the parts of Q give matrices and vectors")
        }
        _ => error,
    }
}

fn divide(a: &Value, b: &Value, span: &Range<usize>) -> Fallible<Value> {
    let Some(divisor) = b.as_scalar() else {
        return Err(Box::new(
            misfit(span, format!("cannot divide by {}", b.describe())).help("only scalars divide"),
        ));
    };
    let Some(inverse) = divisor.recip() else {
        let error = Diagnostic::new(code::UNDEFINED_VALUE, span.clone(), "division by zero");
        return Err(Box::new(error.label("the divisor is zero")));
    };
    scaled(a, &inverse)
        .ok_or_else(|| Box::new(misfit(span, format!("cannot divide {}", a.describe()))))
}

/// The value times a scalar; `None` for poses and elements of motion groups.
fn scaled(value: &Value, factor: &Expr) -> Option<Value> {
    let scale = |entries: &[Expr]| entries.iter().map(|entry| entry * factor).collect();
    Some(match value {
        Value::Scalar(entry) => Value::Scalar(entry * factor),
        Value::List(entries) => Value::List(scale(entries)),
        Value::Tangent(kind, entries) => Value::Tangent(*kind, scale(entries)),
        _ => Value::Matrix(value.as_summand()?.scale(factor)),
    })
}

fn matrix_product(a: &Value, b: &Value) -> Option<Value> {
    let left = a.as_matrix()?;
    let right = b.as_matrix()?;
    if left.columns() == right.rows() {
        return Some(Value::matrix(left.times(&right)));
    }
    // A list is a column where a row does not fit; beside another list neither reading is preferred.
    match (a, b) {
        (Value::List(_), Value::List(_)) => None,
        (_, Value::List(entries)) if left.columns() == entries.len() => Some(Value::matrix(
            left.times(&Matrix::column_vector(entries.clone())),
        )),
        _ => None,
    }
}

/// Pose by pose, where a 3×3 matrix counts as a rotation alone; pose by point.
fn pose_product(a: &Value, b: &Value) -> Option<Value> {
    let left = a.as_pose()?;
    let moved = |point: &Matrix| left.rotation.times(point).plus(&left.translation);
    if let Some(right) = b.as_pose() {
        let (rotation, translation) = (
            left.rotation.times(&right.rotation),
            moved(&right.translation),
        );
        return Some(Value::Pose(PoseExpr {
            rotation,
            translation,
        }));
    }
    let point = b.as_vector3()?;
    Some(Value::Matrix(moved(&Matrix::column_vector(point))))
}
