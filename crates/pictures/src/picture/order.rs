//! Solids in the order in which they are drawn, the nearest last.

use super::solid::{Face, Solid};
use nalgebra::Vector3;

/// Cuts of one solid at most.
const MOST_CUTS: usize = 6;

/// Which of two solids hides the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Nearer {
    First,
    Second,
}

/// The solids, cut where they go through each other, in an order in which none is drawn over what hides it. `size` is that of all of them.
pub fn ordered(solids: Vec<Solid>, eye: &Vector3<f64>, size: f64) -> Vec<Solid> {
    let slack = 1e-6 * size;
    let pieces = cut(solids, slack);
    let count = pieces.len();
    let balls: Vec<_> = pieces.iter().map(ball).collect();
    // Which pieces must be drawn before each.
    let mut before: Vec<Vec<usize>> = vec![vec![]; count];
    for b in 0..count {
        for a in 0..b {
            if !overlap(&balls[a], &balls[b], eye) {
                continue;
            }
            match nearer(&pieces[a], &pieces[b], eye, slack) {
                Some(Nearer::First) => before[a].push(b),
                Some(Nearer::Second) => before[b].push(a),
                None => {}
            }
        }
    }
    let distance = |piece: usize| (balls[piece].0 - eye).norm();
    let mut left: Vec<usize> = (0..count).collect();
    left.sort_by(|a, b| distance(*b).total_cmp(&distance(*a)));
    let mut is_drawn = vec![false; count];
    let mut order = vec![];
    while !left.is_empty() {
        let is_free = |piece: &usize| before[*piece].iter().all(|other| is_drawn[*other]);
        // The farthest of those that hide each other in a circle.
        let next = left.iter().position(is_free).unwrap_or(0);
        let piece = left.remove(next);
        is_drawn[piece] = true;
        order.push(piece);
    }
    let mut pieces: Vec<Option<Solid>> = pieces.into_iter().map(Some).collect();
    order
        .into_iter()
        .filter_map(|piece| pieces[piece].take())
        .collect()
}

fn ball(solid: &Solid) -> (Vector3<f64>, f64) {
    let centre = solid.centre();
    let reach = solid.corners().map(|corner| (corner - centre).norm());
    (centre, reach.fold(0.0, f64::max))
}

/// Whether the cones in which two balls are seen meet.
fn overlap(a: &(Vector3<f64>, f64), b: &(Vector3<f64>, f64), eye: &Vector3<f64>) -> bool {
    let (to_a, to_b) = (a.0 - eye, b.0 - eye);
    let half = |to: &Vector3<f64>, radius: f64| (radius / to.norm()).min(1.0).asin();
    to_a.angle(&to_b) <= half(&to_a, a.1) + half(&to_b, b.1)
}

/// Least and greatest distance of a solid before a face's plane.
fn extent(face: &Face, solid: &Solid) -> (f64, f64) {
    let origin = face.corners[0];
    let heights = solid
        .corners()
        .map(|corner| face.normal.dot(&(corner - origin)));
    heights.fold(
        (f64::INFINITY, f64::NEG_INFINITY),
        |(least, most), height| (least.min(height), most.max(height)),
    )
}

/// The face of `solid` before whose plane all of `other` is.
fn separating<'a>(solid: &'a Solid, other: &Solid, slack: f64) -> Option<&'a Face> {
    let is_before =
        |face: &&Face| extent(face, other).0 >= -slack && extent(face, solid).1 <= slack;
    solid.faces.iter().find(is_before)
}

fn nearer(a: &Solid, b: &Solid, eye: &Vector3<f64>, slack: f64) -> Option<Nearer> {
    let sees = |face: &Face| face.normal.dot(&(eye - face.corners[0])) > 0.0;
    if let Some(face) = separating(b, a, slack) {
        return Some(match sees(face) {
            true => Nearer::First,
            false => Nearer::Second,
        });
    }
    if let Some(face) = separating(a, b, slack) {
        return Some(match sees(face) {
            true => Nearer::Second,
            false => Nearer::First,
        });
    }
    // Of what is in another for the most part, the other shows.
    match (is_in(a, b), is_in(b, a)) {
        (true, false) => Some(Nearer::Second),
        (false, true) => Some(Nearer::First),
        _ => None,
    }
}

/// Whether the middle of a solid is in another one.
fn is_in(solid: &Solid, other: &Solid) -> bool {
    let middle = solid.centre();
    let mut faces = other.faces.iter();
    faces.all(|face| face.normal.dot(&(middle - face.corners[0])) < 0.0)
}

