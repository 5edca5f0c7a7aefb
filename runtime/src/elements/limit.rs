//! Compliant limits of a joint's coordinate or port.

use super::error::{body, values};
use super::port::{add_slopes, known};
use super::{Action, Curvature, Curvatures, Element, ElementError, Slope, Slopes, View};
use crate::erased::AnyJoint;
use crate::joint::{Port, PortLaw};
use crate::mechanism::Mechanism;
use crate::steps::EffortLaw;
use alloc::string::String;
use core::f64::consts::TAU;

/// A stop on either side of a joint's coordinate, which gives way: beyond it by x the effort towards the inside is `k x max(0, 1 + d ẋ)`
/// (K. H. Hunt and F. R. E. Crossley, *Coefficient of restitution interpreted as damping in vibroimpact*, 1975).
///
/// The effort is continuous and never pulls. It stores `½ k x²`. For joints whose Q is one coordinate q with `v = q̇`, where one that turns counts its
/// turns, and for ports of any joint.
#[derive(Clone, Debug)]
pub struct JointLimit {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint it limits.
    pub body: usize,
    /// Index of the port among those of the joint that it limits; `None` for its only coordinate.
    pub port: Option<usize>,
    /// The least q that is free, rad or m.
    pub lower: Option<f64>,
    /// The largest q that is free, rad or m.
    pub upper: Option<f64>,
    /// k, N·m/rad or N/m; not negative.
    pub stiffness: f64,
    /// d, s/rad or s/m; not negative.
    pub damping: f64,
}

/// How far the joint is beyond one of its limits.
struct Beyond {
    /// 1 beyond the upper one, −1 beyond the lower one.
    side: f64,
    /// x, positive.
    by: f64,
    /// ẋ.
    rate: f64,
}

impl JointLimit {
    /// How far a value is beyond the lower and the upper limit, negative within; −∞ where there is none. At a port that wraps by the shortest way round from
    /// the middle of the range, or from the only limit.
    fn excess(&self, value: f64, port: Option<&Port>) -> [f64; 2] {
        let from = |rest: f64| port.map_or(value - rest, |port| port.deflection(value, rest));
        if let (Some(lower), Some(upper), true) =
            (self.lower, self.upper, port.is_some_and(|port| port.wraps))
        {
            let half = 0.5 * (upper - lower);
            let way = from(lower + half);
            return [-way - half, way - half];
        }
        let none = f64::NEG_INFINITY;
        [
            self.lower.map_or(none, |lower| -from(lower)),
            self.upper.map_or(none, from),
        ]
    }

    /// The port that it limits.
    fn port_of(&self, joint: &dyn AnyJoint) -> Option<&'static Port> {
        joint.ports().get(self.port?)
    }

    /// `None` within the range; NaN of a body or port that is not there.
    fn beyond(&self, view: &View<'_>) -> Option<Beyond> {
        let (value, rate) = view.axis(self.body, self.port);
        let port = view.joint(self.body).and_then(|joint| self.port_of(joint));
        let [under, over] = self.excess(value, port);
        let side = match over >= under {
            true => 1.0,
            false => -1.0,
        };
        let by = over.max(under);
        let is_free = by <= 0.0 && !value.is_nan();
        (!is_free).then_some(Beyond {
            side,
            by: by + 0.0 * value,
            rate: side * rate,
        })
    }

    /// The effort at a place beyond.
    fn effort(&self, beyond: &Beyond) -> f64 {
        -beyond.side * self.stiffness * beyond.by * self.factor(beyond)
    }

    /// `max(0, 1 + d ẋ)`.
    fn factor(&self, beyond: &Beyond) -> f64 {
        match 1.0 + self.damping * beyond.rate {
            factor if factor < 0.0 => 0.0,
            factor => factor,
        }
    }
}

/// Whether Q of a joint is one coordinate whose rate is v.
pub fn is_one_coordinate(joint: &dyn AnyJoint) -> bool {
    let layout = joint.layout();
    if (layout.configuration, layout.freedoms, layout.constraints) != (1, 1, 0) {
        return false;
    }
    // At two places, exactly: a joint's own formulas give 1 and q + ϕ where they are these.
    [0.25_f64, 1.75].into_iter().all(|q| {
        let (mut moved, mut inverse) = ([0.0], [0.0]);
        joint.retract(&[q], &[0.5], &mut moved);
        joint.velocity_map_inverse(&[q], &mut inverse);
        moved == [q + 0.5] && inverse == [1.0]
    })
}

