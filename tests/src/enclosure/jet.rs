//! Truncated polynomials in ϕ over balls: values with their first and second derivatives at ϕ = 0.

use super::ball::Ball;
use super::curve;
use hamel_codegen::expr::Function;

/// A value with as many orders of derivatives as are known; what does not vary has none.
#[derive(Clone, Debug)]
pub struct Jet {
    /// The value.
    pub value: Ball,
    /// First derivatives; empty where it does not vary.
    pub first: Vec<Ball>,
    /// Second derivatives, row by row of the lower triangle; empty where they are not asked for.
    pub second: Vec<Ball>,
}

/// Derivatives of a function of one argument: value, first, second.
type Derivatives = [Ball; 3];

fn half() -> Ball {
    Ball::exact(0.5)
}

impl Jet {
    /// What does not vary.
    pub fn constant(value: Ball) -> Self {
        Self {
            value,
            first: vec![],
            second: vec![],
        }
    }

    /// The variable number `i` of `count`, with derivatives up to `order`.
    pub fn variable(value: Ball, i: usize, count: usize, order: usize) -> Self {
        let entry = |k: usize| if k == i { Ball::one() } else { Ball::zero() };
        let seconds = if order > 1 {
            count * (count + 1) / 2
        } else {
            0
        };
        Self {
            value,
            first: (0..count).map(entry).collect(),
            second: vec![Ball::zero(); seconds],
        }
    }

    /// A value and its first derivatives.
    pub fn linear(value: Ball, first: Vec<Ball>) -> Self {
        Self {
            value,
            first,
            second: vec![],
        }
    }

    fn varies(&self) -> bool {
        !self.first.is_empty()
    }

    /// The derivative by variable `k`, to one order less.
    pub fn partial(&self, k: usize) -> Self {
        if !self.varies() {
            return Self::constant(Ball::zero());
        }
        let first = match self.second.is_empty() {
            true => vec![],
            false => (0..self.first.len())
                .map(|l| self.second[place(k, l)].clone())
                .collect(),
        };
        Self::linear(self.first[k].clone(), first)
    }

    /// The derivative by variable `k` alone; 0 where nothing varies.
    pub fn slope(&self, k: usize) -> Ball {
        self.first.get(k).cloned().unwrap_or_else(Ball::zero)
    }

    /// Without second derivatives.
    pub fn to_first_order(&self) -> Self {
        Self::linear(self.value.clone(), self.first.clone())
    }

    fn combined(&self, other: &Self, value: Ball, of: impl Fn(&Ball, &Ball) -> Ball) -> Self {
        let zero = Ball::zero();
        let at = |list: &[Ball], i: usize| list.get(i).cloned().unwrap_or_else(|| zero.clone());
        let first = (0..self.first.len().max(other.first.len()))
            .map(|i| of(&at(&self.first, i), &at(&other.first, i)));
        let seconds = match (self.varies(), other.varies()) {
            (true, true) => self.second.len().min(other.second.len()),
            (true, false) => self.second.len(),
            _ => other.second.len(),
        };
        let second = (0..seconds).map(|i| of(&at(&self.second, i), &at(&other.second, i)));
        Self {
            value,
            first: first.collect(),
            second: second.collect(),
        }
    }

    /// Sum.
    pub fn plus(&self, other: &Self) -> Self {
        self.combined(other, self.value.plus(&other.value), Ball::plus)
    }

