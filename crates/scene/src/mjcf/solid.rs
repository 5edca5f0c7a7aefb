//! Volumes, surfaces and inertias of simple shapes, as MuJoCo computes them.

use nalgebra::Vector3;
use std::f64::consts::PI;

/// A shape about the origin of its frame, with its main axis along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Solid {
    /// Of that radius, m.
    Sphere(f64),
    /// Radius, and half of its length without the hemispheres, m.
    Capsule(f64, f64),
    /// Radius, and half of its length, m.
    Cylinder(f64, f64),
    /// Half axes, m.
    Ellipsoid(Vector3<f64>),
    /// Half sides, m.
    Box(Vector3<f64>),
}

impl Solid {
    /// Its volume, m³.
    pub(super) fn volume(&self) -> f64 {
        match *self {
            Self::Sphere(r) => 4.0 * PI * r * r * r / 3.0,
            Self::Capsule(r, half) => PI * (r * r * 2.0 * half + 4.0 * r * r * r / 3.0),
            Self::Cylinder(r, half) => PI * r * r * 2.0 * half,
            Self::Ellipsoid(s) => 4.0 * PI * s.x * s.y * s.z / 3.0,
            Self::Box(s) => 8.0 * s.x * s.y * s.z,
        }
    }

    /// Its surface, m². Of an ellipsoid it is the approximation of K. Thomsen, which MuJoCo takes.
    pub(super) fn surface(&self) -> f64 {
        const THOMSEN: f64 = 1.6075;
        match *self {
            Self::Sphere(r) => 4.0 * PI * r * r,
            Self::Capsule(r, half) => 4.0 * PI * r * r + 4.0 * PI * r * half,
            Self::Cylinder(r, half) => 2.0 * PI * r * r + 4.0 * PI * r * half,
            Self::Ellipsoid(s) => {
                let sum = [s.x * s.y, s.y * s.z, s.z * s.x].map(|pair| pair.powf(THOMSEN));
                4.0 * PI * (sum.iter().sum::<f64>() / 3.0).powf(1.0 / THOMSEN)
            }
            Self::Box(s) => 8.0 * (s.x * s.y + s.y * s.z + s.z * s.x),
        }
    }

    /// Its moments of inertia about its axes where that `mass` fills it, kg m².
    pub(super) fn filled(&self, mass: f64) -> Vector3<f64> {
        match *self {
            Self::Sphere(r) => Vector3::repeat(0.4 * mass * r * r),
            Self::Capsule(r, half) => {
                let height = 2.0 * half;
                let ends = mass * 4.0 * r / (4.0 * r + 3.0 * height);
                let end = 0.4 * ends * r * r;
                let far = ends * height * (3.0 * r + 2.0 * height) / 8.0;
                Self::Cylinder(r, half).filled(mass - ends)
                    + Vector3::new(end + far, end + far, end)
            }
            Self::Cylinder(r, half) => {
                let across = mass * (3.0 * r * r + 4.0 * half * half) / 12.0;
                Vector3::new(across, across, mass * r * r / 2.0)
            }
            Self::Ellipsoid(s) => across(&s) * (mass / 5.0),
            Self::Box(s) => across(&s) * (mass / 3.0),
        }
    }

    /// The same where the mass is spread over its surface.
    pub(super) fn hollow(&self, mass: f64) -> Vector3<f64> {
        match *self {
            Self::Sphere(r) => Vector3::repeat(2.0 / 3.0 * mass * r * r),
            Self::Capsule(r, half) => {
                // The ends are 4 π r² of 4 π r² + 4 π r half.
                let ends = mass * r / (r + half);
                let end = 2.0 / 3.0 * ends * r * r;
                // Half a sphere has its centre of mass half a radius from the plane that cuts it.
                let far = ends * ((half + r / 2.0).powi(2) - r * r / 4.0);
                tube(mass - ends, r, half) + Vector3::new(end + far, end + far, end)
            }
            Self::Cylinder(r, half) => {
                let disks = mass * r / (r + 2.0 * half);
                let about = disks * (r * r / 4.0 + half * half);
                tube(mass - disks, r, half) + Vector3::new(about, about, disks * r * r / 2.0)
            }
            Self::Ellipsoid(s) => thin(&s, mass),
            Self::Box(s) => sides(&s, mass),
        }
    }
}

