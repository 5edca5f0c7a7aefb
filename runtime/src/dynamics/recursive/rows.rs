//! Rows of M̄ four at a time: neighbouring speeds on one branch climb it side by side.
//!
//! Row i has the entries `X_kᵀ F_i` for the speeds k from i to the root, F_i the momentum of one unit of speed i, shifted on the way. (Where joints carry
//! several bodies there is a row, and a column, for each body and each speed of its joint.) Rows of speeds
//! that follow each other on one way to the root meet the same joints from there on, so that shift and products are those of vectors of four.

use super::Recursive;
use super::link::Rung;
use crate::scalar::Scalar;
use crate::spatial::split;
use alloc::vec::Vec;
use core::array::from_fn;
use core::ops::Range;
use nalgebra::{Vector3, Vector6};

/// Rows that climb side by side.
const LANES: usize = 4;

/// One number of each row.
type Lane = [f64; LANES];

/// 1 for one row, 0 for the others.
const UNITS: [Lane; LANES] = [
    [1.0, 0.0, 0.0, 0.0],
    [0.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0, 0.0],
    [0.0, 0.0, 0.0, 1.0],
];

/// Rows that climb side by side, each the next towards the root of the one after it.
#[derive(Clone, Debug)]
pub(super) struct Climb {
    columns: Range<usize>,
    /// Whose joint has the last of them.
    body: usize,
}

impl Climb {
    /// All rows, for the next columns towards the root: as many as can climb side by side from the tips on.
    pub(super) fn all(rungs: &[Rung], parents: &[Option<usize>]) -> Vec<Self> {
        let mut climbs = Vec::new();
        for (body, rung) in rungs.iter().enumerate().rev() {
            let mut end = climbs
                .last()
                .map_or(parents.len(), |last: &Self| last.columns.start);
            while end > rung.start {
                let least = end.saturating_sub(LANES);
                let follows = |column: &usize| parents[*column] == Some(*column - 1);
                let more = (least + 1..end).rev().take_while(follows).count();
                let columns = end - 1 - more..end;
                end = columns.start;
                climbs.push(Self { columns, body });
            }
        }
        climbs
    }
}

/// Wrenches at one frame, side by side.
struct Wrenches {
    moment: [Lane; 3],
    force: [Lane; 3],
}

impl Wrenches {
    fn none() -> Self {
        Self {
            moment: [[0.0; LANES]; 3],
            force: [[0.0; LANES]; 3],
        }
    }

    /// One of them, which has been zero.
    #[inline(always)]
    fn set(&mut self, lane: usize, wrench: &Vector6<f64>) {
        // By products: to write one of four would have the next shift wait for it.
        let own = &UNITS[lane];
        let (moment, force) = split(wrench);
        for i in 0..3 {
            add(&mut self.moment[i], own, moment[i]);
            add(&mut self.force[i], own, force[i]);
        }
    }

    /// All of them at a frame `−offset` away.
    #[inline(always)]
    fn shift(&mut self, offset: &Vector3<f64>) {
        let [x, y, z] = (*offset).into();
        let [fx, fy, fz] = &self.force;
        let [mx, my, mz] = &mut self.moment;
        for l in 0..LANES {
            mx[l] = Scalar::mul_add(y, fz[l], Scalar::mul_add(-z, fy[l], mx[l]));
            my[l] = Scalar::mul_add(z, fx[l], Scalar::mul_add(-x, fz[l], my[l]));
            mz[l] = Scalar::mul_add(x, fy[l], Scalar::mul_add(-y, fx[l], mz[l]));
        }
    }

    /// Products with one column, of which only the halves that are asked for are other than 0.
    #[inline(always)]
    fn against(&self, column: &Vector6<f64>, (turns, slides): (bool, bool)) -> Lane {
        let (turn, slide) = split(column);
        match (turns, slides) {
            (true, false) => products(&turn, &self.moment),
            (false, _) => products(&slide, &self.force),
            (true, true) => {
                let (mut sum, slid) =
                    (products(&turn, &self.moment), products(&slide, &self.force));
                for l in 0..LANES {
                    sum[l] += slid[l];
                }
                sum
            }
        }
    }
}

/// `sum += weight lane`.
#[inline(always)]
fn add(sum: &mut Lane, lane: &Lane, weight: f64) {
    for l in 0..LANES {
        sum[l] = Scalar::mul_add(lane[l], weight, sum[l]);
    }
}

#[inline(always)]
fn products(weights: &Vector3<f64>, [x, y, z]: &[Lane; 3]) -> Lane {
    let mut sum = [0.0; LANES];
    for l in 0..LANES {
        sum[l] = Scalar::mul_add(
            weights.x,
            x[l],
            Scalar::mul_add(weights.y, y[l], weights.z * z[l]),
        );
    }
    sum
}

impl Recursive {
    /// `X_kᵀ F_i` into row i of `rows`, square, for the wrench or momentum `F_i` of each column in [`Recursive::momenta`], all columns k of joints
    /// between the root and i, and those of its own joint. To the right of those stands what nobody reads.
    pub(super) fn fill_rows(&self, rows: &mut [f64]) {
        let size = self.momenta.len();
        for climb in &self.climbs {
            let rows = &mut rows[climb.columns.start * size..climb.columns.end * size];
            self.climb(climb, rows, size);
        }
    }

    /// The rows of one climb, of `size` entries each.
    fn climb(&self, climb: &Climb, rows: &mut [f64], size: usize) {
        let own = &climb.columns;
        let mut rows = rows.chunks_exact_mut(size);
        // What has no row ends in none, so that vectors stay whole.
        let mut rows: [&mut [f64]; LANES] = from_fn(|_| rows.next().unwrap_or_default());
        let mut wrenches = Wrenches::none();
        let mut body = climb.body;
        // As long as the joint has rows of its own.
        let mut below = own.end;
        loop {
            let rung = &self.rungs[body];
            if below > own.start {
                below = rung.start.max(own.start);
                for column in below..rung.end.min(own.end) {
                    wrenches.set(column - own.start, &self.momenta[column]);
                }
            }
            let places = rung.start..rung.end;
            for (place, column) in places.clone().zip(&self.columns[places]) {
                let entries = wrenches.against(column, rung.kind.parts(place));
                for (row, entry) in rows.iter_mut().zip(entries) {
                    if let Some(place) = row.get_mut(place) {
                        *place = entry;
                    }
                }
            }
            let Some(parent) = rung.parent else {
                return;
            };
            wrenches.shift(&self.nodes[body].motion.placement.offset);
            body = parent;
        }
    }
}
