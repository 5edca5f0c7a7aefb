//! Equations of motion in all forms, and what is read off the recursive one.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::tree;
use crate::support::{NOWHERE, at, bare, equipped, refused, wrong, wrong_sizes};
use hamel_runtime::dynamics::{
    Dynamics, ForwardDerivatives, Frame, HamiltonianDerivatives, InverseDerivatives,
    InverseMassMatrix, MassMatrix, Recursive, Reference, Refined,
};
use hamel_runtime::mechanism::Mechanism;
use nalgebra::{DVector, Vector6};
use std::sync::Arc;

fn forms(mechanism: &Arc<Mechanism>) -> [Box<dyn Dynamics>; 3] {
    let mechanism = || Arc::clone(mechanism);
    [
        Box::new(Recursive::new(mechanism())),
        Box::new(Refined::new(mechanism())),
        Box::new(Reference::new(mechanism())),
    ]
}

/// Arguments that are right: q, v̄, τ, and room for one number per speed.
struct Right {
    q: Vec<f64>,
    v: Vec<f64>,
    tau: Vec<f64>,
    room: Vec<f64>,
}

fn right(mechanism: &Mechanism) -> Right {
    let layout = mechanism.layout();
    Right {
        q: at(mechanism),
        v: vec![0.1; layout.speeds],
        tau: vec![0.2; layout.freedoms],
        room: vec![0.0; layout.speeds],
    }
}

#[test]
fn every_form_refuses_other_sizes_and_what_is_not_finite() {
    for mechanism in [bare(), equipped()] {
        let layout = *mechanism.layout();
        let Right { q, v, tau, room } = right(&mechanism);
        let mut given = |_: &[f64], tau: &mut [f64]| tau.fill(0.1);
        for mut dynamics in forms(&mechanism) {
            let mut forward = ForwardDerivatives::new(&mechanism);
            let mut hamiltonian = HamiltonianDerivatives::new(&mechanism);
            let (mut a, mut b) = (room.clone(), room.clone());
            assert!(dynamics.forward_dynamics(&q, &v, &tau, &mut a).is_ok());
            assert!(dynamics.momenta(&q, &v, &mut a).is_ok());
            for bad in wrong(layout.configuration) {
                refused(dynamics.forward_dynamics(&bad, &v, &tau, &mut a));
                refused(dynamics.momenta(&bad, &v, &mut a));
                refused(dynamics.speeds(&bad, &v, &mut a));
                refused(dynamics.momentum_rates(&bad, &v, &mut given, &mut a, &mut b));
                refused(dynamics.hamiltonian(&bad, &v));
                refused(dynamics.forward_dynamics_derivatives(&bad, &v, &tau, &mut forward));
                refused(dynamics.hamiltonian_derivatives(&bad, &v, &tau, &mut hamiltonian));
                refused(dynamics.complete_speeds(&bad, &mut v.clone()));
            }
            for bad in wrong(layout.speeds) {
                refused(dynamics.forward_dynamics(&q, &bad, &tau, &mut a));
                refused(dynamics.momenta(&q, &bad, &mut a));
                refused(dynamics.speeds(&q, &bad, &mut a));
                refused(dynamics.momentum_rates(&q, &bad, &mut given, &mut a, &mut b));
                refused(dynamics.hamiltonian(&q, &bad));
                refused(dynamics.forward_dynamics_derivatives(&q, &bad, &tau, &mut forward));
                refused(dynamics.hamiltonian_derivatives(&q, &bad, &tau, &mut hamiltonian));
                refused(dynamics.complete_speeds(&q, &mut bad.clone()));
            }
            for bad in wrong(layout.freedoms) {
                refused(dynamics.forward_dynamics(&q, &v, &bad, &mut a));
                refused(dynamics.forward_dynamics_derivatives(&q, &v, &bad, &mut forward));
                refused(dynamics.hamiltonian_derivatives(&q, &v, &bad, &mut hamiltonian));
            }
            for mut bad in wrong_sizes(layout.speeds) {
                refused(dynamics.forward_dynamics(&q, &v, &tau, &mut bad));
                refused(dynamics.momenta(&q, &v, &mut bad));
                refused(dynamics.speeds(&q, &v, &mut bad));
                refused(dynamics.momentum_rates(&q, &v, &mut given, &mut bad, &mut a));
                refused(dynamics.momentum_rates(&q, &v, &mut given, &mut a, &mut bad));
            }
            let mut bad = |_: &[f64], tau: &mut [f64]| tau.fill(f64::NAN);
            refused(dynamics.momentum_rates(&q, &v, &mut bad, &mut a, &mut b));
        }
    }
}

