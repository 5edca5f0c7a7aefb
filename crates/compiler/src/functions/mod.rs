//! The functions that can be asked for, each by its own recursion; where there are several, the one with the fewest operations.

mod choice;
mod in_lanes;
mod kind;
mod least;
mod not_written;
mod ways;

pub use in_lanes::compile_in_lanes;
pub use kind::Kind;
pub use not_written::{NotWritten, TooLong};
pub(crate) use ways::ways_to_accelerations;

use super::emit::Function;
use super::graph::record_alike;
use super::model::Model;
use super::packs::{self, Packs};
use super::prune::{Link, Pruning, prune};
use choice::{choose, numbers, run};
use least::least;

/// Operations, those of loops once, that a function may have, so that no module keeps the Rust compiler busy without end: straight-line functions
/// of 31 000 operations already took it more than 100 s.
pub const LONGEST: usize = 100_000;

/// Whether like bodies are looped over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Loops {
    /// Never.
    Never,
    /// In functions of more than 10 000 operations, if that halves what is written; like limbs are side by side in what has no such loops.
    #[default]
    Long,
    /// Wherever there are any.
    Always,
}

/// A function as it was chosen.
#[derive(Clone, Debug)]
pub struct Chosen {
    /// The function.
    pub function: Function,
    /// The recursion.
    pub way: &'static str,
    /// Operations of all recursions that were tried.
    pub tried: Vec<(&'static str, usize)>,
}

/// A function of the model: with the fewest operations where it is short, else with the shortest code.
///
/// # Errors
/// More than [`LONGEST`] operations that would be written; second derivatives of forward dynamics where constraints couple joints.
pub fn compile(model: &Model, kind: Kind, loops: Loops) -> Result<Chosen, NotWritten> {
    let constraint = model.coupling.constraints.first();
    if let (Kind::ForwardSecondDerivatives, Some(constraint)) = (kind, constraint) {
        let constraint = constraint.name.clone();
        return Err(NotWritten::Coupled { kind, constraint });
    }
    let refused = |operations| {
        NotWritten::TooLong(TooLong {
            kind,
            in_lanes: false,
            operations,
            numbers: None,
        })
    };
    let least = least(model, kind);
    let is_looped = loops != Loops::Never && !kind.pairwise(model).is_empty();
    if least > LONGEST && !is_looped {
        return Err(refused(least));
    }
    let links = prune(model, Pruning::ALL);
    let chosen = compile_with(model, &links, kind, loops);
    match chosen.function.written() {
        operations if operations > LONGEST => Err(refused(operations)),
        _ => Ok(chosen),
    }
}

/// The packs of a function as it was chosen, where they save operations.
fn packs(model: &Model, links: &[Link], kind: Kind, chosen: &Chosen) -> Option<Packs> {
    if chosen.function.plan.is_some() || !packs::may_have(model) {
        return None;
    }
    let (outputs, graph) = match &chosen.function.pairs {
        None => {
            let mut ways = kind.ways(model).into_iter();
            let (_, way) = ways.find(|(name, _)| *name == chosen.way)?;
            record_alike(|| run(model, links, way))
        }
        Some(_) => {
            let mut ways = kind.pairwise(model).into_iter();
            let (_, way) = ways.find(|(name, _)| *name == chosen.way)?;
            let ((outputs, _), graph) = record_alike(|| numbers(model, links, way));
            (outputs, graph)
        }
    };
    Packs::new(model, graph, outputs)
}

/// The same with links that are known, and however long.
pub fn compile_with(model: &Model, links: &[Link], kind: Kind, loops: Loops) -> Chosen {
    let mut chosen = choose(model, links, kind, loops);
    if loops == Loops::Long {
        chosen.function.packs = packs(model, links, kind, &chosen);
    }
    chosen
}
