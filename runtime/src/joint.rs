//! The contract between a generated joint and the runtime: the static trait [`Joint`].
//!
//! `hamel-codegen` emits one implementation for each `.joint` file. The runtime never lists joint types: it knows this
//! trait alone. All methods are pure in their arguments and allocate nothing. Everything that belongs to the local
//! coordinates ϕ is evaluated at ϕ = 0 unless the method takes `phi`. Equation numbers are those of Duindam and
//! Stramigioli, *Singularity-free dynamic equations of open-chain mechanisms with general holonomic and nonholonomic joints*.

mod products;

pub use products::Products;

use crate::scalar::Scalar;
use crate::spatial::Pose;
use core::fmt::Debug;
use nalgebra::{SMatrix, SVector};

/// Version of the [`Joint`] trait. Generated code asserts it at compile time.
pub const KERNEL_INTERFACE: u32 = 5;

/// Fails to compile where generated code and runtime differ in the [`Joint`] trait.
///
/// Generated files contain `const _: () = hamel::joint::assert_kernel_interface(5);`.
pub const fn assert_kernel_interface(version: u32) {
    assert!(
        version == KERNEL_INTERFACE,
        "this joint was generated for another version of the runtime's kernel interface: generate it again"
    );
}

/// The matrix with the given rows, as emitted kernels write it.
pub fn from_rows<T: Scalar, const R: usize, const C: usize>(rows: [[T; C]; R]) -> SMatrix<T, R, C> {
    SMatrix::from_fn(|i, j| rows[i][j])
}

/// What is known of a kernel's value at compile time, so that an algorithm can skip what it need not compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Structure {
    /// Identically zero.
    Zero,
    /// The identity matrix, or the identity map.
    Identity,
    /// The same at every configuration.
    Constant,
    /// Depends on the configuration.
    General,
}

impl Structure {
    /// Whether the kernel vanishes identically.
    pub const fn is_zero(self) -> bool {
        matches!(self, Self::Zero)
    }

    /// Whether the kernel is the identity.
    pub const fn is_identity(self) -> bool {
        matches!(self, Self::Identity)
    }

    /// Whether the kernel is the same at every configuration.
    pub const fn is_constant(self) -> bool {
        !matches!(self, Self::General)
    }
}

/// The [`Structure`] of each kernel that can be trivial.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Structures {
    /// X in the parent frame.
    pub twist_map: Structure,
    /// X in the child frame.
    pub twist_map_child: Structure,
    /// ∂X^c/∂ϕ.
    pub twist_map_child_gradient: Structure,
    /// S₀.
    pub velocity_map: Structure,
    /// ∂S/∂ϕ.
    pub velocity_map_gradient: Structure,
    /// Σ γ_k v_k, and with it J22.
    pub gamma: Structure,
    /// S̄: identity for a holonomic joint.
    pub speed_basis: Structure,
    /// ∂S̄/∂ϕ.
    pub speed_basis_gradient: Structure,
    /// Differential of Φ at finite ϕ.
    pub retract_differential: Structure,
    /// c = Ẋ̄^c v̄.
    pub bias_acceleration: Structure,
    /// Ẋ̄^cᵀ h.
    pub bias_momentum: Structure,
    /// X̄^c = X^c S̄.
    pub speed_map: Structure,
}

/// What is known of one entry of a kernel's value at compile time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// 0 at every configuration.
    Zero,
    /// 1 at every configuration.
    One,
    /// Anything else.
    Other,
}

/// The [`Entry`] of each place in the kernels that recursions spend their time on, so that they multiply by nothing that is
/// known to be 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patterns<const K: usize, const S: usize> {
    /// The rotation matrix of H, by rows.
    pub rotation: [[Entry; 3]; 3],
    /// The translation of H.
    pub translation: [Entry; 3],
    /// X^c, by rows.
    pub twist_map_child: [[Entry; K]; 6],
    /// S̄, by rows.
    pub speed_basis: [[Entry; S]; K],
    /// The slices of ∂X^c/∂ϕ, by rows.
    pub twist_map_child_gradient: [[[Entry; K]; 6]; K],
    /// The slices of ∂S̄/∂ϕ, by rows.
    pub speed_basis_gradient: [[[Entry; S]; K]; K],
}

impl<const K: usize, const S: usize> Patterns<K, S> {
    /// Nothing is known.
    pub const DENSE: Self = Self {
        rotation: [[Entry::Other; 3]; 3],
        translation: [Entry::Other; 3],
        twist_map_child: [[Entry::Other; K]; 6],
        speed_basis: [[Entry::Other; S]; K],
        twist_map_child_gradient: [[[Entry::Other; K]; 6]; K],
        speed_basis_gradient: [[[Entry::Other; S]; K]; K],
    };

