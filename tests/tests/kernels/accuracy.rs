//! Compiled kernels against their definitions in 256 bits: at most 16 ulp of the largest summand, at random and extreme points.
//!
//! `cargo test` takes a few hundred points a joint. The sweep takes 10⁵ and puts each joint's rows into
//! `generated/kernel_accuracy.csv` as soon as it is done:
//! `cargo test --release --package hamel-tests --test kernels sweep -- --ignored --nocapture`. With `HAMEL_SWEEP=resume` it leaves
//! out the groups of kernels whose rows are all there already.

use hamel::joint::Joint;
use hamel_tests::accuracy::{Measured, Table, check, check_lanes, measure, measure_duals};
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::Instant;

/// In units of the last place of the largest summand.
const BOUND: f64 = 16.0;

/// Points of a plain test run.
const FEW: usize = 300;
/// Bundles of four points in lanes, and points in dual numbers.
const LANES: usize = 200;
const DUALS: usize = 50;
/// Of these numbers, the part for a joint of relations, whose finite maps are found by Newton's method, in 256 bits too: up to 0.14 s a point.
const OF_RELATIONS: usize = 4;
/// Points of the sweep.
const SWEEP: usize = 100_000;
/// Points between lines of progress.
const PROGRESS: usize = 20_000;
/// The table of the sweep; one joint at a time is put into it.
static TABLE: Mutex<()> = Mutex::new(());

fn table() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../generated/kernel_accuracy.csv")
}

/// How many of `count` points are taken of a joint.
fn share<J, const N: usize, const K: usize, const S: usize, const C: usize>(count: usize) -> usize
where
    J: Joint<N, K, S, C>,
{
    match J::RELATIONS {
        [] => count,
        _ => count.div_ceil(OF_RELATIONS),
    }
}

/// The worst errors at a few points.
fn few<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: &J)
where
    T: Measured,
    J: Joint<N, K, S, C>,
{
    let derived = hamel_tests::derived(J::NAME);
    let points = share::<J, N, K, S, C>(FEW);
    let worst = measure::<T, J, N, K, S, C>(joint, &derived, points, &BTreeSet::new(), &|_| {});
    check(&name::<J, N, K, S, C>(), &worst, BOUND);
}

fn lanes<J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: &J)
where
    J: Joint<N, K, S, C>,
{
    let bundles = share::<J, N, K, S, C>(LANES);
    check_lanes(joint, &hamel_tests::derived(J::NAME), bundles);
}

fn duals<J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: &J)
where
    J: Joint<N, K, S, C>,
{
    let points = share::<J, N, K, S, C>(DUALS);
    let worst = measure_duals(joint, &hamel_tests::derived(J::NAME), points);
    check(&name::<J, N, K, S, C>(), &worst, BOUND);
}

/// The joint's name, and that of its body where this is not the first.
fn name<J, const N: usize, const K: usize, const S: usize, const C: usize>() -> String
where
    J: Joint<N, K, S, C>,
{
    match (J::BODY, J::BODIES.get(J::BODY)) {
        (0, _) | (_, None) => J::NAME.to_owned(),
        (_, Some(body)) => format!("{}.{body}", J::NAME),
    }
}

/// The sweep of one joint and type, with its rows of the table.
fn full<T, J, const N: usize, const K: usize, const S: usize, const C: usize>(joint: &J)
where
    T: Measured,
    J: Joint<N, K, S, C>,
{
    let resume = std::env::var("HAMEL_SWEEP").is_ok_and(|value| value == "resume");
    let joint_name = name::<J, N, K, S, C>();
    let known = match resume {
        true => Table::read(&table()).known(&joint_name, T::NAME, SWEEP),
        false => BTreeSet::new(),
    };
    let (name, start) = (format!("{joint_name} {}", T::NAME), Instant::now());
    let progress = |done: usize| {
        if done > 0 && done.is_multiple_of(PROGRESS) {
            eprintln!("{name}: {done} of {SWEEP} points, {:.0?}", start.elapsed());
        }
    };
    let derived = hamel_tests::derived(J::NAME);
    let worst = measure::<T, J, N, K, S, C>(joint, &derived, SWEEP, &known, &progress);
    if worst.errors.is_empty() {
        return;
    }
    let errors = worst.errors.values().map(|(error, _)| *error);
    let largest = errors.fold(0.0, f64::max);
    println!("{name}: {largest:.2} ulp, {:.1?}", start.elapsed());
    // A lock that a failed sweep left behind still keeps others out.
    let guard = TABLE.lock();
    let mut rows = Table::read(&table());
    rows.insert(&joint_name, T::NAME, &worst, SWEEP, &known);
    rows.write(&table()).expect("the table can be written");
    drop(guard);
    check(&joint_name, &worst, BOUND);
}

macro_rules! accuracy_test {
    ($module:ident, $joint:ty, $example:expr, $n:literal, $k:literal, $s:literal, $c:literal) => {
        mod $module {
            #[test]
            fn double_precision() {
                super::few::<f64, $joint, $n, $k, $s, $c>(&$example);
            }

            #[test]
            fn single_precision() {
                super::few::<f32, $joint, $n, $k, $s, $c>(&$example);
            }

            #[test]
            fn lanes() {
                super::lanes::<$joint, $n, $k, $s, $c>(&$example);
            }

            #[test]
            fn dual_numbers() {
                super::duals::<$joint, $n, $k, $s, $c>(&$example);
            }

            #[test]
            #[ignore = "minutes: 10⁵ points in 256 bits"]
            fn sweep_in_double_precision() {
                super::full::<f64, $joint, $n, $k, $s, $c>(&$example);
            }

            #[test]
            #[ignore = "minutes: 10⁵ points in 256 bits"]
            fn sweep_in_single_precision() {
                super::full::<f32, $joint, $n, $k, $s, $c>(&$example);
            }
        }
    };
}

hamel_joints::for_each_joint!(accuracy_test);

macro_rules! body_test {
    ($module:ident, $joint:ty, $example:expr, $b:literal, $n:literal, $k:literal, $s:literal, $c:literal) => {
        accuracy_test!($module, hamel::joint::Member<$joint, $b>, hamel::joint::Member($example), $n, $k, $s, $c);
    };
}

hamel_joints::for_each_body!(body_test);
