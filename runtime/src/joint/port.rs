//! Ports of joints: angles and lengths of Q, besides v, at which efforts act and rates are read.

use crate::scalar::Scalar;

/// A coordinate y(Q) of a joint: the angle of a motor inside a linkage. Its rate is w = P v, with its row of P(Q).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Port {
    /// Its name, unique in its joint.
    pub name: &'static str,
    /// `rad` or `m`.
    pub unit: &'static str,
    /// Whether its value is an angle up to whole turns, between −π and π.
    pub wraps: bool,
}

impl Port {
    /// How far the value is from `rest`, in its unit: the shortest way round where it wraps.
    pub fn deflection(&self, value: f64, rest: f64) -> f64 {
        let way = value - rest;
        match self.wraps {
            true => {
                let (sin, cos) = Scalar::sin_cos(way);
                Scalar::atan2(sin, cos)
            }
            false => way,
        }
    }
}

/// How what acts on a port changes with its value and rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PortLaw<T> {
    /// The effort f at the state, N·m or N.
    pub effort: T,
    /// −∂f/∂y.
    pub stiffness: T,
    /// −∂f/∂w.
    pub damping: T,
}
