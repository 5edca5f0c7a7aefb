//! The page put together from its parts.

use super::header::Header;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

const FRAME: &str = include_str!("../html/page.html");
const STYLE: &str = include_str!("../html/style.css");

/// One script out of several: a file uses what is declared above it.
const SCRIPTS: [&str; 10] = [
    include_str!("../html/algebra.js"),
    include_str!("../html/recording.js"),
    include_str!("../html/meshes.js"),
    include_str!("../html/painter.js"),
    include_str!("../html/camera.js"),
    include_str!("../html/stage.js"),
    include_str!("../html/chart.js"),
    include_str!("../html/clock.js"),
    include_str!("../html/panel.js"),
    include_str!("../html/main.js"),
];

/// The page of a motion.
///
/// # Errors
/// A header that JSON cannot hold.
pub fn page(header: &Header<'_>, blob: &[u8]) -> Result<String, serde_json::Error> {
    let json = serde_json::to_string(header)?;
    Ok(filled(&[
        ("title", &escaped(header.name)),
        ("style", STYLE),
        // Within JSON `<` stands in texts only; without it no text can end the element.
        ("header", &json.replace('<', "\\u003c")),
        ("numbers", &STANDARD.encode(blob)),
        ("script", &SCRIPTS.join("\n")),
    ]))
}

/// The frame with each `{{name}}` replaced, in one pass: what is put in is not looked at again.
fn filled(parts: &[(&str, &str)]) -> String {
    let mut pieces = FRAME.split("{{");
    let mut page = String::from(pieces.next().unwrap_or_default());
    for piece in pieces {
        let (name, rest) = piece.split_once("}}").unwrap_or(("", piece));
        let part = parts.iter().find(|(known, _)| *known == name);
        page.push_str(part.map_or("", |(_, text)| text));
        page.push_str(rest);
    }
    page
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;");
    text.replace('<', "&lt;").replace('>', "&gt;")
}
