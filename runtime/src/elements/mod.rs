//! What acts on a mechanism besides gravity and inputs: springs, dampers, actuators, external wrenches, user potentials, drives.
//!
//! An [`Element`] reads the motion of the mechanism from a [`View`] and adds efforts at joints and forces on bodies to an [`Action`].
//! Every form of the dynamics calls it at the same place, so that an element is written once. Elements belong to a
//! [`Mechanism`]: see [`Mechanism::with_elements`].

mod body;
mod constraint;
mod curvature;
mod drive;
mod error;
mod joint;
mod limit;
mod port;
mod slopes;
mod spring;
mod timed;
mod unilateral;
mod view;

pub use body::{BodySpring, BodyWrench, WrenchAxes};
pub use constraint::PointConstraint;
pub(crate) use curvature::Collected;
pub use curvature::{Curvature, Curvatures, ForceLaw, HyperDual};
pub use drive::Drive;
pub use error::ElementError;
pub(crate) use error::values;
pub use joint::{JointDamper, JointEffort};
pub use limit::{JointLimit, is_one_coordinate};
pub use port::{PortEffort, PortSpring};
pub use slopes::JointSlopes;
pub(crate) use slopes::Target;
pub use slopes::{End, PointForce, Slope, Slopes};
pub use spring::{JointSpring, RotationSpring};
pub use timed::{TimedEffort, TimedWrench};
pub use unilateral::{JointFriction, JointStop, LimitOf, has_one_freedom};
pub use view::MotionList;
pub use view::{Action, Motions, View};

use crate::mechanism::Mechanism;
use crate::time_function::{Moment, TimeFunction};
use core::fmt::Debug;

/// Something that acts on a mechanism, and what energy it stores.
pub trait Element: Debug + Send + Sync {
    /// Its name, for messages.
    fn name(&self) -> &str;

    /// Whether the element fits the mechanism.
    ///
    /// # Errors
    /// A body that is not there, a value out of range, a wrong size.
    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError>;

    /// Adds its efforts (in the axes of v) and its forces and moments (in world axes).
    fn act(&self, view: &View<'_>, action: &mut Action<'_>);

    /// The energy that it stores, J; 0 for one that stores none.
    fn energy(&self, view: &View<'_>) -> f64;

    /// The power that it feeds in, W: the rate at which the energy of the mechanism and of the element changes by what it exerts. 0 for
    /// one that only stores, negative for one that dissipates.
    fn power(&self, view: &View<'_>) -> f64;

    /// How what it exerts changes with the state, for derivatives of the dynamics; `None` where it does not say, and derivatives of a mechanism
    /// with it are refused.
    fn slope(&self) -> Option<&dyn Slope> {
        None
    }

    /// Second derivatives of what it exerts, for those of the dynamics; `None` where it does not say, and second derivatives of a mechanism with it
    /// are refused.
    fn curvature(&self) -> Option<&dyn Curvature> {
        None
    }

    /// What it exerts at a port of a joint, if that is all that it does: the body whose joint it is, the port, and the effort, N·m or N.
    fn port_effort(&self, _view: &View<'_>) -> Option<(usize, usize, f64)> {
        None
    }

    /// The same of an effort that changes with time, and with nothing else: what compiled equations are handed with τ.
    fn timed_port_effort(&self, _at: Moment) -> Option<(usize, usize, f64)> {
        None
    }

    /// Up to two functions of Q at whose zeros what it exerts bends, continuous as it is; NaN in place of those that it does not have. Steps end there.
    fn bends(&self, _mechanism: &Mechanism, _q: &[f64]) -> [f64; 2] {
        [f64::NAN; 2]
    }

    /// The functions of time that it reads at the view's [`Moment`]; none where it does not change with time.
    fn functions(&self) -> &[TimeFunction] {
        &[]
    }
}
