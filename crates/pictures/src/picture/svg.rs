//! The picture as SVG.

use super::colors::{Color, named, written};
use super::order::ordered;
use super::scenery::Scenery;
use super::solid::Solid;
use super::stage::{GRID, GRID_PART, LINE, SHADOW, Stage, ghost};
use super::{Instant, SIZE};
use nalgebra::{Vector2, Vector3};
use std::fmt::Write;

/// By which a picture is known.
pub const FIRST_LINE: &str = "<!-- hamel simulate, picture -->";

/// The unit of its coordinates, pixels.
const UNIT: f64 = 0.1;

/// What is drawn, and from where.
struct Canvas {
    stage: Stage,
    text: String,
}

/// The picture of all `instants`, of which the last is shown in full, and those before it paler.
pub fn picture(name: &str, scenery: &Scenery, instants: &[Instant]) -> String {
    let stage = Stage::of(scenery, instants, f64::from(SIZE.0) / f64::from(SIZE.1));
    let (size, ground) = (stage.size, stage.ground);
    let mut canvas = Canvas {
        stage,
        text: String::new(),
    };
    canvas.head(name);
    if let Some(ground) = ground {
        canvas.grid(ground);
    }
    let Some((last, earlier)) = instants.split_last() else {
        canvas.text.push_str("</svg>\n");
        return canvas.text;
    };
    let solids = scenery.solids(last, size, true);
    if let Some(ground) = ground {
        canvas.shadow(&solids, ground);
    }
    for (index, instant) in earlier.iter().enumerate() {
        let opacity = ghost(index, earlier.len());
        canvas.ghost(&scenery.solids(instant, size, false), opacity);
    }
    canvas.solids(solids);
    canvas.text.push_str("</svg>\n");
    canvas.text
}

impl Canvas {
    fn head(&mut self, name: &str) {
        let (width, height) = SIZE;
        let [wide, high] = [width, height].map(|length| f64::from(length) / UNIT);
        let name = name.replace('&', "&amp;").replace('<', "&lt;");
        let sky = written(named("sky"));
        self.text = format!(
            "{FIRST_LINE}\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {wide} {high}\" stroke-linejoin=\"round\">\n\
             <title>{name}</title>\n<rect width=\"{wide}\" height=\"{high}\" fill=\"{sky}\"/>\n"
        );
    }

    /// Where a point is drawn, in units.
    fn at(&self, place: &Vector3<f64>) -> Vector2<f64> {
        (self.stage.view.pixel(place, SIZE) / UNIT).map(f64::round)
    }

    /// A closed path of points; none where they fall together.
    fn closed(&self, corners: impl IntoIterator<Item = Vector2<f64>>) -> Option<String> {
        let mut points: Vec<Vector2<f64>> = corners.into_iter().collect();
        points.dedup();
        if points.len() < 3 {
            return None;
        }
        let mut path = format!("M{} {}", points[0].x, points[0].y);
        for pair in points.windows(2) {
            let step = pair[1] - pair[0];
            let _ = write!(
                path,
                "{}{} {}",
                if pair[0] == points[0] { "l" } else { " " },
                step.x,
                step.y
            );
        }
        path.push('z');
        Some(path)
    }

    /// The faces of solids that look to the eye.
    fn solids(&mut self, solids: Vec<Solid>) {
        let eye = self.stage.view.eye;
        // Strokes close the seams between faces.
        self.text.push_str("<g stroke-width=\"6\">\n");
        for solid in ordered(solids, &eye, self.stage.size) {
            let mut last = None;
            for face in &solid.faces {
                if face.normal.dot(&(eye - face.corners[0])) <= 0.0 {
                    continue;
                }
                let lit = self.stage.lit(&face.normal);
                let color = written(face.color.map(|part| part * lit));
                let Some(path) = self.closed(face.corners.iter().map(|corner| self.at(corner)))
                else {
                    continue;
                };
                // Faces of one colour are one path.
                if last.as_ref() == Some(&color) {
                    self.text.push_str(&path);
                    continue;
                }
                self.end_path(last.is_some());
                let _ = write!(
                    self.text,
                    "<path fill=\"{color}\" stroke=\"{color}\" d=\"{path}"
                );
                last = Some(color);
            }
            self.end_path(last.is_some());
        }
        self.text.push_str("</g>\n");
    }

    fn end_path(&mut self, is_open: bool) {
        if is_open {
            self.text.push_str("\"/>\n");
        }
    }

    /// The outlines of solids at an earlier instant, the nearest last.
    fn ghost(&mut self, solids: &[Solid], opacity: f64) {
        let mut outlines: Vec<(f64, String)> = vec![];
        for solid in solids {
            let outline = hull(solid.corners().map(|corner| self.at(corner)).collect());
            let Some(path) = self.closed(outline) else {
                continue;
            };
            let color: Color = solid.faces[0].color;
            let (fill, edge) = (written(color), written(color.map(|part| 0.7 * part)));
            let depth = self.stage.view.depth(&solid.centre());
            outlines.push((
                depth,
                format!("<path fill=\"{fill}\" stroke=\"{edge}\" d=\"{path}\"/>\n"),
            ));
        }
        outlines.sort_by(|a, b| b.0.total_cmp(&a.0));
        let _ = writeln!(self.text, "<g stroke-width=\"6\" opacity=\"{opacity:.2}\">");
        self.text.extend(outlines.into_iter().map(|(_, path)| path));
        self.text.push_str("</g>\n");
    }

    /// The shadow of solids on the ground.
    fn shadow(&mut self, solids: &[Solid], ground: f64) {
        let _ = writeln!(self.text, "<g opacity=\"{SHADOW}\">");
        for solid in solids {
            let corners = solid.corners();
            let corners = corners.map(|corner| self.at(&self.stage.shadow(corner, ground)));
            if let Some(path) = self.closed(hull(corners.collect())) {
                let _ = writeln!(self.text, "<path d=\"{path}\"/>");
            }
        }
        self.text.push_str("</g>\n");
    }

    /// Squares on the ground, paler towards their end.
    fn grid(&mut self, ground: f64) {
        let grid = written(named("grid"));
        let _ = writeln!(
            self.text,
            "<g stroke=\"{grid}\" stroke-width=\"{}\" opacity=\"{GRID}\">",
            LINE / UNIT
        );
        for lines in self.stage.grid(ground) {
            let mut path = String::new();
            for line in lines {
                let [a, b] = line.map(|end| self.at(&end));
                let _ = write!(path, "M{} {}L{} {}", a.x, a.y, b.x, b.y);
            }
            let _ = writeln!(self.text, "<path opacity=\"{GRID_PART}\" d=\"{path}\"/>");
        }
        self.text.push_str("</g>\n");
    }
}

/// The convex hull of points, in the order around it.
fn hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = vec![];
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp(&(point - a)) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut points.iter().copied());
    hull.extend(half(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::hull;
    use nalgebra::Vector2;

    #[test]
    fn a_hull_leaves_out_what_is_inside() {
        let at = |x: f64, y: f64| Vector2::new(x, y);
        let points = vec![
            at(0.0, 0.0),
            at(2.0, 0.0),
            at(1.0, 1.0),
            at(2.0, 2.0),
            at(0.0, 2.0),
            at(1.0, 0.0),
        ];
        assert_eq!(
            hull(points),
            [at(0.0, 0.0), at(2.0, 0.0), at(2.0, 2.0), at(0.0, 2.0)]
        );
    }
}
