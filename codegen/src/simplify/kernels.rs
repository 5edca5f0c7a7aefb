//! The kernels of a joint in the words of its author.

use super::twists;
use super::views::Written;
use super::words::{Words, opened};
use crate::expand::{self, Expansion};
use crate::expr::{Expr, Symbol, budget};
use crate::formula::names::NameSet;
use crate::formula::{Counts, Program};
use crate::kernel::{Kernel, KernelKind, Method, Step, Word};
use crate::manifold::weight;
use crate::matrix::Matrix;
use crate::prepare::Prepared;
use std::collections::{BTreeMap, BTreeSet};

/// Kernels of which every entry is shortened.
const SHORTENED: [KernelKind; 13] = [
    KernelKind::Pose,
    KernelKind::TwistMap,
    KernelKind::TwistMapChild,
    KernelKind::VelocityMap,
    KernelKind::VelocityMapInverse,
    KernelKind::Constraint,
    KernelKind::SpeedBasis,
    KernelKind::VelocityMapGradient,
    KernelKind::PortMap,
    KernelKind::Pins,
    KernelKind::ConfigurationRate,
    KernelKind::Gamma,
    KernelKind::J22,
];

/// The kernels in words, and the words that they use.
pub(super) fn shortened(
    joint: &Prepared,
    expansion: &Expansion,
    mut words: Words<'_>,
    kernels: Vec<Kernel>,
) -> Written {
    let twists = twists::of_pose(joint, expansion, &mut words);
    let shortened = kernels.into_iter().map(|mut kernel| {
        if let Some(outputs) = declared(joint, kernel.kind) {
            kernel.outputs = as_declared(&words, &outputs);
            return kernel;
        }
        match twists.of(kernel.kind) {
            Some(map) => twists::shorter(&words, kernel, map),
            None => base(&words, kernel),
        }
    });
    let mut named: Vec<Kernel> = shortened.collect();
    let [child, basis] = [KernelKind::TwistMapChild, KernelKind::SpeedBasis];
    let speed_map = output(&named, child).times(&output(&named, basis));
    for (of, gradient) in GRADIENTS {
        let map = output(&named, of);
        if let Some(target) = named.iter_mut().find(|kernel| kernel.kind == gradient) {
            *target = shortest_gradient(&mut words, &map, target);
        }
    }
    let is_gradient = |kind| GRADIENTS.iter().any(|(_, gradient)| *gradient == kind);
    let finished = named
        .into_iter()
        .map(|kernel| match is_gradient(kernel.kind) {
            true => kernel,
            false => with_lines(&words, kernel),
        });
    let mut kernels: Vec<Kernel> = finished.collect();
    kernels.extend(super::bias::kernels(joint, expansion, &words, &speed_map));
    with_used(kernels, &words)
}

/// The kernels in order, and the words that they use.
fn with_used(mut kernels: Vec<Kernel>, words: &Words<'_>) -> Written {
    kernels.sort_by_key(|kernel| kernel.kind);
    let used = kernels.iter().flat_map(|kernel| &kernel.steps);
    let used: BTreeSet<&Symbol> = used.flat_map(Step::bound).collect();
    let words = words.words().iter();
    let words = words.filter(|word| used.contains(&word.symbol)).cloned();
    let words = words.collect();
    (kernels, words)
}

/// The kernels as they were derived, with c and its dual.
pub(super) fn as_derived(
    joint: &Prepared,
    expansion: &Expansion,
    kernels: Vec<Kernel>,
    words: &Words<'_>,
) -> Written {
    let map = expand::speed_map(joint, expansion);
    let kernels = kernels.into_iter();
    let mut kernels: Vec<Kernel> = kernels.map(|kernel| with_lines(words, kernel)).collect();
    kernels.extend(super::bias::kernels(joint, expansion, words, &map));
    with_used(kernels, words)
}

/// Derivatives, and what they are of.
const GRADIENTS: [(KernelKind, KernelKind); 2] = [
    (KernelKind::TwistMapChild, KernelKind::TwistMapChildGradient),
    (KernelKind::SpeedBasis, KernelKind::SpeedBasisGradient),
];

/// The slices of a gradient: by the chain rule through the words of the map, or as they were derived.
fn shortest_gradient(words: &mut Words<'_>, map: &Matrix, kernel: &Kernel) -> Kernel {
    let mut by_chain_rule = kernel.clone();
    for (k, slice) in by_chain_rule.outputs.iter_mut().enumerate() {
        if !slice.is_zero() {
            let moved = words.along_each(map, k);
            let mut moved = moved.entries().iter();
            // What is known to vanish does so whatever the names.
            *slice = slice.map(|entry| match (entry.is_zero(), moved.next()) {
                (false, Some(moved)) => moved.clone(),
                _ => Expr::zero(),
            });
        }
    }
    let few = words.functions_alone();
    let shortened = |words: &Words<'_>| {
        let mut kernel = kernel.clone();
        let short = kernel.outputs.iter().map(|slice| words.shorten_each(slice));
        kernel.outputs = short.collect();
        with_lines(words, kernel)
    };
    let first = with_lines(words, by_chain_rule);
    match terms(&kernel.outputs) > LONG {
        true => first,
        false => {
            let others = [words, &few].map(|words| alternative(|| shortened(words)));
            least_work(first, others.into_iter().flatten())
        }
    }
}