    /// A pattern from rows of the signs `0`, `1` and `x` for anything else, as generated code writes it. Of derivatives along ϕ, slices
    /// that are not zero are given with their numbers.
    pub const fn new(
        rotation: [&str; 3],
        translation: &str,
        twist_map_child: [&str; 6],
        speed_basis: [&str; K],
        twist_map_child_gradient: &[(usize, [&str; 6])],
        speed_basis_gradient: &[(usize, [&str; K])],
    ) -> Self {
        let [translation] = entries([translation]);
        Self {
            rotation: entries(rotation),
            translation,
            twist_map_child: entries(twist_map_child),
            speed_basis: entries(speed_basis),
            twist_map_child_gradient: slices(twist_map_child_gradient),
            speed_basis_gradient: slices(speed_basis_gradient),
        }
    }

    /// The pattern of `X^c S̄`, by rows.
    pub const fn speed_columns(&self) -> [[Entry; S]; 6] {
        let mut columns = [[Entry::Zero; S]; 6];
        let mut i = 0;
        while i < 6 {
            let mut j = 0;
            while j < S {
                let mut k = 0;
                while k < K {
                    let term = product(self.twist_map_child[i][k], self.speed_basis[k][j]);
                    columns[i][j] = sum(columns[i][j], term);
                    k += 1;
                }
                j += 1;
            }
            i += 1;
        }
        columns
    }
}

const fn entries<const R: usize, const C: usize>(rows: [&str; R]) -> [[Entry; C]; R] {
    let mut entries = [[Entry::Other; C]; R];
    let mut i = 0;
    while i < R {
        let row = rows[i].as_bytes();
        assert!(
            row.len() == C,
            "a row of a pattern has another length than its matrix"
        );
        let mut j = 0;
        while j < C {
            entries[i][j] = match row[j] {
                b'0' => Entry::Zero,
                b'1' => Entry::One,
                b'x' => Entry::Other,
                _ => panic!("a pattern is written in the signs 0, 1 and x"),
            };
            j += 1;
        }
        i += 1;
    }
    entries
}

const fn slices<const R: usize, const C: usize, const K: usize>(
    given: &[(usize, [&str; R])],
) -> [[[Entry; C]; R]; K] {
    let mut slices = [[[Entry::Zero; C]; R]; K];
    let mut n = 0;
    while n < given.len() {
        let (k, rows) = given[n];
        slices[k] = entries(rows);
        n += 1;
    }
    slices
}

const fn product(a: Entry, b: Entry) -> Entry {
    match (a, b) {
        (Entry::Zero, _) | (_, Entry::Zero) => Entry::Zero,
        (Entry::One, other) | (other, Entry::One) => other,
        (Entry::Other, Entry::Other) => Entry::Other,
    }
}

const fn sum(a: Entry, b: Entry) -> Entry {
    match (a, b) {
        (Entry::Zero, other) | (other, Entry::Zero) => other,
        _ => Entry::Other,
    }
}

/// The frame in which a joint's velocity is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VelocityFrame {
    /// The frame of the child body.
    Child,
    /// The frame of the parent body.
    Parent,
    /// Neither: v is the rate of the coordinates, or X is declared.
    Declared,
}

