//! What an integration is asked to do.

use super::IntegrateError;
use super::tableau::{Estimate, Tableau};
use alloc::format;
use alloc::vec::Vec;
use hamel_runtime::mechanism::Mechanism;

/// Which equations of motion are integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// State (Q, v̄), (24), (34).
    Lagrangian,
    /// State (Q, p̄), (27), (35).
    Hamiltonian,
}

/// How steps are made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// The classical explicit method of order 4.
    Rk4,
    /// The method of order 4 of Celledoni, Marthinsen and Owren: as [`Scheme::Rk4`], but Q moves along by compositions of Φ.
    CommutatorFree4,
    /// Dormand and Prince's of order 5(4).
    DormandPrince,
    /// Dormand and Prince's of order 8(5,3), known as DOP853: for tolerances of 1e-6 and below.
    DormandPrince8,
    /// Verner's of order 9(8): for tolerances near rounding, which its result feels less than that of DOP853.
    Verner9,
    /// Any other explicit method.
    Explicit(&'static Tableau),
    /// The implicit midpoint rule, of order 2; symmetric, as are the next two, as long as the base points of local coordinates stand. Joints whose
    /// coordinates do not add up (a ball's, a free body's) get a new one every half radian or so, at which their energy may drift.
    Midpoint,
    /// Gauss's method with two stages, of order 4.
    Gauss2,
    /// Gauss's method with three stages, of order 6.
    Gauss3,
    /// Radau IIA with three stages, of order 5: implicit, damps what is stiff.
    Radau5,
    /// An exponential Rosenbrock method of order 4(3): solves the linearised equations exactly, undamped stiff springs among them. Inputs that follow
    /// the state are no part of them, so that the order is 2 there; dense output and events do not see what oscillates faster than its steps. Bodies that nothing but uniform gravity
    /// acts on move in closed form, without dense output and events. Each must be alone on a joint of six degrees of freedom, or on a ball joint about its centre of mass.
    Exponential,
    /// A discrete-gradient method of order 2 on the port-Hamiltonian form: keeps the energy balance to rounding, at a fixed step size and under step control.
    DiscreteGradient,
}

impl Scheme {
    /// All that have a name of their own.
    pub const ALL: [Self; 11] = [
        Self::Rk4,
        Self::CommutatorFree4,
        Self::DormandPrince,
        Self::DormandPrince8,
        Self::Verner9,
        Self::Midpoint,
        Self::Gauss2,
        Self::Gauss3,
        Self::Radau5,
        Self::Exponential,
        Self::DiscreteGradient,
    ];

    /// Whether steps are made with derivatives of the equations of motion.
    pub const fn takes_derivatives(&self) -> bool {
        matches!(
            self,
            Self::Midpoint | Self::Gauss2 | Self::Gauss3 | Self::Radau5 | Self::Exponential
        )
    }