#[test]
fn readings_refuse_other_sizes_and_bodies_that_are_not_there() {
    let mechanism = equipped();
    let layout = *mechanism.layout();
    let Right { q, v, tau, room } = right(&mechanism);
    let mut dynamics = Recursive::new(Arc::clone(&mechanism));
    let mut out = room.clone();
    let mut forces = vec![0.0; layout.constraints];
    let mut freedoms = vec![0.0; layout.freedoms];
    for bad in wrong(layout.configuration) {
        refused(dynamics.set_configuration(&bad));
        refused(dynamics.inverse_dynamics(&bad, &v, &v, &mut out));
        refused(dynamics.bias_forces(&bad, &v, &mut out));
        refused(dynamics.joint_efforts(&bad, &mut freedoms));
        refused(dynamics.constraint_force(&bad, &tau, &mut forces));
        refused(dynamics.coupling_force(&bad, &v, &v, &tau, &mut []));
        refused(dynamics.centroidal_map(&bad, &mut vec![0.0; 6 * layout.speeds]));
        refused(dynamics.mass_matrix(&bad, &mut MassMatrix::new(&mechanism)));
        refused(dynamics.inverse_mass_matrix(&bad, &mut InverseMassMatrix::new(&mechanism)));
        refused(dynamics.energy_gradients(&bad, &v, &mut freedoms.clone(), &mut freedoms));
        refused(dynamics.operational_mobility(&bad, 0, Frame::Body));
        refused(dynamics.operational_inertia(&bad, 0, Frame::Body));
        refused(dynamics.readings(&bad, &v).map(|_| ()));
    }
    for bad in wrong(layout.speeds) {
        refused(dynamics.inverse_dynamics(&q, &bad, &v, &mut out));
        refused(dynamics.inverse_dynamics(&q, &v, &bad, &mut out));
        refused(dynamics.bias_forces(&q, &bad, &mut out));
        refused(dynamics.coupling_force(&q, &bad, &v, &tau, &mut []));
        refused(dynamics.coupling_force(&q, &v, &bad, &tau, &mut []));
        refused(dynamics.energy_gradients(&q, &bad, &mut freedoms.clone(), &mut freedoms));
        refused(dynamics.readings(&q, &bad).map(|_| ()));
    }
    for bad in wrong(layout.freedoms) {
        refused(dynamics.constraint_force(&q, &bad, &mut forces));
        refused(dynamics.coupling_force(&q, &v, &v, &bad, &mut []));
    }
    for mut bad in wrong_sizes(layout.speeds) {
        refused(dynamics.inverse_dynamics(&q, &v, &v, &mut bad));
        refused(dynamics.bias_forces(&q, &v, &mut bad));
        refused(MassMatrix::new(&mechanism).solve(&mut bad));
    }
    for mut bad in wrong_sizes(layout.freedoms) {
        refused(dynamics.joint_efforts(&q, &mut bad));
        refused(dynamics.energy_gradients(&q, &v, &mut bad, &mut freedoms));
        refused(dynamics.energy_gradients(&q, &v, &mut freedoms, &mut bad));
    }
    for mut bad in wrong_sizes(layout.constraints) {
        refused(dynamics.constraint_force(&q, &tau, &mut bad));
    }
    for mut bad in wrong_sizes(6 * layout.speeds) {
        refused(dynamics.centroidal_map(&q, &mut bad));
    }
    for index in NOWHERE {
        assert!(dynamics.joint_wrench(index).is_none());
        refused(dynamics.operational_mobility(&q, index, Frame::Body));
        refused(dynamics.operational_inertia(&q, index, Frame::World));
    }
    let readings = dynamics.readings(&q, &v).expect("right");
    for index in NOWHERE {
        refused(readings.pose(index));
        refused(readings.twist(index, Frame::Body));
        refused(readings.frame(index).map(|_| ()));
        refused(readings.body_frame(index).map(|_| ()));
        refused(readings.jacobian(index, Frame::Body, &mut []));
        refused(readings.jacobian_product(index, Frame::Body, &v));
        let wrench = Vector6::zeros();
        refused(readings.jacobian_transpose_product(index, Frame::Body, &wrench, &mut out));
    }
    let frame = readings.frame(0).expect("there is one");
    for mut bad in wrong_sizes(6 * layout.speeds) {
        refused(frame.jacobian(Frame::World, &mut bad));
    }
    for mut bad in wrong_sizes(layout.speeds) {
        refused(frame.jacobian_product(Frame::World, &bad));
        refused(frame.jacobian_transpose_product(Frame::World, &Vector6::zeros(), &mut bad));
    }
    for mut bad in wrong_sizes(6 * layout.freedoms) {
        refused(frame.local_jacobian(Frame::World, &mut bad));
        refused(frame.twist_gradient(Frame::World, &mut bad));
    }
}

