//! What the equations of motion of a scene are solved in, and how that is decided where it is left open.

use hamel_integrate::{IntegrateError, RoundingLimit, Solution};
use hamel_runtime::dynamics::{Dynamics, Recursive, Refined};
use hamel_runtime::mechanism::Mechanism;
use std::sync::Arc;

/// Names of the kinds of arithmetic, as scene files and the command line write them.
pub(crate) const ARITHMETIC_NAMES: [&str; 3] = [
    Arithmetic::Doubles.name(),
    Arithmetic::Refined.name(),
    Arithmetic::Auto.name(),
];

/// What the equations of motion are solved in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arithmetic {
    /// Doubles alone: [`Recursive`].
    #[default]
    Doubles,
    /// Doubles with residuals in numbers of 106 bits, for light bodies that carry heavy ones: [`Refined`].
    Refined,
    /// Doubles, unless a motion in doubles shows that their rounding decides its accuracy ([`Arithmetic::reason_to_refine`]): then as [`Arithmetic::Refined`].
    Auto,
}

impl Arithmetic {
    /// As scene files and the command line write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Doubles => "doubles",
            Self::Refined => "refined",
            Self::Auto => "auto",
        }
    }

    /// The arithmetic of that name; `None` where none has it.
    pub fn named(name: &str) -> Option<Self> {
        let all = [Self::Doubles, Self::Refined, Self::Auto];
        all.into_iter().find(|own| own.name() == name)
    }

    /// The equations of motion of a mechanism; in doubles as long as the choice is open.
    pub fn dynamics(self, mechanism: &Arc<Mechanism>) -> Box<dyn Dynamics> {
        let mechanism = Arc::clone(mechanism);
        match self {
            Self::Doubles | Self::Auto => Box::new(Recursive::new(mechanism)),
            Self::Refined => Box::new(Refined::new(mechanism)),
        }
    }

    /// Why a motion wants [`Arithmetic::Refined`] after it `ended` like this in doubles: rounding decided the length of steps, or made them too short to go on.
    /// `None` where it does not, and where the choice is not left open. Methods of fixed steps do not tell.
    pub fn reason_to_refine(self, ended: Result<&Solution, &IntegrateError>) -> Option<String> {
        if self != Self::Auto {
            return None;
        }
        match ended {
            Ok(solution) => solution.rounding.as_ref().map(|limit| {
                let RoundingLimit { steps, joint, .. } = limit;
                format!("rounding in doubles decides the length of {steps} steps, first of all at joint `{joint}`")
            }),
            Err(
                error @ (IntegrateError::StepUnderflow { .. }
                | IntegrateError::Hopeless { .. }
                | IntegrateError::Unsolved { .. }
                | IntegrateError::AtState { .. }),
            ) => Some(format!("in doubles the motion does not come to its end: {error}")),
            Err(_) => None,
        }
    }
}
