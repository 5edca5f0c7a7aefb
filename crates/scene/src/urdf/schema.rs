//! The part of URDF that decides how a robot moves: its elements, their attributes, and which of them must be there.

use super::robot::JointType;
use super::ties::ClosingType;

/// An element that is read.
#[derive(Debug)]
pub(super) struct Element {
    /// Name of the tag.
    pub(super) name: &'static str,
    /// The attributes that it may have.
    pub(super) attributes: &'static [Attribute],
    /// The elements that it may hold.
    pub(super) children: &'static [Child],
}

/// An attribute of an element.
#[derive(Debug)]
pub(super) struct Attribute {
    /// Its name.
    pub(super) name: &'static str,
    /// What its text must be.
    pub(super) kind: Kind,
    /// Whether it must be there.
    pub(super) need: Need,
}

/// What the text of an attribute must be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// A text in one line, not empty.
    Name,
    /// A finite number.
    Number,
    /// A number, which may be infinite.
    Bound,
    /// So many finite numbers.
    Vector(usize),
    /// One of these words.
    Choice(&'static [&'static str]),
}

/// Whether something must be there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Need {
    /// It may be absent.
    Optional,
    /// It must be there.
    Required,
    /// It must be there in versions of URDF before 1.2.
    Before12,
}

/// An element inside another.
#[derive(Debug)]
pub(super) struct Child {
    /// The element.
    pub(super) element: &'static Element,
    /// Whether it must be there.
    pub(super) need: Need,
    /// Whether there may be several.
    pub(super) several: bool,
}

/// Elements of URDF that say nothing about motion, with what messages call them.
pub(super) const NOT_READ: [(&str, &str); 3] = [
    ("collision", "collision shapes are not read"),
    ("transmission", "transmissions are not simulated"),
    ("gazebo", "settings for Gazebo are not read"),
];

/// Elements in which nothing may be passed over: what they say decides which mechanism the robot is.
pub(super) const STRICT: [&str; 4] = ["loop", "coupling", "predecessor", "successor"];

/// Elements of URDF that pictures show: `shapes` reads them.
pub(super) const SHOWN: [&str; 2] = ["visual", "material"];

/// The whole document.
pub(super) static ROBOT: Element = Element {
    name: "robot",
    attributes: &[
        optional("name", Kind::Name),
        optional("version", Kind::Name),
    ],
    children: &[any(&LINK), any(&JOINT), any(&LOOP), any(&COUPLING)],
};

static LINK: Element = Element {
    name: "link",
    attributes: &[required("name", Kind::Name)],
    children: &[at_most_one(&INERTIAL)],
};

static INERTIAL: Element = Element {
    name: "inertial",
    attributes: &[],
    children: &[at_most_one(&ORIGIN), one(&MASS), one(&INERTIA)],
};

static ORIGIN: Element = Element {
    name: "origin",
    attributes: &[
        optional("xyz", Kind::Vector(3)),
        optional("rpy", Kind::Vector(3)),
        optional("quat_xyzw", Kind::Vector(4)),
    ],
    children: &[],
};

static MASS: Element = Element {
    name: "mass",
    attributes: &[required("value", Kind::Number)],
    children: &[],
};

static INERTIA: Element = Element {
    name: "inertia",
    attributes: &[
        required("ixx", Kind::Number),
        required("ixy", Kind::Number),
        required("ixz", Kind::Number),
        required("iyy", Kind::Number),
        required("iyz", Kind::Number),
        required("izz", Kind::Number),
    ],
    children: &[],
};

static JOINT: Element = Element {
    name: "joint",
    attributes: &[
        required("name", Kind::Name),
        required("type", Kind::Choice(&JointType::NAMES)),
        // Of URDF+.
        optional(
            "independent",
            Kind::Choice(&["true", "false", "True", "False"]),
        ),
    ],
    children: &[
        one(&PARENT),
        one(&CHILD),
        at_most_one(&ORIGIN),
        at_most_one(&AXIS),
        at_most_one(&LIMIT),
        at_most_one(&DYNAMICS),
        at_most_one(&MIMIC),
        at_most_one(&SAFETY_CONTROLLER),
        at_most_one(&CALIBRATION),
    ],
};

