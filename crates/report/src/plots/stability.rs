//! Stability maps.

use super::axes::{Curve, Panel, figure};
use super::style;
use crate::row::Stability;
use hamel_console::output::Failure;

const WIDTH: u32 = 1180;
const HEIGHT: u32 = 420;

/// The largest stable step over the stiffness, absolute and in radians of the natural frequency. Methods without a limit are drawn at the
/// largest step tried, dashed.
pub fn drawing(rows: &[&Stability]) -> Result<String, Failure> {
    let absolute = panel(rows, "largest stable step, s", |_, step| step);
    let relative = panel(rows, "largest stable step × ω, rad", |row, step| {
        step * row.frequency
    });
    figure(&[absolute, relative], WIDTH, HEIGHT)
}

fn panel(rows: &[&Stability], vertical: &str, height: fn(&Stability, f64) -> f64) -> Panel {
    let mut curves: Vec<Curve> = Vec::new();
    for row in rows {
        let unlimited = row.step_s.is_none();
        let label = match unlimited {
            true => format!("{} (no limit)", row.method),
            false => row.method.clone(),
        };
        let step = row.step_s.unwrap_or(row.largest_tried_s);
        let point = (row.stiffness, height(row, step));
        // No step at all is stable.
        let point = (point.1 > 0.0).then_some(point);
        let place = curves.iter().position(|curve| curve.label == label);
        let place = place.unwrap_or_else(|| {
            curves.push(Curve {
                label,
                look: style::Look {
                    dashed: unlimited,
                    ..style::method(&row.method)
                },
                points: vec![],
                failures: vec![],
            });
            curves.len() - 1
        });
        match point {
            Some(point) => curves[place].points.push(point),
            None => curves[place].failures.push(row.stiffness),
        }
    }
    Panel {
        title: String::new(),
        horizontal: "stiffness, N m/rad".into(),
        vertical: vertical.into(),
        curves,
        floor: None,
        marks: true,
    }
}
