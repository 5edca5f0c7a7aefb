//! Springs and dampers at ball joints.

use super::number::{Matrix, Real, Vector, real};
use super::system::Motion;

/// A rotational spring with energy `k (3 − tr R)/2` and a damper, R the rotation of `body` relative to `base`.
#[derive(Clone, Debug)]
pub struct Load {
    pub base: Option<usize>,
    pub body: usize,
    pub stiffness: Real,
    pub damping: Real,
}

impl Load {
    /// R.
    fn relative(&self, motions: &[Motion]) -> Matrix {
        let own = motions[self.body].rotation;
        self.base
            .map_or(own, |base| motions[base].rotation.transpose() * own)
    }

    /// Adds the moments on both bodies, each in its own axes: `−k vee((R − Rᵀ)/2) − c ω` on the body.
    pub fn act(&self, motions: &[Motion], moments: &mut [Vector]) {
        let r = self.relative(motions);
        let axis = Vector::new(
            r[(2, 1)] - r[(1, 2)],
            r[(0, 2)] - r[(2, 0)],
            r[(1, 0)] - r[(0, 1)],
        );
        let moving = &motions[self.body];
        let carried = self
            .base
            .map_or(Vector::zeros(), |base| r.transpose() * motions[base].rate);
        let moment = -axis * (self.stiffness * real(0.5)) - (moving.rate - carried) * self.damping;
        moments[self.body] += moment;
        if let Some(base) = self.base {
            moments[base] -= r * moment;
        }
    }

    /// The energy of the spring, J.
    pub fn energy(&self, motions: &[Motion]) -> Real {
        let r = self.relative(motions);
        self.stiffness * real(0.5) * (real(3.0) - r[(0, 0)] - r[(1, 1)] - r[(2, 2)])
    }
}
