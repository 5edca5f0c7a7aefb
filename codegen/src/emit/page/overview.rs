//! `JOINTS.md`: all joints of a library in one table, what was proved of them and how, and their drawings.

use super::drawing::Drawing;
use super::render;
use super::text::cell;
use crate::derived::Derived;
use crate::emit::header;
use crate::emit::report::{Accuracy, ClaimRow, Report};
use std::collections::{BTreeMap, BTreeSet};
use tera::Context;

const OVERVIEW: &str = include_str!("../../../templates/joints.md.tera");

type Row = BTreeMap<&'static str, String>;

/// The overview; `specs` names the folder of specs and `pages` that of the pages, relative to the overview.
///
/// # Errors
/// A fault in the template, which is part of this crate.
pub fn overview(
    joints: &[Derived],
    specs: &str,
    pages: &str,
    accuracy: &Accuracy,
) -> tera::TeraResult<String> {
    let report = |joint: &Derived| Report::brief(joint).with_accuracy(accuracy);
    let mut reports: Vec<(Report, bool)> = joints
        .iter()
        .map(|joint| (report(joint), Drawing::exists(joint)))
        .collect();
    reports.sort_by(|(a, _), (b, _)| a.name.cmp(&b.name));
    let mut context = Context::new();
    context.insert("header", &header(specs));
    context.insert("pages", pages);
    context.insert("joints", &reports.iter().map(joint).collect::<Vec<Row>>());
    context.insert("checked", &checked(&reports));
    let scalars = scalar_types(&reports);
    let measured = reports.iter().map(|(report, _)| measured(report, &scalars));
    context.insert("measured", &measured.flatten().collect::<Vec<String>>());
    context.insert("scalars", &scalars);
    render("JOINTS.md", OVERVIEW, &context)
}

fn joint((report, drawn): &(Report, bool)) -> Row {
    let of_kind = |kind: &str| {
        report
            .claims
            .iter()
            .filter(|claim| claim.kind == kind)
            .count()
    };
    let numbers = [
        ("normal_form", of_kind("normal_form")),
        ("certificate", of_kind("certificate")),
        ("checked", of_kind("checked")),
    ];
    let speeds = match report.shape.constraints {
        0 => "= v".to_owned(),
        _ => cell(&report.speeds.join(", ")),
    };
    let freedoms: Vec<&str> = report
        .freedoms
        .iter()
        .map(|row| row.name.as_str())
        .collect();
    let mut row: Row = numbers
        .into_iter()
        .map(|(kind, n)| (kind, n.to_string()))
        .collect();
    row.extend([
        ("name", report.name.clone()),
        ("type_name", report.type_name.clone()),
        ("summary", cell(&report.summary)),
        ("manifold", cell(&report.manifold)),
        ("freedoms", cell(&freedoms.join(", "))),
        ("speeds", speeds),
        ("parameters", parameters(report)),
        ("singular", singular(report)),
        ("drawing", if *drawn { "yes" } else { "" }.to_owned()),
    ]);
    row
}

fn parameters(report: &Report) -> String {
    let named = report
        .parameters
        .iter()
        .map(|p| format!("`{}` ({})", p.name, p.unit));
    named.collect::<Vec<_>>().join(", ")
}

fn singular(report: &Report) -> String {
    let loci = report.singularities.iter();
    let loci: Vec<String> = loci
        .map(|locus| format!("$`{} = 0`$", locus.function.latex()))
        .collect();
    match loci.is_empty() {
        true => "nowhere".to_owned(),
        false => loci.join(", "),
    }
}

/// The claims that are checked, not proved, each with its joint.
fn checked(reports: &[(Report, bool)]) -> Vec<Row> {
    let of_report = |(report, _): &(Report, bool)| -> Vec<Row> {
        let row = |claim: &ClaimRow| {
            Row::from([
                ("joint", report.name.clone()),
                ("statement", cell(&claim.statement)),
                ("proof", cell(&claim.proof)),
                ("reason", cell(&claim.detail)),
            ])
        };
        let claims = report.claims.iter().filter(|claim| claim.kind == "checked");
        claims.map(row).collect()
    };
    reports.iter().flat_map(of_report).collect()
}

fn scalar_types(reports: &[(Report, bool)]) -> Vec<String> {
    let rows = reports.iter().flat_map(|(report, _)| &report.accuracy);
    let types: BTreeSet<&String> = rows.map(|row| &row.scalar).collect();
    types.into_iter().cloned().collect()
}

/// The line of a joint in the table of errors: the worst of its kernels for each scalar type.
fn measured(report: &Report, scalars: &[String]) -> Option<String> {
    let worst = |scalar: &String| {
        let rows = report.accuracy.iter().filter(|row| row.scalar == *scalar);
        let worst = rows.max_by(|a, b| a.worst_ulp.total_cmp(&b.worst_ulp));
        worst.map_or("–".to_owned(), |row| {
            format!("{:.2} (`{}`)", row.worst_ulp, row.kernel)
        })
    };
    let cells: Vec<String> = scalars.iter().map(worst).collect();
    let line = format!("| `{}` | {} |", report.name, cells.join(" | "));
    (!report.accuracy.is_empty()).then_some(line)
}
