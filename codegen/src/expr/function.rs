//! Functions of expressions, folded where their value is known, and the relations between them.

use super::{Atom, Expr, Function, Monomial, Rational, hyperbolic, intern};
use num_bigint::BigInt;
use num_traits::{One, ToPrimitive, Zero};

/// Largest integer multiple of an angle that is expanded by the addition theorems.
const LARGEST_MULTIPLE: i64 = 16;

pub(super) fn apply(function: Function, arguments: Vec<Expr>) -> Expr {
    Expr::atom(Atom::Apply(intern::application(function, arguments)))
}

impl Expr {
    /// The circle constant.
    pub fn pi() -> Self {
        apply(Function::Pi, vec![])
    }

    /// Cosine; sums and integer multiples of angles are expanded.
    pub fn cos(&self) -> Self {
        self.cos_sin().0
    }

    /// Sine; sums and integer multiples of angles are expanded.
    pub fn sin(&self) -> Self {
        self.cos_sin().1
    }

    /// Cosine and sine by the addition theorems, so that equal angles written differently are equal.
    fn cos_sin(&self) -> (Self, Self) {
        let mut result = (Self::one(), Self::zero());
        for (monomial, coefficient) in self.terms() {
            let (cos, sin) = cos_sin_of_term(monomial, coefficient);
            result = (
                &(&result.0 * &cos) - &(&result.1 * &sin),
                &(&result.1 * &cos) + &(&result.0 * &sin),
            );
        }
        result
    }

    /// Exponential function.
    pub fn exp(&self) -> Self {
        match self.is_zero() {
            true => Self::one(),
            false => apply(Function::Exp, vec![self.clone()]),
        }
    }

    /// Natural logarithm.
    pub fn ln(&self) -> Self {
        match self.applied_alone() {
            Some((Function::Cosh, [x])) => x.ln_cosh(),
            _ if self.is_one() => Self::zero(),
            _ => apply(Function::Ln, vec![self.clone()]),
        }
    }

    /// Function and arguments, if this is nothing but a function.
    fn applied_alone(&self) -> Option<(Function, &[Self])> {
        let (monomial, coefficient) = self.single_term()?;
        match monomial.main() {
            [(Atom::Apply(application), 1)]
                if coefficient.is_one() && monomial.units().is_empty() =>
            {
                Some((application.function, &application.arguments))
            }
            _ => None,
        }
    }

    /// Angle of the point `(x, self)`.
    pub fn atan2(&self, x: &Self) -> Self {
        match (self.is_zero(), x.as_rational()) {
            (true, Some(value)) if value.is_positive() => Self::zero(),
            _ => apply(Function::Atan2, vec![self.clone(), x.clone()]),
        }
    }

    /// Square root; squares of rationals are taken.
    pub fn sqrt(&self) -> Self {
        match self.as_rational().and_then(|value| value.square_root()) {
            Some(root) => Self::rational(root),
            None => apply(Function::Sqrt, vec![self.clone()]),
        }
    }

    /// Reciprocal; `None` for zero. Single terms are inverted factor by factor.
    pub fn recip(&self) -> Option<Self> {
        let (leading, coefficient) = self.leading()?;
        let scale = Self::rational(coefficient.recip());
        if self.terms().len() > 1 {
            let monic = self.scaled(&coefficient.recip(), &Monomial::one());
            return Some(&scale * &apply(Function::Recip, vec![monic]));
        }
        let (main, units) = leading.split();
        let units = Self::term(Rational::one(), units.recip()?);
        let inverse = |(atom, power): &(Atom, u32)| recip_of_atom(atom).pow(*power);
        let product = main.main().iter().map(inverse);
        Some(product.fold(&scale * &units, |product, factor| &product * &factor))
    }

    /// The same value as one factor, where it is a sum; a number that all terms share stands before it.
    pub fn grouped(&self) -> Self {
        let Some((_, first)) = self.leading().filter(|_| self.terms().len() > 1) else {
            return self.clone();
        };
        let shared = self.terms().all(|(_, c)| c.abs() == first.abs());
        let number = if shared {
            first.clone()
        } else {
            Rational::one()
        };
        let sum = self.scaled(&number.recip(), &Monomial::one());
        apply(Function::Group, vec![sum]).scaled(&number, &Monomial::one())
    }

