//! Factors of placements, each applied at its own price.
//!
//! A placement from child to parent is a product of [`Step`]s: a turn about an axis costs a vector 6 operations and a symmetric matrix 16,
//! where a full rotation costs 15 and 75. Turns by quarters and shifts along axes fold by themselves.

use super::{Mat3, Twist, Vec3, Wrench, apply, cross, product, symmetric};
use crate::graph::Sym;
use num_traits::Zero;

/// A factor of a placement, from its child side to its parent side.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The child's origin stands there.
    Shift(Vec3),
    /// Right-handed turn about axis 0, 1 or 2.
    Turn {
        /// The axis.
        axis: usize,
        /// Cosine of the angle.
        cos: Sym,
        /// Sine of the angle.
        sin: Sym,
    },
    /// Any rotation.
    Rotate(Mat3),
}

impl Step {
    /// The turn about `axis` by a known angle's cosine and sine.
    pub fn known_turn(axis: usize, cos: f64, sin: f64) -> Self {
        Self::Turn {
            axis,
            cos: cos.into(),
            sin: sin.into(),
        }
    }

    /// A rotation matrix as the step that it is: a turn where its entries are those of one.
    pub fn rotation(matrix: &Mat3) -> Self {
        let turn = (0..3).find_map(|axis| {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let zero = |i: usize, j: usize| matrix[(i, j)].is_zero();
            let apart = zero(axis, b) && zero(axis, c) && zero(b, axis) && zero(c, axis);
            let is_turn = matrix[(axis, axis)].number() == Some(1.0)
                && apart
                && matrix[(b, b)] == matrix[(c, c)]
                && matrix[(b, c)] == -matrix[(c, b)];
            is_turn.then(|| Self::Turn {
                axis,
                cos: matrix[(b, b)],
                sin: matrix[(c, b)],
            })
        });
        turn.unwrap_or(Self::Rotate(*matrix))
    }

    /// Whether it changes nothing.
    pub fn is_identity(&self) -> bool {
        match self {
            Self::Shift(by) => by.iter().all(Zero::is_zero),
            // The cosine of a little angle is 1.
            Self::Turn { cos, sin, .. } => cos.number() == Some(1.0) && sin.is_zero(),
            Self::Rotate(matrix) => *matrix == Mat3::identity(),
        }
    }

    /// Whether it is a turn by quarters, or none: such cost nothing.
    fn is_signed_permutation(&self) -> bool {
        match self {
            Self::Turn { cos, sin, .. } => {
                cos.is_unit() && sin.is_zero() || sin.is_unit() && cos.is_zero()
            }
            _ => false,
        }
    }

    /// Whether it is a constant turn: a rotation beside it takes it up, once, where each vector and matrix would be turned by both.
    fn is_known_turn(&self) -> bool {
        match self {
            Self::Turn { cos, sin, .. } => cos.number().is_some() && sin.number().is_some(),
            _ => false,
        }
    }

    fn matrix(&self) -> Mat3 {
        match self {
            Self::Shift(_) => Mat3::identity(),
            Self::Rotate(matrix) => *matrix,
            Self::Turn { axis, cos, sin } => {
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut matrix = Mat3::identity();
                matrix[(b, b)] = *cos;
                matrix[(c, c)] = *cos;
                matrix[(c, b)] = *sin;
                matrix[(b, c)] = -*sin;
                matrix
            }
        }
    }

    /// A vector from child to parent axes.
    pub fn to_parent(&self, a: &Vec3) -> Vec3 {
        match self {
            Self::Shift(_) => *a,
            _ => apply(&self.matrix(), a),
        }
    }

    /// A vector from parent to child axes.
    pub fn to_child(&self, a: &Vec3) -> Vec3 {
        match self {
            Self::Shift(_) => *a,
            _ => apply(&self.matrix().transpose(), a),
        }
    }

    /// A wrench about the child's origin, in its axes, as one at the parent.
    pub fn wrench_to_parent(&self, wrench: &Wrench) -> Wrench {
        match self {
            Self::Shift(by) => Wrench {
                moment: wrench.moment + cross(by, &wrench.force),
                force: wrench.force,
            },
            _ => Wrench {
                moment: self.to_parent(&wrench.moment),
                force: self.to_parent(&wrench.force),
            },
        }
    }

    /// A twist about the child's origin, in its axes, as one about the parent's.
    pub fn twist_to_parent(&self, twist: &Twist) -> Twist {
        match self {
            Self::Shift(by) => Twist {
                linear: twist.linear + cross(by, &twist.angular),
                angular: twist.angular,
            },
            _ => Twist {
                angular: self.to_parent(&twist.angular),
                linear: self.to_parent(&twist.linear),
            },
        }
    }

