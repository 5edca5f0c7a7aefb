//! What the derivatives of the dynamics need of a joint beyond its kernels: [`Products`] of them, the same for every joint.
//!
//! With X̄^c = X^c S̄, its derivatives are `∂X̄^c/∂ϕ_k = ∂X^c_k S̄ + X^c ∂S̄_k`, and ϕ̇ = S₀⁻¹ S̄ v̄. Slices and entries that the joint's
//! [`Patterns`](super::Patterns) know to be 0 are left out when this is compiled for a joint. Second derivatives are first ones of the
//! kernels of c and its dual, by automatic differentiation along each ϕ_k.

use super::patterns::any;
use super::slices::{
    add_moved, add_product, combined, times, transposed_times, turned, turned_back,
};
use super::{Entry, Joint, Structure};
use crate::matrix::{column, entries, map, product, set_column, zeros};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// The derivatives of a column of `$rows` entries along each ϕ_k, as many at once as there are, but at most three: more would be kept in
/// memory.
macro_rules! gradient {
    ($joint:ident, $q:ident, $rows:tt, |$moved:ident| $value:expr) => {
        match const { moving(&Self::PATTERNS.bias_gradient).1 } {
            0 => zeros(),
            1 => along_each::<T, Self, N, K, S, C, $rows, 1>($joint, $q, |$moved| $value),
            2 => along_each::<T, Self, N, K, S, C, $rows, 2>($joint, $q, |$moved| $value),
            _ => along_each::<T, Self, N, K, S, C, $rows, 3>($joint, $q, |$moved| $value),
        }
    };
}

/// X^c, S̄ and their derivatives at one Q. What the joint's structures make needless is 0: X^c where S̄ is constant.
#[derive(Clone, Copy, Debug)]
pub struct FirstOrder<T, const K: usize, const S: usize> {
    map: SMatrix<T, 6, K>,
    map_slices: [SMatrix<T, 6, K>; K],
    basis: SMatrix<T, K, S>,
    basis_slices: [SMatrix<T, K, S>; K],
}

