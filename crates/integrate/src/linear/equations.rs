//! The equations of motion of one form in a linearised step.

use crate::Form;
use crate::flow::Rates;
use alloc::boxed::Box;
use hamel_runtime::dynamics::{
    Dynamics, DynamicsError, ForwardDerivatives, HamiltonianDerivatives, Sensitivity,
};
use hamel_runtime::mechanism::Mechanism;

/// The derivatives of v̄ and ẏ.
#[derive(Clone, Debug)]
pub(crate) enum Equations {
    /// y = v̄.
    Lagrangian(Box<ForwardDerivatives>),
    /// y = p̄.
    Hamiltonian(Box<HamiltonianDerivatives>),
}

impl Equations {
    pub(crate) fn new(mechanism: &Mechanism, form: Form) -> Self {
        match form {
            Form::Lagrangian => Self::Lagrangian(Box::new(ForwardDerivatives::new(mechanism))),
            Form::Hamiltonian => {
                Self::Hamiltonian(Box::new(HamiltonianDerivatives::new(mechanism)))
            }
        }
    }

    /// What y is, for messages.
    pub(super) const fn y(&self) -> &'static str {
        match self {
            Self::Lagrangian(_) => "speeds",
            Self::Hamiltonian(_) => "momenta",
        }
    }

    /// v̄ and ẏ at (q, y, τ), and the derivatives for [`Equations::differentiate`].
    pub(crate) fn evaluate(
        &mut self,
        dynamics: &mut dyn Dynamics,
        (q, y, efforts): (&[f64], &[f64], &[f64]),
        rates: &mut Rates,
    ) -> Result<(), DynamicsError> {
        match self {
            Self::Lagrangian(at) => {
                rates.speeds.copy_from_slice(y);
                dynamics.complete_speeds(q, &mut rates.speeds)?;
                let found = dynamics.forward_dynamics_derivatives(q, &rates.speeds, efforts, at);
                smooth(found)?;
                rates.y.copy_from_slice(at.rates());
                Ok(())
            }
            Self::Hamiltonian(at) => {
                smooth(dynamics.hamiltonian_derivatives(q, y, efforts, at))?;
                let mut held = |_: &[f64], tau: &mut [f64]| tau.copy_from_slice(efforts);
                dynamics.momentum_rates(q, y, &mut held, &mut rates.speeds, &mut rates.y)
            }
        }
    }

    /// δv̄ into `faster` and δẏ into `slopes`, of ξ and δy; the last columns are those of δτ.
    pub(crate) fn differentiate(
        &self,
        local: &Sensitivity,
        y: &Sensitivity,
        faster: &mut Sensitivity,
        slopes: &mut Sensitivity,
    ) {
        self.hasten(local, y, faster);
        let (by_local, by_y, by_efforts) = match self {
            Self::Lagrangian(at) => (at.by_local(), at.by_speeds(), at.by_efforts()),
            Self::Hamiltonian(at) => (
                at.rates_by_local(),
                at.rates_by_momenta(),
                at.rates_by_efforts(),
            ),
        };
        set_products(slopes, (by_local, local), (by_y, y));
        add_efforts(slopes, by_efforts);
    }

    /// δv̄ into `faster`, of ξ and δy; speeds that depend on others follow them.
    pub(super) fn hasten(&self, local: &Sensitivity, y: &Sensitivity, faster: &mut Sensitivity) {
        match self {
            Self::Lagrangian(at) => match at.completed_speeds() {
                None => faster.entries_mut().copy_from_slice(y.entries()),
                Some([by_local, by_speeds]) => {
                    set_products(faster, (by_local, local), (by_speeds, y));
                }
            },
            Self::Hamiltonian(at) => set_products(
                faster,
                (at.speeds_by_local(), local),
                (at.speeds_by_momenta(), y),
            ),
        }
    }
}

/// The sum of two products.
fn set_products(
    sum: &mut Sensitivity,
    first: (&Sensitivity, &Sensitivity),
    second: (&Sensitivity, &Sensitivity),
) {
    sum.entries_mut().fill(0.0);
    sum.add_product(first.0, first.1);
    sum.add_product(second.0, second.1);
}

/// Adds to the last columns.
fn add_efforts(slopes: &mut Sensitivity, by_efforts: &Sensitivity) {
    let (width, own) = (slopes.columns().max(1), by_efforts.columns().max(1));
    let rows = slopes.entries_mut().chunks_exact_mut(width);
    for (row, own) in rows.zip(by_efforts.entries().chunks_exact(own)) {
        super::add(&mut row[width - own.len()..], 1.0, own);
    }
}

/// What has no derivative at a state is left out of those that are found: a linearisation that lacks it costs steps, and no accuracy.
fn smooth(found: Result<(), DynamicsError>) -> Result<(), DynamicsError> {
    match found {
        Err(DynamicsError::NoDerivative { .. }) => Ok(()),
        found => found,
    }
}
