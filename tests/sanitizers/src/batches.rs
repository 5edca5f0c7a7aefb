//! Batches of every size about those of lanes and tasks, in memory that ends where they end.

use crate::module;
use hamel::compiled::{Batch, Lanes, Level};

/// Roundings by which levels may differ, relative to the largest entry: some hundred operations of a well-conditioned system, fused or not.
const ROUNDINGS: f64 = 1e3 * f64::EPSILON;

/// Numbers that are not alike.
fn numbers(count: usize) -> Box<[f64]> {
    let mut state = 1.0_f64;
    let next = |_| {
        state = (state * 0.754_877_666 + 0.569_840_29).fract();
        state - 0.5
    };
    (0..count).map(next).collect()
}

/// Configurations: the plate's angle, the cart's attitude and place on it, and the arm's attitude.
fn configurations(count: usize) -> Box<[f64]> {
    let angles = numbers(count);
    let rows = angles.iter().flat_map(|&angle| {
        let (s, c) = angle.sin_cos();
        [
            angle, c, -s, 0.3, s, c, -0.2, 1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c,
        ]
    });
    rows.collect()
}

fn same(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= ROUNDINGS * largest, "{a} {b}");
    }
}

fn check(batch: &Batch, count: usize) {
    let q = configurations(count);
    let v = numbers(count * module::SPEEDS);
    let tau = numbers(count * module::FREEDOMS);
    let results = || vec![0.0; count * module::SPEEDS].into_boxed_slice();
    let (mut rates, mut efforts, mut shared) = (results(), results(), results());
    let done = batch.forward_dynamics(&q, &v, &tau, &mut rates);
    done.expect("sizes fit");
    batch
        .inverse_dynamics(&q, &v, &rates, &mut efforts)
        .expect("sizes fit");
    let done = batch.par_forward_dynamics(&q, &v, &tau, &mut shared);
    done.expect("sizes fit");
    same(&shared, &rates);
    let single = Batch::at(&module::EQUATIONS, Level::Baseline).expect("every machine has it");
    for state in 0..count {
        let row = |numbers: &[f64], width: usize| -> Box<[f64]> {
            numbers[state * width..(state + 1) * width].into()
        };
        let mut own = vec![0.0; module::SPEEDS].into_boxed_slice();
        let (q, v) = (row(&q, module::CONFIGURATION), row(&v, module::SPEEDS));
        let tau = row(&tau, module::FREEDOMS);
        let done = single.forward_dynamics(&q, &v, &tau, &mut own);
        done.expect("sizes fit");
        same(&row(&rates, module::SPEEDS), &own);
    }
    let side_by_side =
        |numbers: &[f64], width| Lanes::side_by_side(numbers, width).into_boxed_slice();
    let q = side_by_side(&q, module::CONFIGURATION);
    let v = side_by_side(&v, module::SPEEDS);
    let tau = side_by_side(&tau, module::FREEDOMS);
    let mut lanes = v.clone();
    let done = batch.forward_dynamics(&q, &v, &tau, &mut lanes);
    done.expect("sizes fit");
    let apart = Lanes::apart(&lanes, module::SPEEDS);
    same(&apart[..rates.len()], &rates);
}

#[test]
fn batches_of_every_size_stay_in_their_memory() {
    for level in [Level::Baseline, Level::Avx2, Level::Avx512] {
        match Batch::at(&module::EQUATIONS, level) {
            Ok(batch) => (0..=17)
                .chain([127, 128, 129])
                .for_each(|count| check(&batch, count)),
            Err(none) => println!("SKIPPED: {none}"),
        }
    }
}

#[test]
fn sizes_that_do_not_fit_are_errors() {
    let batch = Batch::new(&module::EQUATIONS);
    let [q, v, tau] = [module::CONFIGURATION, module::SPEEDS, module::FREEDOMS].map(numbers);
    let mut room = vec![0.0; module::SPEEDS];
    for short in 1..=module::SPEEDS {
        let end = |numbers: &[f64]| -> Box<[f64]> { numbers[short.min(numbers.len())..].into() };
        assert!(
            batch
                .forward_dynamics(&end(&q), &v, &tau, &mut room)
                .is_err()
        );
        assert!(
            batch
                .forward_dynamics(&q, &v, &end(&tau), &mut room)
                .is_err()
        );
        assert!(
            batch
                .forward_dynamics(&q, &v, &tau, &mut room[short..])
                .is_err()
        );
        assert!(
            batch
                .forward_dynamics(&q, &end(&v), &tau, &mut room)
                .is_err()
        );
    }
}
