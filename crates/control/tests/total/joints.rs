//! Kernels of joints behind slices: NaN for what is of another size, and errors where there can be some.

use crate::common::joints;
use crate::common::polar::polar;
use crate::support::wrong_sizes;
use hamel_runtime::erased::AnyJoint;
use nalgebra::Vector6;
use std::sync::Arc;

fn all() -> Vec<Arc<dyn AnyJoint>> {
    vec![
        joints::revolute(),
        joints::ball(),
        joints::cart(),
        joints::drift(),
        joints::planar(),
        joints::planar_euclidean(),
        polar(1.0),
    ]
}

/// Calls a kernel with `q`, another argument, and room for results.
type Kernel = fn(&dyn AnyJoint, &[f64], &[f64], &mut [f64]);

/// From K and S, the sizes of the second argument and of the results.
type Sizes = fn(usize, usize) -> (usize, usize);

/// Kernels with the sizes of their second argument (0 for none) and of their results, in K and S.
fn kernels() -> Vec<(Kernel, Sizes)> {
    vec![
        (|j, q, _, out| j.twist_map(q, out), |k, _| (0, 6 * k)),
        (|j, q, _, out| j.twist_map_child(q, out), |k, _| (0, 6 * k)),
        (
            |j, q, _, out| j.twist_map_child_gradient(q, out),
            |k, _| (0, 6 * k * k),
        ),
        (|j, q, _, out| j.velocity_map(q, out), |k, _| (0, k * k)),
        (
            |j, q, _, out| j.velocity_map_inverse(q, out),
            |k, _| (0, k * k),
        ),
        (
            |j, q, _, out| j.velocity_map_gradient(q, out),
            |k, _| (0, k * k * k),
        ),
        (|j, q, v, out| j.gamma(q, v, out), |k, _| (k, k * k)),
        (|j, q, p, out| j.j22(q, p, out), |k, _| (k, k * k)),
        (|j, q, _, out| j.speed_basis(q, out), |k, s| (0, k * s)),
        (
            |j, q, _, out| j.speed_basis_gradient(q, out),
            |k, s| (0, k * k * s),
        ),
        (
            |j, q, phi, out| j.retract_differential(q, phi, out),
            |k, _| (k, k * k),
        ),
        (
            |j, q, phi, out| j.retract_differential_inverse(q, phi, phi, out),
            |k, _| (k, k),
        ),
        (
            |j, q, v, out| j.bias_momentum(q, v, &Vector6::repeat(0.5), out),
            |_, s| (s, s),
        ),
        (|j, q, _, out| j.local_twist_map(q, out), |k, _| (0, 6 * k)),
        (
            |j, q, v, out| j.twist_gradient(q, v, out),
            |k, s| (s, 6 * k),
        ),
        (
            |j, q, _, out| j.effort_gradient(q, &Vector6::repeat(0.5), out),
            |k, s| (0, s * k),
        ),
        (
            |j, q, v, out| j.twist_map_rate(q, v, out),
            |_, s| (s, 6 * s),
        ),
        (
            |j, q, v, out| j.bias_acceleration_gradient(q, v, out),
            |k, s| (s, 6 * k),
        ),
        (
            |j, q, v, out| j.bias_acceleration_slope(q, v, out),
            |_, s| (s, 6 * s),
        ),
        (
            |j, q, v, out| j.bias_momentum_gradient(q, v, &Vector6::repeat(0.5), out),
            |k, s| (s, s * k),
        ),
        (
            |j, q, _, out| j.bias_momentum_slope(q, &Vector6::repeat(0.5), out),
            |_, s| (s, s * s),
        ),
    ]
}

#[test]
fn kernels_of_other_sizes_are_nan() {
    for joint in all() {
        let layout = joint.layout();
        let mut home = vec![0.0; layout.configuration];
        joint.home(&mut home);
        for (number, (kernel, sizes)) in kernels().into_iter().enumerate() {
            let (given, results) = sizes(layout.freedoms, layout.speeds);
            let told = format!("{} kernel {number}", joint.name());
            let mut out = vec![0.0; results];
            kernel(&*joint, &home, &vec![0.1; given], &mut out);
            assert!(out.iter().all(|x| x.is_finite()), "{told}: its own sizes");
            for room in wrong_sizes(results) {
                let mut room = room;
                kernel(&*joint, &home, &vec![0.1; given], &mut room);
                assert!(room.iter().all(|x| x.is_nan()), "{told}: other room");
            }
            for q in wrong_sizes(layout.configuration) {
                // What does not depend on Q does not look at it.
                kernel(&*joint, &q, &vec![0.1; given], &mut out);
            }
            for other in wrong_sizes(given) {
                kernel(&*joint, &home, &other, &mut out);
            }
        }
    }
}

#[test]
fn finite_maps_of_other_sizes_are_errors_or_nan() {
    for joint in all() {
        let layout = joint.layout();
        let mut home = vec![0.0; layout.configuration];
        joint.home(&mut home);
        let phi = vec![0.1; layout.freedoms];
        for mut q in wrong_sizes(layout.configuration) {
            let mut out = home.clone();
            joint.home(&mut q);
            joint.retract(&q, &phi, &mut out);
            assert!(out.iter().any(|x| x.is_nan()), "{}", joint.name());
            joint.configuration_rate(&q, &phi, &mut out);
            joint.pose(&q);
            joint.residual(&q);
            joint.singularity(&q);
            joint.bias_acceleration(&q, &[]);
            joint.constraint(&q, &mut []);
            joint.local_rate(&q, &phi, &home, &[], &mut phi.clone());
            assert!(joint.local(&q, &home, &mut phi.clone()).is_err());
            assert!(joint.local(&home, &q, &mut phi.clone()).is_err());
            assert!(joint.project(&mut q).is_err(), "{}", joint.name());
        }
        for mut phi in wrong_sizes(layout.freedoms) {
            let mut out = home.clone();
            joint.retract(&home, &phi, &mut out);
            assert!(out.iter().any(|x| x.is_nan()), "{}", joint.name());
            assert!(joint.local(&home, &home, &mut phi).is_err());
        }
    }
}
