//! Rows of eight states to numbers side by side, and back, by shuffles of registers: gathers take several times as long.

use super::LANES;

/// Eight rows of eight.
pub(super) type Block = [[f64; LANES]; LANES];

/// What a level of instructions has for it.
pub(super) trait Transpose: Copy {
    /// Columns for rows.
    fn transpose(self, rows: Block) -> Block;
}

/// Without instructions of any level.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl Transpose for Plain {
    #[inline(always)]
    fn transpose(self, rows: Block) -> Block {
        let mut columns = rows;
        for (i, column) in columns.iter_mut().enumerate() {
            for (entry, row) in column.iter_mut().zip(&rows) {
                *entry = row[i];
            }
        }
        columns
    }
}

/// Entry by entry the numbers of eight rows from `start`, the last one repeated.
#[inline(always)]
pub(super) fn side_by_side<const N: usize>(
    by: impl Transpose,
    rows: &[[f64; N]],
    start: usize,
) -> [[f64; LANES]; N] {
    let mut lanes = [[0.0; LANES]; N];
    let last = rows.len() - 1;
    let mut place = 0;
    while place < N {
        let from = covering::<N>(place);
        let mut block = [[0.0; LANES]; LANES];
        for (lane, numbers) in block.iter_mut().enumerate() {
            *numbers = eight_from(&rows[(start + lane).min(last)], from);
        }
        for (lanes, numbers) in lanes[from..].iter_mut().zip(&by.transpose(block)) {
            *lanes = *numbers;
        }
        place += LANES;
    }
    lanes
}

/// The numbers of the lanes into as many rows as there are, eight at most.
#[inline(always)]
pub(super) fn apart<const N: usize>(
    by: impl Transpose,
    lanes: &[[f64; LANES]; N],
    rows: &mut [[f64; N]],
) {
    let mut place = 0;
    while place < N {
        let from = covering::<N>(place);
        let mut block = [[0.0; LANES]; LANES];
        for (block, numbers) in block.iter_mut().zip(&lanes[from..]) {
            *block = *numbers;
        }
        for (row, numbers) in rows.iter_mut().zip(&by.transpose(block)) {
            match row[from..].first_chunk_mut() {
                Some(entries) => *entries = *numbers,
                None => row.copy_from_slice(&numbers[..N]),
            }
        }
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

#[cfg(all(feature = "levels", target_arch = "x86_64"))]
mod x86 {
    use super::{Block, Transpose};
    use core::arch::x86_64::{__m256d, __m512d};
    use pulp::cast;
    use pulp::x86::{V3, V4};

    impl Transpose for V3 {
        #[inline(always)]
        fn transpose(self, rows: Block) -> Block {
            let rows: [[__m256d; 2]; 8] = cast(rows);
            let mut columns = rows;
            for side in 0..2 {
                for top in 0..2 {
                    let quarter = quarters(
                        self,
                        [
                            rows[4 * top][side],
                            rows[4 * top + 1][side],
                            rows[4 * top + 2][side],
                            rows[4 * top + 3][side],
                        ],
                    );
                    columns[4 * side][top] = quarter[0];
                    columns[4 * side + 1][top] = quarter[1];
                    columns[4 * side + 2][top] = quarter[2];
                    columns[4 * side + 3][top] = quarter[3];
                }
            }
            cast(columns)
        }
    }

    /// Four by four.
    #[inline(always)]
    fn quarters(simd: V3, [a, b, c, d]: [__m256d; 4]) -> [__m256d; 4] {
        let avx = simd.avx;
        let (even, odd) = (avx._mm256_unpacklo_pd(a, b), avx._mm256_unpackhi_pd(a, b));
        let (even_below, odd_below) = (avx._mm256_unpacklo_pd(c, d), avx._mm256_unpackhi_pd(c, d));
        [
            avx._mm256_permute2f128_pd::<0x20>(even, even_below),
            avx._mm256_permute2f128_pd::<0x20>(odd, odd_below),
            avx._mm256_permute2f128_pd::<0x31>(even, even_below),
            avx._mm256_permute2f128_pd::<0x31>(odd, odd_below),
        ]
    }

    impl Transpose for V4 {
        #[inline(always)]
        fn transpose(self, rows: Block) -> Block {
            let [a, b, c, d, e, f, g, h]: [__m512d; 8] = cast(rows);
            let avx = self.avx512f;
            // Pairs of rows: entries of even columns, and of odd ones.
            let even = [
                avx._mm512_unpacklo_pd(a, b),
                avx._mm512_unpacklo_pd(c, d),
                avx._mm512_unpacklo_pd(e, f),
                avx._mm512_unpacklo_pd(g, h),
            ];
            let odd = [
                avx._mm512_unpackhi_pd(a, b),
                avx._mm512_unpackhi_pd(c, d),
                avx._mm512_unpackhi_pd(e, f),
                avx._mm512_unpackhi_pd(g, h),
            ];
            let [[c0, c2, c4, c6], [c1, c3, c5, c7]] = [pairs(self, even), pairs(self, odd)];
            cast([c0, c1, c2, c3, c4, c5, c6, c7])
        }
    }

    /// Four by four pairs of numbers.
    #[inline(always)]
    fn pairs(simd: V4, [a, b, c, d]: [__m512d; 4]) -> [__m512d; 4] {
        // The first and third pair of both, or the second and fourth.
        const FIRST: i32 = 0x88;
        const SECOND: i32 = 0xdd;
        let avx = simd.avx512f;
        let (above, above_later) = (
            avx._mm512_shuffle_f64x2::<FIRST>(a, b),
            avx._mm512_shuffle_f64x2::<SECOND>(a, b),
        );
        let (below, below_later) = (
            avx._mm512_shuffle_f64x2::<FIRST>(c, d),
            avx._mm512_shuffle_f64x2::<SECOND>(c, d),
        );
        [
            avx._mm512_shuffle_f64x2::<FIRST>(above, below),
            avx._mm512_shuffle_f64x2::<FIRST>(above_later, below_later),
            avx._mm512_shuffle_f64x2::<SECOND>(above, below),
            avx._mm512_shuffle_f64x2::<SECOND>(above_later, below_later),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::{Plain, Transpose, apart, side_by_side};
    use crate::compiled::LANES;

    /// Rows of `N` numbers, all of them different.
    fn check<const N: usize>(by: impl Transpose) {
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
                let lanes = side_by_side(by, &rows, start);
                for (i, numbers) in lanes.iter().enumerate() {
                    for (lane, number) in numbers.iter().enumerate() {
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

    fn check_all(by: impl Transpose) {
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
            pulp::x86::V3::try_new().into_iter().for_each(check_all);
            pulp::x86::V4::try_new().into_iter().for_each(check_all);
        }
    }
}
