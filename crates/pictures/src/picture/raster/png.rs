//! A still picture as PNG.

use super::super::scenery::Scenery;
use super::super::{Instant, SIZE};
use super::{MARK, Painter, has_mark};
use png::{BitDepth, ColorType, Encoder, EncodingError};
use std::io::{self, Read, Write};

/// Whether a file is a still picture of pixels that was written here.
pub fn is_png(file: impl Read) -> bool {
    has_mark(file, b"\x89PNG\r\n\x1a\n")
}

/// Writes the last of some instants in full, and those before it paler.
///
/// # Errors
/// What cannot be written.
pub fn write(scenery: &Scenery, instants: &[Instant], file: &mut impl Write) -> io::Result<()> {
    let pixels = Painter::new(scenery, instants, SIZE).picture(instants);
    let mut encoder = Encoder::new(file, u32::from(SIZE.0), u32::from(SIZE.1));
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder
        .add_text_chunk("Software".into(), MARK.into())
        .map_err(written)?;
    let mut writer = encoder.write_header().map_err(written)?;
    writer
        .write_image_data(pixels.as_flattened())
        .map_err(written)?;
    writer.finish().map_err(written)
}

fn written(error: EncodingError) -> io::Error {
    match error {
        EncodingError::IoError(error) => error,
        other => io::Error::other(other),
    }
}
