//! The search for a place where a compiled kernel is not what the spec defines.
//!
//! Kernels are compared with their definitions in 256 bits (see [`accuracy`](crate::accuracy)), every entry in units of the largest
//! summand of its definition, and laws between them are checked at the same places:
//!
//! - **Parameters** are the joint's example, and values at and near the ends of every range, of both signs, from 1e-6 to 1e6 where a range
//!   has no end, on every side of each `require` function.
//! - **Configurations** are home and random points, one or more for each sign pattern of the `except` functions that is met, and lines
//!   through all of them: along each local coordinate, and along each stored scalar where the manifold is no group. Lines go 1e6
//!   far, on both sides of the exceptions that they cross.
//! - **Narrow features.** Kernels are run in numbers that note the arguments of their functions, divisors and comparisons. Where one of
//!   these changes sign or turns along a line (or along a range of a parameter), subdivision finds the place to the last digit, and
//!   kernels are compared there and on both flanks.
//!
//! **What is found for certain**: a feature of any width that is made by an exponential, logarithm, root, quotient, angle or comparison
//! which meets a line, where the argument is monotone between samples or has one extremum within three of them. Samples are 0.25 apart
//! up to 8 from the start of a line, and beyond in the ratio 1.5; of each argument the six nearest such places and the two farthest are
//! taken. A feature that no such function makes (a polynomial, a sine) is found where it is as wide as the samples are apart.

mod compare;
mod critical;
mod lines;
mod parameters;
mod plant;
mod subject;
mod traced;

pub use plant::{KERNELS, Plant, Planted, Where};

use crate::accuracy::{Definition, Worst};
use chacha20::ChaCha8Rng;
use compare::Definitions;
use hamel::joint::Joint;
use hamel_codegen::derived::{Derived, KernelKind};
use hamel_codegen::matrix::Matrix;
use hamel_codegen::model::{Declared, JointSpec};
use hamel_codegen::precise::Sampler;
use lines::{Direction, Place, samples};
use parameters::Axis;
use rand::{RngExt, SeedableRng};
use std::collections::BTreeMap;
use subject::{Build, Kernels, Sized};

/// In ulp of the largest summand. At random and extreme points kernels keep within 16 (see the accuracy suite); here they are looked at
/// where they change fastest, beside exceptions and at ends of ranges, where formulas that are equal differ by more of their
/// roundings: 2¹² ulp is 1e-12, still far below what a wrong formula makes.
const BOUND: f64 = 4096.0;
/// With a parameter r times as large or small as in the example, beside others that are not, kernels may lose r² of that: a formula that has
/// `a² (1 − c²)` in place of `a² s²` does. This much is always asked: 2⁻⁷ of the largest summand.
const LARGEST_SLACK: f64 = 3.5e13 / BOUND;
/// Random configurations that are drawn in search of sign patterns, and how many of one pattern are kept.
const DRAWN: usize = 12;
const OF_ONE_PATTERN: usize = 2;

/// How much is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Sets of parameters beside the example, at least, in whole rounds over the parameters.
    pub sets: usize,
    /// Lines at the example of the parameters, those through home first; at each other set a third of it.
    pub lines: usize,
    /// Critical places of a line, and of a range of a parameter.
    pub critical: usize,
    /// Samples of a line at which kernels are compared, at the example of the parameters.
    pub samples: usize,
    /// Cases that are compared at the example of the parameters; at each other set a tenth of it.
    pub cases: usize,
}

impl Effort {
    /// What a plain test takes: about a second a joint.
    pub const PLAIN: Self = Self {
        sets: 4,
        lines: 9,
        critical: 6,
        samples: 8,
        cases: 200,
    };
    /// What a plain test takes of a joint of relations, whose kernels solve equations. Its parameters are those of the example, and all lengths scaled.
    pub const RELATIONS: Self = Self {
        sets: 0,
        lines: 4,
        critical: 3,
        samples: 4,
        cases: 60,
    };
    /// What the sweep takes: minutes a joint.
    pub const SWEEP: Self = Self {
        sets: 64,
        lines: 60,
        critical: 48,
        samples: 200,
        cases: 20_000,
    };
}

/// What a search found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// The worst error of each kernel and law in ulp, and where.
    pub worst: Worst,
    /// Cases at which kernels were compared.
    pub cases: usize,
    /// Sign patterns of the `except` functions that were met, with how many cases each.
    pub patterns: BTreeMap<Vec<bool>, usize>,
    /// Sets of parameters.
    pub sets: usize,
}

