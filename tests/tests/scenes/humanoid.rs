//! A humanoid whose knees and ankles are driven through loops (`scenes/humanoid.toml`): all equations agree along its motion, loops stay closed, energy
//! stays, and with links that have no mass it is the plain tree (`scenes/humanoid_tree.toml`).

use hamel::compiled::Compiled;
use hamel::dynamics::{Dynamics, ForwardDerivatives, MassMatrix, Recursive, Reference, Refined};
use hamel::integrate::{Form, Method, Options, Scheme, Solution, State, integrate};
use hamel::integrate::{no_inputs, no_observer};
use hamel::mechanism::Mechanism;
use hamel_emitted::humanoid::EQUATIONS;
use hamel_scene::Scene;
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::scenes::load;
use std::path::Path;
use std::sync::Arc;

const TOLERANCE: f64 = 1e-10;
const FORMS: [Form; 2] = [Form::Lagrangian, Form::Hamiltonian];

/// Degrees of freedom of both robots: pelvis, torso, arms, legs.
const FREEDOMS: usize = 6 + 1 + 2 * 4 + 2 * (3 + 1 + 2);

fn recursive(scene: &Scene) -> Recursive {
    Recursive::new(Arc::clone(&scene.mechanism))
}

fn compiled(scene: &Scene) -> Compiled {
    Compiled::new(Arc::clone(&scene.mechanism), &EQUATIONS).expect("its scene")
}

/// The motion of a scene, from its start to its end.
fn motion(scene: &Scene, dynamics: &mut dyn Dynamics, form: Form) -> Solution {
    let end = scene.settings.t_end;
    let options = Options {
        form,
        method: Method::controlled(Scheme::Verner9, TOLERANCE),
        t_end: end,
        samples: (0..=10).map(|i| end * f64::from(i) / 10.0).collect(),
    };
    let start = scene.start();
    let solution = integrate(dynamics, &start, &options, &mut no_inputs, &mut no_observer);
    solution.unwrap_or_else(|error| panic!("{}: {error}", scene.name))
}

/// v̄̇ without inputs.
fn accelerations(dynamics: &mut dyn Dynamics, state: &State) -> Vec<f64> {
    let layout = *dynamics.mechanism().layout();
    let (efforts, mut rates) = (vec![0.0; layout.freedoms], vec![0.0; layout.speeds]);
    let (q, speeds) = (&state.configuration, &state.speeds);
    let solved = dynamics.forward_dynamics(q, speeds, &efforts, &mut rates);
    solved.expect("regular");
    rates
}

/// How accelerations are compared: in units in which the diagonal of M̄ is 1, since a solution with M̄ does not depend on those of the speeds.
struct Measure {
    scales: Vec<f64>,
    /// How far solutions of equal equations may be apart, relative to the largest acceleration: ten roundings for each unit of the condition of M̄, what they are held to
    /// everywhere (`docs/compile.md`).
    solved: f64,
    /// The same where equations place bodies by other sums: also what ten roundings of 1 m and of 1 rad do. The soles are springs of 2.4e5 N/m under light feet.
    placed: f64,
}

impl Measure {
    fn new(mechanism: &Arc<Mechanism>, state: &State) -> Self {
        let mut dynamics = Recursive::new(Arc::clone(mechanism));
        let (q, speeds) = (&state.configuration, &state.speeds);
        let mut mass = MassMatrix::new(mechanism);
        let found = dynamics.mass_matrix(q, &mut mass);
        found.expect("sizes fit");
        let mass = mass.matrix();
        let scales: Vec<f64> = mass.diagonal().iter().map(|entry| entry.sqrt()).collect();
        let scaled = mass.map_with_location(|i, j, entry| entry / (scales[i] * scales[j]));
        let own = scaled.symmetric_eigenvalues();

        let efforts = vec![0.0; mechanism.layout().freedoms];
        let mut slopes = ForwardDerivatives::new(mechanism);
        let found = dynamics.forward_dynamics_derivatives(q, speeds, &efforts, &mut slopes);
        found.expect("regular");
        let rows = slopes.by_local().matrix();
        let moved = rows.row_iter().zip(&scales);
        let moved = moved.map(|(row, scale)| scale * row.lp_norm(1));
        let moved = moved.fold(0.0, f64::max);
        let largest = slopes
            .rates()
            .iter()
            .zip(&scales)
            .map(|(rate, scale)| (rate * scale).abs());
        let largest = largest.fold(0.0, f64::max);
        let solved = 10.0 * f64::EPSILON * own.max() / own.min();
        Self {
            scales,
            solved,
            placed: solved + 10.0 * f64::EPSILON * moved / largest,
        }
    }

    fn scaled(&self, rates: &[f64]) -> Vec<f64> {
        let both = rates.iter().zip(&self.scales);
        both.map(|(rate, scale)| rate * scale).collect()
    }
}

