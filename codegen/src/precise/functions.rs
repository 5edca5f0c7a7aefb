//! The functions of [`Function`](crate::expr::Function) that are made of others: `atan2`, hyperbolic functions, Stumpff functions, `dexp⁻¹`.

use super::Precise;

/// Bits beyond the precision asked for: for the rounding of some hundred operations, and for the cancellation of a few terms.
const GUARD: usize = 64;

/// The largest √|s| at which Stumpff functions are summed as series, whose largest term is then 2¹⁴⁴ of the value or less.
const LARGEST_SERIES_ANGLE: f64 = 100.0;

impl Precise {
    /// The angle of the point `(x, self)`, in (−π, π]; 0 at the origin.
    pub fn atan2(&self, x: &Self) -> Self {
        let wide = self.bits() + GUARD;
        let (y, x) = (self.to_bits(wide), x.to_bits(wide));
        if y.is_zero() && !x.is_negative() {
            return self.same(0);
        }
        let half_turn = match y.is_negative() {
            true => -Self::pi(wide),
            false => Self::pi(wide),
        };
        // The steeper of both quotients is the smaller one: neither overflows, and a right angle is exact.
        let steep = matches!(x.abs().compare(&y.abs()), Some(std::cmp::Ordering::Less));
        let angle = match (steep, x.is_negative()) {
            (true, _) => half_turn.halved(1) - (&x / &y).atan(),
            (false, true) => half_turn + (&y / &x).atan(),
            (false, false) => (&y / &x).atan(),
        };
        angle.to_bits(self.bits())
    }

    /// Hyperbolic tangent, by `e^(−2|x|)`, which does not overflow.
    pub fn tanh(&self) -> Self {
        if self.is_negligible() {
            return self.clone();
        }
        let size = self.to_bits(self.bits() + self.lost_below_one()).abs();
        let faded = size.halved(-1).negative().exp();
        let one = faded.same(1);
        let tangent = &(&one - &faded) / &(&one + &faded);
        let signed = if self.is_negative() {
            -tangent
        } else {
            tangent
        };
        signed.to_bits(self.bits())
    }

    /// Logarithm of the hyperbolic cosine: `|x| + ln(1 + e^(−2|x|)) − ln 2`.
    pub fn ln_cosh(&self) -> Self {
        if self.is_negligible() {
            return (self * self).halved(1);
        }
        // Near 0 it is x²/2, and its parts are of order 1.
        let size = self.to_bits(self.bits() + 2 * self.lost_below_one()).abs();
        let faded = size.halved(-1).negative().exp();
        let half = (&faded.same(1) + &faded).halved(1);
        (&size + &half.ln()).to_bits(self.bits())
    }

    /// `ln(1 + x)`.
    pub fn ln_1p(&self) -> Self {
        if self.is_negligible() {
            return self.clone();
        }
        let wide = self.to_bits(self.bits() + self.lost_below_one());
        (&wide.same(1) + &wide).ln().to_bits(self.bits())
    }

    /// The larger of two numbers.
    pub fn larger(&self, other: &Self) -> Self {
        match self.compare(other) {
            Some(std::cmp::Ordering::Less) => other.clone(),
            _ => self.clone(),
        }
    }

    /// Bits that sums of numbers of order 1 lose where a number of this size is left, and some to spare.
    fn lost_below_one(&self) -> usize {
        GUARD + (-self.log2()).max(0.0) as usize
    }

    /// Whether 1 + x is 1 to all digits and more: of a function's series its first term is left.
    pub(super) fn is_negligible(&self) -> bool {
        self.log2() < -((self.bits() + GUARD) as f64)
    }

    /// Stumpff function `c_order(s) = Σ_j (−s)^j / (order + 2j)!` of `s = self`.
    pub fn stumpff(&self, order: u32) -> Self {
        let angle = self.to_f64().abs().sqrt();
        let series = angle < LARGEST_SERIES_ANGLE.max(2.0 * f64::from(order));
        // e^angle is the largest term relative to the value: 1.45 bits a radian.
        let lost = if series { (1.45 * angle) as usize } else { 0 };
        let s = self.to_bits(self.bits() + GUARD + lost);
        let value = match series {
            true => series_of_stumpff(&s, order),
            false => recurrence_of_stumpff(&s, order),
        };
        value.to_bits(self.bits())
    }

