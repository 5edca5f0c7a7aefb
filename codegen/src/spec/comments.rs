//! Comments of a spec, where its text is quoted without them.

/// The text with blanks in place of comments: every byte keeps its place, every line its number.
pub(crate) fn without_comments(source: &str) -> String {
    let mut bare = String::with_capacity(source.len());
    let (mut depth, mut in_line) = (0_usize, false);
    let mut characters = source.char_indices().peekable();
    while let Some((at, c)) = characters.next() {
        let rest = &source[at..];
        let opens = !in_line && rest.starts_with("/*");
        let closes = depth > 0 && rest.starts_with("*/");
        in_line = c != '\n' && (in_line || (depth == 0 && rest.starts_with("//")));
        depth += usize::from(opens);
        match in_line || depth > 0 {
            true if c != '\n' => bare.extend(std::iter::repeat_n(' ', c.len_utf8())),
            _ => bare.push(c),
        }
        if opens || closes {
            bare.extend(characters.next().map(|_| ' '));
        }
        depth -= usize::from(closes);
    }
    bare
}

/// The text on one line, without comments.
pub(crate) fn one_line(text: &str) -> String {
    let bare = without_comments(text);
    let words: Vec<&str> = bare.split_whitespace().collect();
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use super::one_line;

    #[test]
    fn what_is_quoted_has_no_comments() {
        assert_eq!(one_line("a > /* ` */ b // `\n + c"), "a > b + c");
    }
}
