//! The equations of motion of each set of held joints, made once.

use crate::flow::{Equations, Flow};
use alloc::sync::Arc;
use alloc::vec::Vec;
use hamel_runtime::mechanism::{Mechanism, MechanismErrors};

/// As many are kept: most motions alternate between a few.
const MOST_KEPT: usize = 16;

pub(super) struct Modes<'a> {
    base: Arc<Mechanism>,
    /// The bodies whose joints are held now.
    held: Vec<usize>,
    /// Those that rest, the last one used first.
    kept: Vec<(Vec<usize>, Equations<'a>)>,
}

impl<'a> Modes<'a> {
    /// Nothing is held yet.
    pub(super) fn new(base: &Arc<Mechanism>) -> Self {
        Self {
            base: Arc::clone(base),
            held: Vec::new(),
            kept: Vec::new(),
        }
    }

    /// Gives `flow` the equations in which the joints under these bodies are held.
    pub(super) fn enter(
        &mut self,
        flow: &mut Flow<'a>,
        held: Vec<usize>,
        q: &[f64],
    ) -> Result<(), MechanismErrors> {
        // Constraints choose at each q which speeds depend on the others.
        let is_coupled = !self.base.constraints().is_empty();
        let is_same = held == self.held && (!is_coupled || held.is_empty());
        if is_same {
            return Ok(());
        }
        let place = self.kept.iter().position(|(kept, _)| *kept == held);
        let equations = match place {
            Some(place) if !is_coupled || held.is_empty() => self.kept.remove(place).1,
            _ => {
                let mechanism = Arc::new(self.base.held(&held, q)?);
                Equations::Own(flow.dynamics().of(mechanism))
            }
        };
        let before = flow.replace_equations(equations);
        let before = (core::mem::replace(&mut self.held, held), before);
        if before.0.is_empty() || !is_coupled {
            self.kept.insert(0, before);
        }
        // The first of all is the caller's, and stays.
        if self.kept.len() > MOST_KEPT {
            let last = self.kept.iter().rposition(|(kept, _)| !kept.is_empty());
            last.map(|place| self.kept.remove(place));
        }
        Ok(())
    }
}
