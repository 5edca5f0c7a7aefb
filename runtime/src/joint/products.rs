//! What the derivatives of the dynamics need of a joint beyond its kernels: [`Products`] of them, the same for every joint.
//!
//! With X̄^c = X^c S̄, its slices are `∂X̄^c/∂ϕ_k = ∂X^c_k S̄ + X^c ∂S̄_k`, and ϕ̇ = S₀⁻¹ S̄ v̄. Slices and entries that the joint's
//! [`Patterns`](super::Patterns) know to be 0 are left out when this is compiled for a joint. Second derivatives are first ones of the
//! kernels of c and its dual, by automatic differentiation along each ϕ_k.

use super::{Entry, Joint};
use crate::scalar::{Dual, Scalar};
use nalgebra::{SMatrix, SVector};

/// Products of a joint's kernels and their derivatives, at ϕ = 0. Shapes, units and frames are those of [`Joint`].
pub trait Products<const N: usize, const K: usize, const S: usize, const C: usize>:
    Joint<N, K, S, C>
{
    /// X^c S₀: ϕ̇ at ϕ = 0 to the twist of the child relative to the parent, in the child frame.
    #[inline]
    fn local_twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K> {
        let map = self.twist_map_child(q);
        match Self::STRUCTURES.velocity_map.is_identity() {
            true => map,
            false => map * self.velocity_map(q),
        }
    }

    /// ∂X̄^c/∂ϕ; slice k is the derivative along ϕ_k.
    #[inline]
    fn speed_map_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, 6, S>; K] {
        let patterns = const { &Self::PATTERNS };
        let mut gradient = [SMatrix::zeros(); K];
        if Self::STRUCTURES.speed_map.is_constant() {
            return gradient;
        }
        if !Self::STRUCTURES.twist_map_child_gradient.is_zero() {
            let (slices, basis) = (self.twist_map_child_gradient(q), self.speed_basis(q));
            for k in 0..K {
                let slice = (&slices[k], &patterns.twist_map_child_gradient[k]);
                add_product(&mut gradient[k], slice, (&basis, &patterns.speed_basis));
            }
        }
        if !Self::STRUCTURES.speed_basis_gradient.is_zero() {
            let (map, slices) = (self.twist_map_child(q), self.speed_basis_gradient(q));
            for k in 0..K {
                let slice = (&slices[k], &patterns.speed_basis_gradient[k]);
                add_product(&mut gradient[k], (&map, &patterns.twist_map_child), slice);
            }
        }
        gradient
    }

    /// ∂(X̄^c v̄)/∂ϕ at fixed v̄; column k is the derivative along ϕ_k.
    #[inline]
    fn twist_gradient<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, K> {
        Self::twist_gradient_by_slices(&self.speed_map_gradient(q), speeds)
    }

    /// The same from [`Products::speed_map_gradient`].
    #[inline]
    fn twist_gradient_by_slices<T: Scalar>(
        slices: &[SMatrix<T, 6, S>; K],
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, K> {
        let pattern = const { &Self::PATTERNS.speed_map_gradient() };
        let mut gradient = SMatrix::<T, _, K>::zeros();
        for k in 0..K {
            gradient.set_column(k, &times(&slices[k], &pattern[k], speeds));
        }
        gradient
    }

    /// ∂(X̄^cᵀ h)/∂ϕ for a wrench or momentum `h` (moment; linear) that is fixed in the child frame: the dual of
    /// [`Products::twist_gradient`].
    #[inline]
    fn effort_gradient<T: Scalar>(&self, q: &SVector<T, N>, h: &SVector<T, 6>) -> SMatrix<T, S, K> {
        let pattern = const { &Self::PATTERNS.speed_map_gradient() };
        let slices = self.speed_map_gradient(q);
        let mut gradient = SMatrix::<T, _, K>::zeros();
        for k in 0..K {
            gradient.set_column(k, &transposed_times(&slices[k], &pattern[k], h));
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
        let local = local_rates(self, q) * speeds;
        Self::twist_map_rate_by_slices(&self.speed_map_gradient(q), &local)
    }

    /// The same from [`Products::speed_map_gradient`] and ϕ̇.
    #[inline]
    fn twist_map_rate_by_slices<T: Scalar>(
        slices: &[SMatrix<T, 6, S>; K],
        local: &SVector<T, K>,
    ) -> SMatrix<T, 6, S> {
        combined(
            slices,
            const { &Self::PATTERNS.speed_map_gradient() },
            local,
        )
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
        let mut bias = SVector::zeros();
        if Self::STRUCTURES.bias_acceleration.is_zero() {
            return bias;
        }
        let velocity = self.velocity(q, speeds);
        let local = self.local_rate(q, &velocity);
        if !Self::STRUCTURES.twist_map_child_gradient.is_zero() {
            let slices = self.twist_map_child_gradient(q);
            bias += turned(
                &slices,
                &patterns.twist_map_child_gradient,
                &local,
                &velocity,
            );
        }
        if !Self::STRUCTURES.speed_basis_gradient.is_zero() {
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
        let mut bias = SVector::zeros();
        if Self::STRUCTURES.bias_momentum.is_zero() {
            return bias;
        }
        let local = self.local_rate(q, &self.velocity(q, speeds));
        if !Self::STRUCTURES.twist_map_child_gradient.is_zero() {
            let slices = self.twist_map_child_gradient(q);
            let efforts = turned_back(&slices, &patterns.twist_map_child_gradient, &local, h);
            bias += self.reduced(q, &efforts);
        }
        if !Self::STRUCTURES.speed_basis_gradient.is_zero() {
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
        match Self::STRUCTURES.velocity_map.is_identity() {
            true => *velocity,
            false => self.velocity_map_inverse(q) * velocity,
        }
    }

    /// ∂c/∂v̄ of [`Joint::bias_acceleration`]: `Ẋ̄^c + ∂(X̄^c v̄)/∂ϕ S₀⁻¹ S̄`.
    #[inline]
    fn bias_acceleration_slope<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, S> {
        let slices = self.speed_map_gradient(q);
        let of_twist = Self::twist_gradient_by_slices(&slices, speeds);
        self.bias_acceleration_slope_by_slices((q, speeds), &slices, &of_twist)
    }

    /// The same from [`Products::speed_map_gradient`] and [`Products::twist_gradient`].
    #[inline]
    fn bias_acceleration_slope_by_slices<T: Scalar>(
        &self,
        (q, speeds): (&SVector<T, N>, &SVector<T, S>),
        slices: &[SMatrix<T, 6, S>; K],
        of_twist: &SMatrix<T, 6, K>,
    ) -> SMatrix<T, 6, S> {
        let local = local_rates(self, q);
        Self::twist_map_rate_by_slices(slices, &(local * speeds)) + of_twist * local
    }

    /// ∂(Ẋ̄^cᵀ h)/∂v̄ at fixed h, of [`Joint::bias_momentum`]: `∂(X̄^cᵀ h)/∂ϕ S₀⁻¹ S̄`.
    #[inline]
    fn bias_momentum_slope<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        h: &SVector<T, 6>,
    ) -> SMatrix<T, S, S> {
        self.effort_gradient(q, h) * local_rates(self, q)
    }

    /// ∂c/∂ϕ at fixed v̄, of [`Joint::bias_acceleration`].
    #[inline]
    fn bias_acceleration_gradient<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SMatrix<T, 6, K> {
        if Self::STRUCTURES.bias_acceleration.is_constant() {
            return SMatrix::zeros();
        }
        let speeds = speeds.map(Dual::constant);
        along_each(self, q, |q| self.bias_acceleration(q, &speeds))
    }

    /// ∂(Ẋ̄^cᵀ h)/∂ϕ at fixed v̄ and h, of [`Joint::bias_momentum`].
    #[inline]
    fn bias_momentum_gradient<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
        h: &SVector<T, 6>,
    ) -> SMatrix<T, S, K> {
        if Self::STRUCTURES.bias_momentum.is_constant() {
            return SMatrix::zeros();
        }
        let (speeds, h) = (speeds.map(Dual::constant), h.map(Dual::constant));
        along_each(self, q, |q| self.bias_momentum(q, &speeds, &h))
    }
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Products<N, K, S, C> for J where
    J: Joint<N, K, S, C>
{
}

/// S₀⁻¹ S̄: v̄ to ϕ̇.
#[inline(always)]
fn local_rates<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    q: &SVector<T, N>,
) -> SMatrix<T, K, S>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let basis = joint.speed_basis(q);
    match J::STRUCTURES.velocity_map.is_identity() {
        true => basis,
        false => joint.velocity_map_inverse(q) * basis,
    }
}

