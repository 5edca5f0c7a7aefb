//! One joint's share in the O(n) recursions: each step written once, generic in the joint, and erased at that grain.
//!
//! **Frames.** Every spatial vector of body i is read at the origin of its joint's child frame, in **world axes**. Going from one
//! body to the next is then a shift by [`Placement::offset`] without a rotation.
//!
//! **Freedoms one by one.** A joint with S speeds is eliminated as S joints of one speed in a row, the first column nearest to the child:
//! with columns `X_j` of X̄, `Y_j = I X_j`, `d_j = X_jᵀ Y_j`, then `I ← I − Y_j Y_jᵀ / d_j`. This is the LDLᵀ factorisation of `X̄ᵀ I X̄`, and
//! neither L nor an inverse is ever formed.

mod articulate;
mod extended;
mod place;
mod vary;

pub use articulate::{Pivot, PivotFailure};
pub use extended::ExtendedSteps;
pub use place::Placement;
pub use vary::Variation;

use crate::erased::Sizes;
use crate::joint::Joint;
use crate::spatial::{ArticulatedInertia, Pose, SpatialInertia};
use nalgebra::{Matrix3, SVector, Vector6};

/// The motion of a joint's child frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T> {
    /// Where it is.
    pub placement: Placement<T>,
    /// V.
    pub twist: Vector6<T>,
    /// V̇.
    pub rate: Vector6<T>,
}

/// The steps of the recursions for one joint; slices have the joint's own sizes (N for `q`, S for the others).
pub trait Steps {
    /// Whether any column of X̄ has an angular part, and whether any has a linear one.
    fn parts(&self) -> (bool, bool);

    /// [`Steps::parts`] of the column of one speed.
    fn column_parts(&self, speed: usize) -> (bool, bool);

    /// The joint's child frame, given its joint frame in the parent's child frame and that of the parent in the world.
    fn place(
        &self,
        q: &[f64],
        joint_frame: &Pose<f64>,
        parent: &Placement<f64>,
        own: &mut Placement<f64>,
    );

    /// [`Steps::place`], and the columns of X̄ at the child frame's origin, in world axes.
    fn stand(
        &self,
        q: &[f64],
        joint_frame: &Pose<f64>,
        parent: &Placement<f64>,
        own: &mut Placement<f64>,
        columns: &mut [Vector6<f64>],
    );

    /// The columns of X̄ in child axes.
    fn speed_map(&self, q: &[f64], columns: &mut [Vector6<f64>]);

    /// [`Steps::stand`] at the `state` (q, v̄, v̄̇); `V = V_λ + X̄ v̄` and
    /// `V̇ = V̇_λ + X̄ v̄̇ + c + ad_V X̄ v̄`. An empty v̄̇ is zero.
    fn advance(
        &self,
        state: (&[f64], &[f64], &[f64]),
        joint_frame: &Pose<f64>,
        parent: &Motion<f64>,
        own: &mut Motion<f64>,
        columns: &mut [Vector6<f64>],
    );

    /// Takes the joint's freedoms out of `inertia`, which becomes what its parent feels; `armature` is added to the pivots.
    ///
    /// # Errors
    /// The first pivot that does not stand above its rounding.
    fn articulate(
        &self,
        inertia: &mut ArticulatedInertia<f64>,
        columns: &[Vector6<f64>],
        armature: &[f64],
        pivots: &mut [Pivot<f64>],
    ) -> Result<(), PivotFailure>;

    /// Takes the joint's freedoms out of `wrench`, which becomes what its parent feels, for generalised `forces` (momenta or
    /// efforts) of the joint; `loads` are kept for [`Steps::resolve`].
    fn reduce(
        &self,
        wrench: &mut Vector6<f64>,
        columns: &[Vector6<f64>],
        pivots: &[Pivot<f64>],
        forces: &[f64],
        loads: &mut [f64],
    );

