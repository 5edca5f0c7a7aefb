//! What an integration is asked to do.

use super::IntegrateError;
use super::dop853::DORMAND_PRINCE_8;
use super::tableau::{CLASSICAL, DORMAND_PRINCE, Tableau};
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
    /// Dormand and Prince's pair of order 5(4) with step control.
    DormandPrince {
        /// Error allowed a step: absolute in ϕ (relative to a ϕ above 1), relative in speeds (to max(1 SI unit, |v̄|)) and in momenta (to the
        /// momentum of such speeds).
        tolerance: f64,
        /// Longest step, s; infinity for none.
        max_step: f64,
        /// First step to try, s; `None` to estimate it.
        first_step: Option<f64>,
    },
    /// Dormand and Prince's method of order 8(5,3) with step control, known as DOP853: for tolerances below 1e-8 or so.
    DormandPrince8 {
        /// Error allowed a step, as for [`Method::DormandPrince`].
        tolerance: f64,
        /// Longest step, s; infinity for none.
        max_step: f64,
        /// First step to try, s; `None` to estimate it.
        first_step: Option<f64>,
    },
}

/// What step control is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Control {
    pub(super) tolerance: f64,
    pub(super) max_step: f64,
    pub(super) first_step: Option<f64>,
}

impl Control {
    /// Least tolerance, below which rounding of the estimate decides.
    const LEAST_TOLERANCE: f64 = 1e-15;

    fn check(&self) -> Result<(), IntegrateError> {
        let allowed = self.tolerance >= Self::LEAST_TOLERANCE && self.tolerance <= 0.1;
        require(
            "tolerance",
            self.tolerance,
            allowed,
            "between 1e-15 and 0.1",
        )?;
        require("max_step", self.max_step, self.max_step > 0.0, "positive")?;
        let first = self.first_step.unwrap_or(1.0);
        let allowed = first > 0.0 && first.is_finite();
        require("first_step", first, allowed, "positive and finite")
    }
}

impl Method {
    /// Step control to `tolerance`, with nothing else prescribed.
    pub const fn dormand_prince(tolerance: f64) -> Self {
        Self::DormandPrince {
            tolerance,
            max_step: f64::INFINITY,
            first_step: None,
        }
    }

    /// Order 8 with step control to `tolerance`, with nothing else prescribed.
    pub const fn dormand_prince_8(tolerance: f64) -> Self {
        Self::DormandPrince8 {
            tolerance,
            max_step: f64::INFINITY,
            first_step: None,
        }
    }

    /// Its coefficients.
    pub const fn tableau(&self) -> &'static Tableau {
        match self {
            Self::Rk4 { .. } => &CLASSICAL,
            Self::DormandPrince { .. } => &DORMAND_PRINCE,
            Self::DormandPrince8 { .. } => &DORMAND_PRINCE_8,
        }
    }

    /// What its step control is given, if it has any.
    pub(super) const fn control(&self) -> Option<Control> {
        match *self {
            Self::Rk4 { .. } => None,
            Self::DormandPrince {
                tolerance,
                max_step,
                first_step,
            }
            | Self::DormandPrince8 {
                tolerance,
                max_step,
                first_step,
            } => Some(Control {
                tolerance,
                max_step,
                first_step,
            }),
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
