//! Mimic joints: robots whose joints follow others exactly are the robots without `<mimic>`, with the coupling eliminated.
//!
//! In the robot without couplings every joint moves by itself, `y = G q + y₀` along the motions that couplings leave, with constant G. So
//! `M = Gᵀ M_free G`, poses are those at y, and accelerations a are those at which the efforts that the free robot needs, `Gᵀ τ_free(y, G v, G a)`, are what
//! acts. The free robot knows nothing of couplings: its equations share no code with them.

use super::trials::{FORMS, fine_methods, run, scene, slide, times};
use hamel::dynamics::{Dynamics, MassMatrix, Recursive, Reference};
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::joint::Coupled;
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{DMatrix, DVector};
use hamel_compiler::model::Model;
use hamel_scene::urdf::{self, Import};
use hamel_scene::{Coupling, Located, Scene, SceneDescription};
use hamel_tests::compiled::{self, Point};
use hamel_tests::laws;
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

type Outcome = Result<(), Box<dyn Error>>;

/// A follower, what it follows, the multiplier and the offset: as the file has them, those of a chain multiplied out.
type Law = (&'static str, &'static str, f64, f64);

/// A robot, the joint that its coupling is, and who follows whom.
struct Robot {
    name: &'static str,
    joint: &'static str,
    laws: &'static [Law],
}

const ROBOTS: [Robot; 4] = [
    Robot {
        name: "parallel_gripper",
        joint: "left",
        laws: &[("right", "left", -1.0, 0.0)],
    },
    Robot {
        name: "adaptive_gripper",
        joint: "finger_joint",
        laws: &[
            ("left_inner_knuckle_joint", "finger_joint", 1.0, 0.0),
            ("left_inner_finger_joint", "finger_joint", -1.0, 0.0),
            ("right_outer_knuckle_joint", "finger_joint", 1.0, 0.0),
            ("right_inner_knuckle_joint", "finger_joint", 1.0, 0.0),
            ("right_inner_finger_joint", "finger_joint", -1.0, 0.0),
        ],
    },
    Robot {
        name: "tendon_finger",
        joint: "knuckle",
        laws: &[
            ("pip", "knuckle", 1.1, 0.05),
            ("dip", "knuckle", 0.67 * 1.1, 0.67 * 0.05 - 0.02),
        ],
    },
    Robot {
        name: "two_limbs",
        joint: "swing+crank",
        laws: &[("rack", "crank", 0.11, 0.04)],
    },
];

/// Rounding of sums over some hundred products times the conditions of these mass matrices, in units of the largest entry: fingers of 10 g on arms of 2 kg.
const ROUNDING: f64 = 1e-11;

impl Robot {
    fn text(&self) -> String {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/urdf/mimic");
        let path = folder.join(format!("{}.urdf", self.name));
        std::fs::read_to_string(path).expect("a robot of the tests")
    }

    fn import(&self) -> Import {
        read(&self.text(), self.name)
    }

    /// The robot whose joints all move by themselves.
    fn free(&self) -> Arc<Mechanism> {
        let lines = self.text();
        let lines = lines.lines().filter(|line| !line.contains("<mimic"));
        let text: Vec<&str> = lines.collect();
        build(&read(&text.join("\n"), self.name).scene).mechanism
    }

    fn pair(&self) -> Pair {
        let coupled = build(&self.import().scene).mechanism;
        let free = self.free();
        let map = self.map(&coupled, &free);
        Pair { coupled, free, map }
    }

    /// Where a joint's first freedom stands among those of the coupled robot, and its first scalar in Q.
    fn place(&self, coupled: &Mechanism, joint: &str) -> (usize, usize) {
        let named = |name: &str| coupled.joints().find(|(_, body)| body.joint_name() == name);
        if let Some((_, body)) = named(joint) {
            let ranges = body.ranges();
            return (ranges.freedoms.start, ranges.configuration.start);
        }
        let (_, coupling) =
            named(self.joint).expect("the coupling has the name of what is followed");
        let number = self.joint.split('+').position(|name| name == joint);
        let number = number.unwrap_or_else(|| panic!("no joint {joint}"));
        let ranges = coupling.ranges();
        (
            ranges.freedoms.start + number,
            ranges.configuration.start + number,
        )
    }

