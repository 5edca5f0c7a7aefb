//! Named frames: Jacobians, their rates and their gradients against dual numbers and differences; operational-space inertia against products of
//! dense matrices, and closed forms.

use chacha20::ChaCha8Rng;
use hamel::dynamics::{Dynamics, DynamicsError, Frame, Recursive};
use hamel::erased::AnyJoint;
use hamel::mechanism::{Mechanism, MechanismError, NamedFrame, StateError};
use hamel::nalgebra::{DMatrix, DVector, Matrix6, Vector3, Vector6};
use hamel::scalar::Dual;
use hamel::spatial::{Pose, SpatialInertia, so3, vee};
use hamel_tests::derivatives::{Actuation, DualForm};
use hamel_tests::differences::{FINE, derivative, moved};
use hamel_tests::figures::{Largest, difference, size};
use hamel_tests::random::{Case, cases, chain, configuration, library, numbers, without_knots};
use rand::{RngExt, SeedableRng};
use std::cell::RefCell;
use std::sync::Arc;

const AXES: [Frame; 3] = [Frame::Body, Frame::World, Frame::WorldAligned];

/// Of kinematics up to 20 joints deep: some hundred roundings of entries up to their largest.
const ROUNDING: f64 = 1e-13;

fn frame(random: &mut ChaCha8Rng, name: &str, body: Option<usize>) -> NamedFrame {
    let mut vector = || Vector3::from_fn(|_, _| random.random_range(-1.0..1.0));
    NamedFrame {
        name: name.to_owned(),
        body,
        at: Pose::new(so3::exp(&(vector() * 2.0)), vector()),
    }
}

/// A case with a frame `tool` on its last body and a frame `floor` of the world.
fn framed(case: Case) -> Case {
    let mut random = ChaCha8Rng::seed_from_u64(case.seed);
    let last = case.mechanism.bodies().len() - 1;
    let frames = vec![
        frame(&mut random, "tool", Some(last)),
        frame(&mut random, "floor", None),
    ];
    let mechanism = (*case.mechanism).clone().with_frames(frames);
    let mechanism = Arc::new(mechanism.expect("they fit"));
    Case { mechanism, ..case }
}

fn all() -> Vec<Case> {
    on(&library())
}

fn on(kinds: &[Arc<dyn AnyJoint>]) -> Vec<Case> {
    cases(kinds, 20, 60).map(framed).collect()
}

fn place(case: &Case) -> String {
    let root = case.mechanism.bodies()[0].joint().name();
    let count = case.mechanism.bodies().len();
    format!("case {} of {count} bodies on {root}", case.seed)
}

/// The frame `tool` in the child frame of its joint.
fn fixed(mechanism: &Mechanism) -> (usize, Pose<f64>) {
    let tool = &mechanism.frames()[0];
    let body = tool.body.expect("a body");
    (body, *mechanism.bodies()[body].child_placement() * tool.at)
}

/// A matrix of 6 rows that a method fills.
fn filled(columns: usize, fill: impl FnOnce(&mut [f64]) -> Result<(), StateError>) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(6, columns);
    fill(matrix.as_mut_slice()).expect("sizes fit");
    matrix
}

/// A twist in the frame's own axes, read as `axes` has it.
fn seen(axes: Frame, pose: &Pose<Dual<f64>>, own: &Vector6<Dual<f64>>) -> Vector6<Dual<f64>> {
    match axes {
        Frame::Body => *own,
        Frame::World => pose.act_twist(own),
        Frame::WorldAligned => Pose::from_rotation(pose.rotation).act_twist(own),
    }
}

fn constants(values: &[f64]) -> Vec<Dual<f64>> {
    values.iter().map(|value| Dual::constant(*value)).collect()
}

/// The twist of a pose in dual numbers, in its own axes.
fn rate(pose: &Pose<Dual<f64>>) -> Vector6<Dual<f64>> {
    let values = |pose: &Pose<Dual<f64>>| {
        (
            pose.rotation.map(|entry| entry.value),
            pose.rotation.map(|entry| entry.derivative()),
            pose.translation.map(|entry| entry.derivative()),
        )
    };
    let (rotation, turn, slide) = values(pose);
    let back = rotation.transpose();
    let (angular, linear): (Vector3<f64>, Vector3<f64>) = (vee(&(back * turn)), back * slide);
    hamel::spatial::join(&angular, &linear).map(Dual::constant)
}

