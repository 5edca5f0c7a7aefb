//! Interpolating splines: the slopes at the knots, and of quintic ones the second derivatives too, by which all derivatives below the degree are continuous.
//!
//! They solve one system of equations, tridiagonal in blocks ([`super::blocks`]).

use super::blocks::{Block, Equations, Numbers, kept, solve, solve_cyclic, zeros};
use crate::expr::Rational;
use num_traits::{One, Zero};

/// Degree and smoothness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Cubic polynomials with continuous second derivatives.
    Cubic,
    /// Quintic polynomials with continuous fourth derivatives.
    Quintic,
}

impl Kind {
    /// Degree of the polynomials.
    pub fn degree(self) -> u8 {
        match self {
            Self::Cubic => 3,
            Self::Quintic => 5,
        }
    }

    /// Up to which order derivatives are continuous at knots.
    pub fn smoothness(self) -> u8 {
        self.degree() - 1
    }

    /// Derivatives at each knot by which the polynomials are found.
    fn unknowns(self) -> usize {
        match self {
            Self::Cubic => 1,
            Self::Quintic => 2,
        }
    }
}

/// What is known at the ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ends {
    /// All derivatives are the same at both.
    Periodic,
    /// The second derivative is 0, of quintic curves the fourth too.
    Natural,
    /// The slopes; the second derivative of quintic curves is 0.
    Clamped(Rational, Rational),
}

/// A linear function of the unknowns at both ends of a piece.
struct Row {
    left: Numbers,
    right: Numbers,
    constant: Rational,
}

/// One piece: its length, and the values at its ends.
struct Piece<'a> {
    kind: Kind,
    length: Rational,
    from: &'a Rational,
    to: &'a Rational,
    /// Its polynomial where all unknowns are 0, and where one of them is 1: those of the left end, those of the right end.
    examples: Vec<Numbers>,
}

fn whole(value: i64) -> Rational {
    Rational::from(value)
}

/// The coefficients of each piece; `None` where the equations have no solution, and of values that differ at the ends of a periodic curve.
pub(super) fn pieces(
    kind: Kind,
    ends: &Ends,
    points: &[(Rational, Rational)],
) -> Option<Vec<Numbers>> {
    let mut pairs = points.windows(2);
    if points.len() < 3 || pairs.any(|pair| pair[0].0 >= pair[1].0) {
        return None;
    }
    let pieces: Vec<Piece<'_>> = points
        .windows(2)
        .map(|pair| Piece::new(kind, &pair[0], &pair[1]))
        .collect();
    let first = pieces.first()?;
    let knots = match ends {
        Ends::Periodic if first.from != pieces.last()?.to || pieces.len() < 3 => return None,
        Ends::Periodic => solve_cyclic(equations(kind, ends, &pieces)?)?,
        _ => solve(equations(kind, ends, &pieces)?)?,
    };
    let unknowns = |knot: usize| -> Numbers {
        let rows = &knots[knot % knots.len()];
        rows.iter().map(|row| row[0].clone()).collect()
    };
    let numbered = pieces.iter().enumerate();
    Some(
        numbered
            .map(|(i, piece)| piece.coefficients(&unknowns(i), &unknowns(i + 1)))
            .collect(),
    )
}

/// The equations of all knots; of a periodic curve the last knot is the first.
fn equations(kind: Kind, ends: &Ends, pieces: &[Piece<'_>]) -> Option<Vec<Equations>> {
    let count = pieces.len();
    let inner = |i: usize| joined(&pieces[(i + count - 1) % count], &pieces[i % count]);
    if *ends == Ends::Periodic {
        return Some((0..count).map(inner).collect());
    }
    let at_end = |slope: Option<&Rational>, piece: &Piece<'_>, last: bool| {
        let rows = match kind {
            Kind::Cubic => vec![piece.end_condition(slope, last)],
            Kind::Quintic => vec![
                piece.own(1, last, Rational::zero()),
                piece.end_condition(slope, last),
            ],
        };
        of_end(rows, last)
    };
    let (left, right) = match ends {
        Ends::Clamped(left, right) => (Some(left), Some(right)),
        _ => (None, None),
    };
    let first = at_end(left, pieces.first()?, false);
    let last = at_end(right, pieces.last()?, true);
    let inner = (1..count).map(inner);
    Some(std::iter::once(first).chain(inner).chain([last]).collect())
}

/// That derivatives are continuous between two pieces.
fn joined(before: &Piece<'_>, after: &Piece<'_>) -> Equations {
    let orders = match before.kind {
        Kind::Cubic => 2..=2,
        Kind::Quintic => 3..=4,
    };
    let rows: Vec<(Row, Row)> = orders
        .map(|order| {
            (
                before.derivative(order, true),
                after.derivative(order, false),
            )
        })
        .collect();
    let difference = |(a, b): (&Numbers, &Numbers)| a.iter().zip(b).map(|(a, b)| a - b).collect();
    let negated = |row: &Numbers| row.iter().map(|entry| -entry).collect();
    Equations {
        before: rows.iter().map(|(a, _)| a.left.clone()).collect(),
        own: rows
            .iter()
            .map(|(a, b)| difference((&a.right, &b.left)))
            .collect(),
        after: rows.iter().map(|(_, b)| negated(&b.right)).collect(),
        right: rows
            .iter()
            .map(|(a, b)| vec![&b.constant - &a.constant])
            .collect(),
    }
}

