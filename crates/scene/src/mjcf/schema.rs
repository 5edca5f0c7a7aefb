//! The part of MJCF that decides how a robot moves: its elements, the attributes that MuJoCo knows, and what their texts must be.

/// An element that is looked into.
#[derive(Debug)]
pub(super) struct Tag {
    /// The element that holds it, where the name alone does not tell.
    pub(super) inside: Option<&'static str>,
    /// Its name.
    pub(super) name: &'static str,
    /// Names of the attributes that it may have.
    pub(super) attributes: &'static str,
    /// Names of the elements that it may hold.
    pub(super) children: &'static str,
    /// Those of the attributes that are read, with what their texts must be.
    pub(super) read: &'static [(&'static str, Kind)],
    /// Those that must be there.
    pub(super) required: &'static [&'static str],
}

/// What the text of an attribute must be.
#[derive(Clone, Copy, Debug)]
pub(super) enum Kind {
    /// A text in one line, not empty.
    Name,
    /// At least and at most so many finite numbers.
    Numbers(usize, usize),
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Three letters of x, y, z, X, Y and Z.
    Sequence,
}

const SWITCH: Kind = Kind::Choice(&["true", "false"]);
const TRISTATE: Kind = Kind::Choice(&["true", "false", "auto"]);
const ENABLED: Kind = Kind::Choice(&["enable", "disable"]);

/// What a body holds.
const IN_BODY: &str = "inertial joint freejoint geom site camera light plugin composite flexcomp frame replicate body attach";

/// The kinds of actuators.
pub(super) const ACTUATORS: [&str; 13] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
    "plugin",
];

/// Attributes of joints, with those of defaults.
const JOINT: &str = "name class type group pos axis springdamper limited actuatorfrclimited solreflimit solimplimit solreffriction \
    solimpfriction stiffness range actuatorfrcrange actuatorgravcomp margin ref springref springyield armature damping frictionloss user";

const GEOM: &str = "name class type contype conaffinity condim group priority size material friction mass density shellinertia solmix \
    solref solimp margin gap fromto axisangle xyaxes zaxis euler hfield mesh fitscale rgba fluidshape fluidcoef user pos quat adhesion \
    castshadow surfacevel";

const ACTUATOR: &str = "name class group ctrllimited forcelimited actlimited ctrlrange forcerange actrange lengthrange gear cranklength \
    joint jointinparent tendon slidersite cranksite site refsite body user actdim dyntype gaintype biastype dynprm gainprm biasprm actearly \
    inheritrange kp kv ki dampratio timeconst tausmooth area diameter bias range force scale lmin lmax vmax fpmax fvmax gain plugin \
    instance armature damping delay interp nsample input velrange ffrange imax posrange slewmax cogging controller inductance lugre \
    motorconst nominal resistance saturation thermal";

// What places an element.
const POS: (&str, Kind) = ("pos", Kind::Numbers(3, 3));
const QUAT: (&str, Kind) = ("quat", Kind::Numbers(4, 4));
const AXISANGLE: (&str, Kind) = ("axisangle", Kind::Numbers(4, 4));
const EULER: (&str, Kind) = ("euler", Kind::Numbers(3, 3));
const XYAXES: (&str, Kind) = ("xyaxes", Kind::Numbers(6, 6));
const ZAXIS: (&str, Kind) = ("zaxis", Kind::Numbers(3, 3));