/// The derivatives of c or its dual along each ϕ_k at ϕ = 0, which moves Q with `Q̇(Q, S₀ e_k)`.
#[inline(always)]
fn along_each<
    T,
    J,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
    const R: usize,
>(
    joint: &J,
    q: &SVector<T, N>,
    function: impl Fn(&SVector<Dual<T>, N>) -> SVector<Dual<T>, R>,
) -> SMatrix<T, R, K>
where
    T: Scalar,
    J: Joint<N, K, S, C>,
{
    let velocities = joint.velocity_map(q);
    let column = |k: usize| {
        if J::PATTERNS.bias_gradient[k] == Entry::Zero {
            return SVector::zeros();
        }
        let rate = joint.configuration_rate(q, &velocities.column(k).into_owned());
        function(&q.zip_map(&rate, Dual::new)).map(|entry| entry.derivative)
    };
    SMatrix::from_columns(&core::array::from_fn::<_, K, _>(column))
}

/// `Σ_k M_k x_k` without what `patterns` know to be 0 or 1.
#[inline(always)]
fn combined<T: Scalar, const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<T, R, C>; K],
    patterns: &[[[Entry; C]; R]; K],
    x: &SVector<T, K>,
) -> SMatrix<T, R, C> {
    let mut sum = SMatrix::zeros();
    for k in 0..K {
        for i in 0..R {
            for j in 0..C {
                let known = patterns[k][i][j];
                sum[(i, j)] = accumulated(sum[(i, j)], known, slices[k][(i, j)], x[k]);
            }
        }
    }
    sum
}

