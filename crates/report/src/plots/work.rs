//! Work–precision diagrams.

use super::axes::{Curve, Panel, figure};
use super::style::{self, Look};
use crate::row::Work;
use hamel_console::output::Failure;
use itertools::Itertools;

const WIDTH: u32 = 1180;
const HEIGHT: u32 = 400;

/// What stands on the horizontal axis.
type Axis = (&'static str, fn(&Work) -> Option<f64>);

const AXES: [Axis; 2] = [
    ("run time, s", |row| {
        row.seconds_least.or(row.seconds_median)
    }),
    ("evaluations of the equations", |row| {
        row.evaluations.map(|count| count as f64)
    }),
];

/// Both forms of one scene in its first representation, by the tree: the worst error against run time and against evaluations.
pub fn forms(rows: &[&Work]) -> Result<String, Failure> {
    let key = |row: &Work| (row.method.clone(), row.form.clone());
    let look = |row: &Work| Look {
        dashed: row.form == "hamiltonian",
        ..style::method(&row.method)
    };
    let label = |row: &Work| match row.form.as_str() {
        "hamiltonian" => format!("{} H", row.method),
        _ => row.method.clone(),
    };
    panels(rows, key, label, look)
}

/// One method in several representations.
pub fn representations(rows: &[&Work]) -> Result<String, Failure> {
    let names = rows.iter().map(|row| row.representation.as_str());
    let names: Vec<&str> = names.unique().collect();
    let first = rows.first().map(|row| &row.method);
    let key = |row: &Work| (row.method.clone(), row.representation.clone());
    let place = |row: &Work| names.iter().position(|name| **name == row.representation);
    // The second method is dashed.
    let look = |row: &Work| Look {
        dashed: first != Some(&row.method),
        ..style::numbered(3 + place(row).unwrap_or_default())
    };
    let label = |row: &Work| format!("{} {}", row.representation, row.method);
    panels(rows, key, label, look)
}

/// Some methods on the tree and on compiled equations.
pub fn implementations(rows: &[&Work]) -> Result<String, Failure> {
    let key = |row: &Work| (row.method.clone(), row.implementation.clone());
    let look = |row: &Work| Look {
        dashed: row.implementation == "compiled",
        ..style::method(&row.method)
    };
    let label = |row: &Work| format!("{} {}", row.method, row.implementation);
    panels(rows, key, label, look)
}

fn panels<K: PartialEq>(
    rows: &[&Work],
    key: impl Fn(&Work) -> K,
    label: impl Fn(&Work) -> String,
    look: impl Fn(&Work) -> Look,
) -> Result<String, Failure> {
    let mut groups: Vec<(K, Vec<&Work>)> = Vec::new();
    for row in rows {
        let key = key(row);
        match groups.iter_mut().find(|(known, _)| *known == key) {
            Some((_, group)) => group.push(row),
            None => groups.push((key, vec![row])),
        }
    }
    let floor = rows.first().map(|row| (row.floor, "floor".to_owned()));
    let panels = AXES.map(|(name, axis)| Panel {
        title: String::new(),
        horizontal: name.into(),
        vertical: "worst error over the samples".into(),
        curves: groups
            .iter()
            .filter_map(|(_, group)| curve(group, axis, &label, &look))
            .collect(),
        floor: floor.clone(),
        marks: true,
    });
    figure(&panels, WIDTH, HEIGHT)
}

fn curve(
    group: &[&Work],
    axis: fn(&Work) -> Option<f64>,
    label: &impl Fn(&Work) -> String,
    look: &impl Fn(&Work) -> Look,
) -> Option<Curve> {
    let first = group.first()?;
    let points = group.iter().filter_map(|row| {
        let error = row.error_worst?;
        // An error of nothing cannot stand on a logarithmic axis: it is a tenth of a rounding.
        Some((axis(row)?, error.max(1e-17)))
    });
    let failed = group.iter().filter(|row| !row.failure.is_empty());
    let failures = failed.filter_map(|row| axis(row)).filter(|&x| x > 0.0);
    Some(Curve {
        label: label(first),
        look: look(first),
        points: points.collect(),
        failures: failures.collect(),
    })
}
