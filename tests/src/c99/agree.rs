//! Modules in C held against the lines that they are written from, bit by bit, and against the tree.

use super::{Module, Program};
use crate::compiled::{Functions, Point};
use hamel::mechanism::Mechanism;
use hamel_compiler::emit::Function;
use hamel_compiler::functions::{Kind, Loops, compile};
use hamel_compiler::graph::Argument;
use hamel_compiler::model::Model;
use std::cell::RefCell;
use std::path::Path;
use std::sync::Arc;

/// Operations of a function of derivatives from which on a compiler is not done with it soon.
const LONG: usize = 20_000;

/// Which functions of derivatives are compared, and how the compiler optimises.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Those of fewer operations; of second derivatives, of half as many.
    operations: usize,
    optimisation: &'static str,
}

impl Extent {
    /// Many scenes, in each run of the tests: optimising long functions would take most of its time.
    pub const MANY_SCENES: Self = Self {
        operations: 2_000,
        optimisation: "-O0",
    };
    /// A few scenes, in each run.
    pub const FEW_SCENES: Self = Self {
        operations: 5_000,
        optimisation: "-O1",
    };
    /// Before a release.
    pub const RELEASE: Self = Self {
        operations: 10_000,
        optimisation: "-O1",
    };
}

/// States of each scene whose values are compared.
const STATES: u64 = 3;

/// The functions of a model that are not too long, as a module has them; of derivatives those that a compiler is done with soon.
pub fn functions(model: &Model) -> Vec<Function> {
    functions_with(model, Loops::default(), LONG)
}

/// The same with loops as said, and derivatives of fewer operations than `long`.
fn functions_with(model: &Model, loops: Loops, long: usize) -> Vec<Function> {
    let function = |kind: Kind| {
        let function = compile(model, kind, loops).ok()?.function;
        let derivatives = [
            Kind::ForwardDerivatives,
            Kind::InverseDerivatives,
            Kind::InverseMassMatrix,
        ];
        // Of second ones a few scenes tell as much.
        let second = [
            Kind::ForwardSecondDerivatives,
            Kind::InverseSecondDerivatives,
        ];
        let most = match kind {
            kind if derivatives.contains(&kind) => long,
            kind if second.contains(&kind) => long / 2,
            _ => usize::MAX,
        };
        let is_short = function.written() < most;
        is_short.then_some(function)
    };
    Kind::ALL.into_iter().filter_map(function).collect()
}

/// Whether the bits are the same; any NaN is as good as another.
pub fn same(a: &[f64], b: &[f64]) -> bool {
    let pairs = a.iter().zip(b);
    let mut same = pairs.map(|(a, b)| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan());
    a.len() == b.len() && same.all(|same| same)
}

/// Builds modules of all functions in `folder`, of derivatives to this extent: they have the bits of their evaluated lines, and the values of the tree. Returns how many functions are compared.
///
/// # Panics
/// Where one has not.
pub fn agree(folder: &Path, scenes: &[(Arc<Mechanism>, Model)], extent: Extent) -> usize {
    // As a module has them, and every other scene with all loops that there are, those over pairs of joints among them.
    let loops = [Loops::Long, Loops::Always];
    let models = scenes
        .iter()
        .map(|(_, model)| model)
        .zip(loops.into_iter().cycle());
    let functions = models.map(|(model, loops)| functions_with(model, loops, extent.operations));
    let functions: Vec<Vec<Function>> = functions.collect();
    let named = scenes.iter().zip(&functions).enumerate();
    let modules: Vec<Module<'_>> = named
        .map(|(i, ((_, model), functions))| Module {
            name: format!("scene_{i}"),
            model,
            functions,
            lanes: &[],
            kernels: &[],
            optimisation: extent.optimisation,
        })
        .collect();
    let count = functions.iter().map(Vec::len).sum();
    let Some(program) = Program::new(folder, &modules) else {
        return count;
    };
    let program = RefCell::new(program);
    for (i, (mechanism, model)) in scenes.iter().enumerate() {
        let others = Functions::new(model);
        let by = |(kind, loops): (Kind, Loops), q: &[f64], v: &[f64], u: &[f64]| {
            let mut compiled = functions[i].iter();
            // What would be too long is not in the module.
            let Some(function) = compiled.find(|one| one.name == kind.name()) else {
                return others.evaluate((kind, loops), q, v, u);
            };
            let given = |argument| match argument {
                Argument::Weights => &u[u.len() - v.len()..],
                Argument::Configuration => q,
                Argument::Speeds | Argument::Momenta => v,
                Argument::Efforts | Argument::Accelerations => u,
                // Of steps of motions alone.
                Argument::Given => &[],
            };
            let arguments = function.arguments.iter();
            let arguments = arguments.map(|&(one, size)| &given(one)[..size]);
            let arguments: Vec<&[f64]> = arguments.collect();
            let name = format!("scene_{i}");
            let found = program.borrow_mut().call(&name, function.name, &arguments);
            let expected = function.evaluate(|argument| given(argument).to_vec());
            assert!(
                same(&found, &expected),
                "{}, {kind:?}: {found:?} and {expected:?}",
                model.name
            );
            found
        };
        for seed in 0..STATES {
            let point = || {
                Point::random(model.clone(), mechanism, 100 * seed + i as u64)
                    .compiled_with(&[Loops::Long])
            };
            point().agrees_by(&by);
            let has = |kind: Kind| functions[i].iter().any(|one| one.name == kind.name());
            if has(Kind::ForwardDerivatives) && has(Kind::InverseDerivatives) {
                point().derivatives_agree_by(&by);
            }
            if has(Kind::ForwardSecondDerivatives) && has(Kind::InverseSecondDerivatives) {
                point().second_derivatives_agree_by(&by);
            }
        }
    }
    count
}
