//! What the page shows of what the files hold: figures of one machine, and of each curve those that were measured longest.

use super::build_cost::{self, Cost};
use super::machine::Machine;
use super::peers::{self, Peer};
use super::row::{Build, Drift, Estimate, Row, Stability, Work};
use super::store::read;
use hamel_console::output::Failure;
use itertools::Itertools;
use std::collections::HashSet;
use std::path::Path;

/// All that the page is made of.
#[derive(Debug)]
pub struct Figures {
    pub work: Vec<Work>,
    pub drift: Vec<Drift>,
    pub stability: Vec<Stability>,
    pub costs: Vec<Cost>,
    /// What compiled scenes cost.
    pub builds: Vec<Build>,
    /// Estimated errors beside true ones.
    pub estimates: Vec<Estimate>,
    /// Runs of other libraries, on whatever machine.
    pub peers: Vec<Peer>,
    pub machine: Machine,
    /// Machines and versions whose rows are left out.
    pub others: Vec<String>,
}

impl Figures {
    /// Those of this machine; where the files have none of it, those of the machine that measured last.
    ///
    /// # Errors
    /// Files that cannot be read.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let mut work = read::<Work>(folder)?;
        let mut drift = read::<Drift>(folder)?;
        let mut stability = read::<Stability>(folder)?;
        let mut builds = read::<Build>(folder)?;
        let mut estimates = read::<Estimate>(folder)?;
        let this = Machine::this().line();
        // The last one first.
        let rows = work.iter().rev().map(Row::machine);
        let rows = rows.chain(drift.iter().rev().map(Row::machine));
        let rows = rows.chain(stability.iter().rev().map(Row::machine));
        let mut machines: Vec<String> = rows.unique().map(str::to_owned).collect();
        let shown = match machines.contains(&this) {
            true => this,
            false => machines.first().cloned().unwrap_or(this),
        };
        machines.sort();
        machines.retain(|machine| *machine != shown);
        work.retain(|row| row.machine == shown);
        drift.retain(|row| row.machine == shown);
        stability.retain(|row| row.machine == shown);
        builds.retain(|row| row.machine == shown);
        estimates.retain(|row| row.machine == shown);
        Ok(Self {
            work: longest(work, |row| {
                let Work {
                    scene,
                    form,
                    method,
                    representation,
                    implementation,
                    ..
                } = row;
                (
                    format!("{scene} {form} {method} {representation} {implementation}"),
                    &row.budget,
                )
            }),
            drift: longest(drift, |row| {
                let Drift {
                    scene,
                    form,
                    method,
                    ..
                } = row;
                (format!("{scene} {form} {method}"), &row.budget)
            }),
            stability,
            costs: build_cost::costs()?,
            builds,
            estimates: longest(estimates, |row| {
                let Estimate {
                    scene,
                    form,
                    method,
                    ..
                } = row;
                (format!("{scene} {form} {method}"), &row.budget)
            }),
            peers: peers::read(folder)?,
            machine: Machine::of(&shown),
            others: machines,
        })
    }

    /// Whether nothing has been measured.
    pub fn is_empty(&self) -> bool {
        self.work.is_empty() && self.drift.is_empty() && self.stability.is_empty()
    }
}

/// Without the rows of a short look at curves that have been measured in full.
fn longest<R: Clone>(rows: Vec<R>, curve_and_budget: impl Fn(&R) -> (String, &String)) -> Vec<R> {
    let in_full: HashSet<String> = rows
        .iter()
        .map(&curve_and_budget)
        .filter(|(_, budget)| *budget == "full")
        .map(|(curve, _)| curve)
        .collect();
    let stays = |row: &&R| {
        let (curve, budget) = curve_and_budget(row);
        budget == "full" || !in_full.contains(&curve)
    };
    rows.iter().filter(stays).cloned().collect()
}
