//! Whether the kernels in words have the values that were derived, at random points of the manifold.
//!
//! Each step of the simplification is checked by algebra. This looks at what all of them have made together, names included: a name with two
//! meanings would pass the algebra.

use crate::expand::Expansion;
use crate::kernel::{Arguments, Kernel, KernelKind, Method, Step};
use crate::matrix::Matrix;
use crate::precise::{Point, Precise, Sampler};
use crate::prepare::Prepared;

/// Bits of the numbers: enough for sums that lose half of them.
const BITS: usize = 192;

/// Bits to which values agree, relative to the largest entry of a kernel, or to 1.
const AGREEING: usize = 80;

/// Points that are looked at.
const POINTS: usize = 2;

/// Whether each of the kernels has the value of that which was derived, as far as there are points at which both have one.
pub fn have_values_of(
    written: &[Kernel],
    derived: &[Kernel],
    joint: &Prepared,
    expansion: &Expansion,
) -> bool {
    let mut sampler = Sampler::new(&joint.space, BITS).single();
    (0..POINTS)
        .map_while(|_| sampler.point())
        .all(|point| agree(written, derived, expansion, &point))
}

fn agree(written: &[Kernel], derived: &[Kernel], expansion: &Expansion, point: &Point) -> bool {
    // Kernels as they were derived have no lines for the names of B.
    let mut named = point.clone();
    for word in expansion.named() {
        let value = named.evaluate(&word.value);
        named.bind(&word.symbol, value);
    }
    let named = &named;
    let is_bias = |kernel: &Kernel| {
        kernel.kind == KernelKind::BiasAcceleration || kernel.kind == KernelKind::BiasMomentum
    };
    let rate = match written.iter().any(is_bias) {
        true => rate(derived, expansion, named),
        false => None,
    };
    let vector = |symbols| Numbers::of(&Matrix::symbols(symbols), named);
    let Arguments { speeds, wrench, .. } = &expansion.arguments;
    written.iter().all(|kernel| {
        let expected = match kernel.kind {
            KernelKind::BiasAcceleration => {
                let bias = rate.as_ref().map(|rate| rate.times(&vector(speeds)));
                bias.map(|bias| bias.entries)
            }
            KernelKind::BiasMomentum => {
                let transposed = rate.as_ref().map(Numbers::transpose);
                transposed.map(|rate| rate.times(&vector(wrench)).entries)
            }
            kind => derived
                .iter()
                .find(|kernel| kernel.kind == kind)
                .and_then(|kernel| value(kernel, named)),
        };
        match (value(kernel, point), expected) {
            (Some(value), Some(expected)) => is_same(&value, &expected),
            _ => true,
        }
    })
}

/// The entries of a kernel; `None` where formulas are not all of it.
fn value(kernel: &Kernel, point: &Point) -> Option<Vec<Precise>> {
    if kernel.method != Method::Formula {
        return None;
    }
    let mut point = point.clone();
    for step in &kernel.steps {
        let Step::Let(symbol, value) = step else {
            return None;
        };
        let value = point.evaluate(value);
        point.bind(symbol, value);
    }
    let entries = kernel.outputs.iter().map(|output| point.matrix(output));
    Some(entries.flatten().collect())
}

/// `Ẋ̄^c = Σ_k (∂X^c/∂ϕ_k S̄ + X^c ∂S̄/∂ϕ_k) ϕ̇_k` with `ϕ̇ = S₀⁻¹ S̄ v̄`: its products are c and the dual of c.
fn rate(derived: &[Kernel], expansion: &Expansion, point: &Point) -> Option<Numbers> {
    let numbers = |matrix: &Matrix| Numbers::of(matrix, point);
    let all = |kind| -> Option<Vec<Numbers>> {
        let kernel = derived.iter().find(|kernel| kernel.kind == kind)?;
        Some(kernel.outputs.iter().map(numbers).collect())
    };
    let one = |kind| all(kind)?.into_iter().next();
    let (map, basis) = (
        one(KernelKind::TwistMapChild)?,
        one(KernelKind::SpeedBasis)?,
    );
    let local = one(KernelKind::VelocityMapInverse)?
        .times(&basis)
        .times(&numbers(&Matrix::symbols(&expansion.arguments.speeds)));
    let of_map = all(KernelKind::TwistMapChildGradient)?.into_iter();
    let of_basis = all(KernelKind::SpeedBasisGradient)?;
    let slices = of_map.zip(&of_basis).zip(&local.entries);
    let slices = slices.map(|((of_map, of_basis), rate)| {
        let moved = of_map.times(&basis);
        moved.plus(&map.times(of_basis)).scale(rate)
    });
    slices.reduce(|sum, slice| sum.plus(&slice))
}

/// Whether two lists of numbers agree; numbers that are not finite agree with all, as there the formulas have no value.
fn is_same(found: &[Precise], expected: &[Precise]) -> bool {
    if !expected.iter().all(Precise::is_finite) {
        return true;
    }
    let one = Precise::integer(1, BITS);
    let larger = |largest: Precise, entry: &Precise| match entry.abs().compare(&largest) {
        Some(order) if order.is_gt() => entry.abs(),
        _ => largest,
    };
    let scale = expected.iter().fold(one, larger);
    let limit = scale.halved(AGREEING as i32);
    let is_near = |(found, expected): (&Precise, &Precise)| {
        let difference = (found.clone() - expected.clone()).abs();
        difference
            .compare(&limit)
            .is_some_and(|order| order.is_le())
    };
    found.len() == expected.len() && found.iter().zip(expected).all(is_near)
}

/// A matrix of numbers, row by row.
struct Numbers {
    columns: usize,
    entries: Vec<Precise>,
}

impl Numbers {
    fn of(matrix: &Matrix, point: &Point) -> Self {
        Self {
            columns: matrix.columns(),
            entries: point.matrix(matrix),
        }
    }

    fn rows(&self) -> usize {
        self.entries.len() / self.columns.max(1)
    }

    fn at(&self, i: usize, j: usize) -> Precise {
        self.entries[i * self.columns + j].clone()
    }

    fn made(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> Precise) -> Self {
        let places = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
        let entries = places.map(|(i, j)| entry(i, j)).collect();
        Self { columns, entries }
    }

    fn times(&self, other: &Self) -> Self {
        Self::made(self.rows(), other.columns, |i, j| {
            let zero = Precise::integer(0, BITS);
            (0..self.columns).fold(zero, |sum, k| sum + self.at(i, k) * other.at(k, j))
        })
    }

    fn plus(&self, other: &Self) -> Self {
        Self::made(self.rows(), self.columns, |i, j| {
            self.at(i, j) + other.at(i, j)
        })
    }

    fn scale(&self, factor: &Precise) -> Self {
        Self::made(self.rows(), self.columns, |i, j| {
            self.at(i, j) * factor.clone()
        })
    }

    fn transpose(&self) -> Self {
        Self::made(self.columns, self.rows(), |i, j| self.at(j, i))
    }
}
