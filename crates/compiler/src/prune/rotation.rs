//! Constant rotations as few turns about axes as they are.

use super::Fixed;
use nalgebra::Matrix3;

/// Entries of rotations this near to 0 or ±1 are meant to be: what the cosine of a rounded right angle leaves is 0.6 of this.
const NEAR: f64 = 4e-16;

/// `R = Rz(a) Rx(b) Rz(c)`, without turns by nothing.
pub fn turns(rotation: &Matrix3<f64>) -> Vec<Fixed> {
    let r = rotation;
    let (sin_b, cos_b) = (r[(0, 2)].hypot(r[(1, 2)]), r[(2, 2)]);
    let turns = if sin_b <= NEAR {
        // Rx(b) is 1 or half a turn: Rz(a) Rx(b) = Rz(±c) alone.
        let c = unit(r[(0, 0)], if cos_b > 0.0 { r[(1, 0)] } else { -r[(1, 0)] });
        [unit(1.0, 0.0), unit(cos_b.signum(), 0.0), c]
    } else {
        let a = unit(-r[(1, 2)], r[(0, 2)]);
        // The first row of Rz(-a) R = Rx(b) Rz(c). The last row of R has sin c and cos c as well, times sin b: where b is little, their rounding is not that of a, and a + c,
        // which is what counts then, would be lost.
        let row = |j: usize| a.0 * r[(0, j)] + a.1 * r[(1, j)];
        let c = unit(row(0), -row(1));
        // A half turn about x more changes the signs of both others: the form with fewer of them.
        let flip = a.0 < 0.0 && a.1 == 0.0;
        let sign = if flip { -1.0 } else { 1.0 };
        [
            (sign * a.0, sign * a.1),
            unit(cos_b, sign * sin_b),
            (sign * c.0, sign * c.1),
        ]
    };
    let axes = [2, 0, 2];
    let turns = axes.into_iter().zip(turns);
    turns
        .filter(|(_, turn)| *turn != (1.0, 0.0))
        .map(|(axis, (cos, sin))| Fixed::Turn(axis, cos, sin))
        .collect()
}

/// Cosine and sine of one angle, of length 1, with entries that are meant to be 0 or ±1 exactly so.
fn unit(cos: f64, sin: f64) -> (f64, f64) {
    let length = cos.hypot(sin);
    let (cos, sin) = (cos / length, sin / length);
    if sin.abs() <= NEAR {
        (cos.signum(), 0.0)
    } else if cos.abs() <= NEAR {
        (0.0, sin.signum())
    } else {
        (cos, sin)
    }
}

#[cfg(test)]
mod tests {
    use super::turns;
    use crate::prune::Fixed;
    use nalgebra::{Matrix3, Rotation3, Vector3};

    fn back(rotation: &Matrix3<f64>) -> f64 {
        (Fixed::pose(&turns(rotation)).rotation - rotation)
            .abs()
            .max()
    }

    #[test]
    fn a_rotation_is_the_product_of_its_turns() {
        for k in 0..1000 {
            let x = f64::from(k);
            let vector = Vector3::new((1.3 * x).sin(), (2.1 * x).cos(), (0.7 * x).sin()) * 3.0;
            // Three products of entries of size 1: a few roundings.
            assert!(back(&Rotation3::new(vector).into_inner()) < 2e-15);
        }
    }

    /// Axes that are parallel up to rounding, and for more than that.
    #[test]
    fn a_little_tilt_leaves_the_turn_beside_it() {
        for k in 0..1000 {
            let x = f64::from(k);
            let tilt = 10.0_f64.powf(-17.0 + 14.0 * x / 999.0);
            let (a, c) = (
                Vector3::z() * 3.0 * (1.3 * x).sin(),
                Vector3::z() * 3.0 * (2.1 * x).cos(),
            );
            for half in [0.0, std::f64::consts::PI] {
                let tilted = Rotation3::new(Vector3::x() * (half + tilt));
                let mut rotation = (Rotation3::new(a) * tilted * Rotation3::new(c)).into_inner();
                // Entries of products of rounded rotations.
                rotation[(2, 0)] += 1e-16 * (1.7 * x).sin();
                rotation[(0, 2)] += 1e-16 * (2.3 * x).cos();
                let error = back(&rotation);
                assert!(error < 2e-15, "tilt {tilt:e}: {error:e}");
            }
        }
    }

    #[test]
    fn quarter_turns_are_exact() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
            for n in -2..=2 {
                let rotation = Rotation3::new(axis * quarter * f64::from(n)).into_inner();
                let exact = rotation.map(f64::round);
                assert_eq!(Fixed::pose(&turns(&rotation)).rotation, exact);
            }
        }
    }
}
