//! Ends of the ranges of coupled joints, in the one coordinate that all of them follow.

use super::forces::Owner;
use crate::diagnostics::Diagnostic;
use crate::forces::{JointForces, LimitDescription, LimitKind, LimitOwner};
use crate::source::Located;
use hamel_runtime::shown::Number;

/// Gives the limits of all joints to the one that they make.
///
/// Impacts become one limit, as narrow as the narrowest of them; stops that give way act each by itself.
pub(super) fn add(
    owners: &[Owner<'_>],
    coordinates: usize,
    forces: &mut JointForces,
) -> Result<(), Diagnostic> {
    for (port, owner) in owners.iter().enumerate() {
        let Some(limit) = &owner.body.forces.limit else {
            continue;
        };
        if coordinates > 1 {
            return Err(owner.needs_one("a limit", &limit.span, coordinates));
        }
        let own = Located::new(followed(&limit.value, owner), limit.span.clone());
        match (own.value.kind, &mut forces.limit) {
            (LimitKind::Compliant { .. }, _) => forces.further_limits.push(own),
            (LimitKind::Impact { .. }, None) => {
                forces.limit = Some(own);
                forces.limit_of = named(owner, port, limit);
            }
            (LimitKind::Impact { .. }, Some(narrowed)) => {
                let ends = [&mut forces.limit_of, &mut named(owner, port, limit)];
                narrow(owner, (narrowed, &own), ends)?;
            }
        }
    }
    Ok(())
}

/// The limit of y as one of q.
pub(super) fn followed(limit: &LimitDescription, owner: &Owner<'_>) -> LimitDescription {
    let (ratio, offset) = (owner.link.ratio, owner.link.offset);
    let at = |end: f64| (end - offset) / ratio;
    let (lower, upper) = match ratio > 0.0 {
        true => (limit.lower, limit.upper),
        false => (limit.upper, limit.lower),
    };
    LimitDescription {
        lower: lower.map(at),
        upper: upper.map(at),
        kind: match limit.kind {
            // The speeds before and after have the same ratio.
            impact @ LimitKind::Impact { .. } => impact,
            LimitKind::Compliant { stiffness, damping } => LimitKind::Compliant {
                stiffness: ratio * ratio * stiffness,
                damping: ratio.abs() * damping,
            },
        },
    }
}

/// Both ends of the limit of y as those of q, with what messages call them.
fn named(
    owner: &Owner<'_>,
    port: usize,
    limit: &Located<LimitDescription>,
) -> [Option<LimitOwner>; 2] {
    let named = |end: Option<f64>, is_upper: bool| {
        Some(LimitOwner {
            joint: owner.name.to_owned(),
            port,
            is_upper,
            end: Located::new(end?, limit.span.clone()),
        })
    };
    let lower = named(limit.value.lower, false);
    let upper = named(limit.value.upper, true);
    match owner.link.ratio > 0.0 {
        true => [lower, upper],
        false => [upper, lower],
    }
}

/// Brings the ends of a limit to those of another that are narrower.
fn narrow(
    owner: &Owner<'_>,
    (all, own): (&mut Located<LimitDescription>, &Located<LimitDescription>),
    [all_of, own_of]: [&mut [Option<LimitOwner>; 2]; 2],
) -> Result<(), Diagnostic> {
    if all.value.kind != own.value.kind {
        let message = format!(
            "joint `{}`: its limit has another `restitution` than those of the joints that it is coupled with",
            owner.name
        );
        return Err(Diagnostic::new(own.span.clone(), message)
            .context(all.span.clone(), "the limit of another")
            .help("coupled joints stop together"));
    }
    let LimitDescription { lower, upper, .. } = &mut all.value;
    let [lower_of, upper_of] = all_of;
    let [own_lower, own_upper] = own_of;
    if own
        .value
        .lower
        .is_some_and(|own| lower.is_none_or(|all| own > all))
    {
        (*lower, *lower_of) = (own.value.lower, own_lower.take());
    }
    if own
        .value
        .upper
        .is_some_and(|own| upper.is_none_or(|all| own < all))
    {
        (*upper, *upper_of) = (own.value.upper, own_upper.take());
    }
    match (*lower, *upper) {
        (Some(lower), Some(upper)) if lower >= upper => {
            let message = format!(
                "joint `{}`: with the limits of the joints that it is coupled with nothing is left of its range: what it follows is at least {:?} and at most {:?}",
                owner.name,
                Number(lower),
                Number(upper)
            );
            Err(Diagnostic::new(own.span.clone(), message))
        }
        _ => Ok(()),
    }
}
