//! Parts of values, `Q.x`, and their elements, `Q[2, 3]`.

use super::super::ast::{Name, Node, NodeKind};
use super::super::value::Value;
use super::super::{Fallible, code};
use super::{Evaluator, local, misfit};
use crate::diagnostic::Diagnostic;
use crate::expr::Expr;
use crate::manifold::Kind;
use crate::matrix::Matrix;
use num_traits::ToPrimitive;
use std::ops::Range;

impl Evaluator<'_> {
    /// `base.part`
    pub(super) fn part(&mut self, base: &Node, part: &Name) -> Option<Value> {
        if is_phi(base) {
            let found = match &self.locals {
                Some(locals) => locals.part(&part.text, &part.span),
                None => Err(Box::new(local::outside_phi(&base.span))),
            };
            return self.settle(found);
        }
        let value = self.value(base)?;
        let found = part_of(&value, &part.text).ok_or_else(|| Box::new(no_part(&value, part)));
        self.settle(found)
    }

    /// `base[i]` or `base[i, j]`, counted from 1.
    pub(super) fn element(
        &mut self,
        base: &Node,
        indices: &[Node],
        span: &Range<usize>,
    ) -> Option<Value> {
        let value = match (is_phi(base), &self.locals) {
            (true, Some(locals)) => Some(Value::column(locals.all.clone())),
            _ => self.value(base),
        };
        let positions: Vec<Option<usize>> =
            indices.iter().map(|node| self.position(node)).collect();
        let positions: Vec<usize> = positions.into_iter().collect::<Option<_>>()?;
        let found = element_of(&value?, &positions, span);
        self.settle(found)
    }

    fn position(&mut self, node: &Node) -> Option<usize> {
        let value = self.value(node)?;
        let integer = value
            .as_scalar()
            .and_then(Expr::as_rational)
            .filter(crate::expr::Rational::is_integer);
        let position = integer
            .and_then(|number| number.to_integer().to_usize())
            .filter(|&n| n > 0);
        if position.is_none() {
            let error = Diagnostic::new(
                code::INDEX,
                node.span.clone(),
                "an index is a positive integer",
            );
            self.report(error.label("not an index").help("indices count from 1"));
        }
        position
    }
}

fn is_phi(node: &Node) -> bool {
    matches!(&node.kind, NodeKind::Name(name) if name == "phi")
}

/// Names of the parts that a value has.
fn parts(value: &Value) -> &'static [&'static str] {
    match value {
        Value::Element(Kind::S1 | Kind::So2, _) => &["c", "s"],
        Value::Element(Kind::S3, _) => &["w", "x", "y", "z"],
        Value::Element(Kind::Se2, _) => &["c", "s", "x", "y", "R", "p"],
        Value::Element(Kind::Se3, _) | Value::Pose(_) => &["x", "y", "z", "R", "p"],
        Value::Matrix(matrix) if matrix.shape() == (2, 1) => &["x", "y"],
        Value::Matrix(matrix) if matrix.shape() == (3, 1) => &["x", "y", "z"],
        _ => &[],
    }
}

fn part_of(value: &Value, part: &str) -> Option<Value> {
    if !parts(value).contains(&part) {
        return None;
    }
    let scalar = |matrix: &Matrix, i: usize, j: usize| Value::Scalar(matrix.at(i, j).clone());
    let axis = "xyz".find(part);
    Some(match (value, part) {
        (Value::Element(Kind::S3, matrix), _) => scalar(matrix, "wxyz".find(part)?, 0),
        (Value::Element(_, matrix), "c") => scalar(matrix, 0, 0),
        (Value::Element(_, matrix), "s") => scalar(matrix, 1, 0),
        (Value::Element(Kind::Se2, matrix), "R") => Value::Matrix(matrix.block(0, 0, 2, 2)),
        (Value::Element(Kind::Se2, matrix), "p") => Value::Matrix(matrix.block(0, 2, 2, 1)),
        (Value::Element(Kind::Se2, matrix), _) => scalar(matrix, axis?, 2),
        (Value::Matrix(column), _) => scalar(column, axis?, 0),
        (_, "R") => Value::Matrix(value.as_pose()?.rotation),
        (_, "p") => Value::Matrix(value.as_pose()?.translation),
        _ => scalar(&value.as_pose()?.translation, axis?, 0),
    })
}

fn no_part(value: &Value, part: &Name) -> Diagnostic {
    let message = format!("{} has no part `{}`", value.describe(), part.text);
    let error = Diagnostic::new(code::FIELD, part.span.clone(), message).label("no such part");
    match parts(value) {
        [] => error.help("it has no parts with names; elements of matrices are written m[i, j]"),
        known => error.help(format!("its parts are {}", known.join(", "))),
    }
}

fn element_of(value: &Value, positions: &[usize], span: &Range<usize>) -> Fallible<Value> {
    let stored = match value {
        Value::Element(Kind::Se2, matrix) => Some(matrix.block(0, 0, 2, 3)),
        Value::Element(Kind::Se3, matrix) => Some(matrix.block(0, 0, 3, 4)),
        Value::List(entries) => Some(Matrix::column_vector(entries.clone())),
        _ => value.as_matrix(),
    };
    let Some(matrix) = stored else {
        let error = misfit(
            span,
            format!("{} has no elements to index", value.describe()),
        );
        return Err(Box::new(match parts(value) {
            [] => error,
            known => error.help(format!("its parts are {}", known.join(", "))),
        }));
    };
    let (rows, columns) = matrix.shape();
    let (i, j) = match *positions {
        [i] if columns == 1 => (i, 1),
        [j] if rows == 1 => (1, j),
        [i, j] => (i, j),
        _ => {
            let needed = if rows == 1 || columns == 1 {
                "one index"
            } else {
                "two indices"
            };
            return Err(Box::new(misfit(
                span,
                format!(
                    "a {rows}×{columns} matrix takes {needed}, found {}",
                    positions.len()
                ),
            )));
        }
    };
    if i > rows || j > columns {
        let message = format!("element ({i}, {j}) of a {rows}×{columns} matrix");
        return Err(Box::new(
            Diagnostic::new(code::INDEX, span.clone(), message).label("outside the matrix"),
        ));
    }
    Ok(Value::Scalar(matrix.at(i - 1, j - 1).clone()))
}
