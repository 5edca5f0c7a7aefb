//! Text of specs and proofs in Markdown and HTML, where some characters mean something.

use crate::text::{inline_but, visible};

/// Text inside HTML; words between backticks are code.
pub fn html(text: &str) -> String {
    let escaped = visible(text)
        .replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;");
    let parts: Vec<&str> = escaped.split('`').collect();
    let mut shown = String::new();
    for (i, part) in parts.iter().enumerate() {
        let is_code = i % 2 == 1 && i + 1 < parts.len();
        shown += &match (is_code, i) {
            (true, _) => format!("<code>{part}</code>"),
            // The backtick that opened nothing.
            (false, i) if i % 2 == 1 => format!("`{part}"),
            (false, _) => (*part).to_owned(),
        };
    }
    shown
}

/// The paragraphs of a doc comment.
pub fn paragraphs(docs: &[String]) -> Vec<String> {
    let groups = docs.split(|line| line.trim().is_empty());
    let joined = groups.map(|lines| lines.join(" "));
    joined.filter(|text| !text.is_empty()).collect()
}

/// Text of a cell in a table of Markdown: one line, in which nothing but backticks is markup.
pub fn cell(text: &str) -> String {
    // A pipe ends the cell even inside code.
    inline_but(text, r"\*_<~[$").replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::{cell, html, paragraphs};

    #[test]
    fn markup_in_text_is_shown_as_it_is() {
        assert_eq!(cell("a_b * |c|\n `d_e`"), r"a\_b \* \|c\| `d_e`");
        assert_eq!(cell("`<b> and $x$"), r"\`\<b> and \$x\$");
        assert_eq!(html("\u{202e}<b>"), r"\u{202e}&lt;b&gt;");
        assert_eq!(
            html("a < b & `c > d`"),
            "a &lt; b &amp; <code>c &gt; d</code>"
        );
        assert_eq!(html("one ` alone"), "one ` alone");
    }

    #[test]
    fn empty_lines_part_paragraphs() {
        let docs = ["One", "two.", "", "Three."].map(str::to_owned);
        assert_eq!(paragraphs(&docs), ["One two.", "Three."]);
    }
}