    /// A twist, read at the parent, as one at the child.
    pub fn twist_to_child(&self, twist: &Twist) -> Twist {
        match self {
            Self::Shift(by) => Twist {
                angular: twist.angular,
                linear: twist.linear + cross(&twist.angular, by),
            },
            _ => Twist {
                angular: self.to_child(&twist.angular),
                linear: self.to_child(&twist.linear),
            },
        }
    }

    /// `R M Rᵀ` of a matrix in child axes. A turn needs w = s (M_bb − M_cc) + c (M_bc + M_cb) alone: the trace and the skew part of
    /// the block stay what they are.
    pub(super) fn turned(&self, m: &Mat3, is_symmetric: bool) -> Mat3 {
        let Self::Turn { axis, cos, sin } = *self else {
            return self.conjugated(m, is_symmetric);
        };
        if self.is_signed_permutation() {
            return self.conjugated(m, is_symmetric);
        }
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let beside = match is_symmetric {
            true => (cos + cos) * m[(b, c)],
            false => cos * (m[(b, c)] + m[(c, b)]),
        };
        let w = sin * (m[(b, b)] - m[(c, c)]) + beside;
        let mut turned = *m;
        let (cw, sw) = (cos * w, sin * w);
        turned[(b, b)] = m[(b, b)] - sw;
        turned[(c, c)] = m[(c, c)] + sw;
        turned[(b, c)] = cw - m[(c, b)];
        turned[(c, b)] = cw - m[(b, c)];
        turned[(axis, b)] = cos * m[(axis, b)] - sin * m[(axis, c)];
        turned[(axis, c)] = sin * m[(axis, b)] + cos * m[(axis, c)];
        turned[(b, axis)] = cos * m[(b, axis)] - sin * m[(c, axis)];
        turned[(c, axis)] = sin * m[(b, axis)] + cos * m[(c, axis)];
        turned
    }

    fn conjugated(&self, m: &Mat3, is_symmetric: bool) -> Mat3 {
        let rotation = self.matrix();
        let half = product(&rotation, m);
        let entry = |i: usize, j: usize| (0..3).map(|k| half[(i, k)] * rotation[(j, k)]).sum();
        match is_symmetric {
            true => symmetric(entry),
            false => Mat3::from_fn(entry),
        }
    }
}

/// The same placement in fewer steps: turns about one axis that follow each other are one, shifts too, and shifts move towards the
/// parent where that is free.
pub fn simplified(steps: impl IntoIterator<Item = Step>) -> Vec<Step> {
    let mut simple: Vec<Step> = vec![];
    for step in steps {
        push(&mut simple, step);
    }
    simple
}

fn push(steps: &mut Vec<Step>, step: Step) {
    if step.is_identity() {
        return;
    }
    match (steps.last_mut(), step) {
        (Some(Step::Shift(before)), Step::Shift(by)) => *before += by,
        (Some(last), Step::Shift(by)) if passes(last, &by) => {
            let by = last.to_parent(&by);
            let last = steps.pop();
            push(steps, Step::Shift(by));
            steps.extend(last);
        }
        (
            Some(Step::Turn { axis, cos, sin }),
            Step::Turn {
                axis: same,
                cos: c,
                sin: s,
            },
        ) if *axis == same => {
            (*cos, *sin) = (*cos * c - *sin * s, *sin * c + *cos * s);
        }
        (Some(turn), Step::Rotate(matrix)) if turn.is_known_turn() => {
            let mut known = turn.matrix();
            steps.pop();
            while let Some(turn) = steps.pop_if(|step| step.is_known_turn()) {
                known = product(&turn.matrix(), &known);
            }
            push(steps, Step::Rotate(product(&known, &matrix)));
        }
        (Some(Step::Rotate(matrix)), turn) if turn.is_known_turn() => {
            *matrix = product(matrix, &turn.matrix());
        }
        (_, step) => steps.push(step),
    }
    if steps.last().is_some_and(Step::is_identity) {
        steps.pop();
    }
}

/// Whether a shift on the child side of `step` is one on the parent side without operations.
fn passes(step: &Step, by: &Vec3) -> bool {
    match step {
        Step::Shift(_) => true,
        Step::Turn { axis, cos, sin } => {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let known = |a: &Sym| a.number().is_some();
            by[b].is_zero() && by[c].is_zero() || known(cos) && known(sin) && by.iter().all(known)
        }
        Step::Rotate(matrix) => {
            let known = |a: &Sym| a.number().is_some();
            matrix.iter().all(known) && by.iter().all(known)
        }
    }
}
