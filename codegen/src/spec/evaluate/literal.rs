//! Matrix literals: lists, rows of scalars, rows of blocks.

use super::super::value::Value;
use super::super::{Fallible, code, limits};
use super::misfit;
use crate::diagnostic::Diagnostic;
use crate::matrix::Matrix;
use std::ops::Range;

/// The value of `[a, b; c, d]`: a list where it is one row of scalars.
pub(super) fn matrix(rows: &[Vec<Value>], span: &Range<usize>) -> Fallible<Value> {
    if let [row] = rows
        && let Some(entries) = row
            .iter()
            .map(|value| value.as_scalar().cloned())
            .collect::<Option<Vec<_>>>()
    {
        let column = Matrix::column_vector(entries.clone());
        bounded(&column.transpose(), span)?;
        return Ok(if entries.len() == 1 {
            Value::matrix(column)
        } else {
            Value::List(entries)
        });
    }
    let mut whole: Option<Matrix> = None;
    for (number, row) in rows.iter().enumerate() {
        let block = line(row, number + 1, span)?;
        whole = Some(match whole {
            Some(above) if above.columns() != block.columns() => {
                return Err(Box::new(ragged(&above, &block, number + 1, span)));
            }
            Some(above) => above.stack(&block),
            None => block,
        });
        if let Some(whole) = &whole {
            bounded(whole, span)?;
        }
    }
    whole
        .map(Value::matrix)
        .ok_or_else(|| Box::new(misfit(span, "an empty matrix".into())))
}

fn ragged(above: &Matrix, block: &Matrix, number: usize, span: &Range<usize>) -> Diagnostic {
    let (expected, found) = (above.columns(), block.columns());
    misfit(
        span,
        format!("row {number} of the matrix has {found} columns, those above have {expected}"),
    )
}

/// The blocks of one row side by side.
fn line(row: &[Value], number: usize, span: &Range<usize>) -> Fallible<Matrix> {
    if row.len() > 1 && row.iter().all(|value| matches!(value, Value::List(_))) {
        let error = misfit(span, "lists inside a list".into());
        return Err(Box::new(
            error.help("write a matrix as [a, b; c, d], rows separated by `;`"),
        ));
    }
    let heights = row
        .iter()
        .filter(|value| !matches!(value, Value::List(_)))
        .find_map(height);
    let mut whole: Option<Matrix> = None;
    for value in row {
        let block = block(value, heights).ok_or_else(|| {
            let message = format!(
                "{} cannot stand in row {number} of a matrix",
                value.describe()
            );
            Box::new(misfit(span, message))
        })?;
        whole = Some(match whole {
            Some(left) if left.rows() != block.rows() => {
                let message = format!(
                    "blocks of {} and {} rows side by side in row {number} of the matrix",
                    left.rows(),
                    block.rows()
                );
                return Err(Box::new(misfit(span, message)));
            }
            Some(left) => left.beside(&block),
            None => block,
        });
    }
    whole.ok_or_else(|| Box::new(misfit(span, "an empty row".into())))
}

fn height(value: &Value) -> Option<usize> {
    match value {
        Value::Scalar(_) => Some(1),
        _ => value.as_matrix().map(|matrix| matrix.rows()),
    }
}

/// A list is a column beside blocks of its height, a row otherwise.
fn block(value: &Value, height: Option<usize>) -> Option<Matrix> {
    match value {
        Value::Scalar(entry) => Some(Matrix::column_vector(vec![entry.clone()])),
        Value::List(entries) if height == Some(entries.len()) => {
            Some(Matrix::column_vector(entries.clone()))
        }
        _ => value.as_matrix(),
    }
}

fn bounded(matrix: &Matrix, span: &Range<usize>) -> Fallible<()> {
    let (rows, columns) = matrix.shape();
    let (tallest, limit) = (limits::TALLEST_MATRIX, limits::LARGEST_MATRIX);
    match rows > tallest || columns > limit {
        false => Ok(()),
        true => {
            let message =
                format!("a matrix of {rows}×{columns}, at most {tallest}×{limit} is possible");
            Err(Box::new(
                Diagnostic::new(code::TOO_LARGE, span.clone(), message).label("too large"),
            ))
        }
    }
}