/// Terms beyond which another way to write a kernel is not tried: it would hardly be shorter, and takes long to find.
pub(super) const LONG: usize = 120;

/// All terms of matrices, multiplied out.
pub(super) fn terms(matrices: &[Matrix]) -> usize {
    let entries = matrices.iter().flat_map(Matrix::entries);
    entries.map(|entry| opened(entry).terms().len()).sum()
}

/// Most term operations for another way to write a kernel.
const ALTERNATIVE: u64 = 300_000;

/// Another way to write a kernel, unless it is long to find.
pub(super) fn alternative<T>(make: impl FnOnce() -> T) -> Option<T> {
    budget::scope(ALTERNATIVE, make).ok()
}

/// The kernel, or one of the other ways to write it where that takes less work.
pub(super) fn least_work(first: Kernel, others: impl IntoIterator<Item = Kernel>) -> Kernel {
    // Where the work is the same, fewer operations are: what is not written as a multiply–add here may be one in a scene.
    let work = |kernel: &Kernel| {
        let program = Program::new(&kernel.steps, &kernel.outputs, &NameSet::default());
        let counts = Counts::of_program(&program);
        (counts.work(), counts.total())
    };
    let mut ways = vec![first];
    // Different ways often lead to the same kernel.
    for other in others {
        if !ways.contains(&other) {
            ways.push(other);
        }
    }
    if ways.len() == 1 {
        return ways.remove(0);
    }
    // Of equally short ones the first.
    let least = ways.iter().enumerate().min_by_key(|(_, way)| work(way));
    let least = least.map_or(0, |(n, _)| n);
    ways.swap_remove(least)
}

fn output(kernels: &[Kernel], kind: KernelKind) -> Matrix {
    let kernel = kernels.iter().find(|kernel| kernel.kind == kind);
    kernel
        .and_then(|kernel| kernel.outputs.first().cloned())
        .unwrap_or_else(|| Matrix::zeros(0, 0))
}

/// A kernel with every entry shortened, where it is one of these; others as they are.
pub(super) fn base(words: &Words<'_>, mut kernel: Kernel) -> Kernel {
    if kernel.method == Method::Formula && SHORTENED.contains(&kernel.kind) {
        let short = kernel.outputs.iter().map(|m| words.shorten_each(m));
        kernel.outputs = short.collect();
    }
    kernel
}

/// As the author writes it, unless there is a form that is clearly shorter.
fn as_declared(words: &Words<'_>, outputs: &[Matrix]) -> Vec<Matrix> {
    let entry = |entry: &Expr| {
        let short = words.shorten(entry);
        match weight(&short) + 1 < weight(entry) {
            true => short,
            false => entry.clone(),
        }
    };
    outputs.iter().map(|output| output.map(entry)).collect()
}

/// The matrices that the spec declares of a kernel, in the names that it uses.
fn declared(joint: &Prepared, kind: KernelKind) -> Option<Vec<Matrix>> {
    let worded = &joint.spec.worded;
    match kind {
        KernelKind::Pose => {
            let pose = worded.poses.first().cloned()?;
            Some(vec![pose.rotation, pose.translation])
        }
        KernelKind::TwistMap => Some(vec![worded.twist_map.clone()?]),
        KernelKind::Constraint => Some(vec![worded.constraint.clone()?]),
        KernelKind::SpeedBasis => Some(vec![worded.speed_basis.clone()?]),
        _ => None,
    }
}

/// The kernel with a line for each word that it uses; derivatives that are used once, and names for other symbols, stand in their place.
pub(super) fn with_lines(words: &Words<'_>, mut kernel: Kernel) -> Kernel {
    let mut lines: Vec<Word> = vec![];
    for word in words.words().iter().rev() {
        let uses = uses(&word.symbol, &kernel, &lines);
        if uses == 0 {
            continue;
        }
        if word.is_derivative() && uses == 1 || words.is_another_name(word) {
            let value = BTreeMap::from([(word.symbol.clone(), word.value.clone())]);
            put_in(&mut kernel, &mut lines, &value);
            continue;
        }
        lines.push(word.clone());
    }
    let lines = lines.into_iter().rev();
    let lines = lines.map(|word| Step::Let(word.symbol, word.value));
    kernel.steps = lines.chain(kernel.steps).collect();
    kernel
}

fn uses(symbol: &Symbol, kernel: &Kernel, lines: &[Word]) -> usize {
    let outputs = kernel.outputs.iter().flat_map(Matrix::entries);
    let steps = kernel.steps.iter().flat_map(|step| match step {
        Step::Let(_, value) => vec![value],
        Step::Call { argument, .. } => argument.entries().iter().collect(),
    });
    let all = outputs
        .chain(steps)
        .chain(lines.iter().map(|word| &word.value));
    all.filter(|entry| entry.contains(symbol)).count()
}

fn put_in(kernel: &mut Kernel, lines: &mut [Word], value: &BTreeMap<Symbol, Expr>) {
    for output in &mut kernel.outputs {
        *output = output.map(|entry| entry.substitute(value));
    }
    for step in &mut kernel.steps {
        match step {
            Step::Let(_, bound) => *bound = bound.substitute(value),
            Step::Call { argument, .. } => {
                *argument = argument.map(|entry| entry.substitute(value));
            }
        }
    }
    for word in lines {
        word.value = word.value.substitute(value);
    }
}
