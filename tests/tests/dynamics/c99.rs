//! Compiled modules in C: every scene that is compiled, bit by bit as its lines are evaluated here and as Rust computes them, and against the tree.

use super::compiled::{closed, scene_files, several};
use chacha20::ChaCha8Rng;
use hamel::nalgebra::{Rotation3, Vector3};
use hamel::scalar::{Dual, Scalar};
use hamel_codegen::derived::Primitive;
use hamel_codegen::expr::Function as Known;
use hamel_compiler::emit::Function;
use hamel_compiler::functions::{Kind, compile_in_lanes};
use hamel_compiler::graph::{Argument, Sym, atan2, call, call_two, primitive, record};
use hamel_compiler::model::Model;
use hamel_compiler::scene;
use hamel_emitted::{ball_chain, chain_8, geodesic_springs, plate_cart_arm, snakeboard};
use hamel_scene::Scene;
use hamel_tests::c99::{Extent, Module, Program, STATES, agree, functions, same};
use hamel_tests::random;
use rand::SeedableRng;
use std::path::Path;

fn folder(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR"))
        .join("c99")
        .join(name)
}

/// A scene file of the project, and what is compiled of it.
pub fn loaded(file: &str) -> (Scene, Model) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let model = scene(&path).library(hamel_joints::specs()).model();
    let model = model.unwrap_or_else(|error| panic!("{error}"));
    let scene = Scene::load(&path, &hamel_joints::registry());
    (scene.unwrap_or_else(|errors| panic!("{errors}")), model)
}

/// The arguments of one state, where `rows` holds those of all.
pub fn of_state<'r>(function: &Function, rows: &'r [Vec<f64>], state: usize) -> Vec<&'r [f64]> {
    let arguments = rows.iter().zip(&function.arguments);
    let own = arguments.map(|(rows, (_, size))| &rows[state * size..(state + 1) * size]);
    own.collect()
}

/// Every function of every scene that is not too long has the bits of its evaluated lines, and the values of the tree to the bounds of the test `compiled`.
#[test]
fn scenes_agree() {
    let count = agree_on_scenes("scenes", Extent::MANY_SCENES);
    // 879 when this was written: no later limit leaves most of them out.
    assert!(count > 800, "{count}");
}

#[test]
#[ignore = "a minute: longer derivatives"]
fn long_derivatives_of_scenes_agree() {
    agree_on_scenes("long", Extent::RELEASE);
}

fn agree_on_scenes(into: &str, extent: Extent) -> usize {
    let scenes = scene_files().into_iter().map(|(scene, model)| {
        let model = model.unwrap_or_else(|refused| panic!("{refused}"));
        (scene.mechanism, model)
    });
    agree(&folder(into), &scenes.collect::<Vec<_>>(), extent)
}

/// The same of loops that scenes and robots close.
#[test]
fn loops_agree() {
    let count = agree_on_loops("closed", Extent::MANY_SCENES, |name| {
        !name.ends_with(closed::ON_A_BASE)
    });
    // 325 when this was written.
    assert!(count > 300, "{count}");
}

#[test]
#[ignore = "a minute: loops on a moving body, and longer derivatives"]
fn long_derivatives_of_loops_agree() {
    agree_on_loops("long_closed", Extent::RELEASE, |_| true);
}

fn agree_on_loops(into: &str, extent: Extent, is_chosen: impl Fn(&str) -> bool) -> usize {
    let scenes = closed::cases().into_iter();
    let scenes = scenes.filter(|case| is_chosen(&case.name));
    let scenes = scenes.map(|case| (case.scene.mechanism, case.model));
    agree(&folder(into), &scenes.collect::<Vec<_>>(), extent)
}

/// The same of two hinges as one joint that carries two bodies.
#[test]
fn a_joint_with_two_bodies_agrees() {
    agree(&folder("several"), &[several::hinges()], Extent::FEW_SCENES);
}

/// A scalar in which a committed module is computed.
trait Number: Scalar {
    /// The number of this value.
    fn of(value: f64) -> Self;
    /// The value of the number.
    fn value(&self) -> f64;
}

impl Number for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn value(&self) -> f64 {
        *self
    }
}

/// Numbers whose sines and cosines are the standard functions, one by one.
impl Number for Dual<f64> {
    fn of(value: f64) -> Self {
        Self::constant(value)
    }
    fn value(&self) -> f64 {
        self.value
    }
}