/// `Σ_k M_k x y_k` without what `patterns` know to be 0 or 1.
#[inline(always)]
fn turned<T: Scalar, const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<T, R, C>; K],
    patterns: &[[[Entry; C]; R]; K],
    y: &SVector<T, K>,
    x: &SVector<T, C>,
) -> SVector<T, R> {
    let mut sum = SVector::zeros();
    for k in 0..K {
        let column = times(&slices[k], &patterns[k], x);
        for i in 0..R {
            if patterns[k][i].iter().any(|entry| *entry != Entry::Zero) {
                sum[i] = column[i].mul_add(y[k], sum[i]);
            }
        }
    }
    sum
}

/// `Σ_k M_kᵀ x y_k` without what `patterns` know to be 0 or 1.
#[inline(always)]
fn turned_back<T: Scalar, const R: usize, const C: usize, const K: usize>(
    slices: &[SMatrix<T, R, C>; K],
    patterns: &[[[Entry; C]; R]; K],
    y: &SVector<T, K>,
    x: &SVector<T, R>,
) -> SVector<T, C> {
    let mut sum = SVector::zeros();
    for k in 0..K {
        let column = transposed_times(&slices[k], &patterns[k], x);
        for j in 0..C {
            if patterns[k].iter().any(|row| row[j] != Entry::Zero) {
                sum[j] = column[j].mul_add(y[k], sum[j]);
            }
        }
    }
    sum
}

/// `sum + A B` without what the patterns of A and B know to be 0 or 1.
#[inline(always)]
fn add_product<T: Scalar, const R: usize, const M: usize, const C: usize>(
    sum: &mut SMatrix<T, R, C>,
    (a, of_a): (&SMatrix<T, R, M>, &[[Entry; M]; R]),
    (b, of_b): (&SMatrix<T, M, C>, &[[Entry; C]; M]),
) {
    for i in 0..R {
        for m in 0..M {
            for j in 0..C {
                let entry = &mut sum[(i, j)];
                match of_a[i][m] {
                    Entry::Zero => {}
                    Entry::One => *entry = accumulated(*entry, of_b[m][j], b[(m, j)], T::one()),
                    Entry::Other => *entry = accumulated(*entry, of_b[m][j], b[(m, j)], a[(i, m)]),
                }
            }
        }
    }
}

/// `M x` without what `pattern` knows to be 0 or 1.
#[inline(always)]
fn times<T: Scalar, const R: usize, const C: usize>(
    matrix: &SMatrix<T, R, C>,
    pattern: &[[Entry; C]; R],
    x: &SVector<T, C>,
) -> SVector<T, R> {
    let mut product = SVector::zeros();
    for i in 0..R {
        for j in 0..C {
            product[i] = accumulated(product[i], pattern[i][j], matrix[(i, j)], x[j]);
        }
    }
    product
}

/// `Mᵀ x` without what `pattern` of M knows to be 0 or 1.
#[inline(always)]
fn transposed_times<T: Scalar, const R: usize, const C: usize>(
    matrix: &SMatrix<T, R, C>,
    pattern: &[[Entry; C]; R],
    x: &SVector<T, R>,
) -> SVector<T, C> {
    let mut product = SVector::zeros();
    for j in 0..C {
        for i in 0..R {
            product[j] = accumulated(product[j], pattern[i][j], matrix[(i, j)], x[i]);
        }
    }
    product
}

/// `sum + entry x`.
#[inline(always)]
fn accumulated<T: Scalar>(sum: T, pattern: Entry, entry: T, x: T) -> T {
    match pattern {
        Entry::Zero => sum,
        Entry::One => sum + x,
        Entry::Other => entry.mul_add(x, sum),
    }
}
