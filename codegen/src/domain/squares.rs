//! Roots of squares: `sqrt((x² + y²)²)` is `x² + y²`, also where relations of the manifold hide the square.

use super::Domain;
use crate::expr::{Atom, Expr, Function};
use crate::matrix::Matrix;
use crate::model::{ConfigurationSpace, JointSpec};
use std::collections::BTreeSet;

/// The arguments of roots in what a spec declares that are squares on the manifold, each with what it is the square of: that is
/// nowhere negative.
pub fn squares(spec: &JointSpec, space: &ConfigurationSpace) -> Vec<(Expr, Expr)> {
    let domain = Domain::new(space);
    let arguments = arguments(spec);
    let known = arguments.into_iter().filter_map(|argument| {
        let root = root(&domain, &argument, space.manifold.declared())?;
        Some((argument, root))
    });
    known.collect()
}

/// What roots are taken of, where ϕ = 0.
fn arguments(spec: &JointSpec) -> BTreeSet<Expr> {
    let local: Vec<_> = spec
        .freedoms
        .value
        .iter()
        .map(|freedom| freedom.local.clone())
        .collect();
    let retract = spec.retract.iter().flat_map(|declared| &declared.value);
    let mut found = BTreeSet::new();
    let entries = spec.matrices().flat_map(Matrix::entries).chain(retract);
    entries.for_each(|entry| collect(entry, &mut found));
    found
        .iter()
        .map(|argument| argument.at_zero(&local))
        .collect()
}

fn collect(expression: &Expr, found: &mut BTreeSet<Expr>) {
    for atom in expression.atoms() {
        if let Atom::Apply(application) = atom {
            application
                .arguments
                .iter()
                .for_each(|argument| collect(argument, found));
            if application.function == Function::Sqrt {
                found.extend(application.arguments.first().cloned());
            }
        }
    }
}

/// Of an argument, or of that with a relation of the manifold added or subtracted, which does not change it there.
fn root(domain: &Domain<'_>, argument: &Expr, relations: &[Expr]) -> Option<Expr> {
    let normal = domain.ideal().normal_form(argument);
    let moved = relations.iter().flat_map(|g| [&normal + g, &normal - g]);
    let mut candidates = [argument.clone(), normal.clone()].into_iter().chain(moved);
    candidates.find_map(|candidate| {
        let root = candidate.polynomial_root()?;
        let signed = [root.clone(), -root].into_iter();
        signed.into_iter().find(|root| domain.is_not_negative(root))
    })
}
