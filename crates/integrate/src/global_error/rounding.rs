//! What rounding adds to the error of a motion: half an ulp of the state, and what is lost in accelerations, as they grow. A neighbour of a companion shows by how much.

use super::companion::{Companion, distance};
use super::estimation::Estimation;
use super::{ErrorParts, accelerations};
use crate::flow::retract;
use crate::{Form, Method, State, positions};
use alloc::sync::Arc;
use alloc::vec::Vec;
use num_traits::Float;

/// Above this, what rounding amounts to is of no interest, and is not looked for by a companion of its own.
const FAR_ABOVE_ROUNDING: f64 = 1e-9;

/// Neighbours at this distance are too far apart to tell how those go apart that are near.
const APART: f64 = 0.1;

/// A neighbour that takes this many times as many steps as the motion beside it goes elsewhere: it is followed no farther.
const STEPS_OF_NEIGHBOURS: f64 = 1.5;

/// So many steps more cost nothing.
const FEW_STEPS: f64 = 100.0;

/// Bodies that are farther away than this, m, have roundings of positions that are larger than those of speeds.
const FAR: f64 = 1e3;

/// A neighbour in the configuration is so many roundings away: well above those that the two motions make themselves.
const ROUNDINGS: f64 = 256.0;

impl Estimation<'_, '_> {
    /// Errors from steps with those from rounding, as a companion beside one of `others` tells them where they count.
    pub(super) fn with_rounding(
        &mut self,
        from_steps: Vec<f64>,
        others: [(Method, &Companion); 2],
        times: &[State],
    ) -> (Vec<ErrorParts>, Option<f64>) {
        let is_near = from_steps.iter().any(|&error| error < FAR_ABOVE_ROUNDING);
        // What rounding has left in the estimate of a step is in the step as well.
        let limit = self.solution.rounding.as_ref();
        let least = limit.map_or(0.0, |limit| limit.error);
        let (conditioning, growth) = match is_near {
            true => self.conditioning(others, times),
            false => (None, Vec::new()),
        };
        let scatter = self.scatter(times);
        let of_positions = self.of_positions(others[0], times);
        let errors = from_steps.into_iter().enumerate().map(|(i, steps)| {
            let growth = growth.get(i).copied().unwrap_or(1.0);
            let length = times[i].time - self.initial.time;
            let path = others[1].1.paths[i].max(1.0);
            let rounding = self.unit(&times[i]) * growth.max(path);
            let placed = of_positions.get(i).copied().unwrap_or(0.0);
            let rounding = rounding.max(placed);
            // Paths tell how errors of speeds add up in coordinates; what goes beyond is instability.
            let grown = (growth / path).max(1.0);
            let rounding = rounding
                .max(Float::sqrt(length) * scatter * grown)
                .max(least * grown);
            ErrorParts { steps, rounding }
        });
        (errors.collect(), conditioning)
    }

    /// What rounding of accelerations makes of velocities over the root of the time: it is another one at every step, so that it adds up as a random walk does.
    fn scatter(&mut self, times: &[State]) -> f64 {
        if self.options.form == Form::Hamiltonian || self.is_exact() {
            return 0.0;
        }
        let length = self.solution.state.time - self.initial.time;
        let step = length / self.solution.statistics.steps.max(1) as f64;
        Float::sqrt(step) * accelerations::rounding(self.dynamics, self.initial.time, times)
    }

    /// What one rounding of the state amounts to: half an ulp, and of momenta what these do to speeds.
    fn unit(&mut self, state: &State) -> f64 {
        let unit = 0.5 * f64::EPSILON;
        if self.options.form == Form::Lagrangian {
            return unit;
        }
        let mut rounded = state.clone();
        let mut momenta = state.speeds.clone();
        let found = self
            .dynamics
            .momenta(&state.configuration, &state.speeds, &mut momenta);
        let signs = [unit, -unit].into_iter().cycle();
        for (momentum, sign) in momenta.iter_mut().zip(signs) {
            // A change of a rounding would be lost: this one is a thousand of them.
            *momentum *= 1.0 + 1024.0 * sign;
        }
        let found = found.and_then(|()| {
            self.dynamics
                .speeds(&state.configuration, &momenta, &mut rounded.speeds)
        });
        match found {
            Ok(()) => {
                (distance(&self.mechanism, &rounded, state).unwrap_or(0.0) / 1024.0).max(unit)
            }
            Err(_) => unit,
        }
    }

