//! A robot as its document has it: links and joints, each with its element.
//!
//! It is read after the audit, which has found every attribute sound; what the joints and links hold is read where it is used.

use super::document::{attribute, child};
use roxmltree::Node;
use std::collections::{HashMap, HashSet};

/// A robot.
pub(super) struct Robot<'a, 'i> {
    /// Its name, if the file says one.
    pub(super) name: Option<&'a str>,
    /// Its links, in the order of the file.
    pub(super) links: Vec<Link<'a, 'i>>,
    /// Its joints, in the order of the file.
    pub(super) joints: Vec<Joint<'a, 'i>>,
    /// Its `<loop>` elements, in the order of the file.
    pub(super) loops: Vec<Node<'a, 'i>>,
    /// Its `<coupling>` elements, in the order of the file.
    pub(super) couplings: Vec<Node<'a, 'i>>,
    /// The names of the joints.
    pub(super) joint_names: HashSet<&'a str>,
    /// The elements of its materials by their names, the first of each name.
    pub(super) materials: HashMap<&'a str, Node<'a, 'i>>,
}

/// A link.
#[derive(Clone, Copy)]
pub(super) struct Link<'a, 'i> {
    /// Its name.
    pub(super) name: &'a str,
    /// The `<link>` element.
    pub(super) node: Node<'a, 'i>,
}

/// A joint.
#[derive(Clone, Copy)]
pub(super) struct Joint<'a, 'i> {
    /// Its name.
    pub(super) name: &'a str,
    /// Its type.
    pub(super) kind: JointType,
    /// The link that it moves.
    pub(super) child: &'a str,
    /// The link that it hangs on.
    pub(super) parent: &'a str,
    /// The `<joint>` element.
    pub(super) node: Node<'a, 'i>,
}

/// Types of joints in URDF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JointType {
    /// Turns about an axis, between limits.
    Revolute,
    /// Turns about an axis, without limits.
    Continuous,
    /// Slides along an axis.
    Prismatic,
    /// Does not move.
    Fixed,
    /// Moves freely.
    Floating,
    /// Moves in the plane across an axis.
    Planar,
    /// Turns about a point.
    Spherical,
}

impl<'a, 'i> Robot<'a, 'i> {
    /// The robot of a sound document; `None` where it is not sound.
    pub(super) fn read(root: Node<'a, 'i>) -> Option<Self> {
        let named =
            |name: &'static str| root.children().filter(move |node| node.has_tag_name(name));
        let joints = named("joint").map(Joint::read);
        let joints: Vec<Joint<'a, 'i>> = joints.collect::<Option<_>>()?;
        let mut materials = HashMap::new();
        for node in named("material") {
            if let Some(name) = node.attribute("name") {
                materials.entry(name).or_insert(node);
            }
        }
        Some(Self {
            name: root.attribute("name"),
            links: named("link").map(Link::read).collect::<Option<_>>()?,
            loops: named("loop").collect(),
            couplings: named("coupling").collect(),
            joint_names: joints.iter().map(|joint| joint.name).collect(),
            joints,
            materials,
        })
    }
}

impl<'a, 'i> Link<'a, 'i> {
    fn read(node: Node<'a, 'i>) -> Option<Self> {
        let name = node.attribute("name")?;
        Some(Self { name, node })
    }

    /// Its `<inertial>` element.
    pub(super) fn inertial(&self) -> Option<Node<'a, 'i>> {
        child(self.node, "inertial")
    }
}

impl<'a, 'i> Joint<'a, 'i> {
    fn read(node: Node<'a, 'i>) -> Option<Self> {
        Some(Self {
            name: node.attribute("name")?,
            kind: JointType::of(node.attribute("type")?)?,
            child: attribute(node, "child", "link")?,
            parent: attribute(node, "parent", "link")?,
            node,
        })
    }
}

impl JointType {
    /// All of them, as URDF writes them.
    pub(super) const NAMES: [&str; 7] = [
        "revolute",
        "continuous",
        "prismatic",
        "fixed",
        "floating",
        "planar",
        "spherical",
    ];

    /// As URDF writes it.
    pub(super) fn name(self) -> &'static str {
        let known = Self::NAMES.into_iter();
        let mut own = known.filter(|name| Self::of(name) == Some(self));
        own.next().unwrap_or("")
    }

    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "revolute" => Self::Revolute,
            "continuous" => Self::Continuous,
            "prismatic" => Self::Prismatic,
            "fixed" => Self::Fixed,
            "floating" => Self::Floating,
            "planar" => Self::Planar,
            "spherical" => Self::Spherical,
            _ => return None,
        })
    }

    /// The library's joint type; `None` for a fixed joint. All of them act about or along the z axis of their frame.
    pub(super) const fn of_library(self) -> Option<&'static str> {
        match self {
            Self::Fixed => None,
            Self::Revolute => Some("revolute"),
            Self::Continuous => Some("revolute_circle"),
            Self::Prismatic => Some("prismatic"),
            Self::Planar => Some("planar"),
            Self::Floating => Some("free"),
            Self::Spherical => Some("ball_child"),
        }
    }

    /// Whether it moves about, along or across an axis.
    pub(super) const fn has_axis(self) -> bool {
        !matches!(self, Self::Fixed | Self::Floating | Self::Spherical)
    }
}