/// A joint of Definition 1 or 2, with its kernels.
///
/// `N` scalars store the configuration Q, `K` is the number of freedoms (size of v and ϕ), `S` the number of speeds v̄
/// (`S = K` for a holonomic joint), `C = K − S` the number of nonholonomic constraints. Twists and wrenches are
/// 6-vectors, angular part first. SI units, radians. The implementing type holds the joint's parameters.
pub trait Joint<const N: usize, const K: usize, const S: usize, const C: usize>:
    Clone + Debug + Send + Sync + 'static
{
    /// Name of the spec.
    const NAME: &'static str;
    /// Names of the stored scalars of Q, in storage order (matrices row by row).
    const COORDINATES: [&'static str; N];
    /// Names of the freedoms: of ϕ and of v.
    const FREEDOMS: [&'static str; K];
    /// Names of the speeds v̄.
    const SPEEDS: [&'static str; S];
    /// Frame in which v is read.
    const VELOCITY_FRAME: VelocityFrame;
    /// Which kernels are trivial.
    const STRUCTURES: Structures;
    /// Which entries of H, X^c, S̄ and the derivatives of the last two are known.
    const PATTERNS: Patterns<K, S>;
    /// Basis of the spatial inertias in the child frame that the joint cannot feel (N_X):
    /// `[m, mc_x, mc_y, mc_z, Ixx, Iyy, Izz, Ixy, Ixz, Iyz]`, inertia about the frame origin.
    const IMPERCEPTIBLE: &'static [[f64; 10]];

    /// The functions of Q that [`Joint::singularity`] takes the least absolute value of, as the spec writes them: H, X, Φ, A
    /// or S̄ lose their meaning or their rank where one of them is 0. Empty for a joint that is global.
    const SINGULARITIES: &'static [&'static str];

    /// Names and values of the joint's parameters.
    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)>;

    /// The configuration from which `phi` is measured when a scene gives no other.
    fn home<T: Scalar>(&self) -> SVector<T, N>;

    /// H(Q): child coordinates to parent coordinates.
    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T>;

    /// X(Q): v to the twist of the child relative to the parent, in the parent frame, definition 1.
    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K>;

    /// X^c(Q) = Ad_{H⁻¹} X: v to the same twist, in the child frame.
    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K>;

    /// ∂X^c/∂ϕ; slice k is the derivative along ϕ_k.
    fn twist_map_child_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K];

    /// S₀(Q): ϕ̇ to v at ϕ = 0, (23).
    fn velocity_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, K>;

    /// S₀⁻¹(Q): v to ϕ̇ at ϕ = 0.
    fn velocity_map_inverse<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, K>;

    /// ∂S/∂ϕ at ϕ = 0, (23), (32); slice k is ∂S/∂ϕ_k.
    fn velocity_map_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, K, K>; K];

    /// Σ_k γ_k v_k, (17): stands on the left of (24).
    fn gamma<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SMatrix<T, K, K>;

    /// J22(Q, p), (28): stands on the right of (27).
    fn j22<T: Scalar>(&self, q: &SVector<T, N>, p: &SVector<T, K>) -> SMatrix<T, K, K>;

    /// A(Q) with Aᵀ v = 0, definition 2.
    fn constraint<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, C>;

    /// S̄(Q): speeds v̄ to v, definition 2, (15).
    fn speed_basis<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, K, S>;

    /// ∂S̄/∂ϕ; slice k is the derivative along ϕ_k.
    fn speed_basis_gradient<T: Scalar>(&self, q: &SVector<T, N>) -> [SMatrix<T, K, S>; K];

    /// Q̇(Q, v), (31).
    fn configuration_rate<T: Scalar>(&self, q: &SVector<T, N>, v: &SVector<T, K>) -> SVector<T, N>;

    /// Φ(Q, ϕ) at finite ϕ, in closed form.
    fn retract<T: Scalar>(&self, q: &SVector<T, N>, phi: &SVector<T, K>) -> SVector<T, N>;

    /// The ϕ with Φ(Q, ϕ) = `target`: the inverse of [`Joint::retract`], principal branch.
    ///
    /// Where Φ has no inverse in closed form, it is found by [`finite::local`](crate::finite::local): NaN in every entry where
    /// that does not converge.
    fn local<T: Scalar>(&self, q: &SVector<T, N>, target: &SVector<T, N>) -> SVector<T, K>;

    /// D at finite ϕ, K×K: `Φ(Q, ϕ + δ) = Φ(Q′, D δ) + O(δ²)` at Q′ = Φ(Q, ϕ), so that `S(Q, ϕ) = S₀(Q′) D`.
    ///
    /// For Φ = Q exp(ϕ) it is dexp in child axes, `Σ (−ad_ϕ)ⁿ / (n + 1)!`.
    fn retract_differential<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
    ) -> SMatrix<T, K, K>;

    /// ϕ̇ at finite ϕ from `rate`, the value S₀(Q′)⁻¹ v at the moved configuration Q′ = Φ(Q, ϕ).
    ///
    /// With the D of [`Joint::retract_differential`] this is `D⁻¹ rate`. For Φ = Q exp(ϕ) it is `rate + ½ [ϕ, rate] + …`, the
    /// inverse of dexp; its coefficients hold for |ϕ| < 2π.
    fn retract_differential_inverse<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        phi: &SVector<T, K>,
        rate: &SVector<T, K>,
    ) -> SVector<T, K>;

    /// The configuration on the manifold that is nearest to `q`, for `q` off it by rounding or input error.
    ///
    /// Where the manifold is one of declared relations, it is found by [`finite::project`](crate::finite::project): NaN in
    /// every entry where that does not converge.
    fn project<T: Scalar>(&self, q: &SVector<T, N>) -> SVector<T, N>;

    /// Root of the sum of squares of the manifold's relations at `q`; 0 on the manifold.
    fn residual<T: Scalar>(&self, q: &SVector<T, N>) -> T;

    /// Least absolute value of the functions that [`Joint::SINGULARITIES`] names; +∞ where there are none.
    /// Where H, X, Φ, A or S̄ have a value on one side of them alone, 0 on the other.
    fn singularity<T: Scalar>(&self, q: &SVector<T, N>) -> T;

    /// c(Q, v̄) = Ẋ̄^c v̄ with X̄ = X S̄: velocity product term of the recursive forms, a twist rate in the child frame.
    fn bias_acceleration<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SVector<T, 6>;

    /// Ẋ̄^cᵀ h for a momentum `h` (moment; linear) in the child frame: its dual.
    fn bias_momentum<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
        h: &SVector<T, 6>,
    ) -> SVector<T, S>;
}
