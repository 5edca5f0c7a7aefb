//! The rows of a report's tables.

use super::notation::Notation;
use super::ranges;
use super::units;
use crate::derived::{Claim, Derived, Kernel, Method as FoundBy, Structure};
use crate::emit::method::{Method, of_further_body, products};
use crate::expand::{PinDrive, Source};
use crate::expr::Rational;
use crate::formula::Counts;
use crate::model::{Declared, Parameter, Pin, Port};
use num_traits::{One, Zero};

/// A parameter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParameterRow {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// What it means.
    pub description: String,
    /// Values that it may take: `lead > 0`.
    pub range: String,
}

/// A degree of freedom.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FreedomRow {
    /// Its name.
    pub name: String,
    /// Its local coordinate.
    pub local: String,
    /// Its velocity.
    pub velocity: String,
    /// Unit of the local coordinate, empty where the spec does not determine it.
    pub unit: String,
    /// Unit of the velocity, empty where the spec does not determine it.
    pub rate_unit: String,
}

/// A port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PortRow {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Its value as the spec writes it.
    pub value: String,
    /// What it means, and that its angle does not count turns where it does not.
    pub description: String,
}

/// A pin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PinRow {
    /// Its name.
    pub name: String,
    /// The bodies and points that it joins, as the spec writes them.
    pub value: String,
    /// What it means, and which efforts act there.
    pub description: String,
}

/// A claim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClaimRow {
    /// Its stable name.
    pub name: String,
    /// The claim.
    pub statement: String,
    /// How it was proved: `normal_form`, `certificate`, `checked`.
    pub kind: &'static str,
    /// How it was proved, in words.
    pub proof: String,
    /// The certificate, or what was evaluated.
    pub detail: String,
}

/// An emitted kernel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CountRow {
    /// Name of the method.
    pub kernel: String,
    /// What is known at compile time.
    pub structure: String,
    /// The operations of its formulas.
    pub operations: Counts,
    /// What the runtime does besides: a solve, an iteration, or nothing.
    pub besides: Option<&'static str>,
}

impl CountRow {
    /// The operations of its formulas, and what the runtime does besides.
    pub fn work(&self) -> String {
        match (self.besides, self.operations.total()) {
            (None, _) => self.operations.to_string(),
            (Some(besides), 0) => besides.to_owned(),
            (Some(besides), _) => format!("{}, and {besides}", self.operations),
        }
    }
}

pub(super) fn parameters(derived: &Derived) -> Vec<ParameterRow> {
    let row = |parameter: &Parameter| ParameterRow {
        name: parameter.symbol.name().to_string(),
        unit: parameter.unit.clone(),
        description: parameter
            .docs
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" "),
        range: ranges::in_words(parameter.symbol.name(), &parameter.range),
    };
    derived.spec.parameters.iter().map(row).collect()
}

pub(super) fn ports(derived: &Derived) -> Vec<PortRow> {
    let row = |port: &Declared<Port>| {
        let port = &port.value;
        let docs = port.docs.split_whitespace().collect::<Vec<_>>().join(" ");
        let turns = port.wraps().then_some("The angle is up to whole turns.");
        let said = [docs.as_str(), turns.unwrap_or_default()];
        let said: Vec<&str> = said.into_iter().filter(|text| !text.is_empty()).collect();
        PortRow {
            name: port.name.clone(),
            unit: port.unit.clone(),
            value: port.text.clone(),
            description: said.join(" "),
        }
    };
    derived.spec.ports.iter().map(row).collect()
}

pub(super) fn pins(derived: &Derived) -> Vec<PinRow> {
    let spec = &derived.spec;
    let rows = spec.pins.iter().zip(&derived.pin_drives);
    let row = |(declared, drives): (&Declared<Pin>, &Vec<PinDrive>)| {
        let pin = &declared.value;
        let docs = pin.docs.split_whitespace().collect::<Vec<_>>().join(" ");
        let efforts = drives.iter().map(|drive| match drive.source {
            Source::Port(place) => format!("at port `{}`", spec.ports[place].value.name),
            Source::Freedom(place) => format!("on `{}`", spec.freedoms.value[place].name),
        });
        let efforts: Vec<String> = efforts.collect();
        let acting = match efforts.as_slice() {
            [] => String::new(),
            efforts => format!("Efforts {} act here.", efforts.join(" and ")),
        };
        let said = [docs, acting].into_iter().filter(|text| !text.is_empty());
        PinRow {
            name: pin.name.clone(),
            value: pin.text.clone(),
            description: said.collect::<Vec<_>>().join(" "),
        }
    };
    rows.map(row).collect()
}

