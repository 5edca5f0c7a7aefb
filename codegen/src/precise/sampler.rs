//! Random points of a joint's manifold.

use super::linear::shortest_solution;
use super::start::Draw;
use super::{Point, Precise};
use crate::expr::{Expr, Symbol};
use crate::model::ConfigurationSpace;
use chacha20::ChaCha8Rng;
use chacha20::rand_core::{Rng, SeedableRng};

/// Draws before a point is given up: a random point misses what a joint forbids about every other time.
const ATTEMPTS: usize = 64;
/// Newton's method in doubles takes some five steps from near; with slopes in doubles it gains some 50 bits a step: 512 bits in a dozen.
const NEWTON_STEPS: usize = 30;
/// Steps and parts in which the runtime assembles a linkage, `assemble` and `project` of its `finite`.
const PROJECTION_STEPS: usize = 12;
const PARTS: usize = 16;
/// A step in doubles from which on digits are gained by more bits alone.
const CLOSE: f64 = 1e-9;
/// How far from home a point of declared relations is looked for, in every stored scalar.
const REACH: f64 = 0.75;
/// Bits that rounding may cost a relation of some dozen terms of order 1 to 10.
const ROUNDING_BITS: usize = 24;
/// Smallest value of a function of a locus: points are drawn where kernels mean something.
const DISTANCE: f64 = 1.0 / 64.0;

/// How many times as far as usual far points lie from home: beyond some turns of an angle, and on the other side of what is near home.
const REACHES: [f64; 2] = [4.0, 16.0];
/// Bits and steps by which a locus is looked for: far points lie beyond it, not on it.
const ROUGH: (usize, usize) = (64, 10);

/// A deterministic source of random points of one joint.
#[derive(Debug)]
pub struct Sampler<'a> {
    space: &'a ConfigurationSpace,
    draw: Draw,
    /// The relations, by which points are corrected; empty where every factor is sampled as it is.
    relations: Vec<Sloped>,
    /// What is positive wherever the joint lives.
    sides: Vec<Expr>,
    /// Whether points have a second configuration Q′.
    paired: bool,
    /// Values of the parameters, where they are not drawn.
    parameters: Option<Vec<f64>>,
    /// Of far points: the loci, beyond which the domain may have other components, and all relations.
    far: Option<(Vec<Sloped>, Vec<Sloped>)>,
}

/// An expression with its derivatives by the stored scalars.
type Sloped = (Expr, Vec<Expr>);

fn sloped(space: &ConfigurationSpace, expressions: impl IntoIterator<Item = Expr>) -> Vec<Sloped> {
    let coordinates = space.manifold.coordinates();
    let slopes = |e: &Expr| coordinates.iter().map(|q| e.derivative(q)).collect();
    let pairs = expressions.into_iter().map(|e| {
        let slopes = slopes(&e);
        (e, slopes)
    });
    pairs.collect()
}

impl<'a> Sampler<'a> {
    /// Points of the joint in numbers of `bits` bits, the same in every run.
    pub fn new(space: &'a ConfigurationSpace, bits: usize) -> Self {
        let manifold = &space.manifold;
        let relations = match manifold.declared().is_empty() {
            true => vec![],
            false => manifold.relations(),
        };
        Self {
            space,
            draw: Draw {
                random: ChaCha8Rng::seed_from_u64(1),
                bits,
                reach: 1.0,
            },
            relations: sloped(space, relations),
            sides: vec![],
            paired: true,
            parameters: None,
            far: None,
        }
    }

    /// The same with these values of the parameters, in the order of the spec.
    #[must_use]
    pub fn with_parameters(self, values: Vec<f64>) -> Self {
        let parameters = Some(values);
        Self { parameters, ..self }
    }

    /// The same where these functions are positive.
    #[must_use]
    pub fn beside(self, sides: Vec<Expr>) -> Self {
        Self { sides, ..self }
    }

    /// The same without a second configuration Q′.
    #[must_use]
    pub fn single(self) -> Self {
        let paired = false;
        Self { paired, ..self }
    }

    /// Points far from home, every other one beside a locus: the components of the domain are not left out that lie beyond.
    #[must_use]
    pub fn far(self) -> Self {
        let loci = self.space.loci.iter().map(|l| l.value.function.clone());
        let loci = sloped(self.space, loci);
        let all = sloped(self.space, self.space.manifold.relations());
        let far = Some((loci, all));
        Self { far, ..self }
    }

    /// The next point; `None` where none was found that keeps every range, requirement, relation and locus.
    pub fn point(&mut self) -> Option<Point> {
        (0..ATTEMPTS).find_map(|_| self.attempt())
    }

    /// A point on the manifold with parameters within their ranges, whatever it misses of requirements and loci: for who moves some
    /// of its values, and looks at these then.
    pub fn anywhere(&mut self) -> Option<Point> {
        let mut free = self.space.clone();
        free.requirements.clear();
        free.loci.clear();
        let mut sampler = Sampler::new(&free, self.draw.bits).single();
        std::mem::swap(&mut sampler.draw.random, &mut self.draw.random);
        let point = sampler.point();
        std::mem::swap(&mut sampler.draw.random, &mut self.draw.random);
        point
    }

