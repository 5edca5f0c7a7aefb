//! Volume, centre and inertia of what a mesh of triangles encloses, as MuJoCo computes them.

use hamel_runtime::spatial::MassProperties;
use nalgebra::{Matrix3, Vector3};

/// Volumes and areas below this are none to MuJoCo.
const NOTHING: f64 = 1e-15;

/// A mesh of triangles.
#[derive(Clone, Debug, Default)]
pub(super) struct Triangles {
    /// The corners, m.
    pub(super) corners: Vec<Vector3<f64>>,
    /// Three corners each.
    pub(super) faces: Vec<[usize; 3]>,
}

/// What of a mesh has mass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filling {
    /// Pyramids from a point amid the faces to each of them, all counted as positive: MuJoCo's own way, which is exact where that point sees all faces.
    Pyramids,
    /// What the mesh encloses.
    Inside,
    /// Its faces.
    Faces,
}

/// What a mesh weighs with the density 1, kg/m³ or kg/m²: mass is volume or area. `None` without any.
pub(super) fn bulk(mesh: &Triangles, filling: Filling) -> Option<MassProperties> {
    let corner = |place: usize| mesh.corners.get(place).copied();
    let faces = mesh
        .faces
        .iter()
        .map(|[a, b, c]| Some([corner(*a)?, corner(*b)?, corner(*c)?]));
    let faces: Vec<[Vector3<f64>; 3]> = faces.collect::<Option<_>>()?;
    let area = |face: &[Vector3<f64>; 3]| normal(face).norm();
    let center = |face: &[Vector3<f64>; 3]| face.iter().sum::<Vector3<f64>>() / 3.0;
    let surface: f64 = faces.iter().map(area).sum();
    if surface < NOTHING {
        return None;
    }
    let amid = faces
        .iter()
        .map(|face| center(face) * area(face))
        .sum::<Vector3<f64>>()
        / surface;
    let com = match filling {
        Filling::Faces => amid,
        _ => {
            let parts = || {
                faces
                    .iter()
                    .map(|face| (volume(face, &amid, filling), face))
            };
            let whole: f64 = parts().map(|(volume, _)| volume).sum();
            let moment = parts().map(|(volume, face)| (center(face) * 0.75 + amid * 0.25) * volume);
            if whole < NOTHING {
                return None;
            }
            moment.sum::<Vector3<f64>>() / whole
        }
    };
    let mut mass = 0.0;
    let mut products = Matrix3::zeros();
    for face in &faces {
        let (part, parts) = match filling {
            Filling::Faces => (area(face), 12.0),
            _ => (volume(face, &com, filling), 20.0),
        };
        mass += part;
        let corners = face.map(|corner| corner - com);
        let sum: Vector3<f64> = corners.iter().sum();
        let squares: Matrix3<f64> = corners
            .iter()
            .map(|corner| corner * corner.transpose())
            .sum();
        products += (squares + sum * sum.transpose()) * (part / parts);
    }
    let inertia_com = Matrix3::identity() * products.trace() - products;
    let own = MassProperties {
        mass,
        com,
        inertia_com,
    };
    (mass >= NOTHING && own.check().is_ok()).then_some(own)
}

/// Half the cross product of two sides.
fn normal([a, b, c]: &[Vector3<f64>; 3]) -> Vector3<f64> {
    (b - a).cross(&(c - a)) / 2.0
}

/// The volume of the pyramid from a point to a face.
fn volume(face: &[Vector3<f64>; 3], from: &Vector3<f64>, filling: Filling) -> f64 {
    let signed = normal(face).dot(&(face[0] - from)) / 3.0;
    match filling {
        Filling::Pyramids => signed.abs(),
        _ => signed,
    }
}

#[cfg(test)]
mod tests {
    use super::{Filling, Triangles, bulk};
    use crate::mjcf::solid::Solid;
    use nalgebra::{Matrix3, Vector3};

    /// Some tens of roundings of numbers up to 1.
    const ROUNDING: f64 = 1e-14;

    /// A box with these half sides, its middle at `at`.
    fn cuboid(half: Vector3<f64>, at: Vector3<f64>) -> Triangles {
        let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
        let corner = |place: usize| {
            at + half.component_mul(&Vector3::new(
                sign(place & 1),
                sign(place & 2),
                sign(place & 4),
            ))
        };
        let sides = [
            [0, 2, 3, 1],
            [4, 5, 7, 6],
            [0, 1, 5, 4],
            [2, 6, 7, 3],
            [0, 4, 6, 2],
            [1, 3, 7, 5],
        ];
        Triangles {
            corners: (0..8).map(corner).collect(),
            faces: sides
                .iter()
                .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
                .collect(),
        }
    }

    #[test]
    fn a_box_of_triangles_is_a_box() {
        let (half, at) = (Vector3::new(0.3, 0.5, 0.7), Vector3::new(0.1, -0.2, 0.4));
        let mesh = cuboid(half, at);
        let solid = Solid::Box(half);
        for (filling, mass) in [
            (Filling::Pyramids, solid.volume()),
            (Filling::Inside, solid.volume()),
            (Filling::Faces, solid.surface()),
        ] {
            let own = bulk(&mesh, filling).expect("a volume");
            let moments = match filling {
                Filling::Faces => solid.hollow(mass),
                _ => solid.filled(mass),
            };
            assert!((own.mass - mass).abs() <= ROUNDING, "{filling:?}");
            assert!((own.com - at).amax() <= ROUNDING, "{filling:?}");
            assert!(
                (own.inertia_com - Matrix3::from_diagonal(&moments)).amax() <= ROUNDING,
                "{filling:?} {}",
                own.inertia_com
            );
        }
    }

    #[test]
    fn what_encloses_nothing_has_no_mass() {
        let mut mesh = cuboid(Vector3::repeat(0.5), Vector3::zeros());
        assert!(bulk(&Triangles::default(), Filling::Inside).is_none());
        mesh.faces.push([0, 1, 8]);
        assert!(bulk(&mesh, Filling::Inside).is_none());
    }
}
