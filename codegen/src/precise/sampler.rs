//! Random points of a joint's manifold.

use super::linear::shortest_solution;
use super::start::Draw;
use super::{Point, Precise};
use crate::expr::{Expr, Symbol};
use crate::model::JointSpec;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Draws before a point is given up: a random point misses what a joint forbids about every other time.
const ATTEMPTS: usize = 64;
/// Newton's method doubles the digits: from 2⁻¹ to 2⁻⁵¹² in ten steps, and as many more to come near.
const NEWTON_STEPS: usize = 30;
/// How far from home a point of declared relations is looked for, in every stored scalar.
const REACH: f64 = 0.75;
/// Bits that rounding may cost a relation of some dozen terms of order 1 to 10.
const ROUNDING_BITS: usize = 24;
/// Smallest value of a function of a locus: points are drawn where kernels mean something.
const DISTANCE: f64 = 1.0 / 64.0;

/// A deterministic source of random points of one joint.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    spec: &'a JointSpec,
    draw: Draw,
    /// The relations and their derivatives by the stored scalars, row by row; empty where every factor is sampled as it is.
    relations: Vec<(Expr, Vec<Expr>)>,
}

impl<'a> Sampler<'a> {
    /// Points of the joint in numbers of `bits` bits, the same in every run.
    pub fn new(spec: &'a JointSpec, bits: usize) -> Self {
        let manifold = &spec.manifold.value;
        let relations = match manifold.declared().is_empty() {
            true => vec![],
            false => manifold.relations(),
        };
        let coordinates = manifold.coordinates();
        let with_slopes = |relation: Expr| {
            let slopes = coordinates
                .iter()
                .map(|coordinate| relation.derivative(coordinate))
                .collect();
            (relation, slopes)
        };
        Self {
            spec,
            draw: Draw {
                random: ChaCha8Rng::seed_from_u64(1),
                bits,
            },
            relations: relations.into_iter().map(with_slopes).collect(),
        }
    }

    /// The next point; `None` where none was found that keeps every range, requirement, relation and locus.
    pub fn point(&mut self) -> Option<Point> {
        (0..ATTEMPTS).find_map(|_| self.attempt())
    }

    fn attempt(&mut self) -> Option<Point> {
        let mut point = Point::new(self.draw.random.next_u64(), self.draw.bits);
        for parameter in &self.spec.parameters {
            point.bind(&parameter.symbol, self.draw.parameter(&parameter.range));
        }
        let holds = |value: &Expr| point.evaluate(value).to_f64() > 0.0;
        if !self.spec.requirements.iter().all(|r| holds(&r.value.value)) {
            return None;
        }
        let manifold = &self.spec.manifold.value;
        let coordinates = manifold.coordinates();
        let target: Vec<Symbol> = manifold
            .target()
            .into_iter()
            .flat_map(|factor| factor.coordinates)
            .collect();
        let second = self.configuration(&point, &coordinates)?;
        let first = self.configuration(&point, &coordinates)?;
        bind_all(&mut point, &target, second);
        bind_all(&mut point, &coordinates, first);
        Some(point)
    }

    /// A configuration on the manifold and away from the loci.
    fn configuration(&mut self, point: &Point, coordinates: &[Symbol]) -> Option<Vec<Precise>> {
        let manifold = &self.spec.manifold.value;
        let mut at = point.clone();
        if self.relations.is_empty() {
            for factor in manifold.factors() {
                let element = self.draw.element(factor.kind);
                bind_all(&mut at, &factor.coordinates, element);
            }
        } else {
            let home = self.home(point);
            let start = self.draw.near(&home, REACH);
            bind_all(&mut at, coordinates, start);
            self.to_manifold(&mut at, coordinates)?;
        }
        let far = |function: &Expr| at.evaluate(function).to_f64().abs() > DISTANCE;
        let allowed = self.spec.loci.iter().all(|l| far(&l.value.function));
        let values: Vec<Precise> = coordinates.iter().map(|c| at.value(c)).collect();
        (allowed && values.iter().all(Precise::is_finite)).then_some(values)
    }

    fn home(&self, point: &Point) -> Vec<Precise> {
        let declared = self.spec.home.as_ref().map(|home| home.value.clone());
        let home = declared.unwrap_or_else(|| self.spec.manifold.value.home());
        home.iter().map(|entry| point.evaluate(entry)).collect()
    }

    /// Newton's method with the shortest step that solves the linearised relations.
    fn to_manifold(&self, at: &mut Point, coordinates: &[Symbol]) -> Option<()> {
        for _ in 0..NEWTON_STEPS {
            let values: Vec<(Precise, f64)> = self
                .relations
                .iter()
                .map(|(relation, _)| at.evaluate_with_scale(relation))
                .collect();
            if values.iter().all(|value| is_met(value, at.bits())) {
                return Some(());
            }
            let rows: Vec<Vec<Precise>> = self
                .relations
                .iter()
                .map(|(_, slopes)| slopes.iter().map(|slope| at.evaluate(slope)).collect())
                .collect();
            let right: Vec<Precise> = values.iter().map(|(value, _)| -value).collect();
            let step = shortest_solution(&rows, &right);
            for (coordinate, change) in coordinates.iter().zip(step) {
                let moved = at.value(coordinate) + change;
                at.bind(coordinate, moved);
            }
        }
        None
    }
}

/// Whether a relation vanishes to rounding of its terms, or of numbers of order 1: all terms may be small where it is met.
fn is_met((value, scale): &(Precise, f64), bits: usize) -> bool {
    let limit =
        Precise::from_f64(scale.max(1.0), bits).halved(bits.saturating_sub(ROUNDING_BITS) as i32);
    value
        .abs()
        .compare(&limit)
        .is_some_and(|order| order.is_le())
}

fn bind_all(point: &mut Point, symbols: &[Symbol], values: Vec<Precise>) {
    for (symbol, value) in symbols.iter().zip(values) {
        point.bind(symbol, value);
    }
}
