//! How near a motion comes to the singular configurations of a joint.

use super::StepFailure;
use super::flow::Flow;
use super::rates_of_loops::has_ends;
use super::returns::Returns;
use super::step_state::StepState;
use super::stepper::Span;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt::{Display, Formatter, Result};
use hamel_runtime::mechanism::{Body, Loci, Mechanism};
use hamel_runtime::shown::Number;
use num_traits::Float;

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

impl Approach {
    /// That a step comes there.
    fn excluded(&self) -> StepFailure {
        StepFailure::Excluded {
            joint: self.joint.clone(),
            loci: self.loci,
        }
    }
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

/// What vanishes at an excluded configuration counts as 0 below this part of its largest value, ε^(1/4): relations that alone give a joint's Q determine its distance d
/// from there with an error of ε/d. Rates of the dependent coordinates grow as 1/d, and so lose ε/d² of themselves: half of their digits at that d.
const AT_END: f64 = 1.220_703_125e-4;

/// The part of what vanishes at a singular set at the start of a step that must be left within it. A longer step could pass the set unseen, and would lose most digits of what grows there.
const LEFT: f64 = 0.25;

/// How many rad or m a joint may move in a step, as a part of the distance from its singular set, without a look at what lies between.
const UNSEEN: f64 = 0.125;

/// How many times its least value so far what vanishes at a singular set is, from which on the joint is not on its way there: what goes away from the set is no cause of a failure.
const AWAY: f64 = 2.0;

/// Most looks within a step.
const MOST_LOOKS: f64 = 32.0;

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
    /// What vanishes, at the last state seen.
    now: Vec<f64>,
    /// ϕ and Q of one joint.
    phi: Vec<f64>,
    configuration: Vec<f64>,
    returns: Returns,
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
        let nearest: Vec<(usize, Approach)> = watched.map(far).collect();
        Self {
            now: vec![f64::INFINITY; nearest.len()],
            nearest,
            phi: vec![],
            configuration: vec![],
            returns: Returns::new(mechanism),
        }
    }

    /// Whether a joint has configurations where its motion ends.
    pub(super) fn knows_ends(&self, mechanism: &Mechanism) -> bool {
        let mut joints = self.nearest.iter();
        joints.any(|(index, _)| has_ends(mechanism.bodies()[*index].joint()))
    }

    /// Takes note of a configuration, and tells the joint that is where its motion ends: where its relations, which alone give its Q, do not determine how it goes on.
    pub(super) fn see(&mut self, mechanism: &Mechanism, time: f64, q: &[f64]) -> Option<Approach> {
        let mut end = None;
        for ((index, nearest), now) in self.nearest.iter_mut().zip(&mut self.now) {
            let body = &mechanism.bodies()[*index];
            let value = value_at(body, q);
            *now = value;
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

    /// Refuses a step just tried within which a joint passes its singular set, or comes much nearer to it than it is at the start.
    pub(super) fn check(
        &mut self,
        flow: &mut Flow<'_>,
        state: &StepState,
        span: Span,
    ) -> core::result::Result<(), StepFailure> {
        let way = (&*state.offset, &*state.phi);
        self.check_between(&flow.mechanism, &state.base, way)?;
        let watched = self.nearest.iter().map(|(index, _)| *index);
        let found = (self.returns).find(flow, (state, span), watched, (UNSEEN, LEFT))?;
        let found = self.nearest.iter().find(|(index, _)| Some(*index) == found);
        found.map_or(Ok(()), |(_, nearest)| Err(nearest.excluded()))
    }

    /// Refuses a step from one ϕ to another, around base points, within which a joint comes much nearer to its singular set than it is at the start. Between steps it may cross the set,
    /// where its equations have no value, without being there at the end of one.
    fn check_between(
        &mut self,
        mechanism: &Mechanism,
        base: &[f64],
        (start, end): (&[f64], &[f64]),
    ) -> core::result::Result<(), StepFailure> {
        for ((index, nearest), &now) in self.nearest.iter().zip(&self.now) {
            let body = &mechanism.bodies()[*index];
            let freedoms = body.ranges().freedoms.clone();
            let (start, end) = (&start[freedoms.clone()], &end[freedoms]);
            let way = start.iter().zip(end);
            let way = way.fold(0.0_f64, |most, (start, end)| most.max((end - start).abs()));
            let distance = now / nearest.most;
            if way <= UNSEEN * distance {
                continue;
            }
            let looks = Float::ceil((4.0 * way / distance).clamp(4.0, MOST_LOOKS)) as u32;
            let base = body.configuration(base);
            self.configuration.resize(base.len(), 0.0);
            let between = |part: f64| {
                self.phi.clear();
                let pairs = start.iter().zip(end);
                (self.phi).extend(pairs.map(|(start, end)| start + part * (end - start)));
                let joint = body.joint();
                joint.retract(base, &self.phi, &mut self.configuration);
                joint.singularity(&self.configuration)
            };
            let parts = (1..=looks).map(|look| f64::from(look) / f64::from(looks));
            // What is not a number is no place away from the set.
            if !parts.map(between).all(|value| value >= LEFT * now) {
                return Err(nearest.excluded());
            }
        }
        Ok(())
    }

    /// The joint that is nearest to its singular set at a time and Q.
    pub(super) fn nearest_at(&self, mechanism: &Mechanism, (time, q): (f64, &[f64])) -> Near {
        let here = self.nearest.iter().map(|(index, _)| {
            let body = &mechanism.bodies()[*index];
            approach(body, value_at(body, q), time)
        });
        Near(here.min_by(|a, b| a.value.total_cmp(&b.value)))
    }

    /// How near a joint, if its motion has an end and does not go away from it, is to it at a time and Q.
    pub(super) fn end_of(
        &self,
        mechanism: &Mechanism,
        joint: &str,
        (time, q): (f64, &[f64]),
    ) -> Option<Approach> {
        let mut watched = self.nearest.iter();
        let (index, nearest) = watched.find(|(_, nearest)| nearest.joint == joint)?;
        let body = &mechanism.bodies()[*index];
        let value = value_at(body, q);
        (has_ends(body.joint()) && value <= AWAY * nearest.value).then(|| Approach {
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
