//! From the end of one piece to the beginning of the next.

use super::complementarity::Place;
use super::contact::{Contact, Phase, Side, Sliding};
use super::fault::Fault;
use super::guards::{Guard, Guards};
use super::holding::Holding;
use super::notes::{Note, of_joint};
use super::release::Resting;
use super::{Hybrid, MOST_SHORT, names};
use crate::flow::Flow;
use crate::{IntegrateError, State, StepFailure};
use alloc::format;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use hamel_runtime::dynamics::Dynamics;
use nalgebra::{DMatrix, DVector};

/// Joints that are at rest to this part of the largest speed, or of 1 SI unit, when another one ends the piece come to rest with it.
const AT_REST: f64 = 1e-13;

/// Joints that come to a limit within so many roundings of the time do so together.
const TOGETHER: f64 = 64.0 * f64::EPSILON;

/// Efforts that hold joints by inverse dynamics may exceed the bounds that the complementarity problem has kept by this part of themselves.
const AGREEMENT: f64 = 1e-6;

impl<'a> Hybrid<'a> {
    /// Makes `state`, at which some of the guards end a piece, the beginning of the next one: what is to be reported of it, and the guards of the next.
    ///
    /// At the beginning of a motion no guard ends anything, and only impacts are reported.
    pub(crate) fn turn(
        &mut self,
        flow: &mut Flow<'a>,
        state: &mut State,
        ended: &[Guard],
        is_first: bool,
    ) -> Result<(Vec<Note>, Guards), IntegrateError> {
        self.count(state.time, ended)?;
        let turned = self.attempt(flow, state, ended);
        let (mut notes, guards) = turned.map_err(|fault| fault.at(state.time))?;
        if is_first {
            notes.retain(|note| note.is_impact);
        }
        Ok((notes, guards))
    }

    /// Counts short pieces.
    fn count(&mut self, time: f64, ended: &[Guard]) -> Result<(), IntegrateError> {
        let is_short = time - self.last < self.short;
        self.last = time;
        self.count = if is_short { self.count + 1 } else { 0 };
        match ended.first() {
            Some(guard) if self.count > MOST_SHORT => Err(IntegrateError::Chatter {
                joint: self.contacts[guard.contact()].joint.clone(),
                count: self.count,
                time,
            }),
            _ => Ok(()),
        }
    }

    fn attempt(
        &mut self,
        flow: &mut Flow<'a>,
        state: &mut State,
        ended: &[Guard],
    ) -> Result<(Vec<Note>, Guards), Fault> {
        let State {
            time,
            configuration: q,
            speeds,
        } = state;
        let before = speeds.clone();
        self.snap(*time, (q, speeds), ended);
        let hits = self.hit(q, speeds)?;
        let phases = self.decide(flow, (*time, q, speeds), ended)?;
        self.enter(flow, &phases, q)?;
        let guards = self.guards(flow, &phases, (*time, q, speeds))?;
        let mut notes = Vec::new();
        for (index, contact) in self.contacts.iter().enumerate() {
            let own = (before[contact.speed], speeds[contact.speed]);
            let phases = (self.phases[index], phases[index]);
            notes.extend(of_joint(contact, hits[index], phases, own));
        }
        self.phases = phases;
        Ok((notes, guards))
    }

    /// Puts joints that have come to a limit, or to rest, exactly there: they are there already, up to rounding.
    fn snap(&self, time: f64, (q, speeds): (&mut [f64], &mut [f64]), ended: &[Guard]) {
        let largest = speeds.iter().fold(1.0_f64, |most, v| most.max(v.abs()));
        for (index, contact) in self.contacts.iter().enumerate() {
            let ends = |guard: Guard| ended.contains(&guard);
            let coordinate = &mut q[contact.coordinate];
            for side in Side::BOTH {
                let Some(limit) = contact.limit(side) else {
                    continue;
                };
                let reaches = Guard::Reaches {
                    contact: index,
                    side,
                };
                let reach = speeds[contact.speed].abs() * TOGETHER * time.abs();
                let is_near = (*coordinate - limit).abs() <= reach;
                // Also one that is beyond by what an initial state may be.
                let is_beyond = side.inwards() * (*coordinate - limit) < 0.0;
                if ends(reaches) || is_near || is_beyond {
                    *coordinate = limit;
                }
            }
            let reverses = |forward| Guard::Reverses {
                contact: index,
                forward,
            };
            let speed = &mut speeds[contact.speed];
            let is_at_rest = speed.abs() <= AT_REST * largest;
            let stops = ends(reverses(true)) || ends(reverses(false));
            if contact.has_friction() && (stops || is_at_rest) {
                *speed = 0.0;
            }
        }
    }

    /// Columns of M̄⁻¹ of these joints' speeds, and the rows of these speeds in them.
    pub(super) fn inverse_mass(
        &mut self,
        q: &[f64],
        members: &[usize],
    ) -> Result<(Vec<Vec<f64>>, DMatrix<f64>), StepFailure> {
        let layout = *self.bare.mechanism().layout();
        let rest = vec![0.0; layout.speeds];
        let mut unit = vec![0.0; layout.freedoms];
        let mut columns = Vec::with_capacity(members.len());
        for &index in members {
            let own = self.contacts[index].freedom;
            let mut column = vec![0.0; layout.speeds];
            unit[own] = 1.0;
            let found = self.bare.forward_dynamics(q, &rest, &unit, &mut column);
            unit[own] = 0.0;
            found?;
            columns.push(column);
        }
        let size = members.len();
        let entry = |i: usize, j: usize| {
            let speed = self.contacts[members[i]].speed;
            columns[j][speed]
        };
        let matrix = DMatrix::from_fn(size, size, entry);
        Ok((columns, matrix))
    }

