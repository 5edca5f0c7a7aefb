//! Projection onto a manifold that is given by relations, redundant ones among them.

use super::solve::{orientation, triangulate};
use super::{least_squares, norm, unless_apart, unless_turned, with_jacobian};
use crate::matrix::{column, dot, entries, map, product, zeros};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// Bound on the iterations of [`project`] and [`project_by_displacements`]: quadratic convergence needs 5 from an error of a tenth; the others are for
/// points farther away.
pub const PROJECT_ITERATIONS: usize = 12;

/// The point of the manifold that is nearest to `start`, to second order in their distance; NaN in every entry where
/// Newton's method does not converge within [`PROJECT_ITERATIONS`].
///
/// `relations` (R) vanish on the manifold, and `codimension` is the rank of their derivatives by the stored scalars there. R may
/// exceed it: each step is the shortest that solves the `codimension` relations whose gradients are most independent (pivoted
/// Gram–Schmidt). All relations must hold in the end, so that a reflection, say, is not taken for a rotation.
pub fn project<T: Scalar, const N: usize, const R: usize>(
    start: &SVector<T, N>,
    codimension: usize,
    relations: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, R>,
) -> SVector<T, N> {
    let mut q = *start;
    for _ in 0..PROJECT_ITERATIONS {
        q += Equations::at(&q, &relations).shortest_solution(codimension);
    }
    let left = Equations::at(&q, &relations);
    let apart = norm(&left.values);
    let step = norm(&left.shortest_solution(codimension));
    unless_apart(&q, apart + step, norm(&q))
}

/// Parts in which [`assemble`] takes the values of the relations back to zero where Newton's method alone leaves the branch of the guess.
const PARTS: usize = 16;

/// The configuration of a linkage that a guess means: [`project`] of the guess, on its branch; NaN in every entry where none is found.
///
/// Two branches meet where a matrix, `across` (C×C), is singular: ∂φ N, where N are directions that lead back to the manifold. Where the sign of its determinant changes on
/// the way, the values of the relations are taken back to zero in parts, so that Newton's method follows the branch of the guess.
pub fn assemble<T: Scalar, const N: usize, const R: usize, const C: usize>(
    guess: &SVector<T, N>,
    codimension: usize,
    relations: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, R>,
    across: impl Fn(&SVector<T, N>) -> SMatrix<T, C, C>,
) -> SVector<T, N> {
    let sign = |q: &SVector<T, N>| {
        let mut triangle = across(q);
        triangulate(C, triangle.as_mut_slice(), &mut []);
        orientation(C, triangle.as_slice())
    };
    let own_sign = sign(guess);
    let on_branch = |q: SVector<T, N>| unless_turned(&q, own_sign, sign(&q));
    let direct = on_branch(project(guess, codimension, &relations));
    let values = map(&relations(&map(guess, Dual::constant)), |value| value.value);
    let mut q = *guess;
    for left in (1..PARTS).rev() {
        let offset = values * T::from_f64(left as f64 / PARTS as f64);
        let shifted = |q: &SVector<Dual<T>, N>| relations(q) - map(&offset, Dual::constant);
        q += Equations::at(&q, shifted).shortest_solution(codimension);
    }
    let followed = on_branch(project(&q, codimension, &relations));
    let found = norm(&direct).less(T::from_f64(f64::INFINITY));
    direct.zip_map(&followed, |direct, followed| {
        T::select(found, direct, followed)
    })
}

/// The point `start exp(ξ) exp(ξ₂) …` of a manifold in a group, of dimension G, each displacement the shortest that Newton's method asks for;
/// NaN in every entry where it does not converge within [`PROJECT_ITERATIONS`].
///
/// To second order in the distance of `start` it is the point that the shortest displacement leads to. `displaced` is Q exp(ξ);
/// `relations` has their values at Q, C of them and all independent, and their derivatives along displacements of Q, C×G.
pub fn project_by_displacements<T: Scalar, const N: usize, const G: usize, const C: usize>(
    start: &SVector<T, N>,
    displaced: impl Fn(&SVector<T, N>, &SVector<T, G>) -> SVector<T, N>,
    relations: impl Fn(&SVector<T, N>) -> (SVector<T, C>, SMatrix<T, C, G>),
) -> SVector<T, N> {
    let shortest = |q: &SVector<T, N>| {
        let (values, slopes) = relations(q);
        let back = slopes.transpose();
        -product(&back, &least_squares(&product(&slopes, &back), &values))
    };
    by_shortest(start, displaced, shortest)
}

/// What [`project_by_displacements`] does, `shortest` being the displacement that Newton's method asks for at Q.
#[inline]
pub(crate) fn by_shortest<T: Scalar, const N: usize, const G: usize>(
    start: &SVector<T, N>,
    displaced: impl Fn(&SVector<T, N>, &SVector<T, G>) -> SVector<T, N>,
    shortest: impl Fn(&SVector<T, N>) -> SVector<T, G>,
) -> SVector<T, N> {
    let mut q = *start;
    for _ in 0..PROJECT_ITERATIONS {
        q = displaced(&q, &shortest(&q));
    }
    // Displacements are measured by angles: coordinates may all be near 0.
    unless_apart(&q, norm(&shortest(&q)), T::one() + norm(&q))
}

/// `direction_j · δ = −value_j`, one equation a relation, each scaled to a unit direction.
struct Equations<T, const N: usize, const R: usize> {
    /// N×R.
    directions: SMatrix<T, N, R>,
    values: SVector<T, R>,
}

impl<T: Scalar, const N: usize, const R: usize> Equations<T, N, R> {
    fn at(
        q: &SVector<T, N>,
        relations: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, R>,
    ) -> Self {
        let (mut values, gradient) = with_jacobian(relations, q);
        let mut directions = gradient.transpose();
        for j in 0..R {
            let length = norm(&column(&directions, j));
            // A relation without gradient cannot be corrected, but it is still checked.
            let divisor = T::select(T::zero().less(length), length, T::one());
            values[j] /= divisor;
            for i in 0..N {
                directions.data.0[j][i] /= divisor;
            }
        }
        Self { directions, values }
    }

    /// The least δ that solves `rank` of the equations, chosen one after the other by what is left of their directions.
    fn shortest_solution(mut self, rank: usize) -> SVector<T, N> {
        let mut solution = zeros::<T, N, 1>();
        // No more of them are independent than there are relations.
        for _ in 0..rank.min(R) {
            let (direction, value) = self.most_independent();
            solution -= direction * value;
            self.eliminate(&direction, value);
        }
        solution
    }

    /// The longest direction, scaled to 1, and its value.
    fn most_independent(&self) -> (SVector<T, N>, T) {
        let zero = T::zero();
        let mut best = zeros::<T, N, 1>();
        let (mut value, mut longest) = (zero, zero);
        for j in 0..R {
            let candidate = self.values.data.0[0][j];
            let column = column(&self.directions, j);
            let length = norm(&column);
            let longer = longest.less(length);
            best = entries(|i| T::select(longer, column[i], best[i]));
            value = T::select(longer, candidate, value);
            longest = T::select(longer, length, longest);
        }
        let divisor = T::select(zero.less(longest), longest, T::one());
        (best / divisor, value / divisor)
    }

    /// Takes `direction` out of every equation.
    fn eliminate(&mut self, direction: &SVector<T, N>, value: T) {
        for j in 0..R {
            let share = dot(direction, &column(&self.directions, j));
            self.values.data.0[0][j] -= share * value;
            for i in 0..N {
                self.directions.data.0[j][i] -= share * direction.data.0[0][i];
            }
        }
    }
}
