//! Many states of a compiled scene at once (`hamel::compiled::Batch`), with modules of the build script.

use allocation_counter::measure;
use chacha20::ChaCha8Rng;
use hamel::compiled::{Batch, Entry, Equations, InLanes, LANES, Lanes, Level};
use hamel::dynamics::{Dynamics, MassMatrix, Recursive};
use hamel::mechanism::Mechanism;
use hamel_emitted::{linkages, loops, plate_cart_arm as module, walker};
use hamel_scene::Scene;
use hamel_tests::{random, scenes};
use rand::SeedableRng;
use std::path::Path;
use std::sync::Arc;

/// A module as it would be without lanes.
const fn one_by_one(equations: Equations) -> Equations {
    Equations {
        in_lanes: InLanes::NONE,
        ..equations
    }
}

/// A module, the same without lanes, and its scene.
struct Subject {
    equations: &'static Equations,
    one_by_one: &'static Equations,
    mechanism: Arc<Mechanism>,
}

/// A scene of the library's joints, loops on a base that moves, loops within joints with rotors at ports, and two chains whose derivatives are written pair by pair.
fn subjects() -> [Subject; 4] {
    static ONE_BY_ONE: [Equations; 4] = [
        one_by_one(module::EQUATIONS),
        one_by_one(loops::EQUATIONS),
        one_by_one(linkages::EQUATIONS),
        one_by_one(walker::EQUATIONS),
    ];
    let own = |name: &str| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/scenes");
        let scene = Scene::load(folder.join(name), &hamel_joints::registry());
        scene.unwrap_or_else(|errors| panic!("{errors}")).mechanism
    };
    let subject = |number: usize, equations, mechanism| Subject {
        equations,
        one_by_one: &ONE_BY_ONE[number],
        mechanism,
    };
    let arm = scenes::load("plate_cart_arm").mechanism;
    [
        subject(0, &module::EQUATIONS, arm),
        subject(1, &loops::EQUATIONS, own("loops.toml")),
        subject(2, &linkages::EQUATIONS, own("linkages.toml")),
        subject(3, &walker::EQUATIONS, own("walker.toml")),
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
        let [subject, ..] = subjects();
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

    /// The condition of M̄ in each state.
    fn conditions(&self, mechanism: &Arc<Mechanism>) -> Vec<f64> {
        let mut tree = Recursive::new(Arc::clone(mechanism));
        let mut mass = MassMatrix::new(mechanism);
        let states = self.q.chunks(self.equations.configuration);
        let conditions = states.map(|q| {
            tree.mass_matrix(q, &mut mass).expect("sizes fit");
            let eigenvalues = mass.matrix().symmetric_eigenvalues();
            eigenvalues.max() / eigenvalues.min()
        });
        conditions.collect()
    }

    /// Results of all functions that the module has.
    fn run(&self, batch: &Batch) -> Vec<Results> {
        let rows = Rows {
            q: self.q.clone(),
            v: self.v.clone(),
            tau: self.tau.clone(),
            a: self.accelerations().to_vec(),
        };
        self.run_rows(batch, &rows, self.count)
    }

    /// The same of states that lie side by side.
    fn run_side_by_side(&self, batch: &Batch) -> Vec<Results> {
        let equations = self.equations;
        let rows = Rows {
            q: Lanes::side_by_side(&self.q, equations.configuration),
            v: Lanes::side_by_side(&self.v, equations.speeds),
            tau: Lanes::side_by_side(&self.tau, equations.freedoms),
            a: Lanes::side_by_side(self.accelerations(), equations.speeds),
        };
        let mut found = vec![];
        let groups = self.count.div_ceil(LANES);
        for results in self.run_rows(batch, &rows, groups) {
            let states = Lanes::apart(&results.rows, results.width);
            found.push(Results {
                name: results.name,
                width: results.width,
                rows: states[..self.count * results.width].to_vec(),
            });
        }
        found
    }

    fn run_rows<N: Entry + Default>(
        &self,
        batch: &Batch,
        rows: &Rows<N>,
        count: usize,
    ) -> Vec<Results<N>> {
        let Rows { q, v, tau, a } = rows;
        let widths = widths(self.equations);
        let found = widths.into_iter().map(|(name, width, in_lanes)| {
            let mut rows = vec![N::default(); count * width];
            let counted = measure(|| {
                let done = match name {
                    "forward" => batch.forward_dynamics(q, v, tau, &mut rows),
                    "inverse" => batch.inverse_dynamics(q, v, a, &mut rows),
                    "forward slopes" => batch.forward_dynamics_derivatives(q, v, tau, &mut rows),
                    "inverse slopes" => batch.inverse_dynamics_derivatives(q, v, a, &mut rows),
                    "mass" => batch.mass_matrix(q, &mut rows),
                    _ => batch.inverse_mass_matrix(q, &mut rows),
                };
                done.expect("sizes fit");
            });
            // What takes states that lie side by side one by one allocates.
            if in_lanes || N::STATES == 1 {
                assert_eq!(counted.count_total, 0, "{name}");
            }
            Results { name, width, rows }
        });
        found.collect()
    }
}

