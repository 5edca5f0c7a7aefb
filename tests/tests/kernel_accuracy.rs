//! Compiled kernels against their definitions in 256 bits: at most 16 ulp of the largest summand, at random and extreme points.
//!
//! `cargo test` takes a few hundred points a joint. The sweep takes 10⁵ and rewrites `tests/data/kernel_accuracy.csv`:
//! `cargo test --release --package hamel-tests --test kernel_accuracy -- --ignored --nocapture`.

use hamel::joint::Joint;
use hamel_tests::accuracy::{Measured, Shortfall, Table, Worst, check, measure};
use std::path::Path;

/// In units of the last place of the largest summand.
const BOUND: f64 = 16.0;

/// Where it is not kept yet: derivatives of the roots of `ellipsoid` and `falling_disk`, whose terms are multiplied out further than the
/// definition does it. Two entries of the last vanish where the disk is upright, and hold the rounding of Q itself there.
const SHORTFALLS: [Shortfall; 5] = [
    ("ellipsoid", "twist_map_child_gradient", 64.0),
    ("ellipsoid", "bias_acceleration", 64.0),
    ("ellipsoid", "bias_momentum", 64.0),
    ("falling_disk", "constraint", 64.0),
    ("falling_disk", "twist_map_child_gradient", f64::INFINITY),
];

/// Points of a plain test run.
const FEW: usize = 100;
/// Bundles of four points in lanes, and points in dual numbers.
const LANES: usize = 200;
const DUALS: usize = 50;
/// Points of the sweep, and how many of them make a batch with a seed of its own.
const SWEEP: usize = 100_000;
const BATCH: usize = 250;
/// Points between lines of progress.
const PROGRESS: usize = 10_000;

/// The worst errors at `count` points.
fn sweep<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(
    joint: &J,
    count: usize,
) -> Worst
where
    T: Measured,
    J: Joint<N, K, S, C>,
{
    let derived = hamel_tests::derived(J::NAME);
    let batches = 0..count.div_ceil(BATCH) as u64;
    batches.fold(Worst::default(), |mut worst, seed| {
        worst.merge(measure::<T, J, N, K, S, C>(
            joint,
            &derived,
            seed,
            BATCH.min(count),
        ));
        let done = (seed as usize + 1) * BATCH;
        if done.is_multiple_of(PROGRESS) {
            eprintln!("{} {}: {done} of {count} points", J::NAME, T::NAME);
        }
        worst
    })
}

/// The sweep of one joint and type, with its rows of the table.
fn full<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: &J)
where
    T: Measured,
    J: Joint<N, K, S, C>,
{
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/kernel_accuracy.csv");
    let start = std::time::Instant::now();
    let worst = sweep::<T, J, N, K, S, C>(joint, SWEEP);
    let largest = worst
        .errors
        .values()
        .map(|(error, _)| *error)
        .fold(0.0, f64::max);
    println!(
        "{} {}: {largest:.2} ulp, {:.0?}",
        J::NAME,
        T::NAME,
        start.elapsed()
    );
    let mut table = Table::read(&path);
    table.insert(J::NAME, T::NAME, &worst, SWEEP);
    table.write(&path).expect("the table can be written");
    check(J::NAME, &worst, BOUND, &SHORTFALLS);
}

macro_rules! accuracy_test {
    ($module:ident, $joint:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
        mod $module {
            use hamel_tests::accuracy::{check_lanes, measure_duals};

            #[test]
            fn double_precision() {
                let worst = super::sweep::<f64, $joint, $n, $k, $s, $c>(&$example, super::FEW);
                super::check(
                    stringify!($module),
                    &worst,
                    super::BOUND,
                    &super::SHORTFALLS,
                );
            }

            #[test]
            fn single_precision() {
                let worst = super::sweep::<f32, $joint, $n, $k, $s, $c>(&$example, super::FEW);
                super::check(
                    stringify!($module),
                    &worst,
                    super::BOUND,
                    &super::SHORTFALLS,
                );
            }

            #[test]
            fn lanes() {
                let derived = hamel_tests::derived(stringify!($module));
                check_lanes::<$joint, $n, $k, $s, $c>(&$example, &derived, super::LANES);
            }

            #[test]
            fn dual_numbers() {
                let derived = hamel_tests::derived(stringify!($module));
                let worst =
                    measure_duals::<$joint, $n, $k, $s, $c>(&$example, &derived, super::DUALS);
                super::check(
                    stringify!($module),
                    &worst,
                    super::BOUND,
                    &super::SHORTFALLS,
                );
            }

            #[test]
            #[ignore = "hours: 10⁵ points in 256 bits"]
            fn sweep() {
                super::full::<f64, $joint, $n, $k, $s, $c>(&$example);
                super::full::<f32, $joint, $n, $k, $s, $c>(&$example);
            }
        }
    };
}

hamel_joints::for_each_joint!(accuracy_test);
