//! What acts at ports of joints: efforts, springs and dampers at angles and lengths that are none of the joint's local coordinates.
//!
//! An effort f at a port with the rate w = P v is `τ = Pᵀ f` in v, so that its power is `f w`.

use super::error::{body, functions, values};
use super::{Action, Curvature, Curvatures, Element, ElementError, Slope, Slopes, View};
use crate::joint::{MOST_FREEDOMS, Port, PortLaw};
use crate::mechanism::Mechanism;
use crate::steps::EffortLaw;
use crate::time_function::{Moment, TimeFunction};
use alloc::string::String;
use core::slice;

/// An effort at a port, constant or a function of time.
#[derive(Clone, Debug)]
pub struct PortEffort {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint has the port.
    pub body: usize,
    /// Index of the port among those of the joint.
    pub port: usize,
    /// f, N·m or N.
    pub effort: TimeFunction,
}

/// A spring with a damper at a port: `f = −k x − c w`, with x the [deflection](Port::deflection) from rest.
///
/// At a port that wraps, f jumps where the deflection is half a turn.
#[derive(Clone, Debug)]
pub struct PortSpring {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint has the port.
    pub body: usize,
    /// Index of the port among those of the joint.
    pub port: usize,
    /// k, N·m/rad or N/m; not negative.
    pub stiffness: f64,
    /// c, N·m·s/rad or N·s/m; not negative.
    pub damping: f64,
    /// The value of the port at which it is at rest, rad or m.
    pub rest: f64,
}

/// The port, if the joint under a body has one of that index.
pub(super) fn known(
    element: &str,
    mechanism: &Mechanism,
    index: usize,
    port: usize,
) -> Result<&'static Port, ElementError> {
    let body = body(element, mechanism, index)?;
    let ports = body.joint().ports();
    ports.get(port).ok_or_else(|| ElementError::UnknownPort {
        element: element.into(),
        joint: body.joint_name().into(),
        index: port,
        count: ports.len(),
    })
}

impl Element for PortEffort {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        known(&self.name, mechanism, self.body, self.port)?;
        functions(&self.name, "effort", slice::from_ref(&self.effort), 1)
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        let effort = self.effort.value(view.moment);
        action.add_port_effort(view, self.body, self.port, effort);
    }

    fn energy(&self, _view: &View<'_>) -> f64 {
        0.0
    }

    fn power(&self, view: &View<'_>) -> f64 {
        let (_, rate) = view.port(self.body, self.port);
        self.effort.value(view.moment) * rate
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }

    fn port_effort(&self, view: &View<'_>) -> Option<(usize, usize, f64)> {
        Some((self.body, self.port, self.effort.value(view.moment)))
    }

    fn timed_port_effort(&self, at: Moment) -> Option<(usize, usize, f64)> {
        let is_timed = self.effort.constant().is_none();
        is_timed.then(|| (self.body, self.port, self.effort.value(at)))
    }

    fn functions(&self) -> &[TimeFunction] {
        match self.effort.constant() {
            Some(_) => &[],
            None => slice::from_ref(&self.effort),
        }
    }
}

impl PortEffort {
    /// How its effort changes with the value and the rate of the port.
    fn law(&self, view: &View<'_>) -> PortLaw<f64> {
        PortLaw {
            effort: self.effort.value(view.moment),
            stiffness: 0.0,
            damping: 0.0,
        }
    }
}

impl Slope for PortEffort {
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        add_slopes((self.body, self.port), &self.law(view), view, slopes);
    }
}

impl Curvature for PortEffort {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        add_curvatures((self.body, self.port), self.law(view), view, curvatures);
    }
}

impl PortSpring {
    /// x and f; NaN of a port that is not there.
    fn now(&self, view: &View<'_>) -> (f64, f64) {
        let (value, rate) = view.port(self.body, self.port);
        let ports = view.joint(self.body).map_or(&[][..], |joint| joint.ports());
        let port = ports.get(self.port);
        let way = port.map_or(f64::NAN, |port| port.deflection(value, self.rest));
        (way, -self.stiffness * way - self.damping * rate)
    }

    /// How its effort changes with the value and the rate of the port.
    fn law(&self, view: &View<'_>) -> PortLaw<f64> {
        PortLaw {
            effort: self.now(view).1,
            stiffness: self.stiffness,
            damping: self.damping,
        }
    }
}

impl Element for PortSpring {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        known(&self.name, mechanism, self.body, self.port)?;
        values(&self.name, "stiffness", &[self.stiffness], 1, false)?;
        values(&self.name, "damping", &[self.damping], 1, false)?;
        values(&self.name, "rest", &[self.rest], 1, true)
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        let (_, effort) = self.now(view);
        action.add_port_effort(view, self.body, self.port, effort);
    }

    fn energy(&self, view: &View<'_>) -> f64 {
        let (way, _) = self.now(view);
        0.5 * self.stiffness * way * way
    }

    fn power(&self, view: &View<'_>) -> f64 {
        let (_, rate) = view.port(self.body, self.port);
        -self.damping * rate * rate
    }

    fn port_effort(&self, view: &View<'_>) -> Option<(usize, usize, f64)> {
        Some((self.body, self.port, self.now(view).1))
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }
}

impl Slope for PortSpring {
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        add_slopes((self.body, self.port), &self.law(view), view, slopes);
    }
}

impl Curvature for PortSpring {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        add_curvatures((self.body, self.port), self.law(view), view, curvatures);
    }
}

/// Adds the second derivatives of `τ = Pᵀ f`.
fn add_curvatures(
    (body, port): (usize, usize),
    law: PortLaw<f64>,
    view: &View<'_>,
    curvatures: &mut Curvatures<'_>,
) {
    let law = EffortLaw::Axis {
        port: Some(port),
        law,
        product: 0.0,
    };
    curvatures.add_effort(view, body, &law);
}

/// Adds the slopes of `τ = Pᵀ f`.
pub(super) fn add_slopes(
    (body, port): (usize, usize),
    law: &PortLaw<f64>,
    view: &View<'_>,
    slopes: &mut Slopes<'_>,
) {
    let Some((joint, q)) = view.joint_and_configuration(body) else {
        return slopes.add_effort(view, body, &[], &[]);
    };
    let (mut velocity, mut row) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
    let velocity = view.joint_velocity(body, &mut velocity);
    let size = velocity.len();
    let (mut by_local, mut by_velocity) = (
        [0.0; MOST_FREEDOMS * MOST_FREEDOMS],
        [0.0; MOST_FREEDOMS * MOST_FREEDOMS],
    );
    joint.port_slope(q, velocity, port, law, &mut by_local[..size * size]);
    let row = &mut row[..size];
    joint.port_row(q, port, row);
    for (column, p) in by_velocity.chunks_exact_mut(size.max(1)).zip(row.iter()) {
        for (entry, own) in column.iter_mut().zip(row.iter()) {
            *entry = -law.damping * own * p;
        }
    }
    slopes.add_effort(view, body, &by_local, &by_velocity);
}
