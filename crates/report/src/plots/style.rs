//! Colours, marks and letters.

use hamel::integrate::Scheme;
use plotters::prelude::*;

/// Okabe and Ito's colours, which colour-blind readers can tell apart, without the yellow that paper swallows, and four
/// more that differ from them in lightness; marks differ as well.
const COLOURS: [RGBColor; 11] = [
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(204, 121, 167),
    RGBColor(120, 120, 120),
    RGBColor(120, 78, 40),
    RGBColor(106, 61, 154),
    RGBColor(150, 150, 40),
];

/// Of lines that are no curve.
pub const QUIET: RGBColor = RGBColor(90, 90, 90);
/// Of grids.
pub const GRID: RGBColor = RGBColor(225, 225, 225);

pub const FONT: &str = "Helvetica, Arial, sans-serif";
/// Sizes of letters, px.
pub const LABEL: u32 = 15;
pub const TITLE: u32 = 16;

/// Shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    Circle,
    Square,
    Triangle,
    Diamond,
}

/// How a curve looks.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    pub colour: RGBColor,
    pub mark: Mark,
    pub dashed: bool,
}

/// The look of the curve of that number.
pub fn numbered(number: usize) -> Look {
    const MARKS: [Mark; 4] = [Mark::Circle, Mark::Square, Mark::Triangle, Mark::Diamond];
    Look {
        colour: COLOURS[number % COLOURS.len()],
        mark: MARKS[number % MARKS.len()],
        dashed: false,
    }
}

/// The look of a method: the same in all figures.
pub fn method(name: &str) -> Look {
    let place = Scheme::ALL.iter().position(|scheme| scheme.name() == name);
    numbered(place.unwrap_or(COLOURS.len()))
}

/// A power of ten with a raised exponent.
pub fn decade(value: f64) -> String {
    let exponent = value.log10().round() as i32;
    let raised = |digit: char| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        other => char::from_u32(u32::from(other) - u32::from('0') + 0x2070).unwrap_or(other),
    };
    let digits: String = exponent.to_string().chars().map(raised).collect();
    format!("10{digits}")
}
