//! The contract between a generated joint and the runtime: the static trait [`Joint`].
//!
//! `hamel-codegen` emits one implementation for each `.joint` file. The runtime never lists joint types: it knows this
//! trait alone. All methods are pure in their arguments and allocate nothing. Everything that belongs to the local
//! coordinates ϕ is evaluated at ϕ = 0 unless the method takes `phi`. Equation numbers are those of Duindam and
//! Stramigioli, *Singularity-free dynamic equations of open-chain mechanisms with general holonomic and nonholonomic joints*.
//!
//! A kernel that is zero or the identity need not be written: its default returns that, and does not compile for a joint whose
//! [`Joint::STRUCTURES`] do not say so. c = Ẋ̄^c v̄ and its dual follow from the other kernels by products.
//!
//! Of a slider all kernels are trivial but those that must be written, and its S₀ is the identity:
//!
//! ```
#![doc = include_str!("joint/slider.rs.in")]
//! slider!(Structures::TRIVIAL);
//! fn main() {
//!     assert_eq!(Slider.velocity_map(&SVector::<f64, 1>::zeros())[0], 1.0);
//! }
//! ```
//!
//! A slider whose S₀ is said to be anything else, and that does not write it, is refused:
//!
//! ```compile_fail
#![doc = include_str!("joint/slider.rs.in")]
//! slider!(Structures { velocity_map: Structure::Constant, ..Structures::TRIVIAL });
//! fn main() {
//!     assert_eq!(Slider.velocity_map(&SVector::<f64, 1>::zeros())[0], 1.0);
//! }
//! ```

#[cfg(feature = "alloc")]
mod coupled;
mod facts;
mod patterns;
mod pin;
mod port;
mod products;
mod several;
mod slices;
mod structure;
mod units;

/// Most degrees of freedom of a joint.
pub const MOST_FREEDOMS: usize = 16;

#[cfg(feature = "alloc")]
pub use coupled::{
    Coupled, Link, LinkFault, LinkMotion, MOST_COORDINATES, MOST_INDEPENDENT, MOST_LINKS,
    MOST_RELATIONS, Relation, Row, Tie, closed, coupled, linkage_length, most_relations,
};
pub use facts::Facts;
pub use patterns::{Entry, Patterns};
pub use pin::{DriveSource, Pin, PinDrive, Turning};
pub use port::{Port, PortLaw};
pub use products::{FirstOrder, Products};
pub use several::{Carries, Member};
pub use structure::{Structure, Structures};
pub use units::{Unit, Units};

use crate::erased::Shared;
use crate::matrix::{by_entry, identity, zeros};
use crate::scalar::Scalar;
use crate::spatial::Pose;
use core::fmt::Debug;
use nalgebra::{SMatrix, SVector};

/// Version of the [`Joint`] trait. Generated code asserts it at compile time.
pub const KERNEL_INTERFACE: u32 = 7;

/// Fails to compile where generated code and runtime differ in the [`Joint`] trait.
///
/// Generated files contain `const _: () = hamel_runtime::joint::assert_kernel_interface(7);`.
pub const fn assert_kernel_interface(version: u32) {
    assert!(
        version == KERNEL_INTERFACE,
        "this joint was generated for another version of the runtime's kernel interface: generate it again"
    );
}

/// The matrix with the given rows, as emitted kernels write it.
#[inline(always)]
pub fn from_rows<T: Scalar, const R: usize, const C: usize>(rows: [[T; C]; R]) -> SMatrix<T, R, C> {
    by_entry(|i, j| rows[i][j])
}

