//! Solids as faces: those of the page's. All but meshes are convex.

use super::colors::Color;
use super::view::{Ball, across};
use crate::meshes::Part;
use hamel::scene::Geometry;
use hamel::spatial::Pose;
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// A flat convex face.
#[derive(Clone, Debug)]
pub struct Face {
    pub corners: Vec<Vector3<f64>>,
    /// Unit vector outwards.
    pub normal: Vector3<f64>,
    pub color: Color,
}

/// A solid, or a part of one.
#[derive(Clone, Debug)]
pub struct Solid {
    pub faces: Vec<Face>,
}

/// The shape of a solid about its own frame.
#[derive(Clone, Debug)]
pub enum Form<'a> {
    /// A simple shape; a mesh has no faces here.
    Shape(Geometry),
    /// With these half axes.
    Ellipsoid(Vector3<f64>),
    /// A rod of that radius and length along z.
    Rod(f64, f64),
    /// A part of a mesh, and the corners of a box around it.
    Mesh(&'a Part, [Vector3<f64>; 8]),
}

/// Numbers at one height of a round solid: radius and z.
type Row = (f64, f64);

impl<'a> Form<'a> {
    /// A part of a mesh.
    pub fn mesh(part: &'a Part) -> Self {
        let corners = || part.corners.iter().map(|corner| corner.map(f64::from));
        let end = |pick: fn(f64, f64) -> f64| {
            let ends = corners().reduce(|a, b| std::array::from_fn(|axis| pick(a[axis], b[axis])));
            ends.unwrap_or_default()
        };
        let ends = [end(f64::min), end(f64::max)];
        let corner =
            |index: usize| Vector3::from(std::array::from_fn(|axis| ends[index >> axis & 1][axis]));
        Self::Mesh(part, std::array::from_fn(corner))
    }

    /// Its faces, with so many around where it is round, a multiple of four.
    pub fn solid(&self, pose: &Pose<f64>, color: Color, around: usize) -> Solid {
        let one = Vector3::repeat(1.0);
        let sphere = || arc(-FRAC_PI_2, FRAC_PI_2, around / 2, 1.0, 0.0);
        let tube = |r: f64, l: f64| {
            vec![
                (0.0, -l / 2.0),
                (r, -l / 2.0),
                (r, 0.0),
                (r, l / 2.0),
                (0.0, l / 2.0),
            ]
        };
        let faces = match *self {
            Self::Shape(Geometry::Box(sides)) => cuboid(&(sides / 2.0)),
            Self::Shape(Geometry::Sphere(r)) => revolved(&sphere(), around, &(one * r)),
            Self::Shape(Geometry::Cylinder { radius, length }) => {
                revolved(&tube(radius, length), around, &one)
            }
            Self::Shape(Geometry::Capsule { radius, length }) => {
                let mut rows = arc(-FRAC_PI_2, 0.0, around / 4, radius, -length / 2.0);
                rows.push((radius, 0.0));
                rows.extend(arc(0.0, FRAC_PI_2, around / 4, radius, length / 2.0));
                revolved(&rows, around, &one)
            }
            Self::Shape(Geometry::Mesh(_)) => Vec::new(),
            Self::Ellipsoid(half) => revolved(&sphere(), around, &half),
            Self::Rod(radius, length) => {
                let (low, high) = (-length / 2.0, length / 2.0);
                let rows = [(0.0, low), (radius, low), (radius, high), (0.0, high)];
                revolved(&rows, 8, &one)
            }
            Self::Mesh(part, _) => triangles(part),
        };
        let plain = matches!(
            self,
            Self::Shape(Geometry::Box(_)) | Self::Rod(..) | Self::Mesh(..)
        );
        let faces = faces.into_iter().map(|corners| {
            let middle: Vector3<f64> = corners.iter().sum::<Vector3<f64>>() / corners.len() as f64;
            // Octants of two tones show how a round body turns.
            let tone = match !plain && middle.product() < 0.0 {
                true => 0.8,
                false => 1.0,
            };
            let corners: Vec<_> = corners
                .iter()
                .map(|corner| pose.translation + pose.rotation * corner)
                .collect();
            Face {
                normal: normal(&corners),
                corners,
                color: color.map(|part| part * tone),
            }
        });
        Solid {
            faces: faces.collect(),
        }
    }

    /// Balls in it that touch its surface where it reaches farthest.
    pub fn balls(&self, pose: &Pose<f64>) -> Vec<Ball> {
        let at = |z: f64| pose.translation + pose.rotation * Vector3::new(0.0, 0.0, z);
        match *self {
            Self::Shape(Geometry::Sphere(radius)) => vec![(at(0.0), radius)],
            Self::Shape(Geometry::Capsule { radius, length }) => [-length / 2.0, length / 2.0]
                .map(|z| (at(z), radius))
                .into(),
            Self::Mesh(_, corners) => corners
                .map(|corner| (pose.translation + pose.rotation * corner, 0.0))
                .into(),
            _ => {
                let faces = self.solid(pose, [0.0; 3], 8).faces;
                let corners = faces.into_iter().flat_map(|face| face.corners);
                corners.map(|corner| (corner, 0.0)).collect()
            }
        }
    }
}

