//! Identities that algebra does not decide: a search for a place where they fail.
//!
//! A place refutes an identity where an enclosure of its residual excludes 0. That many places agree proves nothing: a spec that
//! wants to rest on it has to say so, by `unproved`. The search therefore looks everywhere that it can:
//! at random points near home, far from it and beside each exception; in cells of every sign pattern of exceptions and
//! requirements; where the functions of the residual change fastest; where enclosures leave room for a large residual, however narrow;
//! and at its derivatives.

mod axes;
mod cells;
mod changes;
mod features;
mod narrow;
mod place;

use super::Identities;
use crate::expr::{Expr, Number, budget};
use crate::model::{End, Parameter};
use crate::precise::{Enclosure, Interval, Point, Precise, Sampler};
use place::Place;
use std::cell::{Cell, OnceCell};
use std::cmp::Ordering;

/// Bits of the numbers, and of a few more where the first leave open what cancels.
const BITS: usize = 256;
const MORE_BITS: usize = 2048;
/// Random points near home and as many far from it, in the first number of bits and in the second.
const POINTS: usize = 50;
const FEW_POINTS: usize = 3;
/// Bits by which a random point may miss the manifold: see `Sampler`.
const MISSED_BITS: usize = 32;
/// Bits to which the terms of a residual must cancel before a point is said to agree.
const CANCELLED_BITS: i32 = 128;
/// What a point costs in term operations, and each term of a residual there.
const COST: (u64, u64) = (150, 15);
/// What finding the manifold again costs.
const COST_OF_NEWTON: u64 = 3000;
/// Most terms of a residual.
const MOST_TERMS: usize = 400;

/// What the search showed.
pub enum Verdict {
    /// An identity fails at a place.
    Refuted(Box<Place>),
    /// No place refutes it, among so many.
    Agrees { points: usize },
    /// Some part of the domain could not be looked at, or nothing be said there.
    Undecided(String),
}

/// What one point says.
enum Said {
    Refutes(Place),
    Agrees,
    Nothing,
}

/// An entry of which the normal form is not 0, as it was defined and in normal form.
type Open = (Expr, Expr);

/// A search for one claim.
struct Search<'s> {
    identities: &'s Identities<'s>,
    open: &'s [Open],
    sides: Vec<Expr>,
    agreeing: Cell<usize>,
}

/// The random points of a joint, drawn when the first claim needs them.
#[derive(Default)]
pub(super) struct Points {
    near: OnceCell<Vec<Point>>,
    beyond: OnceCell<Vec<Point>>,
}

impl Points {
    /// Points near home.
    fn near(&self, identities: &Identities<'_>) -> &[Point] {
        self.near
            .get_or_init(|| draw(identities, BITS, POINTS, false).collect())
    }

    /// Points far from home, and some of both kinds in more bits.
    fn beyond(&self, identities: &Identities<'_>) -> &[Point] {
        self.beyond.get_or_init(|| {
            let few = |far| draw(identities, MORE_BITS, FEW_POINTS, far);
            let far = draw(identities, BITS, POINTS, true);
            far.chain(few(false)).chain(few(true)).collect()
        })
    }
}

/// As many random points as there are, and as can be afforded.
fn draw<'i>(
    identities: &'i Identities<'_>,
    bits: usize,
    count: usize,
    far: bool,
) -> impl Iterator<Item = Point> + 'i {
    let sampler = Sampler::new(&identities.joint.space, bits)
        .beside(identities.sides())
        .single();
    let mut sampler = if far { sampler.far() } else { sampler };
    let affordable = move || sampler.point().filter(|_| budget::spend(COST.0));
    std::iter::repeat_with(affordable)
        .take(count)
        .map_while(|point| point)
}

/// Looks for a place where an entry is not 0.
pub(super) fn search(identities: &Identities<'_>, open: &[Open]) -> Verdict {
    let terms: usize = open.iter().map(|(entry, _)| entry.terms().len()).sum();
    if terms > MOST_TERMS {
        return Verdict::Undecided(format!(
            "its residual has {terms} terms; at most {MOST_TERMS} are evaluated"
        ));
    }
    let search = Search {
        identities,
        open,
        sides: identities.sides(),
        agreeing: Cell::new(0),
    };
    search.run()
}

