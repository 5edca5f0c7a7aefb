//! Rows that differ in where joints start and in nothing else: their scenes have one mechanism.

use crate::document::Document;
use crate::motion::Sweep;
use crate::run::Cells;
use hamel::integrate::State;
use hamel::registry::JointRegistry;
use hamel::scene::{SceneDescription, StartNumber, Starts};

/// Columns that change the state at time 0 of a joint, and nothing else.
pub(crate) fn start_columns(
    document: &Document,
    description: &SceneDescription,
    registry: &JointRegistry,
) -> Vec<(usize, StartNumber)> {
    let columns = document.starts();
    let Some(starts) = description.starts(registry) else {
        return Vec::new();
    };
    columns
        .filter_map(|(column, body, keys)| Some((column, starts.number(body, &keys)?)))
        .collect()
}

impl Sweep {
    /// Whether the scenes of two rows, the first of which has one, differ at most in their states at time 0.
    pub fn differ_in_starts_alone(&self, first: &Cells, second: &Cells) -> bool {
        if second.fault.is_some() || first.numbers.len() != second.numbers.len() {
            return false;
        }
        let starts = |column: usize| self.starts.iter().any(|(own, _)| *own == column);
        let mut pairs = first.numbers.iter().zip(&second.numbers).enumerate();
        pairs.all(|(column, (one, other))| match starts(column) {
            true => other.is_finite(),
            false => one.to_bits() == other.to_bits(),
        })
    }

    /// The state at time 0 of a row, by the [`SceneDescription::starts`] of a row that differs from it in that alone; it has the bits of the row's scene. `None` where the scene is refused.
    pub fn start(&self, starts: &mut Starts, cells: &Cells) -> Option<State> {
        let columns = self.starts.iter();
        let numbers: Option<Vec<(StartNumber, f64)>> = columns
            .map(|&(column, place)| Some((place, *cells.numbers.get(column)?)))
            .collect();
        starts.state(numbers?).ok()
    }
}