fn numbers<T: Number, const N: usize>(values: &[f64]) -> [T; N] {
    std::array::from_fn(|i| T::of(values[i]))
}

fn values<'a, T: Number>(numbers: impl IntoIterator<Item = &'a T>) -> Vec<f64> {
    numbers.into_iter().map(Number::value).collect()
}

/// A function of a committed module: in C its name, which arguments it takes of Q, v̄ or p̄, and τ or v̄̇; and the same in Rust.
struct Committed {
    module: &'static str,
    function: &'static str,
    arguments: &'static [usize],
    in_rust: fn([&[f64]; 4]) -> Vec<f64>,
}

macro_rules! committed {
    ($module:ident, $function:ident, $arguments:tt $(, $flattened:ident)?) => {
        committed!(Dual<f64>: $module, $function, $arguments $(, $flattened)?)
    };
    ($number:ty: $module:ident, $function:ident, [$($argument:literal),*] $(, $flattened:ident)?) => {
        Committed {
            module: stringify!($module),
            function: stringify!($function),
            arguments: &[$($argument),*],
            in_rust: |state| {
                let results = $module::$function::<$number>($(&numbers(state[$argument])),*);
                values(results$(.$flattened())?.iter())
            },
        }
    };
}

fn committed() -> Vec<Committed> {
    vec![
        committed!(plate_cart_arm, forward_dynamics, [0, 1, 2]),
        committed!(plate_cart_arm, inverse_dynamics, [0, 1, 2]),
        committed!(plate_cart_arm, mass_matrix, [0], as_flattened),
        committed!(plate_cart_arm, bias_forces, [0, 1]),
        committed!(plate_cart_arm, momentum_rates, [0, 1, 2], as_flattened),
        committed!(plate_cart_arm, momenta, [0, 1]),
        committed!(plate_cart_arm, speeds_from_momenta, [0, 1]),
        committed!(plate_cart_arm, hamiltonian, [0, 1]),
        committed!(plate_cart_arm, energies, [0, 1]),
        committed!(plate_cart_arm, poses, [0], as_flattened),
        committed!(
            plate_cart_arm,
            forward_dynamics_derivatives,
            [0, 1, 2],
            as_flattened
        ),
        committed!(
            plate_cart_arm,
            inverse_dynamics_derivatives,
            [0, 1, 2],
            as_flattened
        ),
        committed!(plate_cart_arm, inverse_mass_matrix, [0], as_flattened),
        committed!(
            plate_cart_arm,
            forward_dynamics_second_derivatives,
            [0, 1, 2, 3],
            as_flattened
        ),
        committed!(
            plate_cart_arm,
            inverse_dynamics_second_derivatives,
            [0, 1, 2, 3],
            as_flattened
        ),
        // Without sines. Derivatives of eight balls in dual numbers take the compiler ten minutes.
        committed!(
            f64: chain_8,
            forward_dynamics_derivatives,
            [0, 1, 2],
            as_flattened
        ),
        committed!(f64: chain_8, inverse_mass_matrix, [0], as_flattened),
        committed!(geodesic_springs, forward_dynamics, [0, 1, 2]),
        committed!(geodesic_springs, momentum_rates, [0, 1, 2], as_flattened),
        committed!(geodesic_springs, hamiltonian, [0, 1]),
        committed!(snakeboard, forward_dynamics, [0, 1, 2]),
        committed!(snakeboard, momentum_rates, [0, 1, 2], as_flattened),
        committed!(snakeboard, hamiltonian, [0, 1]),
        committed!(ball_chain, forward_dynamics, [0, 1, 2]),
        committed!(ball_chain, inverse_dynamics, [0, 1, 2]),
    ]
}

