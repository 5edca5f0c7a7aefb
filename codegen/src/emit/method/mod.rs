//! Kernels as methods of a joint's type, in any language: signature, formulas or calls of the runtime, operations, meaning.

mod absent;
mod bias;
pub mod group;
pub mod shared;
mod signature;

pub use absent::{Absent, absent, in_words as absent_in_words, of_further_body};
pub use bias::{WORTH_WRITING, operations as operations_by_products, products};
pub use signature::{Argument, Output, Signature, meaning};

use crate::derived::{Derived, Kernel, KernelKind, Step};
use crate::formula::{Binding, Counts, Names, Program};
use crate::matrix::Matrix;
use group::Calls;
use shared::Function;
use std::borrow::Cow;

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
    /// The functions that give it some of its words.
    pub asked: Vec<Function>,
    /// Whether it is the norm of what the kernel of the relations gives.
    pub asks_relations: bool,
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
        Self {
            derived,
            kernel,
            signature,
            names,
            program,
            asked: vec![],
            asks_relations: false,
            calls,
        }
    }

    /// The same, where functions of the joint give what kernels share.
    pub fn with_functions(
        derived: &'a Derived,
        kernel: &'a Kernel,
        names: &Names,
        functions: &[Function],
    ) -> Self {
        let mut whole = Self::new(derived, kernel, names);
        let relations = derived.kernel(KernelKind::Relations);
        whole.asks_relations = kernel.kind == KernelKind::Residual
            && relations.is_some_and(|relations| relations.outputs == kernel.outputs);
        let steps = shared::without(functions, kernel);
        let is_formula = kernel.method == crate::derived::Method::Formula && whole.calls.is_none();
        if !is_formula || steps.len() == kernel.steps.len() {
            return whole;
        }
        let (program, names) = shared::program(&kernel.steps, &steps, &kernel.outputs, names);
        let used = program.symbols();
        let asks = |function: &&Function| function.words.iter().any(|word| used.contains(word));
        whole.asked = functions.iter().filter(asks).cloned().collect();
        (whole.program, whole.names) = (Cow::Owned(program), names);
        whole
    }

    /// The operations of the emitted method.
    pub fn counts(&self) -> Counts {
        let mut counts = match self.asks_relations {
            true => Counts::default(),
            false => Counts::of_program(&self.program),
        };
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
