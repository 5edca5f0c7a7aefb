//! The joints whose motion goes by pieces, and what each of them does in a piece.

use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::Range;
use hamel_runtime::dynamics::EffortAtPort;
use hamel_runtime::elements::LimitOf;
use hamel_runtime::erased::AnyJoint;
use hamel_runtime::mechanism::Mechanism;

/// One end of a joint's range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Lower,
    Upper,
}

impl Side {
    pub(super) const BOTH: [Self; 2] = [Self::Lower, Self::Upper];

    /// The direction from the limit to where the joint may be.
    pub(super) const fn inwards(self) -> f64 {
        match self {
            Self::Lower => 1.0,
            Self::Upper => -1.0,
        }
    }

    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Lower => "lower",
            Self::Upper => "upper",
        }
    }
}

/// What a joint does until the next event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// It moves, and no friction acts.
    Free,
    /// It moves against its friction.
    Slides {
        /// Whether its coordinate grows.
        forward: bool,
    },
    /// Friction holds it.
    Sticks,
    /// Its limit holds it, and friction if there is any.
    Rests(Side),
}

impl Phase {
    pub(super) const fn is_held(self) -> bool {
        matches!(self, Self::Sticks | Self::Rests(_))
    }
}

/// A joint with friction, limits or both.
#[derive(Clone, Debug)]
pub(crate) struct Contact {
    pub(super) body: usize,
    /// Where its coordinate, effort and speed stand among those of all joints.
    pub(super) coordinate: usize,
    pub(super) freedom: usize,
    pub(super) speed: usize,
    pub(super) joint: String,
    /// At the joint's degree of freedom, and at its ports.
    pub(super) frictions: Vec<Friction>,
    lower: Option<f64>,
    upper: Option<f64>,
    /// Whose limits these are, where they are not its own.
    of: [Option<LimitOf>; 2],
    pub(super) restitution: f64,
}

/// Efforts of friction.
#[derive(Clone, Debug)]
pub(super) struct Friction {
    sliding: f64,
    sticking: f64,
    place: Place,
}

/// Where an effort of friction acts.
#[derive(Clone, Debug)]
enum Place {
    /// At the joint's only degree of freedom.
    Freedom,
    /// At a port of the joint, whose Q stands there among all.
    Port {
        joint: Arc<dyn AnyJoint>,
        configuration: Range<usize>,
        port: usize,
    },
}

impl Place {
    /// The rate there over v: P of a port.
    fn ratio(&self, q: &[f64]) -> f64 {
        match self {
            Self::Freedom => 1.0,
            Self::Port {
                joint,
                configuration,
                port,
            } => {
                let mut row = [f64::NAN];
                joint.port_row(&q[configuration.clone()], *port, &mut row);
                row[0]
            }
        }
    }

    /// By what an effort of one unit against the motion acts on v: `|P|`.
    fn weight(&self, q: &[f64]) -> f64 {
        self.ratio(q).abs()
    }
}

/// An effort of friction at a joint that slides.
#[derive(Clone, Debug)]
pub(crate) struct Sliding {
    freedom: usize,
    effort: f64,
    place: Place,
}

impl Sliding {
    /// Adds it to τ at the configuration of all joints.
    pub(crate) fn add(&self, q: &[f64], efforts: &mut [f64]) {
        efforts[self.freedom] += self.effort * self.place.weight(q);
    }
}

impl Contact {
    /// All of a mechanism, in the order of its joints.
    pub(super) fn all(mechanism: &Mechanism) -> Vec<Self> {
        let joints = mechanism.joints();
        let contacts = joints.filter_map(|(index, body)| {
            let own = |at: usize| mechanism.leader(at) == index;
            let frictions = mechanism.frictions().iter();
            // Friction that holds nothing is none.
            let ranges = body.ranges();
            let frictions: Vec<Friction> = frictions
                .filter(|friction| own(friction.body) && friction.sticking > 0.0)
                .map(|friction| Friction {
                    sliding: friction.sliding,
                    sticking: friction.sticking,
                    place: friction.port.map_or(Place::Freedom, |port| Place::Port {
                        joint: body.shared_joint(),
                        configuration: ranges.configuration.clone(),
                        port,
                    }),
                })
                .collect();
            let stop = mechanism.stops().iter().find(|stop| own(stop.body));
            if frictions.is_empty() && stop.is_none() {
                return None;
            }
            Some(Self {
                body: index,
                coordinate: ranges.configuration.start,
                freedom: ranges.freedoms.start,
                speed: ranges.speeds.start,
                joint: body.joint_name().into(),
                frictions,
                lower: stop.and_then(|stop| stop.lower),
                upper: stop.and_then(|stop| stop.upper),
                of: stop.map_or([None, None], |stop| stop.of.clone()),
                restitution: stop.map_or(0.0, |stop| stop.restitution),
            })
        });
        contacts.collect()
    }

