//! Shapes that stand for bodies in pictures; they have no effect on the motion.

use crate::read::LONGEST_NAME;
use crate::text::is_hidden;
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;

/// A shape fixed to a body, or to the world.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeDescription {
    /// Index of the body that carries it; `None` is the world.
    pub body: Option<usize>,
    /// Pose of the shape's own frame in the body frame.
    pub at: Pose<f64>,
    /// What it is.
    pub geometry: Geometry,
    /// Red, green and blue, each from 0 to 255; `None` leaves the choice to whoever draws it.
    pub color: Option<[u8; 3]>,
}

/// A shape about the origin of its own frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Geometry {
    /// A box with sides along x, y and z, m.
    Box(Vector3<f64>),
    /// A sphere of that radius, m.
    Sphere(f64),
    /// A cylinder about z.
    Cylinder {
        /// m.
        radius: f64,
        /// From end to end, m.
        length: f64,
    },
    /// A cylinder about z that ends in hemispheres.
    Capsule {
        /// m.
        radius: f64,
        /// Of the cylinder, without the hemispheres, m.
        length: f64,
    },
    /// The triangles of a file.
    Mesh(Mesh),
}

/// A file of triangles. Reading a scene does not read it: what is not found is missing in pictures alone.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// The file as the scene names it: a path from the folder of the scene, or a `package://` of ROS.
    pub file: String,
    /// Factors of the numbers of the file along x, y and z, none of them 0; where the file says its unit, of metres.
    pub scale: Vector3<f64>,
}

impl Geometry {
    /// Names of the shapes, as scene files write them.
    pub const NAMES: [&'static str; 5] = ["box", "sphere", "cylinder", "capsule", "mesh"];
}

impl Mesh {
    /// Whether a scene can hold the name of a file: one line of visible characters, of at most 1000 bytes.
    pub fn is_name(file: &str) -> bool {
        !file.is_empty() && file.len() <= LONGEST_NAME && !file.chars().any(is_hidden)
    }
}