    /// Stumpff function `c_order`.
    pub fn stumpff(&self, order: u8) -> Self {
        match self.is_zero() {
            true => Self::rational(Rational::new(BigInt::one(), factorial(order.into()))),
            false => apply(Function::Stumpff(order), vec![self.clone()]),
        }
    }

    /// `derivative`-th derivative of the coefficient of `ad²` in `dexp⁻¹`, in `s = θ²`.
    pub fn dexp_inverse(&self, derivative: u8) -> Self {
        match self.is_zero() {
            true => Self::rational(dexp_inverse_at_zero(derivative)),
            false => apply(Function::DexpInverse(derivative), vec![self.clone()]),
        }
    }

    /// The function with new arguments, folded.
    pub fn applied(function: Function, arguments: &[Self]) -> Self {
        match (function, arguments) {
            (Function::Cos, [x]) => x.cos(),
            (Function::Sin, [x]) => x.sin(),
            (Function::Exp, [x]) => x.exp(),
            (Function::Sinh, [x]) => x.sinh(),
            (Function::Cosh, [x]) => x.cosh(),
            (Function::Sech, [x]) => x.sech(),
            (Function::Tanh, [x]) => x.tanh(),
            (Function::LnCosh, [x]) => x.ln_cosh(),
            (Function::Ln, [x]) => x.ln(),
            (Function::Sqrt, [x]) => x.sqrt(),
            (Function::Atan2, [y, x]) => y.atan2(x),
            (Function::Stumpff(order), [x]) => x.stumpff(order),
            (Function::DexpInverse(order), [x]) => x.dexp_inverse(order),
            (Function::Group, [x]) => x.grouped(),
            (Function::Curve(curve, order), [x]) => curve.at(x, order),
            (Function::Recip, [x]) if !x.is_zero() => x.recip().unwrap_or_default(),
            _ => apply(function, arguments.to_vec()),
        }
    }

    /// The same value with the coordinates of a point at a distance of 1 from the origin for the cosine and the sine of its angle: of an arcsine of s, `√(1 − s²)` and s. It is defined in more places: the
    /// root may be gone.
    pub fn without_arcsines(&self) -> Self {
        let known = |atom: Atom| match &atom {
            Atom::Apply(application) => {
                let [angle] = application.arguments.as_slice() else {
                    return None;
                };
                let (cos, sin) = cos_sin_of_point(angle)?;
                match application.function {
                    Function::Cos => Some((atom, cos)),
                    Function::Sin => Some((atom, sin)),
                    _ => None,
                }
            }
            Atom::Symbol(_) => None,
        };
        let known: Vec<(Atom, Self)> = self.atoms().into_iter().filter_map(known).collect();
        match known.is_empty() {
            true => self.clone(),
            false => self.replace_atoms(&known.into_iter().collect()),
        }
    }

    /// The polynomials that vanish because of what the functions in `self` are: `c² + s² − 1`, `r² − u`, `u/u − 1`.
    pub fn atom_relations(&self) -> Vec<Self> {
        self.atoms().iter().flat_map(relations_of_atom).collect()
    }
}

fn relations_of_atom(atom: &Atom) -> Vec<Expr> {
    let Atom::Apply(application) = atom else {
        return vec![];
    };
    let itself = Expr::atom(atom.clone());
    match (application.function, application.arguments.as_slice()) {
        (Function::Cos | Function::Sin, [x]) => {
            let (cos, sin) = (
                apply(Function::Cos, vec![x.clone()]),
                apply(Function::Sin, vec![x.clone()]),
            );
            vec![&(&cos.square() + &sin.square()) - &Expr::one()]
        }
        (Function::Exp, [x]) => vec![&(&itself * &(-x).exp()) - &Expr::one()],
        (Function::Sinh | Function::Cosh | Function::Sech | Function::Tanh, [x]) => {
            hyperbolic::relations(x)
        }
        (Function::Sqrt, [x]) => vec![&itself.square() - x],
        // Nothing times 0 is 1: the reciprocal of 0 would make every expression 0.
        (Function::Recip, [x]) if !x.is_zero() => vec![&(&itself * x) - &Expr::one()],
        _ => vec![],
    }
}

