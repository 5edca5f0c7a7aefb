//! Linear responses of the articulated tree, eight at a time: inward along the branches of what pushes, outward over all bodies.

use super::{Branch, WORLD};
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::recursive::link::Node;
use crate::scalar::Scalar;
use crate::spatial::shift_wrench;
use crate::steps::Pivot;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};

/// Responses that go through the tree side by side.
pub(super) const LANES: usize = 8;

/// One number of each response.
type Lane = [f64; LANES];

/// What asks for a response: something at one joint, and what it means for all below.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push {
    /// The body whose joint it is.
    pub(super) body: usize,
    /// The wrench that the parent feels, at the child frame's origin, once the joint has given way.
    pub(super) wrench: Vector6<f64>,
    /// `t_j` of the joint's own speeds.
    pub(super) loads: [f64; MOST_FREEDOMS],
    /// What is added to the rate of everything below, W.
    pub(super) rate: Vector6<f64>,
    /// The angular part of what is added to the twist of everything below, U.
    pub(super) turn: Vector3<f64>,
}

impl Push {
    pub(super) fn none() -> Self {
        Self {
            body: 0,
            wrench: Vector6::zeros(),
            loads: [0.0; MOST_FREEDOMS],
            rate: Vector6::zeros(),
            turn: Vector3::zeros(),
        }
    }
}

/// The tree as the sweeps see it.
#[derive(Clone, Copy)]
pub(super) struct Tree<'a> {
    pub(super) branches: &'a [Branch],
    pub(super) nodes: &'a [Node],
    pub(super) columns: &'a [Vector6<f64>],
    pub(super) pivots: &'a [Pivot<f64>],
    /// `Bᵀ X / d` of each speed.
    pub(super) drags: &'a [Vector3<f64>],
}

/// Workspace of the sweeps.
#[derive(Clone, Debug)]
pub(super) struct Sweep {
    /// One a body: the wrench that a sweep inward carries.
    wrenches: Vec<[Lane; 6]>,
    /// One a body: rate and angular U of what hangs on it.
    motions: Vec<[Lane; 9]>,
    /// One a speed.
    loads: Vec<Lane>,
    /// Whether the sweep inward has met a body.
    met: Vec<bool>,
}

const ZERO: Lane = [0.0; LANES];

/// `sum += weight lane`.
#[inline(always)]
fn add(sum: &mut Lane, lane: &Lane, weight: f64) {
    for l in 0..LANES {
        sum[l] = Scalar::mul_add(lane[l], weight, sum[l]);
    }
}

/// `lane · column` over six places.
#[inline(always)]
fn product(lanes: &[Lane; 6], column: &Vector6<f64>) -> Lane {
    let mut sum = ZERO;
    for i in 0..6 {
        add(&mut sum, &lanes[i], column[i]);
    }
    sum
}

impl Sweep {
    pub(super) fn new(bodies: usize, speeds: usize) -> Self {
        Self {
            wrenches: vec![[ZERO; 6]; bodies],
            motions: vec![[ZERO; 9]; bodies],
            loads: vec![ZERO; speeds],
            met: vec![false; bodies],
        }
    }

    /// The rates that all speeds answer with, into `rows` (one a speed, of `width` entries), columns from `first` on: one a push, of which there
    /// are at most eight.
    pub(super) fn respond(
        &mut self,
        tree: &Tree<'_>,
        pushes: &[Push],
        (rows, width, first): (&mut [f64], usize, usize),
    ) {
        let last = self.inward(tree, pushes);
        self.outward(tree, pushes, last, (rows, width, first));
        self.met[..=last].fill(false);
    }

    fn meet(&mut self, tree: &Tree<'_>, body: usize) {
        if !self.met[body] {
            self.met[body] = true;
            self.wrenches[body] = [ZERO; 6];
            let (start, end) = tree.branches[body].speeds;
            self.loads[start..end].fill(ZERO);
        }
    }

