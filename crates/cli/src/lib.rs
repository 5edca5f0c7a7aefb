//! `hamel`: simulates and compiles scenes and robots, and explains joints, from the command line.
//!
//! This library holds the program, so that tests can be built with all of its features, and so that the Python package has it too. Exit code 0 means success, 1 that something went wrong (reported on stderr), 2 that the command line was not understood, 130 that it was interrupted.

mod compile;
mod import;
mod input;
mod joints;
mod pace;
mod parameters;
#[cfg(not(feature = "report"))]
#[path = "absent/report.rs"]
mod report;
mod simulate;
mod sweep;

use clap::{Parser, Subcommand};
use hamel_console::{interrupt, output, terminal};
#[cfg(feature = "report")]
use hamel_report as report;
use std::ffi::OsString;

/// What `hamel --help` ends with.
const FEATURES: &str = "`hamel help COMMAND` explains a command with examples.

What takes long to build is left out unless its features are asked for, `cargo run --release -p hamel-cli --features full`:
  parquet     trajectories, tables and results as Parquet: `simulate --parquet`, `sweep`
  predictive  scenes whose controller is model predictive control, `kind = \"mpc\"`
  report      `hamel report`: error against run time, with plots
  full        all of them";

/// Multibody mechanisms with holonomic and nonholonomic joints, without singularities.
#[derive(Debug, Parser)]
#[command(name = "hamel", version, arg_required_else_help = true)]
#[command(after_help = FEATURES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    // The only one with so many options.
    Simulate(Box<simulate::Args>),
    Compile(compile::Args),
    Import(import::Args),
    Joints(joints::Args),
    Parameters(parameters::Args),
    Report(report::Args),
    Sweep(sweep::Args),
}

/// The program: parses a command line, which begins with the name of the program, does what it says, and gives the exit code. From then on the process ends by Ctrl-C.
pub fn run(command_line: impl IntoIterator<Item = OsString>) -> u8 {
    interrupt::listen();
    let registry = hamel_joints::registry();
    let command = match Cli::try_parse_from(command_line) {
        Ok(cli) => cli.command,
        Err(answer) => {
            terminal::answer(&answer);
            return if answer.use_stderr() { 2 } else { 0 };
        }
    };
    let result = match command {
        Command::Simulate(args) => simulate::run(&args, &registry),
        Command::Compile(args) => compile::run(&args, &registry),
        Command::Import(args) => import::run(&args, &registry),
        Command::Joints(args) => joints::run(&args),
        Command::Parameters(args) => parameters::run(&args, &registry),
        Command::Report(args) => report::run(&args, &registry),
        Command::Sweep(args) => sweep::run(&args, &registry),
    };
    match result {
        Ok(()) => 0,
        Err(failure) if failure.is_broken_pipe() => 0,
        Err(failure) => {
            output::report(&failure);
            failure.exit_code()
        }
    }
}
