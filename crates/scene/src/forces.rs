//! What acts at joints and on bodies, and what is forbidden to bodies, as a scene file says it.

use crate::description::Position;
use crate::source::Located;
use hamel_runtime::spatial::Pose;
use hamel_runtime::time_function::TimeFunction;
use nalgebra::{DMatrix, Vector3};

/// What acts at one joint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointForces {
    /// Spring towards a configuration.
    pub spring: Option<Located<JointSpring>>,
    /// Viscous damping c: the effort −c v.
    pub damping: Option<Located<PerFreedom>>,
    /// Inertia of what turns with the joint, such as a rotor: added to the diagonal of the joint's own block of M.
    pub armature: Option<Located<PerFreedom>>,
    /// Efforts τ, one per degree of freedom.
    pub effort: Option<Located<Vec<TimeFunction>>>,
    /// Prescribed motion: the speeds v̄.
    pub motion: Option<Located<Vec<TimeFunction>>>,
    /// Dry friction.
    pub friction: Option<Located<FrictionDescription>>,
    /// Where the joint's range ends.
    pub limit: Option<Located<LimitDescription>>,
    /// Of a coupling, whose limits the lower and the upper end of `limit` are.
    pub limit_of: [Option<LimitOwner>; 2],
    /// Stops that give way at other joints of its coupling.
    pub further_limits: Vec<Located<LimitDescription>>,
    /// What acts at its ports.
    pub ports: Vec<PortForces>,
}

impl JointForces {
    /// The efforts, if none of them changes with time; none where there are none.
    pub fn constant_effort(&self) -> Option<Vec<f64>> {
        let efforts = self.effort.iter().flat_map(|effort| &effort.value);
        efforts.map(TimeFunction::constant).collect()
    }

    /// Whether nothing acts.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }
}

/// What acts at one port of a joint.
#[derive(Clone, Debug, PartialEq)]
pub struct PortForces {
    /// Name of the port.
    pub name: Located<String>,
    /// Effort, N m or N.
    pub effort: Option<TimeFunction>,
    /// Spring.
    pub spring: Option<PortSpringDescription>,
    /// Viscous damping c: the effort −c w; 0 without.
    pub damping: f64,
    /// Inertia of what turns or slides with it, kg m² or kg; 0 without.
    pub armature: f64,
    /// Dry friction.
    pub friction: Option<Located<FrictionDescription>>,
    /// Where its range ends, by stops that give way.
    pub limit: Option<Located<LimitDescription>>,
}

impl PortForces {
    /// What messages call its effort or spring, of the joint of that name.
    pub fn element(&self, what: &str, joint: &str) -> String {
        format!("{what} at port `{}` of joint `{joint}`", self.name.value)
    }

    /// Its limit as an element, at a port of the joint of that name under a body; both by index.
    pub fn compliant_limit(
        &self,
        joint: &str,
        (body, port): (usize, usize),
    ) -> Option<hamel_runtime::elements::JointLimit> {
        let limit = self.limit.as_ref()?.value;
        let LimitKind::Compliant { stiffness, damping } = limit.kind else {
            return None;
        };
        Some(hamel_runtime::elements::JointLimit {
            name: self.element("limit", joint),
            body,
            port: Some(port),
            lower: limit.lower,
            upper: limit.upper,
            stiffness,
            damping,
        })
    }
}

/// A spring at a port.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PortSpringDescription {
    /// N m/rad or N/m.
    pub stiffness: f64,
    /// The value of the port at which it is at rest, rad or m; that at the joint's home without.
    pub rest: Option<f64>,
}

/// Coulomb's friction at a joint with one degree of freedom, N m or N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionDescription {
    /// Effort in motion.
    pub sliding: f64,
    /// Largest effort at rest, not less than that in motion.
    pub sticking: f64,
}

/// The range of a joint with one degree of freedom, rad or m; at least one end is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitDescription {
    /// Its lower end.
    pub lower: Option<f64>,
    /// Its upper end.
    pub upper: Option<f64>,
    /// What happens there.
    pub kind: LimitKind,
}

/// The limit of a joint that ends the range of what the joint follows.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitOwner {
    /// Name of the joint.
    pub joint: String,
    /// The number of its port in the coupling.
    pub port: usize,
    /// Whether it is its upper limit.
    pub is_upper: bool,
    /// Where it is, rad or m.
    pub end: Located<f64>,
}

