//! Checks of a state against its mechanism, what is not finite of it, and projection onto the joints' manifolds.

use super::{Body, Loci, Mechanism, Ranges, StateError};
use crate::erased::{AnyJoint, FiniteMapError};
use crate::joint::MOST_FREEDOMS;
use crate::scalar::all_finite;
use alloc::string::String;
use core::ops::Range;

/// Largest residual of a joint's relations that is taken for rounding of the input.
pub const CONFIGURATION_TOLERANCE: f64 = 1e-9;

/// The owner of vectors that hold all joints' shares.
pub const WHOLE: &str = "the mechanism";

/// A vector's size against what it must be; `element` owns it.
pub fn check_size(
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

/// What a vector of all joints has an entry for.
#[derive(Clone, Copy, Debug)]
pub enum Space {
    /// Each stored scalar of Q.
    Configuration,
    /// Each freedom: v, ϕ, τ.
    Freedoms,
    /// Each speed: v̄, p̄ and their rates.
    Speeds,
}

impl Space {
    fn size(self, mechanism: &Mechanism) -> usize {
        let layout = &mechanism.layout;
        match self {
            Self::Configuration => layout.configuration,
            Self::Freedoms => layout.freedoms,
            Self::Speeds => layout.speeds,
        }
    }

    /// Where a joint's share lies.
    pub(crate) fn range(self, ranges: &Ranges) -> Range<usize> {
        match self {
            Self::Configuration => ranges.configuration.clone(),
            Self::Freedoms => ranges.freedoms.clone(),
            Self::Speeds => ranges.speeds.clone(),
        }
    }

    /// Names of a joint's entries.
    pub(crate) fn names(self, joint: &dyn AnyJoint) -> &'static [&'static str] {
        match self {
            Self::Configuration => joint.coordinates(),
            Self::Freedoms => joint.freedoms(),
            Self::Speeds => joint.speeds(),
        }
    }
}

impl Body {
    /// The joint's own failure, with its name in the mechanism.
    pub fn finite_map(&self, cause: FiniteMapError) -> StateError {
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

impl Body {
    /// The first of the joint's kernels that is not finite at its own `q` and v̄.
    fn no_value(&self, q: &[f64], speeds: &[f64]) -> Option<&'static str> {
        let finite = |size: usize, fill: &dyn Fn(&mut [f64])| {
            let mut entries = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
            fill(&mut entries[..size]);
            all_finite(&entries[..size])
        };
        let (joint, k, s) = (
            self.joint(),
            self.ranges.freedoms.len(),
            self.ranges.speeds.len(),
        );
        if !joint.pose(q).is_finite() {
            return Some("pose");
        }
        if !finite(6 * k, &|out| joint.twist_map_child(q, out)) {
            return Some("twist map");
        }
        if !finite(k * s, &|out| joint.speed_basis(q, out)) {
            return Some("speed basis");
        }
        if !finite(k * k, &|out| joint.velocity_map_inverse(q, out)) {
            return Some("velocity map");
        }
        let bias = joint.bias_acceleration(q, speeds);
        (!all_finite(bias.as_slice())).then_some("velocity product")
    }

    /// Says that something of the joint is not finite.
    pub fn without_value(&self, what: &'static str) -> StateError {
        StateError::NoValue {
            joint: self.joint_name().into(),
            what,
        }
    }
}

impl Mechanism {
    /// Whether a vector of all joints has the right size and is finite; `quantity` says what it is.
    #[inline]
    pub fn check_vector(
        &self,
        quantity: &'static str,
        space: Space,
        values: &[f64],
    ) -> Result<(), StateError> {
        check_size(WHOLE, quantity, space.size(self), values.len())?;
        match all_finite(values) {
            true => Ok(()),
            false => self.not_finite(quantity, space, values),
        }
    }

    /// The first entry that is not finite.
    #[cold]
    fn not_finite(
        &self,
        quantity: &'static str,
        space: Space,
        values: &[f64],
    ) -> Result<(), StateError> {
        self.bodies.iter().try_for_each(|body| {
            let own = &values[space.range(&body.ranges)];
            body.check_finite(quantity, space.names(body.joint()), own)
        })
    }