    /// The point with its stored scalars moved onto the manifold by Newton's method, the parameters as they are; `None` where that fails,
    /// and where its relations are not met to the rounding of their terms, however small these are, or of the stored scalars: an entry of R that is 0
    /// leaves terms that are rounding alone.
    pub fn settled(&self, point: &Point) -> Option<Point> {
        let mut settled = point.clone();
        let coordinates = self.space.manifold.coordinates();
        to_zero(&mut settled, &coordinates, &self.relations)?;
        let near = |symbol: &Symbol| settled.value(symbol).to_f64();
        let holds = |(relation, slopes): &Sloped| {
            let (value, scale) = settled.evaluate_with_scale(relation);
            let slopes = slopes.iter().zip(&coordinates);
            let of_scalars =
                slopes.map(|(slope, q)| slope.evaluate(&0.0, &near).abs() * near(q).abs().max(1.0));
            let scale = of_scalars.fold(scale, f64::max);
            value.is_zero() || scale.is_normal() && is_small(&value, scale, settled.bits())
        };
        self.relations.iter().all(holds).then_some(settled)
    }

    /// The point with its stored scalars, a guess, moved onto the manifold in as many steps as the runtime takes to assemble a linkage: directly, or with the values
    /// of the relations taken back to zero in parts.
    pub fn assembled(&self, guess: &Point) -> Option<Point> {
        let (coordinates, relations) = (self.space.manifold.coordinates(), &self.relations);
        let mut direct = guess.clone();
        if newton_in_doubles(&mut direct, &coordinates, relations, PROJECTION_STEPS) {
            return self.settled(&direct);
        }
        let near = |symbol: &Symbol| guess.value(symbol).to_f64();
        let values = relations.iter().map(|(e, _)| e.evaluate(&0.0, &near));
        let values: Vec<f64> = values.collect();
        let mut now = doubles(guess, &coordinates);
        for left in (1..PARTS).rev() {
            let part = left as f64 / PARTS as f64;
            let targets: Vec<f64> = values.iter().map(|value| part * value).collect();
            let step = step_in_doubles((guess, &coordinates), relations, (&now, &targets));
            add(&mut now, &step);
        }
        let mut followed = guess.clone();
        move_to(&mut followed, &coordinates, &now);
        match newton_in_doubles(&mut followed, &coordinates, relations, PROJECTION_STEPS) {
            true => self.settled(&followed),
            false => None,
        }
    }

    fn attempt(&mut self) -> Option<Point> {
        if self.far.is_some() {
            self.draw.reach = REACHES[self.index(REACHES.len())];
        }
        let mut point = Point::new(self.draw.random.next_u64(), self.draw.bits);
        for (n, parameter) in self.space.parameters.iter().enumerate() {
            let given = self.parameters.as_ref().and_then(|values| values.get(n));
            let value = match given {
                Some(&value) => Precise::from_f64(value, self.draw.bits),
                None => self.draw.parameter(&parameter.range),
            };
            point.bind(&parameter.symbol, value);
        }
        let holds = |value: &Expr| point.evaluate(value).to_f64() > 0.0;
        if !self
            .space
            .requirements
            .iter()
            .all(|r| holds(&r.value.value))
        {
            return None;
        }
        let manifold = &self.space.manifold;
        let coordinates = manifold.coordinates();
        let target: Vec<Symbol> = manifold
            .target()
            .into_iter()
            .flat_map(|factor| factor.coordinates)
            .collect();
        if self.paired {
            let second = self.configuration(&point, &coordinates)?;
            bind_all(&mut point, &target, second);
        }
        let first = self.configuration(&point, &coordinates)?;
        bind_all(&mut point, &coordinates, first);
        Some(point)
    }

    /// A random place among `count`.
    fn index(&mut self, count: usize) -> usize {
        self.draw.random.next_u32() as usize % count.max(1)
    }

    /// A configuration on the manifold and away from the loci.
    fn configuration(&mut self, point: &Point, coordinates: &[Symbol]) -> Option<Vec<Precise>> {
        let manifold = &self.space.manifold;
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
            to_zero(&mut at, coordinates, &self.relations)?;
        }
        if self.far.is_some() && self.index(2) == 1 {
            self.cross(&mut at, coordinates)?;
        }
        let far = |function: &Expr| at.evaluate(function).to_f64().abs() > DISTANCE;
        let mut loci = self.space.loci.iter().map(|locus| &locus.value.function);
        let lives = |side: &Expr| at.evaluate(side).to_f64() > 0.0;
        let allowed = loci.all(far) && self.sides.iter().all(lives);
        let values: Vec<Precise> = coordinates.iter().map(|c| at.value(c)).collect();
        (allowed && values.iter().all(Precise::is_finite)).then_some(values)
    }

    fn home(&self, point: &Point) -> Vec<Precise> {
        let home = self.space.home.iter();
        home.map(|entry| point.evaluate(entry)).collect()
    }

    /// Goes from a far point to some locus, and from there as far as points lie from home, to either side.
    fn cross(&mut self, at: &mut Point, coordinates: &[Symbol]) -> Option<()> {
        let Some((loci, relations)) = self.far.clone() else {
            return Some(());
        };
        let chosen = self.index(loci.len());
        let Some(locus) = loci.get(chosen) else {
            return Some(());
        };
        let (bits, steps) = ROUGH;
        let mut rough = Point::new(0, bits);
        let parameters = self.space.parameters.iter().map(|p| &p.symbol);
        for symbol in coordinates.iter().chain(parameters) {
            rough.bind(symbol, Precise::from_f64(at.value(symbol).to_f64(), bits));
        }
        let all = [&relations[..], std::slice::from_ref(locus)].concat();
        newton_in_doubles(&mut rough, coordinates, &all, steps);
        let found: Vec<Precise> = coordinates
            .iter()
            .map(|q| Precise::from_f64(rough.value(q).to_f64(), self.draw.bits))
            .collect();
        let reach = std::mem::replace(&mut self.draw.reach, 1.0);
        bind_all(at, coordinates, self.draw.near(&found, REACH));
        self.draw.reach = reach;
        to_zero(at, coordinates, &relations)
    }
}

