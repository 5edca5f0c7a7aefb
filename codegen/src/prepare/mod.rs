//! What a spec says of its joint, worked out before anything is expanded or proved.
//!
//! The spec stays as it was declared. Beside it stands the space in which the joint lives: the declared one, with the relations of the
//! coset in which a basis moves Q, and with what is known of the signs of parameters and of squares under roots.

mod conditions;
mod coset;
mod exponential;

pub(crate) use coset::insert;
pub use exponential::{exponential, local_element};

use crate::diagnostic::Diagnostic;
use crate::domain::{self, Critical, Domain};
use crate::expr::Expr;
use crate::model::{ConfigurationSpace, JointSpec};
use std::collections::BTreeSet;

/// A spec, and the space in which its joint lives.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// What is declared.
    pub spec: JointSpec,
    /// Where the joint lives.
    pub space: ConfigurationSpace,
    /// Whether Φ is Q exp(ϕ), so that the finite maps have closed forms.
    pub exponential: bool,
}

impl Prepared {
    /// Works out where the joint of a spec lives.
    ///
    /// # Errors
    /// Exceptions and requirements that say nothing, or forbid everything.
    pub fn new(spec: JointSpec) -> Result<Self, Vec<Diagnostic>> {
        let mut space = ConfigurationSpace::declared(&spec);
        let wrong = conditions::wrong(&space);
        if !wrong.is_empty() {
            return Err(wrong);
        }
        let relations = coset::relations(&spec);
        if !relations.is_empty() {
            space.manifold = space.manifold.confined(relations);
        }
        let positive = domain::positive_parameters(&space.parameters);
        let vanishing = domain::vanishing_parameters(&space.parameters);
        space.manifold = space.manifold.with_signs(positive, vanishing);
        let squares = domain::squares(&spec, &space);
        space.manifold = space.manifold.with_squares(&squares);
        let exponential = exponential::is_exponential(&spec, space.manifold.ideal());
        Ok(Self {
            spec,
            space,
            exponential,
        })
    }

    /// The same joint as if it carried that body alone.
    pub fn carrying(&self, body: usize) -> Self {
        Self {
            spec: self.spec.carrying(body),
            ..self.clone()
        }
    }

    /// The functions in what the spec declares that are not smooth at every argument.
    pub fn critical(&self) -> BTreeSet<Critical> {
        Critical::declared(&self.spec, self.exponential)
    }

    /// What is positive on the component of the manifold on which these functions have a value, that of home.
    pub fn sides(&self) -> Vec<Expr> {
        Domain::new(&self.space).sides(&self.critical())
    }
}
