//! Checks of a state against its mechanism, and projection onto the joints' manifolds.

use super::{Body, Loci, Mechanism, StateError};
use crate::erased::FiniteMapError;
use alloc::string::String;

/// Largest residual of a joint's relations that is taken for rounding of the input.
pub const CONFIGURATION_TOLERANCE: f64 = 1e-9;

/// The owner of vectors that hold all joints' shares.
pub(crate) const WHOLE: &str = "the mechanism";

/// A vector's size against what it must be; `element` owns it.
pub(crate) fn check_size(
    element: &str,
    quantity: &'static str,
    expected: usize,
    found: usize,
) -> Result<(), StateError> {
    if found == expected {
        return Ok(());
    }
    Err(StateError::Size {
        element: String::from(element),
        quantity,
        expected,
        found,
    })
}

impl Body {
    /// The joint's own failure, with its name in the mechanism.
    pub(crate) fn finite_map(&self, cause: FiniteMapError) -> StateError {
        let joint = self.joint_name().into();
        StateError::FiniteMap { joint, cause }
    }

    /// Whether every value is finite; `names` tells the entries in the message.
    pub(super) fn check_finite(
        &self,
        quantity: &'static str,
        names: &[&'static str],
        values: &[f64],
    ) -> Result<(), StateError> {
        match names
            .iter()
            .zip(values)
            .find(|(_, value)| !value.is_finite())
        {
            Some((&entry, &value)) => Err(StateError::NotFinite {
                joint: self.joint_name().into(),
                quantity,
                entry,
                value,
            }),
            None => Ok(()),
        }
    }

    /// Whether `q`, this joint's Q alone, is finite, on the joint's manifold and not singular.
    pub(super) fn check_configuration(&self, q: &[f64]) -> Result<(), StateError> {
        let element = self.joint_name();
        check_size(
            element,
            "configuration",
            self.ranges.configuration.len(),
            q.len(),
        )?;
        self.check_finite("configuration", self.joint().coordinates(), q)?;
        let residual = self.joint().residual(q);
        if residual.is_nan() || residual > CONFIGURATION_TOLERANCE {
            return Err(StateError::OffManifold {
                joint: self.joint_name().into(),
                residual,
                limit: CONFIGURATION_TOLERANCE,
            });
        }
        match self.singular_value(q) {
            None => Ok(()),
            Some(value) => Err(StateError::Singular {
                joint: self.joint_name().into(),
                loci: Loci(self.joint().singularities()),
                value,
            }),
        }
    }
}

impl Mechanism {
    /// Whether `q` has the right size, is finite, lies on every joint's manifold to [`CONFIGURATION_TOLERANCE`], and on none
    /// of the sets where a joint is singular.
    ///
    /// # Errors
    /// The first joint that is refused, with its residual and the limit, or with the functions that vanish.
    pub fn check_configuration(&self, q: &[f64]) -> Result<(), StateError> {
        check_size(WHOLE, "configuration", self.layout.configuration, q.len())?;
        self.bodies
            .iter()
            .try_for_each(|body| body.check_configuration(body.configuration(q)))
    }

    /// Whether `speeds` (or momenta: `quantity` says which) has the right size and is finite.
    ///
    /// # Errors
    /// The first entry that is refused.
    pub fn check_speeds(&self, quantity: &'static str, speeds: &[f64]) -> Result<(), StateError> {
        check_size(WHOLE, quantity, self.layout.speeds, speeds.len())?;
        self.bodies.iter().try_for_each(|body| {
            let own = &speeds[body.ranges.speeds.clone()];
            body.check_finite(quantity, body.joint().speeds(), own)
        })
    }

    /// Moves each joint's Q to the nearest point of its manifold.
    ///
    /// # Errors
    /// When `q` has the wrong size; when a projection fails, with the name of the joint.
    pub fn project(&self, q: &mut [f64]) -> Result<(), StateError> {
        check_size(WHOLE, "configuration", self.layout.configuration, q.len())?;
        for body in &self.bodies {
            let own = &mut q[body.ranges.configuration.clone()];
            body.joint()
                .project(own)
                .map_err(|cause| body.finite_map(cause))?;
        }
        Ok(())
    }
}
