//! The triangles of a mesh as a page holds them.

use crate::meshes::Part;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

/// Corners in 65536 steps along each side of the box around them, and which of them make triangles; bytes are little-endian, in base64.
#[derive(Debug, Serialize)]
pub struct Triangles {
    /// The least coordinates, m.
    low: [f32; 3],
    /// One step along each axis, m.
    step: [f32; 3],
    /// Three numbers of two bytes for each corner.
    corners: String,
    /// Three numbers for each triangle, of two bytes up to 65536 corners, and of four beyond.
    triangles: String,
    /// Bytes of one of these.
    width: usize,
}

impl From<&Part> for Triangles {
    fn from(part: &Part) -> Self {
        let bound = |axis: usize, start: f32, better: fn(f32, f32) -> f32| {
            let numbers = part.corners.iter().map(|corner| corner[axis]);
            numbers.fold(start, better)
        };
        let low = [0, 1, 2].map(|axis| bound(axis, f32::INFINITY, f32::min));
        let high = [0, 1, 2].map(|axis| bound(axis, f32::NEG_INFINITY, f32::max));
        let step = [0, 1, 2].map(|axis| (high[axis] - low[axis]) / f32::from(u16::MAX));
        let corners = part.corners.iter().flat_map(|corner| {
            [0, 1, 2].map(|axis| match step[axis] > 0.0 {
                true => ((corner[axis] - low[axis]) / step[axis]).round() as u16,
                false => 0,
            })
        });
        let corners: Vec<u8> = corners.flat_map(u16::to_le_bytes).collect();
        let places = part.triangles.as_flattened().iter();
        let (width, triangles): (_, Vec<u8>) = match part.corners.len() <= 1 << 16 {
            true => (
                2,
                places.flat_map(|own| (*own as u16).to_le_bytes()).collect(),
            ),
            false => (4, places.flat_map(|own| own.to_le_bytes()).collect()),
        };
        Self {
            low,
            step,
            corners: STANDARD.encode(corners),
            triangles: STANDARD.encode(triangles),
            width,
        }
    }
}
