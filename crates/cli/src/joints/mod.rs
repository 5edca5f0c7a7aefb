//! `hamel joints`: what the joint library holds, what was proved of it, and how to add to it.

mod check;
mod explain;
mod explain_error;
mod list;
mod new;
mod source;

use clap::Subcommand;
use hamel_console::output::Failure;

const EXAMPLES: &str = "\
Examples:
  hamel joints list
      the joints of the library
  hamel joints explain ball
      H, X, S, ∂S/∂ϕ, J22 as formulas, what was proved and how
  hamel joints explain ball --html -o ball.html
      the same as a page for a browser, with drawings
  hamel joints check my_joint.joint
      derives and proves a spec of your own; errors are shown where they stand
  hamel joints explain-error E0305
      why a spec is refused, with a wrong and a right one
  hamel joints new pin_slot
      writes pin_slot.joint to start from, in joint-specs/ where there is such a folder, else here

A JOINT is the name of a library joint, or the path of a .joint file (it contains `/` or ends in .joint).";

/// List, check and explain joints, or start a new one.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES, arg_required_else_help = true)]
pub struct Args {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    List(list::Args),
    Check(check::Args),
    Explain(explain::Args),
    ExplainError(explain_error::Args),
    New(new::Args),
}

/// Runs the subcommand.
pub fn run(args: &Args) -> Result<(), Failure> {
    match &args.command {
        Command::List(args) => list::run(args),
        Command::Check(args) => check::run(args),
        Command::Explain(args) => explain::run(args),
        Command::ExplainError(args) => explain_error::run(args),
        Command::New(args) => new::run(args),
    }
}

/// The shape of all JSON about joints.
#[derive(serde::Serialize)]
struct Library<T> {
    joints: Vec<T>,
}
