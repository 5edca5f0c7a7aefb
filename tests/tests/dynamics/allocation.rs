//! After construction nothing allocates: every method of the recursive form and of its mass matrix, and steps of the integrators.

use allocation_counter::measure;
use hamel::dynamics::{
    Dynamics, ForwardDerivatives, ForwardSecondDerivatives, Frame, HamiltonianDerivatives,
    InverseDerivatives, InverseMassMatrix, InverseSecondDerivatives, MassMatrix, Recursive,
};
use hamel::elements::PointConstraint;
use hamel::integrate::{
    Event, Form, Integration, LinearStep, Method, Options, Scheme, State, Statistics, StepControl,
    Tableau,
};
use hamel::mechanism::NamedFrame;
use hamel::nalgebra::{Vector3, Vector6};
use hamel::spatial::Pose;
use hamel_tests::derivatives::Actuation;
use hamel_tests::random::{Case, cases, library};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Allocations by what was called; the counter itself is seen to count.
#[derive(Default)]
struct Counts(BTreeMap<&'static str, u64>);

impl Counts {
    fn of(&mut self, call: &'static str, work: impl FnOnce()) {
        *self.0.entry(call).or_default() += measure(work).count_total;
    }

    fn assert_none(&self, calls: usize) {
        assert!(measure(|| drop(std::hint::black_box(vec![0_u8; 9]))).count_total > 0);
        assert_eq!(self.0.len(), calls);
        let some: Vec<_> = self.0.iter().filter(|(_, count)| **count > 0).collect();
        assert!(some.is_empty(), "allocations: {some:?}");
    }
}

/// A frame on the last body of each.
fn framed() -> impl Iterator<Item = Case> {
    trees().into_iter().map(|case| {
        let tool = NamedFrame {
            name: "tool".to_owned(),
            body: Some(case.mechanism.bodies().len() - 1),
            at: Pose::from_translation(Vector3::new(0.1, 0.2, 0.3)),
        };
        let mechanism = (*case.mechanism).clone().with_frames(vec![tool]);
        let mechanism = Arc::new(mechanism.expect("it fits"));
        Case { mechanism, ..case }
    })
}

#[test]
fn frames_do_not_allocate() {
    let mut counts = Counts::default();
    for case in framed() {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let layout = *case.mechanism.layout();
        let mut locals = vec![0.0; 6 * layout.freedoms];
        for axes in [Frame::Body, Frame::World, Frame::WorldAligned] {
            counts.of("operational_mobility", || {
                let found = dynamics.operational_mobility(&case.q, 0, axes);
                found.expect("every body has mass");
            });
            let readings = dynamics.readings(&case.q, &case.speeds).expect("sizes fit");
            counts.of("frame", || {
                let frame = readings.frame(0).expect("a frame");
                std::hint::black_box((frame.pose(), frame.twist(axes)));
                std::hint::black_box(frame.jacobian_rate_product(axes));
                frame.local_jacobian(axes, &mut locals).expect("sizes fit");
                frame.twist_gradient(axes, &mut locals).expect("sizes fit");
            });
        }
    }
    counts.assert_none(2);
}

/// Derivatives of mechanisms with elements.
#[test]
fn elements_do_not_allocate() {
    let mut counts = Counts::default();
    for case in trees() {
        let actuation = Actuation::random(&case.mechanism, &case.q, case.seed);
        let mechanism = actuation.equip(&case.mechanism);
        let (q, v, tau) = (&case.q[..], &case.speeds[..], &case.efforts[..]);
        let mut dynamics = Recursive::new(Arc::clone(&mechanism));
        let mut inverse = InverseDerivatives::new(&mechanism);
        let mut forward = ForwardDerivatives::new(&mechanism);
        let mut hamiltonian = HamiltonianDerivatives::new(&mechanism);
        counts.of("derivatives", || {
            let found = dynamics.inverse_dynamics_derivatives(q, v, &case.rates, &mut inverse);
            found.expect("covered");
            let found = dynamics.forward_dynamics_derivatives(q, v, tau, &mut forward);
            found.expect("every body has mass");
            let found = dynamics.hamiltonian_derivatives(q, v, tau, &mut hamiltonian);
            found.expect("every body has mass");
        });
        let mut inverse = InverseSecondDerivatives::new(&mechanism);
        let mut forward = ForwardSecondDerivatives::new(&mechanism);
        counts.of("second derivatives", || {
            let (a, out) = (&case.rates, &mut inverse);
            let found = dynamics.inverse_dynamics_second_derivatives(q, v, a, v, out);
            found.expect("covered");
            let found = dynamics.forward_dynamics_second_derivatives(q, v, tau, v, &mut forward);
            found.expect("every body has mass");
        });
    }
    counts.assert_none(2);
}

/// Both forms and their derivatives where constraints couple joints.
#[test]
fn coupled_joints_do_not_allocate() {
    let mut counts = Counts::default();
    let mut coupled = 0;
    for case in trees() {
        let edge = PointConstraint {
            name: "edge".to_owned(),
            body: case.mechanism.bodies().len() - 1,
            point: Vector3::new(0.3, -0.2, 0.5),
            direction: Vector3::new(0.6, 0.5, -0.4),
        };
        let mechanism = (*case.mechanism).clone();
        // The joints of a few trees allow nothing that the edge forbids.
        let Ok(mechanism) = mechanism.with_constraints(vec![edge], &case.q) else {
            continue;
        };
        coupled += 1;
        let mechanism = Arc::new(mechanism);
        let (q, tau, mut v) = (&case.q[..], &case.efforts[..], case.speeds.clone());
        let mut dynamics = Recursive::new(Arc::clone(&mechanism));
        let mut forward = ForwardDerivatives::new(&mechanism);
        let mut hamiltonian = HamiltonianDerivatives::new(&mechanism);
        let (mut rates, mut forces, mut p) = (case.rates.clone(), [0.0], v.clone());
        counts.of("equations and derivatives", || {
            dynamics.complete_speeds(q, &mut v).expect("determined");
            let found = dynamics.forward_dynamics(q, &v, tau, &mut rates);
            found.expect("every body has mass");
            let found = dynamics.coupling_force(q, &v, &rates, tau, &mut forces);
            found.expect("determined");
            let found = dynamics.forward_dynamics_derivatives(q, &v, tau, &mut forward);
            found.expect("every body has mass");
            let found = dynamics.momenta(q, &v, &mut p);
            found.expect("determined");
            let found = dynamics.hamiltonian_derivatives(q, &p, tau, &mut hamiltonian);
            found.expect("every body has mass");
        });
    }
    assert!(coupled >= 40, "{coupled} trees take an edge");
    counts.assert_none(1);
}

/// Trees of all types of the library, up to 12 joints each.
fn trees() -> Vec<Case> {
    cases(&library(), 12, 48).collect()
}

#[test]
fn equations_of_motion_do_not_allocate() {
    let mut counts = Counts::default();
    for case in trees() {
        let (q, v) = (case.q.as_slice(), case.speeds.as_slice());
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let (mut a, mut b) = (vec![0.0; v.len()], vec![0.0; v.len()]);
        counts.of("accelerations", || {
            let solved = dynamics.forward_dynamics(q, v, &case.efforts, &mut a);
            solved.expect("every body has mass");
        });
        counts.of("momenta", || {
            dynamics.momenta(q, v, &mut a).expect("sizes fit")
        });
        counts.of("speeds", || {
            let solved = dynamics.speeds(q, v, &mut a);
            solved.expect("every body has mass");
        });
        let mut efforts = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(&case.efforts);
        counts.of("momentum_rates", || {
            let solved = dynamics.momentum_rates(q, v, &mut efforts, &mut a, &mut b);
            solved.expect("every body has mass");
        });
        counts.of("hamiltonian", || {
            dynamics.hamiltonian(q, v).expect("every body has mass");
        });
    }
    counts.assert_none(5);
}

#[test]
fn inverse_dynamics_and_wrenches_do_not_allocate() {
    let mut counts = Counts::default();
    for case in trees() {
        let (q, v) = (case.q.as_slice(), case.speeds.as_slice());
        let layout = *case.mechanism.layout();
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut reduced = vec![0.0; v.len()];
        let mut efforts = vec![0.0; layout.freedoms];
        let mut forces = vec![0.0; layout.constraints];
        counts.of("set_configuration", || {
            dynamics.set_configuration(q).expect("sizes fit");
        });
        counts.of("bias_forces", || {
            dynamics.bias_forces(q, v, &mut reduced).expect("sizes fit");
        });
        counts.of("inverse_dynamics", || {
            let found = dynamics.inverse_dynamics(q, v, &case.rates, &mut reduced);
            found.expect("sizes fit");
        });
        counts.of("joint_wrench", || {
            dynamics.joint_wrench(0).expect("a body");
        });
        counts.of("joint_efforts", || {
            dynamics.joint_efforts(q, &mut efforts).expect("sizes fit");
        });
        counts.of("constraint_force", || {
            let found = dynamics.constraint_force(q, &case.efforts, &mut forces);
            found.expect("independent");
        });
    }
    counts.assert_none(6);
}

#[test]
fn derivatives_do_not_allocate() {
    let mut counts = Counts::default();
    for case in trees() {
        let (q, v, tau) = (&case.q[..], &case.speeds[..], &case.efforts[..]);
        let freedoms = case.mechanism.layout().freedoms;
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut inverse = InverseDerivatives::new(&case.mechanism);
        let mut forward = ForwardDerivatives::new(&case.mechanism);
        let mut hamiltonian = HamiltonianDerivatives::new(&case.mechanism);
        let mut steps = [Form::Lagrangian, Form::Hamiltonian]
            .map(|form| LinearStep::new(&case.mechanism, form, &Tableau::RK4));
        let mut gradients = [vec![0.0; freedoms], vec![0.0; freedoms]];
        counts.of("inverse_dynamics_derivatives", || {
            let found = dynamics.inverse_dynamics_derivatives(q, v, &case.rates, &mut inverse);
            found.expect("nothing else acts");
        });
        counts.of("forward_dynamics_derivatives", || {
            let found = dynamics.forward_dynamics_derivatives(q, v, tau, &mut forward);
            found.expect("every body has mass");
        });
        counts.of("hamiltonian_derivatives", || {
            let found = dynamics.hamiltonian_derivatives(q, v, tau, &mut hamiltonian);
            found.expect("every body has mass");
        });
        counts.of("energy_gradients", || {
            let [potential, kinetic] = &mut gradients;
            let found = dynamics.energy_gradients(q, v, potential, kinetic);
            found.expect("sizes fit");
        });
        counts.of("linearize", || {
            for step in &mut steps {
                let found = step.linearize(q, v, tau, 1.0 / 1024.0);
                found.expect("a short step");
            }
        });
        counts.of("entries", || {
            std::hint::black_box(inverse.by_local().entry(0, 0));
            std::hint::black_box(forward.by_efforts().entries());
        });
    }
    counts.assert_none(6);
}

#[test]
fn mass_matrices_do_not_allocate() {
    let mut counts = Counts::default();
    for case in trees() {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let mut mass = MassMatrix::new(&case.mechanism);
        let mut inverse = InverseMassMatrix::new(&case.mechanism);
        let mut x = case.speeds.clone();
        counts.of("inverse_mass_matrix", || {
            let found = dynamics.inverse_mass_matrix(&case.q, &mut inverse);
            found.expect("every body has mass");
        });
        counts.of("mass_matrix", || {
            dynamics.mass_matrix(&case.q, &mut mass).expect("sizes fit");
        });
        counts.of("factorize", || {
            mass.factorize(&case.mechanism)
                .expect("every body has mass");
        });
        counts.of("solve", || mass.solve(&mut x).expect("sizes fit"));
        counts.of("entry, size", || {
            std::hint::black_box(mass.entry(mass.size() - 1, 0));
        });
    }
    counts.assert_none(5);
}

#[test]
fn readings_do_not_allocate() {
    let mut counts = Counts::default();
    for case in trees() {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let size = case.speeds.len();
        let last = case.mechanism.bodies().len() - 1;
        let (mut matrix, mut efforts) = (vec![0.0; 6 * size], vec![0.0; size]);
        counts.of("centroidal_map", || {
            let filled = dynamics.centroidal_map(&case.q, &mut matrix);
            filled.expect("sizes fit");
        });
        counts.of("readings", || {
            dynamics.readings(&case.q, &case.speeds).expect("sizes fit");
        });
        let readings = dynamics.readings(&case.q, &case.speeds).expect("sizes fit");
        counts.of("poses, energies and momentum", || {
            readings.pose(last).expect("a body");
            let sums = (readings.kinetic_energy(), readings.potential_energy());
            std::hint::black_box((sums, readings.mass(), readings.momentum_com()));
        });
        for frame in [Frame::Body, Frame::World, Frame::WorldAligned] {
            counts.of("twist", || {
                readings.twist(last, frame).expect("a body");
            });
            counts.of("jacobian", || {
                let filled = readings.jacobian(last, frame, &mut matrix);
                filled.expect("sizes fit");
            });
            counts.of("products with the Jacobian", || {
                let twist = readings.jacobian_product(last, frame, &case.speeds);
                let wrench: Vector6<f64> = twist.expect("sizes fit");
                let made = readings.jacobian_transpose_product(last, frame, &wrench, &mut efforts);
                made.expect("sizes fit");
            });
        }
    }
    counts.assert_none(6);
}

/// The step of all integrations here, s.
const STEP: f64 = 1.0 / 1024.0;

/// One crossing that is recorded, in the third step; and one in each step that dense output is made for, but that is of no interest.
fn watched(integration: Integration<'_>) -> Integration<'_> {
    let once = Event::new("once", |t, _, _| t - 2.5 * STEP);
    (0..12).fold(integration.event(once), |integration, i| {
        let falling = move |t: f64, _: &[f64], _: &[f64]| (f64::from(i) + 0.3) * STEP - t;
        integration.event(Event::new("each", falling).rising())
    })
}

/// Allocations and steps of a whole integration.
fn integration(
    case: &Case,
    form: Form,
    (method, is_watched): (Method, bool),
    t_end: f64,
) -> (u64, Statistics) {
    let initial = State {
        time: 0.0,
        configuration: case.q.clone(),
        speeds: case.speeds.clone(),
    };
    let options = Options {
        form,
        method,
        t_end,
        samples: vec![],
    };
    let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
    let mut statistics = Statistics::default();
    let info = measure(|| {
        let mut integration = Integration::new(&mut dynamics, &initial, &options);
        if is_watched {
            integration = watched(integration);
        }
        let solution = integration.run().expect("short and smooth");
        assert_eq!(solution.events.len(), usize::from(is_watched));
        statistics = solution.statistics;
    });
    (info.count_total, statistics)
}

/// An integration of more steps allocates no more, whatever is looked for within them: what there is belongs to its beginning and its result.
#[test]
fn accepted_steps_do_not_allocate() {
    let controlled = Method::Controlled {
        scheme: Scheme::DormandPrince,
        control: StepControl {
            tolerance: 1e-3,
            max_step: STEP,
            first_step: Some(STEP),
        },
    };
    let methods = [
        (Method::rk4(STEP), false),
        (controlled, false),
        (controlled, true),
    ];
    let mut compared = 0;
    for case in trees() {
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            for method in methods {
                let (few, first) = integration(&case, form, method, 4.0 * STEP);
                let (many, second) = integration(&case, form, method, 12.0 * STEP);
                // A refused step says why, in words that it allocates.
                if first.rejected + second.rejected == 0 {
                    assert!(second.steps >= first.steps + 8);
                    // Two levels of the polynomial of order 5 in each step that is looked into.
                    let more = second.evaluations - first.evaluations;
                    assert_eq!(more > 70, method.1);
                    assert_eq!(few, many, "case {}, {form:?}, {method:?}", case.seed);
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 225, "{compared} of 288 comparisons");
}
