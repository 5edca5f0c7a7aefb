//! Which entries of H, X^c, S̄ and the derivatives of the last two are 0 or 1 at every configuration, for the runtime's recursions.

use super::joint::sizes;
use super::tokens::ident;
use crate::derived::{Derived, Kernel, KernelKind};
use crate::expr::{Expr, Symbol};
use crate::matrix::Matrix;
use proc_macro2::{Literal, TokenStream};
use quote::quote;
use std::collections::BTreeSet;

/// The constant `PATTERNS`.
pub fn tokens(derived: &Derived) -> TokenStream {
    let [_, k, s, _] = sizes(derived);
    let shape = derived.shape;
    let pose = |output: usize| value(derived, KernelKind::Pose, output);
    let rotation = rows(pose(0), 3, 3);
    let translation = row(pose(1), 3);
    let twist_map = rows(
        value(derived, KernelKind::TwistMapChild, 0),
        6,
        shape.freedoms,
    );
    let basis = value(derived, KernelKind::SpeedBasis, 0).filter(|basis| !is_identity(basis));
    let basis = basis.map(|basis| {
        let rows = rows(Some(basis), shape.freedoms, shape.speeds);
        quote! { .speed_basis([#(#rows),*]) }
    });
    let gradient = |name: &str, kind| {
        let (name, slices) = (ident(name), slices(derived, kind));
        (!slices.is_empty()).then(|| quote! { .#name(&[#(#slices),*]) })
    };
    let of_map = gradient(
        "twist_map_child_gradient",
        KernelKind::TwistMapChildGradient,
    );
    let of_basis = gradient("speed_basis_gradient", KernelKind::SpeedBasisGradient);
    let of_bias = bias_gradient(derived).map(|columns| quote! { .bias_gradient(#columns) });
    quote! {
        const PATTERNS: Patterns<#k, #s> =
            Patterns::new([#(#rotation),*], #translation, [#(#twist_map),*]) #basis #of_map #of_basis #of_bias;
    }
}

/// The columns of ∂c/∂ϕ and of that of its dual, where some are known to be 0: ϕ_k moves no scalar that c is made of.
fn bias_gradient(derived: &Derived) -> Option<String> {
    let kinds = [KernelKind::BiasAcceleration, KernelKind::BiasMomentum];
    let kernels = kinds.into_iter().filter_map(|kind| derived.kernel(kind));
    let symbols: BTreeSet<Symbol> = kernels.flat_map(Kernel::arguments).collect();
    let arguments = &derived.arguments;
    let is_needed = |symbol: &&Symbol| symbols.contains(*symbol);
    arguments.configuration.iter().find(is_needed)?;
    let rates = value(derived, KernelKind::ConfigurationRate, 0)?;
    let map = value(derived, KernelKind::VelocityMap, 0);
    let moves = |k: usize, rate: &Expr| {
        let velocities = arguments.velocity.iter().enumerate();
        let mut velocities =
            velocities.filter(|(j, _)| map.is_none_or(|map| !map.at(*j, k).is_zero()));
        velocities.any(|(_, velocity)| rate.contains(velocity))
    };
    let sign = |k: usize| {
        let mut rates = arguments.configuration.iter().zip(rates.entries());
        let is_moved = rates.any(|(symbol, rate)| is_needed(&symbol) && moves(k, rate));
        if is_moved { 'x' } else { '0' }
    };
    let columns: String = (0..derived.shape.freedoms).map(sign).collect();
    columns.contains('0').then_some(columns)
}

/// What `Patterns::new` says of S̄.
fn is_identity(matrix: &Matrix) -> bool {
    matrix.rows() == matrix.columns() && matrix.is_identity()
}

fn value(derived: &Derived, kind: KernelKind, output: usize) -> Option<&Matrix> {
    derived.kernel(kind)?.outputs.get(output)
}

fn rows(matrix: Option<&Matrix>, rows: usize, columns: usize) -> Vec<String> {
    let sign = |i: usize, j: usize| matrix.map_or('x', |matrix| sign(matrix.at(i, j)));
    (0..rows)
        .map(|i| (0..columns).map(|j| sign(i, j)).collect())
        .collect()
}

/// The slices of a derivative along ϕ that are not zero, with their numbers.
fn slices(derived: &Derived, kind: KernelKind) -> Vec<TokenStream> {
    let slices = derived
        .kernel(kind)
        .map_or(&[][..], |kernel| &kernel.outputs);
    let known = slices
        .iter()
        .enumerate()
        .filter(|(_, slice)| !slice.is_zero());
    let tokens = known.map(|(k, slice)| {
        let k = Literal::usize_unsuffixed(k);
        let rows = rows(Some(slice), slice.rows(), slice.columns());
        quote! { (#k, [#(#rows),*]) }
    });
    tokens.collect()
}

/// A column vector as one row.
fn row(vector: Option<&Matrix>, size: usize) -> String {
    let sign = |i: usize| vector.map_or('x', |vector| sign(vector.at(i, 0)));
    (0..size).map(sign).collect()
}

fn sign(entry: &Expr) -> char {
    match (entry.is_zero(), entry.is_one()) {
        (true, _) => '0',
        (_, true) => '1',
        _ => 'x',
    }
}