    /// As scenes and the command line write it.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Rk4 => "rk4",
            Self::CommutatorFree4 => "cf4",
            Self::DormandPrince => "dopri5",
            Self::DormandPrince8 => "dop853",
            Self::Verner9 => "verner9",
            Self::Explicit(_) => "explicit",
            Self::Midpoint => "midpoint",
            Self::Gauss2 => "gauss2",
            Self::Gauss3 => "gauss3",
            Self::Radau5 => "radau5",
            Self::Exponential => "exponential",
            Self::DiscreteGradient => "discrete_gradient",
        }
    }

    /// What it is and when to take it, in one line.
    pub const fn summary(&self) -> &'static str {
        match self {
            Self::Rk4 => "classical Runge-Kutta of order 4, fixed step",
            Self::CommutatorFree4 => "commutator-free of order 4, fixed step",
            Self::DormandPrince => "Dormand-Prince 5(4), step control: for most motions",
            Self::DormandPrince8 => {
                "Dormand-Prince 8(5,3), step control: for tolerances of 1e-6 and below"
            }
            Self::Verner9 => "Verner 9(8), step control: for tolerances near rounding",
            Self::Explicit(_) => "an explicit method of the caller's",
            Self::Midpoint => "implicit midpoint rule, order 2, fixed step",
            Self::Gauss2 => "Gauss with 2 stages, implicit, order 4, fixed step",
            Self::Gauss3 => "Gauss with 3 stages, implicit, order 6, fixed step: for long runs",
            Self::Radau5 => "Radau IIA of order 5, implicit, step control: for stiff damped scenes",
            Self::Exponential => {
                "exponential Rosenbrock 4(3), step control: takes stiff springs exactly, undamped ones too, and the flight and rotation of bodies without forces"
            }
            Self::DiscreteGradient => {
                "discrete gradient, order 2, fixed step or step control, only with --form hamiltonian: keeps the energy balance to rounding"
            }
        }
    }

    /// The scheme of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scheme| scheme.name() == name)
    }

    /// The power of the step with which its result's error falls.
    pub const fn order(&self) -> u32 {
        match self {
            Self::Midpoint | Self::DiscreteGradient => 2,
            Self::Rk4 | Self::CommutatorFree4 | Self::Gauss2 | Self::Exponential => 4,
            Self::DormandPrince | Self::Radau5 => 5,
            Self::Gauss3 => 6,
            Self::DormandPrince8 => 8,
            Self::Verner9 => 9,
            Self::Explicit(tableau) => tableau.order,
        }
    }

    /// Its coefficients, where it is an explicit Runge–Kutta method.
    pub const fn tableau(&self) -> Option<&'static Tableau> {
        match self {
            Self::Rk4 => Some(&Tableau::RK4),
            Self::DormandPrince => Some(&Tableau::DORMAND_PRINCE),
            Self::DormandPrince8 => Some(&Tableau::DORMAND_PRINCE_8),
            Self::Verner9 => Some(&Tableau::VERNER_9),
            Self::Explicit(tableau) => Some(tableau),
            Self::CommutatorFree4
            | Self::Midpoint
            | Self::Gauss2
            | Self::Gauss3
            | Self::Radau5
            | Self::Exponential
            | Self::DiscreteGradient => None,
        }
    }

    /// The forms of the equations of motion that it integrates. The discrete gradient is a method for momenta.
    pub fn forms(&self) -> &'static [Form] {
        match self {
            Self::DiscreteGradient => &[Form::Hamiltonian],
            _ => &[Form::Lagrangian, Form::Hamiltonian],
        }
    }

    /// Whether it estimates its own error, so that it can control its step.
    pub fn has_estimate(&self) -> bool {
        match self {
            Self::Radau5 | Self::Exponential | Self::DiscreteGradient => true,
            _ => self
                .tableau()
                .is_some_and(|tableau| tableau.estimate != Estimate::None),
        }
    }
}

/// Which method integrates them: a scheme, and what chooses its steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Steps of one length; those that land on a sample time are shorter.
    Fixed {
        /// How steps are made.
        scheme: Scheme,
        /// Step, s.
        dt: f64,
    },
    /// Step control, for a scheme that estimates its error.
    Controlled {
        /// How steps are made.
        scheme: Scheme,
        /// How accurate they shall be.
        control: StepControl,
    },
}

/// What step control is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl {
    /// Error allowed a step: absolute in ϕ (relative to a ϕ above 1), relative in speeds (to max(1 SI unit, |v̄|)) and in momenta
    /// by what they do to the speeds.
    pub tolerance: f64,
    /// Longest step, s; infinity for none.
    pub max_step: f64,
    /// First step to try, s; `None` to estimate it.
    pub first_step: Option<f64>,
}

impl StepControl {
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
    /// The classical method of order 4 with steps of `dt` (s).
    pub const fn rk4(dt: f64) -> Self {
        Self::fixed(Scheme::Rk4, dt)
    }

