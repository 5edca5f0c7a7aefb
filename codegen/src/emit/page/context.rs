//! A report as the templates see it: lists of named texts.

use super::text::{cell, html, paragraphs};
use crate::emit::report::layout::{left_aligned, width};
use crate::emit::report::{Formula, Report};
use crate::text::{fence, markdown, visible};
use std::collections::BTreeMap;
use tera::Context;

type Row = BTreeMap<&'static str, String>;

/// Cells that hold identifiers, in which nothing needs escaping.
const IDENTIFIERS: &[&str] = &["name", "kernel", "kind"];

/// What a template is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Medium {
    /// A terminal: the columns of tables are aligned.
    Terminal,
    /// Markdown: formulas are LaTeX.
    Markdown,
    /// HTML: formulas are MathML.
    Html,
}

impl Medium {
    /// Text of a spec or proof in a table.
    fn text(self, text: &str) -> String {
        match self {
            Self::Terminal => visible(text),
            Self::Markdown => cell(text),
            Self::Html => html(text),
        }
    }

    /// The doc comment of a spec, line by line.
    fn docs(self, lines: &[String]) -> Vec<String> {
        match self {
            Self::Markdown => markdown(lines),
            _ => lines.iter().map(|line| visible(line)).collect(),
        }
    }

    fn table(self, mut rows: Vec<Row>) -> Vec<Row> {
        let cells = rows.iter_mut().flatten();
        for (_, text) in cells.filter(|(key, _)| !IDENTIFIERS.contains(key)) {
            *text = self.text(text);
        }
        match self {
            Self::Terminal => aligned(rows),
            _ => rows,
        }
    }

    /// The equations of a formula.
    fn equations(self, formula: &Formula) -> String {
        let equations = formula.equations.iter();
        match self {
            Self::Terminal => formula.text.clone(),
            Self::Markdown => equations
                .map(|equation| format!("```math\n{}\n```\n", equation.latex()))
                .collect::<Vec<_>>()
                .join("\n"),
            Self::Html => equations
                .map(|equation| format!("<div class=\"equation\">{}</div>\n", equation.mathml()))
                .collect(),
        }
    }
}

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

/// The report for a template.
pub fn context(report: &Report, medium: Medium) -> Context {
    let mut context = Context::new();
    let list = |texts: &[String]| -> Vec<String> { texts.iter().map(|t| medium.text(t)).collect() };
    context.insert("name", &report.name);
    context.insert("type_name", &report.type_name);
    context.insert("summary", &medium.text(&report.summary));
    context.insert("docs", &medium.docs(&report.docs));
    context.insert("paragraphs", &list(&paragraphs(&report.docs)));
    context.insert("freedom_count", &report.shape.freedoms);
    context.insert("scalar_count", &report.shape.configuration);
    context.insert("constraint_count", &report.shape.constraints);
    context.insert("requirements", &list(&report.requirements));
    context.insert("bodies", &report.bodies);
    context.insert("manifold", &report.manifold);
    context.insert("coordinates", &report.coordinates);
    context.insert("home", &report.home);
    context.insert("home_is_guess", &report.home_is_guess);
    context.insert("velocity_frame", report.velocity_frame.as_str());
    context.insert("speeds", &report.speeds);
    context.insert("still", &medium.text(&report.still));
    context.insert("unidentifiable", &report.unidentifiable);
    let spec = visible(&report.spec.trim().replace("\r\n", "\n"));
    context.insert("fence", &fence(&spec));
    context.insert("spec", &spec);
    tables(&mut context, report, medium);
    context
}

