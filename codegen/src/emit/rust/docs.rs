//! Documentation of emitted code: what a kernel maps, its shape, frame and units, its equation, its cost.

use super::numeric;
use crate::derived::{Derived, Kernel, KernelKind, Structure};
use crate::emit::method::{
    Method, Output, Signature, absent_in_words, meaning, operations_by_products,
};
use crate::emit::report::{
    ClaimRow, FreedomRow, Report, Statement, main_formulas, manifold, sources, units,
    velocity_frame,
};
use crate::text::{inline, markdown, visible};
use proc_macro2::TokenStream;
use quote::quote;

/// Longest statement that documentation quotes in full, in characters; of a longer one the line number says the rest.
const LONGEST_STATEMENT: usize = 100;

/// Lines of outer documentation.
pub fn outer<S: AsRef<str>>(lines: &[S]) -> TokenStream {
    let lines = lines.iter().map(|line| spaced(line.as_ref()));
    quote! { #(#[doc = #lines])* }
}

fn inner(lines: &[String]) -> TokenStream {
    let lines = lines.iter().map(|line| spaced(line));
    quote! { #(#![doc = #lines])* }
}

fn spaced(line: &str) -> String {
    if line.is_empty() {
        String::new()
    } else {
        format!(" {}", visible(line))
    }
}

/// The documentation of a joint's module.
pub fn module(derived: &Derived) -> TokenStream {
    let report = Report::brief(derived);
    let mut lines: Vec<String> = match report.docs.is_empty() {
        true => vec![report.summary.clone()],
        false => markdown(&report.docs),
    };
    lines.push(String::new());
    lines.extend(storage(derived, &report));
    lines.extend(absent_in_words(derived));
    lines.extend([String::new(), "```text".into()]);
    for (i, formula) in main_formulas(derived).into_iter().enumerate() {
        lines.extend((i > 0).then(String::new));
        lines.extend(formula.text.lines().map(str::to_owned));
    }
    lines.push("```".into());
    lines.extend(claims(&report));
    inner(&lines)
}

fn storage(derived: &Derived, report: &Report) -> Vec<String> {
    let freedom = |row: &FreedomRow| match row.unit.is_empty() {
        true => format!("`{}` ({})", row.name, row.local),
        false => format!("`{}` ({}, {})", row.name, row.local, row.unit),
    };
    let freedoms: Vec<String> = report.freedoms.iter().map(freedom).collect();
    let mut lines = vec![
        format!(
            "- Configuration: {}, stored as {}.",
            manifold(derived),
            report.coordinates.join(", ")
        ),
        format!("- Degrees of freedom: {}.", freedoms.join(", ")),
        format!("- Velocity v: read {}.", velocity_frame(&derived.spec)),
    ];
    if derived.shape.constraints > 0 {
        let speeds: Vec<String> = report
            .speeds
            .iter()
            .map(|name| format!("`{name}`"))
            .collect();
        lines.push(format!(
            "- Speeds v\u{304}: {}; constraints: {}.",
            speeds.join(", "),
            derived.shape.constraints
        ));
    }
    lines
}

fn claims(report: &Report) -> Vec<String> {
    if report.claims.is_empty() {
        return vec![];
    }
    let claim = |row: &ClaimRow| {
        format!(
            "- `{}`: {} ({})",
            row.name,
            inline(&row.statement),
            inline(&row.proof)
        )
    };
    let head = [String::new(), "Proved when this file was generated:".into()];
    head.into_iter()
        .chain(report.claims.iter().map(claim))
        .collect()
}

/// The documentation of a kernel.
pub fn kernel(derived: &Derived, kernel: &Kernel, method: &Method<'_>) -> TokenStream {
    let mut lines = vec![meaning(kernel.kind).to_owned()];
    let shape = shape_of(derived, kernel);
    let cost = match numeric::sentence(derived, kernel) {
        Some(sentence) => sentence.to_owned(),
        None => format!(
            "Operations: {}{}{}.",
            method.counts(),
            asked(method),
            instead(derived, kernel)
        ),
    };
    lines.push(format!("{shape}{} {cost}", constancy(kernel.structure)));
    lines.extend(origin(&sources(derived, kernel.kind)));
    outer(&lines)
}

/// The functions whose operations are not counted.
fn asked(method: &Method<'_>) -> String {
    let names = method
        .asked
        .iter()
        .map(|function| format!(" and those of `{}`", function.name));
    names.collect()
}

/// What the products of other kernels would take, for a kernel that follows from them.
fn instead(derived: &Derived, kernel: &Kernel) -> String {
    match kernel.kind {
        KernelKind::BiasAcceleration | KernelKind::BiasMomentum => {
            let products = operations_by_products(derived, kernel.kind).total();
            format!(", instead of {products} operations by products")
        }
        _ => String::new(),
    }
}

/// The statements of the spec that a kernel comes from: one in full, several by line and first word.
fn origin(sources: &[Statement]) -> Vec<String> {
    let text = match sources {
        [] => return vec![],
        [only] => {
            let text: String = only.text.chars().take(LONGEST_STATEMENT).collect();
            let more = if text.len() < only.text.len() {
                " …"
            } else {
                ""
            };
            format!("line {} `{text}{more}`", only.line)
        }
        several => {
            let short = |source: &Statement| format!("line {} `{}`", source.line, source.keyword);
            several.iter().map(short).collect::<Vec<_>>().join(", ")
        }
    };
    vec![format!("From {text}.")]
}

fn constancy(structure: Structure) -> &'static str {
    match structure {
        Structure::Zero => " Zero.",
        Structure::Identity => " The identity.",
        Structure::Constant => " Independent of Q.",
        Structure::General => "",
    }
}

/// Shape, frame and units.
fn shape_of(derived: &Derived, kernel: &Kernel) -> String {
    let size = match Signature::new(kernel, derived.shape).output {
        Output::Pose => "Rotation matrix and translation in m.".to_owned(),
        Output::Scalar => "A scalar.".to_owned(),
        Output::Vector(rows) => format!("{rows}-vector"),
        Output::List(count) => format!("{count} scalars"),
        Output::Rows(rows, columns) => format!("{rows}×{columns}"),
        Output::Matrix(rows, columns) => format!("{rows}×{columns}"),
        Output::Slices(rows, columns) => {
            let count = derived.shape.freedoms;
            let slices = if count == 1 { "slice" } else { "slices" };
            format!("{count} {slices} of {rows}×{columns}")
        }
    };
    let units = units_of(derived, kernel.kind);
    match (size.ends_with('.'), units.is_empty()) {
        (true, _) => size,
        (false, true) => format!("{size}."),
        (false, false) => format!("{size}, {units}."),
    }
}

fn units_of(derived: &Derived, kind: KernelKind) -> String {
    match kind {
        KernelKind::TwistMap | KernelKind::TwistMapChild => {
            let columns = match listed(&units::of_velocities(derived)).as_str() {
                "" => "columns by v".to_owned(),
                rates => format!("columns by v in {rates}"),
            };
            format!("rows rad/s (angular) and m/s (linear), {columns}")
        }
        KernelKind::Local => listed(&units::of_freedoms(derived)),
        KernelKind::RetractDifferentialInverse => listed(&units::of_local_rates(derived)),
        KernelKind::BiasAcceleration => "rad/s² (angular) and m/s² (linear)".into(),
        KernelKind::PortValues => {
            let ports = derived.spec.ports.iter();
            listed(
                &ports
                    .map(|port| port.value.unit.clone())
                    .collect::<Vec<_>>(),
            )
        }
        _ => String::new(),
    }
}

/// Units in order, or one of them where all are alike; empty where one is not known.
fn listed(units: &[String]) -> String {
    match units {
        units if units.iter().any(String::is_empty) => String::new(),
        [first, rest @ ..] if rest.iter().all(|unit| unit == first) => first.clone(),
        units => units.join(", "),
    }
}
