//! Which shared sums to pull out: one at a time, the one that saves most.

use super::cube::{Cube, Term, combined, common};
use super::numbers::Numbers;
use super::pool::Pool;
use std::collections::HashMap;

/// Most pairs of terms looked at in one kernel: a bound on the work, half a second. Sums that would exceed it are left alone.
const MOST_PAIRS: usize = 150_000;

/// Most shared sums pulled out of one kernel: a bound on the work, far above what joints need.
const MOST_DIVISORS: usize = 4000;

/// Pulls shared sums out of all sums of the pool, while that saves operations.
pub fn extract(pool: &mut Pool) {
    let mut search = Search::new(pool);
    for _ in 0..MOST_DIVISORS {
        let Some(best) = search.best() else { break };
        let Some(variable) = pool.divisor(search.divisors[best].terms.clone()) else {
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
    known: HashMap<[Term; 2], usize>,
    /// Whether each term of each sum is still there.
    alive: Vec<Vec<bool>>,
    /// Divisors of the pairs that each term of each sum is in.
    pairs: Vec<Vec<Vec<(usize, usize)>>>,
    budget: usize,
}

impl Search {
    fn new(pool: &mut Pool) -> Self {
        let mut search = Self {
            divisors: vec![],
            known: HashMap::new(),
            alive: vec![],
            pairs: vec![],
            budget: MOST_PAIRS,
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
        let Pool { sums, numbers, .. } = pool;
        let [a, b] = terms.map(|term| &sums[sum][term]);
        let (divisor, quotient) = divided(numbers, a, b);
        let after = quotient.multiplications(1);
        let saved = a.multiplications(0) + b.multiplications(0) + 1 - after;
        let at = self.divisor(divisor);
        let divisor = &mut self.divisors[at];
        divisor.saved += saved;
        divisor.live += 1;
        divisor.occurrences.push(Occurrence { sum, terms, saved });
        let occurrence = divisor.occurrences.len() - 1;
        for term in terms {
            self.pairs[sum][term].push((at, occurrence));
        }
    }

    fn divisor(&mut self, terms: [Term; 2]) -> usize {
        let next = self.divisors.len();
        let at = *self.known.entry(terms.clone()).or_insert(next);
        if at == next {
            self.divisors.push(Divisor {
                cost: 1 + terms
                    .iter()
                    .map(|term| term.multiplications(0))
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
    fn best(&self) -> Option<usize> {
        let candidates = self.divisors.iter().enumerate();
        let useful =
            candidates.filter(|(_, divisor)| divisor.live > 1 && divisor.saved > divisor.cost);
        useful
            .max_by_key(|(at, divisor)| (divisor.saved - divisor.cost, std::cmp::Reverse(*at)))
            .map(|(at, _)| at)
    }

    /// Replaces the occurrences of a divisor by its variable; of two that share a term only the first.
    fn replace(&mut self, pool: &mut Pool, best: usize, variable: u16) {
        for occurrence in std::mem::take(&mut self.divisors[best].occurrences) {
            let Occurrence { sum, terms, .. } = occurrence;
            if !terms.iter().all(|term| self.alive[sum][*term]) {
                continue;
            }
            let [a, b] = terms.map(|term| pool.sums[sum][term].clone());
            terms.iter().for_each(|term| self.remove_term(sum, *term));
            let (_, mut quotient) = divided(&mut pool.numbers, &a, &b);
            quotient.cube = combined(&quotient.cube, &vec![(variable, 1)], 1);
            pool.sums[sum].push(quotient);
            let term = pool.sums[sum].len() - 1;
            self.add_term(pool, sum, term);
        }
        self.divisors[best].saved = 0;
        self.divisors[best].live = 0;
    }

    fn remove_term(&mut self, sum: usize, term: usize) {
        self.alive[sum][term] = false;
        for (divisor, occurrence) in std::mem::take(&mut self.pairs[sum][term]) {
            let divisor = &mut self.divisors[divisor];
            let Some(occurrence) = divisor.occurrences.get(occurrence) else {
                continue;
            };
            let other = occurrence.terms.iter().find(|other| **other != term);
            if other.is_some_and(|other| self.alive[sum][*other]) {
                divisor.saved -= occurrence.saved;
                divisor.live -= 1;
            }
        }
    }
}

/// The sum of both terms as a product of a divisor and a term.
fn divided(numbers: &mut Numbers, a: &Term, b: &Term) -> ([Term; 2], Term) {
    let cube: Cube = common(&a.cube, &b.cube);
    let [a, b] = [a, b].map(|term| (combined(&term.cube, &cube, -1), term.coefficient));
    let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
    let pair = numbers.pair(a.1, b.1);
    let [first, second] = pair.parts;
    let part = |cube, coefficient| Term { cube, coefficient };
    (
        [part(a.0, first), part(b.0, second)],
        part(cube, pair.content),
    )
}
