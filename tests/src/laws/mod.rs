//! Laws that every joint obeys, checked on the compiled kernels by dual numbers: the definition against what was derived.
//!
//! Each law takes a configuration Q and a local coordinate ϕ; [`check_all`] runs them at ϕ = 0, 1e-8, random, and within 1e-6 of
//! half a turn, from random configurations.

mod dual;
mod finite;
pub mod search;
mod speed;
mod velocity;

use chacha20::ChaCha8Rng;
use dual::{constant, moving};
use hamel::joint::Joint;
use hamel::nalgebra::{SMatrix, SVector};
use hamel::scalar::Dual;
use rand::{RngExt, SeedableRng};

/// Bound on relative errors: sums of up to a hundred products of numbers of order 1 to 10 in double precision, 100 × 10² × 1.1e-16.
const TOLERANCE: f64 = 1e-12;
const CONFIGURATIONS: usize = 40;

type D1 = Dual<f64>;
type D2 = Dual<D1>;

/// A joint at a configuration.
struct At<'a, J, const N: usize, const K: usize, const S: usize, const C: usize> {
    joint: &'a J,
    q: SVector<f64, N>,
}

/// How far ϕ goes.
#[derive(Clone, Copy, Debug)]
pub enum Reach {
    /// Up to half a turn: Φ is exp, or as good.
    HalfTurn,
    /// Entries up to this number: beyond, Φ(Q, ·) takes values twice, or meets an exception.
    Entries(f64),
    /// The same from configurations that are no further from home: a linkage has ends all around.
    Around(f64),
}

/// How far from home configurations are looked at, in entries of ϕ.
const AWAY: f64 = 1.5;

/// Checks every law at many configurations and sizes of ϕ, up to half a turn.
///
/// # Panics
/// With the law, the joint and the figures, where one does not hold.
pub fn check_all<
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
) {
    check_within(joint, Reach::HalfTurn);
}

/// Checks every law at many configurations, at sizes of ϕ up to `reach`.
///
/// # Panics
/// With the law, the joint and the figures, where one does not hold.
pub fn check_within<
    J: Joint<N, K, S, C>,
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
>(
    joint: &J,
    reach: Reach,
) {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let furthest = match reach {
        Reach::Around(furthest) => furthest,
        Reach::HalfTurn | Reach::Entries(_) => AWAY,
    };
    for _ in 0..CONFIGURATIONS {
        let away: SVector<f64, K> = vector(&mut random, furthest);
        let at = At {
            joint,
            q: joint.retract(&joint.home(), &away),
        };
        at.velocity_laws(&vector(&mut random, 2.0), &vector(&mut random, 2.0));
        at.speed_laws(&vector(&mut random, 2.0), &vector(&mut random, 2.0));
        at.manifold_laws(&vector(&mut random, 1e-6));
        at.unidentifiable_laws(&vector(&mut random, furthest.min(1.0)));
        at.singular_sets();
        for phi in at.sizes(&vector(&mut random, 1.0), reach) {
            at.finite_laws(&phi, &vector(&mut random, 2.0));
        }
    }
}

fn vector<const K: usize>(random: &mut ChaCha8Rng, size: f64) -> SVector<f64, K> {
    SVector::from_fn(|_, _| random.random_range(-size..size))
}

fn close<const R: usize, const M: usize>(
    law: &str,
    name: &str,
    got: &SMatrix<f64, R, M>,
    expected: &SMatrix<f64, R, M>,
) {
    close_within(law, name, got, expected, TOLERANCE);
}

fn close_within<const R: usize, const M: usize>(
    law: &str,
    name: &str,
    got: &SMatrix<f64, R, M>,
    expected: &SMatrix<f64, R, M>,
    tolerance: f64,
) {
    agree((law, name), got.as_slice(), expected.as_slice(), tolerance);
}

/// Not generic in sizes: it would be compiled for each of many joints.
fn agree((law, name): (&str, &str), got: &[f64], expected: &[f64], tolerance: f64) {
    let largest = |most: f64, entry: &f64| most.max(entry.abs());
    let size = 1.0 + got.iter().chain(expected).fold(0.0, largest);
    let pairs = got.iter().zip(expected);
    let errors = pairs.map(|(got, expected)| (got - expected).abs() / size);
    let errors: Vec<f64> = errors.collect();
    // NaN where one is infinite, which is not within anything.
    let is_close = errors.iter().all(|error| *error <= tolerance);
    assert!(
        is_close,
        "{name}: {law}: relative errors {errors:?}\ngot, column by column, {got:?}, expected {expected:?}"
    );
}

impl<J: Joint<N, K, S, C>, const N: usize, const K: usize, const S: usize, const C: usize>
    At<'_, J, N, K, S, C>
{
    /// ϕ = 0, of size 1e-8, and up to the reach: as given and with its turn within 1e-6 of π, or a half and the whole.
    fn sizes(&self, phi: &SVector<f64, K>, reach: Reach) -> [SVector<f64, K>; 4] {
        if let Reach::Entries(most) | Reach::Around(most) = reach {
            return [SVector::zeros(), phi * 1e-8, phi * (most / 2.0), phi * most];
        }
        let turn = (self.joint.twist_map_child(&self.q) * self.joint.velocity_map(&self.q) * phi)
            .fixed_rows::<3>(0)
            .norm();
        let scale = match turn > 0.1 {
            // An angle of Q may turn further than the child does, as on the flat side of an ellipse.
            true => (std::f64::consts::PI - 1e-6) / turn.max(phi.amax()),
            false => std::f64::consts::PI,
        };
        [SVector::zeros(), phi * 1e-8, *phi, phi * scale]
    }

    /// Q moved along ϕ_k, as a dual number.
    fn along(&self, direction: &SVector<f64, K>) -> SVector<D1, N> {
        let start = moving(&SVector::zeros(), direction);
        self.joint.retract(&constant(&self.q), &start)
    }
}
