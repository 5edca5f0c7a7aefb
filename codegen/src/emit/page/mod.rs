//! Pages of a joint from its report, through templates: Markdown, HTML, and plain text for a terminal.

mod context;
pub mod drawing;
mod overview;
mod text;

pub use overview::overview;

use super::header;
use super::report::{Accuracy, Report};
use crate::derived::Derived;
use context::{Medium, context};
use drawing::Drawing;
use tera::Tera;

const PAGE: &str = include_str!("../../../templates/page.md.tera");
const HTML: &str = include_str!("../../../templates/page.html.tera");
const STYLE: &str = include_str!("../../../templates/page.css");
const TEXT: &str = include_str!("../../../templates/explain.txt.tera");

/// The Markdown page of a joint; `label` names its spec: `joint-specs/ball.joint`. Its drawing is a file `NAME.svg` beside it.
///
/// # Errors
/// A fault in the template, which is part of this crate.
pub fn page(derived: &Derived, label: &str, accuracy: &Accuracy) -> tera::TeraResult<String> {
    let report = Report::new(derived).with_accuracy(accuracy);
    let mut context = context(&report, Medium::Markdown);
    context.insert("header", &header(label));
    context.insert("has_drawing", &Drawing::exists(derived));
    render("page.md", PAGE, &context)
}

/// The HTML page of a joint: one file that needs no other.
///
/// # Errors
/// As [`page`].
pub fn html_page(derived: &Derived, accuracy: &Accuracy) -> tera::TeraResult<String> {
    let report = Report::new(derived).with_accuracy(accuracy);
    let drawing = Drawing::new(derived, &report.freedoms);
    let mut context = context(&report, Medium::Html);
    context.insert("style", STYLE.trim());
    context.insert(
        "pictures",
        &drawing
            .map(|drawing| drawing.pictures())
            .unwrap_or_default(),
    );
    render("page.html", HTML, &context)
}

/// The drawing of a joint as a file of its own; nothing for a joint whose pose cannot be evaluated at home.
pub fn drawing_file(derived: &Derived, label: &str) -> Option<String> {
    let report = Report::brief(derived);
    let drawing = Drawing::new(derived, &report.freedoms)?;
    Some(format!("<!-- {} -->\n{}\n", header(label), drawing.sheet()))
}

/// The same for a terminal.
///
/// # Errors
/// As [`page`].
pub fn explain_text(derived: &Derived, accuracy: &Accuracy) -> tera::TeraResult<String> {
    let report = Report::new(derived).with_accuracy(accuracy);
    render("explain.txt", TEXT, &context(&report, Medium::Terminal))
}

fn render(name: &str, template: &str, context: &tera::Context) -> tera::TeraResult<String> {
    let mut tera = Tera::new();
    tera.add_raw_template(name, template)?;
    let text = tera.render(name, context)?;
    let lines: Vec<&str> = text.trim().lines().map(str::trim_end).collect();
    Ok(lines.join("\n") + "\n")
}
