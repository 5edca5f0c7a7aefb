//! Energy over long runs.

use super::axes::{Curve, Panel, figure};
use super::style::{self, Look};
use crate::row::Drift;
use hamel_console::output::Failure;

const WIDTH: u32 = 1180;
const HEIGHT: u32 = 420;

/// The largest error of the energy so far over the number of steps, in each form.
pub fn drawing(rows: &[&Drift]) -> Result<String, Failure> {
    let panels = ["lagrangian", "hamiltonian"].map(|form| {
        let own: Vec<&&Drift> = rows.iter().filter(|row| row.form == form).collect();
        Panel {
            title: format!("{form} form"),
            horizontal: "steps".into(),
            vertical: "|E − E₀| / max(|E₀|, T₀)".into(),
            curves: curves(&own),
            floor: None,
            marks: false,
        }
    });
    figure(&panels, WIDTH, HEIGHT)
}

fn curves(rows: &[&&Drift]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows {
        if curves.iter().all(|curve| curve.label != row.method) {
            curves.push(Curve {
                label: row.method.clone(),
                look: Look {
                    dashed: false,
                    ..style::method(&row.method)
                },
                points: vec![],
                failures: vec![],
            });
        }
        let Some(curve) = curves.iter_mut().find(|curve| curve.label == row.method) else {
            continue;
        };
        let steps = row.steps as f64;
        // The largest so far: an error that crosses zero says nothing there.
        let before = curve.points.last().map_or(1e-17, |point| point.1);
        match row.failure.is_empty() {
            true => curve.points.push((steps, row.drift.max(before))),
            false => curve.failures.push(steps.max(1.0)),
        }
    }
    curves
}