#[test]
fn all_equations_agree_along_the_motion() {
    let scene = load("humanoid");
    let mechanism = || Arc::clone(&scene.mechanism);
    let states = motion(&scene, &mut compiled(&scene), Form::Lagrangian).samples;
    let mut refined = Refined::new(mechanism());
    let mut forms: [(&str, Box<dyn Dynamics>); 3] = [
        ("tree", Box::new(recursive(&scene))),
        ("reference", Box::new(Reference::new(mechanism()))),
        ("compiled", Box::new(compiled(&scene))),
    ];
    let mut worst = Largest::new("accelerations of a humanoid, in parts of its bound");
    for state in &states {
        let measure = Measure::new(&scene.mechanism, state);
        let expected = measure.scaled(&accelerations(&mut refined, state));
        for (name, form) in &mut forms {
            let found = measure.scaled(&accelerations(&mut **form, state));
            let error = difference(&found, &expected) / size(&expected);
            let place = format!("{} s, {name}", state.time);
            // The others place bodies as the refined ones do.
            let bound = match *name {
                "compiled" => measure.placed,
                _ => measure.solved,
            };
            println!("{place}: {error:.1e} of {bound:.1e}");
            worst.meet(error / bound, place);
        }
    }
    worst.assert_within(1.0);
}

/// Twice the rounding of sums of terms below 1 m, as the relations of these joints are.
const CLOSED: f64 = 2e-15;

#[test]
fn loops_stay_closed_and_energy_stays() {
    let scene = load("humanoid");
    let mut closed = Largest::new("residual of a loop of a humanoid");
    for form in FORMS {
        let both: [(&str, Box<dyn Dynamics>); 2] = [
            ("tree", Box::new(recursive(&scene))),
            ("compiled", Box::new(compiled(&scene))),
        ];
        for (name, mut dynamics) in both {
            let solution = motion(&scene, &mut *dynamics, form);
            for state in &solution.samples {
                for (_, body) in scene.mechanism.joints() {
                    let q = &state.configuration[body.ranges().configuration.clone()];
                    closed.meet(body.shared_joint().residual(q), body.joint_name());
                }
            }
            let energies = solution.samples.iter().map(|state| energy(&scene, state));
            let energies: Vec<f64> = energies.collect();
            let mut drift = Largest::new("energy of a humanoid");
            for found in &energies {
                drift.meet(
                    (found / energies[0] - 1.0).abs(),
                    format!("{name}, {form:?}"),
                );
            }
            // Each of n steps adds up to the tolerance, relative to speeds; energy is quadratic in them.
            drift.assert_within(2.0 * TOLERANCE * solution.statistics.steps as f64);
        }
    }
    closed.assert_within(CLOSED);
}

/// Kinetic and potential energy, with that of springs, J.
fn energy(scene: &Scene, state: &State) -> f64 {
    let mut dynamics = recursive(scene);
    let mut momenta = vec![0.0; state.speeds.len()];
    let (q, speeds) = (&state.configuration, &state.speeds);
    dynamics
        .momenta(q, speeds, &mut momenta)
        .expect("sizes fit");
    dynamics.hamiltonian(q, &momenta).expect("regular")
}

/// A scene of the folder without what its linkages alone have: masses of cranks and rods, rotors of the ankles.
fn without_links(name: &str) -> Scene {
    const NOTHING: &str =
        "{ mass = 0.0, inertia = [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]] }";
    const LINKS: [&str; 4] = ["crank", "coupler", "left", "right"];
    const ROTORS: [&str; 2] = ["armature = 0.012", "armature = [0.035, 0.016]"];
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/{name}.toml"));
    let text = std::fs::read_to_string(path).expect("a scene of the project");
    let line = |line: &str| {
        let of = |link: &&str| line.starts_with(&format!("bodies.{link} = "));
        match LINKS.iter().find(|link| of(link)) {
            Some(link) => format!("bodies.{link} = {NOTHING}\n"),
            None if ROTORS.contains(&line) => String::new(),
            None => format!("{line}\n"),
        }
    };
    let text: String = text.lines().map(line).collect();
    Scene::parse(&text, name, &hamel_joints::registry()).unwrap_or_else(|errors| panic!("{errors}"))
}

/// Both robots have the same bodies then, in the same place, and nothing but the coordinates of knees and ankles differs.
#[test]
fn with_massless_links_it_is_the_plain_tree() {
    let [loops, tree] = ["humanoid", "humanoid_tree"].map(without_links);
    for scene in [&loops, &tree] {
        assert_eq!(scene.mechanism.layout().speeds, FREEDOMS, "{}", scene.name);
    }
    let [of_loops, of_tree] =
        [&loops, &tree].map(|scene| Measure::new(&scene.mechanism, &scene.start()));
    let rates = |scene| accelerations(&mut recursive(scene), &scene.start());
    let found = of_loops.scaled(&rates(&loops));
    let expected = of_tree.scaled(&rates(&tree));
    // Joints in the order of the scenes, which is that of the bodies: the last two of each leg are knee and ankle.
    let leg = FREEDOMS - 2 * 6;
    let shared = (0..leg + 3).chain(leg + 6..leg + 9);
    let of = |all: &[f64]| shared.clone().map(|i| all[i]).collect::<Vec<f64>>();
    let error = difference(&of(&found), &of(&expected)) / size(&expected);
    let bounds = [of_loops.placed, of_tree.placed];
    println!("massless links: {error:.1e} of {bounds:?}");
    assert!(error <= bounds[0] + bounds[1], "{error:e}");
}
