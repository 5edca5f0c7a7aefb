//! The method that is chosen beside the fastest one, over all scenes.

use super::{is_main, median, percent, times};
use crate::choice::{ASKED, Measured};
use crate::row::Work;
use itertools::Itertools;
use serde::Serialize;

/// Points that are reported, of those at which the choice takes longest.
const WORST: usize = 5;

/// How the choice compares.
#[derive(Debug, Serialize)]
pub struct Selection {
    points: usize,
    median: String,
    within_2: String,
    within_5: String,
    worst: Vec<String>,
}

impl Selection {
    /// Of the Lagrangian form, at the tolerances at which pages tell the choice; `None` where it was not measured.
    pub fn new(rows: &[Work]) -> Option<Self> {
        let main = |row: &&Work| is_main(row) && row.form == "lagrangian";
        let rows: Vec<&Work> = rows.iter().filter(main).collect();
        let scenes = rows.iter().map(|row| row.scene.as_str()).unique();
        let ratios = scenes.flat_map(|scene| {
            let own = rows.iter().copied().filter(|row| row.scene == scene);
            let own: Vec<&Work> = own.collect();
            ASKED.into_iter().filter_map(move |tolerance| {
                let measured = Measured::of(&own, tolerance)?;
                let ratio = measured.ratio();
                let told = format!(
                    "{scene} at {tolerance:.0e}: {} times as long as {}",
                    times(ratio),
                    measured.best
                );
                Some((ratio, told))
            })
        });
        let ratios: Vec<(f64, String)> = ratios.sorted_by(|a, b| b.0.total_cmp(&a.0)).collect();
        let within = |most: f64| {
            let count = ratios.iter().filter(|(ratio, _)| *ratio <= most).count();
            percent(count, ratios.len())
        };
        Some(Self {
            points: ratios.len(),
            median: times(median(ratios.iter().map(|(ratio, _)| *ratio))?),
            within_2: within(2.0),
            within_5: within(5.0),
            worst: ratios
                .iter()
                .take(WORST)
                .map(|(_, told)| told.clone())
                .collect(),
        })
    }
}