/// Conditions on the first or last piece.
fn of_end(rows: Vec<Row>, last: bool) -> Equations {
    let right = rows.iter().map(|row| vec![-&row.constant]).collect();
    let (left_end, right_end): (Block, Block) =
        rows.into_iter().map(|row| (row.left, row.right)).unzip();
    let nothing = zeros(left_end.len());
    match last {
        false => Equations {
            before: nothing,
            own: left_end,
            after: right_end,
            right,
        },
        true => Equations {
            before: left_end,
            own: right_end,
            after: nothing,
            right,
        },
    }
}

impl<'a> Piece<'a> {
    fn new(kind: Kind, from: &'a (Rational, Rational), to: &'a (Rational, Rational)) -> Self {
        let mut piece = Self {
            kind,
            length: &to.0 - &from.0,
            from: &from.1,
            to: &to.1,
            examples: vec![],
        };
        let size = kind.unknowns();
        let zero = vec![Rational::zero(); size];
        let unit = |place: usize| {
            let mut unit = zero.clone();
            unit[place] = Rational::one();
            unit
        };
        let left = (0..size).map(|i| (unit(i), zero.clone()));
        let right = (0..size).map(|i| (zero.clone(), unit(i)));
        let all = std::iter::once((zero.clone(), zero.clone()));
        let all = all.chain(left).chain(right);
        piece.examples = all
            .map(|(left, right)| piece.coefficients(&left, &right))
            .collect();
        piece
    }

    fn rise(&self) -> Rational {
        self.to - self.from
    }

    /// The unknown of this number at an end, less a value.
    fn own(&self, unknown: usize, last: bool, value: Rational) -> Row {
        let size = self.kind.unknowns();
        let mut unit = vec![Rational::zero(); size];
        unit[unknown] = Rational::one();
        let nothing = vec![Rational::zero(); size];
        let (left, right) = match last {
            false => (unit, nothing),
            true => (nothing, unit),
        };
        Row {
            left,
            right,
            constant: -value,
        }
    }

    /// The slope at an end, or that the highest even derivative is 0 there.
    fn end_condition(&self, slope: Option<&Rational>, last: bool) -> Row {
        match slope {
            Some(slope) => self.own(0, last, slope.clone()),
            None => self.derivative(usize::from(self.kind.smoothness()), last),
        }
    }

    /// A derivative at an end, as a function of the unknowns: coefficients are linear in them.
    fn derivative(&self, order: usize, last: bool) -> Row {
        let t = match last {
            false => Rational::zero(),
            true => self.length.clone(),
        };
        let mut values = self
            .examples
            .iter()
            .map(|coefficients| derivative_at(coefficients, order, &t));
        let constant = values.next().unwrap_or_else(Rational::zero);
        let mut slopes: Numbers = values.map(|value| value - &constant).collect();
        let right = slopes.split_off(self.kind.unknowns());
        Row {
            left: slopes,
            right,
            constant,
        }
    }

    /// The polynomial with these derivatives at the ends (C. Hermite).
    fn coefficients(&self, left: &Numbers, right: &Numbers) -> Numbers {
        let h = &self.length;
        let rise = self.rise();
        let (m, n) = (&left[0], &right[0]);
        let over = |value: Rational, power: u32| kept((0..power).fold(value, |value, _| value / h));
        match (left.get(1), right.get(1)) {
            (Some(a), Some(b)) => {
                let (slope, second) = (h, &(h * h));
                let sum = |parts: [i64; 5]| {
                    let [of_rise, of_n, of_m, of_a, of_b] = parts.map(whole);
                    let slopes = (of_n * n + of_m * m) * slope;
                    let seconds = (of_a * a + of_b * b) * second;
                    (of_rise * &rise + slopes + seconds) / whole(2)
                };
                vec![
                    self.from.clone(),
                    m.clone(),
                    a / &whole(2),
                    over(sum([20, -8, -12, -3, 1]), 3),
                    over(sum([-30, 14, 16, 3, -2]), 4),
                    over(sum([12, -6, -6, -1, 1]), 5),
                ]
            }
            _ => {
                let mean = &rise / h;
                vec![
                    self.from.clone(),
                    m.clone(),
                    over(whole(3) * &mean - whole(2) * m - n, 1),
                    over(m + n - whole(2) * mean, 2),
                ]
            }
        }
    }
}

/// The derivative of a polynomial.
pub(super) fn derivative_at(coefficients: &[Rational], order: usize, t: &Rational) -> Rational {
    (order..coefficients.len())
        .rev()
        .fold(Rational::zero(), |sum, power| {
            sum * t + &coefficients[power] * &falling(power, order)
        })
}

/// `power (power − 1) …`, of `order` factors.
pub(super) fn falling(power: usize, order: usize) -> Rational {
    let factors = (0..order).map(|i| (power - i) as i64);
    whole(factors.product())
}