/// Products of a joint's kernels and their derivatives, at ϕ = 0. Shapes, units and frames are those of [`Joint`].
pub trait Products<const N: usize, const K: usize, const S: usize, const C: usize>:
    Joint<N, K, S, C>
{
    /// X^c S₀: ϕ̇ at ϕ = 0 to the twist of the child relative to the parent, in the child frame.
    #[inline]
    fn local_twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        let map = self.twist_map_child(q);
        match const { Self::STRUCTURES.velocity_map.is_identity() } {
            true => map,
            false => product(&map, &self.velocity_map(q)),
        }
    }

    /// What the products below are made of, at one Q.
    #[inline]
    fn first_order<T: Scalar>(&self, q: &SVector<T, N>) -> FirstOrder<T, K, S> {
        FirstOrder {
            map: match const { Self::STRUCTURES.speed_basis_gradient.is_zero() } {
                true => zeros(),
                false => self.twist_map_child(q),
            },
            map_slices: match const { Self::STRUCTURES.twist_map_child_gradient.is_zero() } {
                true => [zeros(); K],
                false => self.twist_map_child_gradient(q),
            },
            basis: self.speed_basis(q),
            basis_slices: match const { Self::STRUCTURES.speed_basis_gradient.is_zero() } {
                true => [zeros(); K],
                false => self.speed_basis_gradient(q),
            },
        }
    }

    /// ∂(X̄^c v̄)/∂ϕ at fixed v̄; column k is the derivative along ϕ_k.
    #[inline]
    fn twist_gradient<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, K> {
        Self::twist_gradient_at(&self.first_order(q), speeds)
    }

    /// The same where the first order is known: column k is `∂X^c_k S̄ v̄ + X^c ∂S̄_k v̄`.
    #[inline]
    fn twist_gradient_at<T: Scalar>(
        first: &FirstOrder<T, K, S>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, K> {
        let patterns = const { &Self::PATTERNS };
        let velocity = times(&first.basis, &patterns.speed_basis, speeds);
        let mut gradient = zeros::<T, 6, K>();
        for k in 0..K {
            let pattern = &patterns.twist_map_child_gradient[k];
            let mut column = times(&first.map_slices[k], pattern, &velocity);
            let map = (&first.map, &patterns.twist_map_child);
            let slice = (&first.basis_slices[k], &patterns.speed_basis_gradient[k]);
            add_moved(&mut column, map, slice, speeds);
            set_column(&mut gradient, k, &column);
        }
        gradient
    }

    /// ∂(X̄^cᵀ h)/∂ϕ for a wrench or momentum `h` (moment; linear) that is fixed in the child frame, the dual of
    /// [`Products::twist_gradient`]: column k is `S̄ᵀ ∂X^c_kᵀ h + ∂S̄_kᵀ X^cᵀ h`.
    #[inline]
    fn effort_gradient<T: Scalar>(&self, q: &SVector<T, N>, h: &SVector<T, 6>) -> SMatrix<T, S, K> {
        let patterns = const { &Self::PATTERNS };
        let first = self.first_order(q);
        let moved = transposed_times(&first.map, &patterns.twist_map_child, h);
        let mut gradient = zeros::<T, S, K>();
        for k in 0..K {
            let pattern = &patterns.twist_map_child_gradient[k];
            let efforts = transposed_times(&first.map_slices[k], pattern, h);
            let of_basis = &patterns.speed_basis_gradient[k];
            let column = transposed_times(&first.basis, &patterns.speed_basis, &efforts)
                + transposed_times(&first.basis_slices[k], of_basis, &moved);
            set_column(&mut gradient, k, &column);
        }
        gradient
    }

    /// Ẋ̄^c at the speeds v̄: `c = Ẋ̄^c v̄`.
    #[inline]
    fn twist_map_rate<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, S> {
        let first = self.first_order(q);
        let local = self.local_rates(q, &first.basis);
        let local = times(
            &local,
            const { &local_pattern::<Self, N, K, S, C>() },
            speeds,
        );
        Self::twist_map_rate_at(&first, &local)
    }

    /// The same where the first order and ϕ̇ are known: `(Σ_k ∂X^c_k ϕ̇_k) S̄ + X^c Σ_k ∂S̄_k ϕ̇_k`.
    #[inline]
    fn twist_map_rate_at<T: Scalar>(
        first: &FirstOrder<T, K, S>,
        local: &SVector<T, K>,
    ) -> SMatrix<T, 6, S> {
        let patterns = const { &Self::PATTERNS };
        let (of_map, of_basis) = const {
            (
                any(&Self::PATTERNS.twist_map_child_gradient),
                any(&Self::PATTERNS.speed_basis_gradient),
            )
        };
        let slices = &patterns.twist_map_child_gradient;
        let of_slices = combined(&first.map_slices, slices, local);
        let slices = &patterns.speed_basis_gradient;
        let of_bases = combined(&first.basis_slices, slices, local);
        let mut rate = zeros();
        let basis = (&first.basis, &patterns.speed_basis);
        add_product(&mut rate, (&of_slices, &of_map), basis);
        let map = (&first.map, &patterns.twist_map_child);
        add_product(&mut rate, map, (&of_bases, &of_basis));
        rate
    }

    /// `c = Ẋ̄^c v̄ = Σ_k (∂X^c_k S̄ v̄ + X^c ∂S̄_k v̄) ϕ̇_k` in the child frame: [`Joint::bias_acceleration`] where a joint has no formula of
    /// its own.
    #[inline]
    fn bias_acceleration_by_products<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SVector<T, 6> {
        let patterns = const { &Self::PATTERNS };
        let mut bias = zeros();
        if const { Self::STRUCTURES.bias_acceleration.is_zero() } {
            return bias;
        }
        let velocity = self.velocity(q, speeds);
        let local = self.local_rate(q, &velocity);
        if const { !Self::STRUCTURES.twist_map_child_gradient.is_zero() } {
            let slices = self.twist_map_child_gradient(q);
            bias += turned(
                &slices,
                &patterns.twist_map_child_gradient,
                &local,
                &velocity,
            );
        }
        if const { !Self::STRUCTURES.speed_basis_gradient.is_zero() } {
            let slices = self.speed_basis_gradient(q);
            let moved = turned(&slices, &patterns.speed_basis_gradient, &local, speeds);
            bias += times(&self.twist_map_child(q), &patterns.twist_map_child, &moved);
        }
        bias
    }

    /// `Ẋ̄^cᵀ h = Σ_k ϕ̇_k (S̄ᵀ ∂X^c_kᵀ h + ∂S̄_kᵀ X^cᵀ h)`: [`Joint::bias_momentum`] where a joint has no formula of its own.
    #[inline]
    fn bias_momentum_by_products<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
        h: &SVector<T, 6>,
    ) -> SVector<T, S> {
        let patterns = const { &Self::PATTERNS };
        let mut bias = zeros();
        if const { Self::STRUCTURES.bias_momentum.is_zero() } {
            return bias;
        }
        let local = self.local_rate(q, &self.velocity(q, speeds));
        if const { !Self::STRUCTURES.twist_map_child_gradient.is_zero() } {
            let slices = self.twist_map_child_gradient(q);
            let efforts = turned_back(&slices, &patterns.twist_map_child_gradient, &local, h);
            bias += self.reduced(q, &efforts);
        }
        if const { !Self::STRUCTURES.speed_basis_gradient.is_zero() } {
            let map = self.twist_map_child(q);
            let efforts = transposed_times(&map, &patterns.twist_map_child, h);
            let slices = self.speed_basis_gradient(q);
            bias += turned_back(&slices, &patterns.speed_basis_gradient, &local, &efforts);
        }
        bias
    }

    /// `v = S̄ v̄`.
    #[inline]
    fn velocity<T: Scalar>(&self, q: &SVector<T, N>, speeds: &SVector<T, S>) -> SVector<T, K> {
        let pattern = const { &Self::PATTERNS.speed_basis };
        times(&self.speed_basis(q), pattern, speeds)
    }

    /// `S̄ᵀ e` for efforts `e` on v.
    #[inline]
    fn reduced<T: Scalar>(&self, q: &SVector<T, N>, efforts: &SVector<T, K>) -> SVector<T, S> {
        let pattern = const { &Self::PATTERNS.speed_basis };
        transposed_times(&self.speed_basis(q), pattern, efforts)
    }

    /// `ϕ̇ = S₀⁻¹ v` at ϕ = 0.
    #[inline]
    fn local_rate<T: Scalar>(&self, q: &SVector<T, N>, velocity: &SVector<T, K>) -> SVector<T, K> {
        match const { Self::STRUCTURES.velocity_map.is_identity() } {
            true => *velocity,
            false => product(&self.velocity_map_inverse(q), velocity),
        }
    }

    /// `S₀⁻¹ S̄`, v̄ to ϕ̇, where S̄ is known.
    #[inline]
    fn local_rates<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        basis: &SMatrix<T, K, S>,
    ) -> SMatrix<T, K, S> {
        match const { Self::STRUCTURES.velocity_map.is_identity() } {
            true => *basis,
            false => product(&self.velocity_map_inverse(q), basis),
        }
    }

    /// ∂c/∂v̄ of [`Joint::bias_acceleration`]: `Ẋ̄^c + ∂(X̄^c v̄)/∂ϕ S₀⁻¹ S̄`.
    #[inline]
    fn bias_acceleration_slope<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, S> {
        let first = self.first_order(q);
        let of_twist = Self::twist_gradient_at(&first, speeds);
        self.bias_acceleration_slope_at((q, speeds), &first, &of_twist)
    }

    /// The same where the first order and [`Products::twist_gradient`] are known.
    #[inline]
    fn bias_acceleration_slope_at<T: Scalar>(
        &self,
        (q, speeds): (&SVector<T, N>, &SVector<T, S>),
        first: &FirstOrder<T, K, S>,
        of_twist: &SMatrix<T, 6, K>,
    ) -> SMatrix<T, 6, S> {
        let pattern = const { &local_pattern::<Self, N, K, S, C>() };
        let local = self.local_rates(q, &first.basis);
        let mut slope = Self::twist_map_rate_at(first, &times(&local, pattern, speeds));
        let full = [[Entry::Other; K]; 6];
        add_product(&mut slope, (of_twist, &full), (&local, pattern));
        slope
    }

    /// ∂(Ẋ̄^cᵀ h)/∂v̄ at fixed h, of [`Joint::bias_momentum`]: `∂(X̄^cᵀ h)/∂ϕ S₀⁻¹ S̄`.
    #[inline]
    fn bias_momentum_slope<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        h: &SVector<T, 6>,
    ) -> SMatrix<T, S, S> {
        let pattern = const { &local_pattern::<Self, N, K, S, C>() };
        let local = self.local_rates(q, &self.speed_basis(q));
        let mut slope = zeros();
        let full = [[Entry::Other; K]; S];
        let gradient = self.effort_gradient(q, h);
        add_product(&mut slope, (&gradient, &full), (&local, pattern));
        slope
    }

    /// ∂c/∂ϕ at fixed v̄, of [`Joint::bias_acceleration`].
    #[inline]
    fn bias_acceleration_gradient<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, K> {
        if const { Self::STRUCTURES.bias_acceleration.is_constant() } {
            return zeros();
        }
        gradient!(self, q, 6, |q| self
            .bias_acceleration(q, &map(speeds, Dual::constant)))
    }

    /// ∂(Ẋ̄^cᵀ h)/∂ϕ at fixed v̄ and h, of [`Joint::bias_momentum`].
    #[inline]
    fn bias_momentum_gradient<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
        h: &SVector<T, 6>,
    ) -> SMatrix<T, S, K> {
        if const { Self::STRUCTURES.bias_momentum.is_constant() } {
            return zeros();
        }
        gradient!(self, q, S, |q| self.bias_momentum(
            q,
            &map(speeds, Dual::constant),
            &map(h, Dual::constant)
        ))
    }
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Products<N, K, S, C> for J where
    J: Joint<N, K, S, C>
{
}