    /// What each joint does from here on.
    fn decide(
        &mut self,
        flow: &mut Flow<'a>,
        (time, q, speeds): (f64, &[f64], &[f64]),
        ended: &[Guard],
    ) -> Result<Vec<Phase>, Fault> {
        let mut phases: Vec<Phase> = self
            .contacts
            .iter()
            .map(|contact| moving(contact, speeds[contact.speed]))
            .collect();
        let all = self.contacts.iter().enumerate();
        let is_at_rest = |contact: &Contact| {
            speeds[contact.speed] == 0.0 && (contact.has_friction() || contact.at(q).is_some())
        };
        let members = all.filter(|(_, contact)| is_at_rest(contact));
        let members: Vec<usize> = members.map(|(index, _)| index).collect();
        if members.is_empty() {
            return Ok(phases);
        }
        let free = self.free_accelerations(flow, (time, q, speeds), &phases, &members)?;
        let (_, matrix) = self.inverse_mass(q, &members)?;
        let exceeded = |contact: usize| {
            ended.iter().find_map(|guard| match *guard {
                Guard::Releases {
                    contact: own,
                    above,
                    ..
                } if own == contact => Some(match above {
                    true => Place::AtUpper,
                    false => Place::AtLower,
                }),
                _ => None,
            })
        };
        let resting = Resting {
            contacts: &self.contacts,
            members: &members,
            q,
            matrix,
            free,
            exceeded: &exceeded,
        };
        let found = resting.phases().ok_or_else(|| {
            self.undecided(
                &members,
                "which of them are held is not determined: the joints depend on each other".into(),
            )
        })?;
        for (index, phase) in members.into_iter().zip(found) {
            phases[index] = phase;
        }
        Ok(phases)
    }

    /// Accelerations of these joints where nothing holds them.
    fn free_accelerations(
        &mut self,
        flow: &mut Flow<'a>,
        (time, q, speeds): (f64, &[f64], &[f64]),
        phases: &[Phase],
        members: &[usize],
    ) -> Result<DVector<f64>, StepFailure> {
        let mechanism = Arc::clone(self.free.mechanism());
        let layout = mechanism.layout();
        let mut efforts = vec![0.0; layout.freedoms];
        flow.set_friction(self.sliding_efforts(phases));
        flow.given_efforts(time, q, speeds, &mut efforts);
        mechanism.prescribe_accelerations(flow.moment(time), &mut efforts);
        self.free.set_moment(flow.moment(time));
        let mut rates = vec![0.0; layout.speeds];
        self.free
            .forward_dynamics(q, speeds, &efforts, &mut rates)?;
        let own = members.iter().map(|&i| rates[self.contacts[i].speed]);
        Ok(DVector::from_iterator(members.len(), own))
    }

    fn sliding_efforts(&self, phases: &[Phase]) -> Vec<Sliding> {
        let pairs = self.contacts.iter().zip(phases);
        let sliding = pairs.filter_map(|(contact, phase)| match *phase {
            Phase::Slides { forward } => Some(contact.sliding_efforts(forward)),
            _ => None,
        });
        sliding.flatten().collect()
    }

    /// Gives `flow` the equations of the next piece.
    fn enter(&mut self, flow: &mut Flow<'a>, phases: &[Phase], q: &[f64]) -> Result<(), Fault> {
        flow.set_friction(self.sliding_efforts(phases));
        let held: Vec<usize> = (0..phases.len()).filter(|&i| phases[i].is_held()).collect();
        let bodies = held.iter().map(|&index| self.contacts[index].body);
        let entered = self.modes.enter(flow, bodies.collect(), q);
        entered.map_err(|errors| {
            let reasons: Vec<String> = errors.iter().map(|error| format!("{error}")).collect();
            self.undecided(&held, reasons.join("; "))
        })
    }

    /// The guards of the next piece, at its beginning.
    fn guards(
        &self,
        flow: &mut Flow<'a>,
        phases: &[Phase],
        (time, q, speeds): (f64, &[f64], &[f64]),
    ) -> Result<Guards, Fault> {
        let mut holding = Holding::new(Arc::clone(&flow.mechanism));
        let held: Vec<usize> = (0..phases.len()).filter(|&i| phases[i].is_held()).collect();
        if !held.is_empty() {
            holding.find(flow, (time, q, speeds))?;
        }
        for &index in &held {
            let contact = &self.contacts[index];
            let effort = holding.effort(contact);
            let (lower, upper) = contact.bounds(q, false);
            let size =
                [lower, upper].map(|bound| if bound.is_finite() { bound.abs() } else { 0.0 });
            let room = AGREEMENT * size[0].max(size[1]).max(effort.abs()).max(1.0);
            if !(effort >= lower - room && effort <= upper + room) {
                let reason = format!(
                    "joint `{}` is held by {effort}, which is not between {lower} and {upper}: the joints depend on each other too much for doubles",
                    contact.joint
                );
                return Err(self.undecided(&held, reason));
            }
        }
        let efforts = holding.efforts().to_vec();
        Ok(Guards::new(&self.contacts, phases, q, (holding, &efforts)))
    }

    fn undecided(&self, members: &[usize], reason: String) -> Fault {
        let is_friction = |&index: &usize| self.contacts[index].has_friction();
        Fault::Undecided {
            what: match members.iter().any(is_friction) {
                true => "friction",
                false => "limit",
            },
            joints: names(&self.contacts, members.iter().copied()),
            reason,
        }
    }
}

/// What a joint does that moves with this speed, or begins to.
fn moving(contact: &Contact, speed: f64) -> Phase {
    match contact.has_friction() {
        true if speed != 0.0 => Phase::Slides {
            forward: speed > 0.0,
        },
        _ => Phase::Free,
    }
}
