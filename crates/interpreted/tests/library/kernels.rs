//! Every kernel of every joint of the library, interpreted, beside the compiled one.

use chacha20::ChaCha8Rng;
use hamel::erased::{AnyJoint, Shared};
use hamel::nalgebra::Vector6;
use hamel::scalar::Extended;
use rand::{RngExt, SeedableRng};
use std::sync::Arc;

/// Either side is held to 16 units in the last place of the largest summand (docs/trust.md), which may be larger than the largest entry where it cancels. At these points
/// the largest difference is 36 units of the largest entry, or of 1, for `rail`, whose curve bends by 1/m² of several tens; twice that for other points.
const UNITS: f64 = 64.0;

/// What iterations find is as exact as their last step, times the condition of what they solve, up to 100 here; at these points the largest difference is 2e-15.
const FOUND: f64 = 1e-13;

/// Values by name, and whether an iteration finds them.
type Values = Vec<(&'static str, bool, Vec<f64>)>;

struct Point {
    q: Vec<f64>,
    target: Vec<f64>,
    phi: Vec<f64>,
    v: Vec<f64>,
    speeds: Vec<f64>,
    h: Vector6<f64>,
}

fn values(joint: &dyn AnyJoint, at: &Point) -> Values {
    let layout = joint.layout();
    let (n, k, s, c) = (
        layout.configuration,
        layout.freedoms,
        layout.speeds,
        layout.constraints,
    );
    let mut all: Values = vec![];
    macro_rules! kernel {
        ($found:expr, $name:ident($($argument:expr),*): $size:expr) => {{
            let mut out = vec![0.0; $size];
            joint.$name($($argument,)* &mut out);
            all.push((stringify!($name), $found, out));
        }};
    }
    let Point {
        q,
        phi,
        v,
        speeds,
        h,
        ..
    } = at;
    kernel!(false, twist_map(q): 6 * k);
    kernel!(false, twist_map_child(q): 6 * k);
    kernel!(false, twist_map_child_gradient(q): 6 * k * k);
    kernel!(false, velocity_map(q): k * k);
    kernel!(false, velocity_map_inverse(q): k * k);
    kernel!(false, velocity_map_gradient(q): k * k * k);
    kernel!(false, gamma(q, v): k * k);
    kernel!(false, j22(q, v): k * k);
    kernel!(false, constraint(q): k * c);
    kernel!(false, speed_basis(q): k * s);
    kernel!(false, speed_basis_gradient(q): k * s * k);
    kernel!(false, configuration_rate(q, v): n);
    kernel!(false, bias_momentum(q, speeds, h): s);
    kernel!(true, retract(q, phi): n);
    kernel!(true, retract_differential(q, phi): k * k);
    kernel!(true, retract_differential_inverse(q, phi, v): k);
    kernel!(true, bias_acceleration_gradient(q, speeds): 6 * k);
    let pose = joint.pose(q);
    all.push(("rotation", false, pose.rotation.as_slice().to_vec()));
    all.push(("translation", false, pose.translation.as_slice().to_vec()));
    all.push(("residual", false, vec![joint.residual(q)]));
    all.push((
        "bias_acceleration",
        false,
        joint.bias_acceleration(q, speeds).as_slice().to_vec(),
    ));
    let mut found = vec![0.0; k];
    joint.local(q, &at.target, &mut found).expect("a value");
    all.push(("local", true, found));
    let mut near: Vec<f64> = q.iter().map(|entry| entry + 1e-6).collect();
    joint.project(&mut near).expect("a value");
    all.push(("project", true, near));
    for port in 0..joint.ports().len() {
        kernel!(false, port_row(q, port): k);
        all.push(("port_value", false, vec![joint.port_value(q, port)]));
        for relation in 0..joint.relations().len() {
            all.push((
                "relation_port",
                true,
                vec![joint.relation_port(q, relation, port)],
            ));
        }
    }
    for relation in 0..joint.relations().len() {
        let twist = joint.relation_twist(q, relation);
        all.push(("relation_twist", true, twist.as_slice().to_vec()));
    }
    for pin in 0..joint.pins().len() {
        all.push(("pin_place", false, joint.pin_place(q, pin).to_vec()));
    }
    let singularity = joint.singularity(q);
    if singularity.is_finite() {
        all.push(("singularity", false, vec![singularity]));
    }
    all
}

fn point(joint: &dyn AnyJoint, random: &mut ChaCha8Rng) -> Point {
    let layout = joint.layout();
    // Linkages have ends not far from home.
    let reach = if joint.relations().is_empty() {
        1.5
    } else {
        0.2
    };
    let mut vector = |size: usize, reach: f64| -> Vec<f64> {
        (0..size)
            .map(|_| random.random_range(-reach..reach))
            .collect()
    };
    let moved = |q: &[f64], phi: &[f64]| {
        let mut moved = vec![0.0; layout.configuration];
        joint.retract(q, phi, &mut moved);
        moved
    };
    let mut home = vec![0.0; layout.configuration];
    joint.home(&mut home);
    let q = moved(&home, &vector(layout.freedoms, reach));
    let phi = vector(layout.freedoms, reach.min(1.0));
    Point {
        target: moved(&q, &phi),
        phi,
        v: vector(layout.freedoms, 2.0),
        speeds: vector(layout.speeds, 2.0),
        h: Vector6::from_iterator(vector(6, 2.0)),
        q,
    }
}

fn bodies(first: &Shared) -> Vec<Shared> {
    std::iter::once(first.clone()).chain(first.more()).collect()
}

/// Both, where the interpreted one is not too large.
fn pairs() -> Vec<(Shared, Shared)> {
    let library = hamel::joints::registry();
    let mut pairs = vec![];
    for (name, own) in super::common::all() {
        let entry = library.get(name).expect("a joint of the library");
        let parameters = super::common::parameters(name);
        let compiled = (entry.build)(&parameters).expect("an example");
        if let Ok(own) = own {
            pairs.push((
                compiled,
                own.build(&parameters).expect("what the other takes"),
            ));
        }
    }
    pairs
}

#[test]
fn values_are_those_of_the_compiled_joints() {
    let mut random = ChaCha8Rng::seed_from_u64(28);
    let mut worst = [(0.0, String::new()), (0.0, String::new())];
    for (compiled, interpreted) in pairs() {
        for (compiled, interpreted) in bodies(&compiled).iter().zip(bodies(&interpreted)) {
            for _ in 0..20 {
                let at = point(&**compiled, &mut random);
                let both = values(&**compiled, &at)
                    .into_iter()
                    .zip(values(&*interpreted, &at));
                for ((kernel, found, expected), (_, _, own)) in both {
                    let largest = expected
                        .iter()
                        .fold(1.0, |most: f64, entry| most.max(entry.abs()));
                    assert_eq!(own.len(), expected.len());
                    for (own, expected) in own.iter().zip(&expected) {
                        let error = (own - expected).abs() / largest;
                        assert!(
                            !error.is_nan(),
                            "{} {kernel}: {own} beside {expected}",
                            compiled.name()
                        );
                        let worst = &mut worst[usize::from(found)];
                        if error > worst.0 {
                            *worst = (
                                error,
                                format!("{} {kernel} {own} beside {expected}", compiled.name()),
                            );
                        }
                    }
                }
            }
        }
    }
    let [(exact, of_exact), (found, of_found)] = worst;
    println!(
        "{:.1} units: {of_exact}; {found:.1e}: {of_found}",
        exact / f64::EPSILON
    );
    assert!(
        exact <= UNITS * f64::EPSILON,
        "{:.1} units: {of_exact}",
        exact / f64::EPSILON
    );
    assert!(found <= FOUND, "{found:e}: {of_found}");
}

#[test]
fn what_joints_tell_of_themselves_is_the_same() {
    for (compiled, interpreted) in pairs() {
        for (compiled, own) in bodies(&compiled).iter().zip(bodies(&interpreted)) {
            assert_eq!(own.name(), compiled.name());
            assert_eq!(own.layout(), compiled.layout());
            assert_eq!(own.bodies(), compiled.bodies());
            assert_eq!(own.body(), compiled.body());
            assert_eq!(own.structures(), compiled.structures(), "{}", own.name());
            assert_eq!(own.velocity_frame(), compiled.velocity_frame());
            assert_eq!(own.coordinates(), compiled.coordinates());
            assert_eq!(own.freedoms(), compiled.freedoms());
            assert_eq!(own.speeds(), compiled.speeds());
            assert_eq!(own.relations(), compiled.relations());
            assert_eq!(own.relation_units(), compiled.relation_units());
            assert_eq!(own.ports(), compiled.ports());
            assert_eq!(own.pins(), compiled.pins());
            assert_eq!(own.unidentifiable(), compiled.unidentifiable());
            assert_eq!(own.singularities(), compiled.singularities());
            let layout = own.layout();
            for k in 0..layout.freedoms {
                assert_eq!(own.moves_body(k), compiled.moves_body(k));
                assert_eq!(own.units().freedom(k), compiled.units().freedom(k));
                assert_eq!(own.units().velocity(k), compiled.units().velocity(k));
            }
            for i in 0..layout.configuration {
                assert_eq!(own.units().coordinate(i), compiled.units().coordinate(i));
            }
            for i in 0..layout.speeds {
                assert_eq!(own.units().speed(i), compiled.units().speed(i));
            }
            let parameters = |joint: &dyn AnyJoint| {
                let mut all = vec![];
                joint.parameters(&mut |name, value| all.push((name, value)));
                all
            };
            assert_eq!(parameters(&*own), parameters(&**compiled));
        }
    }
}

#[test]
fn projections_are_the_same_in_doubles_and_in_twice_as_many_digits() {
    for (compiled, interpreted) in pairs() {
        let [expected, own] = [&compiled, &interpreted].map(|joint| {
            let mut home = vec![0.0; joint.layout().configuration];
            joint.home(&mut home);
            home
        });
        let [far, near] = [&compiled, &interpreted].map(|joint| {
            let mut home: Vec<_> = expected
                .iter()
                .map(|&entry| Extended::from(entry))
                .collect();
            let found = Arc::clone(joint).extended().project(&mut home);
            found.expect("close to the manifold");
            home
        });
        for i in 0..own.len() {
            assert!(
                (own[i] - expected[i]).abs() <= FOUND,
                "{}: {own:?}",
                compiled.name()
            );
            let apart = (near[i] - far[i]).high().abs();
            // 106 bits, of which iterations and the quotients of a few operations take some.
            assert!(apart <= 1e-26, "{}: {apart:e}", compiled.name());
        }
    }
}
