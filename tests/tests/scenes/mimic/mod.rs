//! Mimic joints: robots whose joints follow others exactly are the robots without `<mimic>`, with the coupling eliminated.
//!
//! In the robot without couplings every joint moves by itself, `y = G q + y₀` along the motions that couplings leave, with constant G. So
//! `M = Gᵀ M_free G`, poses are those at y, and accelerations a are those at which the efforts that the free robot needs, `Gᵀ τ_free(y, G v, G a)`, are what
//! acts. The free robot knows nothing of couplings: its equations share no code with them.

mod acting;
mod robots;

use hamel::dynamics::{Dynamics, MassMatrix, Recursive};
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::joint::Coupled;
use hamel::nalgebra::DVector;
use hamel_compiler::model::Model;
use hamel_scene::{Coupling, Located, Scene, SceneDescription};
use hamel_tests::compiled::{self, Functions, Point};
use hamel_tests::laws;
use robots::{ROBOTS, build, numbers, read};
use std::error::Error;
use std::sync::Arc;

type Outcome = Result<(), Box<dyn Error>>;

/// Rounding of sums over some hundred products times the conditions of these mass matrices, in units of the largest entry: fingers of 10 g on arms of 2 kg.
const ROUNDING: f64 = 1e-11;

#[track_caller]
fn close(what: &str, found: &DVector<f64>, expected: &DVector<f64>) {
    let error = (found - expected).amax() / expected.amax().max(1e-6);
    assert!(error <= ROUNDING, "{what}: {error:e}\n{found}{expected}");
}

#[test]
fn bodies_stand_where_they_do_without_couplings() {
    for robot in ROBOTS {
        let pair = robot.pair();
        for seed in 0..5 {
            let q = pair.configuration(seed);
            let v = DVector::from_vec(numbers(pair.coupled.layout().speeds, seed + 50));
            let found = pair.coupled.kinematics(&q, v.as_slice()).expect("finite");
            let (y, rates) = (pair.of_free(&q), &pair.map.rates * &v);
            let expected = pair
                .free
                .kinematics(y.as_slice(), rates.as_slice())
                .expect("finite");
            for (body, state) in pair.coupled.bodies().iter().zip(&found.bodies) {
                let same = pair
                    .free
                    .body_index(body.name())
                    .expect("a body of the same name");
                let wanted = &expected.bodies[same];
                let away = (state.pose.matrix() - wanted.pose.matrix()).amax();
                let faster = (state.twist - wanted.twist).amax();
                // Products of some ten poses, and velocities up to 10.
                assert!(
                    away < 1e-14 && faster < 1e-13,
                    "{}: {away:e}, {faster:e}",
                    body.name()
                );
            }
        }
    }
}

#[test]
fn both_forms_are_the_free_robot_with_the_coupling_eliminated() {
    for robot in ROBOTS {
        let pair = robot.pair();
        let map = &pair.map.rates;
        for seed in 0..5 {
            let q = pair.configuration(seed);
            let y = pair.of_free(&q);
            let v = DVector::from_vec(numbers(map.ncols(), seed + 50));
            let efforts = DVector::from_vec(numbers(map.ncols(), seed + 100));
            let mut free = Recursive::new(Arc::clone(&pair.free));
            let mut matrix = MassMatrix::new(&pair.free);
            free.mass_matrix(y.as_slice(), &mut matrix).expect("finite");
            let momenta = map.tr_mul(&(matrix.matrix() * (map * &v)));
            for mut form in pair.forms() {
                let mut found = DVector::zeros(v.len());
                form.momenta(&q, v.as_slice(), found.as_mut_slice())
                    .expect("finite");
                close(robot.name, &found, &momenta);
                form.forward_dynamics(&q, v.as_slice(), efforts.as_slice(), found.as_mut_slice())
                    .expect("regular");
                let (rates, rising) = (map * &v, map * &found);
                let mut needed = DVector::zeros(map.nrows());
                free.inverse_dynamics(
                    y.as_slice(),
                    rates.as_slice(),
                    rising.as_slice(),
                    needed.as_mut_slice(),
                )
                .expect("finite");
                close(robot.name, &map.tr_mul(&needed), &efforts);
            }
        }
    }
}

#[test]
fn momenta_change_as_velocities_do_in_both_forms() {
    for robot in ROBOTS {
        let pair = robot.pair();
        let q = pair.configuration(3);
        let momenta = numbers(pair.map.rates.ncols(), 7);
        let [found, expected] = pair.forms().map(|mut form| {
            let (mut speeds, mut rates) = (momenta.clone(), momenta.clone());
            let mut none = |_: &[f64], out: &mut [f64]| out.fill(0.0);
            form.momentum_rates(&q, &momenta, &mut none, &mut speeds, &mut rates)
                .expect("regular");
            speeds.extend(rates);
            DVector::from_vec(speeds)
        });
        close(robot.name, &found, &expected);
    }
}

#[test]
fn inverse_and_forward_dynamics_are_inverses() {
    for robot in ROBOTS {
        let pair = robot.pair();
        let q = pair.configuration(1);
        let size = pair.map.rates.ncols();
        let [v, efforts] = [11, 12].map(|seed| numbers(size, seed));
        let (mut rates, mut found) = (vec![0.0; size], vec![0.0; size]);
        let mut dynamics = Recursive::new(Arc::clone(&pair.coupled));
        dynamics
            .forward_dynamics(&q, &v, &efforts, &mut rates)
            .expect("regular");
        dynamics
            .inverse_dynamics(&q, &v, &rates, &mut found)
            .expect("finite");
        close(robot.name, &found.into(), &efforts.into());
    }
}

