//! Scene files of Hamel: a mechanism, its initial state, what acts on it and how to simulate it, in TOML; and robots in
//! [URDF](urdf), [MJCF](mjcf) and [SDF](sdf), by [`robot`].
//!
//! A file is read in two steps. [`Scene::from_toml`] reads what the text says by itself and gives a
//! [`SceneDescription`]; [`SceneDescription::build`] looks the joints up in a [`JointRegistry`](hamel_runtime::registry::JointRegistry),
//! solves for their initial state and gives a [`Scene`]. [`Scene::load`] does both, and then reports the errors of both
//! steps together. Errors are [`Diagnostics`]: all mistakes of a file, each with the line it stands on.

mod arithmetic;
mod build;
mod choose;
mod control;
mod coupling;
mod description;
mod diagnostics;
mod event;
mod forces;
mod kind;
pub mod mjcf;
mod notice;
mod parse;
mod read;
pub mod robot;
mod samples;
mod scene;
pub mod sdf;
mod settings;
mod shape;
mod source;
mod start;
mod starts;
pub mod suggest;
pub mod text;
pub mod urdf;
mod write;

pub use arithmetic::Arithmetic;
pub use choose::Company;
pub use control::{
    Control, ControllerDescription, GoalDescription, LawDescription, PortDescription,
    ReferenceDescription, RegulatorDescription,
};
pub use coupling::Coupling;
pub use description::{
    BodyDescription, Closing, CouplingDescription, InitialDescription, JointDescription,
    LoopDescription, LoopEnd, MimicDescription, Motion, Part, PortRate, Position, SceneDescription,
    TwistDescription, TwistFrame,
};
pub use diagnostics::{Diagnostic, Diagnostics};
pub use event::{EventDescription, PointAlong, PortOf, Quantity, QuantityDescription, SceneEvent};
pub use forces::{
    BodyPoint, ConstraintDescription, FrameDescription, FrictionDescription, JointForces,
    JointSpring, LimitDescription, LimitKind, LimitOwner, PerFreedom, PointSpring, PortForces,
    PortSpringDescription, SpringEnergy, WrenchAxes, WrenchDescription,
};
pub use notice::{Notice, Severity};
pub use samples::SampleError;
pub use scene::{Scene, read_file};
pub use settings::Settings;
pub use shape::{Geometry, Mesh, ShapeDescription};
pub use source::{Located, Span};
pub use start::StartError;
pub use starts::{StartNumber, Starts};
