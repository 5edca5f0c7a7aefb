//! Narrow features by their cause: functions change fastest where their arguments are 0 or extremal. Along each variable such places are
//! found by bisection with enclosures and refined by Newton's method, and the claim is tried there and beside, however narrow the feature is.

use super::Search;
use super::axes::{self, Axis, Cell as Box, Side};
use super::place::Place;
use crate::expr::{Atom, Expr, budget};
use crate::precise::{Point, Sampler};
use std::collections::BTreeSet;

/// Bits of the ends of cells, enough for the middles of doubles not to be lost in what cancels.
const BITS: usize = 128;
/// Most cells of one function along one line.
const MOST_CELLS: usize = 300;
/// Most zeros of one function along one line.
const MOST_ZEROS: usize = 4;
/// Most arguments of functions that are looked at.
const MOST_ARGUMENTS: usize = 12;
/// Steps of Newton's method: from doubles to 256 bits, and one for multiple zeros.
const NEWTON_STEPS: usize = 4;
/// A step leads away that is larger than this part of the zero, or of a number of this size.
const DOUBLE_BITS: f64 = 40.0;
const NEAR_ZERO: f64 = -20.0;
/// How far from a zero the claim is tried beside it, as halvings of its size or of 1.
const DISTANCES: [i32; 3] = [4, 24, 60];
/// Points through which the lines go.
const LINES: usize = 2;

impl Search<'_> {
    /// The place with the largest residual that was found.
    pub(super) fn features(&self) -> Option<Place> {
        let mut arguments = BTreeSet::new();
        for (entry, normal) in self.open {
            collect(entry, &mut arguments);
            collect(normal, &mut arguments);
        }
        let mut found = None;
        let mut sampler = Sampler::new(&self.identities.joint.space, super::BITS).single();
        for _ in 0..LINES {
            let Some(base) = sampler.point() else {
                break;
            };
            for argument in arguments.iter().take(MOST_ARGUMENTS) {
                let (whole, _) = axes::on_one_manifold(self.identities.joint, &argument.symbols());
                // Each line goes through an extremum along those before it: functions of several variables peak at one point.
                let mut through = base.clone();
                for side in whole {
                    if let Some(place) = self.along(argument, &side, &mut through) {
                        if place.is_large() {
                            return Some(place);
                        }
                        found = Place::larger(found, Some(place));
                    }
                }
            }
        }
        found
    }

    /// Tries the claim where the argument is 0 or extremal on the line, and moves the point to an extremum.
    fn along(&self, argument: &Expr, side: &Side, through: &mut Point) -> Option<Place> {
        let slope = match &side.axis {
            Axis::Real(symbol) => Some(argument.derivative(symbol)),
            Axis::Angle(..) => None,
        };
        let functions = [Some(argument.clone()), slope];
        let mut found = None;
        let base = through.clone();
        for function in functions
            .iter()
            .flatten()
            .filter(|f| !f.symbols().is_empty())
        {
            for (n, cell) in self.zeros(function, side, &base).iter().enumerate() {
                let mut zero = base.clone();
                axes::move_to_middle(&mut zero, cell);
                refine(&mut zero, function, &side.axis);
                for point in beside(&zero, &side.axis) {
                    found = Place::larger(found, self.fails_at(&point));
                }
                if n == 0 {
                    *through = zero;
                }
            }
        }
        found
    }

    /// Cells of the line, as small as doubles allow, in which the function may be 0: those that are nearest to 0.
    fn zeros(&self, function: &Expr, side: &Side, base: &Point) -> Vec<Box> {
        let mut enclosure = self.near(base, BITS);
        let mut open = vec![vec![side.clone()]];
        let mut found = vec![];
        // Cutting never ends at 0, since there are doubles of all sizes beside it.
        if side.low <= 0.0 && side.high >= 0.0 {
            let (axis, low, high) = (side.axis.clone(), 0.0, 0.0);
            let origin = vec![Side { axis, low, high }];
            axes::bind(&mut enclosure, &origin, BITS);
            if !enclosure.of(function).excludes_zero() {
                found.push(origin);
            }
        }
        for _ in 0..MOST_CELLS {
            let Some(cell) = nearest(&mut open) else {
                break;
            };
            if found.len() >= MOST_ZEROS || !budget::spend(super::COST.0) {
                break;
            }
            axes::bind(&mut enclosure, &cell, BITS);
            if enclosure.of(function).excludes_zero() {
                continue;
            }
            match axes::halves(&cell) {
                Some(halves) => open.extend(halves),
                None => found.push(cell),
            }
        }
        found
    }
}

/// Newton's method from a zero in doubles to all bits of the point; a step that leads away is not taken.
fn refine(point: &mut Point, function: &Expr, axis: &Axis) {
    let Axis::Real(symbol) = axis else {
        return;
    };
    let slope = function.derivative(symbol);
    for _ in 0..NEWTON_STEPS {
        let step = &point.evaluate(function) / &point.evaluate(&slope);
        let x = point.value(symbol);
        if !step.is_finite() || step.log2() > x.log2().max(NEAR_ZERO) - DOUBLE_BITS {
            return;
        }
        point.bind(symbol, &x - &step);
    }
}

/// The point, and points on both sides of it: a factor may be 0 in it, at which a feature does not show.
fn beside(point: &Point, axis: &Axis) -> Vec<Point> {
    let mut points = vec![point.clone()];
    if let Axis::Real(symbol) = axis {
        let x = point.value(symbol);
        let size = x.abs().larger(&x.same(1));
        for distance in DISTANCES {
            let step = size.halved(distance);
            for moved in [&x - &step, &x + &step] {
                let mut beside = point.clone();
                beside.bind(symbol, moved);
                points.push(beside);
            }
        }
    }
    points
}

/// Takes the cell that is nearest to 0: of a periodic function there are others without end.
fn nearest(open: &mut Vec<Box>) -> Option<Box> {
    let extent = |place: &usize| axes::extent(&open[*place]);
    let place = (0..open.len()).min_by(|a, b| extent(a).total_cmp(&extent(b)))?;
    Some(open.swap_remove(place))
}

/// The arguments of all functions in an expression, and of those in them.
fn collect(expression: &Expr, found: &mut BTreeSet<Expr>) {
    for atom in expression.atoms() {
        if let Atom::Apply(application) = atom {
            for argument in &application.arguments {
                if !argument.symbols().is_empty() && found.insert(argument.clone()) {
                    collect(argument, found);
                }
            }
        }
    }
}
