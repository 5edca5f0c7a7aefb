//! What the scene compiler leaves out of joints with several bodies: inertias that do not affect the joint, of all its bodies together.

use chacha20::ChaCha8Rng;
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::nalgebra::{Matrix3, Vector2, Vector3};
use hamel::spatial::{MassProperties, Pose};
use hamel_compiler::JointType;
use hamel_compiler::emit::Function;
use hamel_compiler::functions::{Kind, Loops, compile_with};
use hamel_compiler::graph::Argument;
use hamel_compiler::model::Model;
use hamel_compiler::prune::{Link, Pruning, prune};
use hamel_tests::figures::Largest;
use hamel_tests::{compiled, random};
use rand::SeedableRng;
use std::rc::Rc;
use std::sync::Arc;

/// Mass properties of bodies of a plane linkage, with the centre of mass on the x axis.
fn link(mass: f64, centre: f64) -> MassProperties {
    let inertia = Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04));
    MassProperties::new(mass, Vector3::new(centre, 0.0, 0.0), inertia).expect("valid")
}

fn model(
    name: &str,
    parameters: &[f64],
    masses: &[MassProperties],
    gravity: f64,
    on_world: bool,
) -> Model {
    let mechanism = mechanism(name, parameters, masses, gravity, on_world);
    compiled::model("left_out", &mechanism)
}

/// A joint with these bodies on the world, or on a body that moves freely.
fn mechanism(
    name: &str,
    parameters: &[f64],
    masses: &[MassProperties],
    gravity: f64,
    on_world: bool,
) -> Mechanism {
    let registry = hamel_joints::registry();
    let built = |name: &str, parameters: &[f64]| {
        let entry = registry.get(name).expect("a joint of the library");
        (entry.build)(parameters).unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    let body = |name: &str, joint, parent, mass| BodySpec {
        name: format!("{name} {mass:?}"),
        joint_name: name.into(),
        parent,
        joint,
        placement: Pose::from_translation(Vector3::new(0.1, -0.2, 0.3)),
        child_placement: Pose::identity(),
        mass,
    };
    let parent = (!on_world).then_some(0);
    let base = parent.map(|_| body("free", built("free", &[]), None, link(3.0, 0.1)));
    let first = built(name, parameters);
    let joints = std::iter::once(first.clone()).chain(first.more());
    let bodies = joints
        .zip(masses)
        .map(|(joint, mass)| body(name, joint, parent, *mass));
    let bodies = base.into_iter().chain(bodies).collect();
    let gravity = Vector3::new(0.3, gravity, 0.7) * gravity.abs().min(1.0);
    Mechanism::new(gravity, bodies).unwrap_or_else(|errors| panic!("{errors:?}"))
}

fn operations(model: &Model, links: &[Link]) -> usize {
    let chosen = compile_with(model, links, Kind::ForwardDynamics, Loops::default());
    chosen.function.operations().flops()
}

/// Ground, crank, coupler and rocker.
const LENGTHS: [f64; 4] = [1.0, 0.5, 1.0, 1.25];

/// Crank, coupler and rocker whose common centre of mass does not move: a quarter of the coupler's 2 kg belongs to the end of the rocker, three quarters to that of the crank (Berkof and
/// Lowen, 1969).
fn balanced() -> [MassProperties; 3] {
    [link(3.0, -0.25), link(2.0, 0.25), link(1.0, -0.625)]
}

#[test]
fn gravity_is_left_out_of_a_balanced_four_bar() {
    let of = |masses: &[MassProperties], gravity| {
        let model = model("four_bar", &LENGTHS, masses, gravity, true);
        operations(&model, &prune(&model, Pruning::ALL))
    };
    assert_eq!(of(&balanced(), -9.7), of(&balanced(), 0.0));
    let mut other = balanced();
    other[2] = link(1.0, -0.5);
    assert!(of(&other, -9.7) > of(&other, 0.0));
}

/// Points of mass in the pins of the coupler belong to it as well as to its neighbours.
#[test]
fn a_coupler_leaves_its_mass_to_its_neighbours() {
    let model = model("four_bar", &LENGTHS, &balanced(), -9.7, false);
    let links = prune(&model, Pruning::ALL);
    let massless = links[1..]
        .iter()
        .filter(|link| link.inertia.mass == 0.0)
        .count();
    assert_eq!(massless, 3, "{links:?}");
    let framed = prune(
        &model,
        Pruning {
            frames: true,
            inertias: false,
        },
    );
    assert!(operations(&model, &links) < operations(&model, &framed));
}

/// A rotor that nothing but its own gear turns is an inertia of the output.
#[test]
fn a_rotor_on_a_fixed_axis_is_left_out() {
    let masses = [link(2.0, 0.25), link(1.0, 0.0)];
    let model = model("geared_revolute", &[8.0], &masses, -9.7, true);
    let links = prune(&model, Pruning::ALL);
    let left: Vec<usize> = links
        .iter()
        .map(|link| {
            link.inertia
                .parameters()
                .iter()
                .filter(|own| **own != 0.0)
                .count()
        })
        .collect();
    // Of the output its centre of mass on the x axis, and one square for the moments of both about the axis.
    assert_eq!(left[1], 0, "{links:?}");
    assert_eq!(left[0], 2, "{links:?}");
}

/// On a body that moves, its turning is felt.
#[test]
fn a_rotor_on_a_moving_axis_keeps_its_moment() {
    let masses = [link(2.0, 0.25), link(1.0, 0.0)];
    let model = model("geared_revolute", &[8.0], &masses, -9.7, false);
    let links = prune(&model, Pruning::ALL);
    let rotor = links[2].inertia.parameters();
    assert_ne!(rotor, [0.0; 10]);
    assert_eq!(rotor[0], 0.0);
}

/// Every joint of the library that carries several bodies, on the world and on a ball: efforts with what is left out are those with all of it, to some dozen roundings of their largest term.
#[test]
fn what_is_left_out_changes_no_effort() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let all = random::library();
    let named = |name: &str| {
        all.iter()
            .find(|joint| joint.name() == name)
            .expect("in the library")
    };
    let several = all.iter().filter(|joint| joint.bodies().len() > 1);
    let mut worst = Largest::new("efforts of what is left out");
    for joint in several {
        for on_world in [true, false] {
            let base = (!on_world).then(|| Arc::clone(named("ball")));
            // What hangs on the joint moves frames, and leaves it inertia of its own.
            let carried = ["revolute", "gimbal", "ball"].map(|name| Arc::clone(named(name)));
            let joints: Vec<_> = base
                .into_iter()
                .chain([Arc::clone(joint)])
                .chain(carried)
                .collect();
            let mechanism = random::tree(&mut random, &joints);
            let model = compiled::model(joint.name(), &mechanism);
            let [pruned, bare] = [Pruning::ALL, Pruning::NONE].map(|pruning| {
                let links = prune(&model, pruning);
                compile_with(&model, &links, Kind::InverseDynamics, Loops::Never).function
            });
            for _ in 0..4 {
                let q = random::configuration(&mut random, &mechanism);
                let count = mechanism.layout().speeds;
                let v = random::numbers(&mut random, count);
                let a = random::numbers(&mut random, count);
                let efforts = |function: &Function| {
                    function.evaluate(|argument| match argument {
                        Argument::Configuration => q.clone(),
                        Argument::Speeds | Argument::Momenta => v.clone(),
                        Argument::Efforts | Argument::Accelerations => a.clone(),
                        // Of steps of motions, and of second derivatives.
                        Argument::Given | Argument::Weights => vec![],
                    })
                };
                let (found, expected) = (efforts(&pruned), efforts(&bare));
                let largest = expected
                    .iter()
                    .fold(1.0_f64, |most, own| own.abs().max(most));
                let errors = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
                let error = errors.fold(0.0, f64::max) / largest;
                worst.meet(error, format!("{}, on the world: {on_world}", joint.name()));
            }
        }
    }
    worst.assert_within(1e-12);
}

