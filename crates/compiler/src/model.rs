//! What is compiled: a tree of bodies with numbers for all that does not change.

use super::products::JointType;
use hamel_runtime::elements::{
    BodySpring, BodyWrench, JointLimit, JointSpring, PointConstraint, PortEffort, PortSpring,
    RotationSpring,
};
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};
use std::ops::Range;
use std::rc::Rc;

/// A mechanism whose equations are to be written.
#[derive(Clone, Debug)]
pub struct Model {
    /// Name of the scene.
    pub name: String,
    /// Acceleration of free fall in world axes, m/s².
    pub gravity: Vector3<f64>,
    /// The bodies, each after its parent; those of a joint that carries several follow each other, in its order.
    pub bodies: Vec<Body>,
    /// What acts beside gravity and what the bodies' own joints have.
    pub elements: Elements,
    /// What couples joints.
    pub coupling: Coupling,
}

/// Springs and wrenches, as the runtime has them.
#[derive(Clone, Debug, Default)]
pub struct Elements {
    /// Springs at joints in local coordinates.
    pub joint_springs: Vec<JointSpring>,
    /// Springs at joints that are smooth at every attitude.
    pub rotation_springs: Vec<RotationSpring>,
    /// Springs and dampers between points.
    pub springs: Vec<BodySpring>,
    /// Compliant limits of joints.
    pub limits: Vec<JointLimit>,
    /// Constant efforts at ports.
    pub port_efforts: Vec<PortEffort>,
    /// Springs and dampers at ports.
    pub port_springs: Vec<PortSpring>,
    /// Wrenches from outside.
    pub wrenches: Vec<BodyWrench>,
}

/// Constraints that couple joints.
#[derive(Clone, Debug, Default)]
pub struct Coupling {
    /// Forbidden velocities of points.
    pub constraints: Vec<PointConstraint>,
    /// The speeds that depend on the others, one a constraint.
    pub dependent: Vec<usize>,
}

/// One body and the joint that it hangs on.
///
/// A joint may carry several bodies, all with its parent and its coordinates. The first of them stands for the joint: what acts at
/// the joint is found there alone.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name of the body.
    pub name: String,
    /// Name of its joint.
    pub joint_name: String,
    /// Index of the parent; `None` is the world.
    pub parent: Option<usize>,
    /// The joint's type, as this body sees it.
    pub joint: Rc<JointType>,
    /// Values of the type's parameters, in the order of its spec.
    pub parameters: Vec<f64>,
    /// The joint's parent frame, as this body sees it, in the parent's body frame.
    pub placement: Pose<f64>,
    /// The body frame in the joint's child frame.
    pub child_placement: Pose<f64>,
    /// Mass properties in the body frame.
    pub mass: MassProperties,
    /// What is added to the diagonal of the joint's own block of M, one per degree of freedom; none for further bodies of a joint.
    pub armature: Vec<f64>,
    /// Inertias of rotors at the joint's ports, one per port; none where there are none, and for further bodies of a joint.
    pub port_armature: Vec<f64>,
    /// Viscous damping, one per degree of freedom; none for further bodies of a joint.
    pub damping: Vec<f64>,
    /// Constant efforts, one per degree of freedom; none for further bodies of a joint.
    pub effort: Vec<f64>,
    /// Whether the joint's motion is prescribed: its first entries of τ are its accelerations, and its entries of p̄ its speeds.
    pub driven: bool,
}

impl Body {
    /// Whether it stands for its joint: the joint carries it alone, or it is the first of the joint's bodies.
    pub fn leads(&self) -> bool {
        self.joint.derived.body == 0
    }
}

/// Where the share of a body's joint lies in Q, in v and τ, and in v̄.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Share {
    /// In Q.
    pub configuration: Range<usize>,
    /// In v, τ.
    pub freedoms: Range<usize>,
    /// In v̄, p̄.
    pub speeds: Range<usize>,
}

impl Model {
    /// The joints, each with the index of the body that stands for it.
    pub fn joints(&self) -> impl Iterator<Item = (usize, &Body)> {
        let bodies = self.bodies.iter().enumerate();
        bodies.filter(|(_, body)| body.leads())
    }

    /// The bodies that the joint under a body carries: one, or several that follow each other.
    pub fn carried(&self, body: usize) -> Range<usize> {
        let first = body - self.bodies[body].joint.derived.body;
        first..first + 1 + self.bodies[first].joint.more.len()
    }

    /// For each body how many carry it.
    pub(crate) fn depths(&self) -> Vec<usize> {
        let mut depths: Vec<usize> = vec![];
        for body in &self.bodies {
            depths.push(body.parent.map_or(0, |parent| depths[parent] + 1));
        }
        depths
    }

