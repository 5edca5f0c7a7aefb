//! Inertias that do not affect a joint, of all its bodies together.
//!
//! Let N_b be an inertia of body b in the parent's frame, and X_b the body's twist map there. A set of them does not affect the joint where
//!
//! ```text
//! Σ N_b is constant,   Σ N_b X_b = 0,   Σ X_bᵀ N_b X_b = 0,
//! ```
//!
//! and on the world, which does not move, already where the last one holds and the potential energy is constant. That is linear in ten parameters a body. The conditions are written down at
//! random configurations in 192 bits, in units of length of the size of the joint and with twists of size 1, until further configurations say nothing new. What meets them there meets them everywhere, unless a non-zero analytic function vanished at random
//! points to 64 bits. Where relations define the joint that holds of each part of its manifold by itself: a parallelogram can be assembled crossed as well, beyond where it folds flat. Such parts are looked for far from
//! home and beside the loci, and an inertia is left out where it affects none of them. Curves are analytic between their knots alone: joints with curves take what each body has for itself.

use crate::model::{Body, Inertia, Model};
use hamel_codegen::precise::{Point, Precise, Sampler};
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;
use num_traits::ToPrimitive;

mod echelon;
mod sample;

use echelon::Echelon;
use sample::Sample;

/// Bits of the numbers.
const BITS: usize = 192;
/// What is below this part of the largest entry, as a power of two, is rounding.
const ROUNDING: f64 = -64.0;
/// Configurations at most; after two that say nothing new no more are asked for.
const SAMPLES: usize = 16;
const IN_VAIN: usize = 2;
/// Configurations far from home, of which about every other one lies beyond a locus.
const FAR: usize = 12;

/// Inertias that do not affect a joint together.
#[derive(Clone, Debug)]
pub struct Element {
    /// Of each body, in its child frame.
    pub bodies: Vec<Inertia>,
    /// Their sum in the joint's parent frame as its first body sees it, constant on the relations of the joint alone, if at all; on the world its first moment along gravity is. Where each body has its own
    /// for itself, its part is constant in every pose.
    pub sum: Option<Inertia>,
    /// The unit of length of both, m.
    pub unit: f64,
}

/// A basis of the inertias that do not affect the joint under its first body.
pub(super) fn basis(model: &Model, first: usize) -> Vec<Element> {
    let bodies = &model.bodies[model.carried(first)];
    let alone = bodies.len() == 1 || !bodies[0].joint.derived.spec.curves.is_empty();
    let hanging = bodies.iter().any(|body| body.joint.linkage.is_some());
    match alone || hanging {
        true => of_each(bodies),
        false => of_all(model, bodies).unwrap_or_else(|| of_each(bodies)),
    }
}

/// What each body has for itself, as the generator proved it.
fn of_each(bodies: &[Body]) -> Vec<Element> {
    let of_body = |(index, body): (usize, &Body)| {
        let elements = body.joint.derived.unidentifiable.iter();
        let element = move |element: &[hamel_codegen::expr::Rational; 10]| {
            let parameters = std::array::from_fn(|i| element[i].to_f64().unwrap_or(0.0));
            let mut all = vec![Inertia::zero(); bodies.len()];
            all[index] = Inertia::from_moments_of_inertia(&parameters);
            Element {
                bodies: all,
                sum: None,
                unit: 1.0,
            }
        };
        elements.map(element).collect::<Vec<_>>()
    };
    bodies.iter().enumerate().flat_map(of_body).collect()
}

/// What all have together, worked out once for a joint type with these numbers; `None` where no configuration is found.
fn of_all(model: &Model, bodies: &[Body]) -> Option<Vec<Element>> {
    let first = &bodies[0];
    let frame = &first.placement;
    let relative = |body: &Body| match body.placement == *frame {
        true => Pose::identity(),
        false => frame.inverse().compose(&body.placement),
    };
    let question = Question {
        placements: bodies.iter().map(relative).collect(),
        gravity: match first.parent {
            None => Some(frame.rotation.transpose() * model.gravity),
            Some(_) => None,
        },
    };
    let key = question.key(&first.parameters);
    if let Some(known) = first.joint.across.borrow().get(&key) {
        return known.clone();
    }
    let found = question.answer(bodies);
    let mut known = first.joint.across.borrow_mut();
    known.entry(key).or_insert(found).clone()
}