fn recip_of_atom(atom: &Atom) -> Expr {
    let known = match atom {
        Atom::Apply(application) => (application.function, application.arguments.as_slice()),
        Atom::Symbol(_) => (Function::Recip, [].as_slice()),
    };
    match known {
        (Function::Recip, [x]) => x.clone(),
        (Function::Exp, [x]) => (-x).exp(),
        (Function::Cosh, [x]) => x.sech(),
        (Function::Sech, [x]) => x.cosh(),
        _ => apply(Function::Recip, vec![Expr::atom(atom.clone())]),
    }
}

/// Cosine and sine of one term: known at some parts of a turn, expanded at integer multiples.
fn cos_sin_of_term(monomial: &Monomial, coefficient: &Rational) -> (Expr, Expr) {
    if let Some(exact) = exact_turns(monomial, coefficient) {
        return exact;
    }
    let negative = coefficient.is_negative();
    let size = coefficient.abs();
    let multiple = size
        .to_integer()
        .to_i64()
        .filter(|n| size.is_integer() && (2..=LARGEST_MULTIPLE).contains(n));
    let base = match multiple {
        Some(_) => Rational::one(),
        None => size,
    };
    let angle = Expr::term(base, monomial.clone());
    let cos = apply(Function::Cos, vec![angle.clone()]);
    let sin = apply(Function::Sin, vec![angle]);
    let (mut c, mut s) = (cos.clone(), sin.clone());
    for _ in 1..multiple.unwrap_or(1) {
        (c, s) = (&(&c * &cos) - &(&s * &sin), &(&s * &cos) + &(&c * &sin));
    }
    match negative {
        true => (c, -s),
        false => (c, s),
    }
}

/// x and y of a point at a distance of 1 from the origin, by its angle.
fn cos_sin_of_point(angle: &Expr) -> Option<(Expr, Expr)> {
    let (Function::Atan2, [y, x]) = angle.applied_alone()? else {
        return None;
    };
    let square = |e: &Expr| match e.applied_alone() {
        Some((Function::Sqrt, [u])) => u.clone(),
        _ => e.square(),
    };
    (&square(x) + &square(y))
        .is_one()
        .then(|| (x.clone(), y.clone()))
}

/// At multiples of a sixth and of a quarter of π, whose cosines and sines are halves of roots.
fn exact_turns(monomial: &Monomial, coefficient: &Rational) -> Option<(Expr, Expr)> {
    let is_pi = Expr::term(Rational::one(), monomial.clone()) == Expr::pi();
    let twelfths = coefficient * Rational::from_integer(12.into());
    if !is_pi || !twelfths.is_integer() {
        return None;
    }
    let turn = BigInt::from(24);
    let twelfths = (((twelfths.to_integer() % &turn) + &turn) % &turn).to_i64()?;
    let half_root = |n: i64| Expr::integer(n).sqrt().scaled(&half(), &Monomial::one());
    let (c, s) = match twelfths % 6 {
        0 => (Expr::one(), Expr::zero()),
        2 => (half_root(3), half_root(1)),
        3 => (half_root(2), half_root(2)),
        4 => (half_root(1), half_root(3)),
        _ => return None,
    };
    Some(match twelfths / 6 {
        0 => (c, s),
        1 => (-s, c),
        2 => (-c, -s),
        _ => (s, -c),
    })
}

fn half() -> Rational {
    Rational::new(BigInt::one(), BigInt::from(2))
}

pub(super) fn factorial(n: u32) -> BigInt {
    (1..=n).map(BigInt::from).product()
}

/// `n! |B_{2n+2}| / (2n+2)!`, from `G(s) = Σ_{j ≥ 1} |B_{2j}| s^{j−1} / (2j)!`.
fn dexp_inverse_at_zero(derivative: u8) -> Rational {
    let n = u32::from(derivative);
    let bernoulli = bernoulli(2 * n as usize + 2).abs();
    bernoulli * Rational::new(factorial(n), factorial(2 * n + 2))
}

/// Bernoulli number `B_n`, by the Akiyama–Tanigawa table.
fn bernoulli(n: usize) -> Rational {
    let mut row: Vec<Rational> = vec![Rational::zero(); n + 1];
    for m in 0..=n {
        row[m] = Rational::new(BigInt::one(), BigInt::from(m + 1));
        for j in (1..=m).rev() {
            let difference = &row[j - 1] - &row[j];
            row[j - 1] = difference * Rational::from_integer(BigInt::from(j));
        }
    }
    row.swap_remove(0)
}