/// Cuts solids that go through others; what is left within them is hidden, or nearly so.
fn cut(solids: Vec<Solid>, slack: f64) -> Vec<Solid> {
    let mut pieces: Vec<Solid> = vec![];
    for solid in &solids {
        // Of two, the smaller one is cut.
        let volume = solid.volume();
        let others = solids.iter().filter(|other| volume < other.volume());
        let mut parts = vec![solid.clone()];
        for other in others {
            let (centre, reach) = ball(other);
            let mut next = vec![];
            for part in parts {
                let own = ball(&part);
                if (own.0 - centre).norm() >= own.1 + reach {
                    next.push(part);
                } else {
                    next.extend(outside_first(part, other, slack));
                }
            }
            parts = next;
        }
        pieces.extend(parts);
    }
    pieces
}

/// A solid in parts: those before planes of `other`, and what is left, unless it is inside.
fn outside_first(solid: Solid, other: &Solid, slack: f64) -> Vec<Solid> {
    let (mut parts, mut rest) = (vec![], solid);
    for _ in 0..MOST_CUTS {
        if separating(other, &rest, slack).is_some() || separating(&rest, other, slack).is_some() {
            break;
        }
        let outer = other.faces.iter().map(|face| (extent(face, &rest).1, face));
        let Some((height, face)) = outer.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            break;
        };
        // Nothing of it is outside.
        if height <= slack {
            return parts;
        }
        // Little of it is: of a rod in a body nothing is seen.
        if height < 0.2 * ball(&rest).1 {
            let is_slight = rest.volume().abs() < 0.02 * other.volume() && is_in(&rest, other);
            if is_slight {
                return parts;
            }
            break;
        }
        let (before, behind) = split(&rest, face);
        parts.push(before);
        rest = behind;
        if rest.faces.is_empty() {
            return parts;
        }
    }
    parts.push(rest);
    parts
}

/// What of a solid is before the plane of a face, and what is behind it. Where it was cut it has no face: the other part covers it.
fn split(solid: &Solid, plane: &Face) -> (Solid, Solid) {
    let side = |sign: f64| {
        let faces = solid.faces.iter().filter_map(|face| {
            let corners = clipped(&face.corners, &(plane.normal * sign), &plane.corners[0]);
            (corners.len() >= 3).then(|| Face {
                corners,
                ..face.clone()
            })
        });
        Solid {
            faces: faces.collect(),
        }
    };
    (side(1.0), side(-1.0))
}

/// The part of a polygon before a plane.
pub fn clipped(
    corners: &[Vector3<f64>],
    normal: &Vector3<f64>,
    origin: &Vector3<f64>,
) -> Vec<Vector3<f64>> {
    let height = |corner: &Vector3<f64>| normal.dot(&(corner - origin));
    let mut kept = vec![];
    for (k, corner) in corners.iter().enumerate() {
        let next = &corners[(k + 1) % corners.len()];
        let (here, there) = (height(corner), height(next));
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here >= 0.0) != (there >= 0.0) {
            kept.push(corner + (next - corner) * (here / (here - there)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::ordered;
    use crate::picture::solid::Form;
    use hamel::scene::Geometry;
    use hamel::spatial::Pose;
    use nalgebra::{Matrix3, Vector3};

    fn cuboid(sides: [f64; 3], at: [f64; 3], color: f64) -> super::Solid {
        let pose = Pose::new(Matrix3::identity(), at.into());
        Form::Shape(Geometry::Box(sides.into())).solid(&pose, [color; 3], 8)
    }

    /// The colours in the order in which they are drawn.
    fn drawn(solids: Vec<super::Solid>) -> Vec<f64> {
        let eye = Vector3::new(0.0, -10.0, 4.0);
        let order = ordered(solids, &eye, 4.0);
        order.iter().map(|solid| solid.faces[0].color[0]).collect()
    }

    #[test]
    fn what_stands_on_a_plate_is_drawn_after_it() {
        let plate = || cuboid([8.0, 8.0, 0.1], [0.0, 0.0, -0.05], 0.1);
        // Also at the far edge, where its middle is farther than that of the plate.
        let stone = || cuboid([1.0, 1.0, 1.0], [0.0, 3.0, 0.5], 0.2);
        assert_eq!(drawn(vec![plate(), stone()]), [0.1, 0.2]);
        assert_eq!(drawn(vec![stone(), plate()]), [0.1, 0.2]);
    }

    #[test]
    fn what_goes_through_a_plate_is_cut() {
        let plate = cuboid([4.0, 4.0, 0.2], [0.0; 3], 0.1);
        let pole = cuboid([0.2, 0.2, 4.0], [0.0; 3], 0.2);
        assert_eq!(drawn(vec![plate, pole]), [0.2, 0.1, 0.2]);
    }
}