impl Found {
    /// The kernels and laws that do not hold, with the error and the place.
    pub fn broken(&self) -> Vec<(&'static str, String)> {
        let errors = self.worst.errors.iter();
        let broken = errors.filter(|(_, (error, _))| error.is_nan() || *error > BOUND);
        broken
            .map(|(name, (error, place))| (*name, format!("{error:.1e} ulp, {place}")))
            .collect()
    }
}

/// Searches a joint that `build` makes of values of its parameters; `example` are such values.
pub fn search<J, const N: usize, const K: usize, const S: usize, const C: usize>(
    derived: &Derived,
    build: impl Fn(&[f64]) -> J,
    example: &[f64],
    effort: Effort,
) -> Found
where
    J: Joint<N, K, S, C>,
{
    let build =
        |values: &[f64]| -> Box<dyn Kernels> { Box::new(Sized::<J, N, K, S, C>(build(values))) };
    Search {
        derived: complete(derived),
        body: J::BODY,
        build: &build,
        effort,
        random: ChaCha8Rng::seed_from_u64(11),
        found: Found::default(),
    }
    .run(example)
}

/// Searches a joint, and holds what is found to the bound.
///
/// # Panics
/// With every kernel and law that does not hold, and where; where too little was met to say anything.
pub fn check_everywhere<J, const N: usize, const K: usize, const S: usize, const C: usize>(
    derived: &Derived,
    build: impl Fn(&[f64]) -> J,
    example: &[f64],
    effort: Effort,
) where
    J: Joint<N, K, S, C>,
{
    let found = search(derived, build, example, effort);
    let broken: Vec<String> = found
        .broken()
        .iter()
        .map(|(name, why)| format!("{}.{name}: {why}", J::NAME))
        .collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    let enough = effort.samples * K;
    assert!(
        found.cases >= enough,
        "{}: {} cases of {enough}",
        J::NAME,
        found.cases
    );
}

/// With the one of A and S̄ that the spec leaves to be derived: what follows from it is measured against its definition, and
/// it by AᵀS̄ = 0.
fn complete(derived: &Derived) -> Derived {
    let mut complete = derived.clone();
    let of = |kind: KernelKind| -> Option<Declared<Matrix>> {
        let kernel = derived.kernel(kind)?;
        let value = kernel.expanded().into_iter().next()?;
        Some(Declared { value, span: 0..0 })
    };
    if derived.shape.constraints > 0 {
        let spec = &mut complete.spec;
        spec.speed_basis = spec
            .speed_basis
            .take()
            .or_else(|| of(KernelKind::SpeedBasis));
        spec.constraint = spec
            .constraint
            .take()
            .or_else(|| of(KernelKind::Constraint));
    }
    complete
}

/// How much more than usual kernels may lose, by how far ratios of the parameters are from those of the example: of lengths to each other,
/// of all others to 1.
fn slack(spec: &JointSpec, parameters: &[f64], example: &[f64]) -> f64 {
    let ratios = parameters.iter().zip(example).map(|(p, e)| (p / e).abs());
    let lengths = spec
        .parameters
        .iter()
        .all(|parameter| parameter.unit == "m");
    let start = if lengths {
        (f64::INFINITY, 0.0_f64)
    } else {
        (1.0, 1.0)
    };
    let (least, most) = ratios.fold(start, |(least, most), r| (least.min(r), most.max(r)));
    let ratio = (most / least.max(f64::MIN_POSITIVE)).max(1.0);
    (ratio * ratio).min(LARGEST_SLACK)
}

struct Search<'a> {
    derived: Derived,
    /// Which of its bodies the kernels are those of.
    body: usize,
    build: Build<'a>,
    effort: Effort,
    random: ChaCha8Rng,
    found: Found,
}

