//! Dampers and actuators at a joint.

use super::error::{body, values};
use super::{Action, Curvature, Curvatures, Element, ElementError, Slope, Slopes, View};
use crate::joint::MOST_FREEDOMS;
use crate::mechanism::Mechanism;
use crate::steps::EffortLaw;
use alloc::string::String;
use alloc::vec::Vec;

/// `τ = −c v`, degree of freedom by degree of freedom.
#[derive(Clone, Debug)]
pub struct JointDamper {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint it damps.
    pub body: usize,
    /// c, one entry per freedom: N·m·s/rad or N·s/m; not negative.
    pub coefficients: Vec<f64>,
}

impl Element for JointDamper {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let freedoms = body(&self.name, mechanism, self.body)?
            .ranges()
            .freedoms
            .len();
        values(&self.name, "damping", &self.coefficients, freedoms, false)
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        let (mut velocity, mut effort) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
        let velocity = view.joint_velocity(self.body, &mut velocity);
        let effort = &mut effort[..velocity.len()];
        for ((effort, c), v) in effort.iter_mut().zip(&self.coefficients).zip(velocity) {
            *effort = -c * v;
        }
        action.add_effort(view, self.body, effort);
    }

    fn energy(&self, _view: &View<'_>) -> f64 {
        0.0
    }

    fn power(&self, view: &View<'_>) -> f64 {
        let mut velocity = [0.0; MOST_FREEDOMS];
        let velocity = view.joint_velocity(self.body, &mut velocity);
        let losses = self.coefficients.iter().zip(velocity);
        -losses.map(|(c, v)| c * v * v).sum::<f64>()
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }
}

impl Slope for JointDamper {
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        let size = self.coefficients.len();
        let mut by_velocity = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let diagonal = by_velocity.iter_mut().step_by(size + 1);
        for (entry, c) in diagonal.zip(&self.coefficients) {
            *entry = -c;
        }
        slopes.add_effort(
            view,
            self.body,
            &[0.0; MOST_FREEDOMS * MOST_FREEDOMS],
            &by_velocity,
        );
    }
}

impl Curvature for JointDamper {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        curvatures.add_effort(view, self.body, &EffortLaw::Damper(&self.coefficients));
    }
}

/// Constant efforts of the actuators of a joint.
#[derive(Clone, Debug)]
pub struct JointEffort {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint is driven.
    pub body: usize,
    /// τ, one entry per freedom: N·m or N.
    pub efforts: Vec<f64>,
}

impl Element for JointEffort {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let freedoms = body(&self.name, mechanism, self.body)?
            .ranges()
            .freedoms
            .len();
        values(&self.name, "effort", &self.efforts, freedoms, true)
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        action.add_effort(view, self.body, &self.efforts);
    }

    fn energy(&self, _view: &View<'_>) -> f64 {
        0.0
    }

    fn power(&self, view: &View<'_>) -> f64 {
        let mut velocity = [0.0; MOST_FREEDOMS];
        let velocity = view.joint_velocity(self.body, &mut velocity);
        self.efforts.iter().zip(velocity).map(|(t, v)| t * v).sum()
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }
}

impl Slope for JointEffort {
    fn add_slopes(&self, _view: &View<'_>, _slopes: &mut Slopes<'_>) {}
}

impl Curvature for JointEffort {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        curvatures.add_effort(view, self.body, &EffortLaw::Constant(&self.efforts));
    }
}
