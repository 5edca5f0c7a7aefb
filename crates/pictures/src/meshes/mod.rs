//! The meshes of a scene for pictures: found, read, and made smaller where they have many triangles.

mod bytes;
mod collada;
mod gltf;
mod locate;
mod read;
mod reduce;

pub use locate::locate;

use hamel::scene::{Geometry, Mesh, Notice, Severity, ShapeDescription};
use nalgebra::Vector3;
use std::ops::Range;
use std::path::Path;

/// Triangles of all meshes together at most. On a page each takes about 12 bytes, in base64 16: 1.6 MB.
const MOST_TRIANGLES: usize = 100_000;

/// Parts of one file at most, and nodes that show them.
const MOST_PARTS: usize = 10_000;

/// Triangles of one colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Corners, m.
    pub corners: Vec<[f32; 3]>,
    /// Places of their corners, counterclockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Red, green and blue, where the file says them.
    pub color: Option<[u8; 3]>,
}

/// The meshes of a scene that could be read.
#[derive(Debug, Default)]
pub struct Meshes {
    files: Vec<(Mesh, Range<usize>)>,
    parts: Vec<Part>,
    notices: Vec<Notice>,
}

impl Meshes {
    /// Those of `shapes`, whose files are named from `folder`; each file is read once for each scale. What cannot be drawn is reported by [`Self::notices`].
    pub fn load(shapes: &[ShapeDescription], folder: &Path) -> Self {
        let mut own = Self::default();
        for shape in shapes {
            if let Geometry::Mesh(mesh) = &shape.geometry
                && own.files.iter().all(|(known, _)| known != mesh)
            {
                own.add(mesh, folder);
            }
        }
        reduce::to(MOST_TRIANGLES, &mut own.parts);
        own
    }

    fn add(&mut self, mesh: &Mesh, folder: &Path) {
        let first = self.parts.len();
        let read = locate(folder, &mesh.file).map(|path| read::read(&path));
        match read.map(|parts| scaled(parts?, mesh)) {
            None => self.leave_out("files of meshes are not found", &mesh.file, ""),
            Some(Err(why)) => self.leave_out("meshes cannot be read", &mesh.file, &why),
            Some(Ok(parts)) => self.parts.extend(parts),
        }
        self.files.push((mesh.clone(), first..self.parts.len()));
    }

    fn leave_out(&mut self, message: &str, file: &str, why: &str) {
        let element = match why {
            "" => format!("`{file}`"),
            why => format!("`{file}` ({why})"),
        };
        let known = self.notices.iter_mut().find(|own| own.message == message);
        match known {
            Some(notice) => notice.elements.push(element),
            None => self.notices.push(Notice {
                severity: Severity::Warning,
                message: message.to_owned(),
                elements: vec![element],
            }),
        }
    }

    /// The parts of all meshes.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// Which of them are those of `mesh`; none where it could not be read.
    pub fn parts_of(&self, mesh: &Mesh) -> Range<usize> {
        let found = self.files.iter().find(|(known, _)| known == mesh);
        found.map_or(0..0, |(_, parts)| parts.clone())
    }

    /// What is missing, and why.
    pub fn notices(&self) -> &[Notice] {
        &self.notices
    }
}

/// The parts in the scale of `mesh`, equal corners joined.
///
/// # Errors
/// Coordinates that are beyond those of a page; nothing left of the triangles.
fn scaled(parts: Vec<Part>, mesh: &Mesh) -> Result<Vec<Part>, String> {
    let mut left = Vec::new();
    for mut part in parts {
        part.scale(&mesh.scale)?;
        reduce::weld(&mut part);
        if !part.triangles.is_empty() {
            left.push(part);
        }
    }
    match left.is_empty() {
        true => Err("its triangles have no area".to_owned()),
        false => Ok(left),
    }
}

/// Coordinates are below this, m: sizes of boxes around them are still f32.
const LARGEST: f32 = 1e30;

impl Part {
    /// Multiplies coordinates. A reflection turns the triangles over.
    ///
    /// # Errors
    /// Coordinates that are beyond those of a page.
    fn scale(&mut self, factors: &Vector3<f64>) -> Result<(), String> {
        for corner in &mut self.corners {
            *corner = std::array::from_fn(|axis| (f64::from(corner[axis]) * factors[axis]) as f32);
        }
        // Corners that no triangle has may be anywhere.
        let used = self.triangles.as_flattened().iter();
        let mut used = used.flat_map(|place| self.corners[*place as usize]);
        if let Some(far) = used.find(|number| number.abs() > LARGEST) {
            return Err(format!("a coordinate is {far:e} m"));
        }
        if factors.product() < 0.0 {
            self.turn_over();
        }
        Ok(())
    }

    /// Makes the inside of each triangle its outside, as a reflection of its corners asks for.
    fn turn_over(&mut self) {
        for triangle in &mut self.triangles {
            triangle.swap(1, 2);
        }
    }
}

/// Red, green and blue from 0 to 1 as bytes.
fn color(rgb: [f32; 3]) -> [u8; 3] {
    rgb.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8)
}
