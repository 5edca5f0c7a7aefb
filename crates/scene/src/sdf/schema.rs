//! The part of SDF that decides how a robot moves: its elements, their attributes, and what their texts must be.

/// An element that is read.
#[derive(Debug)]
pub(super) struct Tag {
    /// Its name.
    pub(super) name: &'static str,
    /// What its text must be.
    pub(super) kind: Kind,
    /// The attributes that it may have, and those that it must have behind `!`.
    pub(super) attributes: &'static str,
    /// The elements that it may hold, and those that it must hold behind `!`.
    pub(super) children: &'static str,
}

/// What the text of an element must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Nothing: it holds elements.
    Elements,
    /// A name.
    Name,
    /// A finite number.
    Number,
    /// A number, which may be infinite.
    Bound,
    /// `true` or `false`.
    Switch,
    /// Three finite numbers.
    Vector,
    /// The numbers of a pose, or none.
    Pose,
}

/// Elements that say nothing about motion, with what messages say about them.
pub(super) const NOT_READ: [(&str, &str); 20] = [
    ("collision", "collision shapes are not read"),
    ("sensor", "sensors are not simulated"),
    ("plugin", "plugins are not run"),
    ("light", "lights are not read"),
    ("actor", "actors are not simulated"),
    ("scene", "settings of pictures are not read"),
    ("gui", "settings of pictures are not read"),
    ("projector", "projectors are not read"),
    ("audio", "sounds are not read"),
    ("audio_source", "sounds are not read"),
    ("audio_sink", "sounds are not read"),
    ("particle_emitter", "particles are not simulated"),
    ("battery", "batteries are not simulated"),
    ("physics", "settings of other simulators are not read"),
    ("atmosphere", "air is not simulated"),
    ("wind", "air is not simulated"),
    (
        "state",
        "states of a world are not read: all joints begin at home",
    ),
    ("magnetic_field", "magnetic fields are not simulated"),
    ("fluid_added_mass", "water is not simulated"),
    ("spherical_coordinates", "places on the earth are not read"),
];

/// Elements that have no effect on motion here, and that are passed over: switches of collisions, of saving, and of pictures that are read elsewhere.
pub(super) const SILENT: [&str; 8] = [
    "self_collide",
    "allow_auto_disable",
    "enable_wind",
    "must_be_base_link",
    "visual",
    "provide_feedback",
    "description",
    "initial_position",
];

/// Elements of which there may be several in one.
pub(super) const SEVERAL: [&str; 4] = ["model", "link", "joint", "frame"];

/// Elements that change the mechanism in ways that are not simulated, and why a file with one is refused.
pub(super) const REFUSED: [(&str, &str, &str); 5] = [
    (
        "include",
        "the file that <include> names is not read",
        "`gz sdf -p model.sdf` writes the model with its parts in their places",
    ),
    (
        "gripper",
        "grippers that fix what they touch are not simulated",
        "take the element away: the joints of the gripper move without it",
    ),
    (
        "placement_frame",
        "placement frames are not read",
        "give the pose of the model itself",
    ),
    (
        "gearbox_ratio",
        "gearboxes are not read",
        "say `mimic` in the axis of the joint that follows",
    ),
    (
        "population",
        "populations of models are not read",
        "write the models one by one",
    ),
];

/// The element of that name in another. All of one name hold the same, except for `<gravity>`: a vector in a world, a switch in a link.
pub(super) fn of(name: &str, inside: &str) -> Option<&'static Tag> {
    match (inside, name) {
        ("link", "gravity") => Some(&OF_LINK),
        _ => TAGS.iter().find(|tag| tag.name == name),
    }
}

static OF_LINK: Tag = value("gravity", Kind::Switch);

const fn holds(name: &'static str, attributes: &'static str, children: &'static str) -> Tag {
    Tag {
        name,
        kind: Kind::Elements,
        attributes,
        children,
    }
}

const fn value(name: &'static str, kind: Kind) -> Tag {
    Tag {
        name,
        kind,
        attributes: "",
        children: "",
    }
}

static TAGS: [Tag; 47] = [
    holds("sdf", "version", "world model"),
    holds("world", "!name", "gravity model joint frame"),
    holds(
        "model",
        "!name canonical_link placement_frame",
        "pose static model link joint frame",
    ),
    holds(
        "link",
        "!name",
        "pose gravity inertial velocity_decay kinematic",
    ),
    holds("frame", "!name attached_to", "pose"),
    holds(
        "joint",
        "!name !type",
        "pose !parent !child axis axis2 thread_pitch screw_thread_pitch",
    ),
    holds(
        "axis",
        "",
        "xyz use_parent_model_frame dynamics limit mimic",
    ),
    holds(
        "axis2",
        "",
        "xyz use_parent_model_frame dynamics limit mimic",
    ),
    holds(
        "dynamics",
        "",
        "damping friction spring_reference spring_stiffness",
    ),
    holds(
        "limit",
        "",
        "lower upper effort velocity stiffness dissipation",
    ),
    holds("mimic", "!joint axis", "!multiplier offset reference"),
    holds("inertial", "auto", "pose mass inertia density"),
    holds("inertia", "", "ixx iyy izz ixy ixz iyz"),
    holds("velocity_decay", "", "linear angular"),
    Tag {
        name: "pose",
        kind: Kind::Pose,
        attributes: "relative_to frame degrees rotation_format",
        children: "",
    },
    Tag {
        name: "xyz",
        kind: Kind::Vector,
        attributes: "expressed_in",
        children: "",
    },
    value("gravity", Kind::Vector),
    value("static", Kind::Switch),
    value("kinematic", Kind::Switch),
    value("use_parent_model_frame", Kind::Switch),
    value("parent", Kind::Name),
    value("child", Kind::Name),
    value("mass", Kind::Number),
    value("density", Kind::Number),
    value("ixx", Kind::Number),
    value("iyy", Kind::Number),
    value("izz", Kind::Number),
    value("ixy", Kind::Number),
    value("ixz", Kind::Number),
    value("iyz", Kind::Number),
    value("damping", Kind::Number),
    value("friction", Kind::Number),
    value("spring_reference", Kind::Number),
    value("spring_stiffness", Kind::Number),
    value("lower", Kind::Bound),
    value("upper", Kind::Bound),
    value("effort", Kind::Bound),
    value("velocity", Kind::Bound),
    value("stiffness", Kind::Number),
    value("dissipation", Kind::Number),
    value("thread_pitch", Kind::Number),
    value("screw_thread_pitch", Kind::Number),
    value("multiplier", Kind::Number),
    value("offset", Kind::Number),
    value("reference", Kind::Number),
    value("linear", Kind::Number),
    value("angular", Kind::Number),
];
