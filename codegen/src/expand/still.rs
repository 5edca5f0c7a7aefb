//! Coordinates that move no body: degrees of freedom that move only stored scalars which H does not contain, a steering angle say.
//!
//! X says nothing of them, so the rates of these scalars are rows beside it, for the rank condition and for S alone:
//! `[X; E] S = [J; E_J]`. Dynamics never see them.

use super::Motion;
use super::twist::TwistJacobian;
use crate::expr::{Expr, Symbol};
use crate::matrix::Matrix;
use crate::prepare::Prepared;
use std::collections::BTreeSet;

/// The degrees of freedom that move no body, and the rates of what they move.
#[derive(Clone, Debug)]
pub struct Still {
    /// These degrees of freedom, in order.
    pub freedoms: Vec<usize>,
    /// The stored scalars that they move.
    pub scalars: Vec<Symbol>,
    /// E: rates of these scalars by ϕ̇ at ϕ = 0, which are those by v; `scalars` × k.
    pub rates: Matrix,
    /// ∂E_J/∂ϕ_l: the same beyond ϕ = 0, to first order.
    slopes: Vec<Matrix>,
}

impl Still {
    /// Those of the joint. None where H is constant: a joint moves a body.
    pub fn new(joint: &Prepared, motion: &Motion) -> Self {
        let entries = joint.spec.poses().flat_map(|pose| pose.value.entries());
        let in_pose: BTreeSet<Symbol> = entries.flat_map(Expr::symbols).collect();
        let coordinates = joint.space.manifold.coordinates();
        let moves = |k: usize, n: usize| !motion.direction(k)[n].is_zero();
        let is_still = |&k: &usize| {
            let mut all = coordinates.iter().enumerate();
            all.all(|(n, symbol)| !moves(k, n) || !in_pose.contains(symbol))
        };
        let count = motion.freedoms();
        let freedoms: Vec<usize> = (0..count).filter(is_still).collect();
        if freedoms.is_empty() || freedoms.len() == count {
            return Self::none();
        }
        let moved = |n: &usize| freedoms.iter().any(|&k| moves(k, *n));
        let places: Vec<usize> = (0..coordinates.len()).filter(moved).collect();
        let slope = |l: usize| {
            Matrix::from_fn(places.len(), count, |i, k| {
                motion.curvature(k, l)[places[i]].clone()
            })
        };
        Self {
            rates: Matrix::from_fn(places.len(), count, |i, k| {
                motion.direction(k)[places[i]].clone()
            }),
            slopes: (0..count).map(slope).collect(),
            scalars: places.iter().map(|&n| coordinates[n].clone()).collect(),
            freedoms,
        }
    }

    fn none() -> Self {
        Self {
            freedoms: vec![],
            scalars: vec![],
            rates: Matrix::zeros(0, 0),
            slopes: vec![],
        }
    }

    /// Whether every degree of freedom moves the body.
    pub fn is_empty(&self) -> bool {
        self.freedoms.is_empty()
    }

    /// The rates below a matrix of twists by v.
    pub fn below(&self, twists: &Matrix) -> Matrix {
        match self.is_empty() {
            true => twists.clone(),
            false => twists.stack(&self.rates),
        }
    }

    /// J with the rates below, to the same order.
    pub fn below_jacobian(&self, jacobian: &TwistJacobian) -> TwistJacobian {
        let slopes = jacobian.slopes.iter().enumerate();
        TwistJacobian {
            base: self.below(&jacobian.base),
            child: self.below(&jacobian.child),
            slopes: slopes
                .map(|(l, slope)| match self.is_empty() {
                    true => slope.clone(),
                    false => slope.stack(&self.slopes[l]),
                })
                .collect(),
        }
    }

    /// A map of twists that leaves the rates as they are.
    pub fn beside(&self, map: &Matrix) -> Matrix {
        let (rows, more) = (map.rows(), self.scalars.len());
        let right = map.beside(&Matrix::zeros(rows, more));
        match more {
            0 => map.clone(),
            _ => right.stack(&Matrix::zeros(more, map.columns()).beside(&Matrix::identity(more))),
        }
    }

    /// The names of the scalars, for statements: `steer, spin`.
    pub fn names(&self) -> String {
        let names: Vec<&str> = self.scalars.iter().map(|symbol| symbol.name()).collect();
        names.join(", ")
    }
}
