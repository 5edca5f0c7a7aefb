//! Integrations with options, times, states and inputs of any kind: an end, or an error.

use crate::support::{NOT_FINITE, at, bare, equipped, refused, wrong};
use hamel_integrate::{
    Choice, Estimate, Event, Form, Integration, LinearStep, Method, Options, Sampling, Scheme,
    Spectrum, State, StepControl, Tableau, Wanted,
};
use hamel_runtime::dynamics::Recursive;
use hamel_runtime::mechanism::Mechanism;
use std::sync::Arc;

fn state(mechanism: &Mechanism) -> State {
    State {
        time: 0.0,
        configuration: at(mechanism),
        speeds: vec![0.0; mechanism.layout().speeds],
    }
}

fn options(method: Method, t_end: f64) -> Options {
    Options {
        form: Form::Lagrangian,
        method,
        t_end,
        samples: vec![],
    }
}

fn run(mechanism: &Arc<Mechanism>, state: &State, options: &Options) -> Result<f64, String> {
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let solution = Integration::new(&mut dynamics, state, options).run();
    solution
        .map(|solution| solution.state.time)
        .map_err(|error| error.to_string())
}

/// What is left of a span that no step divides is one step.
#[test]
fn the_shortest_spans_end() {
    let mechanism = bare();
    let rest = state(&mechanism);
    let moving = State {
        speeds: vec![0.3; rest.speeds.len()],
        ..rest.clone()
    };
    let spans = [5e-324, 1e-323, 1e-310, f64::MIN_POSITIVE, 1e-300, 0.0];
    for (t_end, state) in spans
        .into_iter()
        .flat_map(|t_end| [(t_end, &rest), (t_end, &moving)])
    {
        for scheme in Scheme::ALL.into_iter().filter(Scheme::has_estimate) {
            for sampling in [Sampling::Landing, Sampling::Dense] {
                let options = Options {
                    form: scheme.forms()[0],
                    samples: vec![0.0, t_end],
                    ..options(Method::controlled(scheme, 1e-8), t_end)
                };
                let mut dynamics = Recursive::new(Arc::clone(&mechanism));
                let solution = Integration::new(&mut dynamics, state, &options)
                    .sampling(sampling)
                    .event(Event::new("never", |_, _, _| 1.0))
                    .run()
                    .unwrap_or_else(|error| panic!("{scheme:?} to {t_end:e}: {error}"));
                assert_eq!(solution.state.time, t_end, "{scheme:?}");
                // The first is a hundredth of the span where there are such numbers, and steps grow.
                assert!(
                    solution.statistics.steps <= 20,
                    "{scheme:?}: {:?}",
                    solution.statistics
                );
                assert_eq!(solution.samples.len(), 2, "{scheme:?}");
            }
        }
        let fixed = options(Method::rk4(1e-3), t_end);
        assert_eq!(run(&mechanism, state, &fixed), Ok(t_end));
    }
}

/// A span of one rounding of the time.
#[test]
fn spans_at_the_end_of_time_end() {
    let mechanism = bare();
    for start in [1.0, 1e10, 1e300, -1e300] {
        let state = State {
            time: start,
            ..state(&mechanism)
        };
        let end = start.next_up();
        let found = run(
            &mechanism,
            &state,
            &options(Method::dormand_prince(1e-6), end),
        );
        assert!(
            found.is_ok_and(|time| time == end) || start.abs() > 1e16,
            "{start:e}"
        );
    }
}

#[test]
fn numbers_out_of_range_are_errors() {
    let mechanism = bare();
    let state = state(&mechanism);
    let methods = |number: f64| {
        let controls = [
            (number, f64::INFINITY, None),
            (1e-6, number, None),
            (1e-6, 1.0, Some(number)),
        ];
        let controls = controls.map(|(tolerance, max_step, first_step)| Method::Controlled {
            scheme: Scheme::DormandPrince,
            control: StepControl {
                tolerance,
                max_step,
                first_step,
            },
        });
        controls.into_iter().chain([Method::rk4(number)])
    };
    for number in [f64::NAN, f64::NEG_INFINITY, -1.0, 0.0, 1e-300] {
        for method in methods(number) {
            refused(run(&mechanism, &state, &options(method, 1.0)));
        }
        let mut dynamics = Recursive::new(Arc::clone(&mechanism));
        let options = options(Method::rk4(0.1), 1.0);
        let held = Integration::new(&mut dynamics, &state, &options).held(number);
        refused(held.check());
    }
    for number in NOT_FINITE {
        refused(run(&mechanism, &state, &options(Method::rk4(0.1), number)));
        let late = State {
            time: number,
            ..state.clone()
        };
        refused(run(&mechanism, &late, &options(Method::rk4(0.1), 1.0)));
        let sampled = Options {
            samples: vec![number],
            ..options(Method::rk4(0.1), 1.0)
        };
        refused(run(&mechanism, &state, &sampled));
    }
}

