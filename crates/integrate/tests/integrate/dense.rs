//! Dense output: states between the ends of steps, of every scheme.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::{body, tree};
use crate::support::{distance, mixed, options, run, start};
use hamel_integrate::{Form, Integration, Method, Options, Sampling, Scheme, Solution, State};
use hamel_runtime::dynamics::Reference;
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::ops::ControlFlow;
use std::sync::Arc;

/// As [`run`], with samples from dense output.
fn run_dense(mechanism: &Arc<Mechanism>, initial: &State, options: &Options) -> Solution {
    let mut dynamics = Reference::new(Arc::clone(mechanism));
    let integration = Integration::new(&mut dynamics, initial, options);
    let solution = integration.sampling(Sampling::Dense).run();
    solution.expect("integrates")
}

/// Times from 0 to `t_end`, both left out, at places of steps that differ from one to the next.
fn times(count: usize, t_end: f64) -> Vec<f64> {
    let part = |i: usize| (i as f64 + 0.37) / count as f64;
    (0..count).map(|i| t_end * part(i)).collect()
}

fn worst(found: &[State], expected: &[State]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let pairs = found.iter().zip(expected);
    pairs.fold(0.0, |most, (a, b)| {
        assert_eq!(a.time, b.time);
        most.max(distance(a, b))
    })
}

const T_END: f64 = 0.2;

#[test]
fn errors_between_steps_fall_with_the_order_of_the_scheme() {
    let mechanism = mixed();
    let initial = start(&mechanism, 5);
    let samples = times(31, T_END);
    let exact = Options {
        samples: samples.clone(),
        ..options(
            Form::Lagrangian,
            Method::controlled(Scheme::Verner9, 1e-16),
            T_END,
        )
    };
    let reference = run(&mechanism, &initial, &exact).samples;
    // Numbers of steps as in the test of the order at the end of steps.
    let steps = |scheme: Scheme| match scheme {
        Scheme::Midpoint | Scheme::DiscreteGradient => 20.0,
        Scheme::Gauss3 => 4.0,
        Scheme::DormandPrince8 | Scheme::Verner9 => 1.0,
        _ => 10.0,
    };
    for scheme in Scheme::ALL {
        for &form in scheme.forms() {
            let error = |steps: f64| {
                let method = Method::fixed(scheme, T_END / steps);
                let options = Options {
                    samples: samples.clone(),
                    ..options(form, method, T_END)
                };
                worst(
                    &run_dense(&mechanism, &initial, &options).samples,
                    &reference,
                )
            };
            let (coarse, fine) = (error(steps(scheme)), error(2.0 * steps(scheme)));
            let (measured, order) = ((coarse / fine).log2(), f64::from(scheme.order()));
            println!(
                "{form:?}, {}: order {measured:.2}, error {fine:e}",
                scheme.name()
            );
            // In one step the error of the polynomial is all, and is of one order more.
            assert!(
                measured > order - 0.3 && measured < order + 1.6,
                "{form:?}, {}: order {measured} instead of {order}",
                scheme.name()
            );
        }
    }
}

#[test]
fn samples_have_no_influence_on_the_steps() {
    let mechanism = mixed();
    let initial = start(&mechanism, 5);
    for scheme in Scheme::ALL {
        // Steps of order 2 are thirty times as many at 1e-7.
        let tolerance = if scheme.order() == 2 { 1e-4 } else { 1e-7 };
        let method = match scheme.has_estimate() {
            true => Method::controlled(scheme, tolerance),
            false => Method::fixed(scheme, 0.015),
        };
        let plain = options(Form::Hamiltonian, method, T_END);
        let sampled = Options {
            samples: times(40, T_END),
            ..plain.clone()
        };
        let direct = run(&mechanism, &initial, &plain);
        let dense = run_dense(&mechanism, &initial, &sampled);
        assert_eq!(direct.state, dense.state, "{}", scheme.name());
        assert_eq!(direct.statistics.steps, dense.statistics.steps);
        assert_eq!(dense.samples.len(), 40);
    }
}

