//! Rates at the stages of an explicit step, side by side, and their weighted sums.
//!
//! On small mechanisms these sums cost as much as the equations of motion. A row holds ϕ̇ and ẏ of one stage, then zeros up to a whole number
//! of blocks, and a sum goes block by block over all of its rows, so that it stays in registers.

use super::flow::{Rates, RatesMut};
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::scalar::Scalar;

/// Entries that are summed together: those of a register of 256 bits.
const BLOCK: usize = 4;

type Block = [f64; BLOCK];

/// Stages, and their weights.
pub(super) type Terms = Vec<(usize, f64)>;

/// The weights that are not 0.
pub(super) fn terms(weights: &[f64]) -> Terms {
    let weights = weights.iter().copied().enumerate();
    weights.filter(|(_, weight)| *weight != 0.0).collect()
}

/// The rates of one step; the first row has those of the state.
pub(super) struct Stages {
    freedoms: usize,
    /// ϕ̇ and ẏ of a stage.
    entries: usize,
    /// Blocks of a row.
    width: usize,
    blocks: Vec<Block>,
    /// v̄ at the stage that was evaluated last.
    speeds: Vec<f64>,
    /// One row.
    sum: Vec<Block>,
}

impl Stages {
    /// Room for `count` stages.
    pub(super) fn new(count: usize, mechanism: &Mechanism) -> Self {
        let layout = mechanism.layout();
        let entries = layout.freedoms + layout.speeds;
        let width = entries.div_ceil(BLOCK);
        Self {
            freedoms: layout.freedoms,
            entries,
            width,
            blocks: vec![[0.0; BLOCK]; count * width],
            speeds: vec![0.0; layout.speeds],
            sum: vec![[0.0; BLOCK]; width],
        }
    }

    /// A step begins from a state with these rates.
    pub(super) fn begin(&mut self, Rates { phi, y, speeds }: &Rates) {
        let room = self.room(0);
        room.phi.copy_from_slice(phi);
        room.y.copy_from_slice(y);
        room.speeds.copy_from_slice(speeds);
    }

    /// Room for the rates of stage `i`.
    pub(super) fn room(&mut self, i: usize) -> RatesMut<'_> {
        let row = &mut self.blocks[i * self.width..][..self.width];
        let (phi, rest) = row.as_flattened_mut().split_at_mut(self.freedoms);
        RatesMut {
            phi,
            y: &mut rest[..self.entries - self.freedoms],
            speeds: &mut self.speeds,
        }
    }

    /// ẏ and v̄ of the last stage.
    pub(super) fn last(&self) -> (&[f64], &[f64]) {
        let row = &self.blocks[self.blocks.len() - self.width..];
        (
            &row.as_flattened()[self.freedoms..self.entries],
            &self.speeds,
        )
    }

    /// v̄ of the last stage.
    pub(super) fn last_speeds(&self) -> &[f64] {
        &self.speeds
    }

    /// `unit · Σ weights · rates`, of ϕ̇ and then of ẏ.
    pub(super) fn sum(&mut self, unit: f64, weights: &Terms) -> &[f64] {
        for (place, sum) in self.sum.iter_mut().enumerate() {
            let mut total = [0.0; BLOCK];
            for &(stage, weight) in weights {
                let rates = &self.blocks[stage * self.width + place];
                for (total, rate) in total.iter_mut().zip(rates) {
                    *total = Scalar::mul_add(*rate, weight, *total);
                }
            }
            *sum = total.map(|total| unit * total);
        }
        &self.sum.as_flattened()[..self.entries]
    }

    /// The same, 0 where it is no more than what rounding makes of terms that cancel.
    pub(super) fn sum_beyond_rounding(&mut self, unit: f64, weights: &Terms) -> &[f64] {
        for (place, sum) in self.sum.iter_mut().enumerate() {
            let (mut total, mut size) = ([0.0_f64; BLOCK], [0.0; BLOCK]);
            for &(stage, weight) in weights {
                let rates = &self.blocks[stage * self.width + place];
                for i in 0..BLOCK {
                    let term = weight * rates[i];
                    total[i] += term;
                    size[i] += term.abs();
                }
            }
            for i in 0..BLOCK {
                let beyond = total[i].abs() - 2.0 * f64::EPSILON * size[i];
                sum[i] = if beyond < 0.0 {
                    0.0
                } else {
                    unit * beyond.copysign(total[i])
                };
            }
        }
        &self.sum.as_flattened()[..self.entries]
    }
}
