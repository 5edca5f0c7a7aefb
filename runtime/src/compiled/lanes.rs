//! Eight states at a time: a loop over states whose body is one straight-line function, which the compiler vectorises for each level of
//! instructions.
//!
//! The source is the one that serves single states, in the scalar [`Lane`]. What the loop computes for a state depends on that state alone, so
//! that neither the number of states nor their order shows in any result. Levels with fused multiply–adds and those without
//! differ by rounding.

use super::transpose::{Plain, Transpose, apart, side_by_side};
use crate::scalar::{Lane, Scalar};
use crate::unrolled::unrolled;
#[cfg(all(feature = "levels", target_arch = "x86_64"))]
use core::marker::PhantomData;

/// States that go through together; a number that is no multiple of it is filled up with copies of the last state.
pub const LANES: usize = 8;

/// A function of one state for any scalar: Q, v̄ and inputs in, as many results as speeds. Its code must be inlined into `value`.
pub trait OfState<const Q: usize, const V: usize, const U: usize> {
    /// The results.
    fn value<T: Scalar>(q: &[T; Q], v: &[T; V], u: &[T; U]) -> [T; V];
}

/// A function of many states at a level that the machine has: rows of Q, v̄ and inputs, and of results.
pub type ManyStates = fn(Level, &[f64], &[f64], &[f64], &mut [f64]);

/// SIMD instructions, from the fewest to the most. The default is the best that the machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Level {
    /// What the program is built for.
    Baseline,
    /// x86-64 with AVX2 and FMA: four doubles a register.
    Avx2,
    /// x86-64 with AVX-512: eight doubles a register.
    Avx512,
}

impl Level {
    /// All levels.
    pub const ALL: [Self; 3] = [Self::Baseline, Self::Avx2, Self::Avx512];

    /// Whether this machine has it. Without the feature `levels` it is the baseline alone.
    pub fn is_available(self) -> bool {
        match self {
            Self::Baseline => true,
            #[cfg(all(feature = "levels", target_arch = "x86_64"))]
            Self::Avx2 => pulp::x86::V3::try_new().is_some(),
            #[cfg(all(feature = "levels", target_arch = "x86_64"))]
            Self::Avx512 => pulp::x86::V4::try_new().is_some(),
            #[cfg(not(all(feature = "levels", target_arch = "x86_64")))]
            _ => false,
        }
    }
}

impl Default for Level {
    fn default() -> Self {
        let mut available = Self::ALL.into_iter().filter(|level| level.is_available());
        available.next_back().unwrap_or(Self::Baseline)
    }
}

/// `F` of as many states as there are rows in all arguments, eight at a time. What a machine does not have is done at the baseline.
///
/// Modules that are compiled with lanes hold this function of theirs: see [`Equations`](super::Equations).
pub fn many_states<F, const Q: usize, const V: usize, const U: usize>(
    level: Level,
    q: &[f64],
    v: &[f64],
    u: &[f64],
    results: &mut [f64],
) where
    F: OfState<Q, V, U>,
{
    let rows = Rows {
        q: q.as_chunks().0,
        v: v.as_chunks().0,
        u: u.as_chunks().0,
        results: results.as_chunks_mut().0,
    };
    #[cfg(all(feature = "levels", target_arch = "x86_64"))]
    match level {
        Level::Baseline => {}
        Level::Avx2 => {
            if let Some(simd) = pulp::x86::V3::try_new() {
                return simd.vectorize(At::<F, _, Q, V, U>(rows, simd, PhantomData));
            }
        }
        Level::Avx512 => {
            if let Some(simd) = pulp::x86::V4::try_new() {
                return simd.vectorize(At::<F, _, Q, V, U>(rows, simd, PhantomData));
            }
        }
    }
    // There is but one.
    #[cfg(not(all(feature = "levels", target_arch = "x86_64")))]
    let _ = level;
    rows.fill::<F, { cfg!(target_feature = "fma") }>(Plain);
}

/// Arguments and results, a row for each state.
struct Rows<'a, const Q: usize, const V: usize, const U: usize> {
    q: &'a [[f64; Q]],
    v: &'a [[f64; V]],
    u: &'a [[f64; U]],
    results: &'a mut [[f64; V]],
}

/// The same for a level with fused multiply–adds.
#[cfg(all(feature = "levels", target_arch = "x86_64"))]
struct At<'a, F, S, const Q: usize, const V: usize, const U: usize>(
    Rows<'a, Q, V, U>,
    S,
    PhantomData<F>,
);

#[cfg(all(feature = "levels", target_arch = "x86_64"))]
impl<F, S, const Q: usize, const V: usize, const U: usize> pulp::NullaryFnOnce
    for At<'_, F, S, Q, V, U>
where
    F: OfState<Q, V, U>,
    S: Transpose,
{
    type Output = ();

    // Inlined, as all that it calls, into a function that may use the instructions of the level.
    #[inline(always)]
    fn call(self) {
        self.0.fill::<F, true>(self.1);
    }
}

impl<const Q: usize, const V: usize, const U: usize> Rows<'_, Q, V, U> {
    #[inline(always)]
    fn fill<F: OfState<Q, V, U>, const FUSED: bool>(self, by: impl Transpose) {
        let count = self.results.len();
        let count = count.min(self.q.len()).min(self.v.len()).min(self.u.len());
        let mut start = 0;
        while start < count {
            let q = Lines(side_by_side(by, self.q, start));
            let v = Lines(side_by_side(by, self.v, start));
            let u = Lines(side_by_side(by, self.u, start));
            let mut results = Lines([[0.0; LANES]; V]);
            eight::<F, FUSED, Q, V, U>(&q.0, &v.0, &u.0, &mut results.0);
            apart(by, &results.0, &mut self.results[start..count]);
            start += LANES;
        }
    }
}

/// Lanes in whole cache lines.
///
/// This also aligns the frame of the function and with it what registers do not hold: without it each such load and store of eight doubles would touch two lines, but
/// for one place of the stack in four.
#[repr(align(64))]
struct Lines<const N: usize>([[f64; LANES]; N]);

/// Eight states: the loop that is vectorised. Rows would do in place of lanes side by side, but longer ones keep the compiler from it.
#[inline(always)]
fn eight<F, const FUSED: bool, const Q: usize, const V: usize, const U: usize>(
    q: &[[f64; LANES]; Q],
    v: &[[f64; LANES]; V],
    u: &[[f64; LANES]; U],
    results: &mut [[f64; LANES]; V],
) where
    F: OfState<Q, V, U>,
{
    for lane in 0..LANES {
        let value =
            F::value::<Lane<FUSED>>(&of_lane(q, lane), &of_lane(v, lane), &of_lane(u, lane));
        put(value, results, lane);
    }
}

/// The numbers of one state.
#[inline(always)]
fn of_lane<const FUSED: bool, const N: usize>(
    lanes: &[[f64; LANES]; N],
    lane: usize,
) -> [Lane<FUSED>; N] {
    let mut own = [Lane(0.0); N];
    unrolled!(i in N {
        own[i] = Lane(lanes[i][lane]);
    });
    own
}

#[inline(always)]
fn put<const FUSED: bool, const N: usize>(
    own: [Lane<FUSED>; N],
    lanes: &mut [[f64; LANES]; N],
    lane: usize,
) {
    unrolled!(i in N {
        lanes[i][lane] = own[i].0;
    });
}