impl JointLimit {
    /// Whether the range of an angle up to whole turns has two ends and is less than a turn: beyond one end alone the effort would jump half a turn from it.
    fn check_turns(&self, port: &Port) -> Result<(), ElementError> {
        match (self.lower, self.upper) {
            (Some(lower), Some(upper)) if port.wraps && upper - lower >= TAU => {
                Err(ElementError::Value {
                    element: self.name.clone(),
                    quantity: "upper limit",
                    value: upper,
                    requirement: "less than a turn above the lower limit, at a port whose value is an angle up to whole turns",
                })
            }
            (Some(value), None) | (None, Some(value)) if port.wraps => Err(ElementError::Value {
                element: self.name.clone(),
                quantity: "limit",
                value,
                requirement: "one of two, lower and upper, at a port whose value is an angle up to whole turns",
            }),
            _ => Ok(()),
        }
    }
}

impl Element for JointLimit {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let body = body(&self.name, mechanism, self.body)?;
        if let Some(port) = self.port {
            let port = known(&self.name, mechanism, self.body, port)?;
            self.check_turns(port)?;
        } else if !is_one_coordinate(body.joint()) {
            return Err(ElementError::Joint {
                element: self.name.clone(),
                joint: body.joint_name().into(),
                reason: "is not one with a single coordinate whose rate is its speed",
            });
        }
        values(&self.name, "stiffness", &[self.stiffness], 1, false)?;
        values(&self.name, "damping", &[self.damping], 1, false)?;
        let limits = [self.lower, self.upper];
        for limit in limits.into_iter().flatten() {
            values(&self.name, "limit", &[limit], 1, true)?;
        }
        match limits {
            [Some(lower), Some(upper)] if lower > upper => Err(ElementError::Value {
                element: self.name.clone(),
                quantity: "lower limit",
                value: lower,
                requirement: "at most the upper limit",
            }),
            _ => Ok(()),
        }
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        if let Some(beyond) = self.beyond(view) {
            let effort = self.effort(&beyond);
            match self.port {
                Some(port) => action.add_port_effort(view, self.body, port, effort),
                None => action.add_effort(view, self.body, &[effort]),
            }
        }
    }

    fn energy(&self, view: &View<'_>) -> f64 {
        let beyond = self.beyond(view);
        beyond.map_or(0.0, |Beyond { by, .. }| 0.5 * self.stiffness * by * by)
    }

    fn power(&self, view: &View<'_>) -> f64 {
        let Some(beyond) = self.beyond(view) else {
            return 0.0;
        };
        let lost = 1.0 - self.factor(&beyond);
        self.stiffness * beyond.by * beyond.rate * lost
    }

    fn bends(&self, mechanism: &Mechanism, q: &[f64]) -> [f64; 2] {
        let Some(body) = mechanism.bodies().get(self.body) else {
            return [f64::NAN; 2];
        };
        let (joint, own) = (body.joint(), body.configuration(q));
        let value = match (self.port, own) {
            (Some(port), own) => joint.port_value(own, port),
            (None, &[value]) => value,
            _ => f64::NAN,
        };
        let excess = self.excess(value, self.port_of(joint));
        excess.map(|own| if own.is_finite() { own } else { f64::NAN })
    }

    fn port_effort(&self, view: &View<'_>) -> Option<(usize, usize, f64)> {
        let effort = self.beyond(view).map_or(0.0, |beyond| self.effort(&beyond));
        self.port.map(|port| (self.body, port, effort))
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }
}

impl Slope for JointLimit {
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        let Some(beyond) = self.beyond(view) else {
            return;
        };
        let factor = self.factor(&beyond);
        let by_rate = match factor > 0.0 {
            true => self.stiffness * beyond.by * self.damping,
            false => 0.0,
        };
        let by_value = self.stiffness * factor;
        match self.port {
            None => slopes.add_effort(view, self.body, &[-by_value], &[-by_rate]),
            Some(port) => {
                let law = PortLaw {
                    effort: self.effort(&beyond),
                    stiffness: by_value,
                    damping: by_rate,
                };
                add_slopes((self.body, port), &law, view, slopes);
            }
        }
    }
}

impl Curvature for JointLimit {
    /// Of the branch that it is on: where the effort bends, second derivatives jump.
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        let Some(beyond) = self.beyond(view) else {
            return;
        };
        let factor = self.factor(&beyond);
        let damping = match factor > 0.0 {
            true => self.stiffness * self.damping,
            false => 0.0,
        };
        let law = EffortLaw::Axis {
            port: self.port,
            law: PortLaw {
                effort: self.effort(&beyond),
                stiffness: self.stiffness * factor,
                damping: damping * beyond.by,
            },
            product: damping * beyond.side,
        };
        curvatures.add_effort(view, self.body, &law);
    }
}
