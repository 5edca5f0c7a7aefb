//! Fewer triangles for the same surface, by meshoptimizer's simplification.

use super::Part;
use meshopt_rs::simplify::{simplify, simplify_sloppy};
use std::collections::HashMap;

/// Edges are collapsed as long as the surface moves by no more than this part of its extent. Where that does not do, what is near is put together.
const LARGEST_ERROR: f32 = 0.02;

/// Triangles that a part keeps in any case.
const LEAST: usize = 8;

/// Simplification may leave this many times as many triangles as are wanted.
const NEARLY: f64 = 1.2;

/// Reduces the triangles of all parts together to `most` or little more. Small parts stay as they are, and none is left with less than [`LEAST`].
pub fn to(most: usize, parts: &mut [Part]) {
    let counts: Vec<usize> = parts.iter().map(|part| part.triangles.len()).collect();
    let share = share(most, &counts).max(LEAST);
    for part in parts {
        if part.triangles.len() > share {
            reduce(part, share);
        }
    }
}

/// The most triangles of a part with which all parts have `most` together.
fn share(most: usize, counts: &[usize]) -> usize {
    let mut counts = counts.to_vec();
    counts.sort_unstable();
    let mut left = most;
    for (index, count) in counts.iter().enumerate() {
        let share = left / (counts.len() - index);
        if *count > share {
            return share;
        }
        left -= count;
    }
    usize::MAX
}

/// Makes equal corners one; triangles that have no area by it go.
pub fn weld(part: &mut Part) {
    let mut places = HashMap::new();
    let mut corners = Vec::new();
    let mut joined = |corner: [f32; 3]| {
        // −0 is 0.
        let key = corner.map(|number| (number + 0.0).to_bits());
        *places.entry(key).or_insert_with(|| {
            corners.push(corner);
            corners.len() as u32 - 1
        })
    };
    let triangles = part.triangles.iter();
    let triangles =
        triangles.map(|triangle| triangle.map(|place| joined(part.corners[place as usize])));
    part.triangles = triangles
        .filter(|[a, b, c]| a != b && b != c && c != a)
        .collect();
    part.corners = corners;
}

fn reduce(part: &mut Part, wanted: usize) {
    let places = part.triangles.as_flattened();
    let mut found = vec![0; places.len()];
    let mut count = simplify(&mut found, places, &part.corners, 3 * wanted, LARGEST_ERROR);
    if count as f64 > NEARLY * 3.0 * wanted as f64 {
        let fine = found[..count].to_vec();
        count = simplify_sloppy(&mut found, &fine, &part.corners, 3 * wanted);
    }
    found.truncate(count);
    if found.is_empty() {
        // It is thinner than what is put together.
        return;
    }
    part.triangles = found.as_chunks().0.to_vec();
    // Corners without a triangle go.
    weld(part);
}

#[cfg(test)]
mod tests {
    use super::{share, to, weld};
    use crate::meshes::Part;

    /// A sphere of radius 1 of `2 n²` triangles, each with corners of its own.
    fn sphere(n: u32) -> Part {
        let corner = |i: u32, j: u32| {
            let angle = |k: u32| std::f32::consts::PI * k as f32 / n as f32;
            let (latitude, longitude) = (angle(i), 2.0 * angle(j % n));
            // The poles are one point each.
            let s = if i.is_multiple_of(n) {
                0.0
            } else {
                latitude.sin()
            };
            [s * longitude.cos(), s * longitude.sin(), latitude.cos()]
        };
        let mut part = Part::default();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(u, v)| corner(i + u, j + v));
            for corners in [[a, b, c], [a, c, d]] {
                let first = part.corners.len() as u32;
                part.corners.extend(corners);
                part.triangles.push([first, first + 1, first + 2]);
            }
        }
        part
    }

    /// By the divergence theorem.
    fn volume(part: &Part) -> f32 {
        let corner = |place: u32| nalgebra::Vector3::from(part.corners[place as usize]);
        let triangles = part.triangles.iter();
        let volumes = triangles.map(|[a, b, c]| corner(*a).cross(&corner(*b)).dot(&corner(*c)));
        volumes.sum::<f32>() / 6.0
    }

    #[test]
    fn large_meshes_are_made_smaller_and_keep_their_form() {
        let mut parts = [sphere(100), sphere(6)];
        parts.iter_mut().for_each(weld);
        to(3000, &mut parts);
        let counts = parts.each_ref().map(|part| part.triangles.len());
        assert!((2000..=3600).contains(&counts[0]), "{counts:?}");
        // Without the triangles at the poles, which have no area.
        assert_eq!(counts[1], 2 * 6 * 6 - 12);
        // A sphere by 2500 triangles is smaller than itself by 0.3 %: in each, the surface is within it by at most 4π/2500/8.
        let exact = 4.0 / 3.0 * std::f32::consts::PI;
        let found = volume(&parts[0]);
        assert!((found / exact - 1.0).abs() < 0.01, "{found}");
        let far = parts[0]
            .corners
            .iter()
            .map(|[x, y, z]| x.hypot(*y).hypot(*z));
        far.for_each(|far| assert!((far - 1.0).abs() < 1e-5));
    }

    #[test]
    fn large_parts_share_what_small_ones_leave() {
        assert_eq!(share(100, &[10, 500, 1000]), 45);
        assert_eq!(share(100, &[10, 50]), usize::MAX);
        assert_eq!(share(100, &[300]), 100);
        assert_eq!(share(100, &[]), usize::MAX);
    }
}
