//! Compliant limits of a joint's coordinate.

use super::error::{body, values};
use super::{Action, Element, ElementError, Slope, Slopes, View};
use crate::erased::AnyJoint;
use crate::joint::MOST_FREEDOMS;
use crate::mechanism::Mechanism;
use alloc::string::String;

/// A stop on either side of a joint's coordinate, which gives way: beyond it by x the effort towards the inside is `k x max(0, 1 + d ẋ)`
/// (K. H. Hunt and F. R. E. Crossley, *Coefficient of restitution interpreted as damping in vibroimpact*, 1975).
///
/// The effort is continuous and never pulls. It stores `½ k x²`. For joints whose Q is one coordinate q with `v = q̇`; one that turns counts its
/// turns.
#[derive(Clone, Debug)]
pub struct JointLimit {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint it limits.
    pub body: usize,
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
    /// NaN of a body that is not there.
    fn beyond(&self, view: &View<'_>) -> Option<Beyond> {
        let mut velocity = [0.0; MOST_FREEDOMS];
        let velocity = view.joint_velocity(self.body, &mut velocity);
        let (q, v) = match (view.joint_configuration(self.body), velocity) {
            (&[q], &[v]) => (q, v),
            _ => (f64::NAN, f64::NAN),
        };
        let over = self.upper.map_or(f64::NEG_INFINITY, |upper| q - upper);
        let under = self.lower.map_or(f64::NEG_INFINITY, |lower| lower - q);
        let side = match over >= under {
            true => 1.0,
            false => -1.0,
        };
        let by = over.max(under);
        let is_free = by <= 0.0 && !q.is_nan();
        (!is_free).then_some(Beyond {
            side,
            by: by + 0.0 * q,
            rate: side * v,
        })
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

impl Element for JointLimit {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let body = body(&self.name, mechanism, self.body)?;
        if !is_one_coordinate(body.joint()) {
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
            let push = self.stiffness * beyond.by * self.factor(&beyond);
            action.add_effort(view, self.body, &[-beyond.side * push]);
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
        let body = mechanism.bodies().get(self.body);
        let own = body.and_then(|body| body.configuration(q).first());
        let beyond = |limit: Option<f64>, side: f64| match (own, limit) {
            (Some(own), Some(limit)) => side * (own - limit),
            _ => f64::NAN,
        };
        [beyond(self.lower, -1.0), beyond(self.upper, 1.0)]
    }

    fn slope(&self) -> Option<&dyn Slope> {
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
        slopes.add_effort(view, self.body, &[-self.stiffness * factor], &[-by_rate]);
    }
}
