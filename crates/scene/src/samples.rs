//! The times at which a motion is sampled.

use crate::Settings;
use hamel_runtime::shown::Number;

/// More samples than this are taken for a mistake.
const MOST_SAMPLES: f64 = 1e6;

/// More than 1e6 samples.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "a sample each {step:?} s until {t_end:?} s makes {count} samples, and the limit is {MOST_SAMPLES:e}",
    step = Number(*.step), t_end = Number(*.t_end), count = shown(*.count)
)]
pub struct TooManySamples {
    /// Time between two samples, s.
    pub step: f64,
    /// The end, s.
    pub t_end: f64,
    /// How many that makes.
    pub count: f64,
}

fn shown(count: f64) -> String {
    match count.is_finite() {
        true => format!("{count:.3e}"),
        false => format!("more than {:e}", f64::MAX),
    }
}

impl Settings {
    /// 0, `sample_step`, 2 `sample_step`, … and `t_end`.
    ///
    /// # Errors
    /// More than 1e6 samples.
    pub fn sample_times(&self) -> Result<Vec<f64>, TooManySamples> {
        let (step, t_end) = (self.sample_step, self.t_end);
        let count = t_end / step;
        if count.is_nan() || count > MOST_SAMPLES {
            return Err(TooManySamples { step, t_end, count });
        }
        // Rounding must not add a sample just before the last one.
        let whole = (count * (1.0 - 4.0 * f64::EPSILON)).ceil() as usize;
        let mut times: Vec<f64> = (0..whole).map(|index| index as f64 * step).collect();
        times.push(t_end);
        Ok(times)
    }
}

#[cfg(test)]
mod tests {
    use crate::Settings;

    fn settings(t_end: f64, sample_step: f64) -> Settings {
        Settings {
            t_end,
            sample_step,
            ..Settings::default()
        }
    }

    #[test]
    fn times_end_at_the_end() {
        let times = |t_end, step| settings(t_end, step).sample_times().expect("few samples");
        assert_eq!(times(1.0, 0.5), [0.0, 0.5, 1.0]);
        assert_eq!(times(1.0, 0.4), [0.0, 0.4, 0.8, 1.0]);
        assert_eq!(times(0.3, 0.1), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(times(0.0, 0.1), [0.0]);
        assert_eq!(times(4.0, 0.01).len(), 401);
        assert!(settings(1e300, 1e-300).sample_times().is_err());
        assert!(settings(f64::NAN, 0.1).sample_times().is_err());
    }
}