/// The committed modules in C have the bits of those in Rust.
#[test]
fn committed_modules_agree() {
    let files = [
        "../scenes/plate_cart_arm.toml",
        "../scenes/snakeboard.toml",
        "data/scenes/geodesic_springs.toml",
        "data/scenes/ball_chain.toml",
        "../scenes/report/chain_8.toml",
    ];
    let load = |file: &&str| {
        let (scene, model) = loaded(file);
        let name = Path::new(file).file_stem().unwrap_or_default();
        let name = name.to_string_lossy().into_owned();
        let mut functions = functions(&model);
        let own = committed().into_iter().filter(|one| one.module == name);
        let own: Vec<&str> = own.map(|one| one.function).collect();
        functions.retain(|function| own.contains(&function.name));
        (name, scene, functions, model)
    };
    let loaded: Vec<_> = files.iter().map(load).collect();
    let modules = loaded.iter().map(|(name, _, functions, model)| Module {
        name: name.clone(),
        model,
        functions,
        lanes: &[],
        kernels: &[],
        // The highest level that build systems commonly ask for: more is inlined, and other warnings are looked for.
        optimisation: "-O2",
    });
    let modules: Vec<Module<'_>> = modules.collect();
    let Some(mut program) = Program::new(&folder("committed"), &modules) else {
        return;
    };
    for Committed {
        module,
        function,
        arguments,
        in_rust,
    } in committed()
    {
        let named = loaded.iter().find(|(name, ..)| name == module);
        let (_, scene, ..) = named.unwrap_or_else(|| panic!("{module} is compiled"));
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let layout = *scene.mechanism.layout();
        for _ in 0..100 {
            let q = random::configuration(&mut random, &scene.mechanism);
            let v = random::numbers(&mut random, layout.speeds);
            let u = random::numbers(&mut random, layout.freedoms);
            let u = match function {
                "inverse_dynamics"
                | "inverse_dynamics_derivatives"
                | "inverse_dynamics_second_derivatives" => &u[..layout.speeds],
                _ => &u,
            };
            let weights: Vec<f64> = v.iter().map(|v| 0.3 - v.cos()).collect();
            let state = [&*q, &*v, u, &*weights];
            let given: Vec<&[f64]> = arguments.iter().map(|&one| state[one]).collect();
            let found = program.call(module, function, &given);
            let expected = in_rust(state);
            assert!(
                same(&found, &expected),
                "{module}, {function}: {found:?} and {expected:?}"
            );
        }
    }
}

/// Roundings by which states side by side may differ from single ones, relative to the largest entry of a state: some hundred operations of a well-conditioned
/// system, and sines and cosines of another accuracy, as in the test `batches`.
const ROUNDINGS: f64 = 1e3 * f64::EPSILON;

/// The state that is given an angle beyond those that the polynomials serve.
const FAR: usize = 3;

/// Functions of many states are those of one state to rounding, of a whole group and of one that is not, also where the polynomials of angles do not serve.
#[test]
fn many_states_agree() {
    let load = |file: &str| {
        let (scene, model) = loaded(file);
        let kinds = Kind::ALL.into_iter().filter(|kind| kind.is_batched());
        let lanes: Vec<Function> = kinds
            .filter_map(|kind| compile_in_lanes(&model, kind, false).ok())
            .collect();
        let mut single = functions(&model);
        single.retain(|one| lanes.iter().any(|other| other.name == one.name));
        (scene.mechanism, single, lanes, model)
    };
    // The last stores no angle.
    let loaded = [
        "../scenes/plate_cart_arm.toml",
        "data/scenes/linkages.toml",
        "../scenes/report/crank_rocker.toml",
    ]
    .map(load);
    let modules = loaded.iter().zip(["cart", "bars", "rocker"]);
    let modules: Vec<Module<'_>> = modules
        .map(|((_, functions, lanes, model), name)| Module {
            name: name.to_owned(),
            model,
            functions,
            lanes,
            kernels: &[],
            optimisation: "-O2",
        })
        .collect();
    let Some(mut program) = Program::new(&folder("many"), &modules) else {
        return;
    };
    for ((mechanism, _, lanes, _), Module { name, .. }) in loaded.iter().zip(&modules) {
        assert!(lanes.len() >= 4, "{name}: {}", lanes.len());
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut q: Vec<Vec<f64>> = (0..STATES)
            .map(|_| random::configuration(&mut random, mechanism))
            .collect();
        // What a table with loops stores first is its angle.
        if name == "bars" {
            q[FAR][0] = 1.0e6 + 0.3;
        }
        for function in lanes {
            let rest = function.arguments.iter().skip(1);
            let rest: Vec<Vec<f64>> = rest
                .map(|(_, size)| random::numbers(&mut random, STATES * size))
                .collect();
            let rows = [vec![q.concat()], rest].concat();
            let given: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
            let found = program.call(name, &format!("{}_rows", function.name), &given);
            for (state, found) in found.chunks(function.results()).enumerate() {
                let own = of_state(function, &rows, state);
                let expected = program.call(name, function.name, &own);
                let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                let bound = ROUNDINGS * largest;
                let close = found
                    .iter()
                    .zip(&expected)
                    .all(|(a, b)| (a - b).abs() <= bound);
                let what = format!("{name}, {}, state {state}", function.name);
                assert!(close, "{what}: {found:?} and {expected:?}");
            }
        }
    }
}