#[test]
fn gradients_are_those_of_dual_numbers() {
    let mut worst = ["displacements under ϕ", "∂(J v̄)/∂ϕ"].map(Largest::new);
    for case in all() {
        let (body, fixed) = fixed(&case.mechanism);
        let form = DualForm::new(&case.mechanism, Actuation::default());
        let freedoms = case.efforts.len();
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let readings = dynamics.readings(&case.q, &case.speeds).expect("sizes fit");
        let tool = readings.frame(0).expect("a frame");
        let v = constants(&case.speeds);
        for axes in AXES {
            let found = [
                filled(freedoms, |out| tool.local_jacobian(axes, out)),
                filled(freedoms, |out| tool.twist_gradient(axes, out)),
            ];
            let mut expected = [DMatrix::zeros(6, freedoms), DMatrix::zeros(6, freedoms)];
            for k in 0..freedoms {
                let moved = form.moved(&case.q, k);
                let (pose, own) = form.frame((&moved, &v), body, &fixed);
                let way = seen(axes, &pose, &rate(&pose)).map(|entry| entry.value);
                let change = seen(axes, &pose, &own).map(|entry| entry.derivative());
                expected[0].set_column(k, &way);
                expected[1].set_column(k, &change);
            }
            for ((worst, found), expected) in worst.iter_mut().zip(&found).zip(&expected) {
                let error = difference(found.as_slice(), expected.as_slice());
                worst.meet(error / size(expected.as_slice()).max(1.0), place(&case));
            }
        }
    }
    worst.iter().for_each(|worst| worst.assert_within(ROUNDING));
}

/// ϕ̇ of all joints at v̄.
fn local_rates(case: &Case) -> DVector<f64> {
    let velocity = case
        .mechanism
        .velocity_from_speeds(&case.q, &case.speeds)
        .expect("sizes fit");
    let mut rates = DVector::zeros(velocity.len());
    for (_, body) in case.mechanism.joints() {
        let own = body.ranges().freedoms.clone();
        let mut inverse = DMatrix::zeros(own.len(), own.len());
        body.joint()
            .velocity_map_inverse(body.configuration(&case.q), inverse.as_mut_slice());
        let own_rates = inverse * DVector::from_column_slice(&velocity[own.clone()]);
        rates.rows_mut(own.start, own.len()).copy_from(&own_rates);
    }
    rates
}

/// `J v̄` is the twist and the displacement under ϕ̇; `J̇ v̄` is the change of `J v̄` under ϕ̇ at fixed v̄, by the gradient and by differences.
#[test]
fn rates_of_jacobians() {
    let mut worst = ["J v̄", "J̇ v̄", "J̇ v̄ by differences"].map(Largest::new);
    for case in on(&without_knots()) {
        let (freedoms, speeds) = (case.efforts.len(), case.speeds.len());
        let phi_rate = local_rates(&case);
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let v = DVector::from_column_slice(&case.speeds);
        for axes in AXES {
            let readings = dynamics.readings(&case.q, &case.speeds).expect("sizes fit");
            let tool = readings.frame(0).expect("a frame");
            let twist = tool.twist(axes);
            let scale = twist.norm().max(1.0) * phi_rate.norm().max(1.0);
            let by_speeds = filled(speeds, |out| tool.jacobian(axes, out)) * &v;
            let by_locals = filled(freedoms, |out| tool.local_jacobian(axes, out)) * &phi_rate;
            for product in [by_speeds, by_locals] {
                let error = difference(product.as_slice(), twist.as_slice());
                worst[0].meet(error / scale, place(&case));
            }
            let bias = tool.jacobian_rate_product(axes);
            let changed = filled(freedoms, |out| tool.twist_gradient(axes, out)) * &phi_rate;
            let error = difference(changed.as_slice(), bias.as_slice());
            worst[1].meet(error / scale, place(&case));
            let reader = RefCell::new(Recursive::new(Arc::clone(&case.mechanism)));
            let along = derivative(FINE, |t| {
                let phi: Vec<f64> = phi_rate.iter().map(|rate| rate * t).collect();
                let q = moved(&case.mechanism, &case.q, &phi);
                let mut reader = reader.borrow_mut();
                let readings = reader.readings(&q, &case.speeds).expect("sizes fit");
                let tool = readings.frame(0).expect("a frame");
                DMatrix::from_column_slice(6, 1, tool.twist(axes).as_slice())
            });
            let error = difference(along.as_slice(), bias.as_slice());
            worst[2].meet(error / scale, place(&case));
        }
    }
    let [exact, bias, differences] = &worst;
    exact.assert_within(ROUNDING);
    bias.assert_within(ROUNDING);
    // Differences of order 6 leave 1e-13 of functions that vary over lengths of order 1; a chain of 20 joints in motion varies as
    // (Σ|ϕ̇|)⁷ h⁶ / 140 ~ 1e-10 of its size. Loops bend more, and are differenced by smaller steps.
    differences.assert_within(1e-9);
}

