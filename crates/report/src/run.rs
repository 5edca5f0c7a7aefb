//! The command itself: measure what is missing, then make the page.

use super::args::Args;
use super::figures::Figures;
use super::machine::Machine;
use super::plan::Plan;
use super::progress::Progress;
use super::row::{Build, Drift, Estimate, Stability, Work};
use super::store::{Store, Stores, set_aside};
use super::{drift, estimate, page, stability, work};
use hamel::registry::JointRegistry;
use hamel_console::files::{Lock, Output, admit};
use hamel_console::interrupt::Heed;
use hamel_console::output::{self, Failure};
use std::path::Path;

/// Measures and writes the page.
///
/// # Errors
/// Options that name what is not there; files that cannot be read or written.
pub fn run(args: &Args, registry: &JointRegistry) -> Result<(), Failure> {
    let plan = Plan::new(args)?;
    let folder = &args.output;
    if !args.page_only {
        std::fs::create_dir_all(folder).map_err(|error| Failure::write(folder, error))?;
    }
    // Without the folder there are no figures, which is told below.
    let lock = folder
        .is_dir()
        .then(|| Lock::of(folder, "hamel report"))
        .transpose()?;
    let page = folder.join("index.html");
    let admitted = || admit([], [(&*page, page::is_own as _)], args.force.force);
    let output: Option<Output> = match &lock {
        Some(_) => admitted()?.pop(),
        None => None,
    };
    if !args.page_only {
        measure(args, &plan, registry, &Machine::this().line())?;
    }
    let figures = Figures::read(folder)?;
    if args.page_only && figures.is_empty() {
        return Err(Failure::Options(format!(
            "{} holds no figures to make a page of, no work.csv, drift.csv or stability.csv with rows: measure first, or name another folder",
            folder.display()
        )));
    }
    if let Some(output) = output {
        output.write(page::render(&figures, registry)?)?;
    }
    drop(lock);
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
    let curves =
        work::count(plan)? + estimate::count(plan) + drift::count(plan) + stability::count(plan);
    let progress = Progress::new(curves, args.quiet);
    let tick = |what: &str| progress.at(what);
    let folder = &args.output;
    if args.fresh {
        begin_anew(folder, plan, machine)?;
    }
    let mut stores = Stores {
        work: Store::open(folder, machine)?,
        estimates: Store::open(folder, machine)?,
        build: Store::open(folder, machine)?,
        stability: Store::open(folder, machine)?,
        drift: Store::open(folder, machine)?,
    };
    let heed = Heed::begin();
    let measured = work::measure(plan, registry, machine, &mut stores, tick)
        .and_then(|()| estimate::measure(plan, registry, machine, &mut stores.estimates, tick))
        .and_then(|()| stability::measure(plan, registry, machine, &mut stores.stability, tick))
        .and_then(|()| drift::measure(plan, registry, machine, &mut stores.drift, tick));
    // What was measured stays, whatever came then.
    let saved = stores.save();
    drop(heed);
    measured.and(saved)?;
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
    set_aside::<Estimate>(folder, |row| plan.covers(row, machine, work()))?;
    set_aside::<Stability>(folder, |row| plan.covers(row, machine, stability()))?;
    set_aside::<Drift>(folder, |row| plan.covers(row, machine, drift()))
}