    /// Returns the last body that is pushed.
    fn inward(&mut self, tree: &Tree<'_>, pushes: &[Push]) -> usize {
        let mut last = 0;
        for (lane, push) in pushes.iter().enumerate() {
            let branch = tree.branches[push.body];
            last = last.max(push.body);
            self.meet(tree, push.body);
            let (start, end) = branch.speeds;
            for (load, own) in self.loads[start..end].iter_mut().zip(&push.loads) {
                load[lane] = *own;
            }
            if branch.parent != WORLD {
                self.meet(tree, branch.parent);
                let offset = &tree.nodes[push.body].motion.placement.offset;
                let carried = shift_wrench(&push.wrench, offset);
                for (sum, entry) in self.wrenches[branch.parent].iter_mut().zip(&carried) {
                    sum[lane] += entry;
                }
            }
        }
        for body in (0..=last).rev() {
            if self.met[body] {
                self.give_way(tree, body);
            }
        }
        last
    }

    /// One body of the sweep inward.
    #[inline(always)]
    fn give_way(&mut self, tree: &Tree<'_>, body: usize) {
        let branch = tree.branches[body];
        let mut wrench = self.wrenches[body];
        for speed in branch.speeds.0..branch.speeds.1 {
            let pivot = &tree.pivots[speed];
            let mut load = product(&wrench, &tree.columns[speed]);
            for entry in &mut load {
                *entry *= -pivot.inverse;
            }
            for i in 0..6 {
                add(&mut wrench[i], &load, pivot.momentum[i]);
            }
            add(&mut self.loads[speed], &load, 1.0);
        }
        if branch.parent != WORLD {
            self.meet(tree, branch.parent);
            let [x, y, z] = tree.nodes[body].motion.placement.offset.into();
            let [mut a, mut b, mut c, fx, fy, fz] = wrench;
            add(&mut a, &fz, y);
            add(&mut a, &fy, -z);
            add(&mut b, &fx, z);
            add(&mut b, &fz, -x);
            add(&mut c, &fy, x);
            add(&mut c, &fx, -y);
            let parent = &mut self.wrenches[branch.parent];
            for (sum, own) in parent.iter_mut().zip([a, b, c, fx, fy, fz]) {
                add(sum, &own, 1.0);
            }
        }
    }

    fn outward(
        &mut self,
        tree: &Tree<'_>,
        pushes: &[Push],
        last: usize,
        (rows, width, first): (&mut [f64], usize, usize),
    ) {
        let count = pushes.len();
        for (body, branch) in tree.branches.iter().enumerate() {
            let mut motion = match branch.parent {
                WORLD => [ZERO; 9],
                parent => self.motions[parent],
            };
            let [x, y, z] = tree.nodes[body].motion.placement.offset.into();
            let [wx, wy, wz, ..] = motion;
            add(&mut motion[3], &wy, z);
            add(&mut motion[3], &wz, -y);
            add(&mut motion[4], &wz, x);
            add(&mut motion[4], &wx, -z);
            add(&mut motion[5], &wx, y);
            add(&mut motion[5], &wy, -x);
            for speed in (branch.speeds.0..branch.speeds.1).rev() {
                let mut rate = match body <= last && self.met[body] {
                    true => self.loads[speed],
                    false => ZERO,
                };
                let (pivot, drag) = (&tree.pivots[speed], &tree.drags[speed]);
                let mut carried = ZERO;
                for i in 0..6 {
                    add(&mut carried, &motion[i], pivot.momentum[i]);
                }
                add(&mut rate, &carried, -pivot.inverse);
                for i in 0..3 {
                    add(&mut rate, &motion[6 + i], -drag[i]);
                }
                let column = &tree.columns[speed];
                for i in 0..6 {
                    add(&mut motion[i], &rate, column[i]);
                }
                let start = speed * width + first;
                match <&mut Lane>::try_from(&mut rows[start..start + count]) {
                    Ok(whole) => *whole = rate,
                    Err(_) => rows[start..start + count].copy_from_slice(&rate[..count]),
                }
            }
            self.motions[body] = motion;
            if body <= last {
                self.add_own(pushes, body);
            }
        }
    }

    /// W and U of the pushes at the joint of `body`, for what hangs on it.
    fn add_own(&mut self, pushes: &[Push], body: usize) {
        for (lane, push) in pushes.iter().enumerate() {
            if push.body == body {
                let motion = &mut self.motions[body];
                for i in 0..6 {
                    motion[i][lane] += push.rate[i];
                }
                for i in 0..3 {
                    motion[6 + i][lane] = push.turn[i];
                }
            }
        }
    }
}
