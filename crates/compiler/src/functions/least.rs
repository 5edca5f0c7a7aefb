//! The fewest operations that a function can have, before it is made.

use super::Kind;
use crate::model::Model;

/// At least so many operations has a function without loops.
pub(super) fn least(model: &Model, kind: Kind) -> usize {
    let [_, freedoms, speeds] = model.sizes();
    match kind {
        Kind::MassMatrix => ENTRY * pairs(model),
        Kind::InverseMassMatrix => (ENTRY + RESPONSE * speeds / 2) * pairs(model),
        Kind::InverseDerivatives | Kind::InverseSecondDerivatives => MET * pairs(model),
        Kind::ForwardDerivatives | Kind::ForwardSecondDerivatives => {
            (MET + RESPONSE * (freedoms + speeds)) * pairs(model)
        }
        _ => 0,
    }
}

/// Operations of an entry of M̄ beside the diagonal: about the fewest that were counted.
const ENTRY: usize = 15;

/// Operations of the derivatives of inverse dynamics for a speed and a joint that carries it: fewer than were counted.
const MET: usize = 30;

/// Operations of one column of M̄⁻¹ times something for such a pair: the fewest.
const RESPONSE: usize = 2;

/// Pairs of a speed and a joint that carries it.
fn pairs(model: &Model) -> usize {
    let depths = model.depths();
    let joints = model.joints();
    joints
        .map(|(index, body)| body.joint.derived.shape.speeds * depths[index])
        .sum()
}
