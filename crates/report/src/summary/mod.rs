//! What the figures come to: the first part of the page.

mod estimates;
mod failures;
mod floors;
mod kinds;
mod others;
mod selection;

use super::figures::Figures;
use super::row::Work;
use estimates::Estimates;
use failures::Failures;
use floors::Floors;
use hamel::registry::JointRegistry;
use kinds::Kinds;
use others::Others;
use selection::Selection;
use serde::Serialize;

/// The summary, in words and figures of the page.
#[derive(Debug, Serialize)]
pub struct Summary {
    kinds: Kinds,
    floors: Vec<Floors>,
    selection: Option<Selection>,
    estimates: Option<Estimates>,
    others: Vec<Others>,
    failures: Vec<Failures>,
}

impl Summary {
    /// Of all figures.
    pub fn new(figures: &Figures, registry: &JointRegistry) -> Self {
        Self {
            kinds: Kinds::new(&figures.work, registry),
            floors: floors::lines(&figures.work),
            selection: Selection::new(&figures.work),
            estimates: Estimates::new(&figures.estimates),
            others: others::lines(&figures.peers),
            failures: failures::classes(&figures.work),
        }
    }
}

/// Whether a row is of the tree, in the representation that the scene itself has.
fn is_main(row: &Work) -> bool {
    row.implementation == "tree" && matches!(row.representation.as_str(), "declared" | "matrix")
}

/// The value in the middle, the upper one of two; `None` of no values.
fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// So many of so many, in percent.
fn percent(part: usize, whole: usize) -> String {
    match whole {
        0 => "–".into(),
        _ => format!("{:.1} %", 100.0 * part as f64 / whole as f64),
    }
}

/// A ratio with three digits at most.
fn times(ratio: f64) -> String {
    match ratio {
        ratio if ratio < 10.0 => format!("{ratio:.2}"),
        ratio if ratio < 100.0 => format!("{ratio:.1}"),
        ratio => format!("{ratio:.0}"),
    }
}
