//! Formulas as MathML Core: elements that browsers draw without help.

use super::{Mark, Math};

/// The formula in display style.
pub(super) fn block(math: &Math) -> String {
    format!("<math display=\"block\">{}</math>", written(math))
}

pub(super) fn written(math: &Math) -> String {
    match math {
        Math::Row(parts) => format!("<mrow>{}</mrow>", all(parts)),
        Math::Letter('Σ') => operator('∑', ""),
        Math::Letter(letter @ ('∂' | '′')) => operator(*letter, ""),
        Math::Letter(letter) => format!("<mi>{letter}</mi>"),
        Math::Word(word) => format!("<mi mathvariant=\"normal\">{}</mi>", escaped(word)),
        Math::Number(value) => match super::digits(value) {
            Some(digits) => format!("<mn>{digits}</mn>"),
            None => format!(
                "<mfrac displaystyle=\"false\"><mn>{}</mn><mn>{}</mn></mfrac>",
                value.numer(),
                value.denom()
            ),
        },
        Math::Sign(',') => operator(',', " separator=\"true\""),
        Math::Sign(sign) => operator(*sign, " form=\"infix\""),
        Math::Minus => operator('−', " form=\"prefix\""),
        Math::Space => "<mspace width=\"0.17em\"/>".into(),
        Math::Marked(mark, inner) => marked(*mark, inner),
        Math::Script(base, below, above) => script(base, below.as_deref(), above.as_deref()),
        Math::Part(base, part) => format!("<msub>{}<mi>{part}</mi></msub>", written(base)),
        Math::Fraction(above, below) => {
            format!("<mfrac>{}{}</mfrac>", written(above), written(below))
        }
        Math::Partial(above, below) => format!(
            "<mfrac><mrow><mo>∂</mo>{}</mrow><mrow><mo>∂</mo>{}</mrow></mfrac>",
            written(above),
            written(below)
        ),
        Math::Root(inner) => format!("<msqrt>{}</msqrt>", written(inner)),
        Math::Group(inner) => format!("<mrow><mo>(</mo>{}<mo>)</mo></mrow>", written(inner)),
        Math::Matrix(columns, entries) => matrix(*columns, entries),
    }
}

fn all(parts: &[Math]) -> String {
    parts.iter().map(written).collect()
}

fn operator(sign: char, attributes: &str) -> String {
    format!("<mo{attributes}>{}</mo>", escaped(&sign.to_string()))
}

/// Not declared an accent: fonts without tables for mathematics would set it into the letter.
fn marked(mark: Mark, inner: &Math) -> String {
    let sign = match mark {
        Mark::Bar => '¯',
        Mark::Dot => '˙',
        Mark::Tilde => '~',
    };
    format!(
        "<mover>{}<mo stretchy=\"false\">{sign}</mo></mover>",
        written(inner)
    )
}

fn script(base: &Math, below: Option<&Math>, above: Option<&Math>) -> String {
    let base = written(base);
    match (below.map(written), above.map(written)) {
        (Some(below), Some(above)) => format!("<msubsup>{base}{below}{above}</msubsup>"),
        (Some(below), None) => format!("<msub>{base}{below}</msub>"),
        (None, Some(above)) => format!("<msup>{base}{above}</msup>"),
        (None, None) => base,
    }
}

fn matrix(columns: usize, entries: &[Math]) -> String {
    let cell = |entry: &Math| match entry {
        // Zeros step back, so that the pattern of the others is seen.
        Math::Number(value) if value.numer() == 0.into() => {
            "<mtd class=\"zero\"><mn>0</mn></mtd>".to_owned()
        }
        _ => format!("<mtd>{}</mtd>", written(entry)),
    };
    let rows = entries.chunks(columns.max(1));
    let rows = rows.map(|row| format!("<mtr>{}</mtr>", row.iter().map(cell).collect::<String>()));
    format!("<mtable>{}</mtable>", rows.collect::<String>())
}

/// Text inside an element.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}
