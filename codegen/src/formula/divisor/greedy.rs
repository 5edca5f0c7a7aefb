//! Which shared sums to pull out: one at a time, the one that saves most.

use super::cube::{Cubes, Term};
use super::numbers::Numbers;
use super::pool::Pool;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Most pairs of terms looked at in one kernel: a bound on the work, a twentieth of a second. Sums that would exceed it are left alone.
const MOST_PAIRS: usize = 40_000;

/// Most shared sums pulled out of one kernel: a bound on the work, far above what joints need.
const MOST_DIVISORS: usize = 4000;

/// Pulls shared sums out of all sums of the pool, while that saves operations.
pub fn extract(pool: &mut Pool) {
    let mut search = Search::new(pool);
    for _ in 0..MOST_DIVISORS {
        let Some(best) = search.best() else { break };
        let Some(variable) = pool.divisor(search.divisors[best].terms) else {
            break;
        };
        search.replace(pool, best, variable);
    }
    for (terms, alive) in pool.sums.iter_mut().zip(search.alive) {
        // A sum that was left alone has no marks.
        let mut marks = alive.into_iter();
        terms.retain(|_| marks.next().unwrap_or(true));
    }
}

/// A sum of two terms without a common factor.
struct Divisor {
    terms: [Term; 2],
    /// Operations to compute it.
    cost: i64,
    /// Operations that its occurrences save.
    saved: i64,
    occurrences: Vec<Occurrence>,
    live: usize,
}

/// Two terms of a sum that are a multiple of a divisor.
#[derive(Clone, Copy)]
struct Occurrence {
    sum: usize,
    terms: [usize; 2],
    saved: i64,
}

struct Search {
    divisors: Vec<Divisor>,
    known: FxHashMap<[Term; 2], usize>,
    /// Whether each term of each sum is still there.
    alive: Vec<Vec<bool>>,
    /// Divisors of the pairs that each term of each sum is in.
    pairs: Vec<Vec<Vec<(usize, usize)>>>,
    budget: usize,
    /// Gains and divisors; those whose gain has changed since stand there once more.
    gains: BinaryHeap<(i64, Reverse<usize>)>,
}

impl Divisor {
    /// Operations that pulling it out saves, where that is worth it.
    fn gain(&self) -> Option<i64> {
        (self.live > 1 && self.saved > self.cost).then(|| self.saved - self.cost)
    }
}

impl Search {
    fn new(pool: &mut Pool) -> Self {
        let mut search = Self {
            divisors: vec![],
            known: FxHashMap::default(),
            alive: vec![],
            pairs: vec![],
            budget: MOST_PAIRS,
            gains: BinaryHeap::new(),
        };
        for sum in 0..pool.sums.len() {
            search.alive.push(vec![]);
            search.pairs.push(vec![]);
            let terms = pool.sums[sum].len();
            let count = terms * terms.saturating_sub(1) / 2;
            if count > search.budget {
                continue;
            }
            for term in 0..terms {
                search.add_term(pool, sum, term);
            }
        }
        search
    }

    /// Looks at the pairs of a new term with those before it.
    fn add_term(&mut self, pool: &mut Pool, sum: usize, term: usize) {
        self.alive[sum].push(true);
        self.pairs[sum].push(vec![]);
        for other in 0..term {
            if self.alive[sum][other] && self.budget > 0 {
                self.budget -= 1;
                self.add_pair(pool, sum, [other, term]);
            }
        }
    }

    fn add_pair(&mut self, pool: &mut Pool, sum: usize, terms: [usize; 2]) {
        let [a, b] = terms.map(|term| pool.sums[sum][term]);
        let (divisor, quotient) = divided(&mut pool.numbers, &mut pool.cubes, a, b);
        let cubes = &pool.cubes;
        let after = cubes.multiplications(quotient, 1);
        let saved = cubes.multiplications(a, 0) + cubes.multiplications(b, 0) + 1 - after;
        let at = self.divisor(cubes, divisor);
        let divisor = &mut self.divisors[at];
        divisor.saved += saved;
        divisor.live += 1;
        divisor.occurrences.push(Occurrence { sum, terms, saved });
        let occurrence = divisor.occurrences.len() - 1;
        self.offer(at);
        for term in terms {
            self.pairs[sum][term].push((at, occurrence));
        }
    }

    fn divisor(&mut self, cubes: &Cubes, terms: [Term; 2]) -> usize {
        let next = self.divisors.len();
        let at = *self.known.entry(terms).or_insert(next);
        if at == next {
            self.divisors.push(Divisor {
                cost: 1 + terms
                    .map(|term| cubes.multiplications(term, 0))
                    .iter()
                    .sum::<i64>(),
                terms,
                saved: 0,
                occurrences: vec![],
                live: 0,
            });
        }
        at
    }

    /// The divisor that saves most, the first found among equals.
    fn best(&mut self) -> Option<usize> {
        while let Some((gain, Reverse(at))) = self.gains.pop() {
            if self.divisors[at].gain() == Some(gain) {
                return Some(at);
            }
        }
        None
    }

    /// Puts a divisor in line where it is worth it.
    fn offer(&mut self, at: usize) {
        let gain = self.divisors[at].gain();
        self.gains.extend(gain.map(|gain| (gain, Reverse(at))));
    }

    /// Replaces the occurrences of a divisor by its variable; of two that share a term only the first.
    fn replace(&mut self, pool: &mut Pool, best: usize, variable: u16) {
        for occurrence in std::mem::take(&mut self.divisors[best].occurrences) {
            let Occurrence { sum, terms, .. } = occurrence;
            if !terms.iter().all(|term| self.alive[sum][*term]) {
                continue;
            }
            let [a, b] = terms.map(|term| pool.sums[sum][term]);
            terms.iter().for_each(|term| self.remove_term(sum, *term));
            let (_, mut quotient) = divided(&mut pool.numbers, &mut pool.cubes, a, b);
            quotient.cube = pool.cubes.times(quotient.cube, variable);
            pool.sums[sum].push(quotient);
            let term = pool.sums[sum].len() - 1;
            self.add_term(pool, sum, term);
        }
        self.divisors[best].saved = 0;
        self.divisors[best].live = 0;
    }

    fn remove_term(&mut self, sum: usize, term: usize) {
        self.alive[sum][term] = false;
        for (at, occurrence) in std::mem::take(&mut self.pairs[sum][term]) {
            let divisor = &mut self.divisors[at];
            let Some(occurrence) = divisor.occurrences.get(occurrence) else {
                continue;
            };
            let other = occurrence.terms.iter().find(|other| **other != term);
            if other.is_some_and(|other| self.alive[sum][*other]) {
                divisor.saved -= occurrence.saved;
                divisor.live -= 1;
                self.offer(at);
            }
        }
    }
}

/// The sum of both terms as a product of a divisor and a term.
fn divided(numbers: &mut Numbers, cubes: &mut Cubes, a: Term, b: Term) -> ([Term; 2], Term) {
    let divided = cubes.divided(a.cube, b.cube);
    let mut parts = [
        (divided.parts[0], a.coefficient),
        (divided.parts[1], b.coefficient),
    ];
    if divided.descending {
        parts.reverse();
    }
    let [a, b] = parts;
    let pair = numbers.pair(a.1, b.1);
    let [first, second] = pair.parts;
    let part = |cube, coefficient| Term { cube, coefficient };
    (
        [part(a.0, first), part(b.0, second)],
        part(divided.common, pair.content),
    )
}
