//! The global error of a motion: how far its states are from those of the exact motion, estimated from companion motions.
//!
//! Two companions repeat the motion with coarser steps. Their distances from the motion tell how its error falls with the steps, and so what is left of
//! it: errors are nearly proportional to tolerances (L. F. Shampine, *Tolerance proportionality in ODE codes*, 1989). A third one begins
//! beside the first state: the distance to which it is carried away is the conditioning of the motion, which also multiplies rounding.
//! The companions together take about as many evaluations as the motion.
//!
//! Coarser companions tell nothing where the tolerance decides the length of few steps, as where inputs are held or joints stick, and little of methods of high order where something
//! bends. Such motions are compared with one of an eighth of their error, which takes up to one and a half times as many evaluations as they do, and so does a neighbour.

mod accelerations;
mod companion;
mod estimation;
mod request;
mod rounding;

use super::{Observer, Options, Solution, State};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::{Display, Formatter};
use estimation::{Estimation, OSCILLATIONS};
use hamel_runtime::dynamics::Dynamics;

pub use request::Tuned;

/// The largest of the errors of all bodies: of attitudes in rad; of positions, velocities and angular velocities as parts of max(1 SI unit, size).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorParts {
    /// From the steps of the method.
    pub steps: f64,
    /// From rounding.
    pub rounding: f64,
}

impl ErrorParts {
    /// Both together.
    pub const fn total(&self) -> f64 {
        self.steps + self.rounding
    }
}

/// Why an estimate is not reliable.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// The error is too large for anything about it to be linear.
    Large,
    /// The error of companions does not fall with their steps as the order of the method says.
    Order {
        /// The order by which it falls.
        observed: f64,
        /// The order of the method.
        order: u32,
    },
    /// A companion takes steps as short as those of the motion: something else than the error limits them.
    Steps,
    /// Steps are longer than oscillations, whose rounding no companion tells.
    Oscillations,
    /// Steps of fixed size are too long for what acts on the mechanism as a function of time.
    Unseen {
        /// Such steps.
        count: usize,
    },
    /// A companion goes through other impacts, stops and starts of joints, or through them in another order.
    Pieces {
        /// What the motion does where they first differ; nothing where it has no more.
        motion: String,
        /// What the companion does there.
        companion: String,
    },
    /// A companion does not come to the end.
    Companion(String),
}

impl Display for Doubt {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Large => f.write_str("the error may be more than 1 % of the motion"),
            Self::Order { observed, order } => write!(
                f,
                "the error of coarser motions falls with order {observed:.1}, the method is of order {order}"
            ),
            Self::Steps => f.write_str(
                "step sizes are limited by something else than the tolerance, such as samples or stability: motions of other tolerances take nearly the same steps",
            ),
            Self::Oscillations => f.write_str(
                "the method takes steps longer than oscillations: how rounding adds up over these is not known",
            ),
            Self::Unseen { count } => write!(
                f,
                "what acts on the mechanism changes with time faster than {count} of the steps see: take a smaller dt, or a method with step control"
            ),
            Self::Pieces { motion, companion } => {
                let told = |what: &str| match what {
                    "" => String::from("nothing more"),
                    what => format!("`{what}`"),
                };
                let (motion, companion) = (told(motion), told(companion));
                write!(
                    f,
                    "a motion of another tolerance goes through other impacts, stops and starts of joints: {companion} where this one has {motion}"
                )
            }
            Self::Companion(cause) => write!(f, "a coarser motion fails: {cause}"),
        }
    }
}

/// The estimate of the error of a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct GlobalError {
    /// Of each sample of the solution; between times at which the motion was compared, that of the worse one of the two beside it.
    pub samples: Vec<ErrorParts>,
    /// Of the last state.
    pub end: ErrorParts,
    /// Change of the last state per change of the initial speeds, each as a part of the largest of its joint in the motion; absent where that was not found.
    pub conditioning: Option<f64>,
    /// Why it may be wrong by more than a factor of ten, if so.
    pub doubt: Option<Doubt>,
    /// Evaluations of the equations of motion by the companions.
    pub evaluations: usize,
}

/// Runs a companion from this state by these options, with the same inputs as the motion, and without its events; else why there is none.
pub type Run<'a> = dyn FnMut(&State, &Options, &mut Observer<'_>) -> Result<Solution, String> + 'a;

impl GlobalError {
    /// Whether the error of the last state is at most `wanted`, and the estimate that says so reliable.
    pub fn confirms(&self, wanted: f64) -> bool {
        let is_reliable = match self.doubt {
            None => true,
            // Rounding that is not known is less than this.
            Some(Doubt::Oscillations) => wanted >= OSCILLATIONS,
            Some(_) => false,
        };
        is_reliable && self.end.total() <= wanted
    }

    /// The error of `solution`, which was computed from `initial` by `options`, with equations of motion such as `dynamics` has.
    pub fn estimate(
        dynamics: &mut dyn Dynamics,
        initial: &State,
        options: &Options,
        solution: &Solution,
        run: &mut Run<'_>,
    ) -> Self {
        Estimation::new(dynamics, initial, options, solution, run).finish()
    }
}
