//! What the recursion keeps of each body: a compact copy of what never changes, and the workspace.

use super::slender::is_slender;
use crate::erased::AnyJoint;
use crate::mechanism::{Body, Mechanism};
use crate::spatial::{Pose, SpatialInertia, join};
use crate::steps::{Motion, Placement};
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{Vector3, Vector6};

/// One body and its joint, as the sweeps read them: next to each other in memory, without names.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub(super) joint: Arc<dyn AnyJoint>,
    pub(super) parent: Option<usize>,
    pub(super) configuration: Range<usize>,
    pub(super) freedoms: Range<usize>,
    pub(super) speeds: Range<usize>,
    /// Where the body's columns of X̄ are.
    pub(super) columns: Range<usize>,
    /// Where its variations are.
    pub(super) variations: Range<usize>,
    /// Whether it stands for its joint: it is the only body, or the first.
    pub(super) leads: bool,
    /// Which of the joints that carry several bodies carries it, if one does.
    pub(super) group: Option<usize>,
    /// The joint's parent frame in the child frame of the parent's joint.
    pub(super) frame: Pose<f64>,
    /// Inertia in the joint's child frame.
    pub(super) inertia: SpatialInertia<f64>,
    /// Rotor inertias, one per speed; empty where there are none, and at further bodies of a joint.
    pub(super) armature: Vec<f64>,
    /// Whether the joint's motion is prescribed.
    pub(super) driven: bool,
    /// Whether any body hangs on this one.
    pub(super) carries: bool,
    /// Which of the slender bodies this is, if it is one.
    pub(super) slender: Option<usize>,
    /// Whether this is the last of the bodies that hang on its parent, and so the first in an inward sweep.
    pub(super) last: bool,
}

impl Link {
    pub(super) fn all(mechanism: &Mechanism) -> Vec<Self> {
        let bodies = mechanism.bodies().iter().enumerate();
        let mut links: Vec<Self> = bodies
            .map(|(index, body)| Self {
                armature: mechanism.speed_armature(index).to_vec(),
                driven: mechanism.is_driven(index),
                ..Self::new(body)
            })
            .collect();
        let several = mechanism
            .joints()
            .map(|(index, _)| mechanism.carried(index));
        for (group, bodies) in several.filter(|bodies| bodies.len() > 1).enumerate() {
            for link in &mut links[bodies] {
                link.group = Some(group);
            }
        }
        let alone = |link: &&mut Self| link.group.is_none();
        let slender = links.iter_mut().filter(alone);
        let slender = slender.filter(|link| is_slender(&link.inertia));
        for (number, link) in slender.enumerate() {
            link.slender = Some(number);
        }
        for index in (0..links.len()).rev() {
            if let Some(parent) = links[index].parent {
                links[index].last = !links[parent].carries;
                links[parent].carries = true;
            }
        }
        links
    }

    /// Whether it has rotors whose v are not the rates of coordinates: they add velocity terms. At a nonholonomic joint
    /// they are the rates of their own coordinates.
    pub(super) fn turns_rotors(&self) -> bool {
        let structures = self.joint.structures();
        !self.armature.is_empty()
            && !structures.gamma.is_zero()
            && structures.speed_basis.is_identity()
    }

    fn new(body: &Body) -> Self {
        let ranges = body.ranges();
        Self {
            joint: body.shared_joint(),
            parent: body.parent(),
            configuration: ranges.configuration.clone(),
            freedoms: ranges.freedoms.clone(),
            speeds: ranges.speeds.clone(),
            columns: ranges.columns.clone(),
            variations: ranges.variations.clone(),
            leads: body.leads(),
            group: None,
            frame: *body.joint_frame(),
            inertia: *body.joint_inertia(),
            armature: Vec::new(),
            driven: false,
            carries: false,
            slender: None,
            last: false,
        }
    }

    /// The body's own inertia in world axes, once it moves, and the wrench that it takes.
    #[inline(always)]
    pub(super) fn load(&self, node: &mut Node) {
        let Motion {
            placement,
            twist,
            rate,
        } = &node.motion;
        node.rigid = self.inertia.rotated(&placement.rotation);
        node.wrench = node.rigid.wrench(twist, rate);
    }

    /// The body's own inertia in world axes, once it has been placed; no wrench.
    #[inline(always)]
    pub(super) fn turn(&self, node: &mut Node) {
        node.rigid = self.inertia.rotated(&node.motion.placement.rotation);
        node.wrench = Vector6::zeros();
    }
}

/// The little that a walk from a body to the root needs of each body on its way.
#[derive(Clone, Debug)]
pub(super) struct Rung {
    pub(super) parent: Option<usize>,
    /// First column of its X̄.
    pub(super) start: usize,
    /// The column after its last.
    pub(super) end: usize,
    /// What the columns of X̄ consist of.
    pub(super) kind: Kind,
}

/// How many of the columns of X̄ can be read by halves.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// One column, without a linear part.
    TurnsOnce,
    /// Columns before this one have no linear part, those from it on no angular part.
    Apart(usize),
    /// Any.
    Mixed,
}

impl Kind {
    /// Whether a column has an angular, and whether it has a linear part.
    #[inline(always)]
    pub(super) fn parts(self, column: usize) -> (bool, bool) {
        match self {
            Self::TurnsOnce => (true, false),
            Self::Apart(middle) => (column < middle, column >= middle),
            Self::Mixed => (true, true),
        }
    }

    fn new(body: &Body) -> Self {
        let (columns, joint) = (&body.ranges().columns, body.joint());
        let turns = |j: usize| !joint.column_parts(j).1;
        let slides = |j: usize| !joint.column_parts(j).0;
        let first = (0..columns.len()).take_while(|&j| turns(j)).count();
        match (first, columns.len()) {
            (1, 1) => Self::TurnsOnce,
            (first, all) if (first..all).all(slides) => Self::Apart(columns.start + first),
            _ => Self::Mixed,
        }
    }
}

impl Rung {
    pub(super) fn new(body: &Body) -> Self {
        let columns = &body.ranges().columns;
        Self {
            parent: body.parent(),
            start: columns.start,
            end: columns.end,
            kind: Kind::new(body),
        }
    }
}

/// The state of one body in a sweep; all vectors at the child frame's origin, in world axes.
#[derive(Clone, Debug)]
pub(super) struct Node {
    /// Placement, V and V̇, the latter from −g at the world.
    pub(super) motion: Motion<f64>,
    /// The body's own inertia.
    pub(super) rigid: SpatialInertia<f64>,
    /// What a sweep carries rootward: a wrench or a momentum.
    pub(super) wrench: Vector6<f64>,
}

impl Node {
    /// The world, which a base that accelerates upwards makes as heavy as gravity does.
    pub(super) fn world(gravity: &Vector3<f64>) -> Self {
        Self {
            motion: Motion {
                placement: Placement::world(),
                twist: Vector6::zeros(),
                rate: join(&Vector3::zeros(), &-gravity),
            },
            rigid: SpatialInertia::zero(),
            wrench: Vector6::zeros(),
        }
    }
}

/// The next column towards the root, for each column of X̄.
pub(super) fn parents(rungs: &[Rung]) -> Vec<Option<usize>> {
    let mut parents = Vec::new();
    for rung in rungs {
        let mut above = rung.parent;
        let mut nearest = None;
        while let (None, Some(index)) = (nearest, above) {
            let Rung {
                parent, start, end, ..
            } = &rungs[index];
            nearest = (start < end).then(|| end - 1);
            above = *parent;
        }
        for column in rung.start..rung.end {
            parents.push(nearest);
            nearest = Some(column);
        }
    }
    parents
}
