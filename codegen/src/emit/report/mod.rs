//! What is known of a joint, as text: the one data model behind pages, terminal output and the docs of emitted code.

mod accuracy;
mod finite;
mod formulas;
pub mod layout;
pub mod notation;
mod provenance;
mod ranges;
mod series;
mod shared;
mod tables;
pub mod typeset;
pub mod units;

pub use accuracy::{Accuracy, AccuracyError, AccuracyRow};
pub use finite::FiniteRow;
pub use formulas::{Formula, formula, main_formulas};
pub use provenance::{Statement, sources, statement};
pub use series::{Series, series};
pub use tables::{ClaimRow, CountRow, FreedomRow, ParameterRow, PinRow, PortRow, proof_in_words};

use super::types::type_name;
use crate::derived::{Derived, Shape};
use crate::model::{Declared, JointSpec, Locus, VelocityFrame};
use notation::Notation;
use typeset::Math;

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
    /// Sizes.
    pub shape: Shape,
    /// Names of the bodies, where the spec gives some.
    pub bodies: Vec<String>,
    /// Parameters.
    pub parameters: Vec<ParameterRow>,
    /// Conditions on several parameters, as the spec writes them.
    pub requirements: Vec<String>,
    /// The manifold: `Q ∈ SO3`.
    pub manifold: String,
    /// Stored scalars in order.
    pub coordinates: Vec<String>,
    /// The stored scalars at home, where the spec declares them.
    pub home: Vec<String>,
    /// Whether these are a guess, near which home is assembled for the values of the parameters.
    pub home_is_guess: bool,
    /// Freedoms in order.
    pub freedoms: Vec<FreedomRow>,
    /// Speeds in order.
    pub speeds: Vec<String>,
    /// Ports in order.
    pub ports: Vec<PortRow>,
    /// Pins in order.
    pub pins: Vec<PinRow>,
    /// What moves no body, in words; empty where everything does.
    pub still: String,
    /// The frame in which v is read, in words.
    pub velocity_frame: String,
    /// The formulas.
    pub formulas: Vec<Formula>,
    /// Where the joint ends, and why.
    pub singularities: Vec<LocusRow>,
    /// The claims.
    pub claims: Vec<ClaimRow>,
    /// How the maps at finite ϕ and onto the manifold are found.
    pub finite: Vec<FiniteRow>,
    /// Structure and operations of each emitted kernel.
    pub counts: Vec<CountRow>,
    /// Measured errors of the kernels, where figures were given.
    pub accuracy: Vec<AccuracyRow>,
    /// The inertias that do not affect the joint: `Ixx + Iyy`.
    pub unidentifiable: Vec<String>,
    /// Text of the spec.
    pub spec: String,
}

impl Report {
    /// The report of a joint.
    pub fn new(derived: &Derived) -> Self {
        Self {
            formulas: formulas::formulas(derived, &Notation::new(derived)),
            counts: tables::counts(derived),
            ..Self::brief(derived)
        }
    }

    /// The report without formulas and counts, which take most of the time to make.
    pub fn brief(derived: &Derived) -> Self {
        let spec = &derived.spec;
        let notation = Notation::new(derived);
        let coordinates = &derived.arguments.configuration;
        Self {
            name: spec.name.value.clone(),
            type_name: type_name(&spec.name.value),
            summary: summary(&spec.docs, &spec.name.value),
            docs: spec.docs.clone(),
            shape: derived.shape,
            bodies: spec.bodies.clone(),
            parameters: tables::parameters(derived),
            requirements: requirements(spec),
            manifold: manifold(derived),
            coordinates: coordinates
                .iter()
                .map(|symbol| notation.symbol(symbol))
                .collect(),
            home: home(spec, &notation),
            home_is_guess: spec.home_is_guess,
            freedoms: tables::freedoms(derived, &notation),
            speeds: derived.speed_names.clone(),
            ports: tables::ports(derived),
            pins: tables::pins(derived),
            still: derived.still_in_words().unwrap_or_default(),
            velocity_frame: velocity_frame(spec).to_owned(),
            formulas: vec![],
            singularities: singularities(derived, &notation),
            claims: tables::claims(derived),
            finite: finite::rows(derived),
            accuracy: vec![],
            counts: vec![],
            unidentifiable: tables::unidentifiable(derived),
            spec: spec.source.clone(),
        }
    }

    /// With what was measured of this joint.
    #[must_use]
    pub fn with_accuracy(mut self, accuracy: &Accuracy) -> Self {
        self.accuracy = accuracy.of_joint(&self.name);
        self
    }

    /// What is known of the configurations that share a pose: the statement and its reason.
    pub fn fibres(&self) -> Option<&ClaimRow> {
        self.claims.iter().find(|claim| claim.name == "fibres")
    }
}

/// A place where the joint ends.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LocusRow {
    /// The function whose zeros it is.
    pub function: Math,
    /// The function as the spec writes it.
    pub text: String,
    /// Why the joint ends there.
    pub cause: String,
}

fn singularities(derived: &Derived, notation: &Notation) -> Vec<LocusRow> {
    let row = |locus: &Declared<Locus>| LocusRow {
        function: notation.set(&locus.value.function),
        text: locus.value.text.clone(),
        cause: locus
            .value
            .docs
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" "),
    };
    derived.space.loci.iter().map(row).collect()
}

fn requirements(spec: &JointSpec) -> Vec<String> {
    let conditions = spec.requirements.iter();
    conditions
        .map(|condition| condition.value.text.clone())
        .collect()
}

fn home(spec: &JointSpec, notation: &Notation) -> Vec<String> {
    let declared = spec.home.iter().flat_map(|home| &home.value);
    declared.map(|value| notation.set(value).text()).collect()
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
    let factors = derived.space.manifold.factors().iter();
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
