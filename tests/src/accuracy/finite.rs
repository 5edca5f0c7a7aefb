//! The finite maps of a joint from their definitions: Φ(Q, ϕ), its inverse, its differential.

use super::Grid;
use super::definition::{Definition, numbers};
use super::tracked::{Tracked, larger};
use super::wide::Wide;
use hamel_codegen::expr::Number;

/// Φ(Q, ϕ) with its derivatives.
#[derive(Clone, Debug)]
pub struct AtPhi {
    /// Q′ = Φ(Q, ϕ), stored scalars.
    pub moved: Vec<Tracked>,
    /// ∂Φ/∂ϕ at (Q, ϕ), of the stored scalars.
    pub tangent: Grid<Tracked>,
    /// D with `Φ(Q, ϕ + δ) = Φ(Q′, D δ) + O(δ²)`.
    pub differential: Grid<Tracked>,
    /// D⁻¹.
    pub inverse: Grid<Tracked>,
}

/// Corrections of ϕ towards Φ(Q, ϕ) = Q′: from an error of 1e-8 at most (doubles 1e-16, single precision 1e-7), where ∂Φ/∂ϕ is kept,
/// each leaves its own size times the error. Eight leave less than 2⁻¹⁸⁰ of it; fewer do for doubles.
const CORRECTIONS: usize = 8;
/// A correction below this part of what it corrects is the last: the next one would be below 1e-35.
const LAST: f64 = 1e-28;

/// The largest size of an entry.
fn size(values: &[Wide]) -> f64 {
    values.iter().map(|x| x.to_f64().abs()).fold(0.0, larger)
}

impl Definition {
    /// Φ and its differential at finite ϕ.
    pub fn at_phi(&self, q: &[f64], phi: &[f64]) -> AtPhi {
        let there = self.moved_with_tangent(&numbers(q), &numbers(phi));
        let moved = there.get("moved").entries().to_vec();
        let tangent = there.get("tangent").clone();
        let directions = self.directions(&moved);
        let differential = directions.solve_by(&directions.left_inverse(), &tangent);
        AtPhi {
            inverse: differential.inverse(),
            moved,
            tangent,
            differential,
        }
    }

    /// The ϕ near `start` with Φ(Q, ϕ) = `target` (nearest, where the target is off the manifold by rounding). Its scale is how far
    /// errors of an ulp in the summands of Φ(Q, ϕ) move it: those of Q are among them.
    pub fn local(&self, at: &AtPhi, q: &[f64], target: &[f64], start: &[f64]) -> Grid<Tracked> {
        let q = numbers(q);
        let target = numbers(target);
        let left = at.tangent.values().left_inverse();
        let mut phi = numbers(start);
        let mut reached = at.moved.clone();
        for _ in 0..CORRECTIONS {
            let rest = Grid::from_fn(target.len(), 1, |i, _| target[i].value - reached[i].value);
            let step = left.times(&rest);
            for (k, value) in phi.iter_mut().enumerate() {
                *value = Tracked::computed(value.value + *step.at(k, 0), 0.0);
            }
            if size(step.entries()) <= LAST * phi.iter().map(|x| x.scale).fold(0.0, larger) {
                break;
            }
            reached = self.moved(&q, &phi).entries().to_vec();
        }
        Grid::from_fn(phi.len(), 1, |k, _| {
            let moves = |i: usize| left.at(k, i).to_f64().abs() * at.moved[i].scale;
            let scale = (0..at.moved.len()).map(moves).fold(0.0, larger);
            Tracked::computed(phi[k].value, scale)
        })
    }

    /// The point of the manifold nearest to Q, near the point `start` that is on it: the gradient of the distance along the manifold is
    /// reduced to nothing. Its scale is how far errors of an ulp in the scalars of Q move it along the manifold, and errors of an ulp in the summands of
    /// relations across it.
    pub fn nearest(&self, q: &[f64], start: &[Tracked]) -> Vec<Tracked> {
        let mut point = start.to_vec();
        let mut tangent = self.directions(&point).values();
        let mut left = tangent.left_inverse();
        for _ in 0..CORRECTIONS {
            let rest = Grid::from_fn(q.len(), 1, |i, _| Wide::from_f64(q[i]) - point[i].value);
            let step = left.times(&rest);
            if size(step.entries()) <= LAST * q.iter().copied().map(f64::abs).fold(0.0, larger) {
                break;
            }
            let step = step.map(|s| Tracked::computed(*s, 0.0));
            let moved = self.moved(&point, step.entries());
            let moved = moved.map(|x| Tracked::computed(x.value, 0.0));
            point = moved.entries().to_vec();
            tangent = self.directions(&point).values();
            left = tangent.left_inverse();
        }
        let along = tangent.times(&left);
        let shifts = self.shifts(q);
        let scale = |i: usize| {
            let moves = |j: usize| along.at(i, j).to_f64().abs() * q[j].abs();
            (0..q.len()).map(moves).fold(shifts[i], larger)
        };
        let scaled = |(i, x): (usize, Tracked)| Tracked::computed(x.value, scale(i));
        point.into_iter().enumerate().map(scaled).collect()
    }

    /// The least size of a function of a locus at Q; nothing where there is none.
    pub fn singularity(&self, q: &[f64]) -> Option<Tracked> {
        let values = self.loci(q);
        let sizes = values.entries().iter();
        let sizes = sizes.map(|x| Tracked::computed(x.value.abs(), x.scale));
        sizes.reduce(|a, b| match a.value.compare_sizes(b.value) {
            std::cmp::Ordering::Greater => b,
            _ => a,
        })
    }

    /// The root of the sum of squares of the relations at Q, with the scale of the largest summand of a relation.
    pub fn residual(&self, q: &[f64]) -> Tracked {
        let values = self.relations(q);
        let values = values.entries();
        let zero = Tracked::input(0.0);
        let sum = values
            .iter()
            .fold(zero, |sum, value| sum.plus(&value.times(value)));
        let scale = values.iter().map(|value| value.scale).fold(0.0, larger);
        Tracked::computed(sum.value.sqrt(), scale)
    }
}
