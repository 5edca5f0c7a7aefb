//! A pose in the way that suits its rotation: an axis, angles, a rotation vector, or the matrix.

use super::value::{list, rows, table};
use crate::parse::rotation;
use crate::read::Sink;
use crate::source::Located;
use hamel_runtime::spatial::{Pose, so3};
use nalgebra::{Matrix3, Vector3};

/// Largest entry of the difference between a rotation and what is written for it: two roundings of 1.
const CLOSE: f64 = 2.0 * f64::EPSILON;

/// The table of a pose; `None` for the identity.
pub(super) fn pose(pose: &Pose<f64>) -> Option<String> {
    let mut entries = Vec::new();
    if pose.translation != Vector3::zeros() {
        entries.push(("position", list(&pose.translation)));
    }
    if pose.rotation != Matrix3::identity() {
        entries.push(written(&pose.rotation));
    }
    (!entries.is_empty()).then(|| table(&entries))
}

type Reader = fn(&str, Located<Vector3<f64>>, &mut Sink) -> Option<Matrix3<f64>>;

/// Three numbers where they give the rotation, few digits first; else the matrix.
fn written(r: &Matrix3<f64>) -> (&'static str, String) {
    let ways: [(&str, Vector3<f64>, Reader); 3] = [
        ("axis", r.column(2).into_owned(), rotation::from_axis),
        ("rpy", roll_pitch_yaw(r), rotation::from_roll_pitch_yaw),
        (
            "rotation_vector",
            so3::log(r),
            rotation::from_rotation_vector,
        ),
    ];
    for digits in [4, 8, 12, 15, 17] {
        for (key, numbers, read) in &ways {
            let rounded = numbers.map(|number| rounded(number, digits));
            let found = read(key, Located::new(rounded, 0..0), &mut Sink::default());
            if found.is_some_and(|found| (found - r).amax() <= CLOSE) {
                return (key, list(&rounded));
            }
        }
    }
    (
        "rotation",
        rows(
            r.transpose()
                .column_iter()
                .map(|row| row.into_iter().collect::<Vec<_>>()),
        ),
    )
}

/// Angles of `Rz(yaw) Ry(pitch) Rx(roll)`. At a pitch of a quarter turn the roll is taken as 0.
fn roll_pitch_yaw(r: &Matrix3<f64>) -> Vector3<f64> {
    /// From here on the angles about x and z are lost in rounding.
    const LOCKED: f64 = 1e-12;
    let across = r[(0, 0)].hypot(r[(1, 0)]);
    let pitch = (-r[(2, 0)]).atan2(across);
    if across < LOCKED {
        return Vector3::new(0.0, pitch, (-r[(0, 1)]).atan2(r[(1, 1)]));
    }
    Vector3::new(
        r[(2, 1)].atan2(r[(2, 2)]),
        pitch,
        r[(1, 0)].atan2(r[(0, 0)]),
    )
}

/// So many decimals of a number around 1.
fn rounded(value: f64, digits: usize) -> f64 {
    if digits >= 17 {
        return value;
    }
    format!("{value:.digits$}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::{CLOSE, pose, roll_pitch_yaw};
    use crate::parse::rotation::from_roll_pitch_yaw;
    use crate::read::Sink;
    use crate::source::Located;
    use hamel_runtime::spatial::{Pose, so3};
    use nalgebra::{Matrix3, Vector3};
    use std::f64::consts::FRAC_PI_2;

    fn turned(roll: f64, pitch: f64, yaw: f64) -> Matrix3<f64> {
        let rpy = Located::new(Vector3::new(roll, pitch, yaw), 0..0);
        from_roll_pitch_yaw("", rpy, &mut Sink::default()).expect("small angles")
    }

    #[test]
    fn angles_come_back_as_they_were_given() {
        for (roll, pitch, yaw) in [
            (0.1, -0.2, 0.3),
            (-1.2, 0.0, 0.4),
            (0.0, 0.7, 3.1),
            (1e-5, 0.0, -2.5),
        ] {
            let text = pose(&Pose::from_rotation(turned(roll, pitch, yaw))).expect("a rotation");
            assert_eq!(text, format!("{{ rpy = [{roll:?}, {pitch:?}, {yaw:?}] }}"));
        }
    }

    #[test]
    fn an_axis_is_written_as_one_and_the_identity_not_at_all() {
        assert_eq!(pose(&Pose::identity()), None);
        let y_from_z = so3::exp(&(Vector3::x() * -FRAC_PI_2));
        let text = pose(&Pose::from_rotation(y_from_z)).expect("a rotation");
        assert_eq!(text, "{ axis = [0.0, 1.0, 0.0] }");
    }

    #[test]
    fn locked_angles_still_give_the_rotation() {
        for yaw in [0.3, -2.0] {
            let r = turned(0.4, FRAC_PI_2, yaw);
            let [roll, pitch, yaw] = roll_pitch_yaw(&r).into();
            assert!((turned(roll, pitch, yaw) - r).amax() <= CLOSE);
        }
    }
}