    /// `n`-th derivative in `s = self` of `G(s) = (1 − (θ/2) cot(θ/2)) / θ²`, `s = θ²`.
    ///
    /// With u = s/4 it is `(c₂(u) − c₃(u)) / (4 c₁(u))`, which cancels nowhere; the derivatives are those of the quotient.
    pub fn dexp_inverse(&self, derivative: u32) -> Self {
        let n = derivative as usize;
        let u = self.to_bits(self.bits() + GUARD).halved(2);
        let slopes = |order| stumpff_derivatives(&u, order, n);
        let (c1, c2, c3) = (slopes(1), slopes(2), slopes(3));
        let mut quotient: Vec<Self> = vec![];
        for m in 0..=n {
            let numerator = &c2[m] - &c3[m];
            let known = (0..m).fold(u.same(0), |sum, i| {
                sum + u.same(binomial(m, i)) * &quotient[i] * &c1[m - i]
            });
            quotient.push(&(numerator - known) / &c1[0]);
        }
        quotient[n]
            .halved(2 + 2 * derivative as i32)
            .to_bits(self.bits())
    }
}

fn series_of_stumpff(s: &Precise, order: u32) -> Precise {
    let mut term = (1..=order).fold(s.same(1), |term, n| &term / &s.same(n.into()));
    let mut sum = term.clone();
    let smallest = s.same(1).halved(s.bits() as i32);
    let mut last = i64::from(order);
    // Terms fall once (last + 1)(last + 2) > |s|; both factors grow, so this ends.
    while term.is_finite() && !term.is_zero() {
        term = &(&term * &-s) / &s.same((last + 1) * (last + 2));
        last += 2;
        sum = &sum + &term;
        let negligible = (&smallest * &sum.abs()).compare(&term.abs());
        let falling = (last * last) as f64 > s.to_f64().abs();
        if falling && negligible != Some(std::cmp::Ordering::Less) {
            break;
        }
    }
    sum
}

/// From c₀ and c₁ by `c_{k+2} = (1/k! − c_k) / s`, for s of many turns.
fn recurrence_of_stumpff(s: &Precise, order: u32) -> Precise {
    let angle = s.abs().sqrt();
    let start = match (order.is_multiple_of(2), s.is_negative()) {
        (true, false) => angle.cos(),
        (true, true) => angle.cosh(),
        (false, false) => &angle.sin() / &angle,
        (false, true) => &angle.sinh() / &angle,
    };
    let mut inverse_factorial = s.same(1);
    let mut value = start;
    for k in (order % 2..order).step_by(2) {
        value = &(&inverse_factorial - &value) / s;
        inverse_factorial = &inverse_factorial / &s.same(i64::from(k + 1) * i64::from(k + 2));
    }
    value
}

/// `c_k, c_k′, …, c_k⁽ⁿ⁾` by `c_k′ = (k c_{k+2} − c_{k+1}) / 2`.
fn stumpff_derivatives(s: &Precise, order: usize, n: usize) -> Vec<Precise> {
    // Row m holds the m-th derivatives of c_order, c_{order+1}, …: two fewer in each row.
    let mut row: Vec<Precise> = (order..=order + 2 * n)
        .map(|k| s.stumpff(k as u32))
        .collect();
    let mut derivatives = vec![row[0].clone()];
    for _ in 0..n {
        row = (0..row.len() - 2)
            .map(|i| (s.same((order + i) as i64) * &row[i + 2] - row[i + 1].clone()).halved(1))
            .collect();
        derivatives.push(row[0].clone());
    }
    derivatives
}

fn binomial(n: usize, k: usize) -> i64 {
    (0..k).fold(1, |b, i| b * (n - i) as i64 / (i + 1) as i64)
}
