//! The last expression of a method: matrices as rows, so that a reader sees them.

use super::numeric;
use super::tokens::Writer;
use crate::derived::{Kernel, KernelKind};
use crate::emit::method::{Output, Signature};
use crate::formula::Node;
use crate::matrix::Matrix;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// From as many zero rows on, those that are not zero are written with their numbers.
const MANY_ZERO_ROWS: usize = 2;

/// The result of a kernel; `entries` are those of its outputs, one matrix after the other.
pub fn tokens(
    writer: &Writer<'_>,
    kernel: &Kernel,
    signature: &Signature,
    entries: &[Node],
) -> TokenStream {
    let mut rest = entries;
    let parts = kernel.outputs.iter().map(|matrix| {
        let (own, others) = rest.split_at(matrix.entries().len().min(rest.len()));
        rest = others;
        (matrix, own)
    });
    let parts: Vec<(&Matrix, &[Node])> = parts.collect();
    match (signature.output, parts.as_slice()) {
        (Output::Pose, [(rotation, r), (translation, p)]) => {
            let (rotation, translation) =
                (matrix(writer, rotation, r), vector(writer, translation, p));
            quote! { Pose { rotation: #rotation, translation: #translation } }
        }
        (Output::Scalar, [(_, functions)]) if kernel.kind == KernelKind::Singularity => {
            least(writer, functions)
        }
        (Output::Scalar, [(_, functions), (_, sides)])
            if kernel.kind == KernelKind::Singularity =>
        {
            let (functions, sides) = (list(writer, functions), list(writer, sides));
            quote! { ::hamel::finite::least_absolute_beside(#functions, #sides) }
        }
        (Output::Scalar, _) => norm_of(writer, entries),
        (Output::Vector(_), [(column, own)]) => vector(writer, column, own),
        (Output::Matrix(..), [(only, own)]) => matrix(writer, only, own),
        (Output::List(_) | Output::Rows(..), [(along, own)])
            if numeric::factor(kernel.kind).is_some() =>
        {
            matrix(writer, along, own)
        }
        (Output::List(_), [(_, own)]) => list(writer, own),
        (Output::Rows(_, columns), [(_, own)]) => {
            let rows = own.chunks(columns.max(1)).map(|row| list(writer, row));
            quote! { [#(#rows),*] }
        }
        (_, slices) if slices.iter().all(|(slice, _)| slice.is_zero()) => {
            let count = Literal::usize_unsuffixed(slices.len());
            quote! { [SMatrix::zeros(); #count] }
        }
        (_, slices) => {
            let slices = slices
                .iter()
                .map(|(matrix, own)| slice(writer, matrix, own));
            quote! { [#(#slices),*] }
        }
    }
}

fn matrix(writer: &Writer<'_>, matrix: &Matrix, entries: &[Node]) -> TokenStream {
    if matrix.is_zero() {
        return quote! { SMatrix::zeros() };
    }
    if matrix.rows() == matrix.columns() && matrix.is_identity() {
        return quote! { SMatrix::identity() };
    }
    writer.rows(entries, matrix.columns())
}

/// A slice of a derivative: the rows that are not zero with their numbers, where most are.
fn slice(writer: &Writer<'_>, slice: &Matrix, entries: &[Node]) -> TokenStream {
    let rows: Vec<&[Node]> = entries.chunks(slice.columns().max(1)).collect();
    let used = |row: &&[Node]| row.iter().any(|entry| !entry.is_zero());
    let count = rows.iter().filter(|row| used(row)).count();
    if count == 0 || rows.len() - count < MANY_ZERO_ROWS {
        return matrix(writer, slice, entries);
    }
    let numbered = rows.iter().enumerate().filter(|(_, row)| used(row));
    let numbered = numbered.map(|(i, row)| {
        let (i, row) = (Literal::usize_unsuffixed(i), writer.list(row));
        quote! { (#i, #row) }
    });
    quote! { rows_at([#(#numbered),*]) }
}

fn vector(writer: &Writer<'_>, column: &Matrix, entries: &[Node]) -> TokenStream {
    if column.is_zero() {
        return quote! { SVector::zeros() };
    }
    let entries = entries.iter().map(|entry| writer.formula(entry));
    quote! { SVector::from([#(#entries),*]) }
}

/// Least absolute value.
fn least(writer: &Writer<'_>, functions: &[Node]) -> TokenStream {
    let functions = list(writer, functions);
    quote! { ::hamel::finite::least_absolute(#functions) }
}

fn list(writer: &Writer<'_>, entries: &[Node]) -> TokenStream {
    let entries = entries.iter().map(|entry| writer.formula(entry));
    quote! { [#(#entries),*] }
}

/// Root of the sum of squares of `relations`.
pub fn norm() -> TokenStream {
    quote! {
        let sum = relations.into_iter().fold(T::zero(), |sum, relation| relation.mul_add(relation, sum));
        sum.sqrt()
    }
}

fn norm_of(writer: &Writer<'_>, relations: &[Node]) -> TokenStream {
    if relations.iter().all(Node::is_zero) {
        return quote! { T::zero() };
    }
    let relations = relations.iter().map(|relation| writer.formula(relation));
    let norm = norm();
    quote! { let relations = [#(#relations),*]; #norm }
}
