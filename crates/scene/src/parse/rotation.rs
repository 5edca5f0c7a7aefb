//! Rotation matrices from the ways in which a file may write them.

use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::source::Located;
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::{Pose, hat, so3};
use nalgebra::{Matrix3, Vector3, Vector4};

/// Largest deviation of a quaternion's length from 1 that passes for rounding.
const QUATERNION_TOLERANCE: f64 = 1e-9;

/// Largest angle, rad: rounding alone moves a larger one by more than 1e-10.
const LARGEST_ANGLE: f64 = 1e6;

/// exp(r~) of a rotation vector `r`, rad.
pub(crate) fn from_rotation_vector(
    path: &str,
    r: Located<Vector3<f64>>,
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    check_angles(path, &r, sink)?;
    Some(so3::exp(&r.value))
}

/// The rotation of a unit quaternion `(w, x, y, z)`.
pub(crate) fn from_quaternion(
    path: &str,
    quaternion: Located<Vector4<f64>>,
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    let norm = quaternion.value.norm();
    if (norm - 1.0).abs() > QUATERNION_TOLERANCE || !norm.is_finite() {
        let message = format!(
            "{path} has length {}, which differs from 1 by more than {QUATERNION_TOLERANCE:e}",
            Number(norm)
        );
        sink.push(Diagnostic::new(quaternion.span, message));
        return None;
    }
    Some(unit_quaternion(&quaternion.value))
}

/// The rotation of a quaternion `(w, x, y, z)` of any length but 0.
pub(crate) fn from_any_quaternion(
    path: &str,
    quaternion: Located<Vector4<f64>>,
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    let scale = quaternion.value.amax();
    if scale == 0.0 {
        let message = format!("{path} is zero; a quaternion must have a length");
        sink.push(Diagnostic::new(quaternion.span, message));
        return None;
    }
    Some(unit_quaternion(&(quaternion.value / scale)))
}

/// Rotations about the fixed x, y and z axes in turn, rad: `Rz(yaw) Ry(pitch) Rx(roll)`.
pub(crate) fn from_roll_pitch_yaw(
    path: &str,
    rpy: Located<Vector3<f64>>,
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    check_angles(path, &rpy, sink)?;
    let about = |axis: Vector3<f64>, angle: f64| so3::exp(&(axis * angle));
    let [roll, pitch, yaw] = rpy.value.into();
    Some(about(Vector3::z(), yaw) * about(Vector3::y(), pitch) * about(Vector3::x(), roll))
}

fn check_angles(path: &str, angles: &Located<Vector3<f64>>, sink: &mut Sink) -> Option<()> {
    let largest = angles.value.amax();
    if largest <= LARGEST_ANGLE {
        return Some(());
    }
    let message =
        format!("{path} has an entry of {largest:e} rad, and the limit is {LARGEST_ANGLE:e}");
    sink.push(Diagnostic::new(angles.span.clone(), message));
    None
}

/// A rotation matrix given by rows, freed of its rounding.
pub(crate) fn from_matrix(
    path: &str,
    rotation: Located<Matrix3<f64>>,
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    let Located { value: r, span } = rotation;
    if let Err(error) = Pose::from_rotation(r).check() {
        sink.push(Diagnostic::new(span, format!("{path}: {error}")));
        return None;
    }
    let gram = r.transpose() * r;
    // One Newton–Schulz step towards the nearest rotation squares the error: from 1e-9 to below rounding.
    Some(r * (Matrix3::identity() * 3.0 - gram) * 0.5)
}

/// The vector of length 1 in the direction of `vector`.
pub(crate) fn unit(
    path: &str,
    vector: Located<Vector3<f64>>,
    sink: &mut Sink,
) -> Option<Vector3<f64>> {
    let scale = vector.value.amax();
    if scale == 0.0 {
        let message = format!("{path} is zero; an axis must have a direction");
        sink.push(Diagnostic::new(vector.span, message));
        return None;
    }
    Some((vector.value / scale).normalize())
}

