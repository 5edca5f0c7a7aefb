//! The figures of stability maps and of drifts in short: one number for each curve.

use super::row::{Drift, Stability};
use itertools::Itertools;
use serde::Serialize;

/// Stiffnesses that the table shows, N m/rad.
const STIFFNESSES: [f64; 4] = [1.0, 1e4, 1e8, 1e12];

/// A table with a name before each line.
#[derive(Debug, Serialize)]
pub struct Table {
    columns: Vec<String>,
    lines: Vec<Line>,
}

#[derive(Debug, Serialize)]
struct Line {
    name: String,
    cells: Vec<String>,
}

impl Table {
    /// With a line for each name; cells that nothing is known of are empty.
    fn new<C: Copy>(
        names: Vec<String>,
        columns: &[C],
        heading: impl Fn(C) -> String,
        cell: impl Fn(&str, C) -> Option<String>,
    ) -> Option<Self> {
        let lines = names.into_iter().map(|name| Line {
            cells: { columns.iter() }
                .map(|&column| cell(&name, column).unwrap_or_default())
                .collect(),
            name,
        });
        let lines: Vec<Line> = lines.collect();
        (!lines.is_empty()).then(|| Self {
            columns: columns.iter().copied().map(heading).collect(),
            lines,
        })
    }
}

/// The largest stable step times the frequency, rad, for each scene and method; `None` of no rows.
pub fn stability(rows: &[Stability]) -> Option<Table> {
    let name = |row: &Stability| format!("{} {}", row.scene, row.method);
    let names = rows.iter().map(name).unique().collect();
    Table::new(
        names,
        &STIFFNESSES,
        |stiffness| format!("{stiffness:.0e}"),
        |wanted, stiffness| {
            let mut own = rows.iter().filter(|row| name(row) == wanted);
            let row = own.find(|row| (row.stiffness / stiffness - 1.0).abs() < 1e-6)?;
            Some(match row.step_s {
                None => "no limit".into(),
                Some(step) => format!("{:.2}", step * row.frequency),
            })
        },
    )
}

/// The drift at the end of each run, and the steps to there, for each method and form; `None` of no rows.
pub fn drift(rows: &[Drift]) -> Option<Table> {
    let name = |row: &Drift| format!("{} {}", row.method, row.form);
    let names = rows.iter().map(name).unique().collect();
    let scenes: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).unique().collect();
    Table::new(names, &scenes, str::to_owned, |wanted, scene| {
        let own = rows
            .iter()
            .filter(|row| row.scene == scene && name(row) == wanted);
        let own: Vec<&Drift> = own.collect();
        let last = own.last()?;
        if !last.failure.is_empty() {
            return Some(format!("fails at {}", last.steps));
        }
        let most = own.iter().map(|row| row.drift).fold(0.0, f64::max);
        Some(format!("{most:.1e} ({:.0e})", last.steps as f64))
    })
}