/// A four-bar of any size, from micrometres to thousands of kilometres, on the world and on a ball: what is left out does not depend on the unit of length, in which v has one as well.
#[test]
fn what_is_left_out_does_not_depend_on_the_size() {
    for exponent in [-6, -3, 0, 3, 6] {
        let unit = 10.0_f64.powi(exponent);
        let lengths = [3.0, 1.0, 3.0, 2.5].map(|length| length * unit);
        let bodies = [[0.2, 0.1], [0.3, -0.2], [0.1, 0.3]].map(|[x, y]| {
            let inertia = Matrix3::from_diagonal(&Vector3::new(0.02, 0.03, 0.04)) * unit * unit;
            MassProperties::new(1.0, Vector3::new(x, y, 0.0) * unit, inertia).expect("valid")
        });
        for on_world in [true, false] {
            let model = model("four_bar", &lengths, &bodies, -9.7, on_world);
            let [pruned, bare] = [Pruning::ALL, Pruning::NONE].map(|pruning| {
                let links = prune(&model, pruning);
                compile_with(&model, &links, Kind::InverseDynamics, Loops::Never).function
            });
            let mechanism = mechanism("four_bar", &lengths, &bodies, -9.7, on_world);
            let mut random = ChaCha8Rng::seed_from_u64(5);
            let mut q = mechanism.home();
            let body = mechanism.bodies().last().expect("a body");
            let own = body.ranges().configuration.clone();
            let mut moved = vec![0.0; own.len()];
            body.joint()
                .retract(&q[own.clone()], &[0.05 / (unit * unit)], &mut moved);
            q[own].copy_from_slice(&moved);
            let count = mechanism.layout().speeds;
            // v of the four-bar in 1/(m² s): its links turn at about 1 rad/s.
            let mut numbers = || {
                let mut numbers = random::numbers(&mut random, count);
                numbers[count - 1] /= unit * unit;
                numbers
            };
            let (v, a) = (numbers(), numbers());
            let efforts = |function: &Function| {
                let mut efforts = function.evaluate(|argument| match argument {
                    Argument::Configuration => q.clone(),
                    Argument::Speeds | Argument::Momenta => v.clone(),
                    Argument::Efforts | Argument::Accelerations => a.clone(),
                    // Of steps of motions, and of second derivatives.
                    Argument::Given | Argument::Weights => vec![],
                });
                efforts[count - 1] /= unit * unit;
                efforts
            };
            let (found, expected) = (efforts(&pruned), efforts(&bare));
            let largest = expected
                .iter()
                .fold(0.0_f64, |most, own| own.abs().max(most));
            for (found, expected) in found.iter().zip(&expected) {
                let error = (found - expected).abs() / largest;
                assert!(
                    error < 1e-12,
                    "{unit} m, on the world: {on_world}: {error:e}"
                );
            }
        }
    }
}

