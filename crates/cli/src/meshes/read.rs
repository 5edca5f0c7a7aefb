//! Files of meshes: STL and OBJ, COLLADA (`.dae`), and glTF, told by their endings.

use super::{Part, gltf};
use mesh_loader::{Loader, Scene};
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;

/// Most bytes of a file.
const MOST_BYTES: u64 = 256 << 20;

/// The parts of the mesh in a file.
///
/// # Errors
/// A file that is too large, cannot be read, or is in no such format; a mesh without a triangle. In words.
pub fn read(path: &Path) -> Result<Vec<Part>, String> {
    let size = std::fs::metadata(path).map_err(told)?.len();
    if size > MOST_BYTES {
        return Err(format!(
            "{} MB, and at most {} are read",
            size >> 20,
            MOST_BYTES >> 20
        ));
    }
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let bytes = std::fs::read(path).map_err(told)?;
    let ending = ending.to_str().unwrap_or_default();
    let parts = guarded(|| match ending {
        "gltf" | "glb" => gltf::read(path, &bytes),
        _ => by_loader(ending, path, bytes),
    })?;
    let parts: Vec<Part> = parts.into_iter().filter_map(sound).collect();
    match parts.is_empty() {
        true => Err("it has no triangle".to_owned()),
        false => Ok(parts),
    }
}

/// The parts of a file in the formats of `mesh_loader`.
fn by_loader(ending: &str, path: &Path, mut bytes: Vec<u8>) -> Result<Vec<Part>, String> {
    let loader = Loader::default();
    let scene = match ending {
        "stl" => {
            if is_binary_stl(&bytes) {
                // Its head is not read, though it may look like the beginning of a text.
                bytes[..HEAD].fill(0);
            }
            loader.load_stl_from_slice(&bytes, path)
        }
        "obj" => loader.load_obj_from_slice(&bytes, path),
        "dae" => loader.load_collada_from_slice(&bytes, path),
        _ => return Err("it is none of .stl, .obj, .dae, .gltf and .glb".to_owned()),
    };
    scene.map(parts).map_err(told)
}

/// Bytes before the number of triangles in a binary STL.
const HEAD: usize = 80;

/// Whether the length is that of a binary STL; texts have it by chance at most.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let count = bytes.get(HEAD..).and_then(|rest| rest.first_chunk());
    count.is_some_and(|count| {
        let triangles = u64::from(u32::from_le_bytes(*count));
        bytes.len() as u64 == HEAD as u64 + 4 + 50 * triangles
    })
}

fn told(error: std::io::Error) -> String {
    error.to_string()
}

/// What `load` gives. The reader of COLLADA panics where a file refers to an element that it does not have.
fn guarded(load: impl FnOnce() -> Result<Vec<Part>, String>) -> Result<Vec<Part>, String> {
    let hook = panic::take_hook();
    panic::set_hook(Box::new(|_| {}));
    let loaded = panic::catch_unwind(AssertUnwindSafe(load));
    panic::set_hook(hook);
    loaded.unwrap_or_else(|_| Err("it refers to what it does not have".to_owned()))
}

fn parts(scene: Scene) -> Vec<Part> {
    let colors = scene.materials.iter().map(|own| own.color.diffuse);
    let colors = colors.chain(std::iter::repeat(None));
    let parts = scene.meshes.into_iter().zip(colors);
    parts
        .map(|(mesh, color)| Part {
            corners: mesh.vertices,
            triangles: mesh.faces,
            color: color.map(bytes),
        })
        .collect()
}

/// A colour without its transparency.
fn bytes([red, green, blue, _]: [f32; 4]) -> [u8; 3] {
    [red, green, blue].map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// The triangles of a part whose corners exist and are finite; `None` where there is none.
fn sound(mut part: Part) -> Option<Part> {
    let is_finite = |place: u32| {
        let corner = part.corners.get(place as usize);
        corner.is_some_and(|corner| corner.iter().all(|number| number.is_finite()))
    };
    part.triangles
        .retain(|triangle| triangle.iter().all(|place| is_finite(*place)));
    (!part.triangles.is_empty()).then_some(part)
}
