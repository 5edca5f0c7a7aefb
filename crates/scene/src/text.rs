//! Characters that a reader does not see: names must not hold them, and wherever text is shown they are written out.
//!
//! Two names that look alike would otherwise be two, a name could turn the direction of what stands beside it, and a terminal would obey it.

use crate::read::LONGEST_NAME;

/// Characters that take no room and that the standard library counts as printed: joiners of marks, fillers, selectors of variants.
const WITHOUT_WIDTH: [(char, char); 9] = [
    ('\u{34f}', '\u{34f}'),
    ('\u{115f}', '\u{1160}'),
    ('\u{17b4}', '\u{17b5}'),
    ('\u{180b}', '\u{180f}'),
    ('\u{2065}', '\u{2065}'),
    ('\u{3164}', '\u{3164}'),
    ('\u{fe00}', '\u{fe0f}'),
    ('\u{ffa0}', '\u{ffa0}'),
    ('\u{e0100}', '\u{e01ef}'),
];

/// Whether a reader does not see the character: it controls a terminal, turns the direction of writing, takes no room, or is a blank other than
/// the space. Accents are seen on the letter before them.
pub fn is_hidden(c: char) -> bool {
    if c.is_ascii() {
        return c.is_ascii_control();
    }
    let takes_no_room = WITHOUT_WIDTH
        .iter()
        .any(|(first, last)| (*first..=*last).contains(&c));
    // The standard library escapes what does not print; behind a letter it leaves accents alone.
    let pair: String = ['a', c].iter().collect();
    takes_no_room || !pair.escape_debug().eq(pair.chars())
}

/// Whether all of a text is seen. Ends of lines and tabs count as seen.
pub fn is_visible(text: &str) -> bool {
    !text.chars().any(|c| is_hidden(c) && c != '\n' && c != '\t')
}

/// The text with hidden characters as `\u{202e}`. Ends of lines and tabs stay.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match is_hidden(c) && c != '\n' && c != '\t' {
            true => shown.extend(c.escape_unicode()),
            false => shown.push(c),
        }
    }
    shown
}

/// The same in one line: ends of lines and tabs are written out too.
pub fn visible_line(text: &str) -> String {
    visible(text)
        .replace('\n', "\\u{a}")
        .replace('\t', "\\u{9}")
}

/// A text as messages show it: in one line, without control characters, not too long.
pub(crate) fn quoted(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.chars().count() {
        0..=LONGEST => format!("{text:?}"),
        _ => format!("{:?}…", text.chars().take(LONGEST).collect::<String>()),
    }
}

/// Why a text is no name; `None` where it is one.
pub(crate) fn no_name(text: &str) -> Option<String> {
    let why = match text {
        "" => "but must be a name",
        text if text.contains(char::is_control) => "with a control character",
        text if text.contains(is_hidden) => "with a character that is not seen",
        text if text.len() > LONGEST_NAME => {
            let length = text.len();
            return Some(format!(
                "of {length} bytes, but {LONGEST_NAME} are possible"
            ));
        }
        _ => return None,
    };
    Some(why.to_owned())
}

/// Where bytes stop being UTF-8, in words; the text where they do not.
pub(crate) fn from_utf8(bytes: Vec<u8>) -> Result<String, String> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.as_bytes();
        let line = 1 + bytes[..valid].iter().filter(|byte| **byte == b'\n').count();
        format!(
            "its line {line} is not UTF-8: byte {valid} of the file is {:#04x}",
            bytes[valid]
        )
    })
}

#[cfg(test)]
mod tests {
    use super::{from_utf8, is_hidden, is_visible, visible, visible_line};

    #[test]
    fn what_turns_takes_no_room_or_controls_is_hidden() {
        for c in "\0\u{1b}\u{7f}\u{9b}\u{ad}\u{34f}\u{61c}\u{180e}\u{200b}\u{200d}\u{200f}\u{2028}\u{202e}\u{2060}\u{2069}\u{3164}\u{fe0f}\u{feff}\u{e0041}".chars() {
            assert!(is_hidden(c), "{c:?}");
        }
        for c in " a_é→ϕ中\u{304}".chars() {
            assert!(!is_hidden(c), "{c:?}");
        }
    }

    #[test]
    fn hidden_characters_are_written_out() {
        assert_eq!(
            visible("a\u{1b}[2J\u{202e}\n\tb"),
            "a\\u{1b}[2J\\u{202e}\n\tb"
        );
        assert_eq!(visible_line("a\n\tb"), "a\\u{a}\\u{9}b");
        assert!(is_visible("lines\n\tand S\u{304}") && !is_visible("a\r\n"));
    }

    #[test]
    fn the_line_that_is_not_utf8_is_named() {
        let refused = from_utf8(b"a\nb\n\xffc".to_vec());
        assert_eq!(
            refused.expect_err("no UTF-8"),
            "its line 3 is not UTF-8: byte 4 of the file is 0xff"
        );
    }
}
