//! Eight states at a time: loops over states whose bodies are straight, which the compiler vectorises for each level of instructions.
//!
//! The lines are those that serve single states, in the scalar [`Lane`]. What the loop computes for a state depends on that state alone, so
//! that neither the number of states nor their order shows in any result. Levels with fused multiply–adds and those without
//! differ by rounding.

use super::instructions::{Instructions, Plain, Registers, Work};
use super::layout::{Lanes, Quantities, States};
use super::transpose::{apart, side_by_side};
use core::hint::black_box;
use core::marker::PhantomData;
use core::slice;
#[cfg(all(feature = "levels", target_arch = "x86_64"))]
use fearless_simd::Level as Detected;
use hamel_runtime::scalar::{Lane, Scalar};

/// States that go through together; a number that is no multiple of it is filled up with copies of the last state.
pub const LANES: usize = 8;

/// A function of eight states side by side: Q, v̄ and inputs in, `R` results out.
///
/// Callers take it as a parameter, so that it is LLVM that inlines it: it then knows that results overlap no argument, without which it does not vectorise its
/// loops. The Rust compiler, which inlines what it knows, forgets that.
pub trait OfEight<const Q: usize, const V: usize, const U: usize, const R: usize> {
    /// Assigns the results. It must be inlined, as all that it calls, into the function of each level; of a loop with more than 250 places in memory, LLVM
    /// makes no SIMD code.
    fn eight<T: LaneScalar, I: Registers>(
        simd: I,
        q: &[Lanes; Q],
        v: &[Lanes; V],
        u: &[Lanes; U],
        results: &mut [Lanes; R],
    );
}

/// The number of one state in a loop over states.
pub trait LaneScalar: Scalar {
    /// It as a double.
    fn number(self) -> f64;
}

impl<const FUSED: bool> LaneScalar for Lane<FUSED> {
    #[inline(always)]
    fn number(self) -> f64 {
        self.0
    }
}

/// Sums that processors add to at once.
const SUMS: usize = 4;

/// A function of many states at a level that the machine has; whether all results are finite.
pub type ManyStates = fn(Level, States<'_>) -> bool;

/// SIMD instructions, from the fewest to the most. The default is the best that the machine has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Level {
    /// What the program is built for.
    Baseline,
    /// x86-64 with AVX2 and FMA: four doubles a register.
    Avx2,
    /// x86-64 with the AVX-512 of Ice Lake and later: eight doubles a register.
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
            Self::Avx2 => Detected::new().as_avx2().is_some(),
            #[cfg(all(feature = "levels", target_arch = "x86_64"))]
            Self::Avx512 => Detected::new().as_avx512().is_some(),
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

/// Evaluates `F`, eight states at a time, for every row that is complete in all inputs. Returns whether all results are finite. What a machine does not have is
/// done at the baseline.
///
/// Modules that are compiled with lanes hold this function of theirs: see [`Equations`](super::Equations).
pub fn many_states<F, const Q: usize, const V: usize, const U: usize, const R: usize>(
    level: Level,
    states: States<'_>,
) -> bool
where
    F: OfEight<Q, V, U, R>,
{
    #[cfg(all(feature = "levels", target_arch = "x86_64"))]
    match level {
        Level::Baseline => {}
        Level::Avx2 => {
            if let Some(simd) = Detected::new().as_avx2() {
                return at::<F, Lane<true>, Q, V, U, R>(simd, states);
            }
        }
        Level::Avx512 => {
            if let Some(simd) = Detected::new().as_avx512() {
                return at::<F, Lane<true>, Q, V, U, R>(simd, states);
            }
        }
    }
    // There is but one.
    #[cfg(not(all(feature = "levels", target_arch = "x86_64")))]
    let _ = level;
    at::<F, Lane<{ cfg!(target_feature = "fma") }>, Q, V, U, R>(Plain, states)
}

/// The same by instructions that the machine has.
fn at<E, T, const Q: usize, const V: usize, const U: usize, const R: usize>(
    simd: impl Instructions,
    states: States<'_>,
) -> bool
where
    E: OfEight<Q, V, U, R>,
    T: LaneScalar,
{
    match states {
        States::SideBySide(of) => {
            simd.run(Groups::<_, E, T, Q, V, U, R>(simd, whole(of), PhantomData))
        }
        States::Rows(of) => rows::<E, T, Q, V, U, R>(simd, whole(of)),
    }
}

/// Whole rows of what a function takes and leaves.
struct Whole<'a, N, const Q: usize, const V: usize, const U: usize, const R: usize> {
    q: &'a [[N; Q]],
    v: &'a [[N; V]],
    u: &'a [[N; U]],
    results: &'a mut [[N; R]],
}

