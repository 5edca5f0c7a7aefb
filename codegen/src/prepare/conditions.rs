//! Exceptions and requirements that say nothing, or forbid everything.

use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::model::{ConfigurationSpace, Declared, Locus, Requirement};
use crate::spec::code;

/// An error for each exception that holds nowhere, or at home for some parameters, and for each requirement that is always or never true.
pub fn wrong(space: &ConfigurationSpace) -> Vec<Diagnostic> {
    let without_loci = ConfigurationSpace {
        loci: vec![],
        ..space.clone()
    };
    let loci = space.loci.iter();
    let of_loci = loci.filter_map(|locus| wrong_locus(locus, &without_loci));
    let requirements = space.requirements.iter().enumerate();
    let of_requirements = requirements.filter_map(|(n, requirement)| {
        let before = &space.requirements[..n];
        wrong_requirement(requirement, before, &without_loci)
    });
    of_loci.chain(of_requirements).collect()
}

fn wrong_locus(locus: &Declared<Locus>, without_loci: &ConfigurationSpace) -> Option<Diagnostic> {
    let error = |message: &str| Diagnostic::new(code::LOCUS, locus.span.clone(), message);
    let (domain, function) = (Domain::new(without_loci), &locus.value.function);
    if let Some(certificate) = domain.nonzero(function) {
        let error = error("this equation holds nowhere").label("excludes nothing");
        let note = format!("left minus right is never 0: {certificate}");
        return Some(error.note(note).help("remove it"));
    }
    let at_home = function.substitute(&without_loci.home_values());
    // A guess of home is off the manifold: there the function says nothing of home itself.
    if without_loci.home_is_guess || domain.nonzero(&at_home).is_some() {
        return None;
    }
    let error = error("this equation may hold at home")
        .note(format!("left minus right is {at_home} there"));
    Some(match at_home.symbols().is_empty() {
        true => error
            .label("undecided in the configuration in which a mechanism starts")
            .help("declare another configuration by `home = …;`"),
        false => error
            .label("excludes, for some parameters, the configuration in which a mechanism starts")
            .help("declare another configuration by `home = …;`, or leave those parameters out by their ranges or by `require`"),
    })
}

fn wrong_requirement(
    requirement: &Declared<Requirement>,
    before: &[Declared<Requirement>],
    space: &ConfigurationSpace,
) -> Option<Diagnostic> {
    let error =
        |message: &str| Diagnostic::new(code::REQUIREMENT, requirement.span.clone(), message);
    let given = |requirements: &[Declared<Requirement>]| ConfigurationSpace {
        requirements: requirements.to_vec(),
        ..space.clone()
    };
    let value = &requirement.value.value;
    if Domain::new(&given(&[])).is_positive(value) {
        let error = error("this requirement is always true");
        return Some(
            error
                .label("follows from the ranges of the parameters")
                .help("remove it"),
        );
    }
    let never = Domain::new(&given(before)).is_not_negative(&-value);
    never.then(|| {
        error("this requirement is never true")
            .label("contradicts the ranges of the parameters or the requirements above")
            .help("no scene could use the joint")
    })
}