fn tables(context: &mut Context, report: &Report, medium: Medium) {
    context.insert("parameters", &medium.table(parameters(report)));
    context.insert("freedoms", &medium.table(freedoms(report)));
    context.insert("ports", &medium.table(ports(report)));
    context.insert("pins", &medium.table(pins(report)));
    context.insert("formulas", &formulas(report, medium));
    context.insert("singularities", &singularities(report, medium));
    context.insert("claims", &medium.table(claims(report)));
    context.insert("finite", &medium.table(finite(report)));
    context.insert("counts", &medium.table(counts(report)));
    context.insert("accuracy", &medium.table(accuracy(report)));
    let fibres = report.fibres().map(|claim| {
        row([
            ("statement", &medium.text(&claim.statement)),
            ("detail", &medium.text(&claim.detail)),
        ])
    });
    context.insert("fibres", &fibres.unwrap_or_default());
}

fn parameters(report: &Report) -> Vec<Row> {
    let rows = report.parameters.iter();
    rows.map(|p| {
        row([
            ("name", &p.name),
            ("unit", &p.unit),
            ("range", &p.range),
            ("description", &p.description),
        ])
    })
    .collect()
}

fn freedoms(report: &Report) -> Vec<Row> {
    let rows = report.freedoms.iter().map(|f| {
        let known = |unit: &String| {
            if unit.is_empty() {
                "–".to_owned()
            } else {
                unit.clone()
            }
        };
        row([
            ("name", &f.name),
            ("local", &f.local),
            ("velocity", &f.velocity),
            ("unit", &known(&f.unit)),
            ("rate_unit", &known(&f.rate_unit)),
        ])
    });
    rows.collect()
}

fn ports(report: &Report) -> Vec<Row> {
    let rows = report.ports.iter();
    rows.map(|p| {
        row([
            ("name", &p.name),
            ("unit", &p.unit),
            ("value", &p.value),
            ("description", &p.description),
        ])
    })
    .collect()
}

fn pins(report: &Report) -> Vec<Row> {
    let rows = report.pins.iter();
    rows.map(|p| {
        row([
            ("name", &p.name),
            ("value", &p.value),
            ("description", &p.description),
        ])
    })
    .collect()
}

fn formulas(report: &Report, medium: Medium) -> Vec<Row> {
    let rows = report.formulas.iter();
    rows.map(|f| {
        row([
            ("title", &f.title),
            ("equations", &medium.equations(f)),
            ("statement", &f.statement),
        ])
    })
    .collect()
}

fn singularities(report: &Report, medium: Medium) -> Vec<Row> {
    let rows = report.singularities.iter().map(|locus| {
        let function = match medium {
            Medium::Terminal => locus.function.text(),
            Medium::Markdown => format!("$`{}`$", locus.function.latex()),
            Medium::Html => format!("<math>{}</math>", locus.function.mathml()),
        };
        row([
            ("function", &function),
            ("text", &locus.text),
            ("cause", &medium.text(&locus.cause)),
        ])
    });
    rows.collect()
}

fn claims(report: &Report) -> Vec<Row> {
    let rows = report.claims.iter();
    let rows = rows.map(|c| {
        row([
            ("name", &c.name),
            ("statement", &c.statement),
            ("kind", c.kind),
            ("proof", &c.proof),
            ("detail", &c.detail),
        ])
    });
    rows.collect()
}

fn finite(report: &Report) -> Vec<Row> {
    let rows = report.finite.iter().map(|map| {
        row([
            ("kernel", &map.kernel),
            ("meaning", &map.meaning),
            ("method", &map.method),
        ])
    });
    rows.collect()
}

fn counts(report: &Report) -> Vec<Row> {
    let rows = report.counts.iter().map(|c| {
        row([
            ("kernel", &c.kernel),
            ("structure", &c.structure),
            ("operations", &c.work()),
        ])
    });
    rows.collect()
}

fn accuracy(report: &Report) -> Vec<Row> {
    let rows = report.accuracy.iter().map(|a| {
        let (worst, points) = (format!("{:.2}", a.worst_ulp), a.points.to_string());
        row([
            ("kernel", &a.kernel),
            ("scalar", &a.scalar),
            ("worst", &worst),
            ("points", &points),
        ])
    });
    rows.collect()
}
