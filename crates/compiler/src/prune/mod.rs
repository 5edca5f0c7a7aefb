//! What a scene does not need, taken away before any equation is written: inertias that affect no joint, and frames that cost.
//!
//! All of it is exact: M, the forces of (24) and (34), and the efforts stay what they are, to rounding. Joint reaction wrenches do not: who
//! wants these takes them from the tree.

mod across;
mod frames;
mod inertias;
mod remembered;
mod rotation;

pub(crate) use across::Element;
pub(crate) use frames::Freedom;
pub use frames::{Placed, clean};
pub(crate) use remembered::Remembered;

use super::model::{Inertia, Model};
use hamel_runtime::spatial::Pose;

/// A body in the frame in which its equations are written.
#[derive(Clone, Debug)]
pub struct Link {
    /// From the joint's parent frame to the frame of the parent's equations.
    pub placement: Vec<Fixed>,
    /// From the frame of this body's equations to the joint's child frame.
    pub after: Vec<Fixed>,
    /// The body frame in the frame of its equations.
    pub body: Pose<f64>,
    /// The inertia that is left to it, in its frame.
    pub inertia: Inertia,
    /// First moment of what the world took off it, in world axes, kg m.
    pub dropped: nalgebra::Vector3<f64>,
}

/// A constant factor of a placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fixed {
    /// The child's origin stands there, m.
    Shift(nalgebra::Vector3<f64>),
    /// Turn about axis 0, 1 or 2, by the cosine and the sine of the angle.
    Turn(usize, f64, f64),
}

impl Fixed {
    /// A pose in factors.
    pub fn steps(pose: &Pose<f64>) -> Vec<Self> {
        let shift = clean(pose.translation);
        let shift = (shift != nalgebra::Vector3::zeros()).then_some(Self::Shift(shift));
        shift
            .into_iter()
            .chain(rotation::turns(&pose.rotation))
            .collect()
    }

    /// Their product.
    pub fn pose(steps: &[Self]) -> Pose<f64> {
        let poses = steps.iter().map(|step| match *step {
            Self::Shift(by) => Pose::from_translation(by),
            Self::Turn(axis, cos, sin) => {
                let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
                let mut matrix = nalgebra::Matrix3::identity();
                matrix[(b, b)] = cos;
                matrix[(c, c)] = cos;
                matrix[(c, b)] = sin;
                matrix[(b, c)] = -sin;
                Pose::from_rotation(matrix)
            }
        });
        poses.fold(Pose::identity(), |pose, step| pose.compose(&step))
    }
}

/// What is taken away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pruning {
    /// Frames move to where placements are sparse.
    pub frames: bool,
    /// Inertias that affect no joint move to the root.
    pub inertias: bool,
}

impl Pruning {
    /// All that can be.
    pub const ALL: Self = Self {
        frames: true,
        inertias: true,
    };
    /// Nothing.
    pub const NONE: Self = Self {
        frames: false,
        inertias: false,
    };
}

/// The links of a model, in frames chosen for few operations, with the inertias that affect no joint moved to the root.
pub fn prune(model: &Model, pruning: Pruning) -> Vec<Link> {
    let placed = Placed::new(model, pruning.frames);
    let links = placed.links();
    match pruning.inertias {
        true => inertias::rootward(model, &placed, links),
        false => links,
    }
}