/// As many whole rows as all quantities have.
fn whole<N, const Q: usize, const V: usize, const U: usize, const R: usize>(
    of: Quantities<'_, N>,
) -> Whole<'_, N, Q, V, U, R> {
    let (q, v, u) = (of.q.as_chunks().0, of.v.as_chunks().0, of.u.as_chunks().0);
    let results = of.results.as_chunks_mut().0;
    let count = results.len().min(q.len()).min(v.len()).min(u.len());
    Whole {
        q: &q[..count],
        v: &v[..count],
        u: &u[..count],
        results: &mut results[..count],
    }
}

/// States in rows: eight at a time side by side, and back.
fn rows<E, T, const Q: usize, const V: usize, const U: usize, const R: usize>(
    simd: impl Instructions,
    rows: Whole<'_, f64, Q, V, U, R>,
) -> bool
where
    E: OfEight<Q, V, U, R>,
    T: LaneScalar,
{
    let (mut q, mut v, mut u) = ([Lanes::ZERO; Q], [Lanes::ZERO; V], [Lanes::ZERO; U]);
    let mut results = [Lanes::ZERO; R];
    let mut finite = true;
    for start in (0..rows.results.len()).step_by(LANES) {
        simd.run(Gather {
            simd,
            from: (&rows, start),
            to: (&mut q, &mut v, &mut u),
        });
        let group = Whole {
            q: slice::from_ref(&q),
            v: slice::from_ref(&v),
            u: slice::from_ref(&u),
            results: slice::from_mut(&mut results),
        };
        finite &= simd.run(Groups::<_, E, T, Q, V, U, R>(simd, group, PhantomData));
        simd.run(Scatter(simd, &results, &mut rows.results[start..]));
    }
    finite
}

/// Eight rows of all arguments from one on, to side by side.
struct Gather<'a, S, const Q: usize, const V: usize, const U: usize, const R: usize> {
    simd: S,
    from: (&'a Whole<'a, f64, Q, V, U, R>, usize),
    to: (&'a mut [Lanes; Q], &'a mut [Lanes; V], &'a mut [Lanes; U]),
}

impl<S, const Q: usize, const V: usize, const U: usize, const R: usize> Work
    for Gather<'_, S, Q, V, U, R>
where
    S: Instructions,
{
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let (rows, start) = self.from;
        side_by_side(self.simd, rows.q, start, self.to.0);
        side_by_side(self.simd, rows.v, start, self.to.1);
        side_by_side(self.simd, rows.u, start, self.to.2);
    }
}

/// What is side by side, to rows.
struct Scatter<'a, S, const N: usize>(S, &'a [Lanes; N], &'a mut [[f64; N]]);

impl<S: Instructions, const N: usize> Work for Scatter<'_, S, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        apart(self.0, self.1, self.2);
    }
}

/// `E` of states that lie side by side; whether all results are finite.
struct Groups<'a, I, E, T, const Q: usize, const V: usize, const U: usize, const R: usize>(
    I,
    Whole<'a, Lanes, Q, V, U, R>,
    PhantomData<(E, T)>,
);

impl<I, E, T, const Q: usize, const V: usize, const U: usize, const R: usize> Work
    for Groups<'_, I, E, T, Q, V, U, R>
where
    I: Registers,
    E: OfEight<Q, V, U, R>,
    T: LaneScalar,
{
    type Output = bool;

    #[inline(always)]
    fn run(self) -> bool {
        let Self(simd, Whole { q, v, u, results }, _) = self;
        // A whole cache line on the stack aligns the frame, and with it what registers do not hold: without it each such load and store of eight doubles
        // would touch two lines, except for one place of the stack in four.
        black_box(Lanes::ZERO);
        // What x − x adds up to: 0, or NaN. Asked here, where the results still are at hand; reading them again takes a tenth of inverse dynamics.
        let mut differences = [[0.0; LANES]; SUMS];
        for (group, results) in results.iter_mut().enumerate() {
            E::eight::<T, I>(simd, &q[group], &v[group], &u[group], results);
            let (entries, last) = results.as_chunks::<SUMS>();
            for entries in entries {
                add_differences(&mut differences, entries);
            }
            add_differences(&mut differences, last);
        }
        differences.as_flattened().iter().all(|&sum| sum == 0.0)
    }
}

#[inline(always)]
fn add_differences(sums: &mut [[f64; LANES]; SUMS], entries: &[Lanes]) {
    for (sums, entry) in sums.iter_mut().zip(entries) {
        for (sum, x) in sums.iter_mut().zip(entry.0) {
            #[expect(clippy::eq_op, reason = "not zero where x is not finite")]
            let difference = x - x;
            *sum += difference;
        }
    }
}