/// Closes a loop; of URDF+ (arXiv 2411.19753), as are the elements below.
static LOOP: Element = Element {
    name: "loop",
    attributes: &[
        required("name", Kind::Name),
        required("type", Kind::Choice(&ClosingType::NAMES)),
    ],
    children: &[one(&PREDECESSOR), one(&SUCCESSOR), at_most_one(&AXIS)],
};

static COUPLING: Element = Element {
    name: "coupling",
    attributes: &[required("name", Kind::Name), optional("type", Kind::Name)],
    children: &[one(&PREDECESSOR), one(&SUCCESSOR), one(&RATIO)],
};

static PREDECESSOR: Element = Element {
    name: "predecessor",
    attributes: &[required("link", Kind::Name)],
    children: &[at_most_one(&ORIGIN)],
};

static SUCCESSOR: Element = Element {
    name: "successor",
    attributes: &[required("link", Kind::Name)],
    children: &[at_most_one(&ORIGIN)],
};

static RATIO: Element = Element {
    name: "ratio",
    attributes: &[required("value", Kind::Number)],
    children: &[],
};

static PARENT: Element = Element {
    name: "parent",
    attributes: &[required("link", Kind::Name)],
    children: &[],
};

static CHILD: Element = Element {
    name: "child",
    attributes: &[required("link", Kind::Name)],
    children: &[],
};

static AXIS: Element = Element {
    name: "axis",
    attributes: &[required("xyz", Kind::Vector(3))],
    children: &[],
};

static LIMIT: Element = Element {
    name: "limit",
    attributes: &[
        optional("lower", Kind::Bound),
        optional("upper", Kind::Bound),
        optional("effort", Kind::Bound),
        Attribute {
            name: "velocity",
            kind: Kind::Bound,
            need: Need::Before12,
        },
        optional("acceleration", Kind::Bound),
        optional("deceleration", Kind::Bound),
        optional("jerk", Kind::Bound),
    ],
    children: &[],
};

static DYNAMICS: Element = Element {
    name: "dynamics",
    attributes: &[
        optional("damping", Kind::Number),
        optional("friction", Kind::Number),
    ],
    children: &[],
};

static MIMIC: Element = Element {
    name: "mimic",
    attributes: &[
        required("joint", Kind::Name),
        optional("multiplier", Kind::Number),
        optional("offset", Kind::Number),
    ],
    children: &[],
};

static SAFETY_CONTROLLER: Element = Element {
    name: "safety_controller",
    attributes: &[
        optional("soft_lower_limit", Kind::Bound),
        optional("soft_upper_limit", Kind::Bound),
        optional("k_position", Kind::Number),
        required("k_velocity", Kind::Number),
    ],
    children: &[],
};

static CALIBRATION: Element = Element {
    name: "calibration",
    attributes: &[
        optional("rising", Kind::Number),
        optional("falling", Kind::Number),
    ],
    children: &[],
};

const fn optional(name: &'static str, kind: Kind) -> Attribute {
    let need = Need::Optional;
    Attribute { name, kind, need }
}

const fn required(name: &'static str, kind: Kind) -> Attribute {
    let need = Need::Required;
    Attribute { name, kind, need }
}

const fn any(element: &'static Element) -> Child {
    Child {
        element,
        need: Need::Optional,
        several: true,
    }
}

const fn at_most_one(element: &'static Element) -> Child {
    Child {
        element,
        need: Need::Optional,
        several: false,
    }
}

const fn one(element: &'static Element) -> Child {
    Child {
        element,
        need: Need::Required,
        several: false,
    }
}