/// Every joint's relations hold on dense output as well as the matrices of a ball joint do after one product; and the polynomials of neighbouring
/// steps meet where the steps do.
#[test]
fn dense_output_is_continuous_and_on_the_manifold() {
    let mechanism = mixed();
    let initial = start(&mechanism, 5);
    let step = 1.0 / 64.0;
    // 1e-12 s on both sides of the ends of steps, and somewhere between.
    let near = |i: u32| {
        let end = f64::from(i) * step;
        [end - 1e-12, end + 1e-12, end + 0.3 * step]
    };
    let samples: Vec<f64> = (1..12).flat_map(near).collect();
    for scheme in Scheme::ALL {
        let options = Options {
            samples: samples.clone(),
            ..options(Form::Hamiltonian, Method::fixed(scheme, step), T_END)
        };
        let solution = run_dense(&mechanism, &initial, &options);
        for states in solution.samples.chunks_exact(3) {
            let gap = distance(&states[0], &states[1]);
            // Rates of tens over 2e-12 s; rounding is a thousand times less.
            assert!(gap < 1e-10, "{}: {gap:e}", scheme.name());
            for state in states {
                let residual = mechanism.bodies().iter().map(|body| {
                    let own = &state.configuration[body.ranges().configuration.clone()];
                    body.joint().residual(own)
                });
                // One product of matrices and sums of products of its entries.
                assert!(residual.fold(0.0, f64::max) < 1e-14, "{}", scheme.name());
            }
        }
    }
}

/// A body in the plane: angle, x, y; gravity along −y.
fn thrown() -> Arc<Mechanism> {
    let mass = MassProperties::new(2.0, Vector3::zeros(), Matrix3::identity()).expect("physical");
    let joint = joints::planar_euclidean();
    let stone = body("stone", None, joint, Pose::identity(), mass);
    let gravity = Vector3::new(0.0, -10.0, 0.0);
    Arc::new(Mechanism::new(gravity, vec![stone]).expect("one body"))
}

/// Under forces that are constant over each period every motion is a parabola in each, and so is every polynomial, as long as a step is looked at under
/// the force that was held in it.
#[test]
fn what_lies_within_a_step_moved_under_the_inputs_held_in_it() {
    let mechanism = thrown();
    let initial = State {
        time: 0.0,
        configuration: mechanism.home(),
        speeds: vec![0.0; 3],
    };
    let period = 0.25;
    // Accelerations −10 + 15 and −10 − 5 m/s², in turn.
    let push = |time: f64| match (time / period).round() as i64 % 2 {
        0 => 30.0,
        _ => -10.0,
    };
    let height = |time: f64| {
        let (mut y, mut v, mut left, mut i) = (0.0, 0.0, time, 0);
        while left > 0.0 {
            let h: f64 = left.min(period);
            let a = -10.0 + push(f64::from(i) * period) / 2.0;
            y += h * (v + 0.5 * a * h);
            v += h * a;
            left -= period;
            i += 1;
        }
        y
    };
    for scheme in [Scheme::Rk4, Scheme::DormandPrince8, Scheme::Gauss3] {
        let options = Options {
            samples: times(17, 2.0),
            ..options(Form::Lagrangian, Method::fixed(scheme, 0.4), 2.0)
        };
        let mut dynamics = Reference::new(Arc::clone(&mechanism));
        let solution = Integration::new(&mut dynamics, &initial, &options)
            .inputs(|time, _: &[f64], _: &[f64], efforts: &mut [f64]| efforts[2] = push(time))
            .held(period)
            .sampling(Sampling::Dense)
            .run()
            .expect("integrates");
        for state in &solution.samples {
            let error = (state.configuration[2] - height(state.time)).abs();
            // Heights of some metres, to rounding of a dozen sums.
            assert!(error < 1e-13, "{}: {error:e}", scheme.name());
        }
    }
}

/// The observer sees samples in their place, and may end the motion there.
#[test]
fn observers_see_samples_within_steps() {
    let mechanism = tree(&mut Random::new(2), &[joints::ball(), joints::revolute()]);
    let initial = start(&mechanism, 3);
    let samples = vec![0.0, 0.05, 0.1, 0.15, 0.18];
    let options = Options {
        samples: samples.clone(),
        ..options(Form::Hamiltonian, Method::rk4(0.1), T_END)
    };
    let mut seen = Vec::new();
    let mut dynamics = Reference::new(Arc::clone(&mechanism));
    let solution = Integration::new(&mut dynamics, &initial, &options)
        .sampling(Sampling::Dense)
        .observer(|step| {
            assert!(step.momenta.is_some());
            seen.push((step.time, step.number, step.sample, step.is_within));
            match step.sample {
                Some(3) => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        })
        .run()
        .expect("integrates");
    let expected = [
        (0.0, 0, Some(0), false),
        (0.05, 1, Some(1), true),
        (0.1, 1, Some(2), false),
        (0.15, 2, Some(3), true),
    ];
    assert_eq!(seen, expected);
    assert!(solution.stopped);
    assert_eq!(solution.state, solution.samples[3]);
    assert_eq!(solution.samples.len(), 4);
}
