//! Long lines of C, broken where a reader would.

/// Longest line that is not broken.
const WIDTH: usize = 110;

/// The text with long lines broken, what follows one deeper: comments at spaces, code after commas and before operators. Lines of the preprocessor
/// stay as they are.
pub fn broken(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    let mut in_comment = false;
    for line in text.lines().map(str::trim_end) {
        let bare = line.trim_start();
        in_comment |= bare.starts_with("/*");
        match line.chars().count() <= WIDTH || bare.starts_with('#') {
            true => written += line,
            false => written += &broken_line(line, in_comment),
        }
        written.push('\n');
        in_comment &= !bare.ends_with("*/");
    }
    written
}

fn broken_line(line: &str, is_comment: bool) -> String {
    let bare = line.trim_start();
    let indent = line.len() - bare.len();
    let mut written = " ".repeat(indent);
    let mut column = indent;
    for (i, piece) in pieces(bare, is_comment).into_iter().enumerate() {
        let length = piece.chars().count();
        if i > 0 && column + 1 + length > WIDTH {
            let indent = indent + 4;
            written += &format!("\n{}", " ".repeat(indent));
            column = indent;
        } else if i > 0 {
            written.push(' ');
            column += 1;
        }
        written += &piece;
        column += length;
    }
    written
}

/// What must stay together.
fn pieces(line: &str, is_comment: bool) -> Vec<String> {
    let mut pieces: Vec<String> = vec![];
    let mut joins = true;
    for word in line.split(' ') {
        let is_operator = matches!(word, "+" | "-" | "*" | "/");
        match pieces.last_mut() {
            Some(piece) if joins && !is_operator && !is_comment => {
                piece.push(' ');
                *piece += word;
            }
            _ => pieces.push(word.to_owned()),
        }
        joins = !word.ends_with(',');
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::{WIDTH, broken};

    #[test]
    fn code_is_broken_after_commas_and_before_operators() {
        let sum = ["first_value * second_value"; 6].join(" + ");
        let list = ["some_long_value"; 9].join(", ");
        let comment = ["a few words"; 12].join(" ");
        let short = "    const double x = a + b;";
        let define = format!("#define LONG {sum}");
        let text = format!(
            "    y = {sum};\n    f({list});\n{short}\n{define}\n/* {comment}\n   {comment} */\n"
        );
        let found = broken(&text);
        // Nothing is lost.
        let words = |text: &str| {
            text.split_whitespace()
                .map(str::to_owned)
                .collect::<Vec<_>>()
        };
        assert_eq!(words(&found), words(&text));
        let lines: Vec<&str> = found.lines().collect();
        assert_eq!(lines.len(), 10, "{found}");
        assert!(lines[1].starts_with("        +") || lines[1].starts_with("        *"));
        assert!(lines[2].ends_with(','), "{found}");
        assert_eq!(lines[4..6], [short, define.as_str()]);
        let mut long = lines.iter().filter(|line| line.chars().count() > WIDTH);
        assert_eq!(long.next(), Some(&define.as_str()));
        assert_eq!(long.next(), None);
    }
}
