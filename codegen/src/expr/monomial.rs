//! Products of powers of atoms, in the term order of the ring.

use super::atom::Atom;
use std::cmp::Ordering;

/// A product of powers of atoms.
///
/// Powers of parameters and π may be negative: these belong to the field of coefficients. All others are positive.
/// The order is graded reverse lexicographic in the other atoms, ties broken by the parameters.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Monomial {
    /// Atoms of the ring, ascending.
    main: Vec<(Atom, u32)>,
    /// Atoms of the field of coefficients, ascending.
    units: Vec<(Atom, i32)>,
}

impl Monomial {
    /// The monomial 1.
    pub fn one() -> Self {
        Self::default()
    }

    /// The monomial `atom`.
    pub fn atom(atom: Atom) -> Self {
        match atom.is_unit() {
            true => Self {
                main: vec![],
                units: vec![(atom, 1)],
            },
            false => Self {
                main: vec![(atom, 1)],
                units: vec![],
            },
        }
    }

    /// Whether this is 1.
    pub fn is_one(&self) -> bool {
        self.main.is_empty() && self.units.is_empty()
    }

    /// Whether only parameters and π occur, so that the monomial is invertible.
    pub fn is_unit(&self) -> bool {
        self.main.is_empty()
    }

    /// Number of its atoms.
    pub(super) fn len(&self) -> usize {
        self.main.len() + self.units.len()
    }

    /// Total degree in the atoms of the ring.
    pub fn degree(&self) -> u32 {
        self.main.iter().map(|(_, power)| power).sum()
    }

    /// The atoms of the ring with their powers, ascending.
    pub fn main(&self) -> &[(Atom, u32)] {
        &self.main
    }

    /// The parameters with their powers, ascending.
    pub fn units(&self) -> &[(Atom, i32)] {
        &self.units
    }

    /// The part without parameters, and the part that is only parameters.
    pub fn split(&self) -> (Self, Self) {
        (
            Self {
                main: self.main.clone(),
                units: vec![],
            },
            Self {
                main: vec![],
                units: self.units.clone(),
            },
        )
    }

    /// All atoms with their powers.
    pub fn factors(&self) -> impl Iterator<Item = (&Atom, i32)> {
        let main = self.main.iter().map(|(atom, power)| (atom, *power as i32));
        self.units
            .iter()
            .map(|(atom, power)| (atom, *power))
            .chain(main)
    }

    /// The product of some of the factors of a monomial, in their order.
    pub(crate) fn of_factors<'a>(factors: impl IntoIterator<Item = (&'a Atom, i32)>) -> Self {
        let mut product = Self::one();
        for (atom, power) in factors {
            match atom.is_unit() {
                true => product.units.push((atom.clone(), power)),
                false => product.main.push((atom.clone(), power.unsigned_abs())),
            }
        }
        product
    }

    /// The power of `atom`.
    pub fn power(&self, atom: &Atom) -> i32 {
        self.factors()
            .find(|(candidate, _)| *candidate == atom)
            .map_or(0, |(_, power)| power)
    }

    /// The product.
    pub fn times(&self, other: &Self) -> Self {
        Self {
            main: merge(&self.main, &other.main, |a, b| a + b, |b| b),
            units: merge(&self.units, &other.units, |a, b| a + b, |b| b),
        }
    }

    /// The quotient, where `divisor` divides this in the ring.
    pub fn divided_by(&self, divisor: &Self) -> Option<Self> {
        if !divisor.main_divides(self) {
            return None;
        }
        Some(Self {
            main: merge(&self.main, &divisor.main, |a, b| a - b, |b| b),
            units: merge(&self.units, &divisor.units, |a, b| a - b, |b| -b),
        })
    }

    /// The reciprocal of a unit.
    pub fn recip(&self) -> Option<Self> {
        self.is_unit().then(|| Self {
            main: vec![],
            units: self
                .units
                .iter()
                .map(|(a, power)| (a.clone(), -power))
                .collect(),
        })
    }

    fn main_divides(&self, other: &Self) -> bool {
        let mut candidates = other.main.iter();
        self.main.iter().all(|(atom, power)| {
            candidates
                .by_ref()
                .find(|(candidate, _)| candidate >= atom)
                .is_some_and(|(candidate, available)| candidate == atom && available >= power)
        })
    }

    /// Least common multiple of the parts without parameters.
    pub fn lcm(&self, other: &Self) -> Self {
        Self {
            main: merge(&self.main, &other.main, u32::max, |b| b),
            units: vec![],
        }
    }

    /// Whether no atom of the ring occurs in both.
    pub fn is_coprime(&self, other: &Self) -> bool {
        self.main
            .iter()
            .all(|(atom, _)| other.main.iter().all(|(candidate, _)| candidate != atom))
    }
}

/// Merges two ascending lists, combining the powers of common atoms and dropping zeros.
fn merge<P: Copy + PartialEq + Default>(
    a: &[(Atom, P)],
    b: &[(Atom, P)],
    both: impl Fn(P, P) -> P,
    only_b: impl Fn(P) -> P,
) -> Vec<(Atom, P)> {
    if b.is_empty() {
        return a.to_vec();
    }
    let mut merged = Vec::with_capacity(a.len() + b.len());
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let order = match (a.get(i), b.get(j)) {
            (Some(x), Some(y)) => x.0.cmp(&y.0),
            (Some(_), None) => Ordering::Less,
            _ => Ordering::Greater,
        };
        let (atom, power) = match order {
            Ordering::Less => (&a[i].0, a[i].1),
            Ordering::Greater => (&b[j].0, only_b(b[j].1)),
            Ordering::Equal => (&a[i].0, both(a[i].1, b[j].1)),
        };
        if power != P::default() {
            merged.push((atom.clone(), power));
        }
        i += usize::from(order != Ordering::Greater);
        j += usize::from(order != Ordering::Less);
    }
    merged
}

impl PartialOrd for Monomial {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Monomial {
    fn cmp(&self, other: &Self) -> Ordering {
        self.degree()
            .cmp(&other.degree())
            .then_with(|| reverse_lexicographic(&self.main, &other.main))
            .then_with(|| self.units.cmp(&other.units))
    }
}

/// Of two monomials of one degree, the larger has the smaller power of the smallest atom in which they differ.
pub(crate) fn reverse_lexicographic<A: Ord>(a: &[(A, u32)], b: &[(A, u32)]) -> Ordering {
    for (x, y) in a.iter().zip(b) {
        match x.0.cmp(&y.0) {
            Ordering::Equal if x.1 == y.1 => {}
            Ordering::Equal => return y.1.cmp(&x.1),
            // The smaller atom stands in one of them alone: that one is smaller.
            order => return order,
        }
    }
    b.len().cmp(&a.len())
}
