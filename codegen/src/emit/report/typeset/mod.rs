//! Formulas as they are set: one tree, written as text for a terminal, as LaTeX for Markdown and as MathML for HTML.

mod compose;
mod latex;
mod letters;
mod mathml;
mod text;

#[cfg(test)]
mod tests;

pub use compose::composed;
pub use letters::named;

use crate::expr::Rational;
use num_traits::One;

/// A formula on paper: what stands beside, above and below what. Parentheses that only a line of text needs are the text writer's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Math {
    /// Side by side.
    Row(Vec<Math>),
    /// A variable of one letter.
    Letter(char),
    /// A name of several letters, upright.
    Word(String),
    /// A rational number, not negative.
    Number(Rational),
    /// A sign between two operands: `+`, `−`, `=`.
    Sign(char),
    /// The sign of what follows.
    Minus,
    /// Between factors.
    Space,
    /// A letter with a mark above.
    Marked(Mark, Box<Math>),
    /// What stands below and above at the right.
    Script(Box<Math>, Option<Box<Math>>, Option<Box<Math>>),
    /// A stored scalar named after a part of its factor: `q.w`.
    Part(Box<Math>, char),
    /// Numerator and denominator.
    Fraction(Box<Math>, Box<Math>),
    /// A partial derivative: `∂S/∂ϕ₁`.
    Partial(Box<Math>, Box<Math>),
    /// Square root.
    Root(Box<Math>),
    /// In parentheses.
    Group(Box<Math>),
    /// Number of columns, and entries row by row.
    Matrix(usize, Vec<Math>),
}

/// Denominators up to this are written as such, others as decimals where these are short.
const LARGEST_DENOMINATOR: u32 = 12;

/// How a number is written in digits alone: an integer, or a decimal that says more than its fraction.
fn digits(value: &Rational) -> Option<String> {
    match value.denom() {
        one if one.is_one() => Some(value.to_string()),
        below if below <= LARGEST_DENOMINATOR.into() => None,
        _ => value.decimal(),
    }
}

/// A mark above a letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Of the allowed velocities.
    Bar,
    /// Of a rate.
    Dot,
    /// Of a cross-product matrix, (5).
    Tilde,
}

impl Math {
    /// A whole number.
    pub fn integer(value: usize) -> Self {
        Self::Number(Rational::from_integer(value.into()))
    }

    /// With the mark above.
    #[must_use]
    pub fn marked(self, mark: Mark) -> Self {
        Self::Marked(mark, Box::new(self))
    }

    /// With an index below.
    #[must_use]
    pub fn with_index(self, below: Self) -> Self {
        match self {
            Self::Script(base, None, above) => Self::Script(base, Some(Box::new(below)), above),
            other => Self::Script(Box::new(other), Some(Box::new(below)), None),
        }
    }

    /// With an exponent or the like.
    #[must_use]
    pub fn raised_to(self, above: Self) -> Self {
        match self {
            Self::Script(base, below, None) => Self::Script(base, below, Some(Box::new(above))),
            other => Self::Script(Box::new(other), None, Some(Box::new(above))),
        }
    }

    /// With an exponent −1.
    #[must_use]
    pub fn inverse(self) -> Self {
        self.raised_to(Self::Row(vec![Self::Minus, Self::integer(1)]))
    }

    /// Transposed.
    #[must_use]
    pub fn transposed(self) -> Self {
        self.raised_to(Self::Letter('T'))
    }

    /// In parentheses.
    #[must_use]
    pub fn grouped(self) -> Self {
        Self::Group(Box::new(self))
    }

    /// The opposite.
    #[must_use]
    pub fn negative(self) -> Self {
        Self::Row(vec![Self::Minus, self])
    }

    /// The factors with space between them.
    pub fn product(factors: impl IntoIterator<Item = Self>) -> Self {
        let mut row = vec![];
        for factor in factors {
            if !row.is_empty() {
                row.push(Self::Space);
            }
            row.push(factor);
        }
        match row.len() {
            1 => row.swap_remove(0),
            _ => Self::Row(row),
        }
    }

    /// `self = right`.
    #[must_use]
    pub fn equals(self, right: Self) -> Self {
        Self::Row(vec![self, Self::Sign('='), right])
    }

    /// Number of letters, numbers and signs.
    pub fn size(&self) -> usize {
        match self {
            Self::Row(parts) | Self::Matrix(_, parts) => parts.iter().map(Self::size).sum(),
            Self::Marked(_, inner)
            | Self::Part(inner, _)
            | Self::Root(inner)
            | Self::Group(inner) => inner.size(),
            Self::Fraction(above, below) | Self::Partial(above, below) => {
                above.size() + below.size()
            }
            Self::Script(base, below, above) => {
                let scripts = [below, above].into_iter().flatten();
                base.size() + scripts.map(|part| part.size()).sum::<usize>()
            }
            Self::Space => 0,
            Self::Letter(_) | Self::Word(_) | Self::Number(_) | Self::Sign(_) | Self::Minus => 1,
        }
    }

    /// On one line, or a matrix over several.
    pub fn text(&self) -> String {
        text::written(self)
    }

    /// LaTeX in the macros that Markdown viewers allow, without delimiters.
    pub fn latex(&self) -> String {
        latex::written(self)
    }

    /// MathML Core, without the enclosing `math`.
    pub fn mathml(&self) -> String {
        mathml::written(self)
    }
}

/// An equation on lines of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Equation {
    /// What it gives a value; may itself be an equation: `J22 = −p~`.
    pub left: Math,
    /// The value; a matrix is set over several lines.
    pub right: Math,
}

impl Equation {
    /// Aligned over several lines.
    pub fn text(&self) -> String {
        text::equation(self)
    }

    /// For a block of LaTeX.
    pub fn latex(&self) -> String {
        format!("{} = {}", self.left.latex(), self.right.latex())
    }

    /// A complete `math` element in display style.
    pub fn mathml(&self) -> String {
        mathml::block(&self.left.clone().equals(self.right.clone()))
    }
}
