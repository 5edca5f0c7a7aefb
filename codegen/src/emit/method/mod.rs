//! Kernels as methods of a joint's type, in any language: signature, formulas or calls of the runtime, operations, meaning.

mod absent;
mod bias;
pub mod group;
mod signature;

pub use absent::{Absent, absent, in_words as absent_in_words, of_further_body};
pub use bias::{WORTH_WRITING, operations as operations_by_products, products};
pub use signature::{Argument, Output, Signature, meaning};

use crate::derived::{Derived, Kernel, KernelKind, Step};
use crate::expr::Symbol;
use crate::formula::{Binding, Counts, Names, Program};
use crate::matrix::Matrix;
use group::Calls;
use std::borrow::Cow;
use std::collections::BTreeSet;

/// A kernel with all that is needed to write it and to count it.
pub struct Method<'a> {
    /// Its joint.
    pub derived: &'a Derived,
    /// What it computes.
    pub kernel: &'a Kernel,
    /// Its name, arguments and result.
    pub signature: Signature,
    /// The names of its symbols.
    pub names: Names,
    /// Its formulas.
    pub program: Cow<'a, Program>,
    /// The symbols that these use.
    pub used: BTreeSet<Symbol>,
    /// The calls of groups that compute it, instead of its formulas.
    pub calls: Option<Calls<'a>>,
}

/// Name of the method of a kernel.
pub fn method_name(derived: &Derived, kernel: &Kernel) -> &'static str {
    Signature::new(kernel, derived.shape).name
}

impl<'a> Method<'a> {
    /// Factors and names what the kernel computes.
    pub fn new(derived: &'a Derived, kernel: &'a Kernel, names: &Names) -> Self {
        let mut names = names.clone();
        let calls = Calls::new(derived, kernel);
        let program = match &calls {
            Some(calls) => {
                calls.bound().iter().for_each(|symbol| names.claim(symbol));
                let entries = Matrix::column_vector(calls.expressions());
                Cow::Owned(Program::new(&[], &[entries], names.taken()))
            }
            None => {
                let bound = kernel.steps.iter().flat_map(Step::bound);
                bound.for_each(|symbol| names.claim(symbol));
                Cow::Borrowed(derived.program(kernel))
            }
        };
        program
            .bindings
            .iter()
            .flat_map(Binding::names)
            .for_each(|symbol| names.adopt(symbol));
        let signature = Signature::new(kernel, derived.shape);
        let used = program.symbols();
        Self {
            derived,
            kernel,
            signature,
            names,
            program,
            used,
            calls,
        }
    }

    /// The operations of the emitted method.
    pub fn counts(&self) -> Counts {
        let mut counts = Counts::of_program(&self.program);
        if let Some(calls) = &self.calls {
            counts += calls.counts();
            return counts;
        }
        let relations = self.program.outputs.len();
        if self.kernel.kind == KernelKind::Residual && relations > 0 {
            counts += Counts {
                additions: relations,
                multiplications: relations,
                fused: relations,
                divisions: 0,
                calls: 1,
            };
        }
        counts
    }
}