/// The sums of two squares, each without that of one axis.
fn across(s: &Vector3<f64>) -> Vector3<f64> {
    let square = s.component_mul(s);
    Vector3::repeat(square.sum()) - square
}

/// The curved side of a cylinder.
fn tube(mass: f64, r: f64, half: f64) -> Vector3<f64> {
    let across = mass * (6.0 * r * r + 4.0 * half * half) / 12.0;
    Vector3::new(across, across, mass * r * r)
}

/// What lies between an ellipsoid and one whose half axes are longer by a micrometre: so does MuJoCo.
fn thin(s: &Vector3<f64>, mass: f64) -> Vector3<f64> {
    const THICKNESS: f64 = 1e-6;
    let outer = s.add_scalar(THICKNESS);
    let [inside, outside] = [s, &outer].map(|s| Solid::Ellipsoid(*s).volume());
    let density = mass / (outside - inside);
    across(&outer) * (outside * density / 5.0) - across(s) * (inside * density / 5.0)
}

/// The six sides of a box.
fn sides(s: &Vector3<f64>, mass: f64) -> Vector3<f64> {
    let [x, y, z] = [s.x, s.y, s.z];
    // Each pair of sides across an axis, with its part of the surface.
    let pairs = [
        (y * z, [0.0, y, z], [x, 0.0, 0.0]),
        (x * z, [x, 0.0, z], [0.0, y, 0.0]),
        (x * y, [x, y, 0.0], [0.0, 0.0, z]),
    ];
    let surface: f64 = pairs.iter().map(|(area, ..)| area).sum();
    let moments = pairs.iter().map(|(area, along, off)| {
        let part = mass * area / surface;
        across(&Vector3::from(*along)) * (part / 3.0) + across(&Vector3::from(*off)) * part
    });
    moments.sum()
}

#[cfg(test)]
mod tests {
    use super::Solid;
    use nalgebra::Vector3;

    /// Ten roundings of numbers around 1.
    const ROUNDING: f64 = 10.0 * f64::EPSILON;

    #[test]
    fn long_and_short_shapes_become_each_other() {
        let sphere = Solid::Sphere(0.7);
        for (same, wanted) in [
            (Solid::Capsule(0.7, 0.0), sphere),
            (Solid::Ellipsoid(Vector3::repeat(0.7)), sphere),
        ] {
            assert!((same.volume() - wanted.volume()).abs() <= ROUNDING);
            assert!((same.filled(2.0) - wanted.filled(2.0)).amax() <= ROUNDING);
        }
        let hollow = Solid::Capsule(0.7, 0.0).hollow(2.0) - sphere.hollow(2.0);
        assert!(hollow.amax() <= ROUNDING, "{hollow}");
    }

    #[test]
    fn a_hollow_shape_is_the_derivative_of_a_filled_one() {
        // What a thin layer of the same thickness everywhere adds: of a box or a cylinder that is what all sizes grow by.
        let h = 1e-6;
        for (inner, outer) in [
            (
                Solid::Box(Vector3::new(0.3, 0.5, 0.7)),
                Solid::Box(Vector3::new(0.3 + h, 0.5 + h, 0.7 + h)),
            ),
            (Solid::Cylinder(0.3, 0.5), Solid::Cylinder(0.3 + h, 0.5 + h)),
            (Solid::Capsule(0.3, 0.5), Solid::Capsule(0.3 + h, 0.5)),
        ] {
            let added = outer.filled(outer.volume()) - inner.filled(inner.volume());
            let mass = outer.volume() - inner.volume();
            let wanted = added / mass;
            assert!((inner.hollow(1.0) - wanted).amax() <= 1e-5, "{inner:?}");
            assert!((mass / h - inner.surface()).abs() <= 1e-4, "{inner:?}");
        }
    }
}
