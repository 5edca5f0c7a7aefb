//! Base parameters of every joint of the library, of robots, and of scenes.

use chacha20::ChaCha8Rng;
use hamel::dynamics::parameters::BaseParameters;
use hamel::dynamics::{JointTorqueRegressor, Recursive};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::DVector;
use hamel_tests::figures::Largest;
use hamel_tests::random::{chain, configuration, library, numbers};
use hamel_tests::scenes;
use rand::SeedableRng;
use std::path::Path;
use std::sync::Arc;

/// `Y π` against `Y_b B π`, of the sum of the absolute values of their terms: some dozen roundings of each, and what the elimination adds.
const ROUNDING: f64 = 1e-11;

/// The largest difference of `Y π` and `Y_b B π` at some states, as a part of their terms.
fn difference(mechanism: &Arc<Mechanism>, base: &BaseParameters) -> f64 {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let mut regressor = JointTorqueRegressor::new(mechanism);
    let parameters = mechanism.inertial_parameters();
    let values = base.values(&parameters).expect("ten a body");
    let all = DVector::from_column_slice(&parameters);
    let size = mechanism.layout().speeds;
    let mut largest = 0.0_f64;
    for _ in 0..4 {
        let q = configuration(&mut random, mechanism);
        let (v, a) = (numbers(&mut random, size), numbers(&mut random, size));
        dynamics
            .joint_torque_regressor(&q, &v, &a, &mut regressor)
            .expect("a state");
        let of_base = base.regressor(&regressor).expect("the same mechanism");
        let terms = of_base.abs() * (base.matrix().abs() * all.abs());
        let error = of_base * &values - regressor.matrix() * &all;
        largest = largest.max(error.amax() / terms.amax().max(1.0));
    }
    largest
}

#[test]
fn efforts_are_those_of_the_base_parameters_for_every_joint() {
    let mut met = Largest::new("Y π against Y_b B π, of their terms");
    let mut not_minimal = vec![];
    for joint in library() {
        for count in 1..3 {
            let mut random = ChaCha8Rng::seed_from_u64(count as u64);
            let mechanism = chain(&mut random, &joint, count);
            let base = BaseParameters::new(&mechanism).expect("a joint that moves");
            let name = format!("{count} of {}", joint.name());
            met.meet(difference(&mechanism, &base), &name);
            let own = base.certificate();
            println!(
                "{name}: {} of {}, {:.1e} to {:.1e}",
                base.count(),
                base.matrix().ncols(),
                own.smallest,
                own.rounding
            );
            if !own.is_minimal() {
                not_minimal.push(joint.name());
            }
        }
    }
    met.assert_within(ROUNDING);
    not_minimal.dedup();
    // Nonholonomic joints that feel less than X tells.
    assert_eq!(not_minimal, ["car", "pointing"]);
}

fn robot(name: &str, floating_base: bool) -> Arc<Mechanism> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("peers/urdf")
        .join(name);
    let options = hamel::scene::urdf::Options {
        floating_base,
        ..Default::default()
    };
    let text = std::fs::read_to_string(&path).expect("it is in the repository");
    let import = hamel::scene::urdf::read(&text, name, &options);
    let scene = import.and_then(|own| own.build(&hamel_joints::registry()));
    scene.unwrap_or_else(|errors| panic!("{errors}")).mechanism
}

#[test]
fn robots_and_scenes_have_as_many_as_the_literature_says() {
    let plate = scenes::load("plate_cart_arm").mechanism;
    for (name, mechanism, expected) in [
        // Gaz et al., IEEE RA-L 4 (2019).
        ("panda7", robot("panda7.urdf", false), Some(43)),
        // Ten of the body that floats, seven of each that turns on another.
        ("anymal", robot("anymal.urdf", true), Some(10 + 7 * 12)),
        ("g1", robot("g1.urdf", true), None),
        ("plate_cart_arm", plate, None),
    ] {
        let base = BaseParameters::new(&mechanism).expect("joints that move");
        let (certificate, all) = (base.certificate(), base.matrix().ncols());
        println!("{name}: {} of {all}, {certificate:?}", base.count());
        assert!(certificate.is_minimal(), "{name}");
        assert!(difference(&mechanism, &base) < ROUNDING, "{name}");
        if let Some(expected) = expected {
            assert_eq!(base.count(), expected, "{name}");
        }
    }
}
