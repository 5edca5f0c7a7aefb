//! A report as the templates see it: lists of named texts.

use crate::emit::report::Report;
use crate::emit::report::layout::{left_aligned, width};
use std::collections::BTreeMap;
use tera::Context;

type Row = BTreeMap<&'static str, String>;

fn row<const C: usize>(cells: [(&'static str, &str); C]) -> Row {
    cells
        .into_iter()
        .map(|(key, text)| (key, text.to_owned()))
        .collect()
}

/// Every text padded to the widest of its column: a table of plain text.
fn aligned(mut rows: Vec<Row>) -> Vec<Row> {
    let keys: Vec<&'static str> = rows
        .first()
        .map(|row| row.keys().copied().collect())
        .unwrap_or_default();
    for key in keys {
        let widest = rows
            .iter()
            .filter_map(|row| row.get(key))
            .map(|text| width(text))
            .max()
            .unwrap_or(0);
        for text in rows.iter_mut().filter_map(|row| row.get_mut(key)) {
            *text = left_aligned(text, widest);
        }
    }
    rows
}

/// The report for a template; `plain` aligns the columns of tables.
pub fn context(report: &Report, plain: bool) -> Context {
    let table = |rows: Vec<Row>| if plain { aligned(rows) } else { rows };
    let mut context = Context::new();
    context.insert("name", &report.name);
    context.insert("type_name", &report.type_name);
    context.insert("summary", &report.summary);
    context.insert("docs", &report.docs);
    context.insert("manifold", &report.manifold);
    context.insert("coordinates", &report.coordinates);
    context.insert("velocity_frame", report.velocity_frame.as_str());
    context.insert("speeds", &report.speeds);
    context.insert("imperceptible", &report.imperceptible);
    context.insert("spec", report.spec.trim());
    context.insert("parameters", &table(parameters(report)));
    context.insert("freedoms", &table(freedoms(report)));
    context.insert("formulas", &formulas(report));
    context.insert("claims", &table(claims(report)));
    context.insert("counts", &table(counts(report)));
    context
}

fn parameters(report: &Report) -> Vec<Row> {
    let rows = report.parameters.iter();
    rows.map(|p| {
        row([
            ("name", &p.name),
            ("unit", &p.unit),
            ("description", &p.description),
        ])
    })
    .collect()
}

fn freedoms(report: &Report) -> Vec<Row> {
    let rows = report.freedoms.iter().map(|f| {
        let unit = if f.unit.is_empty() { "–" } else { &f.unit };
        row([
            ("name", &f.name),
            ("local", &f.local),
            ("velocity", &f.velocity),
            ("unit", unit),
            ("rate_unit", &f.rate_unit),
        ])
    });
    rows.collect()
}

fn formulas(report: &Report) -> Vec<Row> {
    let rows = report.formulas.iter();
    rows.map(|f| {
        row([
            ("title", &f.title),
            ("text", &f.text),
            ("statement", &f.statement),
        ])
    })
    .collect()
}

fn claims(report: &Report) -> Vec<Row> {
    let rows = report.claims.iter();
    let rows = rows.map(|c| {
        row([
            ("name", &c.name),
            ("statement", &c.statement),
            ("proof", &c.proof),
            ("detail", &c.detail),
        ])
    });
    rows.collect()
}

fn counts(report: &Report) -> Vec<Row> {
    let rows = report.counts.iter().map(|c| {
        let operations = c.operations.to_string();
        row([
            ("kernel", &c.kernel),
            ("structure", &c.structure),
            ("operations", &operations),
        ])
    });
    rows.collect()
}
