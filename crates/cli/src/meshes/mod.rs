//! The meshes of a scene for pictures: found, read, and made smaller where they have many triangles.

mod gltf;
mod locate;
mod read;
mod reduce;

pub use locate::locate;

use hamel_scene::{Geometry, Mesh, Notice, Severity, ShapeDescription};
use std::ops::Range;
use std::path::Path;

/// Triangles of all meshes together at most. On a page each takes about 12 bytes, in base64 16: 1.6 MB.
const MOST_TRIANGLES: usize = 100_000;

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
    /// Those of `shapes`, whose files are named from `folder`; each file is read once for each scale. What cannot be drawn is told by [`Self::notices`].
    pub fn load(shapes: &[ShapeDescription], folder: &Path) -> Self {
        let mut own = Self::default();
        for shape in shapes {
            if let Geometry::Mesh(mesh) = &shape.geometry
                && own.files.iter().all(|(known, _)| known != mesh)
            {
                let first = own.parts.len();
                match locate(folder, &mesh.file).map(|path| read::read(&path)) {
                    None => own.leave_out("files of meshes are not found", &mesh.file, ""),
                    Some(Err(why)) => own.leave_out("meshes cannot be read", &mesh.file, &why),
                    Some(Ok(parts)) => own.parts.extend(parts.into_iter().map(|mut part| {
                        part.scale(mesh.scale.map(|factor| factor as f32).into());
                        part
                    })),
                }
                own.files.push((mesh.clone(), first..own.parts.len()));
            }
        }
        reduce::to(MOST_TRIANGLES, &mut own.parts);
        own
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

impl Part {
    /// Multiplies coordinates. A reflection turns the triangles over.
    fn scale(&mut self, factors: [f32; 3]) {
        for corner in &mut self.corners {
            *corner = std::array::from_fn(|axis| corner[axis] * factors[axis]);
        }
        if factors.iter().product::<f32>() < 0.0 {
            for triangle in &mut self.triangles {
                triangle.swap(1, 2);
            }
        }
    }
}
