//! The border to the terminal: all text that the program says goes through here, and what a terminal would obey, or a reader would not see, is
//! written out. Names, paths, texts of files and what other programs say cannot colour, move or hide anything.

use clap::error::Error;
use hamel_scene::text::{is_hidden, is_visible, visible};
use serde_json::ser::Formatter;
use std::io::{self, IsTerminal, Write};

/// Says text on stdout.
///
/// # Errors
/// A stdout that cannot be written.
pub(crate) fn out(text: &str) -> io::Result<()> {
    io::stdout().lock().write_all(visible(text).as_bytes())
}

/// Says lines on stderr. If stderr is gone nobody is left to tell.
pub fn err(text: &str) {
    drop(writeln!(io::stderr().lock(), "{}", visible(text)));
}

/// Says on stderr what has been rendered with colours or without them: `render` writes out itself what would not be seen.
pub(crate) fn err_rendered(render: impl FnOnce(bool) -> String) {
    let mut stderr = io::stderr().lock();
    let colour = stderr.is_terminal() && std::env::var_os("NO_COLOR").is_none();
    drop(write!(stderr, "{}", render(colour)));
}

/// Says what the command line was answered with: help, or why it was not understood.
pub fn answer(answer: &Error) {
    let mut arguments = std::env::args_os();
    let is_plain = arguments.all(|argument| is_visible(&argument.to_string_lossy()));
    if is_plain {
        drop(answer.print());
        return;
    }
    let text = answer.render().to_string();
    match answer.use_stderr() {
        true => err(text.trim_end()),
        false => drop(out(&text)),
    }
}

/// Texts of JSON, in which what would not be seen is written as `\u202e`.
pub(crate) struct Texts;

impl Formatter for Texts {
    fn write_string_fragment<W: ?Sized + Write>(
        &mut self,
        writer: &mut W,
        fragment: &str,
    ) -> io::Result<()> {
        fragment_of_json(writer, fragment)
    }
}

/// A part of a text of JSON, for formatters.
///
/// # Errors
/// A writer that cannot be written.
pub fn fragment_of_json<W: ?Sized + Write>(writer: &mut W, fragment: &str) -> io::Result<()> {
    for part in fragment.split_inclusive(is_hidden) {
        let hidden = part.chars().next_back().filter(|c| is_hidden(*c));
        let shown = hidden.map_or(part, |c| &part[..part.len() - c.len_utf8()]);
        writer.write_all(shown.as_bytes())?;
        let mut units = [0; 2];
        for unit in hidden.map_or(&[][..], |c| c.encode_utf16(&mut units)) {
            write!(writer, "\\u{unit:04x}")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::Texts;
    use serde::Serialize;
    use serde_json::Serializer;

    #[test]
    fn texts_of_json_show_all_and_read_back() {
        let text = "a\u{202e}b\u{e0041}\u{1b}\n\u{9b}c é";
        let mut bytes = Vec::new();
        let mut serializer = Serializer::with_formatter(&mut bytes, Texts);
        text.serialize(&mut serializer).expect("memory takes it");
        let written = String::from_utf8(bytes).expect("JSON is UTF-8");
        assert_eq!(written, r#""a\u202eb\udb40\udc41\u001b\n\u009bc é""#);
        let read: String = serde_json::from_str(&written).expect("JSON");
        assert_eq!(read, text);
    }
}
