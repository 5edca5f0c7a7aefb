//! Formulas as LaTeX, in macros that the Markdown viewers of code hosts allow (`\operatorname` is not among them).

use super::letters::latex_name;
use super::{Mark, Math};

pub(super) fn written(math: &Math) -> String {
    match math {
        Math::Row(parts) => parts.iter().map(written).collect(),
        Math::Letter(letter) => self::letter(*letter),
        Math::Word(word) => format!(r"\mathrm{{{}}}", word.replace('_', r"\_")),
        Math::Number(value) => match super::digits(value) {
            Some(digits) => digits,
            None => format!(r"\tfrac{{{}}}{{{}}}", value.numer(), value.denom()),
        },
        Math::Sign(sign) => self::sign(*sign),
        Math::Minus => "-".into(),
        Math::Space => r"\,".into(),
        Math::Marked(mark, inner) => format!(r"{}{{{}}}", accent(*mark), written(inner)),
        Math::Script(base, below, above) => {
            let script = |sign: char, part: &Option<Box<Math>>| {
                part.as_ref()
                    .map(|part| format!("{sign}{{{}}}", written(part)))
                    .unwrap_or_default()
            };
            format!(
                "{{{}}}{}{}",
                written(base),
                script('_', below),
                script('^', above)
            )
        }
        Math::Part(base, part) => format!("{{{}}}_{{{part}}}", written(base)),
        Math::Fraction(above, below) => fraction(&written(above), &written(below)),
        Math::Partial(above, below) => fraction(
            &format!(r"\partial {}", written(above)),
            &format!(r"\partial {}", written(below)),
        ),
        Math::Root(inner) => format!(r"\sqrt{{{}}}", written(inner)),
        Math::Group(inner) => format!(r"\left({}\right)", written(inner)),
        Math::Matrix(columns, entries) => matrix(*columns, entries),
    }
}

fn fraction(above: &str, below: &str) -> String {
    format!(r"\frac{{{above}}}{{{below}}}")
}

/// A macro ends at the brace or space after it, so that no letter that follows becomes part of its name.
fn letter(letter: char) -> String {
    match (latex_name(letter), letter) {
        (Some(name), _) => format!("{name} "),
        (None, '′') => r"\prime ".into(),
        (None, '∂') => r"\partial ".into(),
        (None, 'Σ') => r"\sum ".into(),
        (None, other) => other.to_string(),
    }
}

fn sign(sign: char) -> String {
    match sign {
        '−' => " - ".into(),
        ',' => ", ".into(),
        '∈' => r" \in ".into(),
        '≠' => r" \neq ".into(),
        other => format!(" {other} "),
    }
}

fn accent(mark: Mark) -> &'static str {
    match mark {
        Mark::Bar => r"\bar",
        Mark::Dot => r"\dot",
        Mark::Tilde => r"\tilde",
    }
}

fn matrix(columns: usize, entries: &[Math]) -> String {
    let rows = entries.chunks(columns.max(1)).map(|row| {
        let cells: Vec<String> = row.iter().map(written).collect();
        cells.join(" & ")
    });
    let rows: Vec<String> = rows.collect();
    // Ten columns are the most that a matrix has by default.
    format!(
        "\\begin{{bmatrix}}\n{}\n\\end{{bmatrix}}",
        rows.join(" \\\\\n")
    )
}
