//! Units of a joint's degrees of freedom, velocities and speeds, which are those on its page: read off how they move Q and the child.

use super::coordinates::{Factor, Kind};
use hamel::erased::AnyJoint;
use nalgebra::{DMatrix, DVector, Vector6};

/// What a coordinate measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// An angle, rad.
    Angle,
    /// A length, m.
    Length,
    /// Neither.
    None,
}

impl Unit {
    /// Of the coordinate.
    pub const fn coordinate(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Length => "m",
            Self::None => "",
        }
    }

    /// Of its rate.
    pub const fn rate(self) -> &'static str {
        match self {
            Self::Angle => "rad/s",
            Self::Length => "m/s",
            Self::None => "",
        }
    }

    /// Of the effort that does work at this rate.
    pub const fn effort(self) -> &'static str {
        match self {
            Self::Angle => "N m",
            Self::Length => "N",
            Self::None => "",
        }
    }

    /// By the twist of a unit rate: an angle where it is a unit rotation, a length where it is a unit translation.
    fn of_twist(twist: &Vector6<f64>) -> Self {
        let (angular, linear) = hamel::spatial::split(twist);
        let is_unit = |length: f64| (length - 1.0).abs() < EXACT;
        match (angular.norm(), linear.norm()) {
            (turn, _) if is_unit(turn) => Self::Angle,
            (turn, slide) if turn < EXACT && is_unit(slide) => Self::Length,
            _ => Self::None,
        }
    }
}

/// Roundings of kernels at home.
const EXACT: f64 = 1e-9;

/// What a joint's coordinates measure.
#[derive(Clone, Debug)]
pub struct Units {
    /// ϕ.
    pub freedoms: Vec<Unit>,
    /// v, with which τ does work.
    pub velocities: Vec<Unit>,
    /// v̄.
    pub speeds: Vec<Unit>,
    /// The stored scalars of Q that are in no group; [`Unit::None`] for others.
    pub scalars: Vec<Unit>,
}

impl Units {
    /// Those of `joint`.
    pub fn of(joint: &dyn AnyJoint) -> Self {
        let home = Home::of(joint);
        let columns = 0..joint.layout().freedoms;
        let freedoms: Vec<_> = columns.clone().map(|k| home.freedom(k)).collect();
        let velocities: Vec<_> = columns
            .map(|k| match is_unit(home.velocity_map.row(k).iter(), k) {
                true => freedoms[k],
                false => home.unit(&home.entry(k)),
            })
            .collect();
        let speeds = 0..joint.layout().speeds;
        let speeds = speeds.map(|speed| home.speed(speed, &velocities)).collect();
        let scalars = home.scalars(&freedoms);
        Self {
            freedoms,
            velocities,
            speeds,
            scalars,
        }
    }
}

/// Whether entries are those of the unit vector `k`.
fn is_unit<'e>(entries: impl Iterator<Item = &'e f64>, k: usize) -> bool {
    let mut entries = entries.enumerate();
    entries.all(|(i, entry)| (entry - f64::from(u8::from(i == k))).abs() < EXACT)
}

/// A joint at home, where its kernels say what its coordinates do.
struct Home {
    factors: Vec<Factor>,
    /// X^c of each body.
    twist_maps: Vec<DMatrix<f64>>,
    /// Whether relations alone say how Q moves, so that a velocity may have a scale of its own.
    by_relations: bool,
    /// S₀.
    velocity_map: DMatrix<f64>,
    /// S̄.
    speed_basis: DMatrix<f64>,
    /// ∂Q/∂ϕ.
    rates: DMatrix<f64>,
}