/// The matrix with the given rows at their numbers, and zeros elsewhere, as emitted kernels write it.
#[inline(always)]
pub fn rows_at<T: Scalar, const R: usize, const C: usize, const W: usize>(
    rows: [(usize, [T; C]); W],
) -> SMatrix<T, R, C> {
    let mut matrix = zeros::<T, R, C>();
    for (i, row) in &rows {
        for (j, entry) in row.iter().enumerate() {
            matrix.data.0[j][*i] = *entry;
        }
    }
    matrix
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
/// `N` scalars store the configuration Q, `K` is the number of degrees of freedom (size of v and ϕ), `S` the number of speeds v̄
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
    /// Basis of the spatial inertias in the child frame that do not affect the joint (N_X):
    /// `[m, mc_x, mc_y, mc_z, Ixx, Iyy, Izz, Ixy, Ixz, Iyz]`, inertia about the frame origin.
    const UNIDENTIFIABLE: &'static [[f64; 10]];

    /// The functions of Q that [`Joint::singularity`] takes the least absolute value of, as the spec writes them: H, X, Φ, A
    /// or S̄ lose their meaning or their rank where one of them is 0. Empty for a joint that is global.
    const SINGULARITIES: &'static [&'static str];

    /// The declared relations, as equations, of a joint whose motion relations alone give. Each has a multiplier.
    const RELATIONS: &'static [&'static str] = &[];

    /// The unit of each relation, as `m`, `m^2`, or `1` for a number or an angle; empty where nothing tells it. That of its multiplier is J over it.
    const RELATION_UNITS: &'static [&'static str] = &[];

    /// What everything is measured in, as far as the spec determines it.
    const UNITS: Units = Units::UNKNOWN;

    /// The ports: angles and lengths of Q, besides v, at which efforts act and rates are read.
    const PORTS: &'static [Port] = &[];

    /// Whether the joint can have ports: what is asked of ports is compiled for such joints alone. A joint that overrides [`Joint::ports`] says `true`.
    const HAS_PORTS: bool = !Self::PORTS.is_empty();

    /// The pins: where the bodies hold each other.
    const PINS: &'static [Pin] = &[];

    /// Names of the bodies that the joint carries; empty where it carries one that has no name.
    const BODIES: &'static [&'static str] = &[];

    /// Which of them this is the joint of: 0 except for a [`Member`].
    const BODY: usize = 0;

    /// The constants of the trait as a value. A joint that is built at run time overrides it.
    fn facts(&self) -> Facts {
        Facts::of::<Self, N, K, S, C>()
    }

    /// Whether the velocity of a degree of freedom moves the body at some configuration, by [`Joint::PATTERNS`], but of a joint that knows it when it is made.
    fn moves_body(&self, freedom: usize) -> bool {
        let rows = &Self::PATTERNS.twist_map_child;
        freedom < K && rows.iter().any(|row| !matches!(row[freedom], Entry::Zero))
    }

    /// What everything is measured in: [`Joint::UNITS`], but of a joint that knows it when it is made.
    fn units(&self) -> Units {
        Self::UNITS
    }

    /// The ports: [`Joint::PORTS`], but of a joint that knows them when it is made. Such a joint says so by [`Joint::HAS_PORTS`].
    fn ports(&self) -> &'static [Port] {
        Self::PORTS
    }

    /// Names of the bodies: [`Joint::BODIES`], but of a joint that knows them when it is made.
    fn bodies(&self) -> &'static [&'static str] {
        Self::BODIES
    }

    /// The number of unused scalars at the end of Q, where the type is larger than the joint. They are always 0, are not part of the joint's
    /// [layout](crate::erased::AnyJoint::layout), and as many of the last [`Joint::RELATIONS`] hold them there.
    fn idle(&self) -> usize {
        0
    }

    /// Which of the bodies this is the joint of: [`Joint::BODY`], but of a joint that knows it when it is made.
    fn body(&self) -> usize {
        Self::BODY
    }

    /// Hands the joint as each further body sees it, a [`Member`], to `visit`, in the order of [`Joint::bodies`].
    fn more(&self, _visit: &mut dyn FnMut(Shared)) {
        const {
            assert!(
                Self::BODIES.len() <= 1,
                "the joint carries several bodies: it must implement more"
            )
        };
    }

    /// Names and values of the joint's parameters.
    fn parameters(&self) -> impl Iterator<Item = (&'static str, f64)> {
        const {
            assert!(
                size_of::<Self>() == 0,
                "the joint holds values: it must implement parameters"
            )
        };
        core::iter::empty()
    }

    /// The configuration from which `phi` is measured when a scene gives no other.
    fn home<T: Scalar>(&self) -> SVector<T, N>;

    /// H(Q): child coordinates to parent coordinates.
    fn pose<T: Scalar>(&self, q: &SVector<T, N>) -> Pose<T>;

    /// X(Q): v to the twist of the child relative to the parent, in the parent frame, definition 1.
    fn twist_map<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K>;

    /// X^c(Q) = Ad_{H⁻¹} X: v to the same twist, in the child frame.
    fn twist_map_child<T: Scalar>(&self, q: &SVector<T, N>) -> SMatrix<T, 6, K>;

    /// ∂X^c/∂ϕ; slice k is the derivative along ϕ_k.
    fn twist_map_child_gradient<T: Scalar>(&self, _q: &SVector<T, N>) -> [SMatrix<T, 6, K>; K] {
        const {
            assert!(
                Self::STRUCTURES.twist_map_child_gradient.is_zero(),
                "twist_map_child_gradient is not zero: the joint must implement it"
            )
        };
        [zeros(); K]
    }

    /// S₀(Q): ϕ̇ to v at ϕ = 0, (23).
    fn velocity_map<T: Scalar>(&self, _q: &SVector<T, N>) -> SMatrix<T, K, K> {
        const {
            assert!(
                Self::STRUCTURES.velocity_map.is_identity(),
                "velocity_map is not the identity: the joint must implement it"
            )
        };
        identity()
    }

    /// S₀⁻¹(Q): v to ϕ̇ at ϕ = 0.
    fn velocity_map_inverse<T: Scalar>(&self, _q: &SVector<T, N>) -> SMatrix<T, K, K> {
        const {
            assert!(
                Self::STRUCTURES.velocity_map.is_identity(),
                "velocity_map_inverse is not the identity: the joint must implement it"
            )
        };
        identity()
    }

    /// ∂S/∂ϕ at ϕ = 0, (23), (32); slice k is ∂S/∂ϕ_k.
    fn velocity_map_gradient<T: Scalar>(&self, _q: &SVector<T, N>) -> [SMatrix<T, K, K>; K] {
        const {
            assert!(
                Self::STRUCTURES.velocity_map_gradient.is_zero(),
                "velocity_map_gradient is not zero: the joint must implement it"
            )
        };
        [zeros(); K]
    }

    /// Σ_k γ_k v_k, (17): stands on the left of (24).
    fn gamma<T: Scalar>(&self, _q: &SVector<T, N>, _v: &SVector<T, K>) -> SMatrix<T, K, K> {
        const {
            assert!(
                Self::STRUCTURES.gamma.is_zero(),
                "gamma is not zero: the joint must implement it"
            )
        };
        zeros()
    }

    /// J22(Q, p), (28): stands on the right of (27).
    fn j22<T: Scalar>(&self, _q: &SVector<T, N>, _p: &SVector<T, K>) -> SMatrix<T, K, K> {
        const {
            assert!(
                Self::STRUCTURES.gamma.is_zero(),
                "j22 is not zero: the joint must implement it"
            )
        };
        zeros()
    }

    /// A(Q) with Aᵀ v = 0, definition 2.
    fn constraint<T: Scalar>(&self, _q: &SVector<T, N>) -> SMatrix<T, K, C> {
        const {
            assert!(
                C == 0,
                "constraint has columns: the joint must implement it"
            )
        };
        zeros()
    }

    /// S̄(Q): speeds v̄ to v, definition 2, (15).
    fn speed_basis<T: Scalar>(&self, _q: &SVector<T, N>) -> SMatrix<T, K, S> {
        const {
            assert!(
                K == S && Self::STRUCTURES.speed_basis.is_identity(),
                "speed_basis is not the identity: the joint must implement it"
            )
        };
        identity()
    }

    /// ∂S̄/∂ϕ; slice k is the derivative along ϕ_k.
    fn speed_basis_gradient<T: Scalar>(&self, _q: &SVector<T, N>) -> [SMatrix<T, K, S>; K] {
        const {
            assert!(
                Self::STRUCTURES.speed_basis_gradient.is_zero(),
                "speed_basis_gradient is not zero: the joint must implement it"
            )
        };
        [zeros(); K]
    }

    /// P(Q), a row for each of [`Joint::PORTS`]: v to its rate, rad/s or m/s. Efforts τ_p at the ports, N·m or N, are `τ = Pᵀ τ_p` in v.
    fn port_map<T: Scalar>(&self, _q: &SVector<T, N>) -> impl AsRef<[[T; K]]> {
        const {
            assert!(
                !Self::HAS_PORTS,
                "the joint has ports: it must implement port_map"
            )
        };
        let none: [[T; K]; 0] = [];
        none
    }

    /// The values of the ports, rad or m; that of a [port that wraps](Port::wraps) is between −π and π.
    fn port_values<T: Scalar>(&self, _q: &SVector<T, N>) -> impl AsRef<[T]> {
        const {
            assert!(
                !Self::HAS_PORTS,
                "the joint has ports: it must implement port_values"
            )
        };
        let none: [T; 0] = [];
        none
    }

    /// For each of [`Joint::PINS`] its point, m, the axis about which the first body turns and that along which it slides, in the parent frame; 0 for an axis that
    /// it does not have.
    fn pins<T: Scalar>(&self, _q: &SVector<T, N>) -> impl AsRef<[[T; 9]]> {
        const {
            assert!(
                Self::PINS.is_empty(),
                "the joint has pins: it must implement pins"
            )
        };
        let none: [[T; 9]; 0] = [];
        none
    }

    /// For each of [`Joint::RELATIONS`] the twist of the body, in the child frame, at the displacement rate of Q at which that relation would change at
    /// unit rate, and no other: along the directions in which Φ comes back onto the manifold, with H as the spec writes it.
    fn relation_twists<T: Scalar>(&self, _q: &SVector<T, N>) -> impl AsRef<[[T; 6]]> {
        const {
            assert!(
                Self::RELATIONS.is_empty(),
                "the joint has relations: it must implement relation_twists"
            )
        };
        let none: [[T; 6]; 0] = [];
        none
    }

    /// The rates of the ports at the same displacement rates: of all ports for the first relation, then for the next.
    fn relation_ports<T: Scalar>(&self, _q: &SVector<T, N>) -> impl AsRef<[T]> {
        const {
            assert!(
                Self::RELATIONS.is_empty() || !Self::HAS_PORTS,
                "the joint has relations and ports: it must implement relation_ports"
            )
        };
        let none: [T; 0] = [];
        none
    }

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
        _q: &SVector<T, N>,
        _phi: &SVector<T, K>,
    ) -> SMatrix<T, K, K> {
        const {
            assert!(
                Self::STRUCTURES.retract_differential.is_identity(),
                "retract_differential is not the identity: the joint must implement it"
            )
        };
        identity()
    }

    /// ϕ̇ at finite ϕ from `rate`, the value S₀(Q′)⁻¹ v at the moved configuration Q′ = Φ(Q, ϕ).
    ///
    /// With the D of [`Joint::retract_differential`] this is `D⁻¹ rate`. For Φ = Q exp(ϕ) it is `rate + ½ [ϕ, rate] + …`, the
    /// inverse of dexp; its coefficients hold for |ϕ| < 2π.
    fn retract_differential_inverse<T: Scalar>(
        &self,
        _q: &SVector<T, N>,
        _phi: &SVector<T, K>,
        rate: &SVector<T, K>,
    ) -> SVector<T, K> {
        const {
            assert!(
                Self::STRUCTURES.retract_differential.is_identity(),
                "retract_differential_inverse is not the identity: the joint must implement it"
            )
        };
        *rate
    }

    /// The configuration on the manifold that is nearest to `q`, for `q` off it by rounding or input error.
    ///
    /// Where the manifold is one of declared relations, it is found by [`finite::project`](crate::finite::project), or, where these
    /// alone give Φ, by [`finite::project_by_displacements`](crate::finite::project_by_displacements): NaN in every entry where that
    /// does not converge.
    fn project<T: Scalar>(&self, q: &SVector<T, N>) -> SVector<T, N> {
        const {
            assert!(
                Self::STRUCTURES.project.is_identity(),
                "project is not the identity: the joint must implement it"
            )
        };
        *q
    }

    /// Root of the sum of squares of the manifold's relations at `q`; 0 on the manifold.
    fn residual<T: Scalar>(&self, _q: &SVector<T, N>) -> T {
        const {
            assert!(
                Self::STRUCTURES.residual.is_zero(),
                "residual is not zero: the joint must implement it"
            )
        };
        T::zero()
    }

    /// Least absolute value of the functions that [`Joint::SINGULARITIES`] names; +∞ where there are none.
    /// Where H, X, Φ, A or S̄ have a value on one side of them alone, 0 on the other.
    fn singularity<T: Scalar>(&self, _q: &SVector<T, N>) -> T {
        const {
            assert!(
                Self::SINGULARITIES.is_empty(),
                "the joint has singularities: it must implement singularity"
            )
        };
        crate::finite::least_absolute([])
    }

    /// c(Q, v̄) = Ẋ̄^c v̄ with X̄ = X S̄: velocity product term of the recursive forms, a twist rate in the child frame.
    ///
    /// By default [by products](Products::bias_acceleration_by_products) of the other kernels; a joint has a formula of its own
    /// where that is much shorter, so that whole scenes are faster by it (`cargo bench --package hamel-tests --bench dedicated`).
    fn bias_acceleration<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
    ) -> SVector<T, 6> {
        self.bias_acceleration_by_products(q, speeds)
    }

    /// Ẋ̄^cᵀ h for a momentum `h` (moment; linear) in the child frame: its dual.
    ///
    /// By default [by products](Products::bias_momentum_by_products), as c.
    fn bias_momentum<T: Scalar>(
        &self,
        q: &SVector<T, N>,
        speeds: &SVector<T, S>,
        h: &SVector<T, 6>,
    ) -> SVector<T, S> {
        self.bias_momentum_by_products(q, speeds, h)
    }
}
