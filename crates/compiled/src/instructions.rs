//! What levels of SIMD instructions have: functions that may use them, and transposing by shuffles of registers, where gathers take several times as long.

use super::LANES;

/// Eight rows of eight.
pub(super) type Block = [[f64; LANES]; LANES];

/// What a register of four takes of a row.
#[cfg(all(feature = "levels", target_arch = "x86_64"))]
const HALF: usize = LANES / 2;

/// What is done in a function of its own.
pub(super) trait Work {
    /// What comes of it.
    type Output;

    /// Does it. Inlined, as all that it calls, into the function of each level.
    fn run(self) -> Self::Output;
}

/// What a level of instructions has.
pub(super) trait Instructions: Copy {
    /// Runs in a function that may use them.
    fn run<W: Work>(self, work: W) -> W::Output;

    /// Columns for rows.
    fn transpose(self, rows: Block) -> Block;
}

/// Without instructions of any level.
#[derive(Clone, Copy)]
pub(super) struct Plain;

impl Instructions for Plain {
    #[inline(never)]
    fn run<W: Work>(self, work: W) -> W::Output {
        work.run()
    }

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

#[cfg(all(feature = "levels", target_arch = "x86_64"))]
mod x86 {
    use super::{Block, HALF, Instructions, Work};
    use core::arch::x86_64::{
        __m256d, __m512d, _mm256_permute2f128_pd, _mm256_setzero_pd, _mm256_unpackhi_pd,
        _mm256_unpacklo_pd, _mm512_shuffle_f64x2, _mm512_unpackhi_pd, _mm512_unpacklo_pd,
    };
    use fearless_simd::prelude::*;
    use fearless_simd::{Avx2, Avx512, kernel};
    use safe_unaligned_simd::x86_64::{
        _mm256_loadu_pd, _mm256_storeu_pd, _mm512_loadu_pd, _mm512_storeu_pd,
    };

    impl Instructions for Avx2 {
        fn run<W: Work>(self, work: W) -> W::Output {
            // Inlined, as all that it calls, into a function that may use the instructions of the level.
            self.vectorize(
                #[inline(always)]
                || work.run(),
            )
        }

        #[inline(always)]
        fn transpose(self, rows: Block) -> Block {
            let mut columns = rows;
            by_quarters(self, &rows, &mut columns);
            columns
        }
    }

    kernel!(
        /// Eight by eight, in quarters.
        #[inline(always)]
        fn by_quarters(level: Avx2, rows: &Block, columns: &mut Block) {
            quarter(level, rows, columns, 0, 0);
            quarter(level, rows, columns, 0, HALF);
            quarter(level, rows, columns, HALF, 0);
            quarter(level, rows, columns, HALF, HALF);
        }
    );

    kernel!(
        /// Four by four: rows from `top`, their entries from `left`.
        #[inline(always)]
        fn quarter(level: Avx2, rows: &Block, columns: &mut Block, top: usize, left: usize) {
            let _ = level;
            let entries = |row: usize| -> __m256d {
                match rows[top + row][left..].first_chunk() {
                    Some(entries) => _mm256_loadu_pd(entries),
                    None => _mm256_setzero_pd(),
                }
            };
            let (a, b, c, d) = (entries(0), entries(1), entries(2), entries(3));
            let (even, odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
            let (even_below, odd_below) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
            let turned = [
                _mm256_permute2f128_pd::<0x20>(even, even_below),
                _mm256_permute2f128_pd::<0x20>(odd, odd_below),
                _mm256_permute2f128_pd::<0x31>(even, even_below),
                _mm256_permute2f128_pd::<0x31>(odd, odd_below),
            ];
            for (column, numbers) in columns[left..].iter_mut().zip(turned) {
                if let Some(place) = column[top..].first_chunk_mut() {
                    _mm256_storeu_pd(place, numbers);
                }
            }
        }
    );

    impl Instructions for Avx512 {
        fn run<W: Work>(self, work: W) -> W::Output {
            self.vectorize(
                #[inline(always)]
                || work.run(),
            )
        }

        #[inline(always)]
        fn transpose(self, rows: Block) -> Block {
            let mut columns = rows;
            by_pairs(self, &rows, &mut columns);
            columns
        }
    }

    kernel!(
        /// Eight by eight.
        #[inline(always)]
        fn by_pairs(level: Avx512, rows: &Block, columns: &mut Block) {
            let [a, b, c, d, e, f, g, h] = [
                _mm512_loadu_pd(&rows[0]),
                _mm512_loadu_pd(&rows[1]),
                _mm512_loadu_pd(&rows[2]),
                _mm512_loadu_pd(&rows[3]),
                _mm512_loadu_pd(&rows[4]),
                _mm512_loadu_pd(&rows[5]),
                _mm512_loadu_pd(&rows[6]),
                _mm512_loadu_pd(&rows[7]),
            ];
            // Pairs of rows: entries of even columns, and of odd ones.
            let [c0, c2, c4, c6] = pairs(
                level,
                _mm512_unpacklo_pd(a, b),
                _mm512_unpacklo_pd(c, d),
                _mm512_unpacklo_pd(e, f),
                _mm512_unpacklo_pd(g, h),
            );
            let [c1, c3, c5, c7] = pairs(
                level,
                _mm512_unpackhi_pd(a, b),
                _mm512_unpackhi_pd(c, d),
                _mm512_unpackhi_pd(e, f),
                _mm512_unpackhi_pd(g, h),
            );
            let turned = [c0, c1, c2, c3, c4, c5, c6, c7];
            for (column, numbers) in columns.iter_mut().zip(turned) {
                _mm512_storeu_pd(column, numbers);
            }
        }
    );

    /// The first and third pair of both, or the second and fourth.
    const FIRST: i32 = 0x88;
    const SECOND: i32 = 0xdd;

    kernel!(
        /// Four by four pairs of numbers.
        #[inline(always)]
        fn pairs(level: Avx512, a: __m512d, b: __m512d, c: __m512d, d: __m512d) -> [__m512d; 4] {
            let _ = level;
            let (above, above_later) = (
                _mm512_shuffle_f64x2::<FIRST>(a, b),
                _mm512_shuffle_f64x2::<SECOND>(a, b),
            );
            let (below, below_later) = (
                _mm512_shuffle_f64x2::<FIRST>(c, d),
                _mm512_shuffle_f64x2::<SECOND>(c, d),
            );
            [
                _mm512_shuffle_f64x2::<FIRST>(above, below),
                _mm512_shuffle_f64x2::<FIRST>(above_later, below_later),
                _mm512_shuffle_f64x2::<SECOND>(above, below),
                _mm512_shuffle_f64x2::<SECOND>(above_later, below_later),
            ]
        }
    );
}
