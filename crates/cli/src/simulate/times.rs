//! The times that `--at` asks for.

use hamel_console::output::Failure;

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
    use super::chosen;

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
