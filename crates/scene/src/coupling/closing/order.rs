//! Which coordinates of a linkage are independent.

use super::Problem;
use super::span::independent;
use crate::diagnostics::Diagnostic;
use crate::suggest::all_of;
use hamel_runtime::joint::{MOST_INDEPENDENT, MOST_LINKS, MOST_RELATIONS, most_relations};

impl Problem<'_> {
    /// The coordinates, the independent ones first, each in the order of the file.
    pub(super) fn ordered(&self, selected: &[Vec<f64>]) -> Result<Vec<usize>, Diagnostic> {
        let all = self.names.len();
        let Some(first) = self.candidates.first() else {
            return Ok((0..all).collect());
        };
        let refuse = |why: &str| first.named.refuse(why);
        let freedoms = all - selected.len().min(all);
        if freedoms == 0 {
            let why = format!(
                "it cannot move: {} joints obey {} independent relations",
                all,
                selected.len()
            );
            return Err(refuse(&why));
        }
        let degrees = match freedoms {
            1 => String::from("1 degree"),
            more => format!("{more} degrees"),
        };
        if selected.len() > most_relations(freedoms) {
            let why = format!(
                "with what shares joints with it, it has {degrees} of freedom and {} independent relations, which no joint has",
                selected.len()
            );
            let help = format!(
                "a joint has at most {MOST_INDEPENDENT} degrees of freedom and {MOST_RELATIONS} relations, and {MOST_LINKS} of both together"
            );
            return Err(refuse(&why).help(help));
        }
        let wanted = self.wanted.iter().map(|&k| self.names[k]);
        if self.wanted.len() > freedoms {
            let why = format!(
                "{} are to move independently, and it has {degrees} of freedom",
                all_of(wanted)
            );
            return Err(refuse(&why));
        }
        // One rate says all where there is one degree of freedom; of several, those that are given are best those of independent coordinates.
        let rated = |k: &usize| freedoms > 1 && self.rated.contains(k);
        let others = (0..all).filter(|k| !self.wanted.contains(k));
        let unrated: Vec<usize> = others.clone().filter(|k| !rated(k)).collect();
        let mut dependent = independent_columns(selected, &unrated);
        if dependent.len() < selected.len() {
            dependent = independent_columns(selected, &others.collect::<Vec<usize>>());
        }
        if dependent.len() < selected.len() {
            let why = format!(
                "at the start the other joints do not follow from {}",
                all_of(wanted)
            );
            return Err(refuse(&why).help("let others move independently"));
        }
        dependent.sort_unstable();
        let mut order: Vec<usize> = (0..all).filter(|k| !dependent.contains(k)).collect();
        order.extend(dependent);
        Ok(order)
    }
}

/// Those of these coordinates whose columns are independent, as many as there are; none where that is not clear.
fn independent_columns(rows: &[Vec<f64>], coordinates: &[usize]) -> Vec<usize> {
    let columns = coordinates.iter();
    let columns = columns.map(|&k| rows.iter().map(|row| row[k]).collect());
    let columns: Vec<Vec<f64>> = columns.collect();
    let found = independent(&columns).unwrap_or_default();
    found.into_iter().map(|place| coordinates[place]).collect()
}
