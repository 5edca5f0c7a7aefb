//! `hamel joints list`.

use super::{Library, source};
use comfy_table::presets::UTF8_HORIZONTAL_ONLY;
use comfy_table::{ContentArrangement, Table};
use hamel_codegen::derived::Derived;
use hamel_codegen::model::{Declared, Port};
use hamel_console::output::{self, Failure};
use serde::Serialize;

/// List the joints of the library.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Print JSON on stdout
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Entry {
    name: String,
    summary: String,
    configuration: String,
    freedoms: Vec<String>,
    speeds: Vec<String>,
    /// Those that the spec names; none where it carries one body.
    bodies: Vec<String>,
    ports: Vec<Parameter>,
    parameters: Vec<Parameter>,
}

/// A parameter or a port.
#[derive(Serialize)]
struct Parameter {
    name: String,
    unit: String,
}

/// Prints the list.
pub fn run(args: &Args) -> Result<(), Failure> {
    let names = source::library();
    let entries = names
        .iter()
        .map(|name| Ok(entry(&source::derive(name)?)))
        .collect::<Result<Vec<_>, Failure>>()?;
    match args.json {
        true => output::print_json(&Library { joints: entries }),
        false => output::print(&format!(
            "{}\n`hamel joints explain NAME` shows one of them.\n",
            table(&entries)
        )),
    }
}

fn entry(joint: &Derived) -> Entry {
    let spec = &joint.spec;
    let factors = spec
        .manifold
        .value
        .factors()
        .iter()
        .map(|factor| format!("{}: {}", factor.name, factor.kind.name()));
    let parameter = |p: &hamel_codegen::model::Parameter| Parameter {
        name: p.symbol.name().to_owned(),
        unit: p.unit.clone(),
    };
    let port = |p: &Declared<Port>| Parameter {
        name: p.value.name.clone(),
        unit: p.value.unit.clone(),
    };
    Entry {
        name: spec.name.value.clone(),
        summary: spec
            .docs
            .iter()
            .map(|line| line.trim())
            .find(|line| !line.is_empty())
            .unwrap_or_default()
            .to_owned(),
        configuration: factors.collect::<Vec<_>>().join(", "),
        freedoms: spec
            .freedoms
            .value
            .iter()
            .map(|freedom| freedom.name.clone())
            .collect(),
        speeds: joint.speed_names.clone(),
        bodies: spec.bodies.clone(),
        ports: spec.ports.iter().map(port).collect(),
        parameters: spec.parameters.iter().map(parameter).collect(),
    }
}

fn table(entries: &[Entry]) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_HORIZONTAL_ONLY);
    // As wide as the terminal, where there is one.
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_header(["joint", "Q", "v", "speeds", "parameters", "what it is"]);
    for entry in entries {
        let parameters: Vec<String> = entry
            .parameters
            .iter()
            .map(|p| format!("{} ({})", p.name, p.unit))
            .collect();
        let speeds = match entry.speeds == entry.freedoms {
            true => "= v".to_owned(),
            false => entry.speeds.join(", "),
        };
        table.add_row([
            &entry.name,
            &entry.configuration,
            &entry.freedoms.join(", "),
            &speeds,
            &parameters.join(", "),
            &entry.summary,
        ]);
    }
    table
}