/// Which inertias do not affect a joint, in its parent frame as its first body sees it.
struct Question {
    /// The joint's parent frame as each body sees it.
    placements: Vec<Pose<f64>>,
    /// Of a joint on the world.
    gravity: Option<Vector3<f64>>,
}

impl Question {
    /// All numbers on which the answer depends.
    fn key(&self, parameters: &[f64]) -> Vec<u64> {
        let placements = self.placements.iter().flat_map(|pose| {
            let translation = pose.translation.iter();
            pose.rotation.iter().chain(translation)
        });
        let gravity = self.gravity.iter().flatten();
        let numbers = parameters.iter().chain(placements).chain(gravity);
        numbers.map(|number| number.to_bits()).collect()
    }

    fn answer(&self, bodies: &[Body]) -> Option<Vec<Element>> {
        let space = &bodies[0].joint.derived.space;
        let sampler = || {
            let sampler = Sampler::new(space, BITS).single();
            sampler.with_parameters(bodies[0].parameters.clone())
        };
        let mut near = sampler();
        let unit = self.unit(bodies, &near.point()?);
        let sampled = |point: &Point| {
            let samples = bodies.iter().zip(&self.placements);
            let mut samples: Vec<Sample> = samples
                .map(|(body, placement)| Sample::new(body, placement, point.clone(), unit))
                .collect();
            even(&mut samples);
            samples
        };
        let first = sampled(&near.point()?);
        let mut conditions = Conditions::new(self.gravity.as_ref(), &first);
        if !space.manifold.declared().is_empty() {
            let mut far = sampler().far();
            let points = std::iter::repeat_with(|| far.point()).take(FAR);
            points
                .flatten()
                .for_each(|point| _ = conditions.add(&sampled(&point)));
        }
        let mut in_vain = 0;
        for _ in 0..SAMPLES {
            let is_new = conditions.add(&sampled(&near.point()?));
            in_vain = if is_new { 0 } else { in_vain + 1 };
            if in_vain == IN_VAIN {
                let basis = conditions.echelon.null_space().into_iter();
                return Some(basis.map(|own| element(&own, &first, unit)).collect());
            }
        }
        None
    }

    /// A power of two as large as the distances of the bodies' frames, m.
    fn unit(&self, bodies: &[Body], point: &Point) -> f64 {
        let samples = bodies.iter().zip(&self.placements);
        let distances = samples
            .map(|(body, placement)| Sample::new(body, placement, point.clone(), 1.0).distance());
        match distances.fold(0.0, f64::max) {
            0.0 => 1.0,
            distance => distance.log2().round().exp2(),
        }
    }
}

/// The conditions on inertias at the configurations that have been looked at.
struct Conditions<'a> {
    gravity: Option<&'a Vector3<f64>>,
    /// What is constant, where it was seen first.
    first: Vec<Vec<Precise>>,
    echelon: Echelon,
}

impl<'a> Conditions<'a> {
    /// Those at a first configuration.
    fn new(gravity: Option<&'a Vector3<f64>>, samples: &[Sample]) -> Self {
        let mut conditions = Self {
            gravity,
            first: constants(samples, gravity),
            echelon: Echelon::new(10 * samples.len()),
        };
        conditions.add(samples);
        conditions
    }

    /// Adds those at another configuration, and says whether they are new.
    fn add(&mut self, samples: &[Sample]) -> bool {
        let constant = constants(samples, self.gravity);
        let vanishing = vanishing(samples, self.gravity.is_some());
        let size = constant.iter().chain(&vanishing).flatten().map(size);
        let size = size.fold(f64::NEG_INFINITY, f64::max);
        let changes = constant.iter().zip(&self.first).map(|(row, first)| {
            let pairs = row.iter().zip(first);
            pairs.map(|(a, b)| a - b).collect()
        });
        let changes: Vec<Vec<Precise>> = changes.collect();
        let rows = changes.iter().chain(&vanishing);
        rows.filter(|row| self.echelon.add(row, size)).count() > 0
    }
}

