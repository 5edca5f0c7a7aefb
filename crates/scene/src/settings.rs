//! How a scene wants to be simulated: defaults that a caller may override.

use crate::arithmetic::Arithmetic;
use hamel_integrate::{Form, Method, Sampling, Scheme};

/// Names of the forms of the equations of motion, as scene files and the command line write them.
pub(crate) const FORM_NAMES: [&str; 2] = ["lagrangian", "hamiltonian"];

/// Names of the places that samples come from, as scene files and the command line write them.
pub(crate) const SAMPLING_NAMES: [&str; 2] = ["landing", "dense"];

/// Names of the integration methods, as scene files write them; the last one leaves the choice to [`hamel_integrate::Choice`].
pub(crate) const METHOD_NAMES: [&str; Scheme::ALL.len() + 1] = {
    let mut names = [Settings::AUTO; Scheme::ALL.len() + 1];
    let mut i = 0;
    while i < Scheme::ALL.len() {
        names[i] = Scheme::ALL[i].name();
        i += 1;
    }
    names
};

/// Settings of a simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The simulated time runs from 0 to `t_end`, s; at least 0.
    pub t_end: f64,
    /// Integration method.
    pub method: Method,
    /// Whether the method is left to [`hamel_integrate::Choice`]; `method` then has the tolerance.
    pub chooses: bool,
    /// The largest error that the last state shall have, as [`hamel_integrate::ErrorParts`] measures it; the tolerance is then searched for
    /// ([`hamel_integrate::Tuned`]), and the one of `method` means nothing.
    pub accuracy: Option<f64>,
    /// Form of the equations of motion.
    pub form: Form,
    /// What they are solved in.
    pub arithmetic: Arithmetic,
    /// Time between two samples of the trajectory, s; above 0.
    pub sample_step: f64,
    /// Where samples come from.
    pub sampling: Sampling,
}

impl Settings {
    /// What stands for a method where the choice is left open.
    pub const AUTO: &str = "auto";
    /// End of the simulated time where a scene gives none, s.
    pub const DEFAULT_T_END: f64 = 1.0;
    /// Time between two samples where a scene gives none, s.
    pub const DEFAULT_SAMPLE_STEP: f64 = 0.01;
    /// Step of methods without step control, and of those of order 2, where a scene gives neither a step nor a tolerance, s.
    pub const DEFAULT_DT: f64 = 1e-3;
    /// Tolerance of other methods where a scene gives neither. With one of order 2 it would take some hundred thousand steps a second.
    pub const DEFAULT_TOL: f64 = 1e-10;

    /// The method that `scheme`, a step and a tolerance ask for; a step alone asks for `rk4`. Where nothing but a tolerance is given at most, the choice is
    /// left open, and the returned method has the tolerance. `None` where the scheme takes no tolerance. Of step and tolerance at most one is given.
    pub fn method_of(scheme: Option<Scheme>, dt: Option<f64>, tol: Option<f64>) -> Option<Method> {
        let implied = match dt {
            Some(_) => Scheme::Rk4,
            None => Scheme::DormandPrince,
        };
        let scheme = scheme.unwrap_or(implied);
        match (dt, tol) {
            (Some(dt), _) => Some(Method::fixed(scheme, dt)),
            (None, Some(_)) if !scheme.has_estimate() => None,
            (None, None) if !scheme.has_estimate() || scheme.order() == 2 => {
                Some(Method::fixed(scheme, Self::DEFAULT_DT))
            }
            (None, tol) => {
                let tol = tol.unwrap_or(Self::DEFAULT_TOL);
                Some(Method::controlled(scheme, tol))
            }
        }
    }

    /// The same with this tolerance, where the method has step control.
    #[must_use]
    pub fn with_tolerance(&self, tolerance: f64) -> Self {
        let mut settings = *self;
        if let Method::Controlled { control, .. } = &mut settings.method {
            control.tolerance = tolerance;
        }
        settings
    }

    /// Name of the method, as scene files and the command line write it.
    pub const fn method_name(&self) -> &'static str {
        match self.chooses {
            true => Self::AUTO,
            false => self.method.scheme().name(),
        }
    }

    /// Name of the form, as scene files and the command line write it.
    pub const fn form_name(&self) -> &'static str {
        match self.form {
            Form::Lagrangian => "lagrangian",
            Form::Hamiltonian => "hamiltonian",
        }
    }

    /// Where samples come from, as scene files and the command line write it.
    pub const fn sampling_name(&self) -> &'static str {
        match self.sampling {
            Sampling::Landing => "landing",
            Sampling::Dense => "dense",
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            t_end: Self::DEFAULT_T_END,
            method: Method::dormand_prince(Self::DEFAULT_TOL),
            chooses: true,
            accuracy: None,
            form: Form::Lagrangian,
            arithmetic: Arithmetic::Doubles,
            sample_step: Self::DEFAULT_SAMPLE_STEP,
            sampling: Sampling::Landing,
        }
    }
}

/// The sampling of that name.
pub(crate) fn sampling_named(name: &str) -> Option<Sampling> {
    match name {
        "landing" => Some(Sampling::Landing),
        "dense" => Some(Sampling::Dense),
        _ => None,
    }
}

/// The form of that name.
pub(crate) fn form_named(name: &str) -> Option<Form> {
    match name {
        "lagrangian" => Some(Form::Lagrangian),
        "hamiltonian" => Some(Form::Hamiltonian),
        _ => None,
    }
}