impl Solid {
    pub fn corners(&self) -> impl Iterator<Item = &Vector3<f64>> {
        self.faces.iter().flat_map(|face| &face.corners)
    }

    pub fn volume(&self) -> f64 {
        let faces = self.faces.iter().map(|face| {
            let Some((first, rest)) = face.corners.split_first() else {
                return 0.0;
            };
            let parts = rest
                .windows(2)
                .map(|pair| first.dot(&pair[0].cross(&pair[1])) / 6.0);
            parts.sum::<f64>()
        });
        faces.sum()
    }

    pub fn centre(&self) -> Vector3<f64> {
        let count = self.corners().count().max(1);
        self.corners().sum::<Vector3<f64>>() / count as f64
    }
}

/// The rotation that takes z to a direction.
pub fn from_axis(axis: &Vector3<f64>) -> Matrix3<f64> {
    let z = axis.normalize();
    let x = across(&z);
    Matrix3::from_columns(&[x, z.cross(&x), z])
}

/// By Newell: right also where corners fall together.
fn normal(corners: &[Vector3<f64>]) -> Vector3<f64> {
    let next = corners.iter().cycle().skip(1);
    let sum: Vector3<f64> = corners.iter().zip(next).map(|(a, b)| a.cross(b)).sum();
    sum.try_normalize(0.0).unwrap_or_else(Vector3::z)
}

/// Rows of a part of a circle between two angles of latitude, about the height `z`.
fn arc(from: f64, to: f64, steps: usize, radius: f64, z: f64) -> Vec<Row> {
    let rows = (0..=steps).map(|k| {
        let angle = from + (to - from) * k as f64 / steps as f64;
        let is_pole = (angle.abs() - FRAC_PI_2).abs() < 1e-9;
        let across = if is_pole { 0.0 } else { angle.cos() };
        (radius * across, z + radius * angle.sin())
    });
    rows.collect()
}

/// The faces that rows make when they turn about z, stretched; level ones are quarters of a disk.
fn revolved(rows: &[Row], around: usize, stretch: &Vector3<f64>) -> Vec<Vec<Vector3<f64>>> {
    let corner = |(radius, z): Row, step: usize| {
        let angle = TAU * step as f64 / around as f64;
        Vector3::new(radius * angle.cos(), radius * angle.sin(), z).component_mul(stretch)
    };
    let mut faces = vec![];
    for pair in rows.windows(2) {
        let (low, high) = (pair[0], pair[1]);
        if low.1 == high.1 {
            for first in (0..around).step_by(around / 4) {
                let rim = (first..=first + around / 4)
                    .map(|step| corner(if low.0 > 0.0 { low } else { high }, step));
                let mut sector: Vec<_> = rim.chain([corner((0.0, low.1), 0)]).collect();
                // Below, from the other side.
                if low.0 == 0.0 {
                    sector.reverse();
                }
                faces.push(sector);
            }
            continue;
        }
        for step in 0..around {
            let mut face = vec![];
            if low.0 > 0.0 {
                face.extend([corner(low, step), corner(low, step + 1)]);
            } else {
                face.push(corner(low, step));
            }
            if high.0 > 0.0 {
                face.extend([corner(high, step + 1), corner(high, step)]);
            } else {
                face.push(corner(high, step));
            }
            faces.push(face);
        }
    }
    faces
}

fn triangles(part: &Part) -> Vec<Vec<Vector3<f64>>> {
    let corner = |place: &u32| Vector3::from(part.corners[*place as usize]).cast();
    let triangles = part.triangles.iter();
    triangles
        .map(|triangle| triangle.iter().map(corner).collect())
        .collect()
}

fn cuboid(half: &Vector3<f64>) -> Vec<Vec<Vector3<f64>>> {
    let mut faces = vec![];
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut face: Vec<_> = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
                .into_iter()
                .map(|(a, b)| {
                    let mut corner = Vector3::zeros();
                    corner[axis] = sign;
                    corner[(axis + 1) % 3] = a;
                    corner[(axis + 2) % 3] = b;
                    corner.component_mul(half)
                })
                .collect();
            if sign < 0.0 {
                face.reverse();
            }
            faces.push(face);
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::Form;
    use hamel::scene::Geometry;
    use hamel::spatial::Pose;
    use nalgebra::Vector3;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn faces_enclose_their_solids_and_look_outwards() {
        let (radius, length) = (0.5, 2.0);
        let disk = PI * radius * radius;
        let ball = 2.0 / 3.0 * TAU * radius.powi(3);
        for (form, wanted) in [
            (Form::Shape(Geometry::Box(Vector3::new(1.0, 2.0, 3.0))), 6.0),
            (Form::Shape(Geometry::Sphere(radius)), ball),
            (
                Form::Shape(Geometry::Cylinder { radius, length }),
                disk * length,
            ),
            (
                Form::Shape(Geometry::Capsule { radius, length }),
                disk * length + ball,
            ),
            (Form::Ellipsoid(Vector3::new(0.5, 1.0, 1.5)), 6.0 * ball),
        ] {
            let found = form.solid(&Pose::identity(), [0.5; 3], 64).volume();
            assert!(
                (found - wanted).abs() < 0.01 * wanted,
                "{form:?}: {found} and {wanted}"
            );
        }
    }
}
