//! The page: figures, and tables of what they show.

use super::case::Case;
use super::choice::{self, Choice};
use super::figures::Figures;
use super::peers::{Peer, fronts};
use super::plan::{COMPARED, COMPARED_REPRESENTATIONS};
use super::plots;
use super::row::{Build, Work};
use super::summary::Summary;
use super::tables;
use hamel::registry::JointRegistry;
use hamel_console::files::first_line;
use hamel_console::output::Failure;
use itertools::Itertools;
use serde::Serialize;
use std::fs::File;
use tera::{Context, Tera};

const TEMPLATE: &str = include_str!("page.html");

/// Accuracies that run times are reported for.
const ASKED: [f64; 2] = [1e-6, 1e-9];

/// One scene's part of the page.
#[derive(Serialize)]
struct Section {
    name: String,
    description: String,
    source: String,
    floor: String,
    conditioning: String,
    /// The work–precision diagram of both forms.
    forms: String,
    /// That of the representations; empty where there is one.
    representations: String,
    /// That of the tree and of compiled equations; empty where there is one.
    implementations: String,
    /// That of other libraries; empty where none was measured.
    others: String,
    best: Vec<Best>,
    choices: Vec<Choice>,
    failures: Vec<Failing>,
}

/// The best of one method on a scene.
#[derive(Serialize)]
struct Best {
    method: String,
    form: String,
    implementation: String,
    error: String,
    floors: String,
    /// Least run times, ms, at the accuracies asked.
    times: Vec<String>,
}

/// Runs that failed for one reason.
#[derive(Serialize)]
struct Failing {
    curve: String,
    accuracies: String,
    reason: String,
}

/// A line of the table of compiled scenes.
#[derive(Serialize)]
struct Built<'a> {
    row: &'a Build,
    generation_ms: String,
    compilation_ms: String,
    text_kb: String,
    library_kb: String,
}

#[derive(Serialize)]
struct Drawing {
    name: String,
    svg: String,
}

/// A line of the overview: by method, the least error in floors.
#[derive(Serialize)]
struct Line {
    scene: String,
    floor: String,
    cells: Vec<Cell>,
}

#[derive(Serialize)]
struct Cell {
    text: String,
    /// `reached` to 10 floors, `near` to 100, `far`, or `failed`.
    class: &'static str,
}

/// Whether a file is a page that was written before; the template has this mark.
pub fn is_own(file: &File) -> bool {
    first_line(file).ends_with("<!-- hamel report -->")
}

/// The whole page as text.
///
/// # Errors
/// Figures or texts that cannot be made.
pub fn render(figures: &Figures, registry: &JointRegistry) -> Result<String, Failure> {
    let mut context = Context::new();
    let sections = sections(figures, registry)?;
    let methods = figures.work.iter().map(|row| row.method.as_str());
    let methods: Vec<&str> = methods.unique().collect();
    context.insert("machine", &figures.machine);
    context.insert("others", &figures.others);
    context.insert("summary", &Summary::new(figures, registry));
    context.insert("lines", &overview(&figures.work, &methods));
    context.insert("methods", &methods);
    context.insert("sections", &sections);
    context.insert("asked", &ASKED.map(|error| format!("{error:.0e}")));
    context.insert(
        "drift",
        &drawings(&figures.drift, |row| &row.scene, plots::drift)?,
    );
    context.insert(
        "stability",
        &drawings(&figures.stability, |row| &row.scene, plots::stability)?,
    );
    context.insert("stability_table", &tables::stability(&figures.stability));
    context.insert("drift_table", &tables::drift(&figures.drift));
    context.insert("costs", &figures.costs);
    context.insert("builds", &builds(&figures.builds));
    context.insert("points", &figures.work.len());
    let mut tera = Tera::new();
    let name = "page.html";
    let added = tera.add_raw_template(name, TEMPLATE);
    let page = added.and_then(|()| tera.render(name, &context));
    page.map_err(|error| Failure::Page(error.to_string()))
}

/// What compiled scenes cost, in units for readers.
fn builds(rows: &[Build]) -> Vec<Built<'_>> {
    let rows = rows.iter().map(|row| Built {
        row,
        generation_ms: format!("{:.0}", 1e3 * row.generation_s),
        compilation_ms: format!("{:.0}", 1e3 * row.compilation_s),
        text_kb: format!("{:.1}", row.text_bytes as f64 / 1e3),
        library_kb: format!("{:.1}", row.library_bytes as f64 / 1e3),
    });
    rows.collect()
}