/// `J M̄⁻¹ Jᵀ`, column by column.
fn mobility(case: &Case, axes: Frame) -> Matrix6<f64> {
    let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
    let columns: [Vector6<f64>; 6] = std::array::from_fn(|i| {
        let mut unit = Vector6::zeros();
        unit[i] = 1.0;
        let mut efforts = vec![0.0; case.speeds.len()];
        let readings = dynamics.readings(&case.q, &case.speeds).expect("sizes fit");
        let tool = readings.frame(0).expect("a frame");
        let made = tool.jacobian_transpose_product(axes, &unit, &mut efforts);
        made.expect("sizes fit");
        let mut response = vec![0.0; efforts.len()];
        let solved = dynamics.speeds(&case.q, &efforts, &mut response);
        solved.expect("every body has mass");
        let readings = dynamics.readings(&case.q, &response).expect("sizes fit");
        readings.frame(0).expect("a frame").twist(axes)
    });
    Matrix6::from_columns(&columns)
}

#[test]
fn operational_mobility_is_the_response_to_wrenches() {
    let mut worst = Largest::new("J M̄⁻¹ Jᵀ");
    for case in all() {
        let actuation = Actuation::random(&case.mechanism, &case.q, case.seed);
        let rotors = Case {
            mechanism: actuation.equip(&case.mechanism),
            ..case.clone()
        };
        for case in [case, rotors] {
            let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
            for axes in AXES {
                let found = dynamics.operational_mobility(&case.q, 0, axes);
                let found = found.expect("every body has mass");
                let expected = mobility(&case, axes);
                let error = difference(found.as_slice(), expected.as_slice());
                worst.meet(error / size(expected.as_slice()).max(1.0), place(&case));
            }
        }
    }
    // Both solve with M̄, whose condition reaches 1e4 on such trees.
    worst.assert_within(1e-12);
}

/// A frame on a free body feels the body's own inertia.
#[test]
fn a_free_body_has_its_own_inertia() {
    let kinds = library();
    let free = kinds.iter().find(|joint| joint.name() == "free");
    let free = free.expect("a joint of the library");
    let mut worst = Largest::new("Λ of a free body");
    for seed in 0..20 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mechanism = chain(&mut random, free, 1);
        let tool = frame(&mut random, "tool", Some(0));
        let body = &mechanism.bodies()[0];
        let inertia = SpatialInertia::from(body.mass()).transform(&tool.at.inverse());
        let expected = Matrix6::from_columns(&std::array::from_fn::<_, 6, _>(|i| {
            let mut unit = Vector6::zeros();
            unit[i] = 1.0;
            inertia.apply(&unit)
        }));
        let framed = (*mechanism).clone().with_frames(vec![tool]);
        let framed = Arc::new(framed.expect("it fits"));
        let q = configuration(&mut random, &framed);
        let found = Recursive::new(framed).operational_inertia(&q, 0, Frame::Body);
        let found = found.expect("six ways to move");
        let error = difference(found.as_slice(), expected.as_slice());
        worst.meet(error / size(expected.as_slice()), seed);
    }
    // The condition of such an inertia is some 100.
    worst.assert_within(1e-13);
}

/// A point that turns about a fixed axis with ω at distance r accelerates with ω² r towards it.
#[test]
fn a_turning_point_accelerates_to_its_axis() {
    let kinds = library();
    let revolute = kinds.iter().find(|joint| joint.name() == "revolute");
    let revolute = revolute.expect("a joint of the library");
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let mechanism = chain(&mut random, revolute, 1);
    let at = mechanism.bodies()[0].child_placement().inverse();
    let (omega, r) = (3.0, 0.25);
    let tool = NamedFrame {
        name: "tool".to_owned(),
        body: Some(0),
        at: at * Pose::from_translation(Vector3::new(r, 0.0, 0.4)),
    };
    let framed = (*mechanism).clone().with_frames(vec![tool]);
    let mut dynamics = Recursive::new(Arc::new(framed.expect("it fits")));
    let (q, v) = ([0.7], [omega]);
    let readings = dynamics.readings(&q, &v).expect("sizes fit");
    let tool = readings.frame(0).expect("a frame");
    let bias = tool.jacobian_rate_product(Frame::WorldAligned);
    let inward = tool.pose().rotation * Vector3::new(-omega * omega * r, 0.0, 0.0);
    let expected = hamel::spatial::join(&Vector3::zeros(), &inward);
    // A few roundings of numbers up to 9.
    assert!((bias - expected).amax() < 1e-14, "{bias}");
    // In its own axes the frame's twist does not change.
    assert!(tool.jacobian_rate_product(Frame::Body).amax() < 1e-14);
}