    /// [`Steps::articulate`] and [`Steps::reduce`] in one.
    ///
    /// # Errors
    /// The first pivot that does not stand above its rounding.
    fn eliminate(
        &self,
        carried: (&mut ArticulatedInertia<f64>, &mut Vector6<f64>),
        columns: &[Vector6<f64>],
        armature_and_forces: (&[f64], &[f64]),
        pivots: &mut [Pivot<f64>],
        loads: &mut [f64],
    ) -> Result<(), PivotFailure>;

    /// The joint's `rates` (speeds or accelerations), added to the `motion` that its parent carries it along with.
    fn resolve(
        &self,
        motion: &mut Vector6<f64>,
        columns: &[Vector6<f64>],
        pivots: &[Pivot<f64>],
        loads: &[f64],
        rates: &mut [f64],
    );

    /// `N X̄` of a rigid inertia into `out`, one momentum a speed.
    fn momenta(
        &self,
        inertia: &SpatialInertia<f64>,
        columns: &[Vector6<f64>],
        out: &mut [Vector6<f64>],
    );

    /// `X̄ᵀ F` into `out`.
    fn gather(&self, wrench: &Vector6<f64>, columns: &[Vector6<f64>], out: &mut [f64]);

    /// `S̄ᵀ τ` into `out`, for efforts τ with one entry a freedom.
    fn reduce_efforts(&self, q: &[f64], efforts: &[f64], out: &mut [f64]);

    /// What one unit of each ϕ and speed changes at the `state` (q, v̄, v̄̇), one entry a freedom; `motions` are those of the child frames of
    /// this joint and of its parent, `columns` those of X̄. An empty v̄̇ is zero.
    fn vary(
        &self,
        state: (&[f64], &[f64], &[f64]),
        motions: (&Motion<f64>, &Motion<f64>),
        columns: &[Vector6<f64>],
        out: &mut [Variation<f64>],
    );
}

/// A slice as an array of the size that the joint's type has: the recursions cut their own vectors by the layout of that joint, and the
/// sizes of what callers hand over are checked before.
fn sized<E, const S: usize>(slice: &[E]) -> &[E; S] {
    slice.try_into().expect("one entry a speed of the joint")
}

