//! `hamel joints check`.

use super::{Library, source};
use hamel_codegen::derived::{Claim, Derived};
use hamel_codegen::emit::report::proof_in_words;
use hamel_codegen::model::Port;
use hamel_console::output::{self, Failure};
use serde::Serialize;

/// Derive joints anew and prove every claim.
///
/// Without names, all joints of the library. Exit code 1 if any spec is refused; its errors are on stderr.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Library joints or .joint files
    #[arg(value_name = "JOINT")]
    joints: Vec<String>,

    /// Print `{joints: [{name, ports, claims: [{claim, proof, points}]}]}` on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Checked {
    name: String,
    ports: Vec<String>,
    claims: Vec<Proved>,
}

#[derive(Serialize)]
struct Proved {
    claim: &'static str,
    proof: &'static str,
    /// Points at which a claim that is not proved was checked; 0 for proofs.
    points: usize,
}

/// Checks the joints and prints what was proved.
pub fn run(args: &Args) -> Result<(), Failure> {
    let names = match args.joints.is_empty() {
        true => source::library(),
        false => args.joints.clone(),
    };
    let (mut joints, mut failures) = (vec![], vec![]);
    for name in &names {
        match source::derive(name) {
            Ok(joint) => joints.push(joint),
            Err(failure) => failures.push(failure),
        }
    }
    match args.json {
        true => output::print_json(&Library {
            joints: joints.iter().map(checked).collect(),
        })?,
        false => output::print(&joints.iter().map(text).collect::<String>())?,
    }
    match failures.is_empty() {
        true => Ok(()),
        false => Err(Failure::Several(failures)),
    }
}

fn checked(joint: &Derived) -> Checked {
    let proved = |claim: &Claim| Proved {
        claim: claim.name,
        proof: claim.proof.name(),
        points: claim.points,
    };
    Checked {
        name: joint.spec.name.value.clone(),
        ports: (joint.spec.ports.iter())
            .map(|port| port.value.name.clone())
            .collect(),
        claims: joint.claims.iter().map(proved).collect(),
    }
}

fn text(joint: &Derived) -> String {
    let width = joint
        .claims
        .iter()
        .map(|claim| claim.statement.chars().count())
        .max()
        .unwrap_or(0);
    let line = |claim: &Claim| {
        format!(
            "  {:width$}  {}: {}\n",
            claim.statement,
            proof_in_words(claim),
            claim.detail
        )
    };
    let lines: String = joint.claims.iter().map(line).collect();
    let notes = [joint.still_in_words(), joint.named_columns_in_words()];
    let notes = notes.into_iter().flatten();
    let notes: String = notes.map(|note| format!("  note: {note}\n")).collect();
    let bodies = match joint.spec.bodies.as_slice() {
        [] => String::new(),
        names => format!(" (bodies {})", names.join(", ")),
    };
    let ports = joint.spec.ports.iter().map(|port| {
        let Port {
            name, unit, text, ..
        } = &port.value;
        format!("  port {name}: {unit} = {text}\n")
    });
    let ports: String = ports.collect();
    let pins = joint.spec.pins.iter();
    let pins: String = pins
        .map(|pin| format!("  pin {}: {}\n", pin.value.name, pin.value.text))
        .collect();
    format!(
        "{}{bodies}\n{lines}{ports}{pins}{notes}\n",
        joint.spec.name.value
    )
}
