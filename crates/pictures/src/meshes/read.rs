//! Files of meshes: STL and OBJ, COLLADA (`.dae`), and glTF, by their endings.

use super::{Part, bytes, collada, gltf};
use mesh_loader::Loader;
use std::path::Path;

/// The parts of the mesh in a file.
///
/// # Errors
/// A file that is too large, cannot be read, or is in no such format; a mesh without a triangle. In words.
pub fn read(path: &Path) -> Result<Vec<Part>, String> {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let read = || bytes::read(path).map_err(told);
    let parts = match ending.to_str().unwrap_or_default() {
        "stl" => stl(path, read()?),
        "obj" => obj(path, &read()?),
        "dae" => collada::read(&String::from_utf8_lossy(&read()?)),
        "gltf" | "glb" => gltf::read(path, &read()?),
        _ => return Err("it is none of .stl, .obj, .dae, .gltf and .glb".to_owned()),
    };
    let parts: Vec<Part> = parts?.into_iter().filter_map(sound).collect();
    match parts.is_empty() {
        true => Err("it has no triangle".to_owned()),
        false => Ok(parts),
    }
}

fn stl(path: &Path, mut bytes: Vec<u8>) -> Result<Vec<Part>, String> {
    if is_binary_stl(&bytes) {
        // Its head is not read, though it may look like the beginning of a text.
        bytes[..HEAD].fill(0);
    }
    let loaded = Loader::default().load_stl_from_slice(&bytes, path);
    loaded.map(parts).map_err(told)
}

fn obj(path: &Path, bytes: &[u8]) -> Result<Vec<Part>, String> {
    let loader = Loader::default();
    // Its materials stand in a file that it names.
    let loaded = loader.load_obj_from_slice_with_reader(bytes, path, bytes::read);
    loaded.map(parts).map_err(told)
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

fn parts(scene: mesh_loader::Scene) -> Vec<Part> {
    let colors = scene.materials.iter().map(|own| own.color.diffuse);
    let colors = colors.chain(std::iter::repeat(None));
    let parts = scene.meshes.into_iter().zip(colors);
    parts
        .map(|(mesh, color)| Part {
            corners: mesh.vertices,
            triangles: mesh.faces,
            color: color.map(|[red, green, blue, _]| super::color([red, green, blue])),
        })
        .collect()
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
