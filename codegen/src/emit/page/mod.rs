//! Pages of a joint from its report, through templates: Markdown, and plain text for a terminal.

mod context;

use super::report::Report;
use super::rust::header;
use crate::derived::Derived;
use tera::Tera;

const PAGE: &str = include_str!("../../../templates/page.md.tera");
const TEXT: &str = include_str!("../../../templates/explain.txt.tera");

/// The Markdown page of a joint; `label` names its spec: `joint-specs/ball.joint`.
///
/// # Errors
/// A fault in the template, which is part of this crate.
pub fn page(derived: &Derived, label: &str) -> tera::TeraResult<String> {
    let mut context = context::context(&Report::new(derived), false);
    context.insert("header", &header(label));
    render("page.md", PAGE, &context)
}

/// The same for a terminal.
///
/// # Errors
/// As [`page`].
pub fn explain_text(derived: &Derived) -> tera::TeraResult<String> {
    render(
        "explain.txt",
        TEXT,
        &context::context(&Report::new(derived), true),
    )
}

fn render(name: &str, template: &str, context: &tera::Context) -> tera::TeraResult<String> {
    let mut tera = Tera::new();
    tera.add_raw_template(name, template)?;
    let text = tera.render(name, context)?;
    let lines: Vec<&str> = text.trim().lines().map(str::trim_end).collect();
    Ok(lines.join("\n") + "\n")
}
