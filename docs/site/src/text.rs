//! What pages hold for others than mdBook: formulas as GitHub reads them, items that rustdoc links, links to sources and to motions.

use crate::links;
use anyhow::{Context, Result, bail};
use mdbook_driver::book::Book;
use pulldown_latex::config::DisplayMode;
use pulldown_latex::{Parser, RenderConfig, Storage, push_mathml};
use std::convert::Infallible;

/// Prepares every page for mdBook.
pub fn prepare(book: &mut Book, has_motions: bool) -> Result<()> {
    let mut result = Ok(());
    book.for_each_chapter_mut(|chapter| {
        let text = match has_motions {
            true => show_motions(&chapter.content),
            false => Ok(chapter.content.clone()),
        };
        match text.and_then(|text| typeset(&text)) {
            Ok(text) => chapter.content = text,
            Err(error) => {
                let page = chapter.path.as_deref().unwrap_or("a page".as_ref());
                result = Err(error).with_context(|| page.display().to_string());
            }
        }
    });
    result
}

/// Takes away the bounds of comments `<!-- motions: … -->`, which hold links that lead somewhere in the site alone.
fn show_motions(text: &str) -> Result<String> {
    let mut parts = text.split("<!-- motions:");
    let mut shown = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let ends = part.split_once("-->");
        let (inside, rest) = ends.context("a comment of motions has no end")?;
        shown += inside;
        shown += rest;
    }
    Ok(shown)
}

/// Formulas as MathML, which browsers typeset without a script: blocks that begin with three backticks and `math`, and formulas between $` and `$.
fn typeset(text: &str) -> Result<String> {
    let mut result = String::new();
    let mut formula: Option<String> = None;
    let mut is_code = false;
    for line in text.lines() {
        let fence = line.trim_start().strip_prefix("```");
        match (&mut formula, fence) {
            (Some(latex), Some(_)) => {
                let mathml = mathml(latex, DisplayMode::Block)?;
                result += &format!("<div class=\"formula\">{mathml}</div>\n");
                formula = None;
            }
            (Some(latex), None) => *latex += &format!("{line}\n"),
            (None, Some("math")) if !is_code => formula = Some(String::new()),
            (None, Some(_)) => {
                is_code = !is_code;
                result += &format!("{line}\n");
            }
            (None, None) if is_code => result += &format!("{line}\n"),
            (None, None) => {
                let line = without_items(&typeset_line(line)?);
                result += &format!("{}\n", rename_sources(&line));
            }
        }
    }
    match formula {
        Some(latex) => bail!("the formula `{latex}` has no end"),
        None => Ok(result),
    }
}

fn typeset_line(line: &str) -> Result<String> {
    let mut parts = line.split("$`");
    let mut result = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let ends = part.split_once("`$");
        let (latex, rest) = ends.with_context(|| format!("a formula of `{line}` has no end"))?;
        result += &mathml(latex, DisplayMode::Inline)?;
        result += rest;
    }
    Ok(result)
}

/// Takes the brackets from `[`Item`]`, a link that rustdoc alone resolves.
fn without_items(line: &str) -> String {
    let mut parts = line.split("[`");
    let mut result = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        match part.split_once("`]") {
            Some((item, rest)) if !rest.starts_with(['(', '[', ':']) => {
                result += &format!("`{item}`{rest}");
            }
            _ => result += &format!("[`{part}"),
        }
    }
    result
}

/// Links and definitions of links with the names that sources have in the site.
fn rename_sources(line: &str) -> String {
    let mut parts = line.split("](");
    let mut result = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let ends = part.split_once(')');
        let (target, rest) = ends.unwrap_or((part, ""));
        let end = if ends.is_some() { ")" } else { "" };
        result += &format!("]({}{end}{rest}", links::in_site(target));
    }
    match result.split_once("]: ") {
        Some((name, target)) if name.starts_with('[') => {
            format!("{name}]: {}", links::in_site(target))
        }
        _ => result,
    }
}

fn mathml(latex: &str, display_mode: DisplayMode) -> Result<String> {
    let storage = Storage::new();
    let events: Result<Vec<_>, _> = Parser::new(latex, &storage).collect();
    let events = events.map_err(|error| anyhow::anyhow!("the formula `{latex}`: {error}"))?;
    let config = RenderConfig {
        display_mode,
        ..RenderConfig::default()
    };
    let mut mathml = String::new();
    push_mathml(
        &mut mathml,
        events.into_iter().map(Ok::<_, Infallible>),
        config,
    )?;
    Ok(mathml)
}
