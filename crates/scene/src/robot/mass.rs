//! Mass properties of the parts of a robot: moved between frames, and added up.

use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};

/// The same body in the frame in which its own frame stands at `pose`.
pub(crate) fn moved(mass: &MassProperties, pose: &Pose<f64>) -> MassProperties {
    let r = pose.rotation;
    let inertia_com = if r == Matrix3::identity() {
        mass.inertia_com
    } else {
        symmetric(&(r * mass.inertia_com * r.transpose()))
    };
    MassProperties {
        mass: mass.mass,
        com: pose.transform_point(&mass.com),
        inertia_com,
    }
}

/// Bodies joined to one: masses add up, and each inertia is moved to the common centre of mass (Steiner). All are in the same frame.
pub(crate) fn sum(parts: &[MassProperties]) -> MassProperties {
    if let [one] = parts {
        return *one;
    }
    let mass: f64 = parts.iter().map(|part| part.mass).sum();
    let moment: Vector3<f64> = parts.iter().map(|part| part.com * part.mass).sum();
    let com = if mass > 0.0 { moment / mass } else { moment };
    let inertias = parts.iter().map(|part| {
        let d = part.com - com;
        part.inertia_com + (Matrix3::identity() * d.dot(&d) - d * d.transpose()) * part.mass
    });
    MassProperties {
        mass,
        com,
        inertia_com: symmetric(&inertias.sum()),
    }
}

/// Whether there is nothing to accelerate.
pub(crate) fn is_nothing(mass: &MassProperties) -> bool {
    mass.mass == 0.0 && mass.inertia_com == Matrix3::zeros()
}

fn symmetric(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    (matrix + matrix.transpose()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::{is_nothing, moved, sum};
    use hamel_runtime::spatial::{MassProperties, Pose, so3};
    use nalgebra::{Matrix3, Vector3};

    /// A few roundings of numbers around 1.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;

    #[test]
    fn two_points_make_a_dumbbell() {
        let point = |x: f64, mass: f64| MassProperties {
            mass,
            com: Vector3::new(x, 0.0, 0.0),
            inertia_com: Matrix3::zeros(),
        };
        let whole = sum(&[point(-1.0, 1.0), point(2.0, 2.0)]);
        // Reduced mass 2/3 times the square of the distance 3.
        let wanted = Matrix3::from_diagonal(&Vector3::new(0.0, 6.0, 6.0));
        assert_eq!((whole.mass, whole.com), (3.0, Vector3::x()));
        assert!((whole.inertia_com - wanted).amax() <= ROUNDING);
    }

    #[test]
    fn moving_turns_the_inertia_with_the_body() {
        let body = MassProperties {
            mass: 2.0,
            com: Vector3::new(0.1, 0.2, 0.3),
            inertia_com: Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 2.5)),
        };
        let quarter = so3::exp(&(Vector3::z() * std::f64::consts::FRAC_PI_2));
        let there = moved(&body, &Pose::new(quarter, Vector3::new(0.0, 0.0, 1.0)));
        assert!((there.com - Vector3::new(-0.2, 0.1, 1.3)).amax() <= ROUNDING);
        let wanted = Matrix3::from_diagonal(&Vector3::new(2.0, 1.0, 2.5));
        assert!((there.inertia_com - wanted).amax() <= ROUNDING);
        assert!(is_nothing(&sum(&[MassProperties::massless(); 2])));
    }
}