/// The pattern of `S₀⁻¹ S̄`.
const fn local_pattern<J, const N: usize, const K: usize, const S: usize, const C: usize>()
-> [[Entry; S]; K]
where
    J: Joint<N, K, S, C>,
{
    match J::STRUCTURES.velocity_map {
        Structure::Identity => J::PATTERNS.speed_basis,
        _ => [[Entry::Other; S]; K],
    }
}

/// The indices of the entries that are not known to be 0, and how many there are.
const fn moving<const K: usize>(entries: &[Entry; K]) -> ([usize; K], usize) {
    let (mut indices, mut count, mut k) = ([0; K], 0, 0);
    while k < K {
        if !matches!(entries[k], Entry::Zero) {
            indices[count] = k;
            count += 1;
        }
        k += 1;
    }
    (indices, count)
}

/// The derivatives of c or its dual along each ϕ_k at ϕ = 0, which moves Q with `Q̇(Q, S₀ e_k)`; `D` of them at once.
#[inline(always)]
fn along_each<
    T,
    J,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
    const R: usize,
    const D: usize,
>(
    joint: &J,
    q: &SVector<T, N>,
    function: impl Fn(&SVector<Dual<T, D>, N>) -> SVector<Dual<T, D>, R>,
) -> SMatrix<T, R, K>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let mut gradient = zeros::<T, R, K>();
    let velocities = joint.velocity_map(q);
    let (indices, count) = const { moving(&J::PATTERNS.bias_gradient) };
    let mut first = 0;
    while first < count {
        // Where fewer are left than fit, the first of them fills the rest.
        let index = |d: usize| indices[if first + d < count { first + d } else { first }];
        let mut moved = map(q, Dual::constant);
        for d in 0..D {
            let rate = joint.configuration_rate(q, &column(&velocities, index(d)));
            for i in 0..N {
                moved.data.0[0][i].derivatives[d] = rate.data.0[0][i];
            }
        }
        let value = function(&moved);
        for d in 0..D {
            let own = entries(|i| value.data.0[0][i].derivatives[d]);
            set_column(&mut gradient, index(d), &own);
        }
        first += D;
    }
    gradient
}
