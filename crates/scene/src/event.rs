//! Events of a scene: as the file says them, and as an integration takes them.

use crate::source::Located;
use hamel_integrate::{Direction, Event};
use hamel_runtime::mechanism::Mechanism;
use nalgebra::Vector3;
use std::sync::Arc;

/// Names of the directions in which a value is crossed, as scene files write them.
pub(crate) const DIRECTION_NAMES: [&str; 3] = ["any", "rising", "falling"];

/// Names of what follows, as scene files write them.
pub(crate) const CONSEQUENCE_NAMES: [&str; 2] = ["record", "stop"];

/// An event, as a scene file says it.
#[derive(Clone, Debug)]
pub struct EventDescription {
    /// Name, unique among events.
    pub name: Located<String>,
    /// What crosses the value.
    pub quantity: QuantityDescription,
    /// The value, in the unit of the quantity.
    pub value: f64,
    /// Which crossings count.
    pub direction: Direction,
    /// Whether the first of them ends the simulation.
    pub stops: bool,
}

/// A quantity, as a scene file says it.
#[derive(Clone, Debug)]
pub enum QuantityDescription {
    /// How far a point lies along a direction.
    Point(PointAlong),
    /// One of the stored scalars of a joint's Q, by name.
    Coordinate {
        /// The joint.
        joint: Located<String>,
        /// Its coordinate.
        name: Located<String>,
    },
    /// One of a joint's speeds v̄, by name.
    Speed {
        /// The joint.
        joint: Located<String>,
        /// Its speed.
        name: Located<String>,
    },
    /// The value of one of a joint's ports, by name.
    Port {
        /// The joint.
        joint: Located<String>,
        /// Its port.
        name: Located<String>,
    },
    /// The rate of one of a joint's ports, by name.
    Rate {
        /// The joint.
        joint: Located<String>,
        /// Its port.
        name: Located<String>,
    },
}

/// How far a point of a body lies along a direction of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointAlong {
    /// Index of the body.
    pub body: usize,
    /// The point in the body frame, m.
    pub point: Vector3<f64>,
    /// The direction in world axes, of length 1.
    pub along: Vector3<f64>,
}

/// A quantity of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Quantity {
    /// How far a point lies along a direction, m.
    Point(PointAlong),
    /// The entry of the configurations Q of all joints.
    Coordinate(usize),
    /// The entry of the speeds v̄ of all joints.
    Speed(usize),
    /// The value of a port of the joint under a body.
    Port(PortOf),
    /// Its rate.
    Rate(PortOf),
}

/// A port of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PortOf {
    /// Index of the body.
    pub body: usize,
    /// Index of the port among those of its joint.
    pub port: usize,
    /// Whether its value is an angle up to whole turns.
    pub wraps: bool,
}

/// An event, fitted to the mechanism of its scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneEvent {
    /// Its name.
    pub name: String,
    /// What crosses the value.
    pub quantity: Quantity,
    /// The value, in the unit of the quantity.
    pub value: f64,
    /// Which crossings count.
    pub direction: Direction,
    /// Whether the first of them ends the simulation.
    pub stops: bool,
}

impl SceneEvent {
    /// As an integration of `mechanism` takes it.
    pub fn event(&self, mechanism: &Arc<Mechanism>) -> Event<'static> {
        let (quantity, value) = (self.quantity, self.value);
        let (mechanism, there) = (Arc::clone(mechanism), Arc::clone(mechanism));
        let beyond = move |_time: f64, q: &[f64], speeds: &[f64]| {
            let found = match quantity {
                Quantity::Point(point) => point.of(&mechanism, q),
                Quantity::Coordinate(entry) => entry_of(q, entry),
                Quantity::Speed(entry) => entry_of(speeds, entry),
                // An angle up to whole turns crosses the value modulo a turn.
                Quantity::Port(port) if port.wraps => {
                    return (port.value(&mechanism, q) - value).sin();
                }
                Quantity::Port(port) => port.value(&mechanism, q),
                Quantity::Rate(port) => port.rate(&mechanism, q, speeds),
            };
            found - value
        };
        let event = Event::new(&*self.name, beyond).towards(self.direction);
        let event = match quantity {
            Quantity::Port(port) if port.wraps => {
                event.provided(move |_, q, _| (port.value(&there, q) - value).cos() > 0.0)
            }
            _ => event,
        };
        match self.stops {
            true => event.stopping(),
            false => event,
        }
    }
}

impl PortOf {
    /// rad or m; NaN of a port that is not there.
    fn value(&self, mechanism: &Mechanism, q: &[f64]) -> f64 {
        let body = mechanism.body(self.body);
        body.map_or(f64::NAN, |body| {
            body.joint().port_value(body.configuration(q), self.port)
        })
    }

    /// rad/s or m/s.
    fn rate(&self, mechanism: &Mechanism, q: &[f64], speeds: &[f64]) -> f64 {
        let rates = mechanism.port_rates(self.body, q, speeds);
        rates.map_or(f64::NAN, |rates| entry_of(&rates, self.port))
    }
}

/// NaN for an entry that is not there, which whoever looks at an event refuses.
fn entry_of(values: &[f64], entry: usize) -> f64 {
    values.get(entry).copied().unwrap_or(f64::NAN)
}

impl PointAlong {
    /// At configuration `q`, m.
    fn of(&self, mechanism: &Mechanism, q: &[f64]) -> f64 {
        let (mut position, mut next) = (self.point, Some(self.body));
        while let Some(index) = next {
            let Ok(body) = mechanism.body(index) else {
                return f64::NAN;
            };
            let joint = body.joint().pose(body.configuration(q));
            let pose = *body.placement() * joint * *body.child_placement();
            position = pose.transform_point(&position);
            next = body.parent();
        }
        self.along.dot(&position)
    }
}
