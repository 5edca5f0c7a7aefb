//! Friction and limits of joints in a mechanism, and the mechanism with some of its joints held.

use super::actuation::refuse;
use super::{CONFIGURATION_TOLERANCE, Mechanism, MechanismErrors, StateError};
use crate::elements::{Drive, ElementError, JointFriction, JointStop};
use crate::time_function::Law;
use alloc::format;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::Vector3;

impl Mechanism {
    /// The mechanism with this friction at joints instead of what it had; drives are to be given before, constraints that couple joints after.
    ///
    /// The equations of motion do not contain it: motions of `hamel_integrate` do, which switch between joints that stick and joints that slide.
    ///
    /// # Errors
    /// Everything that does not fit; friction given twice at one joint or port.
    pub fn with_frictions(
        mut self,
        frictions: Vec<JointFriction>,
    ) -> Result<Self, MechanismErrors> {
        let mut taken = Vec::new();
        let failures = frictions.iter().filter_map(|friction| {
            let place = (friction.body, friction.port);
            let twice = self.twice(&mut taken, place, &friction.name);
            friction.check(&self).err().or(twice)
        });
        refuse(failures)?;
        self.actuation.frictions = frictions;
        Ok(self)
    }

    /// The mechanism with these limits of joints instead of those it had; drives are to be given before, constraints that couple joints after.
    ///
    /// The equations of motion do not contain them: motions of `hamel_integrate` do.
    ///
    /// # Errors
    /// Everything that does not fit; limits given twice at one joint.
    pub fn with_stops(mut self, stops: Vec<JointStop>) -> Result<Self, MechanismErrors> {
        let mut taken = Vec::new();
        let failures = stops.iter().filter_map(|stop| {
            let twice = self.twice(&mut taken, (stop.body, None), &stop.name);
            stop.check(&self).err().or(twice)
        });
        refuse(failures)?;
        self.actuation.stops = stops;
        Ok(self)
    }

    /// That a joint, or a port of it, has what it has already.
    fn twice(
        &self,
        taken: &mut Vec<(usize, Option<usize>)>,
        (body, port): (usize, Option<usize>),
        element: &str,
    ) -> Option<ElementError> {
        let owner = self.bodies.get(body)?;
        let place = (self.leader(body), port);
        if !taken.contains(&place) {
            taken.push(place);
            return None;
        }
        Some(ElementError::Joint {
            element: element.into(),
            joint: owner.joint_name().into(),
            reason: "has it already",
        })
    }

    /// Dry friction at joints.
    pub fn frictions(&self) -> &[JointFriction] {
        &self.actuation.frictions
    }

    /// Limits of joints.
    pub fn stops(&self) -> &[JointStop] {
        &self.actuation.stops
    }

    /// Whether every joint of `q` is within its limits, to [`CONFIGURATION_TOLERANCE`] of the larger of 1 and the limit.
    ///
    /// # Errors
    /// The first joint that is not, with its coordinate and the limit; a wrong size.
    pub fn check_limits(&self, q: &[f64]) -> Result<(), StateError> {
        self.check_room("configuration", super::Space::Configuration, q)?;
        self.actuation.stops.iter().try_for_each(|stop| {
            let owner = &self.bodies[stop.body];
            let value = owner.configuration(q)[0];
            let room = |limit: f64| CONFIGURATION_TOLERANCE * limit.abs().max(1.0);
            let below = stop.lower.filter(|&lower| value < lower - room(lower));
            let above = stop.upper.filter(|&upper| value > upper + room(upper));
            let beyond = below.map(|limit| ("lower", limit));
            let Some((side, limit)) = beyond.or(above.map(|limit| ("upper", limit))) else {
                return Ok(());
            };
            Err(StateError::BeyondLimit {
                joint: owner.joint_name().into(),
                coordinate: owner.joint().coordinates().first().copied().unwrap_or(""),
                value,
                side,
                limit,
            })
        })
    }

    /// The mechanism with the joints under these bodies held where they are: driven at speed 0. Constraints that couple joints choose anew, at `q`,
    /// which speeds depend on the others.
    ///
    /// # Errors
    /// A joint that is driven already; a wrong size of `q`; constraints that the held joints leave nothing to be chosen for.
    pub fn held(&self, bodies: &[usize], q: &[f64]) -> Result<Self, MechanismErrors> {
        let mut free = self.clone();
        let constraints = core::mem::take(&mut free.actuation.constraints);
        free.actuation.dependent.clear();
        let mut drives = self.actuation.drives.clone();
        drives.extend(bodies.iter().map(|&body| {
            let owner = self.bodies.get(body);
            let speeds = owner.map_or(1, |owner| owner.ranges.speeds.len());
            let joint = owner.map_or("", |owner| owner.joint_name());
            Drive {
                name: format!("hold of joint `{joint}`"),
                body,
                laws: vec![Law::default().into(); speeds],
            }
        }));
        let held = free.with_drives(drives)?;
        match constraints.is_empty() {
            true => Ok(held),
            false => held.with_constraints(constraints, q),
        }
    }

    /// The mechanism without gravity and elements: at rest, its accelerations under efforts are `M̄⁻¹ S̄ᵀτ` and nothing else.
    #[must_use]
    pub fn without_loads(&self) -> Self {
        let mut bare = self.clone();
        bare.gravity = Vector3::zeros();
        bare.actuation.elements.clear();
        bare
    }
}
