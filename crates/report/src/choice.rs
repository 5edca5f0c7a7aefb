//! The method that is chosen for a scene beside the one that would have been the fastest.

use super::case::Case;
use super::curve::run_times;
use super::row::Work;
use hamel::registry::JointRegistry;
use hamel_scene::{Company, Scene, Settings};
use serde::Serialize;

/// Tolerances at which the choice is reported.
pub const ASKED: [f64; 3] = [1e-4, 1e-8, 1e-12];

/// The choice for one tolerance.
#[derive(Debug, Serialize)]
pub struct Choice {
    tolerance: String,
    /// The method, and why.
    method: &'static str,
    reason: String,
    /// Run time with it, the choosing included, ms, and the error; empty where it was not measured.
    time: String,
    error: String,
    /// The method that is the fastest to the same error, and how many times as long the choice takes.
    best: String,
    ratio: String,
}

/// What was measured of the choice for one tolerance.
#[derive(Debug)]
pub struct Measured {
    /// Run time, the choosing included, s, and the worst error.
    pub seconds: f64,
    pub error: f64,
    /// The method that is the fastest to the same error, and its run time, s.
    pub best: String,
    pub least: f64,
}

impl Measured {
    /// Of the rows of one scene, form, representation and implementation; `None` where the choice was not measured, or failed.
    pub fn of(rows: &[&Work], tolerance: f64) -> Option<Self> {
        let own = rows.iter().find(|row| {
            row.method == Settings::AUTO && (row.accuracy / tolerance - 1.0).abs() < 1e-6
        })?;
        let (error, seconds) = (own.error_worst?, own.seconds_least?);
        let (best, least) = fastest(rows, error)?;
        Some(Self {
            seconds,
            error,
            best,
            least,
        })
    }

    /// How many times as long as the fastest method the choice takes.
    pub fn ratio(&self) -> f64 {
        self.seconds / self.least
    }
}

/// The choices for the scene of a case, with what was measured of them, in the rows of one scene, form, representation and implementation.
pub fn choices(case: &Case, registry: &JointRegistry, rows: &[&Work]) -> Vec<Choice> {
    let scene = case.description().ok();
    let scene = scene.and_then(|description| description.build(registry).ok());
    let end = case.reference().map_or(0.0, |reference| reference.end());
    let choices = ASKED.into_iter().filter_map(|tolerance| {
        let (method, reason) = chosen(scene.as_ref()?, tolerance, end)?;
        let measured = Measured::of(rows, tolerance);
        let told = |tell: fn(&Measured) -> String| measured.as_ref().map_or(String::new(), tell);
        Some(Choice {
            tolerance: format!("{tolerance:.0e}"),
            method,
            reason,
            time: told(|own| format!("{:.3}", 1e3 * own.seconds)),
            error: told(|own| format!("{:.1e}", own.error)),
            best: told(|own| own.best.clone()),
            ratio: told(|own| format!("{:.1}", own.ratio())),
        })
    });
    choices.collect()
}

fn chosen(scene: &Scene, tolerance: f64, t_end: f64) -> Option<(&'static str, String)> {
    let settings = Settings {
        t_end,
        ..Settings::default()
    };
    let settings = settings.with_tolerance(tolerance);
    let chosen = scene.choose_method(&settings, &scene.start(), Company::default());
    let (method, reason) = chosen.ok()?;
    Some((method.scheme().name(), reason.unwrap_or_default()))
}

/// The method that takes the least time to this error, and the time, s.
fn fastest(rows: &[&Work], error: f64) -> Option<(String, f64)> {
    let named = rows.iter().copied();
    let named: Vec<&Work> = named.filter(|row| row.method != Settings::AUTO).collect();
    let fastest = run_times(&named, error).into_iter();
    let fastest = fastest.min_by(|a, b| a.1.total_cmp(&b.1));
    fastest.map(|(name, time)| (name.to_owned(), time))
}