    /// Order 5 with step control to `tolerance`, with nothing else prescribed.
    pub const fn dormand_prince(tolerance: f64) -> Self {
        Self::controlled(Scheme::DormandPrince, tolerance)
    }

    /// Steps of `dt` (s).
    pub const fn fixed(scheme: Scheme, dt: f64) -> Self {
        Self::Fixed { scheme, dt }
    }

    /// Step control to `tolerance`, with nothing else prescribed.
    pub const fn controlled(scheme: Scheme, tolerance: f64) -> Self {
        Self::Controlled {
            scheme,
            control: StepControl::to(tolerance),
        }
    }

    /// How steps are made.
    pub const fn scheme(&self) -> &Scheme {
        match self {
            Self::Fixed { scheme, .. } | Self::Controlled { scheme, .. } => scheme,
        }
    }

    /// What its step control is given, if it has any.
    pub const fn control(&self) -> Option<StepControl> {
        match *self {
            Self::Fixed { .. } => None,
            Self::Controlled { control, .. } => Some(control),
        }
    }

    /// The lengths that it prescribes, with their names, s.
    fn lengths(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let lengths = match *self {
            Self::Fixed { dt, .. } => [Some(("dt", dt)), None],
            Self::Controlled { control, .. } => [
                Some(("max_step", control.max_step)),
                control.first_step.map(|first| ("first_step", first)),
            ],
        };
        lengths.into_iter().flatten()
    }

    fn check(&self) -> Result<(), IntegrateError> {
        match self {
            &Self::Fixed { dt, .. } => {
                require("dt", dt, dt > 0.0 && dt.is_finite(), "positive and finite")
            }
            Self::Controlled { scheme, .. } if !scheme.has_estimate() => {
                Err(IntegrateError::NoEstimate {
                    scheme: scheme.name(),
                })
            }
            Self::Controlled { control, .. } => control.check(),
        }
    }
}

/// The least step with which time moves on from `start` to `end`, s: below some roundings of the time it would not.
pub(super) fn least_step(start: f64, end: f64) -> f64 {
    16.0 * f64::EPSILON * start.abs().max(end.abs())
}

/// A length of time that is long enough to move on by.
pub(super) fn check_length(
    option: &'static str,
    length: f64,
    start: f64,
    end: f64,
) -> Result<(), IntegrateError> {
    require(
        option,
        length,
        length >= least_step(start, end),
        "at least 16 roundings (2.2e-16) of the times that are integrated over",
    )
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
    /// Whether the scheme can take the mechanism in this form.
    pub(super) fn check_scheme(&self, mechanism: &Mechanism) -> Result<(), IntegrateError> {
        let scheme = self.method.scheme();
        if let Scheme::Explicit(tableau) = scheme
            && let Some(reason) = tableau.fault()
        {
            let scheme = scheme.name();
            return Err(IntegrateError::Scheme { scheme, reason });
        }
        if !scheme.forms().contains(&self.form) {
            return Err(IntegrateError::Scheme {
                scheme: scheme.name(),
                reason: "takes the port-Hamiltonian form alone, which is `--form hamiltonian` of the program, `form = \"hamiltonian\"` of a scene or in Python, and `Form::Hamiltonian` in Rust".into(),
            });
        }
        if *scheme != Scheme::DiscreteGradient {
            return Ok(());
        }
        let drive = mechanism.drives().first();
        let constraint = mechanism.constraints().first();
        let reason = match (drive, constraint) {
            (Some(drive), _) => format!(
                "takes no prescribed motion, whose work it does not know: `{}` is one",
                drive.name
            ),
            (_, Some(constraint)) => format!(
                "takes no constraint that couples joints: `{}` is one",
                constraint.name
            ),
            _ => return Ok(()),
        };
        Err(IntegrateError::Scheme {
            scheme: scheme.name(),
            reason,
        })
    }

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
        for (option, length) in self.method.lengths() {
            check_length(option, length, start, self.t_end)?;
        }
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