impl Search<'_> {
    fn run(mut self, example: &[f64]) -> Found {
        let whole = self.effort;
        let part = Effort {
            lines: whole.lines.div_ceil(3),
            samples: whole.samples.div_ceil(4),
            cases: whole.cases.div_ceil(8),
            ..whole
        };
        self.at(example, example, whole);
        for set in self.sets(example) {
            self.at(&set, example, part);
        }
        self.found
    }

    /// Sets of parameters beside the example, from all axes in turn.
    fn sets(&mut self, example: &[f64]) -> Vec<Vec<f64>> {
        let definition = Definition::new(&self.derived, self.body, example);
        let mut notes = |values: &[f64]| {
            let joint = (self.build)(values);
            let place = Place {
                joint: &*joint,
                definition: &definition,
                parameters: values,
                slack: 1.0,
            };
            let (home, k) = (joint.home(), definition.freedoms());
            let away: Vec<f64> = (0..k).map(|i| 0.3 + 0.2 * i as f64).collect();
            let there = joint.retract(&home, &away);
            [home, there].map(|q| joint.notes(&place.still(q))).concat()
        };
        let spec = &self.derived.spec;
        let wanted = match self.effort.sets {
            0 => 0,
            _ => example.len(),
        };
        let axes = (0..wanted).map(|index| Axis {
            spec,
            start: example,
            index,
        });
        let mut axes: Vec<_> = axes
            .map(|axis| axis.sets(&mut notes, self.effort.critical).into_iter())
            .collect();
        let mut sets = vec![];
        while sets.len() < self.effort.sets {
            let before = sets.len();
            sets.extend(axes.iter_mut().filter_map(Iterator::next));
            if sets.len() == before {
                break;
            }
        }
        // All lengths a thousand times as large or small, at the same ratios.
        let scaled =
            [1e-3, 1e3].map(|factor| example.iter().map(|x| factor * x).collect::<Vec<f64>>());
        let scaled = scaled
            .into_iter()
            .filter(|values| !values.is_empty() && parameters::allowed(spec, values));
        sets.into_iter().chain(scaled).collect()
    }

    /// The kernels with these parameters.
    fn at(&mut self, parameters: &[f64], example: &[f64], effort: Effort) {
        let joint = (self.build)(parameters);
        let definition = Definition::new(&self.derived, self.body, parameters);
        let slack = slack(&self.derived.spec, parameters, example);
        let place = Place {
            joint: &*joint,
            definition: &definition,
            parameters,
            slack,
        };
        self.found.sets += 1;
        let bases = self.bases(&place);
        let lines = bases
            .iter()
            .flat_map(|base| place.directions().into_iter().map(move |d| (base, d)));
        let lines: Vec<(&Vec<f64>, Direction)> = lines.take(effort.lines).collect();
        let of_line = effort.cases.div_ceil(lines.len().max(1));
        for base in &bases {
            self.compare(&place, base.clone());
        }
        for (base, direction) in lines {
            for t in self
                .places(&place, base, direction, effort.samples)
                .into_iter()
                .take(of_line)
            {
                self.compare(&place, place.configuration(base, direction, t));
            }
        }
    }

    /// Places along a line: some samples, and critical ones with their flanks.
    fn places(
        &mut self,
        place: &Place,
        base: &[f64],
        direction: Direction,
        count: usize,
    ) -> Vec<f64> {
        let critical = place.critical(base, direction, self.effort.critical);
        let flanks = critical
            .into_iter()
            .flat_map(|c| [c.at, c.at - c.width, c.at + c.width]);
        let all = samples();
        let every = (all.len() / count.max(1)).max(1);
        let first = self.random.random_range(0..every);
        let sampled: Vec<f64> = all.iter().skip(first).step_by(every).copied().collect();
        sampled.into_iter().chain(flanks).collect()
    }

    /// Configurations to start lines from: home, and some of each sign pattern that random points meet.
    fn bases(&mut self, place: &Place) -> Vec<Vec<f64>> {
        let space = place.definition.space();
        let coordinates = space.manifold.coordinates();
        let mut samplers = [
            Sampler::new(space, 64).single(),
            Sampler::new(space, 64).single().far(),
        ];
        let mut bases = vec![place.joint.home()];
        let mut met: BTreeMap<Vec<bool>, usize> = BTreeMap::new();
        for n in 0..DRAWN {
            let Some(point) = samplers[n % 2].point() else {
                continue;
            };
            let q: Vec<f64> = coordinates
                .iter()
                .map(|symbol| point.value(symbol).to_f64())
                .collect();
            let Some(signs) = place.signs(&q) else {
                continue;
            };
            let count = met.entry(signs).or_default();
            *count += 1;
            if *count <= OF_ONE_PATTERN {
                bases.push(q);
            }
        }
        bases
    }

    fn compare(&mut self, place: &Place, q: Vec<f64>) {
        let Some(signs) = place.signs(&q) else { return };
        let case = place.case(q, &mut self.random);
        if let Some(definitions) = Definitions::new(place.definition, &case) {
            definitions.measure(place, &mut self.found.worst);
            self.found.cases += 1;
            *self.found.patterns.entry(signs).or_default() += 1;
        }
    }
}