/// All of them.
pub(super) static TAGS: [Tag; 15] = [
    Tag {
        inside: None,
        name: "mujoco",
        attributes: "model",
        children: "compiler option size statistic visual default extension asset worldbody deformable contact tendon equality actuator \
            sensor keyframe custom include",
        read: &[("model", Kind::Name)],
        required: &[],
    },
    Tag {
        inside: None,
        name: "compiler",
        // The last three are those of earlier versions of MuJoCo.
        attributes: "alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict coordinate discardvisual eulerseq \
            fitaabb fusestatic inertiafromgeom inertiagrouprange meshdir passthrough savecanonical savecompiled saveinertial settotalmass \
            strippath texturedir usethread convexhull exactmeshinertia eulerdamp",
        children: "lengthrange",
        read: &[
            ("alignfree", SWITCH),
            ("angle", Kind::Choice(&["degree", "radian"])),
            ("autolimits", SWITCH),
            ("balanceinertia", SWITCH),
            ("boundinertia", Kind::Numbers(1, 1)),
            ("boundmass", Kind::Numbers(1, 1)),
            ("coordinate", Kind::Choice(&["local", "global"])),
            ("eulerseq", Kind::Sequence),
            ("fusestatic", SWITCH),
            ("inertiafromgeom", TRISTATE),
            ("inertiagrouprange", Kind::Numbers(2, 2)),
            ("settotalmass", Kind::Numbers(1, 1)),
        ],
        required: &[],
    },
    Tag {
        inside: None,
        name: "option",
        attributes: "actuatorgroupdisable ccd_iterations ccd_tolerance cone density gravity impratio integrator iterations jacobian \
            ls_iterations ls_tolerance magnetic noslip_iterations noslip_tolerance o_friction o_margin o_solimp o_solref sdf_initpoints \
            sdf_iterations sleep_tolerance solver timestep tolerance viscosity wind apirate collision mpr_iterations mpr_tolerance",
        children: "flag",
        read: &[
            ("gravity", Kind::Numbers(3, 3)),
            ("density", Kind::Numbers(1, 1)),
            ("viscosity", Kind::Numbers(1, 1)),
        ],
        required: &[],
    },
    Tag {
        inside: None,
        name: "flag",
        attributes: "actuation autoreset clampctrl constraint contact damper diagexact energy equality eulerdamp filterparent frictionloss \
            fwdinv gravity invdiscrete ipc island limit midphase multiccd nativeccd override refsafe sensor sleep speculative spring \
            warmstart passive sensornoise",
        children: "",
        read: &[
            ("gravity", ENABLED),
            ("spring", ENABLED),
            ("damper", ENABLED),
            ("passive", ENABLED),
            ("limit", ENABLED),
            ("frictionloss", ENABLED),
            ("equality", ENABLED),
            ("constraint", ENABLED),
        ],
        required: &[],
    },
    Tag {
        inside: None,
        name: "default",
        attributes: "class",
        children: "default mesh texture material joint geom site camera light pair equality tendon general motor position velocity \
            intvelocity orientation pid damper cylinder muscle adhesion dcmotor plugin",
        read: &[("class", Kind::Name)],
        required: &[],
    },
    Tag {
        inside: None,
        name: "worldbody",
        attributes: "",
        children: IN_BODY,
        read: &[],
        required: &[],
    },
    Tag {
        inside: None,
        name: "body",
        attributes: "name childclass pos quat axisangle xyaxes zaxis euler mocap gravcomp fuse simple sleep user",
        children: IN_BODY,
        read: &[
            ("name", Kind::Name),
            ("childclass", Kind::Name),
            ("mocap", SWITCH),
            ("gravcomp", Kind::Numbers(1, 1)),
            POS,
            QUAT,
            AXISANGLE,
            EULER,
            XYAXES,
            ZAXIS,
        ],
        required: &[],
    },
    Tag {
        inside: None,
        name: "frame",
        attributes: "name childclass pos quat axisangle xyaxes zaxis euler",
        children: IN_BODY,
        read: &[
            ("childclass", Kind::Name),
            POS,
            QUAT,
            AXISANGLE,
            EULER,
            XYAXES,
            ZAXIS,
        ],
        required: &[],
    },
    Tag {
        inside: None,
        name: "inertial",
        attributes: "pos quat axisangle xyaxes zaxis euler mass diaginertia fullinertia",
        children: "",
        read: &[
            ("mass", Kind::Numbers(1, 1)),
            ("diaginertia", Kind::Numbers(3, 3)),
            ("fullinertia", Kind::Numbers(6, 6)),
            POS,
            QUAT,
            AXISANGLE,
            EULER,
            XYAXES,
            ZAXIS,
        ],
        required: &["pos", "mass"],
    },
    Tag {
        inside: Some("equality"),
        name: "joint",
        attributes: "name class active solref solimp joint1 joint2 polycoef",
        children: "",
        read: &[
            ("joint1", Kind::Name),
            ("joint2", Kind::Name),
            ("polycoef", Kind::Numbers(1, 5)),
            ("active", SWITCH),
        ],
        required: &["joint1"],
    },
    Tag {
        inside: None,
        name: "joint",
        attributes: JOINT,
        children: "",
        read: &[
            ("name", Kind::Name),
            ("class", Kind::Name),
            ("type", Kind::Choice(&["free", "ball", "slide", "hinge"])),
            ("pos", Kind::Numbers(3, 3)),
            ("axis", Kind::Numbers(3, 3)),
            ("limited", TRISTATE),
            ("actuatorfrclimited", TRISTATE),
            ("range", Kind::Numbers(2, 2)),
            ("actuatorfrcrange", Kind::Numbers(2, 2)),
            ("ref", Kind::Numbers(1, 1)),
            ("springref", Kind::Numbers(1, 1)),
            ("springdamper", Kind::Numbers(2, 2)),
            ("stiffness", Kind::Numbers(1, 3)),
            ("damping", Kind::Numbers(1, 3)),
            ("armature", Kind::Numbers(1, 1)),
            ("frictionloss", Kind::Numbers(1, 1)),
        ],
        required: &[],
    },
    Tag {
        inside: None,
        name: "freejoint",
        attributes: "name group align",
        children: "",
        read: &[("name", Kind::Name), ("align", TRISTATE)],
        required: &[],
    },
    Tag {
        inside: None,
        name: "geom",
        attributes: GEOM,
        children: "plugin",
        read: &[
            ("name", Kind::Name),
            ("class", Kind::Name),
            (
                "type",
                Kind::Choice(&[
                    "plane",
                    "hfield",
                    "sphere",
                    "capsule",
                    "ellipsoid",
                    "cylinder",
                    "box",
                    "mesh",
                    "sdf",
                ]),
            ),
            ("size", Kind::Numbers(1, 3)),
            ("fromto", Kind::Numbers(6, 6)),
            ("mass", Kind::Numbers(1, 1)),
            ("density", Kind::Numbers(1, 1)),
            ("shellinertia", SWITCH),
            ("group", Kind::Numbers(1, 1)),
            ("rgba", Kind::Numbers(4, 4)),
            POS,
            QUAT,
            AXISANGLE,
            EULER,
            XYAXES,
            ZAXIS,
        ],
        required: &[],
    },
    Tag {
        inside: None,
        name: "site",
        attributes: "name class type group pos quat material size fromto axisangle xyaxes zaxis euler rgba user mesh",
        children: "",
        read: &[
            ("name", Kind::Name),
            ("class", Kind::Name),
            ("fromto", Kind::Numbers(6, 6)),
            POS,
            QUAT,
            AXISANGLE,
            EULER,
            XYAXES,
            ZAXIS,
        ],
        required: &[],
    },
    Tag {
        inside: None,
        name: "equality",
        attributes: "active solref solimp",
        children: "connect weld joint tendon flex flexstrain flexvert distance",
        read: &[("active", SWITCH)],
        required: &[],
    },
];

