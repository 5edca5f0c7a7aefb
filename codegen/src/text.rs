//! Text of specs, files and paths where it is emitted: what a reader does not see is written out, and markup that could do more than
//! set letters is text.

/// Marks that begin and end blocks of code in Markdown.
const FENCES: [char; 2] = ['`', '~'];

/// Fewest marks of a fence.
const SHORTEST_FENCE: usize = 3;

/// The text with characters that do not print, or that turn the direction of writing, as `\u{202e}`. Ends of lines and tabs stay.
pub fn visible(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        match c == '\n' || c == '\t' || prints(c) {
            true => shown.push(c),
            false => shown.extend(c.escape_unicode()),
        }
    }
    shown
}

/// A path or a name in one line, for a comment of any language: what would end one is parted.
pub fn one_line(text: &str) -> String {
    let line = visible(text).replace('\n', "\\n").replace('\t', "\\t");
    line.replace("--", "- -")
        .replace("*/", "* /")
        .replace("/*", "/ *")
}

/// Whether all of the text is seen as it is.
pub fn is_visible(text: &str) -> bool {
    text.chars().all(|c| c == '\n' || c == '\t' || prints(c))
}

/// Whether a reader sees the character, or sees what it does to the letter before it.
fn prints(c: char) -> bool {
    if c.is_ascii() {
        return c.is_ascii_graphic() || c == ' ';
    }
    // The standard library escapes what does not print; behind a letter it leaves accents alone.
    let pair: String = ['a', c].iter().collect();
    pair.escape_debug().eq(pair.chars())
}

/// A doc comment as Markdown in which code, indented or between fences, is text, and links, HTML and formulas are letters; words
/// between backticks are code.
pub fn markdown(lines: &[impl AsRef<str>]) -> Vec<String> {
    let mut written: Vec<String> = vec![];
    let mut paragraph: Vec<&str> = vec![];
    let mut fence: Option<&str> = None;
    for line in lines.iter().map(AsRef::as_ref) {
        let bare = line.trim();
        match fence {
            Some(open) if closes(bare, open) => {
                written.push(open.to_owned());
                fence = None;
            }
            Some(_) => written.push(visible(line)),
            None => match opening(bare) {
                Some(open) => {
                    written.extend(of_paragraph(&paragraph));
                    paragraph.clear();
                    written.push(format!("{open}text"));
                    fence = Some(open);
                }
                // Indented lines would be code.
                None => paragraph.push(bare),
            },
        }
    }
    written.extend(of_paragraph(&paragraph));
    written.extend(fence.map(str::to_owned));
    written
}

/// Characters that begin links, HTML, formulas and escapes.
const SPECIAL: &str = r"\<[$";

/// Text in one line as Markdown, in the same way.
pub fn inline(text: &str) -> String {
    inline_but(text, SPECIAL)
}

/// The same, where these characters are letters outside of code.
pub fn inline_but(text: &str, special: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    escaped(&visible(&line), special)
}

/// Backticks that no line of the text closes.
pub fn fence(text: &str) -> String {
    let runs = text.split(|c| c != '`').map(str::len);
    "`".repeat(SHORTEST_FENCE.max(1 + runs.max().unwrap_or(0)))
}

/// The marks of a fence that a line opens.
fn opening(line: &str) -> Option<&str> {
    let mark = line.chars().next().filter(|c| FENCES.contains(c))?;
    let length = line.chars().take_while(|c| *c == mark).count();
    let is_fence = length >= SHORTEST_FENCE && !(mark == '`' && line[length..].contains(mark));
    is_fence.then(|| &line[..length])
}

fn closes(line: &str, open: &str) -> bool {
    let mark = open.chars().next();
    line.len() >= open.len() && line.chars().all(|c| Some(c) == mark)
}

/// Lines of text, empty ones among them: code spans do not reach across these.
fn of_paragraph(lines: &[&str]) -> Vec<String> {
    let paragraphs = lines.split(|line| line.is_empty());
    let escaped = paragraphs.map(|lines| escaped(&visible(&lines.join("\n")), SPECIAL));
    let text = escaped.collect::<Vec<_>>().join("\n\n");
    match lines.is_empty() {
        true => vec![],
        false => text.split('\n').map(str::to_owned).collect(),
    }
}

/// Text in which these characters are letters outside of code. Backticks that are no pair are letters too.
fn escaped(text: &str, special: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    let mut shown = String::with_capacity(text.len());
    for (i, part) in parts.iter().enumerate() {
        let is_code = i % 2 == 1;
        let is_closed = i + 1 < parts.len();
        match (is_code, is_closed && !part.trim().is_empty()) {
            (false, _) => shown += &letters(part, special),
            (true, true) => shown.extend(["`", part, "`"]),
            // A backtick that opens nothing, or nothing between two.
            (true, false) => {
                shown += &format!("\\`{}", letters(part, special));
                shown += if is_closed { "\\`" } else { "" };
            }
        }
    }
    shown
}

/// A bare address would be a link.
fn letters(text: &str, special: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for (at, c) in text.char_indices() {
        if special.contains(c) || text[at..].starts_with("://") {
            shown.push('\\');
        }
        shown.push(c);
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::{inline, is_visible, markdown, one_line, visible};

    #[test]
    fn what_is_not_seen_is_written_out() {
        let hidden = "a\u{1b}[31m\u{202e}b\u{200b}\u{feff}\r";
        assert_eq!(
            visible(hidden),
            "a\\u{1b}[31m\\u{202e}b\\u{200b}\\u{feff}\\u{d}"
        );
        assert!(!is_visible(hidden));
        for plain in [
            "S\u{304} ϕ → ∂ 3×4",
            "tab\tand\nline",
            "\"quoted\" \\ 'too'",
        ] {
            assert!(is_visible(plain), "{plain}");
            assert_eq!(visible(plain), plain);
        }
    }

    #[test]
    fn names_do_not_end_the_comments_that_they_stand_in() {
        assert_eq!(one_line("a -->\n*/ b/*"), r"a - ->\n* / b/ *");
    }

    #[test]
    fn code_is_text_and_every_fence_is_closed() {
        let docs = [
            "One.",
            "```rust",
            "  exit(0)",
            "```",
            "    indented",
            "~~~~",
            "`` ``` ~~~",
        ];
        let wanted = [
            "One.",
            "```text",
            "  exit(0)",
            "```",
            "indented",
            "~~~~text",
            "`` ``` ~~~",
            "~~~~",
        ];
        assert_eq!(markdown(&docs), wanted);
        assert_eq!(markdown(&["a", "", "b"]), ["a", "", "b"]);
        assert_eq!(markdown(&[""; 0]), [""; 0]);
    }

    #[test]
    fn links_html_and_formulas_are_letters_outside_of_code() {
        assert_eq!(
            inline("[x](y) <b> `<b> [x]` \\<"),
            r"\[x](y) \<b> `<b> [x]` \\\<"
        );
        assert_eq!(inline("one ` alone"), r"one \` alone");
        assert_eq!(inline("`` and `c`"), r"\`\` and `c`");
        assert_eq!(inline("$$\\href{x}$$"), r"\$\$\\href{x}\$\$");
        assert_eq!(
            inline("see https://example.org"),
            r"see https\://example.org"
        );
    }

    #[test]
    fn code_may_reach_across_lines_but_not_across_paragraphs() {
        assert_eq!(markdown(&["a `b", "c` d"]), ["a `b", "c` d"]);
        assert_eq!(markdown(&["a `b", "", "<c>`"]), ["a \\`b", "", "\\<c>\\`"]);
    }
}
