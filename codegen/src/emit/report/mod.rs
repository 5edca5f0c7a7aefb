//! What is known of a joint, as text: the one data model behind pages, terminal output and the docs of emitted code.

mod formulas;
pub mod layout;
pub mod notation;
mod provenance;
mod series;
mod tables;
pub mod units;

pub use formulas::{Formula, main_formulas};
pub use provenance::{Statement, sources, statement};
pub use series::{Series, series};
pub use tables::{ClaimRow, CountRow, FreedomRow, ParameterRow};

use super::names::type_name;
use crate::derived::Derived;
use crate::model::{JointSpec, VelocityFrame};
use notation::Notation;

/// All that a page shows.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name of the spec.
    pub name: String,
    /// Name of the type in Rust.
    pub type_name: String,
    /// First sentence of the doc comment.
    pub summary: String,
    /// The doc comment, line by line.
    pub docs: Vec<String>,
    /// Parameters.
    pub parameters: Vec<ParameterRow>,
    /// The manifold: `Q ∈ SO3`.
    pub manifold: String,
    /// Stored scalars in order.
    pub coordinates: Vec<String>,
    /// Freedoms in order.
    pub freedoms: Vec<FreedomRow>,
    /// Speeds in order.
    pub speeds: Vec<String>,
    /// The frame in which v is read, in words.
    pub velocity_frame: String,
    /// The formulas.
    pub formulas: Vec<Formula>,
    /// The claims.
    pub claims: Vec<ClaimRow>,
    /// Structure and operations of each emitted kernel.
    pub counts: Vec<CountRow>,
    /// The inertias that the joint cannot feel: `Ixx + Iyy`.
    pub imperceptible: Vec<String>,
    /// Text of the spec.
    pub spec: String,
}

impl Report {
    /// The report of a joint.
    pub fn new(derived: &Derived) -> Self {
        let spec = &derived.spec;
        let notation = Notation::new(derived);
        let coordinates = &derived.arguments.configuration;
        Self {
            name: spec.name.value.clone(),
            type_name: type_name(&spec.name.value),
            summary: summary(&spec.docs, &spec.name.value),
            docs: spec
                .docs
                .iter()
                .map(|line| line.trim().to_owned())
                .collect(),
            parameters: tables::parameters(derived),
            manifold: manifold(derived),
            coordinates: coordinates
                .iter()
                .map(|symbol| notation.symbol(symbol))
                .collect(),
            freedoms: tables::freedoms(derived, &notation),
            speeds: derived.speed_names.clone(),
            velocity_frame: velocity_frame(spec).to_owned(),
            formulas: formulas::formulas(derived, &notation),
            claims: tables::claims(derived),
            counts: tables::counts(derived),
            imperceptible: tables::imperceptible(derived),
            spec: spec.source.clone(),
        }
    }
}

/// The first sentence of a doc comment.
pub fn summary(docs: &[String], name: &str) -> String {
    let text: Vec<&str> = docs
        .iter()
        .map(|line| line.trim())
        .take_while(|line| !line.is_empty())
        .collect();
    let text = text.join(" ");
    let end = text.find(". ").map_or(text.len(), |at| at + 1);
    match text[..end].is_empty() {
        true => format!("Joint `{name}`."),
        false => text[..end].to_owned(),
    }
}

/// The configuration manifold: `R ∈ SO3, p ∈ R3`.
pub fn manifold(derived: &Derived) -> String {
    let factors = derived.spec.manifold.value.factors().iter();
    let named: Vec<String> = factors
        .map(|factor| format!("{} ∈ {}", factor.name, factor.kind.name()))
        .collect();
    named.join(", ")
}

/// The frame of v, in words.
pub fn velocity_frame(spec: &JointSpec) -> &'static str {
    match spec.velocity.value {
        VelocityFrame::Child => "in the axes of the child",
        VelocityFrame::Parent => "in the axes of the parent",
        VelocityFrame::Rates if spec.twist_map.is_some() => "as X declares",
        VelocityFrame::Rates => "as the rates of the local coordinates",
    }
}
