//! Iterations of implicit steps that rounding keeps from converging.
//!
//! Where masses differ by many orders of magnitude, the accelerations of light bodies scatter by far more than a rounding. An iteration that asks for more digits than
//! they have converges by chance, over steps so short that the scatter no longer shows.

use super::flow::Flow;
use super::rounding::{MARGIN, Rounding};
use super::step_state::StepState;
use super::stepper::Stepper;
use super::{IntegrateError, Statistics};

/// Rounding is no cause where less than this part of all attempts does not converge: step control shortens a step now and then.
const OFTEN: f64 = 0.1;

/// Whether a motion may go on that takes more steps than anybody waits for, `step` the next one, s.
///
/// # Errors
/// If many attempts do not converge, and rounding alone changes the iteration by more than what a step may leave unsolved.
pub(super) fn check(
    (step_state, flow): (&StepState, &mut Flow<'_>),
    (time, step): (f64, f64),
    (rounding, stepper): (&mut Rounding, &mut dyn Stepper),
    statistics: &Statistics,
) -> Result<(), IntegrateError> {
    let (count, attempts) = (
        statistics.unconverged,
        statistics.steps + statistics.rejected,
    );
    if (count as f64) < OFTEN * attempts as f64 {
        return Ok(());
    }
    // Where the equations have no value nearby, nothing is known of rounding.
    let Ok(scatter) = rounding.scatter_of_configurations(step_state, flow, time) else {
        return Ok(());
    };
    match stepper.unsolved_by_rounding(step_state, scatter, step) {
        Some((ratio, row)) if MARGIN * ratio > 1.0 => Err(IntegrateError::Unsolved {
            time,
            joint: flow.row_name(row),
            ratio: MARGIN * ratio,
            count,
            attempts,
        }),
        _ => Ok(()),
    }
}
