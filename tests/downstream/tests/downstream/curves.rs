//! Joints with curves: kernels against the splines in high precision and against differences, inertia by plane geometry, motions over knots, periods and ends.

use hamel::dynamics::{Dynamics, Recursive, Reference};
use hamel::erased::AnyJoint;
use hamel::integrate::{Form, Method, Options, State, integrate, no_inputs, no_observer};
use hamel::joint::{Joint, Member};
use hamel::mechanism::{BodySpec, Mechanism};
use hamel::spatial::{MassProperties, Pose};
use hamel_codegen::expr::curve::Curve;
use hamel_codegen::precise::Precise;
use hamel_compiler::JointType;
use hamel_downstream::joints::{MeasuredRocker, Valley, cam_circle};
use hamel_joints::CamFollower;
use hamel_tests::c99;
use hamel_tests::compiled::{self, Point};
use nalgebra::{Matrix3, SVector, Vector3};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::Arc;

const BITS: usize = 256;
const BASE: f64 = 0.03;
/// kg m², kg
const CAM_INERTIA: f64 = 2e-4;
const FOLLOWER_MASS: f64 = 0.15;
const GRAVITY: f64 = 9.81;

/// Joints with curves, of this crate and of the library, with parameters that they allow.
const WITH_CURVES: [(&str, &[f64]); 5] = [
    ("cam_circle", &[0.7]),
    ("cam_follower", &[0.7]),
    ("measured_rocker", &[]),
    ("rail", &[0.7, 0.2, 0.1]),
    ("valley", &[]),
];

/// The folder in which the spec of a joint stands: this crate's, or the library's.
fn folder(joint: &str) -> PathBuf {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("joints");
    match own.join(format!("{joint}.joint")).exists() {
        true => own,
        false => hamel_tests::spec_folder(),
    }
}

/// The only curve of a joint, as its spec declares it.
fn declared(joint: &str) -> Curve {
    let curves = hamel_tests::derived_in(&folder(joint), joint).spec.curves();
    let [curve] = curves.as_slice() else {
        panic!("`{joint}` has one curve");
    };
    *curve
}

fn exact(curve: Curve, x: f64, order: u8) -> f64 {
    curve.value(&Precise::from_f64(x, BITS), order).to_f64()
}

/// Height of the follower above the base, its slope, and ∂X^c/∂ϕ, the second derivative.
fn follower(theta: f64) -> [f64; 3] {
    let joint = Member::<_, 1>(CamFollower::new(BASE));
    let q = SVector::from([theta]);
    [
        joint.pose(&q).translation[1] - BASE,
        joint.twist_map(&q)[4],
        joint.twist_map_child_gradient(&q)[0][4],
    ]
}

/// Angles between knots, at all knots, just beside them, and after many turns.
fn angles() -> impl Iterator<Item = f64> {
    let knots = (0..=12).map(|i| f64::from(i) * std::f64::consts::PI / 6.0);
    let beside = knots.flat_map(|knot| [knot, knot.next_up(), knot.next_down(), knot + 0.2]);
    beside.flat_map(|x| [0.0, 1.0, -1.0, 57.0].map(|turns| x + turns * std::f64::consts::TAU))
}

#[test]
fn kernels_are_the_spline_in_high_precision() {
    let lift = declared("cam_follower");
    for theta in angles() {
        let found = follower(theta);
        for (order, found) in (0_u8..).zip(found) {
            let value = exact(lift, theta, order);
            // Of each derivative the largest value is some 0.1; an argument of many turns is rounded by so many units.
            let bound = 0.1 * f64::EPSILON * (8.0 + theta.abs());
            assert!(
                (found - value).abs() <= bound,
                "derivative {order} at {theta}: {found:e} instead of {value:e}"
            );
        }
    }
}

#[test]
fn slopes_are_those_of_differences() {
    // Cut off are h⁴ times a fifth derivative of order 10, a few h³ of its jumps at knots; rounding is ε/h.
    let (h, bound) = (1e-3, 1e-8);
    for theta in angles().filter(|theta| theta.abs() < 7.0) {
        let [ahead, behind] = [h, -h].map(|h| follower(theta + h));
        let [further, back] = [2.0 * h, -2.0 * h].map(|h| follower(theta + h));
        let here = follower(theta);
        for order in 0..2 {
            let near = ahead[order] - behind[order];
            let far = further[order] - back[order];
            let slope = (8.0 * near - far) / (12.0 * h);
            let error = (slope - here[order + 1]).abs();
            assert!(error < bound, "derivative {order} at {theta}: {error:e}");
        }
    }
}

