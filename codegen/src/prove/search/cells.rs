//! Every sign pattern of exceptions and requirements: the ranges of what they depend on are cut into cells until each cell lies
//! on one side of all of them, and the claim is tried in cells of each pattern.

use super::axes::{self, Cell as Box};
use super::place::Place;
use super::{Said, Search};
use crate::expr::{Expr, Symbol, budget};
use crate::precise::{Enclosure, Sampler};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// Bits of the ends of cells.
const BITS: usize = 128;
/// Most cells, and most of one pattern in which the claim is tried.
const MOST_CELLS: usize = 3000;
const MOST_TRIED: usize = 24;
/// Most variables that are cut.
const MOST_AXES: usize = 3;
/// What a cell costs in term operations.
const COST: u64 = 60;

/// The sign of each exception.
type Pattern = Vec<bool>;

/// What the cells are sorted by.
struct Conditions<'c> {
    positive: Vec<&'c Expr>,
    loci: Vec<&'c Expr>,
}

/// Where a cell lies.
enum Side {
    /// Some requirement does not hold in it.
    Outside,
    /// On one side of everything.
    Inside(Pattern),
    /// Not known; these patterns are possible.
    Mixed(Vec<Pattern>),
}

impl Search<'_> {
    /// A place in some cell where the claim fails; and why some part of the domain was not looked at.
    pub(super) fn cells(&self) -> (Option<Place>, Option<String>) {
        let joint = self.identities.joint;
        let required = joint.spec.requirements.iter().map(|r| &r.value.value);
        let conditions = Conditions {
            positive: required.chain(&self.sides).collect(),
            loci: joint
                .space
                .loci
                .iter()
                .map(|locus| &locus.value.function)
                .collect(),
        };
        let all = conditions.positive.iter().chain(&conditions.loci);
        let symbols: BTreeSet<Symbol> = all.flat_map(|e| e.symbols()).collect();
        if symbols.is_empty() {
            return (None, None);
        }
        let (whole, complete) = axes::whole(joint, &symbols);
        if !complete || whole.len() > MOST_AXES {
            // Points beside every exception were drawn; which patterns they met is not known.
            return (
                None,
                Some("its domain has more components than can be distinguished".into()),
            );
        }
        let (found, open) = self.sorted(&conditions, whole);
        let mut refuting = None;
        let mut unreached: BTreeSet<Pattern> = open;
        for (pattern, cells) in found {
            let (place, tried) = self.try_cells(&cells);
            refuting = Place::larger(refuting, place);
            if tried {
                unreached.remove(&pattern);
            } else {
                unreached.insert(pattern);
            }
        }
        let unreached = unreached.first().map(|pattern| self.in_words(pattern));
        (refuting, unreached)
    }

    /// Cells inside, by pattern, the larger ones first; and the patterns that cells left over may hold.
    fn sorted(
        &self,
        conditions: &Conditions<'_>,
        whole: Box,
    ) -> (BTreeMap<Pattern, Vec<Box>>, BTreeSet<Pattern>) {
        let mut found: BTreeMap<Pattern, Vec<Box>> = BTreeMap::new();
        let mut left = BTreeSet::new();
        let mut open = VecDeque::from([whole]);
        let mut seen = 0;
        while let Some(cell) = open.pop_front() {
            seen += 1;
            match conditions.side(&cell) {
                Side::Outside => {}
                Side::Inside(pattern) => found.entry(pattern).or_default().push(cell),
                Side::Mixed(patterns) => {
                    let more = seen < MOST_CELLS && budget::spend(COST);
                    match axes::halves(&cell).filter(|_| more) {
                        Some(halves) => open.extend(halves),
                        None => left.extend(patterns),
                    }
                }
            }
        }
        // Beside every zero of a condition some cells are always left: they count where no cell inside has their pattern.
        left.retain(|pattern| !found.contains_key(pattern));
        (found, left)
    }

    /// A place where the claim fails in some of the cells; and whether it was tried in one at all.
    fn try_cells(&self, cells: &[Box]) -> (Option<Place>, bool) {
        let mut sampler = Sampler::new(&self.identities.joint.space, super::BITS).single();
        let (mut refuting, mut tried) = (None, false);
        let mut cells: Vec<&Box> = cells.iter().collect();
        cells.sort_by(|a, b| axes::extent(a).total_cmp(&axes::extent(b)));
        // From near 0 to as far as there are any: components of the domain may follow each other.
        let step = cells.len().div_ceil(MOST_TRIED).max(1);
        let chosen = cells.iter().step_by(step);
        for cell in chosen {
            let Some(mut point) = sampler.anywhere() else {
                continue;
            };
            axes::move_to_middle(&mut point, cell);
            let Some(point) = self.on_manifold(&point).filter(|point| self.admits(point)) else {
                continue;
            };
            match self.at(&point) {
                Said::Refutes(place) => refuting = Place::larger(refuting, Some(place)),
                Said::Agrees => {
                    tried = true;
                    self.agreeing.set(self.agreeing.get() + 1);
                }
                Said::Nothing => {}
            }
        }
        (refuting, tried)
    }

    fn in_words(&self, pattern: &[bool]) -> String {
        let loci = self.identities.joint.space.loci.iter().zip(pattern);
        let signs: Vec<String> = loci
            .map(|(locus, positive)| {
                let sign = if *positive { ">" } else { "<" };
                format!("{} {sign} 0", locus.value.function)
            })
            .collect();
        match signs.is_empty() {
            true => "no values of the parameters were found that meet every `require`".into(),
            false => format!("no point was found where {}", signs.join(" and ")),
        }
    }
}

impl Conditions<'_> {
    fn side(&self, cell: &Box) -> Side {
        let mut enclosure = Enclosure::new(BITS);
        axes::bind(&mut enclosure, cell, BITS);
        let required: Vec<_> = self.positive.iter().map(|e| enclosure.of(e)).collect();
        let never =
            |value: &crate::precise::Interval| value.is_negative() || value.high().is_zero();
        if required.iter().any(never) {
            return Side::Outside;
        }
        let loci: Vec<_> = self.loci.iter().map(|e| enclosure.of(e)).collect();
        let mut patterns: Vec<Pattern> = vec![vec![]];
        for value in &loci {
            let signs: &[bool] = match (value.is_positive(), value.is_negative()) {
                (true, _) => &[true],
                (_, true) => &[false],
                _ => &[false, true],
            };
            let longer = patterns.iter().flat_map(|pattern| {
                signs.iter().map(|sign| {
                    let mut pattern = pattern.clone();
                    pattern.push(*sign);
                    pattern
                })
            });
            patterns = longer.collect();
        }
        let decided = patterns.len() == 1 && required.iter().all(|value| value.is_positive());
        match (decided, patterns.pop()) {
            (true, Some(pattern)) => Side::Inside(pattern),
            (_, Some(last)) => {
                patterns.push(last);
                Side::Mixed(patterns)
            }
            (_, None) => Side::Outside,
        }
    }
}