    /// Difference.
    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.negative())
    }

    /// Opposite.
    pub fn negative(&self) -> Self {
        let all = |list: &[Ball]| list.iter().map(Ball::negative).collect();
        Self {
            value: self.value.negative(),
            first: all(&self.first),
            second: all(&self.second),
        }
    }

    fn scaled(&self, factor: &Ball) -> Self {
        let all = |list: &[Ball]| list.iter().map(|x| x.times(factor)).collect();
        Self {
            value: self.value.times(factor),
            first: all(&self.first),
            second: all(&self.second),
        }
    }

    /// Product.
    pub fn times(&self, other: &Self) -> Self {
        if !self.varies() {
            return other.scaled(&self.value);
        }
        if !other.varies() {
            return self.scaled(&other.value);
        }
        let (a, b) = (&self.value, &other.value);
        let mut product = self.combined(other, a.times(b), |x, y| x.times(b).plus(&y.times(a)));
        let count = product.first.len();
        for (i, j) in pairs(count).take(product.second.len()) {
            let cross = self.first[i]
                .times(&other.first[j])
                .plus(&self.first[j].times(&other.first[i]));
            let n = place(i, j);
            product.second[n] = product.second[n].plus(&cross);
        }
        product
    }

    /// Quotient.
    pub fn over(&self, other: &Self) -> Self {
        self.times(&other.reciprocal())
    }

    /// `1 / self`.
    pub fn reciprocal(&self) -> Self {
        let value = self.value.reciprocal();
        self.mapped(|| {
            let square = value.times(&value).negative();
            let third = square.times(&value).times(&Ball::exact(-2.0));
            [value.clone(), square, third]
        })
    }

    /// A function with these derivatives at the value.
    fn mapped(&self, derivatives: impl FnOnce() -> Derivatives) -> Self {
        let [value, slope, bend] = derivatives();
        let first = self.first.iter().map(|x| x.times(&slope)).collect();
        let second = pairs(self.first.len())
            .zip(&self.second)
            .map(|((i, j), x)| {
                let cross = self.first[i].times(&self.first[j]).times(&bend);
                x.times(&slope).plus(&cross)
            });
        Self {
            value,
            first,
            second: second.collect(),
        }
    }

    /// The integer power.
    pub fn power(&self, exponent: i32) -> Self {
        let mut power = Self::constant(Ball::one());
        for _ in 0..exponent.unsigned_abs() {
            power = power.times(self);
        }
        if exponent < 0 {
            power.reciprocal()
        } else {
            power
        }
    }

    /// A function of the generator's expressions.
    pub fn apply(function: Function, arguments: &[Self]) -> Self {
        match (function, arguments) {
            (Function::Pi, []) => Self::constant(Ball::pi()),
            (Function::Group, [x]) => x.clone(),
            (Function::Recip, [x]) => x.reciprocal(),
            (Function::Atan2, [y, x]) => y.angle(x),
            (Function::Sinh, [x]) => x.hyperbolic().0,
            (Function::Cosh, [x]) => x.hyperbolic().1,
            (Function::Sech, [x]) => x.hyperbolic().1.reciprocal(),
            (Function::Tanh, [x]) => {
                let (sinh, cosh) = x.hyperbolic();
                sinh.over(&cosh)
            }
            (Function::LnCosh, [x]) => Self::apply(Function::Ln, &[x.hyperbolic().1]),
            (Function::Ln1p, [x, m]) => {
                let scaled = x.times(&Self::apply(Function::Exp, std::slice::from_ref(m)));
                let sum = Self::constant(Ball::one()).plus(&scaled);
                Self::apply(Function::Ln, &[sum])
            }
            // No value depends on this scale: an exact number will do.
            (Function::Larger, [a, b]) => {
                let larger = a.value.to_f64().max(b.value.to_f64());
                Self::constant(Ball::exact(larger))
            }
            (function, [x]) if !x.varies() => Self::constant(value(function, &x.value)),
            (function, [x]) => x.mapped(|| derivatives(function, &x.value)),
            _ => Self::constant(Ball::unknown()),
        }
    }

    /// Hyperbolic sine and cosine by exponentials.
    fn hyperbolic(&self) -> (Self, Self) {
        let up = Self::apply(Function::Exp, std::slice::from_ref(self));
        let down = up.reciprocal();
        let half = Self::constant(half());
        (up.minus(&down).times(&half), up.plus(&down).times(&half))
    }

    /// `atan2(self, x)`: θ_i = (x y_i − y x_i) / ρ².
    fn angle(&self, x: &Self) -> Self {
        let value = self.value.atan2(&x.value);
        let count = self.first.len().max(x.first.len());
        if count == 0 {
            return Self::constant(value);
        }
        let seconds = match (self.varies(), x.varies()) {
            (true, true) => !self.second.is_empty() && !x.second.is_empty(),
            (true, false) => !self.second.is_empty(),
            _ => !x.second.is_empty(),
        };
        let (y1, x1) = (self.to_first_order(), x.to_first_order());
        let square = y1.times(&y1).plus(&x1.times(&x1));
        let along = |i: usize| {
            let moved = x1.times(&self.partial(i)).minus(&y1.times(&x.partial(i)));
            moved.over(&square)
        };
        let along: Vec<Self> = (0..count).map(along).collect();
        let second = pairs(count).map(|(i, j)| along[i].slope(j));
        Self {
            value,
            first: along.iter().map(|a| a.value.clone()).collect(),
            second: if seconds { second.collect() } else { vec![] },
        }
    }
}

/// Pairs (i, j) with j ≤ i, in the order of storage.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(|i| (0..=i).map(move |j| (i, j)))
}

fn place(i: usize, j: usize) -> usize {
    let (i, j) = (i.max(j), i.min(j));
    i * (i + 1) / 2 + j
}

fn value(function: Function, x: &Ball) -> Ball {
    match function {
        Function::Cos => x.cos(),
        Function::Sin => x.sin(),
        Function::Exp => x.exp(),
        Function::Ln => x.ln(),
        Function::Sqrt => x.sqrt(),
        Function::Stumpff(order) => x.stumpff(order.into()),
        Function::Curve(curve, order) => curve::derivative(curve, order, x),
        // The inverse of dexp serves finite maps that no law here asks for.
        _ => Ball::unknown(),
    }
}

fn derivatives(function: Function, x: &Ball) -> Derivatives {
    let f = value(function, x);
    match function {
        Function::Cos => {
            let slope = x.sin().negative();
            [f.clone(), slope, f.negative()]
        }
        Function::Sin => [f.clone(), x.cos(), f.negative()],
        Function::Exp => [f.clone(), f.clone(), f],
        Function::Ln => {
            let slope = x.reciprocal();
            let bend = slope.times(&slope).negative();
            [f, slope, bend]
        }
        Function::Sqrt => {
            let slope = f.reciprocal().times(&half());
            let bend = slope.over(x).times(&half()).negative();
            [f, slope, bend]
        }
        Function::Stumpff(order) => {
            let order = u32::from(order);
            let slope = |k: u32| {
                let ahead = x.stumpff(k + 2).times(&Ball::exact(k.into()));
                ahead.minus(&x.stumpff(k + 1)).times(&half())
            };
            let ahead = slope(order + 2).times(&Ball::exact(order.into()));
            let bend = ahead.minus(&slope(order + 1)).times(&half());
            [f, slope(order), bend]
        }
        Function::Curve(curve, order) => {
            let ahead = |by| curve::derivative(curve, order + by, x);
            [f, ahead(1), ahead(2)]
        }
        _ => [f, Ball::unknown(), Ball::unknown()],
    }
}
