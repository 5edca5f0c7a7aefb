//! How the numbers of many states lie: state after state in rows, or eight states side by side.

use super::LANES;

/// One quantity of eight states, in a cache line of its own.
///
/// Eight states side by side are a row of these, in the order in which one state's numbers stand in a row of `f64`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub struct Lanes(pub [f64; LANES]);

/// Arguments and results of many states, in one of the two layouts.
#[derive(Debug)]
pub enum States<'a> {
    /// State after state.
    Rows(Quantities<'a, f64>),
    /// Eight states after eight states.
    SideBySide(Quantities<'a, Lanes>),
}

/// Q, v̄ and inputs of many states, and room for their results.
#[derive(Debug)]
pub struct Quantities<'a, N> {
    /// Rows of Q.
    pub q: &'a [N],
    /// Rows of v̄.
    pub v: &'a [N],
    /// Rows of τ or v̄̇.
    pub u: &'a [N],
    /// Rows of v̄̇ or τ̄.
    pub results: &'a mut [N],
}

impl Lanes {
    /// Zeros.
    pub(super) const ZERO: Self = Self([0.0; LANES]);
}
