//! Dry friction and limits of a joint: what makes a motion go by pieces.
//!
//! Neither is an [`Element`](super::Element): the equations of motion of a mechanism know nothing of them. A motion through them is made of smooth
//! pieces, between which a joint begins or ceases to stick, or hits its limit; the integrator tells these apart.

use super::ElementError;
use super::error::body;
use super::is_one_coordinate;
use super::port::known as known_port;
use crate::erased::AnyJoint;
use crate::mechanism::{Body, Mechanism};
use alloc::string::String;

/// Coulomb's dry friction at a joint with one degree of freedom, or at one of its ports.
///
/// While the joint moves, an effort of the size `sliding` acts against its speed, or against the rate of the port. At rest the joint takes whatever effort holds
/// it, up to `sticking` there: at a port with the rate P v this is `|P|` times as much on v.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFriction {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint it is.
    pub body: usize,
    /// Index of the port among those of the joint; `None` for its degree of freedom.
    pub port: Option<usize>,
    /// Effort of friction in motion, N m or N.
    pub sliding: f64,
    /// Largest effort of friction at rest, N m or N; not less than `sliding`.
    pub sticking: f64,
}

/// Limits of a joint with one degree of freedom, with Newton's law of impact: the speed after it is `−restitution` times that before.
#[derive(Clone, Debug, PartialEq)]
pub struct JointStop {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint it is.
    pub body: usize,
    /// Least value of the coordinate, rad or m, if there is one.
    pub lower: Option<f64>,
    /// Largest value of the coordinate, rad or m, if there is one.
    pub upper: Option<f64>,
    /// From 0, which takes all of the joint's speed, to 1, which takes none.
    pub restitution: f64,
    /// Whose limits the lower and the upper one are, where they are not the joint's own.
    pub of: [Option<LimitOf>; 2],
}

/// The limit of a joint that is one of several bodies of another: a joint that follows, or one that is followed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LimitOf {
    /// Name of the joint, for messages.
    pub joint: String,
    /// Whether it is its upper limit.
    pub is_upper: bool,
}

impl JointFriction {
    /// Whether the friction fits the mechanism.
    ///
    /// # Errors
    /// A body or a port that is not there; a joint with more than one degree of freedom, or one whose motion is prescribed; efforts out of range.
    pub fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let name = &self.name;
        let owner = body(name, mechanism, self.body)?;
        let fits = match has_one_freedom(owner.joint()) {
            true => Ok(()),
            false => Err("has not a single degree of freedom: give dampers"),
        };
        check_joint(name, mechanism, self.body, fits)?;
        if let Some(port) = self.port {
            known_port(name, mechanism, self.body, port)?;
        }
        let sliding = self.sliding;
        let allowed = sliding.is_finite() && sliding >= 0.0;
        require(name, "sliding", sliding, allowed, "finite and not negative")?;
        let sticking = self.sticking;
        let allowed = sticking.is_finite() && sticking >= sliding;
        require(
            name,
            "sticking",
            sticking,
            allowed,
            "finite and not less than the friction in motion",
        )
    }
}

impl JointStop {
    /// Whether the limits fit the mechanism.
    ///
    /// # Errors
    /// A body that is not there; a joint of another kind, or one whose motion is prescribed; limits that are not finite or out of order, or
    /// none; a restitution out of range.
    pub fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let name = &self.name;
        let owner = body(name, mechanism, self.body)?;
        let fits = match is_one_coordinate(owner.joint()) {
            true => Ok(()),
            false => Err(
                "is not one of a single coordinate whose rate is its speed, as a revolute, a prismatic or a screw joint is",
            ),
        };
        let owner = check_joint(name, mechanism, self.body, fits)?;
        if self.lower.is_none() && self.upper.is_none() {
            return Err(ElementError::Joint {
                element: name.clone(),
                joint: owner.joint_name().into(),
                reason: "has neither a lower nor an upper limit",
            });
        }
        let lower = self.lower.unwrap_or(f64::MIN);
        let upper = self.upper.unwrap_or(f64::MAX);
        require(name, "lower", lower, lower.is_finite(), "finite")?;
        let allowed = upper.is_finite() && upper > lower;
        let requirement = "finite and above the lower limit";
        require(name, "upper", upper, allowed, requirement)?;
        let restitution = self.restitution;
        let allowed = (0.0..=1.0).contains(&restitution);
        require(name, "restitution", restitution, allowed, "from 0 to 1")
    }
}

/// Whether a joint moves in one way, and nothing forbids it.
pub fn has_one_freedom(joint: &dyn AnyJoint) -> bool {
    let layout = joint.layout();
    (layout.freedoms, layout.speeds, layout.constraints) == (1, 1, 0)
}

/// The body, if its joint `fits` and moves freely.
fn check_joint<'a>(
    element: &str,
    mechanism: &'a Mechanism,
    index: usize,
    fits: Result<(), &'static str>,
) -> Result<&'a Body, ElementError> {
    let owner = body(element, mechanism, index)?;
    let reason = if let Err(reason) = fits {
        reason
    } else if mechanism.is_driven(index) {
        "has a prescribed motion, which neither friction nor limits can change"
    } else if mechanism
        .dependent_speeds()
        .contains(&owner.ranges().speeds.start)
    {
        "has a speed that constraints make depend on others: give friction and limits before constraints"
    } else {
        return Ok(owner);
    };
    Err(ElementError::Joint {
        element: element.into(),
        joint: owner.joint_name().into(),
        reason,
    })
}

fn require(
    element: &str,
    quantity: &'static str,
    value: f64,
    allowed: bool,
    requirement: &'static str,
) -> Result<(), ElementError> {
    if allowed {
        return Ok(());
    }
    Err(ElementError::Value {
        element: element.into(),
        quantity,
        value,
        requirement,
    })
}
