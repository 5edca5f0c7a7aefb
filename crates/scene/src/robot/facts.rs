//! What the file of a robot says of a joint beyond its motion.

use hamel_runtime::shown::Number;

/// What a file says of a joint beyond its motion. Of it `damping` and `friction` are simulated, and limits of position where that is asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointFacts {
    /// Name of the joint.
    pub name: String,
    /// The `<limit>` element.
    pub limits: Option<Limits>,
    /// Viscous damping, N m s/rad or N s/m.
    pub damping: f64,
    /// Dry friction, N m or N.
    pub friction: f64,
}

impl JointFacts {
    /// What is not simulated of it, a line each.
    pub(crate) fn lines(&self) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(limits) = &self.limits {
            lines.extend(limits.line());
        }
        lines
    }
}

impl Limits {
    fn line(&self) -> Option<String> {
        let position = self
            .position
            .map(|[lower, upper]| format!("position {:?} to {:?}", Number(lower), Number(upper)));
        let velocity = self
            .velocity
            .map(|velocity| format!("velocity {:?}", Number(velocity)));
        let effort = self
            .effort
            .map(|effort| format!("effort {:?}", Number(effort)));
        let parts: Vec<String> = [position, velocity, effort].into_iter().flatten().collect();
        (!parts.is_empty()).then(|| format!("limits: {}", parts.join(", ")))
    }
}

/// Limits of a joint: rad or m, rad/s or m/s, N m or N.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Least and largest position.
    pub position: Option<[f64; 2]>,
    /// Largest velocity.
    pub velocity: Option<f64>,
    /// Largest effort.
    pub effort: Option<f64>,
}
