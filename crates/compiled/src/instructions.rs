//! What levels of SIMD instructions have: functions that may use them, registers of eight numbers, and transposing by shuffles of registers, where gathers take
//! several times as long.

use super::LANES;
use super::layout::Lanes;
use hamel_runtime::scalar::{Lane, Scalar};

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

/// Numbers of eight states in the registers of a level of instructions.
pub trait Registers: Copy {
    /// Eight numbers.
    type Eight: Copy;

    /// Reads them.
    fn read(self, from: &Lanes) -> Self::Eight;

    /// Leaves them in memory.
    fn write(self, eight: Self::Eight, to: &mut Lanes);

    /// The same number eight times.
    fn all(self, number: f64) -> Self::Eight;

    /// `a b`.
    fn times(self, a: Self::Eight, b: Self::Eight) -> Self::Eight;

    /// `a b + c`, rounded once where the level has that.
    fn mul_add(self, a: Self::Eight, b: Self::Eight, c: Self::Eight) -> Self::Eight;

    /// `1/a`.
    fn reciprocal(self, a: Self::Eight) -> Self::Eight;
}

/// What a level of instructions has.
pub(super) trait Instructions: Registers {
    /// Runs in a function that may use them.
    fn run<W: Work>(self, work: W) -> W::Output;

    /// Columns for rows.
    fn transpose(self, rows: Block) -> Block;
}

/// Without instructions of any level: numbers in memory, and loops over the states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Plain;

/// Numbers as the scalar of the baseline computes with them.
type Own = Lane<{ cfg!(target_feature = "fma") }>;

impl Registers for Plain {
    type Eight = Lanes;

    #[inline(always)]
    fn read(self, from: &Lanes) -> Lanes {
        *from
    }

    #[inline(always)]
    fn write(self, eight: Lanes, to: &mut Lanes) {
        *to = eight;
    }

    #[inline(always)]
    fn all(self, number: f64) -> Lanes {
        Lanes([number; LANES])
    }

    #[inline(always)]
    fn times(self, mut a: Lanes, b: Lanes) -> Lanes {
        for (a, b) in a.0.iter_mut().zip(b.0) {
            *a *= b;
        }
        a
    }

    #[inline(always)]
    fn mul_add(self, a: Lanes, b: Lanes, mut c: Lanes) -> Lanes {
        for (lane, sum) in c.0.iter_mut().enumerate() {
            *sum = Own::mul_add(Lane(a.0[lane]), Lane(b.0[lane]), Lane(*sum)).0;
        }
        c
    }

    #[inline(always)]
    fn reciprocal(self, mut a: Lanes) -> Lanes {
        for number in &mut a.0 {
            *number = 1.0 / *number;
        }
        a
    }
}

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
    use super::{Block, HALF, Instructions, Lanes, Registers, Work};
    use core::arch::x86_64::{
        __m256d, __m512d, _mm256_permute2f128_pd, _mm256_setzero_pd, _mm256_unpackhi_pd,
        _mm256_unpacklo_pd, _mm512_shuffle_f64x2, _mm512_unpackhi_pd, _mm512_unpacklo_pd,
    };
    use fearless_simd::prelude::*;
    use fearless_simd::{Avx2, Avx512, f64x8, kernel};
    use safe_unaligned_simd::x86_64::{
        _mm256_loadu_pd, _mm256_storeu_pd, _mm512_loadu_pd, _mm512_storeu_pd,
    };

    macro_rules! implement_registers {
        ($($level:ty),*) => {$(
            impl Registers for $level {
                type Eight = f64x8<Self>;

                #[inline(always)]
                fn read(self, from: &Lanes) -> f64x8<Self> {
                    from.0.simd_into(self)
                }

                #[inline(always)]
                fn write(self, eight: f64x8<Self>, to: &mut Lanes) {
                    to.0 = eight.into();
                }

                #[inline(always)]
                fn all(self, number: f64) -> f64x8<Self> {
                    self.splat_f64x8(number)
                }

                #[inline(always)]
                fn times(self, a: f64x8<Self>, b: f64x8<Self>) -> f64x8<Self> {
                    a * b
                }

                #[inline(always)]
                fn mul_add(self, a: f64x8<Self>, b: f64x8<Self>, c: f64x8<Self>) -> f64x8<Self> {
                    a.mul_add(b, c)
                }

                #[inline(always)]
                fn reciprocal(self, a: f64x8<Self>) -> f64x8<Self> {
                    self.all(1.0) / a
                }
            }
        )*};
    }

    implement_registers!(Avx2, Avx512);

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