fn sized_mut<E, const S: usize>(slice: &mut [E]) -> &mut [E; S] {
    slice.try_into().expect("one entry a speed of the joint")
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> Steps
    for (J, Sizes<N, K, S, C>)
where
    J: Joint<N, K, S, C>,
{
    fn parts(&self) -> (bool, bool) {
        place::Parts::any::<J, N, K, S, C>()
    }

    fn column_parts(&self, speed: usize) -> (bool, bool) {
        place::Parts::of::<J, N, K, S, C>(speed)
    }

    fn place(
        &self,
        q: &[f64],
        joint_frame: &Pose<f64>,
        parent: &Placement<f64>,
        own: &mut Placement<f64>,
    ) {
        let q = SVector::from(*sized::<_, N>(q));
        *own = place::child(&self.0, &q, joint_frame, parent);
    }

    fn stand(
        &self,
        q: &[f64],
        joint_frame: &Pose<f64>,
        parent: &Placement<f64>,
        own: &mut Placement<f64>,
        columns: &mut [Vector6<f64>],
    ) {
        let q = SVector::from(*sized::<_, N>(q));
        *own = place::child(&self.0, &q, joint_frame, parent);
        *sized_mut(columns) = place::columns(&self.0, &q, &own.rotation);
    }

    fn speed_map(&self, q: &[f64], columns: &mut [Vector6<f64>]) {
        let q = SVector::from(*sized::<_, N>(q));
        *sized_mut(columns) = place::columns(&self.0, &q, &Matrix3::identity());
    }

    fn advance(
        &self,
        (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
        joint_frame: &Pose<f64>,
        parent: &Motion<f64>,
        own: &mut Motion<f64>,
        columns: &mut [Vector6<f64>],
    ) {
        let q = SVector::from(*sized::<_, N>(q));
        let speeds = SVector::from(*sized::<_, S>(speeds));
        let columns: &mut [Vector6<f64>; S] = sized_mut(columns);
        *own = place::advance(&self.0, (&q, &speeds), joint_frame, parent, columns);
        if !accelerations.is_empty() {
            let accelerations = SVector::from(*sized::<_, S>(accelerations));
            own.rate = place::add_columns::<f64, J, N, K, S, C>(&own.rate, columns, &accelerations);
        }
    }

    fn articulate(
        &self,
        inertia: &mut ArticulatedInertia<f64>,
        columns: &[Vector6<f64>],
        armature: &[f64],
        pivots: &mut [Pivot<f64>],
    ) -> Result<(), PivotFailure> {
        articulate::inertia::<J, N, K, S, C>(inertia, sized(columns), armature, sized_mut(pivots))
    }

    fn reduce(
        &self,
        wrench: &mut Vector6<f64>,
        columns: &[Vector6<f64>],
        pivots: &[Pivot<f64>],
        forces: &[f64],
        loads: &mut [f64],
    ) {
        *wrench = articulate::wrench::<J, f64, N, K, S, C>(
            wrench,
            sized(columns),
            sized(pivots),
            sized(forces),
            sized_mut(loads),
        );
    }

    fn eliminate(
        &self,
        (inertia, wrench): (&mut ArticulatedInertia<f64>, &mut Vector6<f64>),
        columns: &[Vector6<f64>],
        (armature, forces): (&[f64], &[f64]),
        pivots: &mut [Pivot<f64>],
        loads: &mut [f64],
    ) -> Result<(), PivotFailure> {
        self.articulate(inertia, columns, armature, pivots)?;
        self.reduce(wrench, columns, pivots, forces, loads);
        Ok(())
    }

    fn resolve(
        &self,
        motion: &mut Vector6<f64>,
        columns: &[Vector6<f64>],
        pivots: &[Pivot<f64>],
        loads: &[f64],
        rates: &mut [f64],
    ) {
        *motion = articulate::motion::<J, f64, N, K, S, C>(
            motion,
            sized(columns),
            sized(pivots),
            sized(loads),
            sized_mut(rates),
        );
    }

    fn momenta(
        &self,
        inertia: &SpatialInertia<f64>,
        columns: &[Vector6<f64>],
        out: &mut [Vector6<f64>],
    ) {
        let (columns, out) = (sized::<_, S>(columns), sized_mut::<_, S>(out));
        for j in 0..S {
            out[j] = articulate::momentum::<J, f64, N, K, S, C>(inertia, j, &columns[j]);
        }
    }

    fn gather(&self, wrench: &Vector6<f64>, columns: &[Vector6<f64>], out: &mut [f64]) {
        let (columns, out) = (sized::<_, S>(columns), sized_mut::<_, S>(out));
        for j in 0..S {
            out[j] = articulate::power::<J, f64, N, K, S, C>(j, &columns[j], wrench);
        }
    }

    fn reduce_efforts(&self, q: &[f64], efforts: &[f64], out: &mut [f64]) {
        if J::STRUCTURES.speed_basis.is_identity() {
            out.copy_from_slice(efforts);
            return;
        }
        let basis = self.0.speed_basis(&SVector::from(*sized::<_, N>(q)));
        let reduced = basis.tr_mul(&SVector::from(*sized::<_, K>(efforts)));
        out.copy_from_slice(reduced.as_slice());
    }

    fn vary(
        &self,
        (q, speeds, accelerations): (&[f64], &[f64], &[f64]),
        motions: (&Motion<f64>, &Motion<f64>),
        columns: &[Vector6<f64>],
        out: &mut [Variation<f64>],
    ) {
        let q = SVector::from(*sized::<_, N>(q));
        let speeds = SVector::from(*sized::<_, S>(speeds));
        let accelerations = match accelerations.is_empty() {
            true => SVector::zeros(),
            false => SVector::from(*sized::<_, S>(accelerations)),
        };
        let state = (&q, &speeds, &accelerations);
        let (columns, out) = (sized::<_, S>(columns), sized_mut::<_, K>(out));
        vary::variations::<J, N, K, S, C>(&self.0, state, motions, columns, out);
    }
}
