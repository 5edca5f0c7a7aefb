//! What a panel shows: the parent frame, each body at home and at the ends of its sweep, and the path of a point of it.

use super::pen::{ALLOWED, AXES, BODY, FORBIDDEN, INK, Look, Pen};
use super::sampler::Frame;
use super::sweep::{Sweep, Track};
use super::view::faces_viewer;

/// Half the sides of the block that stands for the child, m; all different, so that every turn of it shows.
const BLOCK: [f64; 3] = [0.42, 0.26, 0.13];
/// Length of the child's axes, m.
const AXIS: f64 = 0.66;
/// Length of the parent's axes, m.
const PARENT_AXIS: f64 = 1.0;

/// The size of blocks and axes of one of several bodies, so that the links of a mechanism stand apart.
const SMALL: f64 = 0.4;

/// The size of blocks and axes.
fn scale(sweep: &Sweep) -> f64 {
    match sweep.bodies.len() {
        1 => 1.0,
        _ => SMALL,
    }
}

/// Points that must fit into the picture.
pub fn extent(sweep: &Sweep) -> Vec<[f64; 3]> {
    let parent = (0..3).map(|axis| unit(axis, PARENT_AXIS)).chain([[0.0; 3]]);
    let bodies = sweep.bodies.iter();
    parent
        .chain(bodies.flat_map(|track| extent_of(track, scale(sweep))))
        .collect()
}

fn extent_of(track: &Track, scale: f64) -> Vec<[f64; 3]> {
    let ends = [
        track.frames.first(),
        track.frames.get(track.home),
        track.frames.last(),
    ];
    let of_child = |frame: &Frame| {
        let frame = *frame;
        corners(scale)
            .into_iter()
            .map(move |corner| frame.point(corner))
            .collect::<Vec<_>>()
    };
    let at_home = track.frames.get(track.home).into_iter();
    let tips = at_home.flat_map(|frame| (0..3).map(|axis| frame.point(unit(axis, scale * AXIS))));
    let marker = marker(track, scale);
    let path = track.frames.iter().map(|frame| frame.point(marker));
    let blocks = ends.into_iter().flatten().flat_map(of_child);
    blocks.chain(tips).chain(path).collect()
}

/// Draws a panel, the farthest first.
pub fn draw(pen: &mut Pen, sweep: &Sweep, forbidden: bool) {
    let colour = if forbidden { FORBIDDEN } else { ALLOWED };
    let scale = scale(sweep);
    for track in &sweep.bodies {
        for ghost in ghosts(track) {
            block(pen, ghost, scale, Look::surface(colour, 0.13, 0.5));
        }
    }
    parent(pen);
    for track in &sweep.bodies {
        if let Some(home) = track.frames.get(track.home) {
            let stem = Look {
                dashed: true,
                ..Look::line(INK, 0.8)
            };
            pen.path(&[[0.0; 3], home.origin], false, stem);
            block(pen, home, scale, Look::surface(BODY, 0.45, 0.9));
            axes(pen, home, scale);
        }
    }
    for track in &sweep.bodies {
        path(pen, track, scale, forbidden);
    }
}

/// The ends of the sweep.
fn ghosts(track: &Track) -> impl Iterator<Item = &Frame> {
    let last = track.frames.len().saturating_sub(1);
    let ends = [0, last].into_iter().filter(|at| *at != track.home);
    ends.filter_map(|at| track.frames.get(at))
}

fn parent(pen: &mut Pen) {
    for (axis, name) in ['x', 'y', 'z'].into_iter().enumerate() {
        let tip = unit(axis, PARENT_AXIS);
        pen.arrow(&[[0.0; 3], tip], Look::line(INK, 1.0));
        pen.label([0.0; 3], tip, name, INK);
    }
}

fn axes(pen: &mut Pen, frame: &Frame, scale: f64) {
    for (axis, colour) in AXES.into_iter().enumerate() {
        let tip = frame.point(unit(axis, scale * AXIS));
        pen.arrow(&[frame.origin, tip], Look::line(colour, 1.8));
    }
}

/// The path of a point of a body; the line of a forbidden one is broken.
fn path(pen: &mut Pen, track: &Track, scale: f64, forbidden: bool) {
    let colour = if forbidden { FORBIDDEN } else { ALLOWED };
    let marker = marker(track, scale);
    let points: Vec<[f64; 3]> = track
        .frames
        .iter()
        .map(|frame| frame.point(marker))
        .collect();
    let look = Look {
        dashed: forbidden,
        ..Look::line(colour, 2.2)
    };
    pen.arrow(&points, look);
}

/// The point whose path is shown: the origin, unless the tip of an axis goes clearly farther.
fn marker(track: &Track, scale: f64) -> [f64; 3] {
    let (Some(home), Some(last)) = (track.frames.get(track.home), track.frames.last()) else {
        return [0.0; 3];
    };
    let travel = |local: [f64; 3]| {
        let (a, b) = (home.point(local), last.point(local));
        (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
    };
    let mut best = ([0.0; 3], 1.02 * travel([0.0; 3]));
    for tip in (0..3).map(|axis| unit(axis, scale * AXIS)) {
        // A tenth more, so that rounding does not decide between two tips that go equally far.
        if travel(tip) > 1.1 * best.1 + 1e-6 {
            best = (tip, travel(tip));
        }
    }
    best.0
}

/// The faces of the block that the viewer sees.
fn block(pen: &mut Pen, frame: &Frame, scale: f64, look: Look) {
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let normal = frame.point(unit(axis, side));
            let normal = std::array::from_fn(|i| normal[i] - frame.origin[i]);
            if faces_viewer(normal) {
                pen.path(
                    &face(axis, side, scale).map(|corner| frame.point(corner)),
                    true,
                    look,
                );
            }
        }
    }
}

/// The corners of a face, around it.
fn face(axis: usize, side: f64, scale: f64) -> [[f64; 3]; 4] {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(a, b)| {
        let mut corner = [0.0; 3];
        corner[axis] = side * scale * BLOCK[axis];
        corner[u] = a * scale * BLOCK[u];
        corner[v] = b * scale * BLOCK[v];
        corner
    })
}

fn corners(scale: f64) -> Vec<[f64; 3]> {
    [-1.0, 1.0]
        .into_iter()
        .flat_map(|side| face(2, side, scale))
        .collect()
}

fn unit(axis: usize, length: f64) -> [f64; 3] {
    std::array::from_fn(|i| if i == axis { length } else { 0.0 })
}
