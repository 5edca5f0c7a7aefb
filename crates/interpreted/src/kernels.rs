//! The kernels of a joint as tapes.

use crate::facts::{self, BodyFacts};
use crate::tape::{Inputs, Tape, assemble};
use hamel_codegen::derived::{Derived, Kernel, KernelKind, Method, Structure};
use hamel_codegen::emit::method::{Absent, Signature, absent};
use hamel_codegen::matrix::Matrix;
use hamel_runtime::joint::{Facts, Port, Units};

/// A kernel's formulas, and what is known of it.
#[derive(Clone, Debug)]
pub struct KernelTape {
    /// Its formulas.
    pub tape: Tape,
    /// Rows and columns of each of its results.
    pub shapes: Vec<(usize, usize)>,
    /// How its value is found.
    pub method: Method,
    /// What is known of its value.
    pub structure: Structure,
    /// Whether products of other kernels are its value as well.
    pub by_products: bool,
}

/// The joint as one of its bodies sees it.
#[derive(Clone, Debug)]
pub struct BodyKernels {
    /// By the number of their kind.
    tapes: Vec<Option<KernelTape>>,
    /// What the body is told by.
    pub facts: BodyFacts,
}

/// All that is evaluated of a joint type.
#[derive(Clone, Debug)]
pub struct Kernels {
    /// One for each body.
    pub bodies: Vec<BodyKernels>,
    /// The constants of the joint; those of bodies stand there.
    pub facts: Facts,
    /// What everything is measured in.
    pub units: Units,
    /// Its ports.
    pub ports: &'static [Port],
    /// The names of its bodies; none where it carries one that has no name.
    pub body_names: &'static [&'static str],
    /// The names of its parameters.
    pub parameters: Vec<&'static str>,
    /// How many scalars it stores.
    pub stored: usize,
    /// Dimension of the group that its manifold of relations lies in; 0 where Φ needs none.
    pub displacements: usize,
    /// How many relations the spec declares.
    pub declared: usize,
    /// How many relations of known factors stand before them.
    pub own: usize,
    /// Rank of the derivatives of the relations.
    pub codimension: usize,
    /// Whether relations alone give Φ.
    pub implicit: bool,
}

impl Kernels {
    /// Those of a derived joint, its names followed by empty ones up to `room` stored scalars.
    pub fn new(derived: &Derived, room: usize) -> Self {
        let [declared, own] = derived.relation_counts();
        let parameters = derived.spec.parameters.iter();
        Self {
            bodies: derived.bodies().map(BodyKernels::new).collect(),
            facts: facts::of(derived, room),
            units: facts::units(derived),
            ports: facts::ports(derived),
            body_names: facts::names(derived.spec.bodies.iter().map(String::as_str)),
            parameters: parameters
                .map(|parameter| facts::kept(parameter.symbol.name()))
                .collect(),
            stored: derived.shape.configuration,
            displacements: derived.shape.displacements,
            declared,
            own,
            codimension: derived.codimension(),
            implicit: derived.spec.implicit.is_some(),
        }
    }
}

impl BodyKernels {
    fn new(derived: &Derived) -> Self {
        let mut tapes = vec![];
        for kernel in &derived.kernels {
            let place = kernel.kind as usize;
            if tapes.len() <= place {
                tapes.resize(place + 1, None);
            }
            tapes[place] = Some(KernelTape::new(derived, kernel));
        }
        Self {
            tapes,
            facts: BodyFacts::new(derived),
        }
    }

    /// The kernel of that kind.
    pub fn tape(&self, kind: KernelKind) -> Option<&KernelTape> {
        self.tapes.get(kind as usize)?.as_ref()
    }
}

impl KernelTape {
    /// Rows of its first result.
    pub fn rows(&self) -> usize {
        self.shapes.first().map_or(0, |(rows, _)| *rows)
    }

    /// Columns of its first result, 1 where it has none.
    pub fn columns(&self) -> usize {
        self.shapes
            .first()
            .map_or(1, |(_, columns)| *columns)
            .max(1)
    }

    fn new(derived: &Derived, kernel: &Kernel) -> Self {
        let signature = Signature::new(kernel, derived.shape);
        let arguments = signature.arguments.iter();
        let parameters = derived.spec.parameters.iter();
        let inputs = Inputs {
            arguments: arguments
                .map(|argument| argument.symbols(&derived.arguments))
                .collect(),
            parameters: parameters.map(|parameter| &parameter.symbol).collect(),
        };
        Self {
            tape: assemble(derived.program(kernel), &inputs),
            shapes: kernel.outputs.iter().map(Matrix::shape).collect(),
            method: kernel.method,
            structure: kernel.structure,
            by_products: absent(derived, kernel) == Some(Absent::ByProducts),
        }
    }
}