/// Opposite links are as long: it moves as a parallelogram, whose coupler does not turn, or crossed, where it does.
const PARALLELOGRAM: &str = "
hamel = 1;

/// A linkage that folds flat.
joint parallelogram(ground: m > 0, crank: m > 0) {
    config  a: S1, b: S1, c: S1;
    bodies  crank, coupler, rocker;
    relation crank * a.c + ground * b.c = ground + crank * c.c;
    relation crank * a.s + ground * b.s = crank * c.s;
    home near [0, 1], [1, 0], [0, 1];
    except  c.s * b.c - c.c * b.s = 0;
    basis   turn of so2(a);
    H.crank   = rot_z(a);
    H.coupler = pose(rot_z(b), [crank * a.c, crank * a.s, 0]);
    H.rocker  = pose(rot_z(c), [ground, 0, 0]);
}
";

/// What is not felt of a parallelogram alone is not left out, since the equations would be wrong where it is assembled crossed.
#[test]
fn what_is_left_out_changes_no_effort_of_a_linkage_on_either_side_of_its_fold() {
    let derived = hamel_codegen::derive(PARALLELOGRAM, "parallelogram.joint");
    let derived = derived.unwrap_or_else(|errors| panic!("{errors}"));
    let interpreted = hamel_interpreted::JointType::new(&derived).expect("not too large");
    let first = interpreted.build(&[1.0, 0.5]).expect("lengths");
    let joints = std::iter::once(first.clone()).chain(first.more());
    let masses = [link(1.0, 0.2), link(2.0, 0.4), link(1.5, 0.3)];
    let bodies = joints.zip(masses).map(|(joint, mass)| BodySpec {
        name: format!("{mass:?}"),
        joint_name: "parallelogram".into(),
        parent: None,
        joint,
        placement: Pose::identity(),
        child_placement: Pose::identity(),
        mass,
    });
    let mechanism = Mechanism::new(Vector3::new(0.3, -9.7, 0.7), bodies.collect());
    let mechanism = mechanism.unwrap_or_else(|errors| panic!("{errors:?}"));
    let joint = Rc::new(JointType::new(derived).expect("its products take little work"));
    let model = compiled::model_on("parallelogram", &mechanism, |_| Some(Rc::clone(&joint)));
    let [pruned, bare] = [Pruning::ALL, Pruning::NONE].map(|pruning| {
        let links = prune(&model, pruning);
        compile_with(&model, &links, Kind::InverseDynamics, Loops::Never).function
    });
    for angle in [0.4, 1.1, 2.0] {
        let (sine, cosine) = f64::sin_cos(angle);
        // The end of the crank, and that of the rocker: beside it, or mirrored by the line from the end of the crank to the rocker's pin.
        let (pin, end) = (Vector2::new(1.0, 0.0), Vector2::new(cosine, sine) * 0.5);
        let along = (pin - end).normalize();
        let beside = Vector2::new(1.0, 0.0);
        let mirrored = along * (2.0 * along.dot(&beside)) - beside;
        for coupler in [beside, mirrored] {
            let rocker = (end + coupler - pin) * 2.0;
            let q = vec![cosine, sine, coupler.x, coupler.y, rocker.x, rocker.y];
            let efforts = |function: &Function| {
                function.evaluate(|argument| match argument {
                    Argument::Configuration => q.clone(),
                    Argument::Speeds | Argument::Momenta => vec![0.7],
                    Argument::Efforts | Argument::Accelerations => vec![-0.4],
                    Argument::Given | Argument::Weights => vec![],
                })
            };
            let (found, expected) = (efforts(&pruned)[0], efforts(&bare)[0]);
            // Some dozen operations with terms below 100 N m.
            let error = (found - expected).abs();
            assert!(
                error < 1e-12,
                "{angle} rad, coupler {coupler}: {found} for {expected}"
            );
        }
    }
}
