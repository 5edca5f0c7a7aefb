//! How near a motion comes to the singular configurations of a joint.

use super::rates_of_loops::has_ends;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::{Display, Formatter, Result};
use hamel_runtime::mechanism::{Body, Loci, Mechanism};
use hamel_runtime::shown::Number;

/// How near a joint comes to a set that it must stay away from.
#[derive(Clone, Debug, PartialEq)]
pub struct Approach {
    /// The joint.
    pub joint: String,
    /// The functions that vanish there, as the spec writes them.
    pub loci: Loci,
    /// Their least absolute value at the initial state and after each accepted step.
    pub value: f64,
    /// When, s.
    pub time: f64,
    /// Their largest absolute value there: what the least is small beside.
    pub most: f64,
}

impl Display for Approach {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (joint, value, time, most) = (&self.joint, self.value, Number(self.time), self.most);
        write!(
            f,
            "joint `{joint}`: {} comes to {value:.3e} at {time} s, and is {most:.3e} at most",
            self.loci
        )
    }
}

/// The part of its largest value from which on what vanishes at an excluded configuration is 0 as far as doubles can tell: relations that alone give a
/// joint's Q determine its distance d from there with an error of ε/d, a hundredth of d at `10 √ε`.
const AT_END: f64 = 10.0 * 1.490_116_119_384_765_6e-8;

/// Where a failed step began, of the joints that have singular sets: nothing, or the one that is nearest to its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Near(pub Option<Approach>);

impl Display for Near {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Some(Approach {
            joint, loci, value, ..
        }) = &self.0
        else {
            return Ok(());
        };
        write!(
            f,
            "; joint `{joint}` is singular where {loci} is 0, and it is {value:e} there"
        )
    }
}

/// Watches all joints that have singular sets.
#[derive(Debug)]
pub(super) struct Watch {
    /// Index of the body, and its joint's nearest approach so far.
    nearest: Vec<(usize, Approach)>,
}

impl Watch {
    pub(super) fn new(mechanism: &Mechanism) -> Self {
        let joints = mechanism.joints();
        let watched = joints.filter(|(_, body)| !body.joint().singularities().is_empty());
        let far = |(index, body): (usize, &Body)| {
            (
                index,
                Approach {
                    most: 0.0,
                    ..approach(body, f64::INFINITY, 0.0)
                },
            )
        };
        Self {
            nearest: watched.map(far).collect(),
        }
    }

    /// Takes note of a configuration, and tells the joint that is where its motion ends: where its relations, which alone give its Q, do not determine how it goes on.
    pub(super) fn see(&mut self, mechanism: &Mechanism, time: f64, q: &[f64]) -> Option<Approach> {
        let mut end = None;
        for (index, nearest) in &mut self.nearest {
            let body = &mechanism.bodies()[*index];
            let value = value_at(body, q);
            nearest.most = nearest.most.max(value);
            if value < nearest.value {
                (nearest.value, nearest.time) = (value, time);
            }
            if value <= AT_END * nearest.most && has_ends(body.joint()) {
                end = Some(nearest.clone());
            }
        }
        end
    }

    /// The joint that is nearest to its singular set at a time and Q.
    pub(super) fn nearest_at(&self, mechanism: &Mechanism, (time, q): (f64, &[f64])) -> Near {
        let here = self.nearest.iter().map(|(index, _)| {
            let body = &mechanism.bodies()[*index];
            approach(body, value_at(body, q), time)
        });
        Near(here.min_by(|a, b| a.value.total_cmp(&b.value)))
    }

    /// How near a joint, if it has a singular set, is to it at a time and Q.
    pub(super) fn end_of(
        &self,
        mechanism: &Mechanism,
        joint: &str,
        (time, q): (f64, &[f64]),
    ) -> Option<Approach> {
        let mut watched = self.nearest.iter();
        let (index, nearest) = watched.find(|(_, nearest)| nearest.joint == joint)?;
        let value = value_at(&mechanism.bodies()[*index], q);
        Some(Approach {
            value,
            time,
            ..nearest.clone()
        })
    }

    pub(super) fn finish(self) -> Vec<Approach> {
        self.nearest
            .into_iter()
            .map(|(_, nearest)| nearest)
            .collect()
    }
}

fn value_at(body: &Body, q: &[f64]) -> f64 {
    body.joint().singularity(body.configuration(q))
}

fn approach(body: &Body, value: f64, time: f64) -> Approach {
    Approach {
        joint: body.joint_name().into(),
        loci: Loci(body.joint().singularities()),
        value,
        time,
        most: value,
    }
}