#[test]
fn states_of_other_sizes_or_not_finite_are_errors() {
    let mechanism = equipped();
    let right = state(&mechanism);
    let layout = *mechanism.layout();
    let wanted = Wanted {
        tolerance: 1e-8,
        span: 1.0,
        is_bound: false,
    };
    let configurations = wrong(layout.configuration).into_iter().map(|bad| State {
        configuration: bad,
        ..right.clone()
    });
    let speeds = wrong(layout.speeds).into_iter().map(|bad| State {
        speeds: bad,
        ..right.clone()
    });
    for state in configurations.chain(speeds) {
        refused(run(&mechanism, &state, &options(Method::rk4(0.1), 1.0)));
        refused(Spectrum::at(&mechanism, &state));
        refused(Choice::new(&mechanism, &state, wanted));
    }
    for number in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e-300] {
        for (tolerance, span) in [(number, 1.0), (1e-8, number)] {
            let wanted = Wanted {
                tolerance,
                span,
                ..wanted
            };
            // Any choice will do: whoever integrates refuses the numbers.
            assert!(Choice::new(&mechanism, &right, wanted).is_ok());
        }
    }
}

#[test]
fn inputs_and_events_that_are_not_finite_are_errors() {
    let mechanism = bare();
    let state = state(&mechanism);
    for scheme in Scheme::ALL {
        for number in NOT_FINITE {
            for form in [Form::Lagrangian, Form::Hamiltonian] {
                let options = Options {
                    form,
                    ..options(Method::fixed(scheme, 0.01), 0.05)
                };
                let mut dynamics = Recursive::new(Arc::clone(&mechanism));
                let driven = Integration::new(&mut dynamics, &state, &options).inputs(
                    |time, _, _, efforts| efforts[2] = if time > 0.02 { number } else { 0.0 },
                );
                refused(driven.run());
                let mut dynamics = Recursive::new(Arc::clone(&mechanism));
                let watched = Integration::new(&mut dynamics, &state, &options).event(Event::new(
                    "odd",
                    |time, _, _| if time > 0.02 { number } else { 1.0 },
                ));
                refused(watched.run());
            }
        }
    }
}

const EMPTY: Tableau = Tableau {
    order: 0,
    nodes: &[],
    matrix: &[],
    weights: &[],
    estimate: Estimate::None,
    first_same_as_last: true,
};

const CROOKED: Tableau = Tableau {
    order: 4,
    nodes: &[0.0, f64::NAN],
    matrix: &[&[], &[1.0, 2.0, 3.0]],
    weights: &[1.0],
    estimate: Estimate::One(&[]),
    first_same_as_last: false,
};

#[test]
fn coefficients_that_are_none_are_errors() {
    let mechanism = bare();
    let state = state(&mechanism);
    let efforts = vec![0.0; mechanism.layout().freedoms];
    for tableau in [&EMPTY, &CROOKED] {
        let scheme = Scheme::Explicit(tableau);
        refused(run(
            &mechanism,
            &state,
            &options(Method::fixed(scheme, 0.1), 1.0),
        ));
        refused(run(
            &mechanism,
            &state,
            &options(Method::controlled(scheme, 1e-6), 1.0),
        ));
        let mut step = LinearStep::new(&mechanism, Form::Lagrangian, tableau);
        refused(step.linearize(&state.configuration, &state.speeds, &efforts, 0.1));
    }
}

#[test]
fn linearised_steps_refuse_what_is_wrong() {
    let mechanism = bare();
    let layout = *mechanism.layout();
    let State {
        configuration: q,
        speeds: v,
        ..
    } = state(&mechanism);
    let tau = vec![0.0; layout.freedoms];
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let mut step = LinearStep::new(&mechanism, form, &Tableau::RK4);
        for bad in wrong(layout.configuration) {
            refused(step.linearize(&bad, &v, &tau, 0.1));
        }
        for bad in wrong(layout.speeds) {
            refused(step.linearize(&q, &bad, &tau, 0.1));
        }
        for bad in wrong(layout.freedoms) {
            refused(step.linearize(&q, &v, &bad, 0.1));
        }
        for length in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
            refused(step.linearize(&q, &v, &tau, length));
        }
        assert!(step.linearize(&q, &v, &tau, 0.01).is_ok());
    }
}
