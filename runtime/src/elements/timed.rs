//! Efforts and wrenches that are functions of time.

use super::body::{Pull, add_wrench_curvatures, add_wrench_slopes};
use super::error::{body, functions, values};
use super::{
    Action, Curvature, Curvatures, Element, ElementError, Slope, Slopes, View, WrenchAxes,
};
use crate::mechanism::Mechanism;
use crate::time_function::TimeFunction;
use alloc::string::String;
use alloc::vec::Vec;
use nalgebra::Vector3;

/// Efforts of the actuators of a joint as functions of time. They are part of τ: whoever evaluates the equations of motion at a time adds them by
/// [`Mechanism::add_timed_efforts`].
#[derive(Clone, Debug)]
pub struct TimedEffort {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint is driven.
    pub body: usize,
    /// τ, one entry per freedom: N·m or N.
    pub efforts: Vec<TimeFunction>,
}

impl TimedEffort {
    /// Whether the efforts fit the mechanism.
    ///
    /// # Errors
    /// A body that is not there, a wrong number of efforts, a number that is not finite.
    pub fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let body = body(&self.name, mechanism, self.body)?;
        let freedoms = body.ranges().freedoms.len();
        functions(&self.name, "effort", &self.efforts, freedoms)
    }
}

/// A force and moment on a body, from outside, as functions of time.
#[derive(Clone, Debug)]
pub struct TimedWrench {
    /// Name, for messages.
    pub name: String,
    /// The body.
    pub body: usize,
    /// Where the force acts, in the body frame, m.
    pub point: Vector3<f64>,
    /// Force, N, then the moment beside that of the force, N·m.
    pub entries: [TimeFunction; 6],
    /// The axes of both.
    pub axes: WrenchAxes,
}

impl TimedWrench {
    /// What it is at the time of the view.
    fn now(&self, view: &View<'_>) -> Pull<'_> {
        let [fx, fy, fz, mx, my, mz] = self.entries.each_ref().map(|f| f.value(view.moment));
        Pull {
            body: self.body,
            point: &self.point,
            force: Vector3::new(fx, fy, fz),
            moment: Vector3::new(mx, my, mz),
            axes: self.axes,
        }
    }
}

impl Element for TimedWrench {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        body(&self.name, mechanism, self.body)?;
        values(&self.name, "point", self.point.as_slice(), 3, true)?;
        functions(&self.name, "wrench", &self.entries, 6)
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        self.now(view).act(view, action);
    }

    /// Work depends on the path in general: none is counted.
    fn energy(&self, _view: &View<'_>) -> f64 {
        0.0
    }

    fn power(&self, view: &View<'_>) -> f64 {
        self.now(view).power(view)
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }

    fn functions(&self) -> &[TimeFunction] {
        &self.entries
    }
}

impl Slope for TimedWrench {
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        add_wrench_slopes(&self.now(view), view, slopes);
    }
}

impl Curvature for TimedWrench {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        add_wrench_curvatures(&self.now(view), view, curvatures);
    }
}
