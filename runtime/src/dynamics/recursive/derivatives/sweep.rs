//! Linear responses of the articulated tree, eight at a time: inward along the branches of what pushes, outward over all bodies.

use super::{Branch, Sensitivity, WORLD};
use crate::dynamics::recursive::inverse::MOST_FREEDOMS;
use crate::dynamics::recursive::link::Node;
use crate::scalar::Scalar;
use crate::spatial::shift_wrench;
use crate::steps::Pivot;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Vector3, Vector6};

/// Responses that go through the tree side by side.
const LANES: usize = 8;

/// Sweeps whose results are written together: 256 bytes of each row.
const GROUP: usize = 4;

/// One number of each response; aligned so that none lies across two lines of the cache, whose stores the next body's loads would wait for.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Lane([f64; LANES]);

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
    /// One a body that forks: the rate of what hangs on it.
    motions: Vec<[Lane; 6]>,
    /// One a body that forks: the angular U of what hangs on it.
    turns: Vec<[Lane; 3]>,
    /// One a speed.
    loads: Vec<Lane>,
    /// Whether the sweep inward has met a body.
    met: Vec<bool>,
    /// One a speed, of each of a group of sweeps: rows of results are written where several of their numbers are known, since each is far from the others.
    answers: Vec<Lane>,
}

const ZERO: Lane = Lane([0.0; LANES]);

/// `sum += weight lane`.
#[inline(always)]
fn add(sum: &mut Lane, lane: &Lane, weight: f64) {
    for l in 0..LANES {
        sum.0[l] = Scalar::mul_add(lane.0[l], weight, sum.0[l]);
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
            answers: vec![ZERO; GROUP * speeds],
        }
    }

    /// The rates that all speeds answer with, into columns of `out`: one a push. `TURNS` says whether any of them has a U.
    pub(super) fn respond<const TURNS: bool>(
        &mut self,
        tree: &Tree<'_>,
        pushes: &[Push],
        out: &mut Sensitivity,
    ) {
        let end = tree.branches.len();
        for (group, pushes) in pushes.chunks(GROUP * LANES).enumerate() {
            let mut answers = core::mem::take(&mut self.answers);
            for (stripe, pushes) in answers
                .chunks_exact_mut(out.rows().max(1))
                .zip(pushes.chunks(LANES))
            {
                let last = self.inward(tree, pushes);
                self.outward::<TURNS, true>(tree, pushes, (last, end), stripe);
                self.met[..=last].fill(false);
            }
            write_down(&answers, group * GROUP * LANES, pushes.len(), out);
            self.answers = answers;
        }
    }

    /// [`Sweep::respond`] to unit forces on the speeds, whose responses are symmetric: half of them are found by outward sweeps, the others are copied.
    pub(super) fn respond_symmetrically(
        &mut self,
        tree: &Tree<'_>,
        pushes: &[Push],
        out: &mut Sensitivity,
    ) {
        for (group, pushes) in pushes.chunks(GROUP * LANES).enumerate() {
            let mut answers = core::mem::take(&mut self.answers);
            let start = group * GROUP * LANES;
            for (place, (stripe, pushes)) in answers
                .chunks_exact_mut(out.rows().max(1))
                .zip(pushes.chunks(LANES))
                .enumerate()
            {
                let last = self.inward(tree, pushes);
                self.outward::<false, false>(tree, pushes, (last, last + 1), stripe);
                self.met[..=last].fill(false);
                mirror(stripe, start + place * LANES, pushes.len(), out);
            }
            write_down_triangle(&answers, start, pushes.len(), out);
            self.answers = answers;
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
                load.0[lane] = *own;
            }
            if branch.parent != WORLD {
                self.meet(tree, branch.parent);
                let offset = &tree.nodes[push.body].motion.placement.offset;
                let carried = shift_wrench(&push.wrench, offset);
                for (sum, entry) in self.wrenches[branch.parent].iter_mut().zip(&carried) {
                    sum.0[lane] += entry;
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
            for entry in &mut load.0 {
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
        answers: &mut [Lane],
    ) {
        // Those of the body before, on which most bodies hang, never leave for memory: a long chain's do not fit into the nearest cache.
        let (mut motion, mut turn) = ([ZERO; 6], [ZERO; 3]);
        for (body, branch) in tree.branches[..end].iter().enumerate() {
            match branch.parent {
                WORLD => (motion, turn) = ([ZERO; 6], [ZERO; 3]),
                parent if parent + 1 == body => {}
                parent => {
                    motion = self.motions[parent];
                    if TURNS {
                        turn = self.turns[parent];
                    }
                }
            }
            if branch.parent != WORLD {
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
                answers[speed] = rate;
            }
            if MOVES && pushes.first().is_some_and(|push| push.body <= body) && body <= last {
                add_own(pushes, body, &mut motion, &mut turn);
            }
            if branch.forks {
                self.motions[body] = motion;
                if TURNS {
                    self.turns[body] = turn;
                }
            }
        }
    }
}

/// The rows of `answers` from the sweeps of `count` pushes into columns of `out` from `first` on.
fn write_down(answers: &[Lane], first: usize, count: usize, out: &mut Sensitivity) {
    let (rows, width) = (out.rows(), out.columns);
    for (row, entries) in out.entries.chunks_exact_mut(width).enumerate() {
        let own = entries[first..first + count].chunks_mut(LANES);
        for (own, answer) in own.zip(answers[row..].iter().step_by(rows)) {
            match <&mut [f64; LANES]>::try_from(&mut *own) {
                Ok(whole) => *whole = answer.0,
                Err(_) => own.copy_from_slice(&answer.0[..own.len()]),
            }
        }
    }
}

/// [`write_down`] of what stands above the diagonal and on it.
fn write_down_triangle(answers: &[Lane], first: usize, count: usize, out: &mut Sensitivity) {
    let (rows, width) = (out.rows(), out.columns);
    for (row, entries) in out
        .entries
        .chunks_exact_mut(width)
        .take(first + count)
        .enumerate()
    {
        let known = row.saturating_sub(first) / LANES;
        let own = entries[first..first + count].chunks_mut(LANES).enumerate();
        for (stripe, own) in own.skip(known) {
            own.copy_from_slice(&answers[stripe * rows + row].0[..own.len()]);
        }
    }
}

/// What the speeds before `first` answer to unit forces on those from it on, as what these answer to forces on them.
fn mirror(stripe: &[Lane], first: usize, count: usize, out: &mut Sensitivity) {
    let width = out.columns;
    for (lane, row) in out.entries[first * width..]
        .chunks_exact_mut(width)
        .take(count)
        .enumerate()
    {
        for (entry, answer) in row.iter_mut().zip(&stripe[..first]) {
            *entry = answer.0[lane];
        }
    }
}

/// W and U of the pushes at the joint of `body`, for what hangs on it.
#[inline(never)]
fn add_own(pushes: &[Push], body: usize, motion: &mut [Lane; 6], turn: &mut [Lane; 3]) {
    for (lane, push) in pushes.iter().enumerate() {
        if push.body == body {
            for (sum, rate) in motion.iter_mut().zip(&push.rate.data.0[0]) {
                sum.0[lane] += rate;
            }
            for (own, turn) in turn.iter_mut().zip(&push.turn.data.0[0]) {
                own.0[lane] = *turn;
            }
        }
    }
}
