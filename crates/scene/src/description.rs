//! What a scene file says, checked as far as that goes without knowing the joints.

use crate::control::ControllerDescription;
use crate::coupling::Coupling;
use crate::event::EventDescription;
use crate::forces::{
    ConstraintDescription, FrameDescription, JointForces, PointSpring, WrenchDescription,
};
use crate::settings::Settings;
use crate::shape::ShapeDescription;
use crate::source::{Located, Span};
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Vector3, Vector6};

/// A scene whose text is sound by itself; [`SceneDescription::build`] adds the joints.
#[derive(Clone, Debug)]
pub struct SceneDescription {
    /// Name of the scene.
    pub name: String,
    /// What the scene shows; may be empty.
    pub description: String,
    /// Acceleration of gravity in world axes, m/s².
    pub gravity: Vector3<f64>,
    /// The bodies, each after its parent; those that mimic joints couple follow each other.
    pub bodies: Vec<BodyDescription>,
    /// Loops that joints between bodies of the tree close.
    pub loops: Vec<LoopDescription>,
    /// Sums of positions of joints that are proportional.
    pub couplings: Vec<CouplingDescription>,
    /// Named frames.
    pub frames: Vec<FrameDescription>,
    /// Springs between points.
    pub springs: Vec<PointSpring>,
    /// Wrenches on bodies.
    pub wrenches: Vec<WrenchDescription>,
    /// Forbidden velocities of points.
    pub constraints: Vec<ConstraintDescription>,
    /// What is to be noticed on the way.
    pub events: Vec<EventDescription>,
    /// What stands for bodies in pictures.
    pub shapes: Vec<ShapeDescription>,
    /// What controls the mechanism, if anything does.
    pub controller: Option<ControllerDescription>,
    /// Simulation settings.
    pub settings: Settings,
    pub(crate) source: Source,
}

impl SceneDescription {
    /// A scene without anything in it.
    pub(crate) fn empty(source: Source) -> Self {
        Self {
            name: String::new(),
            description: String::new(),
            gravity: Vector3::zeros(),
            bodies: Vec::new(),
            loops: Vec::new(),
            couplings: Vec::new(),
            frames: Vec::new(),
            springs: Vec::new(),
            wrenches: Vec::new(),
            constraints: Vec::new(),
            events: Vec::new(),
            shapes: Vec::new(),
            controller: None,
            settings: Settings::default(),
            source,
        }
    }
}

/// A source text and what messages call it.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    /// What messages call the text.
    pub(crate) name: String,
    /// The text itself.
    pub(crate) text: String,
}

/// One body and the joint that it hangs on.
#[derive(Clone, Debug)]
pub struct BodyDescription {
    /// Name, unique in the scene.
    pub name: Located<String>,
    /// Index of the parent body in [`SceneDescription::bodies`]; `None` is the world.
    pub parent: Option<usize>,
    /// Mass, centre of mass and inertia.
    pub mass: MassProperties,
    /// The joint; of a joint that carries several bodies, each of them has it.
    pub joint: JointDescription,
    /// Which body of its joint it is, where the joint carries several.
    pub part: Option<Part>,
    /// The joint's parent frame in the parent body's frame.
    pub at: Pose<f64>,
    /// The body's frame in the joint's child frame.
    pub body_at: Pose<f64>,
    /// State at time 0.
    pub initial: InitialDescription,
    /// What acts at the joint.
    pub forces: JointForces,
    /// The joint that it follows, if it follows one.
    pub mimic: Option<Located<MimicDescription>>,
}

/// What a joint follows: its angle or displacement is `multiplier · y + offset`, with the y of another joint.
#[derive(Clone, Debug, PartialEq)]
pub struct MimicDescription {
    /// Name of the other joint.
    pub joint: Located<String>,
    /// Not 0.
    pub multiplier: f64,
    /// rad or m.
    pub offset: f64,
}

/// A loop: two bodies of the tree that a joint holds together.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopDescription {
    /// Name, unique among loops and couplings.
    pub name: Located<String>,
    /// The joint.
    pub closing: Closing,
    /// What it holds together: the frames of the joint on the predecessor and on the successor.
    pub ends: [LoopEnd; 2],
    /// Names of joints of the loop that move independently; where there are fewer than its degrees of freedom, others are chosen.
    pub independent: Vec<Located<String>>,
}

/// Where the joint of a loop holds a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopEnd {
    /// Index of the body; `None` is the world.
    pub body: Option<usize>,
    /// The frame of the joint in that of the body.
    pub at: Pose<f64>,
}