/// The text of the emitted joint needs no file beside it.
#[test]
fn knots_of_a_file_are_in_the_emitted_spec() {
    assert!(cam_circle::SPEC.contains("cubic periodic through [0, 0.000], [10, 0.300]"));
    assert!(!cam_circle::SPEC.contains("csv"));
    let again = hamel_codegen::spec::parse(cam_circle::SPEC, "cam_circle.joint");
    let again = again.unwrap_or_else(|errors| panic!("{errors}"));
    assert_eq!(again.curves(), [declared("cam_circle")]);
}

fn built(joint: &str, parameters: &[f64]) -> Arc<dyn AnyJoint> {
    let mut registry = hamel_joints::registry();
    registry
        .extend(hamel_downstream::entries())
        .expect("distinct names");
    let entry = registry.get(joint).expect("registered");
    (entry.build)(parameters).expect("parameters in range")
}

/// The bodies of one joint, each with its mass and its moment of inertia about z, under gravity against y.
fn carried(joint: &Arc<dyn AnyJoint>, masses: &[(f64, f64)]) -> Arc<Mechanism> {
    let joints = std::iter::once(Arc::clone(joint)).chain(joint.more());
    let bodies = joints.zip(masses).enumerate();
    let bodies = bodies.map(|(n, (joint, &(mass, inertia)))| {
        let moments = Matrix3::from_diagonal(&Vector3::new(inertia, inertia, inertia));
        BodySpec {
            name: format!("body {n}"),
            joint_name: "joint".into(),
            parent: None,
            joint,
            placement: Pose::identity(),
            child_placement: Pose::identity(),
            mass: MassProperties::new(mass, Vector3::zeros(), moments).expect("valid"),
        }
    });
    let gravity = Vector3::new(0.0, -GRAVITY, 0.0);
    let mechanism = Mechanism::new(gravity, bodies.collect());
    Arc::new(mechanism.unwrap_or_else(|errors| panic!("{errors:?}")))
}

fn cam() -> Arc<Mechanism> {
    let joint = built("cam_follower", &[BASE]);
    carried(&joint, &[(1.0, CAM_INERTIA), (FOLLOWER_MASS, 1e-5)])
}

/// `(J + m y′²) θ̈ + m y′ y″ θ̇² + m g y′ = 0`
#[test]
fn the_cam_feels_its_follower() {
    let (lift, mechanism) = (declared("cam_follower"), cam());
    for theta in angles().filter(|theta| theta.abs() < 7.0) {
        for rate in [0.0, 11.0, -40.0] {
            let [slope, bend] = [1, 2].map(|order| exact(lift, theta, order));
            let inertia = CAM_INERTIA + FOLLOWER_MASS * slope * slope;
            let effort = FOLLOWER_MASS * slope * (bend * rate * rate + GRAVITY);
            let expected = -effort / inertia;
            let forms: [&mut dyn Dynamics; 2] = [
                &mut Recursive::new(Arc::clone(&mechanism)),
                &mut Reference::new(Arc::clone(&mechanism)),
            ];
            for dynamics in forms {
                let mut found = [0.0];
                dynamics
                    .forward_dynamics(&[theta], &[rate], &[0.0], &mut found)
                    .expect("regular");
                // Rounding of a sum of a few products of which the largest is about 1e3.
                let error = (found[0] - expected).abs() / (1.0 + rate * rate + GRAVITY);
                assert!(error < 1e-12, "at {theta}, {rate}: {error:e}");
            }
        }
    }
}

