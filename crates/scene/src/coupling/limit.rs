//! Ends of the ranges of coupled joints, in the one coordinate that all of them follow.

use super::forces::Owner;
use crate::diagnostics::Diagnostic;
use crate::forces::{JointForces, LimitDescription, LimitKind};
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
    for owner in owners {
        let Some(limit) = &owner.body.forces.limit else {
            continue;
        };
        if coordinates > 1 {
            return Err(owner.needs_one("a limit", &limit.span, coordinates));
        }
        let own = Located::new(followed(&limit.value, owner), limit.span.clone());
        match (own.value.kind, &mut forces.limit) {
            (LimitKind::Compliant { .. }, _) => forces.further_limits.push(own),
            (LimitKind::Impact { .. }, None) => forces.limit = Some(own),
            (LimitKind::Impact { .. }, Some(narrowed)) => narrow(owner, narrowed, &own)?,
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

fn narrow(
    owner: &Owner<'_>,
    all: &mut Located<LimitDescription>,
    own: &Located<LimitDescription>,
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
    let tighter = |a: Option<f64>, b: Option<f64>, choose: fn(f64, f64) -> f64| match (a, b) {
        (Some(a), Some(b)) => Some(choose(a, b)),
        (one, other) => one.or(other),
    };
    all.value.lower = tighter(all.value.lower, own.value.lower, f64::max);
    all.value.upper = tighter(all.value.upper, own.value.upper, f64::min);
    match (all.value.lower, all.value.upper) {
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
