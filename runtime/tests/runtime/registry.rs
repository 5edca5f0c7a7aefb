//! The registry, and joints behind the object-safe trait.

use crate::common::joints;
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::joint::{KERNEL_INTERFACE, assert_kernel_interface};
use hamel_runtime::registry::{
    DuplicateJoint, JointEntry, JointRegistry, Limit, ParameterError, ParameterInfo,
    check_parameters, check_requirement,
};
use std::sync::Arc;

const _: () = assert_kernel_interface(KERNEL_INTERFACE);

const PARAMETERS: [ParameterInfo; 1] = [ParameterInfo {
    name: "lead",
    unit: "m",
    description: "advance of one turn",
    lower: Some(Limit {
        value: -1.0,
        included: true,
    }),
    upper: Some(Limit {
        value: 2.0,
        included: false,
    }),
}];

fn build(values: &[f64]) -> Result<Arc<dyn AnyJoint>, ParameterError> {
    let [lead] = check_parameters("screw", &PARAMETERS, values)?;
    if lead == 0.0 {
        let (joint, parameter, requirement) = ("screw", "lead", "other than 0");
        return Err(ParameterError::OutOfRange {
            joint,
            parameter,
            value: lead,
            requirement,
        });
    }
    Ok(joints::revolute())
}

fn entry(name: &'static str) -> JointEntry {
    JointEntry {
        name,
        summary: "a test entry",
        parameters: &PARAMETERS,
        build,
    }
}

#[test]
fn names_are_unique_and_sorted() {
    let mut registry = JointRegistry::new();
    registry
        .extend([entry("screw"), entry("ball")])
        .expect("two names");
    assert_eq!(
        registry.insert(entry("ball")),
        Err(DuplicateJoint { name: "ball" })
    );
    assert_eq!(registry.names().collect::<Vec<_>>(), ["ball", "screw"]);
    assert_eq!(registry.entries().count(), 2);
    assert!(registry.get("helix").is_none());
}

#[test]
fn parameters_are_checked() {
    let build = entry("screw").build;
    assert!(build(&[0.01]).is_ok());
    let message = |values: &[f64]| build(values).expect_err("refused").to_string();
    assert_eq!(
        message(&[]),
        "joint type `screw` takes 1 parameter(s), not 0"
    );
    assert_eq!(
        message(&[f64::NAN]),
        "parameter `lead` of joint type `screw` is NaN, not a finite number"
    );
    assert_eq!(
        message(&[0.0]),
        "parameter `lead` of joint type `screw` is 0: it must be other than 0"
    );
    assert!(
        build(&[-1.0]).is_ok(),
        "the lower limit belongs to the range"
    );
    assert_eq!(
        message(&[-1.5]),
        "parameter `lead` of joint type `screw` is -1.5: it must be at least -1"
    );
    assert_eq!(
        message(&[2.0]),
        "parameter `lead` of joint type `screw` is 2: it must be less than 2"
    );
}

#[test]
fn requirements_name_the_values_that_break_them() {
    let check =
        |margin: f64| check_requirement("screw", "lead > 1", margin, &PARAMETERS, &[margin + 1.0]);
    assert_eq!(check(0.5), Ok(()));
    let expected =
        "joint type `screw` requires `lead > 1`: with lead = 0.75 the two sides differ by -0.25";
    assert_eq!(check(-0.25).expect_err("refused").to_string(), expected);
    assert!(check(0.0).is_err(), "a strict inequality");
    assert!(check(f64::NAN).is_err());
}

/// γ and J22 are one matrix in two readings: Σ γ_k v_k p = −J22(p) v.
#[test]
fn erased_kernels_keep_their_meaning() {
    for joint in [joints::ball(), joints::planar(), joints::planar_euclidean()] {
        let layout = joint.layout();
        let size = layout.freedoms;
        let mut q = vec![0.0; layout.configuration];
        joint.home(&mut q);
        let mut moved = q.clone();
        joint.retract(&q, &[0.4, -0.3, 0.9], &mut moved);
        let (v, p) = ([0.3, -0.5, 0.2], [1.0, 0.7, -0.4]);
        let (mut gamma, mut j22) = (vec![0.0; size * size], vec![0.0; size * size]);
        joint.gamma(&moved, &v, &mut gamma);
        joint.j22(&moved, &p, &mut j22);
        for i in 0..size {
            let sum: f64 = (0..size)
                .map(|j| gamma[i + size * j] * p[j] + j22[i + size * j] * v[j])
                .sum();
            assert!(sum.abs() < 1e-14, "a dozen roundings");
        }
        let mut phi = vec![0.0; size];
        joint.local(&q, &moved, &mut phi).expect("a closed form");
        assert!((phi[0] - 0.4).abs() + (phi[1] + 0.3).abs() + (phi[2] - 0.9).abs() < 1e-14);
        assert_eq!(joint.coordinates().len(), layout.configuration);
        assert_eq!(
            (joint.freedoms().len(), joint.speeds().len()),
            (size, layout.speeds)
        );
    }
}

/// The ball of Example 1: S = Q, J22 = −p~ with velocity in parent axes.
#[test]
fn ball_joint_has_the_matrices_of_the_paper() {
    let joint = joints::ball();
    let mut q = [0.0; 9];
    joint.retract(
        &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        &[0.3, -0.8, 0.5],
        &mut q,
    );
    let mut map = [0.0; 9];
    joint.velocity_map(&q, &mut map);
    for (n, entry) in map.iter().enumerate() {
        // Column by column against row by row.
        assert!((entry - q[3 * (n % 3) + n / 3]).abs() < 1e-15);
    }
    let mut j22 = [0.0; 9];
    joint.j22(&q, &[1.0, 2.0, 3.0], &mut j22);
    let expected = -hamel_runtime::spatial::hat(&nalgebra::Vector3::new(1.0, 2.0, 3.0));
    for (found, expected) in j22.iter().zip(expected.iter()) {
        assert!((found - expected).abs() < 1e-14);
    }
}
