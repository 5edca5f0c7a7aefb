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
    /// One a body: the rate of what hangs on it.
    motions: Vec<[Lane; 6]>,
    /// One a body: the angular U of what hangs on it.
    turns: Vec<[Lane; 3]>,
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

/// `r × force` added to a moment.
#[inline(always)]
fn add_cross(moment: &mut [Lane; 6], [x, y, z]: [f64; 3]) {
    let [_, _, _, fx, fy, fz] = *moment;
    add(&mut moment[0], &fz, y);
    add(&mut moment[0], &fy, -z);
    add(&mut moment[1], &fx, z);
    add(&mut moment[1], &fz, -x);
    add(&mut moment[2], &fy, x);
    add(&mut moment[2], &fx, -y);
}

impl Sweep {
    pub(super) fn new(bodies: usize, speeds: usize) -> Self {
        Self {
            wrenches: vec![[ZERO; 6]; bodies],
            motions: vec![[ZERO; 6]; bodies],
            turns: vec![[ZERO; 3]; bodies],
            loads: vec![ZERO; speeds],
            met: vec![false; bodies],
        }
    }

    /// The rates that all speeds answer with, into `rows` (one a speed, of `width` entries), columns from `first` on: one a push, of which there
    /// are at most eight. `TURNS` says whether any of them has a U.
    pub(super) fn respond<const TURNS: bool>(
        &mut self,
        tree: &Tree<'_>,
        pushes: &[Push],
        out: (&mut [f64], usize, usize),
    ) {
        let last = self.inward(tree, pushes);
        self.outward::<TURNS, true>(tree, pushes, (last, tree.branches.len()), out);
        self.met[..=last].fill(false);
    }

    /// [`Sweep::respond`] to unit forces on the speeds from `first` on, whose responses are symmetric: half of them are found by outward sweeps, the
    /// others are copied.
    pub(super) fn respond_symmetrically(
        &mut self,
        tree: &Tree<'_>,
        pushes: &[Push],
        (rows, width, first): (&mut [f64], usize, usize),
    ) {
        let last = self.inward(tree, pushes);
        self.outward::<false, false>(tree, pushes, (last, last + 1), (rows, width, first));
        self.met[..=last].fill(false);
        let (before, own) = rows.split_at_mut(first * width);
        for (row, entries) in before.chunks_exact(width).enumerate() {
            for (lane, entry) in entries[first..first + pushes.len()].iter().enumerate() {
                own[lane * width + row] = *entry;
            }
        }
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
        let branch = &tree.branches[body];
        let (turns, slides) = branch.parts;
        let mut wrench = self.wrenches[body];
        for speed in branch.speeds.0..branch.speeds.1 {
            let (pivot, column) = (&tree.pivots[speed], &tree.columns[speed]);
            let mut load = ZERO;
            if turns {
                for i in 0..3 {
                    add(&mut load, &wrench[i], column[i]);
                }
            }
            if slides {
                for i in 3..6 {
                    add(&mut load, &wrench[i], column[i]);
                }
            }
            for entry in &mut load {
                *entry *= -pivot.inverse;
            }
            let momentum = pivot.momentum.data.0[0];
            for i in 0..6 {
                add(&mut wrench[i], &load, momentum[i]);
            }
            add(&mut self.loads[speed], &load, 1.0);
        }
        if branch.parent != WORLD {
            self.meet(tree, branch.parent);
            add_cross(&mut wrench, tree.nodes[body].motion.placement.offset.into());
            let parent = &mut self.wrenches[branch.parent];
            for (sum, own) in parent.iter_mut().zip(&wrench) {
                add(sum, own, 1.0);
            }
        }
    }

    /// Outward over the bodies up to `end`, of which those after `last` have no loads; `MOVES` says whether any push has a W or a U.
    #[inline(always)]
    fn outward<const TURNS: bool, const MOVES: bool>(
        &mut self,
        tree: &Tree<'_>,
        pushes: &[Push],
        (last, end): (usize, usize),
        (rows, width, first): (&mut [f64], usize, usize),
    ) {
        let count = pushes.len();
        for (body, branch) in tree.branches[..end].iter().enumerate() {
            let (mut motion, mut turn) = ([ZERO; 6], [ZERO; 3]);
            if branch.parent != WORLD {
                motion = self.motions[branch.parent];
                if TURNS {
                    turn = self.turns[branch.parent];
                }
                let [x, y, z] = tree.nodes[body].motion.placement.offset.into();
                let [wx, wy, wz, ..] = motion;
                add(&mut motion[3], &wy, z);
                add(&mut motion[3], &wz, -y);
                add(&mut motion[4], &wz, x);
                add(&mut motion[4], &wx, -z);
                add(&mut motion[5], &wx, y);
                add(&mut motion[5], &wy, -x);
            }
            let (turns, slides) = branch.parts;
            let pushed = body <= last && self.met[body];
            for speed in (branch.speeds.0..branch.speeds.1).rev() {
                let (pivot, drag) = (&tree.pivots[speed], &tree.drags[speed]);
                let (mut carried, mut other) = (ZERO, ZERO);
                for i in 0..3 {
                    add(&mut carried, &motion[i], pivot.momentum[i]);
                    add(&mut other, &motion[3 + i], pivot.momentum[3 + i]);
                }
                add(&mut carried, &other, 1.0);
                let mut rate = ZERO;
                if pushed {
                    rate = self.loads[speed];
                }
                if TURNS {
                    for i in 0..3 {
                        add(&mut rate, &turn[i], -drag[i]);
                    }
                }
                add(&mut rate, &carried, -pivot.inverse);
                let column = &tree.columns[speed];
                if turns {
                    for i in 0..3 {
                        add(&mut motion[i], &rate, column[i]);
                    }
                }
                if slides {
                    for i in 3..6 {
                        add(&mut motion[i], &rate, column[i]);
                    }
                }
                let start = speed * width + first;
                match <&mut Lane>::try_from(&mut rows[start..start + count]) {
                    Ok(whole) => *whole = rate,
                    Err(_) => rows[start..start + count].copy_from_slice(&rate[..count]),
                }
            }
            self.motions[body] = motion;
            if TURNS {
                self.turns[body] = turn;
            }
            if MOVES && pushes.first().is_some_and(|push| push.body <= body) && body <= last {
                self.add_own(pushes, body);
            }
        }
    }

    /// W and U of the pushes at the joint of `body`, for what hangs on it.
    fn add_own(&mut self, pushes: &[Push], body: usize) {
        for (lane, push) in pushes.iter().enumerate() {
            if push.body == body {
                for (sum, rate) in self.motions[body].iter_mut().zip(&push.rate.data.0[0]) {
                    sum[lane] += rate;
                }
                for (own, turn) in self.turns[body].iter_mut().zip(&push.turn.data.0[0]) {
                    own[lane] = *turn;
                }
            }
        }
    }
}