/// The joint that closes a loop, by how the second frame moves in the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Closing {
    /// It turns about the common z axis.
    Revolute,
    /// It slides along the common z axis.
    Prismatic,
    /// It turns about the common z axis and slides along it.
    Cylindrical,
    /// It turns about z and slides across it.
    Planar,
    /// It turns about the common origin.
    Spherical,
    /// It turns about the z axes of both frames, which are at right angles and meet.
    Universal,
    /// Not at all.
    Fixed,
}

impl Closing {
    /// Names, as scenes write them.
    pub const NAMES: [&'static str; 7] = [
        "revolute",
        "prismatic",
        "cylindrical",
        "planar",
        "spherical",
        "universal",
        "fixed",
    ];

    /// By its name.
    pub fn of(name: &str) -> Option<Self> {
        let all = [
            Self::Revolute,
            Self::Prismatic,
            Self::Cylindrical,
            Self::Planar,
            Self::Spherical,
            Self::Universal,
            Self::Fixed,
        ];
        let place = Self::NAMES.iter().position(|known| *known == name)?;
        all.get(place).copied()
    }

    /// As scenes write it.
    pub fn name(self) -> &'static str {
        let mut names = Self::NAMES.into_iter();
        names
            .find(|name| Self::of(name) == Some(self))
            .unwrap_or("")
    }
}

/// `Σ y = ratio · Σ y + offset`: of the joints on the way to the successor, and to the predecessor, from the last body that carries both.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingDescription {
    /// Name, unique among loops and couplings.
    pub name: Located<String>,
    /// Indices of predecessor and successor; `None` is the world.
    pub ends: [Option<usize>; 2],
    /// Not 0.
    pub ratio: f64,
    /// rad or m.
    pub offset: f64,
    /// Names of joints on the ways that move independently; where there are fewer than its degrees of freedom, others are chosen.
    pub independent: Vec<Located<String>>,
}

/// One of several bodies of a joint. They follow each other, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The name of the body within its joint; its full name is `joint.name`.
    pub name: Located<String>,
    /// Its place among the bodies of the joint, from 0.
    pub number: usize,
}

impl BodyDescription {
    /// Whether the state of its joint, and what acts there, are its own: it is the only body of the joint, or the first.
    pub fn leads(&self) -> bool {
        self.part.as_ref().is_none_or(|part| part.number == 0)
    }
}

/// A joint by name, with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct JointDescription {
    /// Name of the joint, unique in the scene; the body's name where the file gives none.
    pub name: Located<String>,
    /// Name of the joint's type, looked up in the registry.
    pub kind: Located<String>,
    /// Parameters of the type, in the order of the file.
    pub parameters: Vec<(Located<String>, f64)>,
    /// What [`SceneDescription::coupled`] has made one joint; no type of the registry then.
    pub coupling: Option<Coupling>,
    /// Where the joint stands in the file.
    pub span: Span,
}

/// State of one joint at time 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InitialDescription {
    /// Where the joint stands.
    pub position: Position,
    /// How it moves.
    pub motion: Motion,
}

/// Configuration of one joint at time 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Position {
    /// The joint type's home.
    #[default]
    Home,
    /// The stored scalars of Q, matrices row by row.
    Configuration(Located<Vec<f64>>),
    /// Local coordinates ϕ from home.
    Phi(Located<Vec<f64>>),
    /// Pose of the joint's child frame in its parent frame.
    Pose(Located<Pose<f64>>),
}

/// Velocity of one joint at time 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Motion {
    /// Every speed is 0.
    #[default]
    Rest,
    /// All degrees of freedom v, which must satisfy the joint's constraint.
    Velocity(Located<Vec<f64>>),
    /// Speeds v̄.
    Speeds(Located<Vec<f64>>),
    /// Twist of the joint's child frame relative to its parent frame.
    Twist(Located<TwistDescription>),
    /// Rates of ports, which determine all speeds.
    Rates(Located<Vec<PortRate>>),
}

/// The rate of one port.
#[derive(Clone, Debug, PartialEq)]
pub struct PortRate {
    /// Name of the port.
    pub name: Located<String>,
    /// rad/s or m/s.
    pub rate: f64,
}

/// A twist and the axes in which it is read.
#[derive(Clone, Debug, PartialEq)]
pub struct TwistDescription {
    /// Angular velocity, rad/s, above linear velocity, m/s.
    pub twist: Vector6<f64>,
    /// The frame of both parts.
    pub frame: TwistFrame,
}

/// The frame in which a relative twist is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TwistFrame {
    /// The joint's child frame: vee(H⁻¹ Ḣ); the linear part is the velocity of the child frame's origin.
    Child,
    /// The joint's parent frame: vee(Ḣ H⁻¹); the linear part belongs to the point at the parent frame's origin.
    Parent,
}

impl TwistFrame {
    /// Names of both frames, as scene files write them.
    pub const NAMES: [&'static str; 2] = ["child", "parent"];
}
