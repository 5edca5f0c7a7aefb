//! `hamel joints explain-error`.

use hamel_codegen::spec::code;
use hamel_console::output::{self, Failure};

/// Explain an error code of specs: why it is an error, a spec that has it, and one that has not.
///
/// Without a code, all codes with their meaning.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The code as errors show it, `E0305`
    #[arg(value_name = "CODE")]
    code: Option<String>,
}

/// Prints the page of the code, or the list of all.
pub fn run(args: &Args) -> Result<(), Failure> {
    match &args.code {
        None => output::print(&list()),
        Some(code) => match code::explain(code) {
            Ok(page) => output::print(&page),
            Err(nearest) => Err(Failure::Options(format!(
                "no error has the code `{code}`: did you mean `{nearest}`? Without a code, all are listed"
            ))),
        },
    }
}

fn list() -> String {
    let line = |(code, meaning): &(&str, &str)| format!("{code}  {meaning}\n");
    code::ALL.iter().map(line).collect()
}
