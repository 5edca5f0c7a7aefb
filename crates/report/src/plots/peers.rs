//! The same motion by several libraries.

use super::axes::{Curve, Panel, figure};
use super::style::{self, Look};
use hamel_console::output::Failure;

const WIDTH: u32 = 1180;
const HEIGHT: u32 = 400;

/// The best of each library: error at the last sample over run time; those of one library are dashed whose name says that they are compiled.
pub fn drawing(fronts: &[(&str, Vec<(f64, f64)>)]) -> Result<String, Failure> {
    let curves = fronts
        .iter()
        .enumerate()
        .map(|(number, (library, points))| {
            let points = points.iter().map(|&(error, seconds)| (seconds, error));
            Curve {
                label: (*library).to_owned(),
                look: Look {
                    dashed: library.contains("compiled"),
                    ..style::numbered(number)
                },
                points: points.collect(),
                failures: Vec::new(),
            }
        });
    let panel = Panel {
        title: String::new(),
        horizontal: "run time, s".into(),
        vertical: "error at the last sample".into(),
        curves: curves.filter(|curve| !curve.points.is_empty()).collect(),
        floor: None,
        marks: true,
    };
    figure(&[panel], WIDTH, HEIGHT)
}
