//! Forbidden velocities of body points: constraints that couple joints.

use super::ElementError;
use super::error::{body, values};
use crate::mechanism::Mechanism;
use alloc::string::String;
use nalgebra::Vector3;

/// `dᵀ v_P = 0`: the velocity in the world of a point P of a body has no part along a direction d that is fixed in the body. A wheel or a
/// knife edge that does not slip sideways.
///
/// With S̄ of Theorem 3 the speeds of the tree are `v̄ = S̄(Q) v̄ᵢ`, where v̄ᵢ are the independent ones among them.
#[derive(Clone, Debug, PartialEq)]
pub struct PointConstraint {
    /// Name, for messages.
    pub name: String,
    /// The body.
    pub body: usize,
    /// P in the body frame, m.
    pub point: Vector3<f64>,
    /// d in body axes; its length does not matter: λ is the force along it, N.
    pub direction: Vector3<f64>,
}

impl PointConstraint {
    /// Whether the constraint fits the mechanism.
    ///
    /// # Errors
    /// A body that is not there, a number that is not finite, a direction of length 0.
    pub fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        body(&self.name, mechanism, self.body)?;
        values(&self.name, "point", self.point.as_slice(), 3, true)?;
        values(&self.name, "direction", self.direction.as_slice(), 3, true)?;
        let length = self.direction.norm();
        if length > 0.0 && length.is_finite() {
            return Ok(());
        }
        Err(ElementError::Value {
            element: self.name.clone(),
            quantity: "length of the direction",
            value: length,
            requirement: "positive and finite",
        })
    }
}
