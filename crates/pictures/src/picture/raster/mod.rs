//! Pictures of pixels: a still one as PNG, and a moving one as GIF. They show meshes as well.

mod gif;
mod layer;
mod png;

pub use gif::{Playing, is_gif, write as write_gif};
pub use png::{is_png, write as write_png};

use super::Instant;
use super::colors::{Color, named};
use super::order::clipped;
use super::scenery::Scenery;
use super::solid::Solid;
use super::stage::{GRID, GRID_PART, LINE, Line, SHADOW, Stage, ghost};
use layer::{Corner, FINE, Layer, Rgb};
use nalgebra::{Vector2, Vector3};
use std::io::Read;

/// By which pictures are known that were written before.
const MARK: &str = "hamel simulate";

/// Bytes of a file in which the mark is.
const HEAD: u64 = 1024;

/// Whether a file begins with these bytes and has the mark in its head.
fn has_mark(file: impl Read, start: &[u8]) -> bool {
    let mut head = vec![];
    let is_read = file.take(HEAD).read_to_end(&mut head).is_ok();
    let mut windows = head.windows(MARK.len());
    is_read && head.starts_with(start) && windows.any(|part| part == MARK.as_bytes())
}

/// What draws the instants of one motion.
struct Painter<'a> {
    scenery: &'a Scenery<'a>,
    stage: Stage,
    /// Width and height, pixels.
    size: (u16, u16),
    /// Sky and ground.
    empty: Layer,
}

impl<'a> Painter<'a> {
    /// For pictures of that size, in which all `instants` are seen.
    fn new(scenery: &'a Scenery<'a>, instants: &[Instant], size: (u16, u16)) -> Self {
        let aspect = f64::from(size.0) / f64::from(size.1);
        let mut painter = Self {
            scenery,
            stage: Stage::of(scenery, instants, aspect),
            size,
            empty: Layer::new(size, bytes(named("sky"))),
        };
        painter.grid();
        painter
    }

    /// The last of some instants in full, and those before it paler; row by row.
    fn picture(&self, instants: &[Instant]) -> Vec<Rgb> {
        let mut picture = self.empty.clone();
        let Some((last, earlier)) = instants.split_last() else {
            return picture.reduced();
        };
        let solids = self.scenery.solids(last, self.stage.size, true);
        if let Some(ground) = self.stage.ground {
            self.shadow(&mut picture, &solids, ground);
        }
        for (index, instant) in earlier.iter().enumerate() {
            let mut paler = self.layer();
            self.solids(
                &mut paler,
                &self.scenery.solids(instant, self.stage.size, false),
            );
            picture.cover(&paler, ghost(index, earlier.len()));
        }
        self.solids(&mut picture, &solids);
        picture.reduced()
    }

    /// A layer in which nothing is.
    fn layer(&self) -> Layer {
        Layer::new(self.size, [0; 3])
    }

    /// The faces of solids in the light, on the side that is seen.
    fn solids(&self, picture: &mut Layer, solids: &[Solid]) {
        let eye = self.stage.view.eye;
        for face in solids.iter().flat_map(|solid| &solid.faces) {
            let is_seen = face.normal.dot(&(eye - face.corners[0])) >= 0.0;
            // Triangles of meshes have two sides.
            let normal = if is_seen { face.normal } else { -face.normal };
            let lit = self.stage.lit(&normal);
            let color = bytes(face.color.map(|part| part * lit));
            picture.face(&self.seen(&face.corners), color);
        }
    }

    /// The shadows of solids on the ground.
    fn shadow(&self, picture: &mut Layer, solids: &[Solid], ground: f64) {
        let mut shadow = self.layer();
        for face in solids.iter().flat_map(|solid| &solid.faces) {
            let corners = face.corners.iter();
            let corners: Vec<_> = corners
                .map(|corner| self.stage.shadow(corner, ground))
                .collect();
            shadow.face(&self.seen(&corners), [0; 3]);
        }
        picture.cover(&shadow, SHADOW);
    }

    /// Draws the squares on the ground.
    fn grid(&mut self) {
        let Some(ground) = self.stage.ground else {
            return;
        };
        let color = bytes(named("grid"));
        for lines in self.stage.grid(ground) {
            let mut grid = self.layer();
            for line in lines {
                grid.face(&self.stroke(&line), color);
            }
            self.empty.cover(&grid, GRID * GRID_PART);
        }
    }

    /// The corners of a line that is as wide as on a picture of the usual size.
    fn stroke(&self, line: &Line) -> [Corner; 4] {
        let scale = f64::from(self.size.0) / f64::from(super::SIZE.0);
        let [a, b] = line.map(|end| self.at(&end));
        let along = Vector2::new(b[0] - a[0], b[1] - a[1]);
        let half = along.try_normalize(0.0).unwrap_or_else(Vector2::x)
            * (LINE * scale * f64::from(FINE) / 2.0);
        let beside =
            |end: Corner, side: f64| [end[0] - side * half.y, end[1] + side * half.x, end[2]];
        [
            beside(a, 1.0),
            beside(b, 1.0),
            beside(b, -1.0),
            beside(a, -1.0),
        ]
    }

    /// The corners of the part of a face that is before the eye.
    fn seen(&self, corners: &[Vector3<f64>]) -> Vec<Corner> {
        let view = &self.stage.view;
        let near = view.near();
        let is_near = |corner: &Vector3<f64>| view.depth(corner) < near;
        let at = |corners: &[Vector3<f64>]| corners.iter().map(|corner| self.at(corner)).collect();
        match corners.iter().any(is_near) {
            true => at(&clipped(
                corners,
                &-view.back,
                &(view.eye - view.back * near),
            )),
            false => at(corners),
        }
    }

    fn at(&self, place: &Vector3<f64>) -> Corner {
        let at = self.stage.view.pixel(place, self.size) * f64::from(FINE);
        [at.x, at.y, 1.0 / self.stage.view.depth(place)]
    }
}

fn bytes(color: Color) -> Rgb {
    color.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8)
}
