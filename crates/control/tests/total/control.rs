//! Controllers: what they are made of, states of any kind, and the equations behind them.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::tree;
use crate::support::{NOT_FINITE, NOWHERE, refused, wrong, wrong_sizes};
use hamel_control::riccati::{self, Weighting};
use hamel_control::{
    ComputedTorque, Controller, Curve, EnergyShaping, Equilibrium, ErrorDynamics, PathFollower,
    PathGains, Port, PortSpring, Pump, Reference, Regulator, Weights,
};
use hamel_runtime::mechanism::Mechanism;
use hamel_runtime::time_function::Law;
use nalgebra::DMatrix;
use std::sync::Arc;

fn arm() -> Arc<Mechanism> {
    tree(&mut Random::new(4), &[joints::revolute(), joints::ball()])
}

fn follow(law: Law, end: f64) -> Result<Reference, impl std::fmt::Display + std::fmt::Debug> {
    let mechanism = arm();
    let home = mechanism.home();
    Reference::new(mechanism, &home, vec![law; 4], end)
}

fn laws(number: f64) -> [Law; 4] {
    let law = Law::default();
    [
        Law {
            rate: number,
            ..law
        },
        Law {
            amplitude: number,
            frequency: 1.0,
            ..law
        },
        Law {
            frequency: number,
            ..law
        },
        Law {
            phase: number,
            ..law
        },
    ]
}

const SLOW: ErrorDynamics = ErrorDynamics {
    frequency: 1.0,
    damping_ratio: 1.0,
};

fn controllers() -> Vec<Box<dyn Controller>> {
    let mechanism = arm();
    let reference = follow(Law::default(), 1.0).expect("at rest");
    let computed = ComputedTorque::new(reference, SLOW).expect("gains");
    let port = Port {
        port: None,
        body: 0,
        spring: PortSpring::Log(1.0),
        damping: 0.1,
        limit: 2.0,
    };
    let home = mechanism.home();
    let shaping = EnergyShaping::new(
        Arc::clone(&mechanism),
        &home,
        vec![port],
        Pump { gain: 0.1 },
    );
    let equilibrium = Equilibrium::new(mechanism, home, &[0, 1]).expect("held by its inputs");
    let weights = Weights::uniform(&equilibrium, [1.0; 3]);
    let regulator = Regulator::new(equilibrium, &weights).expect("weights");
    vec![
        Box::new(computed),
        Box::new(shaping.expect("a port")),
        Box::new(regulator),
    ]
}

#[test]
fn every_controller_refuses_states_of_other_sizes_or_not_finite() {
    let mechanism = arm();
    let layout = *mechanism.layout();
    let (q, v) = (mechanism.home(), vec![0.1; layout.speeds]);
    for mut controller in controllers() {
        let mut tau = vec![0.0; layout.freedoms];
        let mut measured = vec![0.0; controller.measures().len()];
        assert!(controller.efforts(0.5, &q, &v, &mut tau).is_ok());
        assert!(controller.measure(0.5, &q, &v, &mut measured).is_ok());
        for bad in wrong(layout.configuration) {
            refused(controller.efforts(0.5, &bad, &v, &mut tau));
            refused(controller.measure(0.5, &bad, &v, &mut measured));
        }
        for bad in wrong(layout.speeds) {
            refused(controller.efforts(0.5, &q, &bad, &mut tau));
            refused(controller.measure(0.5, &q, &bad, &mut measured));
        }
        for mut bad in wrong_sizes(layout.freedoms) {
            refused(controller.efforts(0.5, &q, &v, &mut bad));
        }
        for mut bad in wrong_sizes(measured.len()) {
            refused(controller.measure(0.5, &q, &v, &mut bad));
        }
        for time in NOT_FINITE {
            // Regulators do not look at the time.
            _ = controller.efforts(time, &q, &v, &mut tau);
            _ = controller.measure(time, &q, &v, &mut measured);
        }
    }
}

