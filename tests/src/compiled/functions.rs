//! Compiled functions of a model, kept: a test evaluates them at several states.

use hamel_compiler::emit::{Function, Lowered};
use hamel_compiler::functions::{Kind, Loops, compile_with};
use hamel_compiler::graph::Argument;
use hamel_compiler::model::Model;
use hamel_compiler::prune::{Link, Pruning, prune};
use std::cell::RefCell;

/// The functions of a model, each compiled when it is first asked for.
pub struct Functions<'a> {
    model: &'a Model,
    links: Vec<Link>,
    known: RefCell<Vec<Known>>,
}

/// A compiled function.
struct Known {
    how: (Kind, Loops),
    function: Function,
    lines: Lowered,
}

impl<'a> Functions<'a> {
    /// Of a model; nothing is compiled yet.
    pub fn new(model: &'a Model) -> Self {
        Self {
            model,
            links: prune(model, Pruning::ALL),
            known: RefCell::default(),
        }
    }

    /// The values of a function at a state; `speeds` are the momenta where it takes these, `inputs` end with λ where it takes that.
    pub fn evaluate(
        &self,
        how: (Kind, Loops),
        q: &[f64],
        speeds: &[f64],
        inputs: &[f64],
    ) -> Vec<f64> {
        let mut known = self.known.borrow_mut();
        let place = known.iter().position(|one| one.how == how);
        let place = place.unwrap_or_else(|| {
            let function = compile_with(self.model, &self.links, how.0, how.1).function;
            known.push(Known {
                how,
                lines: function.packed_lines(),
                function,
            });
            known.len() - 1
        });
        let Known {
            function, lines, ..
        } = &known[place];
        function.evaluate_lines(lines, |argument| match argument {
            Argument::Configuration => q.to_vec(),
            Argument::Speeds | Argument::Momenta => speeds.to_vec(),
            Argument::Efforts | Argument::Accelerations => inputs.to_vec(),
            Argument::Weights => inputs[inputs.len() - speeds.len()..].to_vec(),
            // Of steps of motions alone.
            Argument::Given => vec![],
        })
    }
}
