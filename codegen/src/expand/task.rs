//! The parts of a derivation, as the error names them that stops one of them for taking too much work.

use crate::model::JointSpec;
use std::ops::Range;

/// Φ to second order in ϕ.
pub const MOTION: &str = "Phi, to second order in phi";
/// J, from H.
pub const TWIST: &str = "the twist of H, to first order in phi";
/// X, in both frames.
pub const TWIST_MAP: &str = "X";
/// S from X and J.
pub const VELOCITY_MAP: &str = "S, the solution of X S = J";
/// P.
pub const PORTS: &str = "the rates of the ports";
/// Where pins are, and what acts there.
pub const PINS: &str = "the pins";
/// A and S̄.
pub const CONSTRAINT: &str = "A and S_bar";
/// What is proved.
pub const PROOF: &str = "the proof";
/// The kernels.
pub const KERNELS: &str = "the kernels";
/// How they are written.
pub const FORMULAS: &str = "the formulas of the kernels";

/// What makes a part shorter, where `claim` is the claim that was being proved.
pub fn advice(task: &str, claim: &str) -> String {
    let statements = match (task, claim) {
        (MOTION, _) => "Phi",
        (TWIST_MAP | VELOCITY_MAP, _) => "X and H",
        (PORTS, _) => "the ports",
        (PINS, _) => "the pins",
        (CONSTRAINT, _)
        | (_, "speeds_meet_constraint" | "speed_basis_rank" | "constraint_rank") => "A and S_bar",
        (_, "port_angles" | "port_rates" | "pins_meet" | "pins_hold") => "the pins and ports",
        _ => "H, X and S_bar",
    };
    format!(
        "shorten {statements}: `let` alone does not, since it is expanded\n\
         sines of sums are multiplied out: store an angle as a factor of S1, and leave constant rotations to `at` and `body_at` of the scene\n\
         split a long product of motions into several joints"
    )
}

/// The statement of the spec that a part starts from; the joint's name for those that start from all.
pub fn span(spec: &JointSpec, task: &str) -> Range<usize> {
    let pose = || spec.pose.span.clone();
    match task {
        MOTION => (spec.retract.as_ref()).map_or(spec.freedoms.span.clone(), |r| r.span.clone()),
        TWIST => pose(),
        TWIST_MAP | VELOCITY_MAP => (spec.twist_map.as_ref()).map_or_else(pose, |x| x.span.clone()),
        PINS => (spec.pins.first()).map_or_else(pose, |pin| pin.span.clone()),
        PORTS => (spec.ports.first()).map_or_else(pose, |port| port.span.clone()),
        CONSTRAINT => {
            let declared = spec.constraint.as_ref().or(spec.speed_basis.as_ref());
            declared.map_or_else(pose, |matrix| matrix.span.clone())
        }
        _ => spec.name.span.clone(),
    }
}