fn drawings<R>(
    rows: &[R],
    name: impl Fn(&R) -> &String,
    draw: impl Fn(&[&R]) -> Result<String, Failure>,
) -> Result<Vec<Drawing>, Failure> {
    let names = rows.iter().map(|row| name(row).as_str()).unique();
    let drawings = names.map(|scene| {
        let own: Vec<&R> = rows.iter().filter(|row| *name(row) == scene).collect();
        Ok(Drawing {
            svg: draw(&own)?,
            name: scene.into(),
        })
    });
    drawings.collect()
}

fn sections(figures: &Figures, registry: &JointRegistry) -> Result<Vec<Section>, Failure> {
    let rows = &figures.work;
    let names = rows.iter().map(|row| row.scene.as_str()).unique();
    let sections = names.map(|name| {
        let own: Vec<&Work> = rows.iter().filter(|row| row.scene == name).collect();
        section(name.into(), (&own, &figures.peers), registry)
    });
    sections.collect()
}

fn section(
    name: String,
    (rows, peers): (&[&Work], &[Peer]),
    registry: &JointRegistry,
) -> Result<Section, Failure> {
    let (description, source) = told(&name)?;
    let first = rows.first().map(|row| row.representation.clone());
    let all = rows.iter().copied();
    let own = all
        .clone()
        .filter(|row| Some(&row.representation) == first.as_ref());
    let own: Vec<&Work> = own.collect();
    let main: Vec<&Work> = own.iter().copied().filter(|row| is_tree(row)).collect();
    let in_others = all.filter(|row| is_tree(row) && is_compared(row, COMPARED_REPRESENTATIONS));
    let in_others: Vec<&Work> = in_others.collect();
    let ways = own
        .iter()
        .copied()
        .filter(|row| is_compared(row, COMPARED.len()));
    let ways: Vec<&Work> = ways.collect();
    Ok(Section {
        floor: rows
            .first()
            .map_or(String::new(), |row| format!("{:.1e}", row.floor)),
        conditioning: rows
            .first()
            .map_or(String::new(), |row| format!("{:.1e}", row.conditioning)),
        forms: plots::forms(&main)?,
        representations: drawn(
            &in_others,
            |row| &row.representation,
            plots::representations,
        )?,
        implementations: drawn(&ways, |row| &row.implementation, plots::implementations)?,
        others: match fronts(peers, &name) {
            fronts if fronts.iter().all(|(_, points)| points.is_empty()) => String::new(),
            fronts => plots::peers(&fronts)?,
        },
        best: best(&own),
        choices: choices(&name, registry, &main),
        failures: failures(rows),
        name,
        description,
        source,
    })
}

/// What is chosen for a scene, where this program knows it, in the Lagrangian form.
fn choices(name: &str, registry: &JointRegistry, rows: &[&Work]) -> Vec<Choice> {
    let known = Case::chosen(&[name.to_owned()]).unwrap_or_default();
    let lagrangian = rows.iter().copied();
    let lagrangian = lagrangian.filter(|row| row.form == "lagrangian");
    let lagrangian: Vec<&Work> = lagrangian.collect();
    known.first().map_or_else(Vec::new, |case| {
        choice::choices(case, registry, &lagrangian)
    })
}

fn is_tree(row: &Work) -> bool {
    row.implementation == "tree"
}

/// Whether a row is of the first so many methods whose representations and implementations are compared.
fn is_compared(row: &Work, count: usize) -> bool {
    let mut names = COMPARED.iter().take(count).map(|scheme| scheme.name());
    row.form == "lagrangian" && names.any(|name| name == row.method)
}

/// A figure of rows that differ in something; nothing where they do not.
fn drawn(
    rows: &[&Work],
    what: impl Fn(&Work) -> &String,
    draw: impl Fn(&[&Work]) -> Result<String, Failure>,
) -> Result<String, Failure> {
    match rows.iter().map(|row| what(row)).all_equal() {
        true => Ok(String::new()),
        false => draw(rows),
    }
}