pub(super) fn freedoms(derived: &Derived, notation: &Notation) -> Vec<FreedomRow> {
    let units = units::of_freedoms(derived)
        .into_iter()
        .zip(units::of_velocities(derived));
    let symbols = derived
        .arguments
        .local
        .iter()
        .zip(&derived.arguments.velocity);
    let freedoms = derived.spec.freedoms.value.iter().zip(symbols).zip(units);
    freedoms
        .map(
            |((freedom, (local, velocity)), (unit, rate_unit))| FreedomRow {
                name: freedom.name.clone(),
                local: notation.symbol(local),
                velocity: notation.symbol(velocity),
                unit,
                rate_unit,
            },
        )
        .collect()
}

pub(super) fn claims(derived: &Derived) -> Vec<ClaimRow> {
    let row = |claim: &Claim| ClaimRow {
        name: claim.name.to_owned(),
        statement: claim.statement.clone(),
        kind: claim.proof.name(),
        proof: proof_in_words(claim),
        detail: claim.detail.clone(),
    };
    derived.claims.iter().map(row).collect()
}

/// How a claim was proved: `normal form`, or that it was not.
pub fn proof_in_words(claim: &Claim) -> String {
    match claim.points {
        0 => claim.proof.name().replace('_', " "),
        points => format!("checked at {points} points, not proved"),
    }
}

pub(super) fn counts(derived: &Derived) -> Vec<CountRow> {
    let names = derived.names();
    let row = |kernel: &Kernel| {
        let method = Method::new(derived, kernel, &names);
        let products = products(derived, kernel);
        CountRow {
            kernel: method.signature.name.to_owned(),
            structure: structure_in_words(kernel.structure).to_owned(),
            operations: products.unwrap_or_else(|| method.counts()),
            besides: products.map_or_else(
                || besides(kernel.method),
                |_| Some("all by products of other kernels"),
            ),
        }
    };
    let own = derived.kernels.iter().map(row);
    let others = derived.more.iter().flat_map(counts_of_body);
    own.chain(others).collect()
}

/// The rows of what is emitted for a further body, with its name.
fn counts_of_body(derived: &Derived) -> Vec<CountRow> {
    let names = derived.names();
    let row = |kernel: &Kernel| {
        let method = Method::new(derived, kernel, &names);
        let name = derived.body_name().unwrap_or_default();
        CountRow {
            kernel: format!("{} of {name}", method.signature.name),
            structure: structure_in_words(kernel.structure).to_owned(),
            operations: method.counts(),
            besides: None,
        }
    };
    of_further_body(derived).map(row).collect()
}

fn besides(found: FoundBy) -> Option<&'static str> {
    match found {
        FoundBy::Formula => None,
        FoundBy::Solve => Some("a K×K solve"),
        FoundBy::Newton => Some("Newton's method"),
    }
}

fn structure_in_words(structure: Structure) -> &'static str {
    match structure {
        Structure::Zero => "zero",
        Structure::Identity => "identity",
        Structure::Constant => "constant",
        Structure::General => "general",
    }
}

const INERTIA: [&str; 10] = [
    "m", "mc_x", "mc_y", "mc_z", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz",
];

/// Each element of the basis of N_X as a sum of parameters of an inertia.
pub(super) fn unidentifiable(derived: &Derived) -> Vec<String> {
    let of_body = |body: &Derived| -> Vec<String> {
        let sums = body.unidentifiable.iter().map(combination);
        match body.body_name() {
            Some(name) => sums.map(|sum| format!("{name}: {sum}")).collect(),
            None => sums.collect(),
        }
    };
    derived.bodies().flat_map(of_body).collect()
}

fn combination(weights: &[Rational; 10]) -> String {
    let mut text = String::new();
    for (weight, name) in weights
        .iter()
        .zip(INERTIA)
        .filter(|(weight, _)| !weight.is_zero())
    {
        text += match (text.is_empty(), weight.is_negative()) {
            (true, false) => "",
            (true, true) => "−",
            (false, false) => " + ",
            (false, true) => " − ",
        };
        let size = weight.abs();
        text += &if size.is_one() {
            name.to_owned()
        } else {
            format!("{size} {name}")
        };
    }
    text
}