/// Newton's method with the shortest step that solves the linearised equations: in doubles at first, then with slopes in doubles, as the
/// linearised equations need no more digits than a step gains.
fn to_zero(at: &mut Point, coordinates: &[Symbol], equations: &[Sloped]) -> Option<()> {
    newton_in_doubles(at, coordinates, equations, NEWTON_STEPS);
    for _ in 0..NEWTON_STEPS {
        let values: Vec<(Precise, f64)> = equations
            .iter()
            .map(|(e, _)| at.evaluate_with_scale(e))
            .collect();
        if values.iter().all(|value| is_met(value, at.bits())) {
            return Some(());
        }
        let near = |symbol: &Symbol| at.value(symbol).to_f64();
        let right = values.iter().map(|(value, _)| -value.to_f64()).collect();
        let step = shortest_solution(slopes(equations, &near), right);
        advance(at, coordinates, &step);
    }
    None
}

/// Newton's method in doubles: to where equations are met to their rounding, or `steps` steps. Whether it has come there.
fn newton_in_doubles(
    at: &mut Point,
    coordinates: &[Symbol],
    equations: &[Sloped],
    steps: usize,
) -> bool {
    let targets = vec![0.0; equations.len()];
    let mut now = doubles(at, coordinates);
    let mut sizes = (0..steps).map(|_| {
        let step = step_in_doubles((at, coordinates), equations, (&now, &targets));
        add(&mut now, &step);
        step.iter()
            .fold(0.0_f64, |most, change| most.max(change.abs()))
    });
    let is_there = sizes.any(|size| size <= CLOSE);
    move_to(at, coordinates, &now);
    is_there
}

fn add(now: &mut [f64], step: &[f64]) {
    now.iter_mut()
        .zip(step)
        .for_each(|(x, change)| *x += change);
}

/// Moves the scalars to these values, by differences in doubles.
fn move_to(at: &mut Point, coordinates: &[Symbol], now: &[f64]) {
    let change = now.iter().zip(doubles(at, coordinates));
    let change: Vec<f64> = change.map(|(now, start)| now - start).collect();
    advance(at, coordinates, &change);
}

/// The step of Newton's method from `now` to where the equations have the values `targets`.
fn step_in_doubles(
    (at, coordinates): (&Point, &[Symbol]),
    equations: &[Sloped],
    (now, targets): (&[f64], &[f64]),
) -> Vec<f64> {
    let near = |symbol: &Symbol| match coordinates.iter().position(|q| q == symbol) {
        Some(place) => now[place],
        None => at.value(symbol).to_f64(),
    };
    let pairs = equations.iter().zip(targets);
    let right = pairs.map(|((e, _), target)| target - e.evaluate(&0.0, &near));
    shortest_solution(slopes(equations, &near), right.collect())
}

fn doubles(at: &Point, coordinates: &[Symbol]) -> Vec<f64> {
    coordinates.iter().map(|q| at.value(q).to_f64()).collect()
}

fn slopes(equations: &[Sloped], near: &impl Fn(&Symbol) -> f64) -> Vec<Vec<f64>> {
    let row = |(_, slopes): &Sloped| slopes.iter().map(|s| s.evaluate(&0.0, near)).collect();
    equations.iter().map(row).collect()
}

fn advance(at: &mut Point, coordinates: &[Symbol], step: &[f64]) {
    for (coordinate, &change) in coordinates.iter().zip(step) {
        let moved = at.value(coordinate) + Precise::from_f64(change, at.bits());
        at.bind(coordinate, moved);
    }
}

/// Whether a relation vanishes to rounding of its terms, or of numbers of order 1: all terms may be small where it is met.
fn is_met((value, scale): &(Precise, f64), bits: usize) -> bool {
    is_small(value, scale.max(1.0), bits)
}

/// Whether a number is of the size of rounding beside another.
fn is_small(value: &Precise, beside: f64, bits: usize) -> bool {
    let limit = Precise::from_f64(beside, bits).halved(bits.saturating_sub(ROUNDING_BITS) as i32);
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
