//! What a mechanism refuses, in its construction and in its state.

use super::{FrameFault, SeveralFault};
use crate::erased::FiniteMapError;
use crate::joint::MOST_FREEDOMS;
use crate::shown::Number;
use crate::spatial::{MassError, PoseError};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::{Display, Formatter};
use core::ops::Deref;

/// The functions whose zeros a joint must stay away from, for messages: `` `f` `` or `` `f` or `g` ``.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Loci(pub &'static [&'static str]);

impl Display for Loci {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        for (i, locus) in self.0.iter().enumerate() {
            let between = if i > 0 { " or " } else { "" };
            write!(f, "{between}`{locus}`")?;
        }
        Ok(())
    }
}

/// Why a mechanism cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MechanismError {
    /// Gravity is NaN or infinite.
    #[error("gravity component {axis} is {value}, not a finite number", value = Number(*.value))]
    Gravity {
        /// `x`, `y` or `z`.
        axis: char,
        /// Its value.
        value: f64,
    },
    /// Two bodies share a name.
    #[error("body {index} has the name `{body}`, which body {first} has already")]
    DuplicateName {
        /// The name.
        body: String,
        /// Index of the second body of that name.
        index: usize,
        /// Index of the first.
        first: usize,
    },
    /// The parent does not come before its child.
    #[error(
        "body `{body}` (index {index}) has parent index {parent}: a parent comes before its children"
    )]
    Parent {
        /// The body.
        body: String,
        /// Its index.
        index: usize,
        /// The parent's index as given.
        parent: usize,
    },
    /// A named frame.
    #[error("frame `{frame}`: {fault}")]
    Frame {
        /// The frame.
        frame: String,
        /// What is wrong with it.
        fault: FrameFault,
    },
    /// A fixed placement is no pose.
    #[error("body `{body}`, {which}: {cause}")]
    Placement {
        /// The body.
        body: String,
        /// `placement` or `child placement`.
        which: &'static str,
        /// What is wrong with it.
        cause: PoseError,
    },
    /// The mass properties are not those of a rigid body.
    #[error("body `{body}`: {cause}")]
    Mass {
        /// The body.
        body: String,
        /// What is wrong with them.
        cause: MassError,
    },
    /// A value computed from finite numbers overflows.
    #[error("body `{body}`: {what} is beyond the range of numbers")]
    Overflow {
        /// The body.
        body: String,
        /// What is too large.
        what: &'static str,
    },
    /// A joint that has not as many speeds and constraints as degrees of freedom, or more than [`MOST_FREEDOMS`] of these.
    #[error(
        "joint `{joint}`: it has {freedoms} degrees of freedom, {speeds} speeds and {constraints} constraints: there must be at most {MOST_FREEDOMS} \
         degrees of freedom, as many as speeds and constraints together"
    )]
    Layout {
        /// The joint.
        joint: String,
        /// K.
        freedoms: usize,
        /// S.
        speeds: usize,
        /// C.
        constraints: usize,
    },
    /// A body of a joint that carries several does not stand with the others.
    #[error("body `{body}`: {fault}")]
    Several {
        /// The body.
        body: String,
        /// What is wrong with it.
        fault: SeveralFault,
    },
    /// The joint's home is not on its own manifold, or not finite.
    #[error(
        "joint `{joint}`: its home configuration is off its manifold by {residual:e}, more than {limit:e}"
    )]
    Home {
        /// The joint.
        joint: String,
        /// Residual of the manifold's relations.
        residual: f64,
        /// Largest residual allowed.
        limit: f64,
    },
    /// A linkage has no home: near the guess of its spec no configuration meets its relations.
    #[error(
        "joint `{joint}`: near the guess `home near` of its spec no configuration meets its relations{}", with_parameters(.parameters)
    )]
    Assembly {
        /// The joint.
        joint: String,
        /// Its parameters with their values.
        parameters: String,
    },
    /// The joint is singular at home.
    #[error(
        "joint `{joint}`: it is singular where {loci} is 0, and at home the least of these is {value}", value = Number(*.value))]
    Singular {
        /// The joint.
        joint: String,
        /// The functions whose zeros it must stay away from.
        loci: Loci,
        /// Least absolute value: 0, or not finite.
        value: f64,
    },
    /// X or S̄ loses rank at home.
    #[error(
        "joint `{joint}`: its {which} is rank-deficient at home: the smallest pivot is {ratio:e} of the largest, the limit \
         is {limit:e}"
    )]
    RankDeficient {
        /// The joint.
        joint: String,
        /// `twist map` or `speed basis`.
        which: &'static str,
        /// Smallest over largest pivot.
        ratio: f64,
        /// Smallest ratio allowed.
        limit: f64,
    },
    /// The configuration at which dependent speeds are to be chosen.
    #[error(transparent)]
    Configuration(StateError),
    /// A constraint depends on the others.
    #[error(
        "constraint `{constraint}`: it depends on the other constraints, or forbids nothing that the joints allow: its pivot is {ratio:e} of \
         the largest, the limit is {limit:e}"
    )]
    DependentConstraint {
        /// The constraint.
        constraint: String,
        /// Pivot over largest entry.
        ratio: f64,
        /// Smallest ratio allowed.
        limit: f64,
    },
    /// Constraints in a mechanism that is too large for them.
    #[error(
        "the mechanism has {speeds} speeds: constraints that couple joints take dense matrices, and with them at most {limit} are possible"
    )]
    Coupled {
        /// How many speeds there are.
        speeds: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A spring, damper, rotor inertia, drive or the like does not fit.
    #[error(transparent)]
    Element(#[from] crate::elements::ElementError),
}

/// Everything that is wrong with a mechanism; never empty. A slice of [`MechanismError`], printed one a line.
#[derive(Clone, Debug, PartialEq)]
pub struct MechanismErrors(Vec<MechanismError>);

impl MechanismErrors {
    /// `errors`, if there are any.
    pub(super) fn check(errors: Vec<MechanismError>) -> Result<(), Self> {
        match errors.is_empty() {
            true => Ok(()),
            false => Err(Self(errors)),
        }
    }
}

impl From<MechanismError> for MechanismErrors {
    fn from(error: MechanismError) -> Self {
        Self(alloc::vec![error])
    }
}

impl FromIterator<MechanismError> for MechanismErrors {
    fn from_iter<I: IntoIterator<Item = MechanismError>>(errors: I) -> Self {
        Self(errors.into_iter().collect())
    }
}

impl Deref for MechanismErrors {
    type Target = [MechanismError];

    fn deref(&self) -> &[MechanismError] {
        &self.0
    }
}

impl IntoIterator for MechanismErrors {
    type Item = MechanismError;
    type IntoIter = alloc::vec::IntoIter<MechanismError>;

    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl Display for MechanismErrors {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        for (i, error) in self.iter().enumerate() {
            let between = if i > 0 { "\n" } else { "" };
            write!(f, "{between}{error}")?;
        }
        Ok(())
    }
}

impl core::error::Error for MechanismErrors {}

/// Why a state, or a part of one, is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StateError {
    /// A vector of the wrong size.
    #[error("{quantity} of {element} has {found} entries: it must have {expected}")]
    Size {
        /// Joint or `the mechanism`.
        element: String,
        /// Which vector.
        quantity: &'static str,
        /// Size it must have.
        expected: usize,
        /// Size given.
        found: usize,
    },
    /// No body has that index.
    #[error("there is no body of index {index}: the mechanism has {count}")]
    UnknownBody {
        /// The index given.
        index: usize,
        /// How many bodies there are.
        count: usize,
    },
    /// No named frame has that index.
    #[error("there is no frame of index {index}: the mechanism has {count}")]
    UnknownFrame {
        /// The index given.
        index: usize,
        /// How many frames there are.
        count: usize,
    },
    /// A number is NaN or infinite.
    #[error("joint `{joint}`: {quantity} entry `{entry}` is {value}, not a finite number", value = Number(*.value))]
    NotFinite {
        /// The joint.
        joint: String,
        /// Which vector.
        quantity: &'static str,
        /// Name of the entry.
        entry: &'static str,
        /// Its value.
        value: f64,
    },
    /// A kernel of a joint, or what follows from it, has no value.
    #[error("the {what} of joint `{joint}` is not finite")]
    NoValue {
        /// The joint.
        joint: String,
        /// `pose`, `twist map` and the like.
        what: &'static str,
    },
    /// The energy is beyond the range of numbers.
    #[error(
        "the energy of {} is beyond the range of numbers: the limit is {:e} J",
        Owner(of.as_deref()), f64::MAX
    )]
    Energy {
        /// The body; absent where it is that of springs, rotors or all bodies together.
        of: Option<String>,
    },
    /// Q is not on the joint's manifold.
    #[error(
        "joint `{joint}`: its configuration is off its manifold by {residual:e}, more than {limit:e}"
    )]
    OffManifold {
        /// The joint.
        joint: String,
        /// Residual of the manifold's relations.
        residual: f64,
        /// Largest residual allowed.
        limit: f64,
    },
    /// A joint is beyond a limit of its own.
    #[error(
        "joint `{joint}`: its coordinate `{coordinate}` is {value}, beyond its {side} limit {limit}",
        value = Number(*.value), limit = Number(*.limit)
    )]
    BeyondLimit {
        /// The joint.
        joint: String,
        /// Name of the coordinate.
        coordinate: &'static str,
        /// Its value.
        value: f64,
        /// `lower` or `upper`.
        side: &'static str,
        /// The limit.
        limit: f64,
    },
    /// The configuration is singular.
    #[error("joint `{joint}`: it is singular where {loci} is 0, and the least of these is {value}", value = Number(*.value))]
    Singular {
        /// The joint.
        joint: String,
        /// The functions whose zeros it must stay away from.
        loci: Loci,
        /// Least absolute value: 0, or not finite.
        value: f64,
    },
    /// A finite map of the joint fails.
    #[error("joint `{joint}`: {cause}")]
    FiniteMap {
        /// The joint.
        joint: String,
        /// Which map.
        cause: FiniteMapError,
    },
    /// The pose given is no pose.
    #[error("joint `{joint}`: {cause}")]
    Pose {
        /// The joint.
        joint: String,
        /// What is wrong with it.
        cause: PoseError,
    },
    /// The joint cannot take the pose.
    #[error(
        "joint `{joint}` cannot take this pose: the nearest that was found is {angle:e} rad and {distance:e} m away, more \
         than {limit:e}"
    )]
    OutOfReach {
        /// The joint.
        joint: String,
        /// Angle that remains, rad.
        angle: f64,
        /// Distance that remains, m.
        distance: f64,
        /// Largest remainder allowed.
        limit: f64,
    },
    /// The joint cannot move with the twist.
    #[error(
        "joint `{joint}` cannot move with this twist: {residual:e} of it remains, more than {limit:e}"
    )]
    TwistOutsideFreedoms {
        /// The joint.
        joint: String,
        /// Norm of the part that no velocity produces.
        residual: f64,
        /// Largest remainder allowed.
        limit: f64,
    },
    /// The joint has no port of that index.
    #[error("joint `{joint}` has no port of index {index}: it has {count}")]
    UnknownPort {
        /// The joint.
        joint: String,
        /// The index given.
        index: usize,
        /// How many ports it has.
        count: usize,
    },
    /// Rates at ports that do not determine all speeds.
    #[error(
        "joint `{joint}`: the rates of these ports determine {rank} of its speeds here, it has {speeds}"
    )]
    PortRatesLeaveOpen {
        /// The joint.
        joint: String,
        /// Rank of their rows of P S̄.
        rank: usize,
        /// How many speeds the joint has.
        speeds: usize,
    },
    /// Rates at ports that the joint cannot have together.
    #[error(
        "joint `{joint}`: its ports cannot have these rates together: {residual:e} of them remains, more than {limit:e}"
    )]
    PortRatesContradict {
        /// The joint.
        joint: String,
        /// Norm of the part that no speeds produce.
        residual: f64,
        /// Largest remainder allowed.
        limit: f64,
    },
    /// A velocity that the nonholonomic constraint forbids.
    #[error(
        "joint `{joint}`: its velocity violates the nonholonomic constraint, |Aᵀv| = {value:e}, more than {limit:e}"
    )]
    ConstraintViolated {
        /// The joint.
        joint: String,
        /// Largest entry of Aᵀv.
        value: f64,
        /// Largest value allowed.
        limit: f64,
    },
}

/// Whose energy it is.
struct Owner<'a>(Option<&'a str>);

impl Display for Owner<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        match self.0 {
            Some(body) => write!(f, "body `{body}`"),
            None => f.write_str("the mechanism"),
        }
    }
}

/// What a linkage cannot be assembled with, if it has parameters.
fn with_parameters(parameters: &str) -> String {
    match parameters {
        "" => String::new(),
        some => format!(": it cannot be put together with {some}"),
    }
}