/// What is read of an actuator.
static IN_ACTUATOR: Tag = Tag {
    inside: Some("actuator"),
    name: "actuator",
    attributes: ACTUATOR,
    children: "config plugin",
    read: &[
        ("name", Kind::Name),
        ("class", Kind::Name),
        ("joint", Kind::Name),
        ("ctrlrange", Kind::Numbers(2, 2)),
        ("forcerange", Kind::Numbers(2, 2)),
        ("ctrllimited", TRISTATE),
        ("forcelimited", TRISTATE),
        ("gear", Kind::Numbers(1, 6)),
        ("gainprm", Kind::Numbers(1, 10)),
        ("armature", Kind::Numbers(1, 1)),
        ("damping", Kind::Numbers(1, 3)),
    ],
    required: &[],
};

/// The section of the actuators.
static SECTION: Tag = Tag {
    inside: None,
    name: "actuator",
    attributes: "",
    children: "general motor position velocity intvelocity orientation pid damper cylinder muscle adhesion dcmotor plugin",
    read: &[],
    required: &[],
};

/// The element of that name inside another, if it is one that is looked into.
pub(super) fn tag(inside: &str, name: &str) -> Option<&'static Tag> {
    match (inside, name) {
        ("mujoco", "actuator") => Some(&SECTION),
        ("actuator", name) if ACTUATORS.contains(&name) => Some(&IN_ACTUATOR),
        // Defaults of actuators are those of general ones; a default of plugins says nothing that is read.
        ("default", name) if name != "plugin" && ACTUATORS.contains(&name) => Some(&IN_ACTUATOR),
        ("default", "equality") => None,
        _ => TAGS
            .iter()
            .find(|tag| tag.name == name && tag.inside.is_none_or(|wanted| wanted == inside)),
    }
}