/// Trees of joints with curves, compiled: in double precision as their lines are evaluated, and in C where there is a compiler, with the same bits.
#[test]
fn compiled_scenes_have_curves() {
    let mut scenes = vec![];
    for (seed, (kind, parameters)) in (0..).zip(WITH_CURVES) {
        let joint = built(kind, parameters);
        let mechanism = carried(&joint, &[(0.3, 0.02), (0.2, 0.03)]);
        let model = compiled::model_on(kind, &mechanism, joint_type);
        let point = || Point::random(model.clone(), &mechanism, seed);
        point().agrees();
        point().derivatives_agree();
        scenes.push((mechanism, model));
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("curves");
    c99::agree(&folder, &scenes, c99::Extent::FEW_SCENES);
}

fn joint_type(name: &str) -> Option<Rc<JointType>> {
    Some(compiled::joint_in(&folder(name), name))
}

fn moved(
    mechanism: &Arc<Mechanism>,
    form: Form,
    (q, v): (f64, f64),
    t_end: f64,
) -> Result<(f64, f64, usize), String> {
    let initial = State {
        time: 0.0,
        configuration: vec![q],
        speeds: vec![v],
    };
    let options = Options {
        form,
        method: Method::dormand_prince(TOLERANCE),
        t_end,
        samples: vec![],
    };
    let mut dynamics = Recursive::new(Arc::clone(mechanism));
    let solution = integrate(
        &mut dynamics,
        &initial,
        &options,
        &mut no_inputs,
        &mut no_observer,
    );
    let solution = solution.map_err(|error| error.to_string())?;
    let State {
        configuration,
        speeds,
        ..
    } = solution.state;
    Ok((configuration[0], speeds[0], solution.statistics.steps))
}

const TOLERANCE: f64 = 1e-10;

fn energy(mechanism: &Mechanism, q: f64, v: f64) -> f64 {
    let kinematics = mechanism.kinematics(&[q], &[v]).expect("sizes fit");
    kinematics.energy()
}

/// Some turns of the cam, each over all knots: nothing adds up.
#[test]
fn energy_is_kept_over_turns_of_a_cam() {
    let mechanism = cam();
    let start = (0.4, 60.0);
    for form in [Form::Lagrangian, Form::Hamiltonian] {
        let (q, v, steps) = moved(&mechanism, form, start, 1.0).expect("regular everywhere");
        assert!(q > 6.0 * std::f64::consts::TAU, "{q}");
        let before = energy(&mechanism, start.0, start.1);
        let drift = (energy(&mechanism, q, v) - before).abs() / before;
        // Each step adds up to the tolerance to a speed, relative to it; energy is quadratic in that.
        let allowed = 2.0 * TOLERANCE * steps as f64;
        assert!(drift < allowed, "{form:?}: {drift:e} in {steps} steps");
    }
}

/// On the straight slopes of a valley a bead is uniformly accelerated, at rest as well as it moves.
#[test]
fn a_curve_goes_on_straight() {
    let mechanism = carried(&built("valley", &[]), &[(0.3, 1e-3)]);
    let height = declared("valley");
    for (x, end) in [(-5.0, -1.0), (4.0, 1.2)] {
        let slope = exact(height, end, 1);
        let q = SVector::from([x]);
        assert!(
            (Valley.pose(&q).translation[1] - exact(height, end, 0) - slope * (x - end)).abs()
                < 1e-14
        );
        for rate in [0.0, 3.0] {
            let mut found = [0.0];
            let mut dynamics = Recursive::new(Arc::clone(&mechanism));
            dynamics
                .forward_dynamics(&[x], &[rate], &[0.0], &mut found)
                .expect("regular");
            let expected = -GRAVITY * slope / (1.0 + slope * slope);
            assert!((found[0] - expected).abs() < 1e-12 * GRAVITY, "at {x}");
        }
    }
}

/// Beyond its ends a curve has no value; how near they are is told, and a motion that leaves ends with the joint's name.
#[test]
fn a_motion_ends_where_its_curve_does() {
    let beyond = SVector::from([4.0_f64]);
    assert!(MeasuredRocker.pose(&beyond).rotation[(0, 0)].is_nan());
    let near = |x: f64| MeasuredRocker.singularity(&SVector::from([x]));
    let last = 7.0 * std::f64::consts::PI / 6.0;
    assert!((near(last - 0.25) - 0.25).abs() < 1e-14);
    let mechanism = carried(&built("measured_rocker", &[]), &[(0.3, 1e-3)]);
    let error = moved(&mechanism, Form::Lagrangian, (3.0, 5.0), 1.0).expect_err("it ends");
    assert!(error.contains("joint"), "{error}");
    let (q, _, _) = moved(&mechanism, Form::Lagrangian, (0.0, 1.0), 1.0).expect("inside");
    assert!(q > 0.5 && q < last);
}
