//! What is handed over: a mechanism with all that there is, and vectors that are wrong in each way.

use crate::common::joints;
use crate::common::random::Random;
use crate::common::trees::{configuration, tree};
use hamel_runtime::elements::{
    BodySpring, BodyWrench, Drive, Element, JointDamper, JointEffort, JointSpring, RotationSpring,
    WrenchAxes,
};
use hamel_runtime::mechanism::{Mechanism, NamedFrame};
use hamel_runtime::spatial::Pose;
use hamel_runtime::time_function::Law;
use nalgebra::{Matrix3, Vector3};
use std::fmt::Debug;
use std::sync::Arc;

/// Vectors that are wrong where one of `count` finite numbers is wanted.
pub fn wrong(count: usize) -> Vec<Vec<f64>> {
    let mut vectors = wrong_sizes(count);
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for place in [0, count / 2, count.saturating_sub(1)] {
            let mut vector = vec![0.25; count];
            if let Some(entry) = vector.get_mut(place) {
                *entry = value;
                vectors.push(vector);
            }
        }
    }
    vectors
}

/// Vectors of other sizes than `count`.
pub fn wrong_sizes(count: usize) -> Vec<Vec<f64>> {
    let sizes = [0, count.saturating_sub(1), count + 1, 2 * count + 7];
    let sizes = sizes.into_iter().filter(|size| *size != count);
    sizes.map(|size| vec![0.25; size]).collect()
}

/// The numbers that no argument may be.
pub const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Indices of nothing.
pub const NOWHERE: [usize; 3] = [5, 1000, usize::MAX];

/// Whether a call refused what it was given.
#[track_caller]
pub fn refused<R: Debug, E: std::fmt::Display>(found: Result<R, E>) {
    let error = found.expect_err("this cannot be right");
    assert!(!error.to_string().is_empty());
}

/// Five joints of all kinds.
pub fn bare() -> Arc<Mechanism> {
    let joints = [
        joints::cart(),
        joints::ball(),
        joints::drift(),
        joints::revolute(),
        joints::planar(),
    ];
    tree(&mut Random::new(21), &joints)
}

/// Every kind of element on a body.
pub fn elements(body: usize) -> Vec<Arc<dyn Element>> {
    let name = || String::from("element");
    vec![
        Arc::new(JointSpring {
            name: name(),
            body,
            stiffness: vec![1.0],
            rest: vec![0.0],
        }),
        Arc::new(RotationSpring {
            name: name(),
            body,
            stiffness: 1.0,
            rest: Matrix3::identity(),
        }),
        Arc::new(JointDamper {
            name: name(),
            body,
            coefficients: vec![0.1],
        }),
        Arc::new(JointEffort {
            name: name(),
            body,
            efforts: vec![0.1],
        }),
        Arc::new(BodySpring {
            name: name(),
            bodies: [Some(body), None],
            points: [Vector3::zeros(), Vector3::new(5.0, 5.0, 5.0)],
            stiffness: 1.0,
            damping: 0.1,
            length: 0.5,
        }),
        Arc::new(BodyWrench {
            name: name(),
            body,
            point: Vector3::zeros(),
            force: Vector3::x(),
            moment: Vector3::y(),
            axes: WrenchAxes::Body,
        }),
    ]
}

/// The same joints with springs, a rotor, a drive and a named frame. Body 3 is on a revolute joint.
pub fn equipped() -> Arc<Mechanism> {
    let frame = NamedFrame {
        name: "tool".into(),
        body: Some(4),
        at: Pose::identity(),
    };
    let drive = Drive {
        name: "drive".into(),
        body: 1,
        laws: vec![Law::default().into(); 3],
    };
    let mechanism = (*bare()).clone();
    let mechanism = mechanism.with_armature(3, &[0.2]).expect("it fits");
    let mechanism = mechanism.with_elements(elements(3)).expect("they fit");
    let mechanism = mechanism.with_drives(vec![drive]).expect("it fits");
    Arc::new(mechanism.with_frames(vec![frame]).expect("it fits"))
}

/// A configuration of it.
pub fn at(mechanism: &Mechanism) -> Vec<f64> {
    configuration(&mut Random::new(5), mechanism)
}
