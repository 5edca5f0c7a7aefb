//! `--compiled`: a simulation on equations that are compiled for its scene.

use super::args::Args;
use super::plan::Plan;
use super::progress;
use hamel_console::compiled::{compiled, compiler};
use hamel_console::output::{Failure, tell};
use hamel_native::Equations;
use hamel_scene::Arithmetic;

/// The equations of the scene of `args`, for simulations in its form by its method.
///
/// # Errors
/// A scene in other arithmetic than that of compiled equations, and those of [`compiled`]; no C compiler.
pub fn equations(args: &Args, plan: &Plan) -> Result<Equations, Failure> {
    if plan.settings.arithmetic != Arithmetic::Doubles {
        return Err(Failure::Options(
            "compiled equations are evaluated in doubles, and the scene asks for others: with `--compiled` say `--arithmetic doubles`".into(),
        ));
    }
    let compiler = compiler()?;
    let progress = progress::compiling(args.quiet, &compiler);
    // Of the text that the mechanism was made of: what the file holds by now may be another scene.
    let (build, label) = (plan.input.build()?, plan.input.label());
    let kinds = hamel_native::functions(plan.settings.form, *plan.settings.method.scheme());
    let equations = compiled(build, label, kinds, &compiler, &plan.scene)?;
    progress.finish_and_clear();
    if !args.quiet {
        tell(&equations.left_out);
    }
    Ok(equations)
}

/// For the summary.
pub fn told(equations: &Equations) -> String {
    let seconds = equations.cost.generation + equations.cost.compilation;
    format!("compiled by {} in {seconds:.2} s", equations.compiler)
}