    /// Whether room for results has the right size.
    #[inline]
    pub fn check_room(
        &self,
        quantity: &'static str,
        space: Space,
        room: &[f64],
    ) -> Result<(), StateError> {
        check_size(WHOLE, quantity, space.size(self), room.len())
    }

    /// The first joint, from the root on, of which a kernel is not finite at (q, v̄).
    pub(crate) fn no_value(&self, q: &[f64], speeds: &[f64]) -> Option<StateError> {
        self.bodies.iter().find_map(|body| {
            let speeds = speeds.get(body.ranges.speeds.clone())?;
            let what = body.no_value(body.configuration(q), speeds)?;
            Some(body.without_value(what))
        })
    }

    /// Whether results at (q, v̄) are finite: `what` says what they are. Where they are not, the first joint with a kernel that is not, else
    /// the first that has such a result.
    #[inline]
    pub fn check_finite(
        &self,
        (q, speeds): (&[f64], &[f64]),
        results: &[(&'static str, Space, &[f64])],
    ) -> Result<(), StateError> {
        match results.iter().all(|(.., values)| all_finite(values)) {
            true => Ok(()),
            false => self.no_result((q, speeds), results),
        }
    }

    /// What results at (q, v̄) that are not finite come from.
    #[cold]
    fn no_result(
        &self,
        (q, speeds): (&[f64], &[f64]),
        results: &[(&'static str, Space, &[f64])],
    ) -> Result<(), StateError> {
        if let Some(cause) = self.no_value(q, speeds) {
            return Err(cause);
        }
        let mut bodies = self.bodies.iter();
        let found = bodies.find_map(|body| {
            let mut results = results.iter();
            let is_finite = |space: &Space, values: &[f64]| {
                let own = values.get(space.range(&body.ranges));
                own.is_none_or(all_finite)
            };
            let found = results.find(|(_, space, values)| !is_finite(space, values));
            found.map(|(what, ..)| body.without_value(what))
        });
        found.map_or(Ok(()), Err)
    }

    /// Whether Q and the pose of every joint are finite at `q`.
    pub fn check_poses(&self, q: &[f64]) -> Result<(), StateError> {
        self.check_vector("configuration", Space::Configuration, q)?;
        self.bodies.iter().try_for_each(|body| {
            match body.joint().pose(body.configuration(q)).is_finite() {
                true => Ok(()),
                false => Err(body.without_value("pose")),
            }
        })
    }

    /// Whether `q` has the right size, is finite, lies on every joint's manifold to [`CONFIGURATION_TOLERANCE`], and on none
    /// of the sets where a joint is singular.
    ///
    /// # Errors
    /// The first joint that is refused, with its residual and the limit, or with the functions that vanish.
    pub fn check_configuration(&self, q: &[f64]) -> Result<(), StateError> {
        check_size(WHOLE, "configuration", self.layout.configuration, q.len())?;
        self.joints()
            .try_for_each(|(_, body)| body.check_configuration(body.configuration(q)))
    }

    /// Whether `speeds` (or momenta: `quantity` says which) has the right size and is finite.
    ///
    /// # Errors
    /// The first entry that is refused.
    pub fn check_speeds(&self, quantity: &'static str, speeds: &[f64]) -> Result<(), StateError> {
        self.check_vector(quantity, Space::Speeds, speeds)
    }

    /// Moves each joint's Q to the nearest point of its manifold.
    ///
    /// # Errors
    /// When `q` has the wrong size; when a projection fails, with the name of the joint.
    pub fn project(&self, q: &mut [f64]) -> Result<(), StateError> {
        check_size(WHOLE, "configuration", self.layout.configuration, q.len())?;
        for (_, body) in self.joints() {
            let own = &mut q[body.ranges.configuration.clone()];
            body.joint()
                .project(own)
                .map_err(|cause| body.finite_map(cause))?;
        }
        Ok(())
    }
}
