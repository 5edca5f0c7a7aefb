//! Formulas as lines of Unicode: `Q₁₁ v₁ − ½ (a + b)`, matrices in tall brackets.

use super::{Equation, Mark, Math};
use crate::emit::report::layout;
use crate::expr::Rational;

/// `left = right`, the right side aligned over several lines where it is a matrix.
pub(super) fn equation(equation: &Equation) -> String {
    let lines = match &equation.right {
        Math::Matrix(columns, entries) => {
            let entries: Vec<String> = entries.iter().map(written).collect();
            layout::matrix(&entries, *columns)
        }
        other => vec![written(other)],
    };
    layout::equation(&written(&equation.left), &lines)
}

pub(super) fn written(math: &Math) -> String {
    match math {
        Math::Row(parts) => row(parts),
        Math::Letter(letter) => letter.to_string(),
        Math::Word(word) => word.clone(),
        Math::Number(value) => number(value),
        Math::Sign(',') => ", ".into(),
        Math::Sign(sign) => format!(" {sign} "),
        Math::Minus => "−".into(),
        Math::Space => " ".into(),
        Math::Marked(mark, inner) => written(inner) + marking(*mark),
        Math::Script(base, below, above) => {
            let below = below.as_ref().map(|below| below_line(&written(below)));
            let above = above.as_ref().map(|above| above_line(&written(above)));
            written(base) + &below.unwrap_or_default() + &above.unwrap_or_default()
        }
        Math::Part(base, part) => format!("{}.{part}", written(base)),
        Math::Fraction(above, below) => format!("{} / {}", tight(above), atom(below)),
        Math::Partial(above, below) => format!("∂{}/∂{}", written(above), written(below)),
        Math::Root(inner) => format!("√({})", written(inner)),
        Math::Group(inner) => format!("({})", written(inner)),
        Math::Matrix(columns, entries) => {
            let entries: Vec<String> = entries.iter().map(written).collect();
            layout::matrix(&entries, *columns).join("\n")
        }
    }
}

/// A quotient among factors needs parentheses on a line.
fn row(parts: &[Math]) -> String {
    let has_factors = parts.contains(&Math::Space);
    let part = |part: &Math| match part {
        Math::Fraction(..) if has_factors => format!("({})", written(part)),
        _ => written(part),
    };
    parts.iter().map(part).collect()
}

fn tight(math: &Math) -> String {
    match math {
        Math::Row(parts) if parts.iter().any(|part| matches!(part, Math::Sign(_))) => {
            format!("({})", written(math))
        }
        _ => written(math),
    }
}

fn atom(math: &Math) -> String {
    let is_operation = |part: &Math| matches!(part, Math::Sign(_) | Math::Minus | Math::Space);
    match math {
        Math::Fraction(..) => format!("({})", written(math)),
        Math::Row(parts) if parts.iter().any(is_operation) => format!("({})", written(math)),
        _ => written(math),
    }
}

fn marking(mark: Mark) -> &'static str {
    match mark {
        Mark::Bar => "\u{304}",
        Mark::Dot => "\u{307}",
        Mark::Tilde => "~",
    }
}

fn below_line(text: &str) -> String {
    let lowered = |c: char| match c {
        '0'..='9' => char::from_u32('₀' as u32 + c.to_digit(10)?),
        'k' => Some('ₖ'),
        _ => None,
    };
    let all: Option<String> = text.chars().map(lowered).collect();
    all.unwrap_or_else(|| format!("_{text}"))
}

fn above_line(text: &str) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| match c {
        '0'..='9' => digits.get(c.to_digit(10)? as usize).copied(),
        '−' => Some('⁻'),
        'T' => Some('ᵀ'),
        '′' => Some('′'),
        _ => None,
    };
    let all: Option<String> = text.chars().map(raised).collect();
    all.unwrap_or_else(|| format!("^{text}"))
}

fn number(value: &Rational) -> String {
    let known = [
        ((1, 2), "½"),
        ((1, 3), "⅓"),
        ((2, 3), "⅔"),
        ((1, 4), "¼"),
        ((3, 4), "¾"),
        ((1, 6), "⅙"),
        ((1, 8), "⅛"),
    ];
    let is = |(above, below): (i32, i32)| *value == Rational::new(above.into(), below.into());
    match known.iter().find(|(fraction, _)| is(*fraction)) {
        Some((_, text)) => (*text).to_owned(),
        None => super::digits(value).unwrap_or_else(|| format!("({value})")),
    }
}