/// Without damping a robot keeps its energy for ten seconds, in both forms.
#[test]
fn energy_stays_for_ten_seconds() {
    const TOLERANCE: f64 = 1e-11;
    for robot in ROBOTS {
        let undamped: String = robot
            .text()
            .lines()
            .filter(|line| !line.contains("<dynamics"))
            .collect::<Vec<_>>()
            .join("\n");
        let scene = build(&read(&undamped, robot.name).scene);
        let mut speeds = vec![0.3; scene.speeds.len()];
        speeds[0] = -0.5;
        let start = State {
            speeds,
            ..scene.start()
        };
        let energy = |state: &State| {
            let found = scene
                .mechanism
                .kinematics(&state.configuration, &state.speeds);
            found.expect("finite").energy()
        };
        for form in [Form::Lagrangian, Form::Hamiltonian] {
            let options = Options {
                form,
                method: Method::dormand_prince(TOLERANCE),
                t_end: 10.0,
                samples: vec![],
            };
            let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
            let end = integrate(
                &mut dynamics,
                &start,
                &options,
                &mut no_inputs,
                &mut no_observer,
            );
            let end = end
                .unwrap_or_else(|error| panic!("{}: {error}", robot.name))
                .state;
            let drift = (energy(&end) - energy(&start)).abs();
            eprintln!("{}, {form:?}: the energy drifts by {drift:e} J", robot.name);
            // The errors of some thousand steps, of which each is held to the tolerance, in a motion that parts from its neighbours by up to e⁴ in ten
            // seconds; energies are of 10 J.
            assert!(drift < 1e5 * TOLERANCE, "{}: {drift:e} J", robot.name);
        }
    }
}

#[test]
fn compiled_couplings_are_those_of_the_tree() {
    for robot in ROBOTS {
        let description = robot.import().scene;
        let model = Model::new(&description, compiled::joint);
        let model = model.unwrap_or_else(|refused| panic!("{refused}"));
        let mechanism = build(&description).mechanism;
        let functions = Functions::new(&model);
        for seed in 0..2 {
            let point = || Point::random(model.clone(), &mechanism, seed);
            point().agrees_with(&functions);
            point().derivatives_agree_with(&functions);
        }
    }
}

/// The laws that the joints of the library are held to, by dual numbers, at random configurations: what X^c is of H, ∂X^c of X^c, P of the ports.
#[test]
fn kernels_of_couplings_obey_the_laws_of_joints() {
    fn check<const K: usize>(coupling: &Coupling) {
        let joint = Coupled::<K>::new(&coupling.links, coupling.ports).expect("links of a joint");
        for body in 0..coupling.links.len() {
            laws::check_all(&joint.member(body).expect("a body"));
        }
    }
    for robot in ROBOTS {
        let scene = robot.import().scene;
        let coupled = scene.coupled().expect("a coupling");
        let couplings = coupled
            .bodies
            .iter()
            .filter_map(|body| body.joint.coupling.as_ref());
        for coupling in couplings {
            match coupling.coordinates() {
                1 => check::<1>(coupling),
                2 => check::<2>(coupling),
                more => panic!("{}: {more} coordinates", robot.name),
            }
        }
    }
}

#[test]
fn ports_tell_angles_by_the_names_of_joints() {
    for robot in ROBOTS {
        let pair = robot.pair();
        let q = pair.configuration(2);
        let y = pair.of_free(&q);
        let (index, body) = pair
            .coupled
            .joints()
            .find(|(_, body)| body.joint_name() == robot.joint)
            .expect("the coupling");
        let values = pair
            .coupled
            .port_values(index, body.configuration(&q))
            .expect("finite");
        assert_eq!(values.len(), pair.coupled.carried(index).len());
        for (port, value) in body.joint().ports().iter().zip(values) {
            let joints = pair.free.joints();
            let mut named = joints.filter(|(_, own)| own.joint_name() == port.name);
            let (_, own) = named.next().expect("a joint of that name");
            let expected = y[own.ranges().configuration.start];
            // A chain of two laws multiplied out here, and there.
            assert!(
                (value - expected).abs() < 4e-16,
                "{}: {value} {expected}",
                port.name
            );
        }
    }
}

#[test]
fn robots_are_the_scenes_that_are_written_of_them() -> Outcome {
    let registry = hamel_joints::registry();
    for robot in ROBOTS {
        let import = robot.import();
        assert!(
            !import
                .notices
                .iter()
                .any(|notice| notice.to_string().contains("mimic")),
            "{}: {:?}",
            robot.name,
            import.notices
        );
        let text = import.to_toml();
        assert!(text.contains("mimic = { joint = "), "{text}");
        let again = Scene::from_toml(&text, "imported.toml")?;
        let mimics = |scene: &SceneDescription| -> Vec<_> {
            let mimics = scene.bodies.iter().filter_map(|body| body.mimic.clone());
            let told = mimics
                .map(|Located { value, .. }| (value.joint.value, value.multiplier, value.offset));
            told.collect()
        };
        assert_eq!(mimics(&again), mimics(&import.scene));
        let (written, built) = (again.build(&registry)?, import.build(&registry)?);
        let mut rates = [written, built].map(|scene| {
            let size = scene.speeds.len();
            let mut rates = vec![0.0; size];
            let mut dynamics = Recursive::new(Arc::clone(&scene.mechanism));
            let efforts = numbers(size, 5);
            dynamics
                .forward_dynamics(
                    &scene.configuration,
                    &numbers(size, 6),
                    &efforts,
                    &mut rates,
                )
                .expect("regular");
            DVector::from_vec(rates)
        });
        let [found, expected] = &mut rates;
        close(robot.name, found, expected);
    }
    Ok(())
}
