//! Runs that failed, sorted by what failed: what cannot be, what takes too long, and what came to its end with a wrong number.

use crate::page::words;
use crate::row::{Cause, Work};
use itertools::Itertools;
use serde::Serialize;

/// Errors of runs with step control up to this multiple of the tolerance and of what the motion multiplies errors by are what the tolerance promises…
const PROMISED: f64 = 10.0;
/// …and errors of so many floors are rounding.
const FLOORS: f64 = 100.0;
/// A floor is this times what the motion multiplies errors by.
const ROUNDING: f64 = 0.5 * f64::EPSILON;

/// One class.
#[derive(Debug, Serialize)]
pub struct Failures {
    class: &'static str,
    /// What runs of this class have in common.
    meaning: &'static str,
    runs: usize,
    lines: Vec<Line>,
}

/// Runs that failed for one reason.
#[derive(Debug, Serialize)]
struct Line {
    reason: String,
    runs: usize,
    scenes: Vec<String>,
    methods: Vec<String>,
}

/// All classes that have runs.
pub fn classes(rows: &[Work]) -> Vec<Failures> {
    let of_cause = |cause: Cause| {
        let rows = rows.iter().filter(move |row| row.cause == Some(cause));
        rows.map(|row| (row, row.failure.clone())).collect_vec()
    };
    let wrong = rows.iter().filter_map(|row| Some((row, wrongness(row)?)));
    let classes = [
        (
            "cannot",
            "The method or the coordinates cannot do what the scene asks, and the run says so: angles that are singular, equations that do not converge, a scene that cannot be \
             compiled.",
            of_cause(Cause::Cannot),
        ),
        (
            "too slow",
            "The run would come to its end: it was stopped for its time, or refused for the number of steps that were left, as explicit methods are on stiff springs.",
            of_cause(Cause::TooSlow),
        ),
        (
            "wrong",
            "The run came to its end, and its error exceeds what its tolerance promises: 10 × tolerance × max(1, conditioning, ωt), and 100 floors.",
            wrong.collect_vec(),
        ),
    ];
    let classes = classes.map(|(class, meaning, rows)| Failures {
        class,
        meaning,
        runs: rows.len(),
        lines: lines(rows),
    });
    classes.into_iter().filter(|class| class.runs > 0).collect()
}

/// What makes a run wrong that came to its end.
fn wrongness(row: &Work) -> Option<String> {
    let error = row.error_worst.filter(|_| row.knob == "tolerance")?;
    // A row without a floor is of nothing that is known.
    let multiplied = (row.floor > 0.0).then_some(row.floor / ROUNDING)?;
    let promised = PROMISED * row.accuracy * multiplied + FLOORS * row.floor;
    (error > promised).then(|| {
        let by = (error / promised).log10().floor().max(0.0);
        format!("error up to 1e{} times what is promised", by + 1.0)
    })
}

/// A line for each reason; figures in it are those of the first run.
fn lines(rows: Vec<(&Work, String)>) -> Vec<Line> {
    let groups = rows
        .into_iter()
        .into_group_map_by(|(_, reason)| key(reason));
    let lines = groups.into_values().map(|group| {
        let names = |name: fn(&Work) -> &String| {
            let names = group.iter().map(|(row, _)| name(row).clone());
            names.unique().sorted().collect_vec()
        };
        Line {
            runs: group.len(),
            scenes: names(|row| &row.scene),
            methods: names(|row| &row.method),
            reason: { group.iter() }
                .map(|(_, reason)| reason.clone())
                .next()
                .unwrap_or_default(),
        }
    });
    lines
        .sorted_by(|a, b| b.runs.cmp(&a.runs).then(a.reason.cmp(&b.reason)))
        .collect()
}

/// What reasons have in common that are one: their text without figures.
fn key(reason: &str) -> String {
    match reason.starts_with("error up to") {
        true => reason.to_owned(),
        false => words(reason),
    }
}
