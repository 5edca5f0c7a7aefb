//! The times at which a motion is sampled.

use crate::Settings;
use hamel_runtime::shown::Number;

/// More samples than this are taken for a mistake.
const MOST_SAMPLES: f64 = 1e6;

/// Why a motion cannot be sampled.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// More than 1e6 samples.
    #[error(
        "a sample each {step:?} s until {t_end:?} s makes {count} samples, and the limit is {MOST_SAMPLES:e}",
        step = Number(*.step), t_end = Number(*.t_end), count = shown(*.count)
    )]
    TooMany {
        /// Time between two samples, s.
        step: f64,
        /// The end, s.
        t_end: f64,
        /// How many that makes.
        count: f64,
    },
    /// Samples that do not go on.
    #[error("the time between two samples is {step:?} s, it must be above 0", step = Number(*.step))]
    Step {
        /// Time between two samples, s.
        step: f64,
    },
}

fn shown(count: f64) -> String {
    match count.is_finite() {
        true => format!("{count:.3e}"),
        false => format!("more than {:e}", f64::MAX),
    }
}

impl Settings {
    /// `start`, `start + sample_step`, … and `t_end`.
    ///
    /// # Errors
    /// More than 1e6 samples; a step that is not above 0.
    pub fn sample_times(&self, start: f64) -> Result<Vec<f64>, SampleError> {
        let (step, t_end) = (self.sample_step, self.t_end);
        if step.is_nan() || step <= 0.0 {
            return Err(SampleError::Step { step });
        }
        let count = (t_end - start) / step;
        if count.is_nan() || count > MOST_SAMPLES {
            return Err(SampleError::TooMany { step, t_end, count });
        }
        // Rounding must not add a sample just before the last one.
        let whole = (count * (1.0 - 4.0 * f64::EPSILON)).ceil() as usize;
        let mut times: Vec<f64> = (0..whole)
            .map(|index| start + index as f64 * step)
            .collect();
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
        let times = |t_end, step| {
            settings(t_end, step)
                .sample_times(0.0)
                .expect("few samples")
        };
        assert_eq!(times(1.0, 0.5), [0.0, 0.5, 1.0]);
        assert_eq!(times(1.0, 0.4), [0.0, 0.4, 0.8, 1.0]);
        assert_eq!(times(0.3, 0.1), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(times(0.0, 0.1), [0.0]);
        assert_eq!(times(4.0, 0.01).len(), 401);
        let later = settings(1.0, 0.25).sample_times(0.5);
        assert_eq!(later.expect("three samples"), [0.5, 0.75, 1.0]);
        for (t_end, step) in [
            (1e300, 1e-300),
            (f64::NAN, 0.1),
            (1.0, 0.0),
            (1.0, -0.1),
            (1.0, f64::NAN),
        ] {
            assert!(
                settings(t_end, step).sample_times(0.0).is_err(),
                "{t_end} {step}"
            );
        }
    }
}