/// Makes each twist of size 1 over all bodies: v may have any unit.
fn even(samples: &mut [Sample]) {
    for j in 0..samples[0].twists.len() {
        let sizes = samples.iter().map(|sample| sample.size(j));
        let largest = sizes.fold(f64::NEG_INFINITY, f64::max);
        if largest.is_finite() {
            samples
                .iter_mut()
                .for_each(|sample| sample.lessen(j, largest.round() as i32));
        }
    }
}

/// An element by the parameters of all bodies in units of length of `unit` metres, with its sum at one configuration.
fn element(parameters: &[Precise], places: &[Sample], unit: f64) -> Element {
    let in_parent = rows(places, Sample::in_parent);
    let of_parent = |row: usize| {
        let products = in_parent[row].iter().zip(parameters).map(|(a, b)| a * b);
        in_doubles(&products.fold(zero(), |sum, product| sum + product))
    };
    let of_body =
        |own: &[Precise]| Inertia::from_parameters(&std::array::from_fn(|i| in_doubles(&own[i])));
    Element {
        bodies: parameters.chunks(10).map(of_body).collect(),
        sum: Some(Inertia::from_parameters(&std::array::from_fn(of_parent))),
        unit,
    }
}

/// What is left of zeros is far below doubles.
fn in_doubles(entry: &Precise) -> f64 {
    match size(entry) < ROUNDING {
        true => 0.0,
        false => entry.to_f64(),
    }
}

/// What must not depend on the configuration, by parameters: Σ N_b, or on the world the potential energy.
fn constants(samples: &[Sample], gravity: Option<&Vector3<f64>>) -> Vec<Vec<Precise>> {
    let Some(gravity) = gravity else {
        return rows(samples, Sample::in_parent);
    };
    // Its direction alone counts.
    let size = gravity.amax().max(f64::MIN_POSITIVE);
    let gravity: Vec<Precise> = gravity
        .iter()
        .map(|&g| Precise::from_f64(g / size, BITS))
        .collect();
    rows(samples, |sample, n| {
        let first = &sample.in_parent(n)[1..4];
        let products = gravity.iter().zip(first);
        [products.fold(zero(), |sum, (g, c)| sum + g * c)]
    })
}

/// What must be zero, by parameters: Σ N_b X_b, unless on the world, and Σ X_bᵀ N_b X_b.
fn vanishing(samples: &[Sample], on_world: bool) -> Vec<Vec<Precise>> {
    let count = samples[0].twists.len();
    let mut all = vec![];
    for j in 0..count {
        if !on_world {
            all.extend(rows(samples, |sample, n| sample.wrench_on_parent(n, j)));
        }
        for k in j..count {
            all.extend(rows(samples, |sample, n| [sample.power(n, j, k)]));
        }
    }
    all
}

/// Rows of a matrix that has a column for each of the ten parameters of each body.
fn rows<const ROWS: usize>(
    samples: &[Sample],
    column: impl Fn(&Sample, usize) -> [Precise; ROWS],
) -> Vec<Vec<Precise>> {
    let mut rows = vec![Vec::with_capacity(10 * samples.len()); ROWS];
    for sample in samples {
        for n in 0..10 {
            for (row, entry) in rows.iter_mut().zip(column(sample, n)) {
                row.push(entry);
            }
        }
    }
    rows
}

/// Its binary logarithm.
fn size(entry: &Precise) -> f64 {
    match entry.is_zero() {
        true => f64::NEG_INFINITY,
        false => entry.abs().log2(),
    }
}

fn zero() -> Precise {
    Precise::integer(0, BITS)
}

/// The values of expressions that hold names, each after those in its own.
fn named(body: &Body, mut point: Point) -> Point {
    for word in &body.joint.derived.named {
        let value = point.evaluate(&word.value);
        point.bind(&word.symbol, value);
    }
    point
}
