//! Narrow features by their cause: functions change fastest where their arguments are 0 or extremal. Along each variable such places are
//! found by bisection with enclosures, and the claim is tried there, however narrow the feature is.

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
        let mut sampler = Sampler::new(self.identities.spec, super::BITS).single();
        for _ in 0..LINES {
            let Some(base) = sampler.point() else {
                break;
            };
            for argument in arguments.iter().take(MOST_ARGUMENTS) {
                let (whole, _) = axes::whole(self.identities.spec, &argument.symbols());
                for side in whole {
                    if let Some(place) = self.along(argument, &side, &base) {
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

    /// Tries the claim where the argument is 0 or extremal on the line.
    fn along(&self, argument: &Expr, side: &Side, base: &Point) -> Option<Place> {
        let slope = match &side.axis {
            Axis::Real(symbol) => Some(argument.derivative(symbol)),
            Axis::Angle(..) => None,
        };
        let functions = [Some(argument.clone()), slope];
        let mut found = None;
        for function in functions
            .iter()
            .flatten()
            .filter(|f| !f.symbols().is_empty())
        {
            for cell in self.zeros(function, side, base) {
                if let Some(place) = self.fails_in(&cell, base) {
                    found = Place::larger(found, Some(place));
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
