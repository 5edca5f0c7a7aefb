//! The command itself: measure what is missing, then make the page.

use super::args::Args;
use super::figures::Figures;
use super::machine::Machine;
use super::plan::Plan;
use super::progress::Progress;
use super::row::{Build, Drift, Stability, Work};
use super::store::{Store, set_aside};
use super::work::Stores;
use super::{drift, page, stability, work};
use crate::output::{self, Failure};
use hamel::registry::JointRegistry;
use std::path::Path;

/// Measures and writes the page.
///
/// # Errors
/// Options that name what is not there; files that cannot be read or written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let plan = Plan::new(args)?;
    let write = |error| Failure::Write {
        target: args.output.display().to_string(),
        error,
    };
    if !args.page_only {
        std::fs::create_dir_all(&args.output).map_err(write)?;
        measure(args, &plan, registry, &Machine::this().line())?;
    }
    let figures = Figures::read(&args.output)?;
    if args.page_only && figures.is_empty() {
        return Err(Failure::Options(format!(
            "{} holds no figures to make a page of, no work.csv, drift.csv or stability.csv with rows: measure first, or name another folder",
            args.output.display()
        )));
    }
    let page = args.output.join("index.html");
    std::fs::write(&page, page::render(&figures)?).map_err(|error| Failure::Write {
        target: page.display().to_string(),
        error,
    })?;
    if args.quiet {
        return Ok(());
    }
    let others = match figures.others.len() {
        0 => String::new(),
        count => format!(
            "machine   {}; figures of {count} other machines or versions are not on the page\n",
            figures.machine.processor
        ),
    };
    output::print(&format!(
        "{others}{} points of work and precision, {} of them failures\npage      {}\nfigures   {}\n",
        figures.work.len(),
        figures
            .work
            .iter()
            .filter(|row| !row.failure.is_empty())
            .count(),
        page.display(),
        args.output.join("*.csv").display()
    ))
}

fn measure(
    args: &Args,
    plan: &Plan,
    registry: &JointRegistry,
    machine: &str,
) -> Result<(), Failure> {
    let curves = work::count(plan)? + drift::count(plan) + stability::count(plan);
    let progress = Progress::new(curves, args.quiet);
    let tick = |what: &str| progress.at(what);
    let folder = &args.output;
    if args.fresh {
        begin_anew(folder, plan, machine)?;
    }
    let mut stores = Stores {
        work: Store::open(folder, machine)?,
        build: Store::open(folder, machine)?,
    };
    work::measure(plan, registry, machine, &mut stores, tick)?;
    let mut store = Store::open(folder, machine)?;
    stability::measure(plan, registry, machine, &mut store, tick)?;
    let mut store = Store::open(folder, machine)?;
    drift::measure(plan, registry, machine, &mut store, tick)?;
    progress.finish();
    Ok(())
}

/// Sets aside what the files have of what is to be measured.
fn begin_anew(folder: &Path, plan: &Plan, machine: &str) -> Result<(), Failure> {
    let work = || plan.cases.iter().map(|case| case.name);
    let stability = || plan.stiff.iter().map(|(name, _)| *name);
    let drift = || plan.drift.scenes.iter().copied();
    set_aside::<Work>(folder, |row| plan.covers(row, machine, work()))?;
    set_aside::<Build>(folder, |row| plan.covers(row, machine, work()))?;
    set_aside::<Stability>(folder, |row| plan.covers(row, machine, stability()))?;
    set_aside::<Drift>(folder, |row| plan.covers(row, machine, drift()))
}
