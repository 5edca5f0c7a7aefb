//! The times at which the trajectory is sampled.

use crate::output::Failure;
use hamel::shown::Number;

/// More samples than this are taken for a mistake.
const MOST_SAMPLES: f64 = 1e6;

/// 0, `step`, 2 `step`, … and `t_end`.
///
/// # Errors
/// More than 1e6 samples.
pub fn regular(t_end: f64, step: f64) -> Result<Vec<f64>, Failure> {
    let count = t_end / step;
    if count > MOST_SAMPLES {
        let count = match count.is_finite() {
            true => format!("{count:.3e}"),
            false => format!("more than {:e}", f64::MAX),
        };
        return Err(Failure::Options(format!(
            "a sample each {:?} s until {:?} s makes {count} samples, and the limit is {MOST_SAMPLES:e}: \
             choose a larger --sample-step",
            Number(step),
            Number(t_end)
        )));
    }
    // Rounding must not add a sample just before the last one.
    let whole = (count * (1.0 - 4.0 * f64::EPSILON)).ceil() as usize;
    let mut times: Vec<f64> = (0..whole).map(|index| index as f64 * step).collect();
    times.push(t_end);
    Ok(times)
}

/// The times asked for, checked against the end of the simulation, and that end.
///
/// # Errors
/// A time that is not finite, negative, not after the one before it, or past `t_end`.
pub fn chosen(at: &[f64], t_end: Option<f64>) -> Result<(Vec<f64>, f64), Failure> {
    let refuse = |message: String| Err(Failure::Options(message));
    let mut before = None;
    for &time in at {
        if !time.is_finite() || time < 0.0 {
            return refuse(format!(
                "--at has the time {time}; it must be finite and at least 0"
            ));
        }
        if before.is_some_and(|before| time <= before) {
            return refuse(format!(
                "--at has the time {time} out of order; times must ascend"
            ));
        }
        if let Some(end) = t_end.filter(|end| time > *end) {
            return refuse(format!(
                "--at has the time {time} after the end {end} given by --t-end"
            ));
        }
        before = Some(time);
    }
    let last = at.last().copied().unwrap_or(0.0);
    Ok((at.to_vec(), t_end.unwrap_or(last)))
}

#[cfg(test)]
mod tests {
    use super::{chosen, regular};

    #[test]
    fn regular_times_end_at_the_end() {
        let times = |t_end, step| regular(t_end, step).expect("few samples");
        assert_eq!(times(1.0, 0.5), [0.0, 0.5, 1.0]);
        assert_eq!(times(1.0, 0.4), [0.0, 0.4, 0.8, 1.0]);
        assert_eq!(times(0.3, 0.1), [0.0, 0.1, 0.2, 0.3]);
        assert_eq!(times(0.0, 0.1), [0.0]);
        assert_eq!(times(4.0, 0.01).len(), 401);
        assert!(regular(1e300, 1e-300).is_err());
    }

    #[test]
    fn chosen_times_ascend_within_the_simulation() {
        assert_eq!(
            chosen(&[0.0, 2.0], None).expect("ascending"),
            (vec![0.0, 2.0], 2.0)
        );
        assert_eq!(chosen(&[1.0], Some(3.0)).expect("inside"), (vec![1.0], 3.0));
        for wrong in [&[2.0, 1.0][..], &[1.0, 1.0], &[-1.0], &[f64::NAN], &[5.0]] {
            assert!(chosen(wrong, Some(4.0)).is_err(), "{wrong:?}");
        }
    }
}