impl Search<'_> {
    fn run(&self) -> Verdict {
        let (identities, points) = (self.identities, &self.identities.points);
        let is_plain = |found: &Option<Place>| found.as_ref().is_some_and(Place::is_plain);
        let mut refuting = self.at_all(points.near(identities));
        if !is_plain(&refuting) {
            let beyond = self.at_all(points.beyond(identities));
            refuting = Place::larger(refuting, beyond);
        }
        // Where a residual is large, at numbers that are easy to picture, says more than where it was first met.
        if !is_plain(&refuting) {
            refuting = Place::larger(refuting, self.narrow());
        }
        let mut unreached = None;
        if !is_plain(&refuting) {
            let (beyond, left) = self.cells();
            refuting = Place::larger(refuting, beyond);
            unreached = left;
        }
        // The dearest looks, where no other found anything.
        let refuting = refuting
            .or_else(|| self.features())
            .or_else(|| self.changes());
        match (refuting, unreached, self.agreeing.get()) {
            (Some(place), ..) => Verdict::Refuted(Box::new(place)),
            (None, Some(reason), _) => Verdict::Undecided(reason),
            (None, None, 0) => Verdict::Undecided("no point was found where it has a value".into()),
            (None, None, points) => Verdict::Agrees { points },
        }
    }

    /// The place with the largest residual among points.
    fn at_all(&self, points: &[Point]) -> Option<Place> {
        let mut refuting = None;
        for point in points {
            match self.at(point) {
                Said::Refutes(place) => refuting = Place::larger(refuting, Some(place)),
                Said::Agrees => self.agreeing.set(self.agreeing.get() + 1),
                Said::Nothing => {}
            }
            if budget::is_exhausted() {
                break;
            }
        }
        refuting
    }

    /// What a point of the domain says.
    fn at(&self, point: &Point) -> Said {
        let terms: usize = self.open.iter().map(|(entry, _)| entry.terms().len()).sum();
        if !budget::spend(COST.0 + COST.1 * terms as u64) {
            return Said::Nothing;
        }
        let enclosure = self.around(point);
        let mut said = Said::Agrees;
        for (entry, normal) in self.open {
            let (value, size) = enclosure.of_terms(entry);
            let of_normal = enclosure.of(normal);
            if value.excludes_zero() || of_normal.excludes_zero() {
                let tighter = if value.excludes_zero() {
                    &value
                } else {
                    &of_normal
                };
                return Said::Refutes(Place::new(
                    self.identities.joint,
                    entry,
                    point,
                    tighter,
                    &size,
                ));
            }
            let cancelled = size.largest_size().halved(CANCELLED_BITS);
            let agrees = value.is_bounded()
                && (value.largest_size().compare(&cancelled)).is_some_and(|order| order.is_le());
            if !agrees {
                said = Said::Nothing;
            }
        }
        said
    }

    /// The middle of the cell, all else as in `base`, where it belongs to the domain and the claim fails there.
    fn fails_in(&self, cell: &[axes::Side], base: &Point) -> Option<Place> {
        let mut point = base.clone();
        axes::move_to_middle(&mut point, cell);
        self.fails_at(&point)
    }

    /// The point, where it belongs to the domain and the claim fails there.
    fn fails_at(&self, point: &Point) -> Option<Place> {
        match self.admits(point).then(|| self.at(point)) {
            Some(Said::Refutes(place)) => Some(place),
            _ => None,
        }
    }

    /// The point on the manifold: a parameter that was moved may have taken the manifold with it.
    fn on_manifold(&self, point: &Point) -> Option<Point> {
        let joint = self.identities.joint;
        match joint.space.manifold.declared().is_empty() {
            true => Some(point.clone()),
            false => {
                budget::spend(COST_OF_NEWTON);
                Sampler::new(&joint.space, point.bits()).settled(point)
            }
        }
    }

    /// Every symbol near its value at the point, in so many bits: for who then frees some of them.
    fn near(&self, base: &Point, bits: usize) -> Enclosure {
        let mut enclosure = Enclosure::new(bits);
        for symbol in self.identities.joint.space.symbols() {
            let value = base.value(&symbol).to_bits(bits);
            enclosure.bind(&symbol, room(&value));
        }
        enclosure
    }

    /// The point with as much room as it may miss the manifold by.
    fn around(&self, point: &Point) -> Enclosure {
        let mut enclosure = Enclosure::new(point.bits());
        let joint = self.identities.joint;
        for parameter in &joint.spec.parameters {
            let value = point.value(&parameter.symbol);
            enclosure.bind(&parameter.symbol, Interval::point(value));
        }
        let manifold = &joint.space.manifold;
        let exact = |kind| matches!(kind, crate::manifold::Kind::Real(_));
        for factor in manifold.factors() {
            let free = exact(factor.kind) && manifold.declared().is_empty();
            for symbol in &factor.coordinates {
                let value = point.value(symbol);
                enclosure.bind(
                    symbol,
                    if free {
                        Interval::point(value)
                    } else {
                        room(&value)
                    },
                );
            }
        }
        enclosure
    }

    /// Whether the point meets every requirement, keeps off every exception and lies on the side of home.
    fn admits(&self, point: &Point) -> bool {
        let enclosure = self.around(point);
        let joint = self.identities.joint;
        let required = joint.spec.requirements.iter().map(|r| &r.value.value);
        let mut positive = required.chain(&self.sides);
        let mut loci = joint.space.loci.iter().map(|locus| &locus.value.function);
        joint
            .spec
            .parameters
            .iter()
            .all(|p| may_be(p, &point.value(&p.symbol)))
            && positive.all(|e| enclosure.of(e).is_positive())
            && loci.all(|e| enclosure.of(e).excludes_zero())
    }
}

/// Whether a parameter may have the value.
fn may_be(parameter: &Parameter, value: &Precise) -> bool {
    let inside = |end: &Option<End>, inner: Ordering| match end {
        Some(end) => match value.compare(&value.rational(&end.value)) {
            Some(Ordering::Equal) => end.included,
            order => order == Some(inner),
        },
        None => true,
    };
    (parameter.may_vanish() || !value.is_zero())
        && inside(&parameter.range.lower, Ordering::Greater)
        && inside(&parameter.range.upper, Ordering::Less)
}

/// All numbers that differ from this by rounding of the point.
fn room(value: &Precise) -> Interval {
    let one = value.same(1);
    let size = match value.abs().compare(&one) {
        Some(std::cmp::Ordering::Greater) => value.abs(),
        _ => one,
    };
    let rounding = size.halved((value.bits() - MISSED_BITS.min(value.bits())) as i32);
    Interval::between(value - &rounding, value + &rounding)
}
