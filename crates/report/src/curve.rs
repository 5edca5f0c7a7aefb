//! Curves of error against run time: what lies between their points.

use super::row::Work;
use itertools::Itertools;

/// The least time, s, to an error, of points (error, time) in the order of their tolerances; between two of them as a power of the error. `None` where the curve does not
/// come so far.
pub fn time_to(points: &[(f64, f64)], error: f64) -> Option<f64> {
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

/// The least time of each method to an error, s, of rows of one scene, form, representation and implementation; methods that do not come so far are left out.
pub fn run_times<'a>(rows: &[&'a Work], error: f64) -> Vec<(&'a str, f64)> {
    let methods = rows.iter().map(|row| row.method.as_str()).unique();
    let times = methods.filter_map(|method| {
        let curve = rows.iter().filter(|row| row.method == method);
        let points = curve.filter_map(|row| Some((row.error_worst?, row.seconds_least?)));
        Some((method, time_to(&points.collect::<Vec<_>>(), error)?))
    });
    times.collect()
}

/// The points (error, time) that no other point beats in both, the fastest first.
pub fn front(points: impl IntoIterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut points: Vec<(f64, f64)> = points.into_iter().collect();
    points.sort_by(|a, b| a.1.total_cmp(&b.1).then(a.0.total_cmp(&b.0)));
    let mut least = f64::INFINITY;
    points.retain(|&(error, _)| {
        let is_better = error < least;
        least = least.min(error);
        is_better
    });
    points
}

#[cfg(test)]
mod tests {
    use super::{front, time_to};

    #[test]
    fn times_are_between_those_of_the_points() {
        let points = [(1e-2, 1.0), (1e-4, 2.0), (1e-8, 8.0)];
        assert_eq!(time_to(&points, 1e-4), Some(2.0));
        let middle = time_to(&points, 1e-6).expect("within the curve");
        assert!((middle - 4.0).abs() < 1e-12, "{middle}");
        assert_eq!(time_to(&points, 1.0), Some(1.0));
        assert_eq!(time_to(&points, 1e-10), None);
    }

    #[test]
    fn a_front_holds_what_nothing_beats() {
        let points = [(1e-2, 1.0), (1e-3, 3.0), (1e-4, 2.0), (f64::INFINITY, 0.5)];
        assert_eq!(front(points), [(1e-2, 1.0), (1e-4, 2.0)]);
    }
}
