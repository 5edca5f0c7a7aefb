//! Many states of a compiled scene at once (`hamel::compiled::Batch`), with modules of the build script.

use allocation_counter::measure;
use chacha20::ChaCha8Rng;
use hamel::compiled::{Batch, Equations, InLanes, Lanes, Level};
use hamel::dynamics::{Dynamics, Recursive};
use hamel::mechanism::Mechanism;
use hamel_scene::Scene;
use hamel_tests::emitted::{loops, plate_cart_arm as module};
use hamel_tests::{random, scenes};
use rand::SeedableRng;
use std::path::Path;
use std::sync::Arc;

/// A module as it would be without lanes.
const fn one_by_one(equations: Equations) -> Equations {
    Equations {
        in_lanes: InLanes {
            forward_dynamics: None,
            inverse_dynamics: None,
        },
        ..equations
    }
}

/// A module, the same without lanes, and its scene.
struct Subject {
    equations: &'static Equations,
    one_by_one: &'static Equations,
    mechanism: Arc<Mechanism>,
}

/// A scene of the library's joints, and loops on a base that moves.
fn subjects() -> [Subject; 2] {
    static ONE_BY_ONE: [Equations; 2] =
        [one_by_one(module::EQUATIONS), one_by_one(loops::EQUATIONS)];
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let closed = Scene::load(
        folder.join("data/scenes/loops.toml"),
        &hamel_joints::registry(),
    );
    let closed = closed.unwrap_or_else(|errors| panic!("{errors}"));
    [
        Subject {
            equations: &module::EQUATIONS,
            one_by_one: &ONE_BY_ONE[0],
            mechanism: scenes::load("plate_cart_arm").mechanism,
        },
        Subject {
            equations: &loops::EQUATIONS,
            one_by_one: &ONE_BY_ONE[1],
            mechanism: closed.mechanism,
        },
    ]
}

/// Roundings by which lanes may differ from single states, relative to the largest entry: some hundred operations of a well-conditioned
/// system, fused or not.
const ROUNDINGS: f64 = 1e3 * f64::EPSILON;

/// Random states, one after the other.
struct States {
    equations: &'static Equations,
    count: usize,
    q: Vec<f64>,
    v: Vec<f64>,
    tau: Vec<f64>,
}

impl States {
    fn new(count: usize) -> Self {
        let [subject, _] = subjects();
        Self::of(&subject, count)
    }

    fn of(subject: &Subject, count: usize) -> Self {
        let Subject {
            equations,
            mechanism,
            ..
        } = subject;
        let mut random = ChaCha8Rng::seed_from_u64(count as u64);
        let q = (0..count).flat_map(|_| random::configuration(&mut random, mechanism));
        let q = q.collect();
        Self {
            equations,
            count,
            q,
            v: random::numbers(&mut random, count * equations.speeds),
            tau: random::numbers(&mut random, count * equations.freedoms),
        }
    }

    /// As many accelerations as speeds.
    fn accelerations(&self) -> &[f64] {
        &self.tau[..self.v.len()]
    }

    /// Results of both functions.
    fn run(&self, batch: &Batch) -> [Vec<f64>; 2] {
        let (mut rates, mut efforts) = (vec![f64::NAN; self.v.len()], vec![f64::NAN; self.v.len()]);
        let done = batch.forward_dynamics(&self.q, &self.v, &self.tau, &mut rates);
        done.expect("sizes fit");
        let done = batch.inverse_dynamics(&self.q, &self.v, self.accelerations(), &mut efforts);
        done.expect("sizes fit");
        [rates, efforts]
    }

    /// The same of states that lie side by side.
    fn run_side_by_side(&self, batch: &Batch) -> [Vec<f64>; 2] {
        let q = Lanes::side_by_side(&self.q, self.equations.configuration);
        let v = Lanes::side_by_side(&self.v, self.equations.speeds);
        let tau = Lanes::side_by_side(&self.tau, self.equations.freedoms);
        let a = Lanes::side_by_side(self.accelerations(), self.equations.speeds);
        let (mut rates, mut efforts) = (v.clone(), v.clone());
        let counted = measure(|| {
            let done = batch.forward_dynamics(&q, &v, &tau, &mut rates);
            done.expect("sizes fit");
            let done = batch.inverse_dynamics(&q, &v, &a, &mut efforts);
            done.expect("sizes fit");
        });
        assert_eq!(counted.count_total, 0);
        [rates, efforts]
            .map(|lanes| Lanes::apart(&lanes, self.equations.speeds)[..self.v.len()].to_vec())
    }
}

