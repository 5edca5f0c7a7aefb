//! Derivatives along the local coordinates: Φ to second order, and the chain rule through it.

use crate::algebra;
use crate::expr::{Expr, Role, Symbol};
use crate::manifold::{Factor, Kind, Manifold};
use crate::matrix::Matrix;
use crate::prepare::{Prepared, local_element};
use std::collections::BTreeMap;

/// Φ(Q, ϕ) to second order in ϕ, as stored scalars: Q + Σ δ_k ϕ_k + ½ Σ δ_kl ϕ_k ϕ_l.
#[derive(Clone, Debug)]
pub struct Motion {
    coordinates: Vec<Symbol>,
    /// `first[k][i]`: ∂Φ_i/∂ϕ_k.
    first: Vec<Vec<Expr>>,
    /// `second[k][l][i]`: ∂²Φ_i/∂ϕ_k∂ϕ_l.
    second: Vec<Vec<Vec<Expr>>>,
    /// Names that stand for functions of Q, with their derivatives along each ϕ_k.
    named: BTreeMap<Symbol, Vec<Expr>>,
}

/// The velocity of a point of the sphere that turns about an axis.
fn turned(factor: &Factor, axis: &[Expr]) -> Vec<Expr> {
    Matrix::tilde(axis)
        .times(&factor.matrix())
        .entries()
        .to_vec()
}

impl Motion {
    /// Φ with these derivatives of the stored scalars at ϕ = 0.
    pub fn new(
        coordinates: Vec<Symbol>,
        first: Vec<Vec<Expr>>,
        second: Vec<Vec<Vec<Expr>>>,
    ) -> Self {
        Self {
            coordinates,
            first,
            second,
            named: BTreeMap::new(),
        }
    }

    /// The same where these names stand for functions of Q with these derivatives along each ϕ_k.
    #[must_use]
    pub fn with_named(self, named: BTreeMap<Symbol, Vec<Expr>>) -> Self {
        Self { named, ..self }
    }

    /// Φ = Q exp(Σ b_k ϕ_k) on every factor, exp taken to second order.
    pub fn of_exponential(joint: &Prepared) -> Self {
        let factors = joint.space.manifold.factors().iter().enumerate();
        let moved = factors.flat_map(|(n, factor)| {
            let step = algebra::exp_second_order(&local_element(&joint.spec, n));
            factor.coordinates_of(&factor.matrix().times(&step))
        });
        Self::of_map(joint, &moved.collect::<Vec<_>>())
    }

    /// Every direction of the known manifolds, declared relations apart, to first order alone.
    pub fn of_known_manifold(manifold: &Manifold) -> Self {
        let mut first = vec![];
        let mut before = 0;
        let size = manifold.coordinates().len();
        for factor in manifold.factors() {
            let directions = match factor.kind {
                Kind::S2 => (0..3)
                    .map(|n| Matrix::identity(3).column(n))
                    .map(|axis| turned(factor, &axis))
                    .collect(),
                kind => algebra::standard_basis(kind)
                    .iter()
                    .map(|generator| factor.coordinates_of(&factor.matrix().times(generator)))
                    .collect::<Vec<_>>(),
            };
            for direction in directions {
                let mut whole = vec![Expr::zero(); size];
                whole[before..before + direction.len()].clone_from_slice(&direction);
                first.push(whole);
            }
            before += factor.coordinates.len();
        }
        Self {
            coordinates: manifold.coordinates(),
            first,
            second: vec![],
            named: BTreeMap::new(),
        }
    }

    /// Any Φ, given as stored scalars in Q and ϕ.
    pub fn of_map(joint: &Prepared, moved: &[Expr]) -> Self {
        let locals: Vec<Symbol> = joint
            .spec
            .freedoms
            .value
            .iter()
            .map(|freedom| freedom.local.clone())
            .collect();
        let ideal = joint.space.manifold.ideal();
        let at_base = |entries: &[Expr]| {
            entries
                .iter()
                .map(|e| ideal.simplest(&e.at_zero(&locals)))
                .collect::<Vec<_>>()
        };
        let along = |entries: &[Expr], k: usize| {
            entries
                .iter()
                .map(|e| e.derivative(&locals[k]))
                .collect::<Vec<_>>()
        };
        let slopes: Vec<Vec<Expr>> = (0..locals.len()).map(|k| along(moved, k)).collect();
        let second = |k: usize| {
            (0..locals.len())
                .map(|l| at_base(&along(&slopes[k], l)))
                .collect()
        };
        Self {
            coordinates: joint.space.manifold.coordinates(),
            first: slopes.iter().map(|slope| at_base(slope)).collect(),
            second: (0..locals.len()).map(second).collect(),
            named: BTreeMap::new(),
        }
    }

    /// Number of local coordinates.
    pub fn freedoms(&self) -> usize {
        self.first.len()
    }

    /// δ_k: the velocity of the stored scalars along ϕ_k.
    pub fn direction(&self, k: usize) -> &[Expr] {
        &self.first[k]
    }

    /// ∂Φ/∂ϕ of the stored scalars at ϕ = 0, N×K: δ_k by columns.
    pub fn tangent(&self) -> Matrix {
        Matrix::from_columns(self.coordinates.len(), &self.first)
    }

    /// δ_kl, the second derivative of Φ along ϕ_k and ϕ_l.
    pub fn curvature(&self, k: usize, l: usize) -> &[Expr] {
        &self.second[k][l]
    }

    /// ∂/∂ϕ_k at ϕ = 0 of a function of Q, in stored scalars and names.
    pub fn along(&self, function: &Expr, k: usize) -> Expr {
        function.along(&|symbol| match self.named.get(symbol) {
            Some(rates) => rates[k].clone(),
            None => self.rate(symbol, &self.first[k]),
        })
    }

    /// Entry by entry.
    pub fn along_each(&self, function: &Matrix, k: usize) -> Matrix {
        function.map(|entry| self.along(entry, k))
    }

    /// ∂²/∂ϕ_k∂ϕ_l at ϕ = 0 of a function of Φ(Q, ϕ), in stored scalars alone.
    pub fn along_both(&self, function: &Expr, k: usize, l: usize) -> Expr {
        // The first derivative, with stand-ins for the rates of the stored scalars, which themselves have rates along ϕ_l.
        let stand_in = |n: usize| Symbol::new(Role::Intermediate, n, "rate_of_coordinate");
        let stand_ins: Vec<Symbol> = (0..self.coordinates.len()).map(stand_in).collect();
        let moves = |n: usize| !self.first[k][n].is_zero() || !self.second[k][l][n].is_zero();
        let rates = stand_ins
            .iter()
            .enumerate()
            .map(|(n, symbol)| match moves(n) {
                true => Expr::symbol(symbol),
                false => Expr::zero(),
            });
        let rates: Vec<Expr> = rates.collect();
        let slope = function.along(&|symbol| self.rate(symbol, &rates));
        let second = slope.along(&|symbol| match stand_ins.iter().position(|s| s == symbol) {
            Some(n) => self.second[k][l][n].clone(),
            None => self.rate(symbol, &self.first[l]),
        });
        let values = stand_ins.into_iter().zip(self.first[k].iter().cloned());
        second.substitute(&values.collect())
    }

    fn rate(&self, symbol: &Symbol, rates: &[Expr]) -> Expr {
        match self
            .coordinates
            .iter()
            .position(|candidate| candidate == symbol)
        {
            Some(n) => rates[n].clone(),
            None => Expr::zero(),
        }
    }
}