    /// One that is at a lower limit of 0.
    #[cfg(test)]
    pub(super) fn bouncing(index: usize, restitution: f64) -> Self {
        Self {
            body: index,
            coordinate: index,
            freedom: index,
            speed: index,
            joint: String::from("joint"),
            frictions: Vec::new(),
            lower: Some(0.0),
            upper: None,
            of: [None, None],
            restitution,
        }
    }

    pub(super) const fn limit(&self, side: Side) -> Option<f64> {
        match side {
            Side::Lower => self.lower,
            Side::Upper => self.upper,
        }
    }

    /// What messages call a limit: the joint, and which of its limits it is.
    pub(super) fn told(&self, side: Side) -> (&str, &'static str) {
        let [lower, upper] = &self.of;
        let of = match side {
            Side::Lower => lower,
            Side::Upper => upper,
        };
        let Some(LimitOf { joint, is_upper }) = of else {
            return (&self.joint, side.name());
        };
        let side = if *is_upper { Side::Upper } else { Side::Lower };
        (joint, side.name())
    }

    /// The limit at which it exactly is.
    pub(super) fn at(&self, q: &[f64]) -> Option<Side> {
        let is_there = |side: &Side| self.limit(*side) == Some(q[self.coordinate]);
        Side::BOTH.into_iter().find(is_there)
    }

    /// Whether friction acts on it.
    pub(super) const fn has_friction(&self) -> bool {
        !self.frictions.is_empty()
    }

    /// Whether friction acts at one of its ports.
    pub(super) fn has_friction_at_ports(&self) -> bool {
        let mut frictions = self.frictions.iter();
        frictions.any(|friction| matches!(friction.place, Place::Port { .. }))
    }

    /// Efforts on v that may act on it at rest at the configuration `q` of all joints, by friction and limits.
    pub(super) fn bounds(&self, q: &[f64], is_slipping: bool) -> (f64, f64) {
        let each = self.frictions.iter().map(|friction| {
            let effort = match is_slipping {
                true => friction.sliding,
                false => friction.sticking,
            };
            effort * friction.place.weight(q)
        });
        let most: f64 = each.sum();
        match self.at(q) {
            None => (-most, most),
            Some(Side::Lower) => (-most, f64::INFINITY),
            Some(Side::Upper) => (f64::NEG_INFINITY, most),
        }
    }

    /// The efforts of its friction at ports in motion.
    pub(super) fn sliding_at_ports(
        &self,
        q: &[f64],
        forward: bool,
    ) -> impl Iterator<Item = EffortAtPort> {
        let sign = against(forward);
        self.at_ports(q, move |friction| sign * friction.sliding)
    }

    /// The efforts of friction at ports that hold it by `effort` on v: each place takes as much of what it can hold as the others.
    pub(super) fn sticking_at_ports(
        &self,
        q: &[f64],
        effort: f64,
    ) -> impl Iterator<Item = EffortAtPort> {
        let (_, most) = self.bounds(q, false);
        let part = if most > 0.0 { effort / most } else { 0.0 };
        self.at_ports(q, move |friction| part * friction.sticking)
    }

    /// Efforts at those of its places that are ports, of friction that acts by `effort` towards larger v.
    fn at_ports(
        &self,
        q: &[f64],
        effort: impl Fn(&Friction) -> f64,
    ) -> impl Iterator<Item = EffortAtPort> {
        self.frictions.iter().filter_map(move |friction| {
            let Place::Port { port, .. } = friction.place else {
                return None;
            };
            Some(EffortAtPort {
                body: self.body,
                port,
                effort: effort(friction) * friction.place.ratio(q).signum(),
            })
        })
    }

    /// The efforts of its friction in motion.
    pub(super) fn sliding_efforts(&self, forward: bool) -> impl Iterator<Item = Sliding> {
        let sign = against(forward);
        self.frictions.iter().map(move |friction| Sliding {
            freedom: self.freedom,
            effort: sign * friction.sliding,
            place: friction.place.clone(),
        })
    }
}

/// The sign of what acts against the motion.
const fn against(forward: bool) -> f64 {
    if forward { -1.0 } else { 1.0 }
}