/// Arguments of many states.
struct Rows<N> {
    q: Vec<N>,
    v: Vec<N>,
    tau: Vec<N>,
    a: Vec<N>,
}

/// What one function leaves, so many numbers a state.
#[derive(Debug, PartialEq)]
struct Results<N = f64> {
    name: &'static str,
    width: usize,
    rows: Vec<N>,
}

/// The functions that a module has, how many numbers they leave, and whether it has them in lanes.
fn widths(equations: &Equations) -> Vec<(&'static str, usize, bool)> {
    let Equations {
        freedoms,
        speeds,
        in_lanes: lanes,
        ..
    } = *equations;
    let (forward_slopes, inverse_slopes) = (
        equations.forward_dynamics_derivatives,
        equations.inverse_dynamics_derivatives,
    );
    let all = [
        (
            "forward",
            equations.forward_dynamics.map(|_| speeds),
            lanes.forward_dynamics,
        ),
        (
            "inverse",
            equations.inverse_dynamics.map(|_| speeds),
            lanes.inverse_dynamics,
        ),
        (
            "forward slopes",
            forward_slopes.map(|_| equations.forward_slopes),
            lanes.forward_dynamics_derivatives,
        ),
        (
            "inverse slopes",
            inverse_slopes.map(|_| speeds * (freedoms + speeds)),
            lanes.inverse_dynamics_derivatives,
        ),
        (
            "mass",
            equations.mass_matrix.map(|_| speeds * speeds),
            lanes.mass_matrix,
        ),
        (
            "inverse mass",
            equations.inverse_mass_matrix.map(|_| speeds * speeds),
            lanes.inverse_mass_matrix,
        ),
    ];
    let there = all
        .into_iter()
        .filter_map(|(name, width, in_lanes)| width.map(|width| (name, width, in_lanes.is_some())));
    there.collect()
}

/// The bound of a function's errors: of what is solved for with M̄, 10 roundings for each unit of its condition where that is more, as in the test `compiled`.
fn bound(function: &str, condition: f64) -> f64 {
    match function {
        "forward" | "forward slopes" | "inverse mass" => {
            ROUNDINGS.max(10.0 * condition * f64::EPSILON)
        }
        _ => ROUNDINGS,
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
        let conditions = states.conditions(&subject.mechanism);
        for level in Level::ALL.into_iter().filter(|level| level.is_available()) {
            let batch = Batch::at(subject.equations, level).expect("it is available");
            let found = states.run(&batch);
            for (found, expected) in found.iter().zip(&expected) {
                for (state, condition) in conditions.iter().enumerate() {
                    let row = state * found.width..(state + 1) * found.width;
                    let (scene, name) = (subject.equations.scene, found.name);
                    let what = format!("{scene}, {name}, {level:?}, state {state}");
                    let (found, expected) = (&found.rows[row.clone()], &expected.rows[row]);
                    let bound = bound(name, *condition);
                    assert_close(found, expected, bound, &what);
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
        let found = states.run(&Batch::new(equations));
        let [rates, efforts] = ["forward", "inverse"].map(|name| {
            let mut all = found.iter();
            all.find(|results| results.name == name)
                .map(|results| &results.rows)
        });
        let (Some(rates), Some(efforts)) = (rates, efforts) else {
            continue;
        };
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
        assert_eq!([&rates, &efforts], [&expected[0].rows, &expected[1].rows]);
        let mut slopes = vec![0.0; states.count * module::EQUATIONS.forward_slopes];
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let done = batch.par_forward_dynamics_derivatives(q, v, &states.tau, &mut slopes);
            done.expect("sizes fit");
        });
        assert_eq!(slopes, expected[2].rows);
    }
    for count in [1, 7, 8, 9, 130] {
        let few = States {
            count,
            equations: states.equations,
            q: states.q[..count * module::CONFIGURATION].to_vec(),
            v: states.v[..count * module::SPEEDS].to_vec(),
            tau: states.tau[..count * module::FREEDOMS].to_vec(),
        };
        for (few, all) in few.run(&batch).iter().zip(&expected) {
            assert_eq!(few.rows, all.rows[..count * all.width], "{}", all.name);
        }
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
