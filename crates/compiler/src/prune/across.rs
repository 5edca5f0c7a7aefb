//! Inertias that do not affect a joint, of all its bodies together.
//!
//! Let N_b be an inertia of body b in the parent's frame, and X_b the body's twist map there. A set of them does not affect the joint where
//!
//! ```text
//! Σ N_b is constant,   Σ N_b X_b = 0,   Σ X_bᵀ N_b X_b = 0,
//! ```
//!
//! and on the world, which does not move, already where the last one holds and the potential energy is constant. That is linear in ten parameters a body. The conditions are written down at
//! random configurations in 128 bits, until further configurations say nothing new. What meets them there meets them everywhere, unless a non-zero analytic function vanished at random
//! points to 64 bits. Curves are analytic between their knots alone: joints with curves take what each body has for itself.

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
const BITS: usize = 128;
/// Configurations at most; after two that say nothing new no more are asked for.
const SAMPLES: usize = 16;
const IN_VAIN: usize = 2;

/// Inertias of the bodies of a joint, in their child frames.
pub type Element = Vec<Inertia>;

/// A basis of the inertias that do not affect the joint under its first body.
pub(super) fn basis(model: &Model, first: usize) -> Vec<Element> {
    let bodies = &model.bodies[model.carried(first)];
    let alone = bodies.len() == 1 || !bodies[0].joint.derived.spec.curves.is_empty();
    let hanging = bodies.iter().any(|body| body.joint.chain.is_some());
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
            all
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
        let sampler = Sampler::new(&bodies[0].joint.derived.space, BITS).single();
        let mut sampler = sampler.with_parameters(bodies[0].parameters.clone());
        let mut echelon = Echelon::new(10 * bodies.len());
        let mut start: Option<Vec<Vec<Precise>>> = None;
        let mut in_vain = 0;
        for _ in 0..SAMPLES {
            let point = sampler.point()?;
            let samples = bodies.iter().zip(&self.placements);
            let samples: Vec<Sample> = samples
                .map(|(body, placement)| Sample::new(body, placement, point.clone()))
                .collect();
            let constant = constants(&samples, self.gravity.as_ref());
            let start = start.get_or_insert_with(|| constant.clone());
            let changes = constant.iter().zip(&*start).map(|(row, start)| {
                let pairs = row.iter().zip(start);
                pairs.map(|(a, b)| a - b).collect()
            });
            let changes: Vec<Vec<Precise>> = changes.collect();
            let vanishing = vanishing(&samples, self.gravity.is_some());
            let rows = changes.iter().chain(&vanishing);
            let news = rows.filter(|row| echelon.add(row)).count();
            in_vain = if news == 0 { in_vain + 1 } else { 0 };
            if in_vain == IN_VAIN {
                let basis = echelon.null_space();
                return Some(basis.iter().map(|all| element(all)).collect());
            }
        }
        None
    }
}

fn element(parameters: &[f64]) -> Element {
    let of_body = |own: &[f64]| Inertia::from_parameters(&std::array::from_fn(|i| own[i]));
    parameters.chunks(10).map(of_body).collect()
}

/// What must not depend on the configuration, by parameters: Σ N_b, or on the world the potential energy.
fn constants(samples: &[Sample], gravity: Option<&Vector3<f64>>) -> Vec<Vec<Precise>> {
    match gravity {
        None => (0..10)
            .map(|row| columns(samples, |sample, n| sample.in_parent(n)[row].clone()))
            .collect(),
        Some(gravity) => vec![columns(samples, |sample, n| {
            let first = &sample.in_parent(n)[1..4];
            let gravity = gravity.iter().map(|&g| Precise::from_f64(g, BITS));
            gravity.zip(first).fold(zero(), |sum, (g, c)| sum + &g * c)
        })],
    }
}

/// What must be zero, by parameters: Σ N_b X_b, unless on the world, and Σ X_bᵀ N_b X_b.
fn vanishing(samples: &[Sample], on_world: bool) -> Vec<Vec<Precise>> {
    let count = samples[0].twists.len();
    let mut rows = vec![];
    for j in 0..count {
        if !on_world {
            rows.extend((0..6).map(|row| {
                columns(samples, |sample, n| {
                    sample.wrench_on_parent(n, j)[row].clone()
                })
            }));
        }
        rows.extend((j..count).map(|k| columns(samples, |sample, n| sample.power(n, j, k))));
    }
    rows
}

/// A row: a number for each of the ten parameters of each body.
fn columns(samples: &[Sample], number: impl Fn(&Sample, usize) -> Precise) -> Vec<Precise> {
    let entries = samples
        .iter()
        .flat_map(|sample| (0..10).map(move |n| (sample, n)));
    entries.map(|(sample, n)| number(sample, n)).collect()
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
