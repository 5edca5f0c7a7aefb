//! What a joint's quantities are measured in: exponents of the metre, the kilogram, the second and the radian.

use crate::expr::Rational;
use num_traits::Zero;
use std::ops::Range;

/// The units whose exponents are told, in order.
const NAMES: [&str; 4] = ["m", "kg", "s", "rad"];

/// Places of the units that are compared: a radian is a number.
pub(crate) const COMPARED: Range<usize> = 0..3;
/// The place of the radian, which is only told.
pub(crate) const ANGLE: Range<usize> = 3..4;

/// The exponent of each unit.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Dimension([Rational; 4]);

impl Dimension {
    /// A length.
    pub fn length() -> Self {
        Self::parsed("m")
    }

    /// An angle.
    pub fn angle() -> Self {
        Self::parsed("rad")
    }

    /// That of a declared unit, `kg*m/s`; unknown parts count as numbers.
    pub fn parsed(unit: &str) -> Self {
        let mut dimension = Self::default();
        let (mut rest, mut sign) = (unit, Rational::from(1));
        loop {
            let end = rest.find(['*', '/']).unwrap_or(rest.len());
            let part: &[(usize, i64)] = match &rest[..end] {
                "m" => &[(0, 1)],
                "kg" => &[(1, 1)],
                "s" => &[(2, 1)],
                "rad" => &[(3, 1)],
                "N" => &[(0, 1), (1, 1), (2, -2)],
                _ => &[],
            };
            for (place, exponent) in part {
                dimension.0[*place] += &sign * &Rational::from(*exponent);
            }
            match rest[end..].chars().next() {
                Some('*') => sign = Rational::from(1),
                Some(_) => sign = Rational::from(-1),
                None => return dimension,
            }
            rest = &rest[end + 1..];
        }
    }

    /// Adds a multiple of the other's exponents.
    pub fn add(&mut self, other: &Self, times: &Rational) {
        for (own, other) in self.0.iter_mut().zip(&other.0) {
            *own += other * times;
        }
    }

    /// Whether the exponents of these units are 0.
    pub fn vanishes(&self, units: &Range<usize>) -> bool {
        self.0[units.clone()].iter().all(Zero::is_zero)
    }

    /// The exponent of the radian, and those of all others.
    pub fn split(self) -> (Rational, Self) {
        let mut others = self.0;
        let angle = std::mem::take(&mut others[ANGLE.start]);
        (angle, Self(others))
    }

    /// `m`, `kg m^2/s`, `1/m^2`; `1` for a number.
    pub fn in_units(&self) -> String {
        let sides = [true, false].map(|above| {
            let own = self.0.iter().zip(NAMES);
            let own = own.filter(|(power, _)| power.is_positive() == above && !power.is_zero());
            let parts: Vec<String> = own.map(|(power, name)| power_of(name, power)).collect();
            parts
        });
        let [above, below] = sides;
        let numerator = match above.as_slice() {
            [] => "1".to_owned(),
            parts => parts.join(" "),
        };
        match below.as_slice() {
            [] => numerator,
            [one] => format!("{numerator}/{one}"),
            parts => format!("{numerator}/({})", parts.join(" ")),
        }
    }

    /// The unit of its rate.
    pub fn rate(&self) -> String {
        let mut rate = self.clone();
        rate.add(&Self::parsed("s"), &Rational::from(-1));
        rate.in_units()
    }

    /// The unit of the effort that does work at its rate, in newtons where that is a force by lengths.
    pub fn effort(&self) -> String {
        let mut effort = Self::parsed("N*m");
        let (_, lengths) = self.clone().split();
        effort.add(&lengths, &Rational::from(-1));
        let mut lever = effort.clone();
        lever.add(&Self::parsed("N"), &Rational::from(-1));
        let is_lever = lever.vanishes(&(1..3));
        match is_lever {
            true if lever.vanishes(&COMPARED) => "N".to_owned(),
            true if lever.0[0].is_positive() => format!("N {}", lever.in_units()),
            true => format!("N{}", &lever.in_units()[1..]),
            false => effort.in_units(),
        }
    }

    /// The same in a sentence, where an angle is a number.
    pub fn in_words(&self) -> String {
        let (_, others) = self.clone().split();
        match others.vanishes(&COMPARED) {
            true => "rad or 1".to_owned(),
            false => others.in_units(),
        }
    }
}

fn power_of(name: &str, power: &Rational) -> String {
    let size = power.abs();
    match (size == Rational::from(1), size.is_integer()) {
        (true, _) => name.to_owned(),
        (_, true) => format!("{name}^{size}"),
        _ => format!("{name}^({size})"),
    }
}

/// What a joint's quantities are measured in; `None` where the spec does not determine it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// The stored scalars of Q, in order.
    pub coordinates: Vec<Option<Dimension>>,
    /// ϕ.
    pub freedoms: Vec<Option<Dimension>>,
    /// What the rates v are of: a v in m/s is that of a length.
    pub velocities: Vec<Option<Dimension>>,
    /// What declared speeds are of, by the columns of S̄; empty where S̄ is not declared.
    pub speeds: Vec<Option<Dimension>>,
    /// The declared relations: that of both sides.
    pub relations: Vec<Option<Dimension>>,
}

#[cfg(test)]
mod tests {
    use super::Dimension;

    #[test]
    fn units_are_read_and_written() {
        for (read, written) in [
            ("m", "m"),
            ("1", "1"),
            ("rad", "rad"),
            ("m/rad", "m/rad"),
            ("m*m", "m^2"),
            ("1/m/s", "1/(m s)"),
            ("N*m", "m^2 kg/s^2"),
            ("N/N", "1"),
        ] {
            assert_eq!(Dimension::parsed(read).in_units(), written, "{read}");
        }
        for (read, rate, effort) in [
            ("rad", "rad/s", "N m"),
            ("m", "m/s", "N"),
            ("1", "1/s", "N m"),
            ("1/m/m", "1/(m^2 s)", "N m^3"),
            ("m*m", "m^2/s", "N/m"),
            ("kg", "kg/s", "m^2/s^2"),
        ] {
            let unit = Dimension::parsed(read);
            assert_eq!((&*unit.rate(), &*unit.effort()), (rate, effort), "{read}");
        }
        assert_eq!(Dimension::parsed("m/rad").in_words(), "m");
        assert_eq!(Dimension::parsed("rad").in_words(), "rad or 1");
    }
}
