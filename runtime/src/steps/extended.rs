//! The steps of inverse dynamics in numbers of 106 bits: what is left of equations that doubles have solved.

use super::{Motion, articulate, place, sized, sized_mut};
use crate::erased::Sizes;
use crate::joint::Joint;
use crate::scalar::Extended;
use crate::spatial::Pose;
use nalgebra::{SVector, Vector6};

type E = Extended;

/// [`Steps`](super::Steps) of one joint in extended numbers; slices have the joint's own sizes.
pub trait ExtendedSteps {
    /// The configuration on the manifold that is nearest to `q`, to 106 bits: a rotation whose entries are doubles is one to 53 alone.
    fn exact_configuration(&self, q: &[f64], out: &mut [E]);

    /// [`Steps::advance`](super::Steps::advance), at an exact configuration.
    fn advance_extended(
        &self,
        state: (&[E], &[E], &[E]),
        joint_frame: &Pose<E>,
        parent: &Motion<E>,
        own: &mut Motion<E>,
        columns: &mut [Vector6<E>],
    );

    /// `X̄ᵀ F` into `out`.
    fn gather_extended(&self, wrench: &Vector6<E>, columns: &[Vector6<E>], out: &mut [E]);
}

impl<J, const N: usize, const K: usize, const S: usize, const C: usize> ExtendedSteps
    for (J, Sizes<N, K, S, C>)
where
    J: Joint<N, K, S, C>,
{
    fn exact_configuration(&self, q: &[f64], out: &mut [E]) {
        let q = SVector::from(*sized::<_, N>(q)).map(E::from);
        let exact = self.0.project(&q);
        out.copy_from_slice(exact.as_slice());
    }

    fn advance_extended(
        &self,
        (q, speeds, accelerations): (&[E], &[E], &[E]),
        joint_frame: &Pose<E>,
        parent: &Motion<E>,
        own: &mut Motion<E>,
        columns: &mut [Vector6<E>],
    ) {
        let q = SVector::from(*sized::<_, N>(q));
        let speeds = SVector::from(*sized::<_, S>(speeds));
        let accelerations = SVector::from(*sized::<_, S>(accelerations));
        let columns: &mut [Vector6<E>; S] = sized_mut(columns);
        *own = place::advance(&self.0, (&q, &speeds), joint_frame, parent, columns);
        own.rate = place::add_columns::<E, J, N, K, S, C>(&own.rate, columns, &accelerations);
    }

    fn gather_extended(&self, wrench: &Vector6<E>, columns: &[Vector6<E>], out: &mut [E]) {
        let (columns, out) = (sized::<_, S>(columns), sized_mut::<_, S>(out));
        for j in 0..S {
            out[j] = articulate::power::<J, E, N, K, S, C>(j, &columns[j], wrench);
        }
    }
}
