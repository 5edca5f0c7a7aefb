//! glTF: the triangles of its scene. Its y axis points up, which is z here.

use super::{MOST_PARTS, Part, bytes};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use gltf::buffer::Source;
use gltf::mesh::Mode;
use gltf::{Gltf, Node};
use nalgebra::{Matrix4, Point3};
use std::path::Path;

/// The parts of the file at `path`, whose bytes these are.
///
/// # Errors
/// What is no glTF, needs an extension that is not known, or has a buffer that cannot be read; in words.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Vec<Part>, String> {
    let Gltf { document, blob } = Gltf::from_slice(bytes).map_err(|error| error.to_string())?;
    if let Some(extension) = document.extensions_required().next() {
        return Err(format!("it needs the extension {extension}"));
    }
    let buffers = document.buffers().map(|buffer| match buffer.source() {
        Source::Bin => blob
            .clone()
            .ok_or_else(|| "its buffer is missing".to_owned()),
        Source::Uri(uri) => self::buffer(path, uri),
    });
    let buffers = buffers.collect::<Result<Vec<_>, _>>()?;
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next());
    let roots = scene.map(|scene| scene.nodes().collect::<Vec<_>>());
    let mut parts = Vec::new();
    let roots = roots.unwrap_or_default().into_iter();
    let mut waiting: Vec<_> = roots.map(|node| (node, Y_UP)).collect();
    // Nodes may be below themselves by mistake: their number is limited.
    let mut seen = 0;
    while let Some((node, above)) = waiting.pop() {
        seen += 1;
        if seen > MOST_PARTS {
            return Err(format!("it shows more than {MOST_PARTS} nodes"));
        }
        let place = above * Matrix4::from(node.transform().matrix());
        add(&node, &place, &buffers, &mut parts);
        waiting.extend(node.children().map(|child| (child, place)));
    }
    Ok(parts)
}

/// Turns y to z.
#[rustfmt::skip]
const Y_UP: Matrix4<f32> = Matrix4::new(
    1.0, 0.0, 0.0, 0.0,
    0.0, 0.0, -1.0, 0.0,
    0.0, 1.0, 0.0, 0.0,
    0.0, 0.0, 0.0, 1.0,
);

/// A buffer that stands in the file itself or in another.
fn buffer(path: &Path, uri: &str) -> Result<Vec<u8>, String> {
    if let Some(data) = uri.strip_prefix("data:") {
        let coded = data.split_once(";base64,").map(|(_, coded)| coded);
        let bytes = coded.and_then(|coded| STANDARD.decode(coded).ok());
        return bytes.ok_or_else(|| "a buffer is not in base64".to_owned());
    }
    let file = path.parent().unwrap_or(Path::new("")).join(plain(uri));
    bytes::read(&file).map_err(|error| format!("its buffer `{uri}`: {error}"))
}

/// A URI without its escapes: `%20` is a space.
fn plain(uri: &str) -> String {
    let mut pieces = uri.split('%');
    let mut bytes = pieces.next().unwrap_or_default().as_bytes().to_vec();
    for piece in pieces {
        let code = piece.get(..2).map(|code| u8::from_str_radix(code, 16));
        match code {
            Some(Ok(byte)) => {
                bytes.push(byte);
                bytes.extend(&piece.as_bytes()[2..]);
            }
            _ => bytes.extend([b"%", piece.as_bytes()].concat()),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Adds the triangles of a node that stands at `place`.
fn add(node: &Node<'_>, place: &Matrix4<f32>, buffers: &[Vec<u8>], parts: &mut Vec<Part>) {
    let primitives = node.mesh().into_iter().flat_map(|mesh| mesh.primitives());
    for primitive in primitives.filter(|own| own.mode() == Mode::Triangles) {
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let Some(corners) = reader.read_positions() else {
            continue;
        };
        let corners: Vec<_> = corners
            .map(|corner| place.transform_point(&Point3::from(corner)).into())
            .collect();
        let places: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..corners.len() as u32).collect(),
        };
        let material = primitive.material();
        let color = material.index().map(|_| {
            let [red, green, blue, _] = material.pbr_metallic_roughness().base_color_factor();
            super::color([red, green, blue].map(coded))
        });
        let mut part = Part {
            triangles: places.as_chunks().0.to_vec(),
            corners,
            color,
        };
        if place.determinant() < 0.0 {
            part.turn_over();
        }
        parts.push(part);
    }
}

/// A linear intensity as sRGB (IEC 61966-2-1).
fn coded(linear: f32) -> f32 {
    match linear <= 0.003_130_8 {
        true => 12.92 * linear,
        false => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
    }
}