impl Home {
    fn of(joint: &dyn AnyJoint) -> Self {
        let layout = joint.layout();
        let (size, freedoms) = (layout.configuration, layout.freedoms);
        let mut q = vec![0.0; size];
        joint.home(&mut q);
        let twist_map = |body: &dyn AnyJoint| {
            let mut twist_map = DMatrix::zeros(6, freedoms);
            body.twist_map_child(&q, twist_map.as_mut_slice());
            twist_map
        };
        let others = joint.more();
        let others = others.iter().map(|body| twist_map(&**body));
        let twist_maps = std::iter::once(twist_map(joint)).chain(others).collect();
        let mut velocity_map = DMatrix::zeros(freedoms, freedoms);
        joint.velocity_map(&q, velocity_map.as_mut_slice());
        let mut speed_basis = DMatrix::zeros(freedoms, layout.speeds);
        joint.speed_basis(&q, speed_basis.as_mut_slice());
        let mut rates = DMatrix::zeros(size, freedoms);
        for (velocity, mut rate) in velocity_map.column_iter().zip(rates.column_iter_mut()) {
            let mut column = vec![0.0; size];
            joint.configuration_rate(&q, velocity.clone_owned().as_slice(), &mut column);
            rate.copy_from_slice(&column);
        }
        Self {
            factors: Factor::all(joint),
            twist_maps,
            by_relations: !joint.relations().is_empty(),
            velocity_map,
            speed_basis,
            rates,
        }
    }

    /// What moves an attitude is an angle, what else moves a group is a length; of real vectors the twist decides.
    fn freedom(&self, k: usize) -> Unit {
        let moved = self.factors.iter().flat_map(|factor| {
            let places = (0..factor.kind.size()).filter(|place| {
                let rate = self.rates[(factor.first + place, k)];
                rate.abs() > EXACT
            });
            places.map(|place| (factor.kind, factor.kind.turns(place)))
        });
        let moved: Vec<_> = moved.collect();
        let by_twists = || self.unit(&self.velocity_map.column(k).clone_owned());
        if moved.iter().any(|(_, turns)| *turns) {
            return match self.by_relations && !self.turns_by_one(k) {
                true => by_twists(),
                false => Unit::Angle,
            };
        }
        match moved.first() {
            Some((Kind::Scalar, _)) | None => by_twists(),
            Some(_) => Unit::Length,
        }
    }

    /// Whether some direction of the plane turns by one radian for one of ϕ_k.
    fn turns_by_one(&self, k: usize) -> bool {
        let planar = self.factors.iter().filter(|factor| factor.kind == Kind::S1);
        let mut turns = planar.map(|factor| {
            let rate = |place: usize| self.rates[(factor.first + place, k)];
            rate(0).hypot(rate(1))
        });
        turns.any(|turn| (turn - 1.0).abs() < EXACT)
    }

    /// By the first body whose twist at this velocity tells.
    fn unit(&self, velocity: &DVector<f64>) -> Unit {
        let twists = self.twist_maps.iter().map(|map| six(&(map * velocity)));
        let mut units = twists.map(|twist| Unit::of_twist(&twist));
        let found = units.find(|unit| *unit != Unit::None);
        found.unwrap_or(Unit::None)
    }

    /// A unit of v.
    fn entry(&self, k: usize) -> DVector<f64> {
        DVector::from_fn(self.velocity_map.nrows(), |i, _| {
            f64::from(u8::from(i == k))
        })
    }

    /// Of a speed that is one entry of v, as of that; of any other by its twist, or as of an entry of v that equals it.
    fn speed(&self, speed: usize, velocities: &[Unit]) -> Unit {
        let column = self.speed_basis.column(speed);
        let mut entries = 0..velocities.len();
        if let Some(k) = entries.find(|&k| is_unit(column.iter(), k)) {
            return velocities[k];
        }
        let equals = |k: &usize| is_unit(self.speed_basis.row(*k).iter(), speed);
        match self.unit(&column.clone_owned()) {
            Unit::None => (0..velocities.len())
                .find(equals)
                .map_or(Unit::None, |k| velocities[k]),
            unit => unit,
        }
    }

    /// A stored scalar has the unit of the degrees of freedom that move it.
    fn scalars(&self, freedoms: &[Unit]) -> Vec<Unit> {
        let unit = |row: usize| {
            let rates = self.rates.row(row);
            let moving = rates.iter().zip(freedoms);
            let mut moving = moving.filter(|(rate, _)| rate.abs() > EXACT);
            let first = moving.next().map_or(Unit::None, |(_, unit)| *unit);
            match moving.all(|(_, unit)| *unit == first) {
                true => first,
                false => Unit::None,
            }
        };
        (0..self.rates.nrows()).map(unit).collect()
    }
}

fn six(column: &DVector<f64>) -> Vector6<f64> {
    Vector6::from_iterator(column.iter().copied())
}
