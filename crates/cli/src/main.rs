//! `hamel`: simulates and compiles scenes and robots, and explains joints, from the command line.
//!
//! Exit code 0 means success, 1 that something went wrong (told on stderr), 2 that the command line was not understood, 130 that it was interrupted.

mod cells;
mod compile;
mod compiled;
mod files;
mod import;
mod input;
mod interrupt;
mod joints;
mod output;
mod report;
mod simulate;
mod terminal;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Multibody mechanisms with holonomic and nonholonomic joints, without singularities.
#[derive(Debug, Parser)]
#[command(name = "hamel", version, arg_required_else_help = true)]
#[command(after_help = "`hamel help COMMAND` explains a command with examples.")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Simulate(simulate::Args),
    Compile(compile::Args),
    Import(import::Args),
    Joints(joints::Args),
    Report(report::Args),
}

fn main() -> ExitCode {
    interrupt::listen();
    let registry = hamel_joints::registry();
    let command = match Cli::try_parse() {
        Ok(cli) => cli.command,
        Err(answer) => {
            terminal::answer(&answer);
            return ExitCode::from(if answer.use_stderr() { 2 } else { 0 });
        }
    };
    let result = match command {
        Command::Simulate(args) => simulate::run(&args, &registry),
        Command::Compile(args) => compile::run(&args, &registry),
        Command::Import(args) => import::run(&args, &registry),
        Command::Joints(args) => joints::run(&args),
        Command::Report(args) => report::run(&args, &registry),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) if failure.is_broken_pipe() => ExitCode::SUCCESS,
        Err(failure) => {
            output::report(&failure);
            failure.exit_code()
        }
    }
}
