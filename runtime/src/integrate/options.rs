//! What an integration is asked to do.

use super::IntegrateError;
use super::dop853::DORMAND_PRINCE_8;
use super::tableau::{CLASSICAL, DORMAND_PRINCE, Tableau};
use super::verner::VERNER_9;
use alloc::vec::Vec;

/// Which equations of motion are integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// State (Q, v̄), (24), (34).
    Lagrangian,
    /// State (Q, p̄), (27), (35).
    Hamiltonian,
}

/// Which method integrates them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The classical method of order 4, fixed step `dt` (s); steps that land on a sample time are shorter.
    Rk4 {
        /// Step, s.
        dt: f64,
    },
    /// An embedded pair with step control.
    Controlled {
        /// Which pair.
        pair: Pair,
        /// How accurate its steps shall be.
        control: Control,
    },
}

/// Explicit methods with an estimate of their own error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// Dormand and Prince's of order 5(4).
    DormandPrince,
    /// Dormand and Prince's of order 8(5,3), known as DOP853: for tolerances below 1e-8 or so.
    DormandPrince8,
    /// Verner's of order 9(8): for tolerances near rounding, which its result feels less than that of DOP853.
    Verner9,
}

impl Pair {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::DormandPrince, Self::DormandPrince8, Self::Verner9];

    /// As scenes and the command line write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::DormandPrince => "dopri5",
            Self::DormandPrince8 => "dop853",
            Self::Verner9 => "verner9",
        }
    }

    /// Its coefficients.
    pub const fn tableau(self) -> &'static Tableau {
        match self {
            Self::DormandPrince => &DORMAND_PRINCE,
            Self::DormandPrince8 => &DORMAND_PRINCE_8,
            Self::Verner9 => &VERNER_9,
        }
    }
}

/// What step control is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Error allowed a step: absolute in ϕ (relative to a ϕ above 1), relative in speeds (to max(1 SI unit, |v̄|)) and in momenta
    /// by what they do to the speeds.
    pub tolerance: f64,
    /// Longest step, s; infinity for none.
    pub max_step: f64,
    /// First step to try, s; `None` to estimate it.
    pub first_step: Option<f64>,
}

impl Control {
    /// Least tolerance, below which rounding of the estimate decides.
    pub const LEAST_TOLERANCE: f64 = 1e-16;
    /// Largest tolerance, beyond which a step says nothing.
    pub const LARGEST_TOLERANCE: f64 = 0.1;

    /// Nothing but a tolerance.
    pub const fn to(tolerance: f64) -> Self {
        Self {
            tolerance,
            max_step: f64::INFINITY,
            first_step: None,
        }
    }

    fn check(&self) -> Result<(), IntegrateError> {
        let allowed = Self::LEAST_TOLERANCE..=Self::LARGEST_TOLERANCE;
        require(
            "tolerance",
            self.tolerance,
            allowed.contains(&self.tolerance),
            "between 1e-16 and 0.1",
        )?;
        require("max_step", self.max_step, self.max_step > 0.0, "positive")?;
        let first = self.first_step.unwrap_or(1.0);
        let allowed = first > 0.0 && first.is_finite();
        require("first_step", first, allowed, "positive and finite")
    }
}

impl Method {
    /// Order 5 with step control to `tolerance`, with nothing else prescribed.
    pub const fn dormand_prince(tolerance: f64) -> Self {
        Self::controlled(Pair::DormandPrince, tolerance)
    }

    /// A pair with step control to `tolerance`, with nothing else prescribed.
    pub const fn controlled(pair: Pair, tolerance: f64) -> Self {
        Self::Controlled {
            pair,
            control: Control::to(tolerance),
        }
    }

    /// As scenes and the command line write it.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Rk4 { .. } => "rk4",
            Self::Controlled { pair, .. } => pair.name(),
        }
    }

    /// Its coefficients.
    pub const fn tableau(&self) -> &'static Tableau {
        match self {
            Self::Rk4 { .. } => &CLASSICAL,
            Self::Controlled { pair, .. } => pair.tableau(),
        }
    }

    /// What its step control is given, if it has any.
    pub const fn control(&self) -> Option<Control> {
        match *self {
            Self::Rk4 { .. } => None,
            Self::Controlled { control, .. } => Some(control),
        }
    }

    fn check(&self) -> Result<(), IntegrateError> {
        if let Self::Rk4 { dt } = *self {
            return require("dt", dt, dt > 0.0 && dt.is_finite(), "positive and finite");
        }
        self.control().as_ref().map_or(Ok(()), Control::check)
    }
}

fn require(
    option: &'static str,
    value: f64,
    allowed: bool,
    requirement: &'static str,
) -> Result<(), IntegrateError> {
    if allowed {
        return Ok(());
    }
    Err(IntegrateError::Option {
        option,
        value,
        requirement,
    })
}

/// What an integration is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Which equations.
    pub form: Form,
    /// Which method.
    pub method: Method,
    /// Time at which to end, s.
    pub t_end: f64,
    /// Times at which the state is wanted, ascending, between the initial time and `t_end`.
    pub samples: Vec<f64>,
}

impl Options {
    pub(super) fn check(&self, start: f64) -> Result<(), IntegrateError> {
        require("initial time", start, start.is_finite(), "finite")?;
        require("t_end", self.t_end, self.t_end.is_finite(), "finite")?;
        if self.t_end < start {
            return Err(IntegrateError::TimeOrder {
                start,
                end: self.t_end,
            });
        }
        self.method.check()?;
        let mut earliest = start;
        for (index, &time) in self.samples.iter().enumerate() {
            // A comparison that NaN fails as well.
            if !(time >= earliest && time <= self.t_end) {
                return Err(IntegrateError::Sample {
                    index,
                    time,
                    earliest,
                    end: self.t_end,
                });
            }
            earliest = time;
        }
        Ok(())
    }
}