    /// The conditioning, and how much a relative change of the speeds has grown at each time, by a neighbour of the coarser companion. Neighbours that are far apart in the end do not tell how those
    /// go apart that are near: one of the finer companion is nearer to it.
    fn conditioning(
        &mut self,
        [fine, coarse]: [(Method, &Companion); 2],
        times: &[State],
    ) -> (Option<f64>, Vec<f64>) {
        let (change, least) = (change_of(coarse.0), change_of(fine.0));
        let found = self.growth((coarse.0, change), coarse.1, times);
        let is_small = |growth: &Vec<f64>| growth.iter().all(|&own| own * change < APART);
        let found = match found {
            Some(growth) if !is_small(&growth) && least < change => {
                let nearer = self.growth((fine.0, least), fine.1, times);
                nearer.or(Some(growth))
            }
            found => found,
        };
        let growth = found.unwrap_or_default();
        (growth.last().copied(), growth)
    }

    /// How far a neighbour of a companion is carried away, as a part of the change of its speeds: as far as ever before where it takes too many steps to be followed.
    fn growth(
        &mut self,
        (method, change): (Method, f64),
        companion: &Companion,
        times: &[State],
    ) -> Option<Vec<f64>> {
        let moved = self.neighbour(change, times)?;
        let most = STEPS_OF_NEIGHBOURS * companion.steps + FEW_STEPS;
        let moved = (self.companion_from(method, times, (&moved, most))).ok()?;
        let distances = self.distances(&moved.states, &companion.states);
        let mut growth: Vec<f64> = distances.iter().map(|distance| distance / change).collect();
        let largest = growth.iter().copied().fold(1.0, f64::max);
        growth.resize(times.len(), largest);
        Some(growth)
    }

    /// What half an ulp of the configuration is at each time, where bodies are so far away that it counts: nothing elsewhere, where speeds tell of it. It is seen beside the finer companion: steps of the coarser one
    /// may change with so little.
    fn of_positions(
        &mut self,
        (method, companion): (Method, &Companion),
        times: &[State],
    ) -> Vec<f64> {
        let (mechanism, q) = (Arc::clone(&self.mechanism), &self.initial.configuration);
        if self.is_exact() || positions::largest(&mechanism, q) < FAR {
            return Vec::new();
        }
        let mut from = self.initial.clone();
        let mut moved = positions::roundings(&mechanism, q);
        for (index, body) in mechanism.joints() {
            let part = if mechanism.is_driven(index) {
                0.0
            } else {
                ROUNDINGS
            };
            moved[body.ranges().freedoms.clone()]
                .iter_mut()
                .for_each(|phi| *phi *= part);
        }
        retract(&mechanism, q, &moved, &mut from.configuration);
        let completed = self
            .dynamics
            .complete_speeds(&from.configuration, &mut from.speeds);
        let found = completed.ok().and_then(|()| {
            self.companion_from(method, times, (&from, f64::INFINITY))
                .ok()
        });
        let distances = found.map(|found| self.distances(&found.states, &companion.states));
        let distances = distances.unwrap_or_default().into_iter();
        distances
            .map(|distance| 0.5 * distance / ROUNDINGS)
            .collect()
    }

    /// The first state with other speeds, where something moves: one larger by a part of the largest that its joint has there or at `times`, the next one smaller, and what constraints make of these.
    /// The speeds of driven joints are given.
    fn neighbour(&mut self, change: f64, times: &[State]) -> Option<State> {
        let mut from = self.initial.clone();
        for (index, body) in self.mechanism.joints() {
            if self.mechanism.is_driven(index) {
                continue;
            }
            let own = body.ranges().speeds.clone();
            let states = core::iter::once(self.initial).chain(times);
            let all = states.flat_map(|state| &state.speeds[own.clone()]);
            let largest = all.fold(0.0_f64, |most, v| most.max(v.abs()));
            let signs = [change, -change].into_iter().cycle();
            for (speed, sign) in from.speeds[own].iter_mut().zip(signs) {
                *speed += sign * largest;
            }
        }
        let completed = (self.dynamics).complete_speeds(&from.configuration, &mut from.speeds);
        let is_moved = from.speeds != self.initial.speeds;
        (completed.is_ok() && is_moved).then_some(from)
    }
}

/// The part by which speeds of a neighbour differ, above the errors of a method.
fn change_of(method: Method) -> f64 {
    let tolerance = method.control().map_or(1e-6, |control| control.tolerance);
    (10.0 * tolerance).clamp(1e-7, 1e-3)
}