    fn map(&self, coupled: &Mechanism, free: &Mechanism) -> Map {
        let (rows, columns) = (free.layout().freedoms, coupled.layout().freedoms);
        let mut map = Map {
            rates: DMatrix::zeros(rows, columns),
            scalars: DMatrix::zeros(free.layout().configuration, coupled.layout().configuration),
            offset: DVector::zeros(free.layout().configuration),
        };
        for (_, body) in free.joints() {
            let (own, ranges) = (body.joint_name(), body.ranges());
            let law = self.laws.iter().find(|(follower, ..)| *follower == own);
            let (leader, ratio, offset) = match law {
                Some((_, leader, ratio, offset)) => (*leader, *ratio, *offset),
                None => (own, 1.0, 0.0),
            };
            let (freedom, scalar) = self.place(coupled, leader);
            for (n, row) in ranges.freedoms.clone().enumerate() {
                map.rates[(row, freedom + n)] = ratio;
            }
            for (n, row) in ranges.configuration.clone().enumerate() {
                map.scalars[(row, scalar + n)] = ratio;
                map.offset[row] = offset;
            }
        }
        map
    }
}

fn read(text: &str, name: &str) -> Import {
    let options = urdf::Options::default();
    urdf::read(text, name, &options).unwrap_or_else(|errors| panic!("{errors}"))
}

fn build(scene: &SceneDescription) -> Scene {
    let built = scene.build(&hamel_joints::registry());
    built.unwrap_or_else(|errors| panic!("{errors}"))
}

/// How motions of the coupled robot are motions of the free one.
struct Map {
    /// G.
    rates: DMatrix<f64>,
    /// The same for the stored scalars of Q, with y₀.
    scalars: DMatrix<f64>,
    offset: DVector<f64>,
}

struct Pair {
    coupled: Arc<Mechanism>,
    free: Arc<Mechanism>,
    map: Map,
}

/// Numbers in waves, another for each seed.
fn numbers(count: usize, seed: u32) -> Vec<f64> {
    let phase = 0.3 + 1.9 * f64::from(seed);
    (0..count).map(|i| (1.7 * i as f64 + phase).sin()).collect()
}

impl Pair {
    fn configuration(&self, seed: u32) -> Vec<f64> {
        let phi = numbers(self.coupled.layout().freedoms, seed);
        let joints = self.coupled.joints();
        let q = joints.flat_map(|(index, body)| {
            let own = &phi[body.ranges().freedoms.clone()];
            self.coupled
                .configuration_from_local(index, own)
                .expect("finite")
        });
        q.collect()
    }

    fn of_free(&self, q: &[f64]) -> DVector<f64> {
        &self.map.scalars * DVector::from_column_slice(q) + &self.map.offset
    }

    fn forms(&self) -> [Box<dyn Dynamics>; 2] {
        [
            Box::new(Recursive::new(Arc::clone(&self.coupled))),
            Box::new(Reference::new(Arc::clone(&self.coupled))),
        ]
    }
}

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
        for seed in 0..2 {
            let point = || Point::random(model.clone(), &mechanism, seed);
            point().agrees();
            point().derivatives_agree();
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

/// Two slides along one line, of which one follows the other by −2 q + 0.3, with everything that can act at either.
fn slides(leader: &str, follower: &str) -> Scene {
    let body = |name: &str, mass: f64, keys: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"world\"\nmass = {mass:?}\njoint = {{ type = \"prismatic\" }}\n\
             inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]\n{keys}\n"
        )
    };
    let mimic = "mimic = { joint = \"a\", multiplier = -2.0, offset = 0.3 }\n";
    scene(&(body("b", 0.5, &format!("{mimic}{follower}")) + &body("a", 1.0, leader)))
}