/// What happens where a joint's range ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LimitKind {
    /// An impact: the speed after it is `−restitution` times that before.
    Impact {
        /// From 0 to 1.
        restitution: f64,
    },
    /// A stop that gives way: beyond it by x the effort towards the inside is `k x max(0, 1 + d ẋ)`.
    Compliant {
        /// k, N m/rad or N/m.
        stiffness: f64,
        /// d, s/rad or s/m.
        damping: f64,
    },
}

/// Numbers of at least 0, one per degree of freedom.
#[derive(Clone, Debug, PartialEq)]
pub enum PerFreedom {
    /// The same for every degree of freedom.
    All(f64),
    /// One for each.
    Each(Vec<f64>),
}

impl PerFreedom {
    /// The numbers for a joint of `freedoms`; `None` where the size is another.
    pub fn spread(&self, freedoms: usize) -> Option<Vec<f64>> {
        match self {
            Self::All(number) => Some(vec![*number; freedoms]),
            Self::Each(numbers) => (numbers.len() == freedoms).then(|| numbers.clone()),
        }
    }
}

/// A spring at a joint, at rest at one of its configurations.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSpring {
    /// Configuration at which it is at rest.
    pub rest: Position,
    /// Its energy.
    pub energy: SpringEnergy,
}

/// Energy of a spring at a joint.
#[derive(Clone, Debug, PartialEq)]
pub enum SpringEnergy {
    /// `½ ϕᵀKϕ`, with ϕ the local coordinates of Q from the rest; one stiffness for every degree of freedom, or a diagonal.
    Diagonal(PerFreedom),
    /// The same with a full matrix K, symmetric and positive semidefinite.
    Full(DMatrix<f64>),
    /// `k (3 − tr R)/2`, R the rotation of the joint's pose relative to that at rest: smooth also at half a turn.
    Trace(f64),
}

/// A point of a body, or of the world.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyPoint {
    /// Index of the body in the description; `None` is the world.
    pub body: Option<usize>,
    /// The point in the body frame, m.
    pub point: Vector3<f64>,
}

/// A named frame.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameDescription {
    /// Name, unique among frames and bodies.
    pub name: Located<String>,
    /// Index of the body that carries it; `None` is the world.
    pub body: Option<usize>,
    /// Its pose in the body frame.
    pub at: Pose<f64>,
}

/// A spring with a damper between two points.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSpring {
    /// One end.
    pub from: BodyPoint,
    /// The other end.
    pub to: BodyPoint,
    /// Stiffness, N/m.
    pub stiffness: f64,
    /// Damping along the line of the points, N s/m.
    pub damping: f64,
    /// Length at rest, m.
    pub length: f64,
}

/// A force and moment on a body.
#[derive(Clone, Debug, PartialEq)]
pub struct WrenchDescription {
    /// Index of the body.
    pub body: usize,
    /// Where the force acts, in the body frame, m.
    pub point: Vector3<f64>,
    /// Force, N.
    pub force: [TimeFunction; 3],
    /// Moment, N m.
    pub moment: [TimeFunction; 3],
    /// Axes of force and moment.
    pub axes: WrenchAxes,
}

impl WrenchDescription {
    /// Force and moment, if neither changes with time.
    pub fn constant(&self) -> Option<[Vector3<f64>; 2]> {
        let vector = |[x, y, z]: &[TimeFunction; 3]| {
            Some(Vector3::new(x.constant()?, y.constant()?, z.constant()?))
        };
        Some([vector(&self.force)?, vector(&self.moment)?])
    }
}

/// Axes of a wrench.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WrenchAxes {
    /// Those of the world.
    World,
    /// Those of the body: the wrench turns with it.
    Body,
}

impl WrenchAxes {
    /// Names of both, as scene files write them.
    pub const NAMES: [&'static str; 2] = ["world", "body"];
}

/// A velocity that a point of a body may not have: `dᵀ v_P = 0`, with the world velocity of the point and d fixed in the body.
#[derive(Clone, Debug, PartialEq)]
pub struct ConstraintDescription {
    /// Name, unique among constraints.
    pub name: Located<String>,
    /// Index of the body.
    pub body: usize,
    /// The point P in the body frame, m.
    pub point: Vector3<f64>,
    /// The direction d in body axes, of length 1.
    pub direction: Vector3<f64>,
}

#[cfg(test)]
mod tests {
    use super::PerFreedom;

    #[test]
    fn one_number_stands_for_all_freedoms() {
        assert_eq!(PerFreedom::All(0.5).spread(3), Some(vec![0.5; 3]));
        assert_eq!(
            PerFreedom::Each(vec![1.0, 2.0]).spread(2),
            Some(vec![1.0, 2.0])
        );
        assert_eq!(PerFreedom::Each(vec![1.0, 2.0]).spread(3), None);
    }
}