#[test]
fn references_of_any_numbers_are_made_or_refused() {
    for number in NOT_FINITE {
        for law in laws(number) {
            refused(follow(law, 1.0));
        }
        refused(follow(Law::default(), number));
        let mut reference = follow(Law::default(), 1.0).expect("at rest");
        let mut q = reference.mechanism().home();
        refused(reference.configuration(number, &mut q));
        refused(ComputedTorque::new(
            follow(Law::default(), 1.0).expect("at rest"),
            ErrorDynamics {
                frequency: number,
                ..SLOW
            },
        ));
    }
    // A phase moves nothing.
    for law in &laws(1e300)[..3] {
        refused(follow(*law, 1e300));
    }
    refused(follow(Law::default(), -1.0));
    let mut reference = follow(
        Law {
            rate: 0.1,
            ..Law::default()
        },
        1.0,
    )
    .expect("slow");
    let size = reference.mechanism().layout().configuration;
    for mut bad in wrong_sizes(size) {
        refused(reference.configuration(0.5, &mut bad));
    }
    for time in [-1e300, 1e300] {
        _ = reference.configuration(time, &mut vec![0.0; size]);
    }
}

#[test]
fn laws_of_any_numbers_are_made_or_refused() {
    let mechanism = arm();
    let home = mechanism.home();
    for index in NOWHERE {
        refused(Equilibrium::new(
            Arc::clone(&mechanism),
            home.clone(),
            &[index],
        ));
        let port = Port {
            port: None,
            body: index,
            spring: PortSpring::Log(1.0),
            damping: 0.1,
            limit: 2.0,
        };
        for ports in [vec![port], vec![port, port]] {
            let pump = Pump { gain: 0.1 };
            refused(EnergyShaping::new(
                Arc::clone(&mechanism),
                &home,
                ports,
                pump,
            ));
        }
        let curve = Curve {
            start: [0.0; 2],
            laws: [Law::default(); 2],
        };
        let gains = PathGains {
            distance: 1.0,
            rate: 1.0,
        };
        refused(PathFollower::new(
            Arc::clone(&mechanism),
            index,
            curve,
            gains,
        ));
    }
    for bad in wrong(home.len()) {
        refused(Equilibrium::new(
            Arc::clone(&mechanism),
            bad.clone(),
            &[0, 1],
        ));
        let pump = Pump { gain: 0.1 };
        refused(EnergyShaping::new(
            Arc::clone(&mechanism),
            &bad,
            vec![],
            pump,
        ));
    }
    let equilibrium = Equilibrium::new(Arc::clone(&mechanism), home, &[0, 1]).expect("held");
    for place in 0..3 {
        for bad in wrong(4) {
            let mut weights = Weights::uniform(&equilibrium, [1.0; 3]);
            match place {
                0 => weights.position = bad,
                1 => weights.speed = bad,
                _ => weights.effort = bad,
            }
            refused(Regulator::new(equilibrium.clone(), &weights));
        }
    }
}

#[test]
fn paths_of_numbers_that_are_not_finite_are_refused() {
    let mechanism = tree(&mut Random::new(4), &[joints::cart()]);
    let gains = |distance: f64, rate: f64| PathGains { distance, rate };
    let line = |rate: f64| Curve {
        start: [0.0; 2],
        laws: [Law {
            rate,
            ..Law::default()
        }; 2],
    };
    for number in NOT_FINITE {
        let make = |curve, gains| PathFollower::new(Arc::clone(&mechanism), 0, curve, gains);
        refused(make(line(number), gains(1.0, 1.0)));
        refused(make(line(1.0), gains(number, 1.0)));
        refused(make(line(1.0), gains(1.0, number)));
    }
}

#[test]
fn riccati_equations_of_any_matrices_are_solved_or_refused() {
    let numbers = [0.0, 1.0, -1.0, 1e-300, 1e300, f64::NAN, f64::INFINITY];
    for (n, m) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 1)] {
        for number in numbers {
            for place in 0..4 {
                let entry = |own: usize, usual: f64| if own == place { number } else { usual };
                let diagonal = |size, entry| DMatrix::from_diagonal_element(size, size, entry);
                let a = diagonal(n, entry(0, 0.5));
                let b = DMatrix::from_element(n, m, entry(1, 1.0));
                let (state, input) = (diagonal(n, entry(2, 1.0)), diagonal(m, entry(3, 1.0)));
                let weighting = Weighting {
                    state: &state,
                    input: &input,
                };
                let solved = [
                    riccati::discrete(&a, &b, weighting),
                    riccati::continuous(&a, &b, weighting),
                ];
                for optimum in solved.into_iter().flatten() {
                    assert!(
                        optimum.gain.iter().all(|k| k.is_finite()),
                        "{n}, {m}, {number}, {place}"
                    );
                }
                let other = diagonal(n + 1, 1.0);
                refused(riccati::discrete(&other, &b, weighting));
                refused(riccati::continuous(&a, &other, weighting));
            }
        }
    }
}
