//! Rows of eight states to numbers side by side, and back, by shuffles of registers: gathers take several times as long.

use super::instructions::Instructions;
use super::{LANES, Lanes};
use hamel_runtime::unrolled;

/// Entry by entry the numbers of eight rows from `start`, the last one repeated.
#[inline(always)]
pub(super) fn side_by_side<const N: usize>(
    by: impl Instructions,
    rows: &[[f64; N]],
    start: usize,
    lanes: &mut [Lanes; N],
) {
    let last = rows.len() - 1;
    let mut place = 0;
    while place < N {
        let from = covering::<N>(place);
        let mut block = [[0.0; LANES]; LANES];
        unrolled!(lane in LANES {
            block[lane] = eight_from(&rows[(start + lane).min(last)], from);
        });
        let columns = by.transpose(block);
        match lanes[from..].first_chunk_mut::<LANES>() {
            Some(lanes) => {
                unrolled!(i in LANES {
                    lanes[i].0 = columns[i];
                });
            }
            None => {
                for (lanes, numbers) in lanes.iter_mut().zip(columns) {
                    lanes.0 = numbers;
                }
            }
        }
        place += LANES;
    }
}

/// The numbers of the lanes into as many rows as there are, eight at most.
#[inline(always)]
pub(super) fn apart<const N: usize>(
    by: impl Instructions,
    lanes: &[Lanes; N],
    rows: &mut [[f64; N]],
) {
    let mut place = 0;
    while place < N {
        let from = covering::<N>(place);
        let mut block = [[0.0; LANES]; LANES];
        match lanes[from..].first_chunk::<LANES>() {
            Some(lanes) => {
                unrolled!(i in LANES {
                    block[i] = lanes[i].0;
                });
            }
            None => {
                for (block, numbers) in block.iter_mut().zip(lanes) {
                    *block = numbers.0;
                }
            }
        }
        let columns = by.transpose(block);
        unrolled!(lane in LANES {
            if let Some(row) = rows.get_mut(lane) {
                match row[from..].first_chunk_mut() {
                    Some(entries) => *entries = columns[lane],
                    None => row.copy_from_slice(&columns[lane][..N]),
                }
            }
        });
        place += LANES;
    }
}

/// Where eight numbers of a row begin, the one at `place` among them: further back where the row ends before.
#[inline(always)]
fn covering<const N: usize>(place: usize) -> usize {
    place.min(N.saturating_sub(LANES))
}

/// Eight numbers from `place`; of a shorter row all, and zeros.
#[inline(always)]
fn eight_from<const N: usize>(row: &[f64; N], place: usize) -> [f64; LANES] {
    match row[place..].first_chunk() {
        Some(numbers) => *numbers,
        None => {
            let mut numbers = [0.0; LANES];
            numbers[..N].copy_from_slice(row);
            numbers
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{apart, side_by_side};
    use crate::instructions::{Instructions, Plain};
    use crate::{LANES, Lanes};

    /// Rows of `N` numbers, all of them different.
    fn check<const N: usize>(by: impl Instructions) {
        for count in 1..=2 * LANES {
            let mut number = 0.0;
            let rows: Vec<[f64; N]> = (0..count)
                .map(|_| {
                    core::array::from_fn(|_| {
                        number += 1.0;
                        number
                    })
                })
                .collect();
            for start in (0..count).step_by(LANES) {
                let mut lanes = [Lanes::ZERO; N];
                side_by_side(by, &rows, start, &mut lanes);
                for (i, numbers) in lanes.iter().enumerate() {
                    for (lane, number) in numbers.0.iter().enumerate() {
                        assert_eq!(*number, rows[(start + lane).min(count - 1)][i]);
                    }
                }
                let own = &rows[start..count.min(start + LANES)];
                let mut back = vec![[0.0; N]; own.len()];
                apart(by, &lanes, &mut back);
                assert_eq!(back, own);
            }
        }
    }

    fn check_all(by: impl Instructions) {
        check::<1>(by);
        check::<7>(by);
        check::<8>(by);
        check::<13>(by);
        check::<24>(by);
    }

    #[test]
    fn numbers_come_to_their_places_and_back() {
        check_all(Plain);
        #[cfg(all(feature = "levels", target_arch = "x86_64"))]
        {
            let level = fearless_simd::Level::new();
            level.as_avx2().into_iter().for_each(check_all);
            level.as_avx512().into_iter().for_each(check_all);
        }
    }
}
