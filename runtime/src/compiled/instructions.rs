//! What levels of SIMD instructions have: functions that may use them, and transposing by shuffles of registers, where gathers take several times as long.

use super::LANES;

/// Eight rows of eight.
pub(super) type Block = [[f64; LANES]; LANES];

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
    use super::{Block, Instructions, Work};
    use core::arch::x86_64::{__m256d, __m512d};
    use pulp::x86::{V3, V4};
    use pulp::{NullaryFnOnce, cast};

    /// Work as pulp takes it.
    struct Inside<W>(W);

    impl<W: Work> NullaryFnOnce for Inside<W> {
        type Output = W::Output;

        // Inlined, as all that it calls, into a function that may use the instructions of the level.
        #[inline(always)]
        fn call(self) -> W::Output {
            self.0.run()
        }
    }

    impl Instructions for V3 {
        fn run<W: Work>(self, work: W) -> W::Output {
            self.vectorize(Inside(work))
        }

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

    impl Instructions for V4 {
        fn run<W: Work>(self, work: W) -> W::Output {
            self.vectorize(Inside(work))
        }

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