/// As many speeds, and another tree: six joints of one speed, two of three.
#[test]
fn results_that_were_made_for_another_tree_are_refused() {
    let chain = |joints: &[_]| tree(&mut Random::new(3), joints);
    let single: Vec<_> = (0..6).map(|_| joints::revolute()).collect();
    let own = chain(&single);
    let other = chain(&[joints::ball(), joints::ball()]);
    assert_eq!(own.layout().speeds, other.layout().speeds);
    let Right { q, v, tau, .. } = right(&own);
    let mut dynamics = Recursive::new(Arc::clone(&own));
    let mut forward = ForwardDerivatives::new(&other);
    let mut hamiltonian = HamiltonianDerivatives::new(&other);
    let mut inverse = InverseDerivatives::new(&other);
    refused(dynamics.forward_dynamics_derivatives(&q, &v, &tau, &mut forward));
    refused(dynamics.hamiltonian_derivatives(&q, &v, &tau, &mut hamiltonian));
    refused(dynamics.inverse_dynamics_derivatives(&q, &v, &v, &mut inverse));
    for mechanism in [bare(), equipped()] {
        let mut forward = ForwardDerivatives::new(&mechanism);
        refused(dynamics.forward_dynamics_derivatives(&q, &v, &tau, &mut forward));
        refused(dynamics.mass_matrix(&q, &mut MassMatrix::new(&mechanism)));
        refused(dynamics.inverse_mass_matrix(&q, &mut InverseMassMatrix::new(&mechanism)));
    }
    let matrix = MassMatrix::new(&own);
    assert_eq!(matrix.entry(usize::MAX / 8, 3), 0.0);
}

#[test]
fn matrices_at_vectors_of_other_sizes_are_nan_or_errors() {
    for mechanism in [bare(), equipped()] {
        let Right { q, v, tau, .. } = right(&mechanism);
        let expansion = Reference::new(Arc::clone(&mechanism))
            .expansion(&q)
            .expect("right");
        let whole = |values: Vec<f64>| DVector::from_vec(values);
        let (speeds, efforts) = (whole(v.clone()), whole(tau.clone()));
        for bad in wrong_sizes(mechanism.layout().freedoms) {
            let bad = whole(bad);
            let rates = [
                expansion.local_rate(&bad),
                expansion.hamiltonian_gradient(&bad),
                expansion.momentum_rate(&bad, &efforts),
                expansion.momentum_rate(&efforts, &bad),
                expansion.reduced_momentum_rate(&speeds, &bad),
            ];
            assert!(rates.iter().all(|rate| rate.iter().any(|x| x.is_nan())));
            expansion.mass_matrix_rate(&bad);
            expansion.coriolis_matrix(&bad);
            expansion.coriolis_matrix_skew(&bad);
            expansion.j22(&bad);
            refused(expansion.accelerations(&mechanism, &bad, &efforts));
            refused(expansion.accelerations(&mechanism, &efforts, &bad));
            refused(expansion.reduced_accelerations(&mechanism, &speeds, &bad));
            refused(expansion.constraint_force(&mechanism, &speeds, &bad));
        }
        for bad in wrong_sizes(mechanism.layout().speeds) {
            let bad = whole(bad);
            expansion.speed_basis_rate(&bad);
            expansion.reduced_coriolis_matrix(&bad);
            expansion.reduced_j22(&bad);
            expansion.reduced_hamiltonian_gradient(&bad);
            expansion.reduced_momentum_rate(&bad, &efforts);
            refused(expansion.reduced_accelerations(&mechanism, &bad, &efforts));
            refused(expansion.speeds(&mechanism, &bad));
            refused(expansion.constraint_force(&mechanism, &bad, &efforts));
        }
    }
}

#[test]
fn finite_numbers_that_come_to_infinite_ones_are_told() {
    let mechanism = bare();
    let Right {
        q, tau, mut room, ..
    } = right(&mechanism);
    let fast = vec![1e200; room.len()];
    for mut dynamics in [
        Box::new(Recursive::new(Arc::clone(&mechanism))) as Box<dyn Dynamics>,
        Box::new(Refined::new(Arc::clone(&mechanism))),
    ] {
        let error = dynamics
            .forward_dynamics(&q, &fast, &tau, &mut room)
            .expect_err("squares of 1e200");
        assert!(error.to_string().contains("finite"), "{error}");
        assert!(!error.to_string().contains("mass matrix"), "{error}");
    }
}
