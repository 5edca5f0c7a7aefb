//! Narrow features: cells in which an enclosure leaves room for the largest residual are cut first, so that the search ends where
//! a bump is, however narrow. Where enclosures leave room everywhere, long cells near 0 come first.

use super::Search;
use super::axes::{self, Cell as Box};
use super::place::Place;
use crate::expr::{Symbol, budget};
use crate::precise::{Point, Sampler};
use std::collections::BTreeSet;

/// Bits of points and of the ends of cells.
const BITS: usize = 128;
/// Most cells of one search.
const MOST_CELLS: usize = 400;
/// Most variables that are cut together; more are cut one at a time, the others held.
const MOST_AXES: usize = 2;
/// The binary logarithm of a room that is as good as any larger one.
const MOST_ROOM: f64 = 8.0;
/// Points from which one variable is varied at a time.
const LINES: usize = 2;

impl Search<'_> {
    /// The place with the largest residual that was found.
    pub(super) fn narrow(&self) -> Option<Place> {
        let entries = self.open.iter().flat_map(|(entry, normal)| [entry, normal]);
        let symbols: BTreeSet<Symbol> = entries.flat_map(|e| e.symbols()).collect();
        let (whole, complete) = axes::on_one_manifold(self.identities.joint, &symbols);
        if whole.is_empty() {
            return None;
        }
        let mut sampler = Sampler::new(&self.identities.joint.space, BITS).single();
        let mut found = None;
        if complete && whole.len() <= MOST_AXES {
            found = self.largest_in(whole.clone(), &sampler.anywhere()?, MOST_CELLS);
            if whole.len() == 1 {
                return found;
            }
        }
        for _ in 0..LINES {
            let Some(base) = sampler.point() else {
                break;
            };
            for side in &whole {
                let line = vec![side.clone()];
                let place = self.largest_in(line, &base, MOST_CELLS / whole.len());
                found = Place::larger(found, place);
            }
        }
        found
    }

    fn largest_in(&self, whole: Box, base: &Point, most: usize) -> Option<Place> {
        // Of cells with the same room, that which is nearest to 0.
        let by_room = |room: f64, cell: &Box| (room, -axes::extent(cell));
        let by_length = |room: f64, cell: &Box| {
            let length = axes::weighted_length(cell).log2();
            (room.clamp(-MOST_ROOM, MOST_ROOM) + length, 0.0)
        };
        let found = self.first_in(whole.clone(), base, most, by_room);
        // Of two variables so few cells would see nothing but the coarsest features; of lines there are several where there are fewer for each.
        let is_line = whole.len() == 1;
        let by_length = || self.first_in(whole, base, most * most / MOST_CELLS, by_length);
        found.or_else(|| is_line.then(by_length).flatten())
    }

    /// The place with the largest residual among the middles of cells, of which that with the largest order is cut next.
    fn first_in(
        &self,
        whole: Box,
        base: &Point,
        most: usize,
        order: impl Fn(f64, &Box) -> (f64, f64),
    ) -> Option<Place> {
        let mut open = vec![(f64::INFINITY, whole)];
        let mut found: Option<Place> = None;
        for _ in 0..most {
            let of = |place: &usize| order(open[*place].0, &open[*place].1);
            let largest = (0..open.len()).max_by(|a, b| {
                let (a, b) = (of(a), of(b));
                a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
            })?;
            let (_, cell) = open.swap_remove(largest);
            found = Place::larger(found, self.fails_in(&cell, base));
            let large = found.as_ref().is_some_and(Place::is_large);
            if large || !budget::spend(super::COST.0) {
                break;
            }
            for half in axes::halves(&cell).into_iter().flatten() {
                let bound = self.room_in(&half, base);
                // What is exactly 0 in a cell needs no more looks.
                if bound > f64::NEG_INFINITY {
                    open.push((bound, half));
                }
            }
        }
        found
    }

    /// The binary logarithm of the largest residual that an enclosure does not exclude in the cell.
    fn room_in(&self, cell: &Box, base: &Point) -> f64 {
        let mut enclosure = self.near(base, BITS);
        axes::bind(&mut enclosure, cell, BITS);
        let sizes = self.open.iter().map(|(entry, normal)| {
            let sizes = [entry, normal].map(|e| enclosure.of(e).largest_size().log2());
            sizes[0].min(sizes[1])
        });
        sizes.fold(f64::NEG_INFINITY, f64::max)
    }
}
