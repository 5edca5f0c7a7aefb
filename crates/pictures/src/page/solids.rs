//! What stands for a body: the ellipsoid of its inertia, and simple shapes of the scene.

use crate::meshes::Meshes;
use crate::sample::seven;
use hamel::scene::{Geometry, ShapeDescription};
use hamel::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use serde::Serialize;

/// The homogeneous ellipsoid of the same mass and inertia, about the centre of mass.
#[derive(Debug, PartialEq, Serialize)]
pub struct Ellipsoid {
    /// Half axes, m.
    half: [f64; 3],
    /// Pose of its principal axes in the body frame, at the centre of mass.
    #[serde(serialize_with = "as_seven")]
    pose: Pose<f64>,
}

impl Ellipsoid {
    /// `None` for a body without mass.
    pub fn new(mass: &MassProperties) -> Option<Self> {
        if mass.mass <= 0.0 {
            return None;
        }
        let principal = mass.inertia_com.symmetric_eigen();
        let moments = principal.eigenvalues;
        let half = moments.map(|moment| {
            // A moment is m/5 times the sum of the squares of the other two half axes.
            let square = 2.5 / mass.mass * (moments.sum() - 2.0 * moment);
            square.max(0.0).sqrt()
        });
        Some(Self {
            half: half.into(),
            pose: Pose::new(proper(principal.eigenvectors), mass.com),
        })
    }

    /// Half axes, m.
    pub fn half(&self) -> Vector3<f64> {
        self.half.into()
    }

    /// Pose of its principal axes in the body frame.
    pub const fn axes(&self) -> Pose<f64> {
        self.pose
    }
}

fn as_seven<S: serde::Serializer>(pose: &Pose<f64>, serializer: S) -> Result<S::Ok, S::Error> {
    seven(pose).serialize(serializer)
}

/// The rotation among principal axes with their signs changed.
fn proper(mut axes: Matrix3<f64>) -> Matrix3<f64> {
    if axes.determinant() < 0.0 {
        let turned: Vector3<f64> = -axes.column(2);
        axes.set_column(2, &turned);
    }
    axes
}

/// A shape of the scene, or a part of one.
#[derive(Debug, Serialize)]
pub struct Shape {
    body: Option<usize>,
    kind: &'static str,
    /// Sides of a box; radius of a sphere; radius and length of a cylinder and a capsule, m; nothing for a mesh.
    size: Vec<f64>,
    /// Which mesh of the page it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    mesh: Option<usize>,
    pose: [f64; 7],
    color: Option<[u8; 3]>,
}

impl Shape {
    /// What the page shows of `shape`: one of these, one for each part of a mesh, or nothing of a mesh that is missing.
    pub fn of(shape: &ShapeDescription, meshes: &Meshes) -> Vec<Self> {
        let (kind, size) = match &shape.geometry {
            Geometry::Box(sides) => ("box", sides.iter().copied().collect()),
            Geometry::Sphere(radius) => ("sphere", vec![*radius]),
            Geometry::Cylinder { radius, length } => ("cylinder", vec![*radius, *length]),
            Geometry::Capsule { radius, length } => ("capsule", vec![*radius, *length]),
            Geometry::Mesh(mesh) => {
                let parts = meshes.parts_of(mesh);
                let of_part = |part: usize| Self {
                    mesh: Some(part),
                    // What a file says itself goes first, as in RViz.
                    color: meshes.parts()[part].color.or(shape.color),
                    ..Self::new(shape, "mesh", Vec::new())
                };
                return parts.map(of_part).collect();
            }
        };
        vec![Self::new(shape, kind, size)]
    }

    fn new(shape: &ShapeDescription, kind: &'static str, size: Vec<f64>) -> Self {
        Self {
            body: shape.body,
            kind,
            size,
            mesh: None,
            pose: seven(&shape.at),
            color: shape.color,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Ellipsoid;
    use hamel::spatial::MassProperties;
    use nalgebra::{Matrix3, Vector3};

    #[test]
    fn an_ellipsoid_has_the_inertia_that_it_stands_for() {
        let [a, b, c] = [0.1, 0.2, 0.3_f64].map(|half| half * half);
        let moments = Vector3::new(b + c, a + c, a + b) * (4.0 / 5.0);
        let mass = MassProperties {
            mass: 4.0,
            com: Vector3::new(0.0, 0.0, 1.0),
            inertia_com: Matrix3::from_diagonal(&moments),
        };
        let mut half = Ellipsoid::new(&mass).expect("a mass").half;
        half.sort_by(f64::total_cmp);
        for (half, wanted) in half.into_iter().zip([0.1, 0.2, 0.3]) {
            assert!((half - wanted).abs() < 1e-12, "{half} instead of {wanted}");
        }
        assert_eq!(Ellipsoid::new(&MassProperties::massless()), None);
    }
}
