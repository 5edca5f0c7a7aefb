//! The times at which a sweep samples its motions.

use hamel::scene::{Scene, Settings};

/// Times that are nearer to each other, as parts of their size, are one: ends of steps are rounded.
const APART: f64 = 1e-12;

/// A time that differs from the end of a motion by no more than this, as a part of it, is the end: sums and products of decimals are rounded.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Columns of samples at most: the summary holds some ten kilobytes for each.
const MOST_COLUMNS: usize = 20_000;

/// Mistakes that are reported in full.
const MOST_TOLD: usize = 10;

/// Time 0, every `step` seconds after it, and the end of the scene's motion.
///
/// # Errors
/// A step that is not above 0, or that makes more than 1e6 samples.
pub(crate) fn every(step: f64, scene: &Scene) -> Result<Vec<f64>, String> {
    let settings = Settings {
        sample_step: step,
        ..scene.settings
    };
    let times = settings.sample_times(0.0);
    let mut times = times.map_err(|error| error.to_string())?;
    // A step of a dozen digits leaves a sliver before the end.
    if let [.., before, end] = times.as_slice()
        && end - before <= APART * end
    {
        times.remove(times.len() - 2);
    }
    Ok(times)
}

/// The times, none of them −0, of motions that end at `end`, each with so many numbers.
///
/// # Errors
/// What is wrong with them, one a line.
pub(crate) fn checked(times: &[f64], numbers: usize, end: f64) -> Result<Vec<f64>, Vec<String>> {
    let columns = times.len().saturating_mul(numbers);
    if columns > MOST_COLUMNS {
        let times = times.len();
        return Err(vec![format!(
            "{times} samples of {numbers} coordinates and speeds make {columns} columns, and the limit is {MOST_COLUMNS}"
        )]);
    }
    let mut refused = refused(times, end);
    if refused.len() > MOST_TOLD {
        let more = refused.len() - MOST_TOLD;
        refused.truncate(MOST_TOLD);
        refused.push(format!("and {more} samples more"));
    }
    match refused.is_empty() {
        true => Ok(times.iter().map(|time| time + 0.0).collect()),
        false => Err(refused),
    }
}

fn refused(times: &[f64], end: f64) -> Vec<String> {
    let mut last = f64::NEG_INFINITY;
    let refused = times.iter().filter_map(|&time| {
        let before = std::mem::replace(&mut last, time);
        if !(time.is_finite() && time >= 0.0) {
            return Some(format!(
                "a sample at {time} s: times are finite, and not negative"
            ));
        }
        if time - before <= APART * time {
            return Some(format!(
                "a sample at {time} s comes after one at {before} s: times ascend, by more than rounding"
            ));
        }
        until(time, end)
            .is_none()
            .then(|| format!("a sample at {time} s: motions end at {end} s"))
    });
    refused.collect()
}

/// When a sample at `time` is taken of a motion that ends at `end`, if it is.
pub(crate) fn until(time: f64, end: f64) -> Option<f64> {
    match end.is_finite() && (time - end).abs() <= ROUNDING * end {
        true => Some(end),
        false => (time < end).then_some(time),
    }
}

#[cfg(test)]
mod tests {
    use super::{checked, until};

    #[test]
    fn the_end_is_the_end_whatever_rounding_makes_of_it() {
        assert_eq!(until(0.1 + 0.2, 0.3), Some(0.3));
        assert_eq!(until(0.3, 0.1 + 0.2), Some(0.1 + 0.2));
        assert_eq!(until(0.300_000_1, 0.3), None);
        assert_eq!(until(0.2, 0.3), Some(0.2));
        assert_eq!(until(1e300, f64::INFINITY), Some(1e300));
        assert_eq!(
            checked(&[-0.0, 0.1 + 0.2], 1, 0.3),
            Ok(vec![0.0, 0.1 + 0.2])
        );
    }

    #[test]
    fn few_of_many_mistakes_are_told() {
        let late: Vec<f64> = (2..2000).map(f64::from).collect();
        let refused = checked(&late, 1, 1.0).expect_err("all come too late");
        assert_eq!(refused.len(), 11);
        assert_eq!(refused[10], "and 1988 samples more");
    }
}
