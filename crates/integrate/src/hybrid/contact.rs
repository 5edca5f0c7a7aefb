//! The joints whose motion goes by pieces, and what each of them does in a piece.

use alloc::string::String;
use alloc::vec::Vec;
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
    pub(super) friction: Option<Friction>,
    lower: Option<f64>,
    upper: Option<f64>,
    pub(super) restitution: f64,
}

/// Efforts of friction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Friction {
    pub(super) sliding: f64,
    pub(super) sticking: f64,
}

impl Contact {
    /// All of a mechanism, in the order of its joints.
    pub(super) fn all(mechanism: &Mechanism) -> Vec<Self> {
        let joints = mechanism.joints();
        let contacts = joints.filter_map(|(index, body)| {
            let own = |at: usize| mechanism.leader(at) == index;
            let frictions = mechanism.frictions().iter();
            // Friction that holds nothing is none.
            let friction = frictions
                .filter(|friction| own(friction.body) && friction.sticking > 0.0)
                .map(|friction| Friction {
                    sliding: friction.sliding,
                    sticking: friction.sticking,
                })
                .next();
            let stop = mechanism.stops().iter().find(|stop| own(stop.body));
            if friction.is_none() && stop.is_none() {
                return None;
            }
            let ranges = body.ranges();
            Some(Self {
                body: index,
                coordinate: ranges.configuration.start,
                freedom: ranges.freedoms.start,
                speed: ranges.speeds.start,
                joint: body.joint_name().into(),
                friction,
                lower: stop.and_then(|stop| stop.lower),
                upper: stop.and_then(|stop| stop.upper),
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
            friction: None,
            lower: Some(0.0),
            upper: None,
            restitution,
        }
    }

    pub(super) const fn limit(&self, side: Side) -> Option<f64> {
        match side {
            Side::Lower => self.lower,
            Side::Upper => self.upper,
        }
    }

    /// The limit at which it exactly is.
    pub(super) fn at(&self, q: &[f64]) -> Option<Side> {
        let is_there = |side: &Side| self.limit(*side) == Some(q[self.coordinate]);
        Side::BOTH.into_iter().find(is_there)
    }

    /// Efforts that may act on it at rest, where friction holds up to `most`.
    pub(super) fn bounds(&self, at: Option<Side>, is_slipping: bool) -> (f64, f64) {
        let most = self.friction.map_or(0.0, |friction| match is_slipping {
            true => friction.sliding,
            false => friction.sticking,
        });
        match at {
            None => (-most, most),
            Some(Side::Lower) => (-most, f64::INFINITY),
            Some(Side::Upper) => (f64::NEG_INFINITY, most),
        }
    }

    /// The effort of its friction in motion.
    pub(super) fn sliding_effort(&self, forward: bool) -> f64 {
        let size = self.friction.map_or(0.0, |friction| friction.sliding);
        if forward { -size } else { size }
    }
}
