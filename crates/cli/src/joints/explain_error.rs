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
            Err(nearest) => Err(Failure::Options(unknown(code, nearest))),
        },
    }
}

/// The message of a code that no error has.
fn unknown(code: &str, nearest: Option<&str>) -> String {
    let advice = match nearest {
        Some(nearest) => format!("did you mean `{nearest}`?"),
        None => format!("codes of specs are {}.", ranges().join(", ")),
    };
    format!("no error has the code `{code}`: {advice} `hamel joints explain-error` lists all")
}

/// The first and the last code of each hundred.
fn ranges() -> Vec<String> {
    let hundred = |code: &str| code.chars().take(3).collect::<String>();
    let groups = code::ALL.chunk_by(|(a, _), (b, _)| hundred(a) == hundred(b));
    groups
        .filter_map(|group| Some(format!("{} to {}", group.first()?.0, group.last()?.0)))
        .collect()
}

fn list() -> String {
    let line = |(code, meaning): &(&str, &str)| format!("{code}  {meaning}\n");
    code::ALL.iter().map(line).collect()
}
