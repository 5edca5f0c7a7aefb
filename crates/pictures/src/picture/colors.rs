//! Colours of the page's style sheet, in its light scheme.

/// Red, green and blue, from 0 to 1.
pub type Color = [f64; 3];

const STYLE: &str = include_str!("../html/style.css");

/// The first colour of that name; grey where there is none.
pub fn named(name: &str) -> Color {
    let digits = STYLE
        .split_once(&format!("--{name}: #"))
        .and_then(|(_, rest)| rest.get(..6));
    let number = digits.and_then(|digits| u32::from_str_radix(digits, 16).ok());
    let [_, rgb @ ..] = number.unwrap_or(0x80_80_80).to_be_bytes();
    bytes(rgb)
}

/// A colour of three bytes.
pub fn bytes(rgb: [u8; 3]) -> Color {
    rgb.map(|part| f64::from(part) / 255.0)
}

/// The colour of a body without one of its own: solids are paler than lines.
pub fn of_body(body: usize) -> Color {
    named(&format!("line-{}", body % 6 + 1)).map(|part| 0.78 * part + 0.22 * 0.85)
}

/// As SVG writes it.
pub fn written(color: Color) -> String {
    let [red, green, blue] = color.map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::{named, written};

    #[test]
    fn colours_are_those_of_the_style_sheet() {
        assert_eq!(written(named("line-1")), "#1f66c9");
        assert_eq!(written(named("sky")), "#eef1f6");
    }
}
