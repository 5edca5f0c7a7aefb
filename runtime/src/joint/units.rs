//! Units of a joint's coordinates, velocities and speeds, as its spec determines them.

/// What a coordinate is measured in, in SI units and radians; all texts are empty where nothing tells it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Unit {
    /// Of the coordinate: `rad`, `m`, `1` for a number, `1/m^2`.
    pub name: &'static str,
    /// Of its rate.
    pub rate: &'static str,
    /// Of the effort that does work at this rate.
    pub effort: &'static str,
}

impl Unit {
    /// An angle.
    pub const ANGLE: Self = Self::new("rad", "rad/s", "N m");
    /// A length.
    pub const LENGTH: Self = Self::new("m", "m/s", "N");
    /// A number.
    pub const NUMBER: Self = Self::new("1", "1/s", "N m");
    /// Not known.
    pub const UNKNOWN: Self = Self::new("", "", "");

    /// A unit by what is said of it.
    pub const fn new(name: &'static str, rate: &'static str, effort: &'static str) -> Self {
        Self { name, rate, effort }
    }
}

/// The units of a joint. Lists are shorter than what they are of where nothing is known of the rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Units {
    /// Of the stored scalars of Q: N of them.
    pub coordinates: &'static [Unit],
    /// Of ϕ: K of them.
    pub freedoms: &'static [Unit],
    /// What v are the rates of, with which efforts τ do work: K of them.
    pub velocities: &'static [Unit],
    /// What the speeds v̄ are the rates of: S of them.
    pub speeds: &'static [Unit],
}

impl Units {
    /// Those of a joint that tells none.
    pub const UNKNOWN: Self = Self::of_rates(&[]);

    /// Those of a joint whose v and v̄ are the rates of its coordinates.
    pub const fn of_rates(coordinates: &'static [Unit]) -> Self {
        Self {
            coordinates,
            freedoms: coordinates,
            velocities: coordinates,
            speeds: coordinates,
        }
    }

    /// Those of the stored scalars of Q, of ϕ, of what v are the rates of, and of what v̄ are.
    pub const fn new(
        coordinates: &'static [Unit],
        freedoms: &'static [Unit],
        velocities: &'static [Unit],
        speeds: &'static [Unit],
    ) -> Self {
        Self {
            coordinates,
            freedoms,
            velocities,
            speeds,
        }
    }

    /// That of a stored scalar of Q.
    pub fn coordinate(&self, place: usize) -> Unit {
        of(self.coordinates, place)
    }

    /// That of a ϕ.
    pub fn freedom(&self, place: usize) -> Unit {
        of(self.freedoms, place)
    }

    /// That of what a v is the rate of.
    pub fn velocity(&self, place: usize) -> Unit {
        of(self.velocities, place)
    }

    /// That of what a speed is the rate of.
    pub fn speed(&self, place: usize) -> Unit {
        of(self.speeds, place)
    }
}

fn of(units: &[Unit], place: usize) -> Unit {
    units.get(place).copied().unwrap_or(Unit::UNKNOWN)
}