/// The shortest rotation that turns the z axis onto `axis`; about the x axis where `axis` is −z.
pub(crate) fn from_axis(
    path: &str,
    axis: Located<Vector3<f64>>,
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    let a = unit(path, axis, sink)?;
    let across = a.x.hypot(a.y);
    // The quaternion is along (1 + z, −y, x, 0); below the horizontal 1 + z cancels, but equals across² / (1 − z).
    let quaternion = if a.z >= 0.0 {
        Vector4::new(1.0 + a.z, -a.y, a.x, 0.0)
    } else if across > 0.0 {
        Vector4::new(across / (1.0 - a.z), -a.y / across, a.x / across, 0.0)
    } else {
        Vector4::new(0.0, 1.0, 0.0, 0.0)
    };
    Some(unit_quaternion(&quaternion))
}

/// The rotation of `(w, x, y, z)`, normalised here.
pub(crate) fn unit_quaternion(quaternion: &Vector4<f64>) -> Matrix3<f64> {
    let unit = quaternion / quaternion.norm();
    let (w, v) = (unit.x, Vector3::new(unit.y, unit.z, unit.w));
    let hat = hat(&v);
    Matrix3::identity() + (hat * w + hat * hat) * 2.0
}

#[cfg(test)]
mod tests {
    use super::{Sink, from_axis, from_matrix, from_quaternion, from_roll_pitch_yaw};
    use crate::source::Located;
    use hamel_runtime::spatial::so3::exp;
    use nalgebra::{Matrix3, Vector3, Vector4};
    use std::f64::consts::FRAC_PI_2;

    /// A few roundings of numbers up to 1.
    const ROUNDING: f64 = 1e-15;

    fn axis(x: f64, y: f64, z: f64) -> Option<Matrix3<f64>> {
        let axis = Located::new(Vector3::new(x, y, z), 0..1);
        from_axis("axis", axis, &mut Sink::default())
    }

    #[test]
    fn axis_is_reached_by_a_rotation() {
        let axes = [
            (0.0, 0.0, 1.0),
            (0.0, 0.0, -2.0),
            (1e-200, 0.0, -1.0),
            (1e-9, 2e-9, -1.0),
            (3.0, -4.0, 12.0),
            (1e300, 1e300, -1e300),
            (0.0, 5e-324, 0.0),
        ];
        for (x, y, z) in axes {
            let r = axis(x, y, z).expect("a direction");
            let scale = x.abs().max(y.abs()).max(z.abs());
            let wanted = (Vector3::new(x, y, z) / scale).normalize();
            assert!(
                (r * Vector3::z() - wanted).amax() <= ROUNDING,
                "{x} {y} {z}"
            );
            assert!((r.transpose() * r - Matrix3::identity()).amax() <= ROUNDING);
            assert!((r.determinant() - 1.0).abs() <= ROUNDING);
        }
        assert_eq!(axis(0.0, 0.0, 0.0), None);
    }

    #[test]
    fn ways_to_write_one_rotation_agree() {
        let expected = exp(&Vector3::new(0.0, 0.0, FRAC_PI_2));
        let half = FRAC_PI_2 / 2.0;
        let quaternion = Vector4::new(half.cos(), 0.0, 0.0, half.sin());
        let sink = &mut Sink::default();
        let others = [
            from_quaternion("q", Located::new(quaternion, 0..1), sink).expect("unit"),
            from_roll_pitch_yaw(
                "rpy",
                Located::new(Vector3::new(0.0, 0.0, FRAC_PI_2), 0..1),
                sink,
            )
            .expect("small angles"),
            from_matrix(
                "r",
                Located::new(
                    Matrix3::new(0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0),
                    0..1,
                ),
                sink,
            )
            .expect("orthonormal"),
        ];
        for other in others {
            assert!((other - expected).amax() <= ROUNDING);
        }
    }

    #[test]
    fn roll_comes_first() {
        let rpy = Located::new(Vector3::new(FRAC_PI_2, 0.0, FRAC_PI_2), 0..1);
        let r = from_roll_pitch_yaw("rpy", rpy, &mut Sink::default()).expect("small angles");
        // Roll takes y to z, which yaw leaves where it is.
        assert!((r * Vector3::y() - Vector3::z()).amax() <= ROUNDING);
    }

    #[test]
    fn a_matrix_within_tolerance_comes_out_orthonormal() {
        let mut r = exp(&Vector3::new(0.3, -0.2, 0.9));
        r[(0, 1)] += 3e-10;
        let r = from_matrix("r", Located::new(r, 0..1), &mut Sink::default()).expect("near enough");
        assert!((r.transpose() * r - Matrix3::identity()).amax() <= ROUNDING);
    }
}
