//! The command itself: measure what is missing, then make the page.

use super::args::Args;
use super::figures::Figures;
use super::machine::Machine;
use super::plan::Plan;
use super::progress::Progress;
use super::store::Store;
use super::{drift, page, stability, work};
use crate::output::{self, Failure};
use hamel::registry::JointRegistry;

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
    std::fs::create_dir_all(&args.output).map_err(write)?;
    if !args.page_only {
        measure(args, &plan, registry, &Machine::this().line())?;
    }
    let figures = Figures::read(&args.output)?;
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
    let mut store = Store::open(folder, machine, args.fresh)?;
    work::measure(plan, registry, machine, &mut store, tick)?;
    let mut store = Store::open(folder, machine, args.fresh)?;
    stability::measure(plan, registry, machine, &mut store, tick)?;
    let mut store = Store::open(folder, machine, args.fresh)?;
    drift::measure(plan, registry, machine, &mut store, tick)?;
    progress.finish();
    Ok(())
}
