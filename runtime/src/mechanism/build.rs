//! Construction of a mechanism: checks, all at once, then assembly.

use super::body::singular_value;
use super::check::CONFIGURATION_TOLERANCE;
use super::rigid::{RigidBody, check_bodies};
use super::several;
use super::{Body, BodySpec, Loci, MechanismError, Ranges};
use crate::erased::{AnyJoint, Layout};
use crate::joint::MOST_FREEDOMS;
use crate::shown::Number;
use crate::spatial::{Pose, SpatialInertia};
use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{DMatrix, Vector3};

/// Smallest over largest pivot of X or S̄ at home: below it, rounding decides what the joint can do.
const RANK_TOLERANCE: f64 = 1e-10;

/// Everything that is wrong with the input of [`Mechanism::new`](super::Mechanism::new).
pub(super) fn check(gravity: &Vector3<f64>, bodies: &[BodySpec]) -> Vec<MechanismError> {
    let rigid: Vec<RigidBody<'_>> = bodies.iter().map(RigidBody::from).collect();
    let mut errors = check_bodies(gravity, &rigid);
    let disordered = several::check(bodies);
    if !disordered.is_empty() {
        errors.extend(disordered);
        return errors;
    }
    for (index, body) in bodies.iter().enumerate() {
        if body.joint.body() == 0 {
            check_joint(&bodies[index..index + several::count(body)], &mut errors);
        }
    }
    errors
}

/// `ground = 1, crank = 0.2`.
fn parameters(joint: &dyn AnyJoint) -> String {
    let mut all = vec![];
    joint.parameters(&mut |name, value| all.push(format!("{name} = {}", Number(value))));
    all.join(", ")
}

/// What is wrong with the joint that carries these bodies.
fn check_joint(bodies: &[BodySpec], errors: &mut Vec<MechanismError>) {
    let Some(body) = bodies.first() else { return };
    let (joint, size) = (&body.joint, body.joint.layout());
    if size.freedoms > MOST_FREEDOMS || size.speeds + size.constraints != size.freedoms {
        errors.push(MechanismError::Layout {
            joint: body.joint_name.clone(),
            freedoms: size.freedoms,
            speeds: size.speeds,
            constraints: size.constraints,
        });
        return;
    }
    let mut home = vec![0.0; size.configuration];
    joint.home(&mut home);
    let residual = joint.residual(&home);
    let finite = home.iter().all(|value| value.is_finite()) && residual.is_finite();
    if !finite && !joint.relations().is_empty() {
        errors.push(MechanismError::Assembly {
            joint: body.joint_name.clone(),
            parameters: parameters(&**joint),
        });
        return;
    }
    if !finite || residual > CONFIGURATION_TOLERANCE {
        errors.push(MechanismError::Home {
            joint: body.joint_name.clone(),
            residual,
            limit: CONFIGURATION_TOLERANCE,
        });
        return;
    }
    if let Some(value) = singular_value(&**joint, &home) {
        errors.push(MechanismError::Singular {
            joint: body.joint_name.clone(),
            loci: Loci(joint.singularities()),
            value,
        });
        return;
    }
    // Of all bodies, below one another.
    let mut twist_map = DMatrix::zeros(6 * bodies.len(), size.freedoms);
    for (number, member) in bodies.iter().enumerate() {
        let mut own = DMatrix::zeros(6, size.freedoms);
        member.joint.twist_map_child(&home, own.as_mut_slice());
        twist_map.rows_mut(6 * number, 6).copy_from(&own);
    }
    // What moves no body has a row of its own in the rank condition.
    let moves = |freedom| bodies.iter().any(|own| own.joint.moves_body(freedom));
    let still = (0..size.freedoms).filter(|&freedom| !moves(freedom));
    let twist_map = twist_map.remove_columns_at(&still.collect::<Vec<_>>());
    let mut speed_basis = DMatrix::zeros(size.freedoms, size.speeds);
    joint.speed_basis(&home, speed_basis.as_mut_slice());
    for (which, matrix) in [("twist map", twist_map), ("speed basis", speed_basis)] {
        let ratio = pivot_ratio(matrix);
        if ratio.is_nan() || ratio < RANK_TOLERANCE {
            errors.push(MechanismError::RankDeficient {
                joint: body.joint_name.clone(),
                which,
                ratio,
                limit: RANK_TOLERANCE,
            });
        }
    }
}

/// Smallest over largest pivot of a matrix with at least as many rows as columns; 0 when it has fewer.
fn pivot_ratio(matrix: DMatrix<f64>) -> f64 {
    let (rows, columns) = matrix.shape();
    if columns == 0 {
        return 1.0;
    }
    if rows < columns {
        return 0.0;
    }
    let triangle = matrix.col_piv_qr().unpack_r();
    let pivots = triangle.diagonal().abs();
    pivots.min() / pivots.max()
}

/// Offsets, joint frames and inertias of checked bodies.
pub(super) fn assemble(specs: Vec<BodySpec>) -> (Vec<Body>, Layout) {
    let mut layout = Layout::default();
    let mut bodies: Vec<Body> = Vec::with_capacity(specs.len());
    for spec in specs {
        let size = spec.joint.layout();
        let ranges = match (spec.joint.body(), bodies.last()) {
            (1.., Some(last)) => last.ranges().next(),
            (_, last) => Ranges::new(&layout, &size, last.map(Body::ranges)),
        };
        layout = Layout {
            configuration: ranges.configuration.end,
            freedoms: ranges.freedoms.end,
            speeds: ranges.speeds.end,
            constraints: ranges.constraints.end,
        };
        let parent_frame = spec
            .parent
            .map_or_else(Pose::identity, |parent| *bodies[parent].child_placement());
        let joint_frame = parent_frame * spec.placement;
        let inertia = SpatialInertia::from(&spec.mass).transform(&spec.child_placement);
        bodies.push(Body::new(spec, ranges, joint_frame, inertia));
    }
    (bodies, layout)
}
