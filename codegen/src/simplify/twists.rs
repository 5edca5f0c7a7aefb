//! X and X^c from H in words, by the definition of the twist: sums that a name stands for are never multiplied out.

use super::kernels::{LONG, base, terms};
use super::words::Words;
use crate::expand::Expansion;
use crate::expr::Expr;
use crate::kernel::{Kernel, KernelKind};
use crate::matrix::Matrix;
use crate::prepare::Prepared;

/// The velocity of Φ in words, in both frames, where it is X.
pub struct Twists {
    parent: Option<Matrix>,
    child: Option<Matrix>,
}

impl Twists {
    /// The kernel in words, where it is one of these.
    pub fn of(&self, kind: KernelKind) -> Option<&Matrix> {
        match kind {
            KernelKind::TwistMap => self.parent.as_ref(),
            KernelKind::TwistMapChild => self.child.as_ref(),
            _ => None,
        }
    }
}

/// `vee(∂R Rᵀ)` and `∂p − ω × p`, and in the child frame `vee(Rᵀ ∂R)` and `Rᵀ ∂p`.
pub fn of_pose(joint: &Prepared, expansion: &Expansion, words: &mut Words<'_>) -> Twists {
    let pose = joint
        .spec
        .worded
        .poses
        .first()
        .unwrap_or(&joint.spec.pose.value);
    let rotation = words.shorten_each(&pose.rotation);
    let position = words.shorten_each(&pose.translation);
    words.name_derivatives(&rotation.beside(&position));
    let to_child = rotation.transpose();
    let (mut parent, mut child) = (vec![], vec![]);
    for k in 0..expansion.shape.freedoms {
        let turned = words.along_each(&rotation, k);
        let moved = words.along_each(&position, k);
        let omega = vee(&turned.times(&to_child)).map(|entry| words.shorten(entry));
        let linear = moved.minus(&Matrix::tilde(omega.entries()).times(&position));
        parent.push(join(&omega, &words.shorten_each(&linear)));
        let omega = vee(&to_child.times(&turned)).map(|entry| words.shorten(entry));
        child.push(join(&omega, &words.shorten_each(&to_child.times(&moved))));
    }
    let is_velocity = expansion.twist_map == expansion.jacobian.base;
    let columns = |columns: Vec<Vec<Expr>>| is_velocity.then(|| Matrix::from_columns(6, &columns));
    Twists {
        parent: columns(parent),
        child: columns(child),
    }
}

/// The kernel in words, or as it was derived, entry by entry, where that is shorter.
pub fn shorter(words: &Words<'_>, kernel: Kernel, map: &Matrix) -> Kernel {
    let known = kernel.outputs.first().cloned();
    // The gradient is derived from X^c: in words, so that its slices are in words.
    let is_derived_from = kernel.kind == KernelKind::TwistMapChild;
    let derived = match terms(&kernel.outputs) > LONG || is_derived_from {
        true => None,
        false => base(words, kernel.clone()).outputs.into_iter().next(),
    };
    let value = Matrix::from_fn(map.rows(), map.columns(), |i, j| {
        let other = derived.as_ref().map(|derived| derived.at(i, j));
        match known.as_ref().is_some_and(|known| known.at(i, j).is_zero()) {
            true => Expr::zero(),
            false => other
                .filter(|other| length(other) < length(map.at(i, j)))
                .unwrap_or_else(|| map.at(i, j))
                .clone(),
        }
    });
    Kernel {
        outputs: vec![value],
        ..kernel
    }
}

fn length(entry: &Expr) -> usize {
    crate::manifold::weight(entry)
}

fn vee(m: &Matrix) -> Matrix {
    Matrix::column_vector(vec![
        m.at(2, 1).clone(),
        m.at(0, 2).clone(),
        m.at(1, 0).clone(),
    ])
}

fn join(angular: &Matrix, linear: &Matrix) -> Vec<Expr> {
    let both = angular.entries().iter().chain(linear.entries());
    both.cloned().collect()
}
