//! Which method is the fastest for which kind of scene.

use super::{is_main, times};
use crate::curve::run_times;
use crate::kind::Kind;
use crate::row::Work;
use hamel::registry::JointRegistry;
use hamel_scene::Settings;
use itertools::Itertools;
use serde::Serialize;

/// Errors that methods are compared at.
const ASKED: [f64; 3] = [1e-4, 1e-8, 1e-12];

/// Multiple of the floor below which no error is asked for.
const FLOORS: f64 = 10.0;

/// Methods that are named for each.
const NAMED: usize = 2;

/// The table.
#[derive(Debug, Serialize)]
pub struct Kinds {
    /// Headings of the columns.
    asked: Vec<String>,
    lines: Vec<Line>,
}

#[derive(Debug, Serialize)]
struct Line {
    kind: &'static str,
    scenes: Vec<String>,
    cells: Vec<String>,
}

/// A method on the scenes of a kind.
struct Record<'a> {
    method: &'a str,
    /// Scenes on which it has the error that is asked.
    reached: usize,
    /// Geometric mean of its run time over that of the fastest method.
    ratio: f64,
}

impl Kinds {
    /// Of the Lagrangian form, by the tree.
    pub fn new(rows: &[Work], registry: &JointRegistry) -> Self {
        let named =
            |row: &&Work| is_main(row) && row.form == "lagrangian" && row.method != Settings::AUTO;
        let rows: Vec<&Work> = rows.iter().filter(named).collect();
        let scenes = rows.iter().map(|row| row.scene.as_str()).unique();
        let scenes: Vec<(&str, Kind)> = scenes
            .filter_map(|scene| Some((scene, Kind::of(scene, registry)?)))
            .collect();
        let lines = Kind::ALL.into_iter().filter_map(|kind| {
            let own = scenes.iter().filter(|(_, of)| *of == kind);
            let own: Vec<&str> = own.map(|(scene, _)| *scene).collect();
            (!own.is_empty()).then(|| Line {
                kind: kind.name(),
                cells: ASKED.map(|error| cell(&rows, &own, error)).to_vec(),
                scenes: own.iter().map(|&scene| scene.to_owned()).collect(),
            })
        });
        Self {
            lines: lines.collect(),
            asked: ASKED.map(|error| format!("{error:.0e}")).to_vec(),
        }
    }
}

/// The best methods: those that have the error on the most scenes, and of these the fastest.
fn cell(rows: &[&Work], scenes: &[&str], error: f64) -> String {
    let mut records = records(rows, scenes, error);
    records.sort_by(|a, b| {
        let count = b.reached.cmp(&a.reached);
        count.then(a.ratio.total_cmp(&b.ratio))
    });
    let told = records.iter().take(NAMED).map(|record| {
        let Record {
            method,
            reached,
            ratio,
        } = record;
        format!("{method} {} ({reached} of {})", times(*ratio), scenes.len())
    });
    match records.is_empty() {
        true => "none".into(),
        false => told.collect::<Vec<_>>().join(", "),
    }
}

fn records<'a>(rows: &[&'a Work], scenes: &[&str], error: f64) -> Vec<Record<'a>> {
    let mut logarithms: Vec<(&str, Vec<f64>)> = Vec::new();
    for scene in scenes {
        let times = times_of(rows, scene, error);
        let least = { times.iter() }.map(|(_, time)| *time).reduce(f64::min);
        for (method, time) in times {
            let logarithm = (time / least.unwrap_or(time)).ln();
            match logarithms.iter_mut().find(|(known, _)| *known == method) {
                Some((_, own)) => own.push(logarithm),
                None => logarithms.push((method, vec![logarithm])),
            }
        }
    }
    let records = logarithms.into_iter().map(|(method, own)| Record {
        method,
        reached: own.len(),
        ratio: (own.iter().sum::<f64>() / own.len() as f64).exp(),
    });
    records.collect()
}

/// The run times, s, of the methods that have an error of some floors or of what is asked on a scene.
fn times_of<'a>(rows: &[&'a Work], scene: &str, error: f64) -> Vec<(&'a str, f64)> {
    let own = rows.iter().copied().filter(|row| row.scene == scene);
    let own: Vec<&Work> = own.collect();
    let floor = own.first().map_or(0.0, |row| row.floor);
    run_times(&own, error.max(FLOORS * floor))
}