    /// The share of each body: that of its joint.
    pub fn shares(&self) -> Vec<Share> {
        let mut end = [0; 3];
        let next = |end: &mut usize, size: usize| {
            let range = *end..*end + size;
            *end = range.end;
            range
        };
        let mut shares: Vec<Share> = vec![];
        for (index, body) in self.joints() {
            let shape = body.joint.derived.shape;
            let share = Share {
                configuration: next(&mut end[0], shape.configuration),
                freedoms: next(&mut end[1], shape.freedoms),
                speeds: next(&mut end[2], shape.speeds),
            };
            shares.extend(self.carried(index).map(|_| share.clone()));
        }
        shares
    }

    /// Sizes of Q, of v and τ, and of v̄.
    pub fn sizes(&self) -> [usize; 3] {
        let shapes = self.joints().map(|(_, body)| body.joint.derived.shape);
        shapes.fold([0; 3], |[q, v, speeds], shape| {
            [
                q + shape.configuration,
                v + shape.freedoms,
                speeds + shape.speeds,
            ]
        })
    }
}

/// A spatial inertia by its ten parameters, about the origin of its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Mass, kg.
    pub mass: f64,
    /// Mass times position of the centre of mass, kg m.
    pub first: Vector3<f64>,
    /// Second moments `J = ∫ r rᵀ dm`, kg m²; the moments and products of inertia are `I = tr(J) 1 − J`.
    pub second: Matrix3<f64>,
}

impl Inertia {
    /// Nothing.
    pub fn zero() -> Self {
        Self {
            mass: 0.0,
            first: Vector3::zeros(),
            second: Matrix3::zeros(),
        }
    }

    /// That of a body in its own frame.
    pub fn of(mass: &MassProperties) -> Self {
        let own = Self {
            mass: mass.mass,
            first: Vector3::zeros(),
            second: second_moments(&mass.inertia_com),
        };
        own.seen_from(&Pose::from_translation(mass.com))
    }

    /// The same inertia in the parent of the pose.
    #[must_use]
    pub fn seen_from(&self, pose: &Pose<f64>) -> Self {
        let (r, p) = (&pose.rotation, &pose.translation);
        let first = r * self.first;
        let second = r * self.second * r.transpose();
        let moved = p * first.transpose() + first * p.transpose() + p * p.transpose() * self.mass;
        Self {
            mass: self.mass,
            first: first + p * self.mass,
            second: second + moved,
        }
    }

    /// `[m, mc_x, mc_y, mc_z, Jxx, Jyy, Jzz, Jxy, Jxz, Jyz]`.
    pub fn parameters(&self) -> [f64; 10] {
        let (h, j) = (&self.first, &self.second);
        [
            self.mass,
            h.x,
            h.y,
            h.z,
            j[(0, 0)],
            j[(1, 1)],
            j[(2, 2)],
            j[(0, 1)],
            j[(0, 2)],
            j[(1, 2)],
        ]
    }

    /// The inertia with these parameters.
    pub fn from_parameters(p: &[f64; 10]) -> Self {
        Self {
            mass: p[0],
            first: Vector3::new(p[1], p[2], p[3]),
            second: Matrix3::new(p[4], p[7], p[8], p[7], p[5], p[9], p[8], p[9], p[6]),
        }
    }

    /// The inertia with the parameters `[m, mc_x, mc_y, mc_z, Ixx, Iyy, Izz, Ixy, Ixz, Iyz]`.
    pub fn from_moments_of_inertia(p: &[f64; 10]) -> Self {
        let inertia = Self::from_parameters(p);
        Self {
            second: second_moments(&inertia.second),
            ..inertia
        }
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            mass: self.mass + other.mass,
            first: self.first + other.first,
            second: self.second + other.second,
        }
    }

    /// The inertia times a number.
    #[must_use]
    pub fn times(&self, factor: f64) -> Self {
        Self {
            mass: self.mass * factor,
            first: self.first * factor,
            second: self.second * factor,
        }
    }
}

/// `J = ½ tr(I) 1 − I`. The larger of two moments is lessened by the third first: where these two are close, as in a rod, nothing of the small
/// one is lost.
fn second_moments(inertia: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| {
        if i != j {
            return -inertia[(i, j)];
        }
        let [a, b] = [1, 2].map(|k| inertia[((i + k) % 3, (i + k) % 3)]);
        ((a.max(b) - inertia[(i, i)]) + a.min(b)) / 2.0
    })
}