/// As many as Q has in the scene whose module the helpers are written into.
const SCALARS: usize = 18;

/// Arguments of the helpers: a number of any sign and size; one below 4π²; a positive one; a matrix off a rotation, by rows; a quaternion.
fn helper_arguments() -> Vec<[f64; SCALARS]> {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut arguments = vec![];
    for i in 0..600 {
        let mut own = [0.0; SCALARS];
        own.copy_from_slice(&random::numbers(&mut random, SCALARS));
        // From 1e-20 to 1e4, and 0.
        let size = 10_f64.powf(f64::from(i) / 25.0 - 20.0);
        own[0] *= if i == 0 { 0.0 } else { size };
        own[1] *= 30.0;
        own[2] = own[2].abs() * size;
        // Angles from rounding to a little beyond π.
        let turn = Vector3::new(own[3], own[4], own[5]).normalize() * size.min(3.2);
        let rotation = Rotation3::from_scaled_axis(turn).transpose();
        for (entry, exact) in own[3..12].iter_mut().zip(rotation.matrix().iter()) {
            *entry = exact + 1e-6 * *entry;
        }
        for entry in &mut own[13..16] {
            *entry *= size;
        }
        arguments.push(own);
    }
    arguments
}

/// Functions of the runtime that C does not have, which modules bring along: every one at arguments of all magnitudes.
#[test]
fn helpers_agree() {
    let x = |i| Sym::input(Argument::Configuration, i);
    let (outputs, graph) = record(|| {
        let mut all: Vec<Sym> = (0..12)
            .map(|order| call(Known::Stumpff(order), x(0)))
            .collect();
        all.extend((0..6).map(|n| call(Known::DexpInverse(n), x(1))));
        all.extend([
            call(Known::Exp, x(0)),
            call(Known::Ln, x(2)),
            call(Known::Sqrt, x(2)),
        ]);
        let hyperbolic = [
            Known::Sinh,
            Known::Cosh,
            Known::Sech,
            Known::Tanh,
            Known::LnCosh,
        ];
        all.extend(hyperbolic.map(|function| call(function, x(0))));
        all.push(atan2(x(0), x(1)));
        all.push(call_two(Known::Larger, x(0), x(1)));
        all.push(call_two(
            Known::Ln1p,
            x(2),
            call_two(Known::Larger, x(0), Sym::from(0.0)),
        ));
        let matrix: Vec<Sym> = (3..12).map(x).collect();
        let quaternion: Vec<Sym> = (12..16).map(x).collect();
        all.extend(primitive(Primitive::RotationVector, &matrix));
        all.extend(primitive(Primitive::NearestRotation, &matrix));
        all.extend(primitive(Primitive::QuaternionVector, &quaternion));
        all.into_iter().map(Sym::value).collect::<Vec<_>>()
    });
    // Any that stores enough will do: its functions are not written.
    let (_, model) = loaded("../scenes/double_ball_pendulum.toml");
    let function = Function {
        name: "helpers",
        summary: "All helpers.".to_owned(),
        arguments: vec![(Argument::Configuration, SCALARS)],
        columns: None,
        graph,
        outputs,
        plan: None,
        packs: None,
        pairs: None,
    };
    let functions = [function];
    let module = Module {
        name: "helpers".to_owned(),
        model: &model,
        functions: &functions,
        lanes: &[],
        kernels: &[],
        optimisation: "-O2",
    };
    let Some(mut program) = Program::new(&folder("helpers"), &[module]) else {
        return;
    };
    for arguments in helper_arguments() {
        let found = program.call("helpers", "helpers", &[&arguments]);
        let expected = functions[0].evaluate(|_| arguments.to_vec());
        assert!(
            same(&found, &expected),
            "{arguments:?}: {found:?} and {expected:?}"
        );
    }
}