/// What a scene shows, and where its reference is from; empty where this program does not know the scene.
fn told(name: &str) -> Result<(String, String), Failure> {
    let known = Case::chosen(&[name.to_owned()]).unwrap_or_default();
    match known.first() {
        Some(case) => Ok((case.description()?.description, case.reference()?.source)),
        None => Ok((String::new(), String::new())),
    }
}

/// The curves of some rows, each with its rows.
fn curves<'a>(rows: &[&'a Work]) -> Vec<(String, Vec<&'a Work>)> {
    let label = |row: &Work| {
        let Work {
            method,
            form,
            representation,
            implementation,
            ..
        } = row;
        format!("{method} {form} {representation} {implementation}")
    };
    let mut curves: Vec<(String, Vec<&Work>)> = Vec::new();
    for row in rows {
        let label = label(row);
        match curves.iter_mut().find(|(known, _)| *known == label) {
            Some((_, curve)) => curve.push(row),
            None => curves.push((label, vec![row])),
        }
    }
    curves
}

fn least(rows: &[&Work]) -> Option<f64> {
    let errors = rows.iter().filter_map(|row| row.error_worst);
    errors.reduce(f64::min)
}

fn best(rows: &[&Work]) -> Vec<Best> {
    let curves = curves(rows).into_iter().map(|(_, curve)| {
        let error = least(&curve);
        let within = |asked: f64| {
            let times = curve
                .iter()
                .filter(|row| row.error_worst.is_some_and(|e| e <= asked));
            let least = times.filter_map(|row| row.seconds_least).reduce(f64::min);
            least.map_or("—".into(), |seconds| format!("{:.3}", 1e3 * seconds))
        };
        Best {
            method: curve[0].method.clone(),
            form: curve[0].form.clone(),
            implementation: curve[0].implementation.clone(),
            error: error.map_or("fails".into(), |error| format!("{error:.1e}")),
            floors: error.map_or("—".into(), |error| multiple(error / curve[0].floor)),
            times: ASKED.map(within).to_vec(),
        }
    });
    curves.collect()
}

fn multiple(factor: f64) -> String {
    match factor < 1000.0 {
        true => format!("{factor:.1}"),
        false => format!("{factor:.0e}"),
    }
}

fn failures(rows: &[&Work]) -> Vec<Failing> {
    let mut failing: Vec<Failing> = Vec::new();
    for (label, curve) in curves(rows) {
        for row in curve.iter().filter(|row| !row.failure.is_empty()) {
            let accuracy = format!("{:.1e}", row.accuracy);
            match failing.last_mut() {
                // One reason with other figures in it is one line: that of the coarsest run.
                Some(last) if last.curve == label && words(&last.reason) == words(&row.failure) => {
                    last.accuracies = format!("{}, {accuracy}", last.accuracies);
                }
                _ => failing.push(Failing {
                    curve: label.clone(),
                    accuracies: accuracy,
                    reason: row.failure.clone(),
                }),
            }
        }
    }
    failing
}

/// A text without its figures.
pub fn words(text: &str) -> String {
    let is_figure = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e');
    text.chars().filter(|&c| !is_figure(c)).collect()
}

fn overview(rows: &[Work], methods: &[&str]) -> Vec<Line> {
    let scenes = rows.iter().map(|row| row.scene.as_str()).unique();
    let lines = scenes.map(|scene| {
        let own: Vec<&Work> = rows.iter().filter(|row| row.scene == scene).collect();
        let cell = |method: &&str| {
            let of_method: Vec<&Work> = own
                .iter()
                .copied()
                .filter(|row| row.method == *method && row.representation != "euler")
                .collect();
            cell(&of_method)
        };
        Line {
            cells: methods.iter().map(cell).collect(),
            floor: own
                .first()
                .map_or(String::new(), |row| format!("{:.1e}", row.floor)),
            scene: scene.into(),
        }
    });
    lines.collect()
}

fn cell(rows: &[&Work]) -> Cell {
    let factor = least(rows)
        .zip(rows.first())
        .map(|(error, row)| error / row.floor);
    let class = match factor {
        _ if rows.is_empty() => "none",
        None => "failed",
        Some(factor) if factor <= 10.0 => "reached",
        Some(factor) if factor <= 100.0 => "near",
        Some(_) => "far",
    };
    let text = match factor {
        Some(factor) => multiple(factor),
        None if rows.is_empty() => String::new(),
        None => "fails".into(),
    };
    Cell { text, class }
}