#[test]
fn frames_that_cannot_move_in_all_ways_are_refused_by_name() {
    for case in all().into_iter().take(30) {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        let refused = dynamics.operational_inertia(&case.q, 1, Frame::World);
        let error = refused.expect_err("a frame of the world");
        assert!(matches!(error, DynamicsError::SingularFrame { .. }));
        assert!(error.to_string().contains("`floor`"), "{error}");
        assert!(error.to_string().contains("`angular x`"), "{error}");
        // The tool of a body with few degrees of freedom moves in as many ways.
        let few = case.speeds.len() < 6;
        match dynamics.operational_inertia(&case.q, 0, Frame::Body) {
            Ok(_) => assert!(!few, "{}", place(&case)),
            Err(error) => assert!(error.to_string().contains("`tool`"), "{error}"),
        }
    }
}

/// Λ undoes the response to wrenches, in all axes.
#[test]
fn operational_inertia_undoes_the_mobility() {
    let mut worst = Largest::new("Λ J M̄⁻¹ Jᵀ, over its condition");
    let mut invertible = 0;
    for case in all() {
        let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
        for axes in AXES {
            let Ok(inertia) = dynamics.operational_inertia(&case.q, 0, axes) else {
                continue;
            };
            invertible += 1;
            let mobility = mobility(&case, axes);
            let singular = mobility.singular_values();
            let condition = singular.max() / singular.min();
            let error = (inertia * mobility - Matrix6::identity()).amax();
            worst.meet(error / condition, place(&case));
        }
    }
    // Every tool that can move in all ways, in all axes: one in two or three.
    assert!(invertible >= 100, "{invertible} invertible");
    // Rounding of three solves and products of up to 24 columns, a few hundred times 1.1e-16.
    worst.assert_within(1e-13);
}

#[test]
fn misfits_are_named() {
    let kinds = library();
    let case = cases(&kinds, 1, 1).next().expect("one case");
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut skew = frame(&mut random, "skew", Some(0));
    skew.at.rotation *= 2.0;
    let frames = vec![
        frame(&mut random, "twice", Some(0)),
        frame(&mut random, "twice", None),
        frame(&mut random, "far", Some(7)),
        frame(&mut random, "body 0", Some(0)),
        skew,
    ];
    let errors = (*case.mechanism).clone().with_frames(frames);
    let errors = errors.expect_err("nothing fits");
    assert!(
        errors
            .iter()
            .all(|error| matches!(error, MechanismError::Frame { .. }))
    );
    let messages: Vec<String> = errors.iter().map(ToString::to_string).collect();
    let starts = [
        "frame `twice`: frame 0 has the name already",
        "frame `far`: there is no body of index 7, the mechanism has 1",
        "frame `body 0`: body 0 has the name already",
        "frame `skew`: ",
    ];
    assert_eq!(messages.len(), starts.len(), "{messages:?}");
    for (message, start) in messages.iter().zip(starts) {
        assert!(message.starts_with(start), "{message}");
    }
    let case = framed(case);
    assert_eq!(case.mechanism.frame_index("floor"), Some(1));
    let mut dynamics = Recursive::new(Arc::clone(&case.mechanism));
    let unknown = StateError::UnknownFrame { index: 2, count: 2 };
    let readings = dynamics.readings(&case.q, &case.speeds).expect("sizes fit");
    assert_eq!(readings.frame(2).map(|_| ()), Err(unknown.clone()));
    let tool = readings.frame(0).expect("a frame");
    let mut few = numbers(&mut random, 5);
    assert!(tool.jacobian(Frame::Body, &mut few).is_err());
    assert!(tool.twist_gradient(Frame::Body, &mut few).is_err());
    let found = dynamics.operational_mobility(&case.q, 2, Frame::Body);
    assert_eq!(found, Err(DynamicsError::State(unknown)));
}