fn assert_close(found: &[f64], expected: &[f64], bound: f64, what: &str) {
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= bound * largest, "{what}: {a} {b}");
    }
}

#[test]
fn a_batch_is_its_states_one_by_one_at_every_level() {
    for subject in subjects() {
        let states = States::of(&subject, 77);
        let expected = states.run(&Batch::new(subject.one_by_one));
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let batch = Batch::at(subject.equations, level).expect("it is available");
            let found = states.run(&batch);
            for (found, expected) in found.iter().zip(&expected) {
                for state in 0..states.count {
                    let speeds = subject.equations.speeds;
                    let row = state * speeds..(state + 1) * speeds;
                    let what = format!("{}, {level:?}, state {state}", subject.equations.scene);
                    assert_close(&found[row.clone()], &expected[row], ROUNDINGS, &what);
                }
            }
        }
    }
}

#[test]
fn states_side_by_side_have_the_numbers_of_states_in_rows() {
    for subject in subjects() {
        let states = States::of(&subject, 29);
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let batch = Batch::at(subject.equations, level).expect("it is available");
            assert_eq!(states.run_side_by_side(&batch), states.run(&batch));
        }
    }
}

#[test]
fn a_batch_is_what_the_tree_computes() {
    for subject in subjects() {
        let states = States::of(&subject, 21);
        let mut tree = Recursive::new(Arc::clone(&subject.mechanism));
        let equations = subject.equations;
        let [rates, efforts] = states.run(&Batch::new(equations));
        let mut expected = vec![0.0; equations.speeds];
        let q = states.q.chunks(equations.configuration);
        let tau = states.tau.chunks(equations.freedoms);
        let rows = q
            .zip(states.v.chunks(equations.speeds))
            .zip(tau)
            .enumerate();
        for (state, ((q, v), tau)) in rows {
            let row = state * equations.speeds..(state + 1) * equations.speeds;
            let done = tree.forward_dynamics(q, v, tau, &mut expected);
            done.expect("the scene is sound");
            assert_close(&rates[row.clone()], &expected, ROUNDINGS, equations.scene);
            let accelerations = &states.accelerations()[row.clone()];
            let done = tree.inverse_dynamics(q, v, accelerations, &mut expected);
            done.expect("the scene is sound");
            assert_close(&efforts[row], &expected, ROUNDINGS, equations.scene);
        }
    }
}

#[test]
fn threads_and_the_number_of_states_do_not_show() {
    let states = States::new(1030);
    let batch = Batch::new(&module::EQUATIONS);
    let expected = states.run(&batch);
    for threads in [1, 2, 5] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let (mut rates, mut efforts) = (vec![0.0; states.v.len()], vec![0.0; states.v.len()]);
        let (q, v, a) = (&states.q, &states.v, states.accelerations());
        pool.expect("threads").install(|| {
            let done = batch.par_forward_dynamics(q, v, &states.tau, &mut rates);
            done.expect("sizes fit");
            let done = batch.par_inverse_dynamics(q, v, a, &mut efforts);
            done.expect("sizes fit");
        });
        assert_eq!([rates, efforts], expected);
    }
    for count in [1, 7, 8, 9, 130] {
        let few = States {
            count,
            equations: states.equations,
            q: states.q[..count * module::CONFIGURATION].to_vec(),
            v: states.v[..count * module::SPEEDS].to_vec(),
            tau: states.tau[..count * module::FREEDOMS].to_vec(),
        };
        let [rates, _] = few.run(&batch);
        assert_eq!(rates, expected[0][..count * module::SPEEDS]);
    }
}

#[test]
fn sizes_that_do_not_fit_are_all_named() {
    let states = States::new(3);
    let batch = Batch::new(&module::EQUATIONS);
    let mut rates = vec![0.0; states.v.len() - 1];
    let short = &states.tau[2..];
    let error = batch.forward_dynamics(&states.q, &states.v, short, &mut rates);
    assert_eq!(
        error.expect_err("sizes differ").to_string(),
        "a batch of 3 rows of `plate_cart_arm`: efforts must have 21 numbers, not 19; rates must have 18 numbers, not 17"
    );
}

#[test]
fn a_batch_does_not_allocate() {
    let states = States::new(50);
    let batch = Batch::new(&module::EQUATIONS);
    let mut rates = vec![0.0; states.v.len()];
    let counted = measure(|| {
        let done = batch.forward_dynamics(&states.q, &states.v, &states.tau, &mut rates);
        done.expect("sizes fit");
    });
    assert_eq!(counted.count_total, 0);
}
