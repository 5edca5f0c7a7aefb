//! Lines and surfaces as elements of SVG, in colours that stand out from white and from black.

use super::view::{Spot, View};
use std::fmt::Write;

/// Text and the parent frame.
pub const INK: &str = "#808992";
/// Directions that the joint forbids.
pub const FORBIDDEN: &str = "#dc4a5e";
/// Directions that the joint allows.
pub const ALLOWED: &str = "#1f9e89";
/// The child.
pub const BODY: &str = "#7d93ad";
/// The axes x, y, z.
pub const AXES: [&str; 3] = ["#e0564f", "#4aa84e", "#4486e0"];

/// How a line or surface looks.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Its colour.
    pub colour: &'static str,
    /// Width of the line in pixels.
    pub width: f64,
    /// Opacity of the surface, 0 for a line.
    pub fill: f64,
    /// Opacity of the line.
    pub opacity: f64,
    /// Whether the line is broken.
    pub dashed: bool,
}

impl Look {
    /// A full line.
    pub fn line(colour: &'static str, width: f64) -> Self {
        Self {
            colour,
            width,
            fill: 0.0,
            opacity: 1.0,
            dashed: false,
        }
    }

    /// A surface with an edge.
    pub fn surface(colour: &'static str, fill: f64, opacity: f64) -> Self {
        Self {
            colour,
            width: 1.0,
            fill,
            opacity,
            dashed: false,
        }
    }

    fn attributes(self) -> String {
        let fill = match self.fill > 0.0 {
            true => format!("fill=\"{}\" fill-opacity=\"{}\"", self.colour, self.fill),
            false => "fill=\"none\"".to_owned(),
        };
        let dashes = if self.dashed {
            " stroke-dasharray=\"5 4\""
        } else {
            ""
        };
        let opacity = match self.opacity < 1.0 {
            true => format!(" stroke-opacity=\"{}\"", self.opacity),
            false => String::new(),
        };
        format!(
            "{fill} stroke=\"{}\" stroke-width=\"{}\"{opacity}{dashes}",
            self.colour, self.width
        )
    }
}

/// Collects elements.
pub struct Pen {
    view: View,
    elements: String,
}

impl Pen {
    /// A pen for one panel.
    pub fn new(view: View) -> Self {
        Self {
            view,
            elements: String::new(),
        }
    }

    /// The elements drawn.
    pub fn finish(self) -> String {
        self.elements
    }

    /// A line through points, closed where `closed` says so.
    pub fn path(&mut self, points: &[[f64; 3]], closed: bool, look: Look) {
        let spots: Vec<Spot> = points.iter().map(|point| self.view.spot(*point)).collect();
        self.spots(&spots, closed, look);
    }

    /// An arrow along points.
    pub fn arrow(&mut self, points: &[[f64; 3]], look: Look) {
        self.path(points, false, look);
        let [.., before, last] = points else {
            return;
        };
        let (from, tip) = (self.view.spot(*before), self.view.spot(*last));
        self.head(
            from,
            tip,
            Look {
                dashed: false,
                ..look
            },
        );
    }

    /// A name beyond the end of a line.
    pub fn label(&mut self, from: [f64; 3], to: [f64; 3], text: char, colour: &str) {
        let (start, end) = (self.view.spot(from), self.view.spot(to));
        let (x, y) = direction(start, end);
        let (x, y) = (end.0 + 8.0 * x, end.1 + 8.0 * y + 3.5);
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.elements,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" font-size=\"11\" font-style=\"italic\" fill=\"{colour}\">{text}</text>",
            rounded(x),
            rounded(y)
        );
    }

    fn head(&mut self, from: Spot, tip: Spot, look: Look) {
        let (x, y) = direction(from, tip);
        let (length, half) = (3.0 + 2.2 * look.width, 1.2 + 1.1 * look.width);
        let base = (tip.0 - length * x, tip.1 - length * y);
        let corners = [
            tip,
            (base.0 - half * y, base.1 + half * x),
            (base.0 + half * y, base.1 - half * x),
        ];
        let look = Look {
            width: 0.5,
            fill: 1.0,
            ..look
        };
        self.spots(&corners, true, look);
    }

    fn spots(&mut self, spots: &[Spot], closed: bool, look: Look) {
        let points: Vec<String> = spots
            .iter()
            .map(|(x, y)| format!("{},{}", rounded(*x), rounded(*y)))
            .collect();
        let element = if closed { "polygon" } else { "polyline" };
        let _ = writeln!(
            self.elements,
            "<{element} points=\"{}\" {} stroke-linejoin=\"round\" stroke-linecap=\"round\"/>",
            points.join(" "),
            look.attributes()
        );
    }
}

/// The unit vector from one spot to another; 0 where they are one.
fn direction(from: Spot, to: Spot) -> Spot {
    let (x, y) = (to.0 - from.0, to.1 - from.1);
    let length = x.hypot(y);
    match length > 1e-6 {
        true => (x / length, y / length),
        false => (0.0, 0.0),
    }
}

/// To a tenth of a pixel: rounding errors of sines, which differ between machines, do not show.
fn rounded(value: f64) -> f64 {
    // Adding 0 turns −0 into 0.
    (value * 10.0).round() / 10.0 + 0.0
}
