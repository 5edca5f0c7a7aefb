//! The method that is chosen for a scene beside the one that would have been the fastest.

use super::case::Case;
use super::row::Work;
use hamel::registry::JointRegistry;
use hamel_scene::{Company, Scene, Settings};
use serde::Serialize;

/// Tolerances at which the choice is told.
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

/// The choices for the scene of a case, with what was measured of them, in the rows of one scene, form, representation and implementation.
pub fn choices(case: &Case, registry: &JointRegistry, rows: &[&Work]) -> Vec<Choice> {
    let scene = case.description().ok();
    let scene = scene.and_then(|description| description.build(registry).ok());
    let end = case.reference().map_or(0.0, |reference| reference.end());
    let choices = ASKED.into_iter().filter_map(|tolerance| {
        let (method, reason) = chosen(scene.as_ref()?, tolerance, end)?;
        let own = rows.iter().find(|row| {
            row.method == Settings::AUTO && (row.accuracy / tolerance - 1.0).abs() < 1e-6
        });
        let own = own.and_then(|row| Some((row.error_worst?, row.seconds_least?)));
        let best = own.and_then(|(error, _)| fastest(rows, error));
        Some(Choice {
            tolerance: format!("{tolerance:.0e}"),
            method,
            reason,
            time: own.map_or(String::new(), |(_, time)| format!("{:.3}", 1e3 * time)),
            error: own.map_or(String::new(), |(error, _)| format!("{error:.1e}")),
            best: best
                .as_ref()
                .map_or(String::new(), |(name, _)| name.clone()),
            ratio: own
                .zip(best)
                .map_or(String::new(), |((_, own), (_, best))| {
                    format!("{:.1}", own / best)
                }),
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

/// The method that takes the least time to this error, and the time, s; between two points of a curve as a power of the error.
fn fastest(rows: &[&Work], error: f64) -> Option<(String, f64)> {
    let mut names: Vec<&str> = rows.iter().map(|row| row.method.as_str()).collect();
    names.dedup();
    let named = names.into_iter().filter(|name| *name != Settings::AUTO);
    let times = named.filter_map(|name| {
        let curve = rows.iter().filter(|row| row.method == name);
        let points = curve.filter_map(|row| Some((row.error_worst?, row.seconds_least?)));
        Some((
            name.to_owned(),
            time_to(&points.collect::<Vec<_>>(), error)?,
        ))
    });
    times.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The least time, s, to an error, of points in the order of their tolerances; `None` where the curve does not come so far.
fn time_to(points: &[(f64, f64)], error: f64) -> Option<f64> {
    // What is on the floor is as good as it.
    let reached = points.iter().filter(|(own, _)| *own <= error.max(LEAST));
    let between = points.windows(2).filter_map(|pair| {
        let [(above, before), (below, after)] = [pair[0], pair[1]];
        let part = (above / error).ln() / (above / below).ln();
        (above > error && error > below).then(|| before * (after / before).powf(part))
    });
    let times = reached.map(|&(_, time)| time).chain(between);
    times.reduce(f64::min)
}

/// Half a rounding.
const LEAST: f64 = 0.5 * f64::EPSILON;

#[cfg(test)]
mod tests {
    use super::time_to;

    #[test]
    fn times_are_between_those_of_the_points() {
        let points = [(1e-2, 1.0), (1e-4, 2.0), (1e-8, 8.0)];
        assert_eq!(time_to(&points, 1e-4), Some(2.0));
        let middle = time_to(&points, 1e-6).expect("within the curve");
        assert!((middle - 4.0).abs() < 1e-12, "{middle}");
        assert_eq!(time_to(&points, 1.0), Some(1.0));
        assert_eq!(time_to(&points, 1e-10), None);
    }
}