/// At a leader, at its follower, and at one slide of 2 kg that does as both: its armature of 1 kg makes the mass of 1 kg and four times 0.5 kg.
const ACTING: [[&str; 3]; 6] = [
    // 8 (q − 0.1) − 2 · 3 (−2 q + 0.3 − 0.5) = 20 (q + 0.02).
    [
        "spring = { stiffness = 8.0, rest = { phi = [0.1] } }\ndamping = 0.5\narmature = 0.25",
        "spring = { stiffness = 3.0, rest = { phi = [0.5] } }\ndamping = 0.2\narmature = 0.5",
        "spring = { stiffness = 20.0, rest = { phi = [-0.02] } }\ndamping = 1.3\narmature = 3.25",
    ],
    [
        "effort = [\"0.3 * sin(3 * t)\"]",
        "effort = [\"0.2 * cos(t)\"]",
        "effort = [\"0.3 * sin(3 * t) - 0.4 * cos(t)\"]\narmature = 1.0",
    ],
    [
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { upper = 0.12, stiffness = 300.0, damping = 0.2 }",
        "",
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { upper = 0.12, stiffness = 300.0, damping = 0.2 }\narmature = 1.0",
    ],
    // The follower is at 0.1 where its leader is at 0.1.
    [
        "effort = [\"4 * cos(5 * t)\"]",
        "limit = { lower = 0.1, stiffness = 80.0, damping = 0.1 }",
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { upper = 0.1, stiffness = 320.0, damping = 0.2 }\narmature = 1.0",
    ],
    [
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { lower = -0.5, upper = 0.3, restitution = 0.5 }",
        "limit = { lower = 0.1, restitution = 0.5 }",
        "effort = [\"4 * cos(5 * t)\"]\nlimit = { lower = -0.5, upper = 0.1, restitution = 0.5 }\narmature = 1.0",
    ],
    [
        "effort = [\"2 * cos(2 * t)\"]\nfriction = 0.3",
        "friction = { sliding = 0.2, sticking = 0.4 }",
        "effort = [\"2 * cos(2 * t)\"]\nfriction = { sliding = 0.7, sticking = 1.1 }\narmature = 1.0",
    ],
];

/// What acts at a follower acts at what it follows, times the multiplier; stiffness, damping and inertia times its square.
#[test]
fn what_acts_at_a_follower_acts_at_what_it_follows() {
    const START: &str = "initial = { phi = [0.05], speeds = [0.3] }";
    for [leader, follower, alone] in ACTING {
        let coupled = slides(&format!("{START}\n{leader}"), follower);
        let alone = slide(&format!("{START}\n{alone}"));
        for form in FORMS {
            let [method, ..] = fine_methods(1e-3);
            let samples = times(2.0);
            let [found, expected] =
                [&coupled, &alone].map(|scene| run(scene, form, method, &samples));
            let pairs = found.samples.iter().zip(&expected.samples);
            let away = pairs.map(|(a, b)| (a.configuration[0] - b.configuration[0]).abs());
            let away = away.fold(0.0, f64::max);
            // Steps of both are held to 1e-12, some hundred of them, and impacts part what is near by a factor of ten.
            assert!(away < 1e-9, "{leader}, {follower}, {form:?}: {away:e}");
        }
    }
}

#[test]
fn a_prescribed_motion_is_that_of_the_follower_too() {
    let driven = slides(
        "motion = { speeds = [{ amplitude = 0.4, frequency = 2.0 }] }",
        "",
    );
    let [method, ..] = fine_methods(1e-3);
    let found = run(&driven, Form::Lagrangian, method, &times(2.0));
    let index = driven.mechanism.body_index("b").expect("the follower");
    for state in &found.samples {
        let bodies = driven
            .mechanism
            .kinematics(&state.configuration, &state.speeds);
        let bodies = bodies.expect("finite");
        let twice = -2.0 * state.speeds[0];
        assert!((bodies.bodies[index].twist[5] - twice).abs() < 1e-15);
        let place = -2.0 * state.configuration[0] + 0.3;
        assert!((bodies.bodies[index].pose.translation.z - place).abs() < 1e-15);
    }
}
