//! Efforts between bounds, and what gives way where they are at a bound: a linear complementarity problem.
//!
//! Wanted are x and `a = c + W x`, W symmetric and positive definite, with `l ≤ x ≤ u` and for each i: `a_i = 0` where `x_i` is between its bounds,
//! `a_i ≥ 0` where it is at the lower one, `a_i ≤ 0` where it is at the upper one. There is one solution. It is found by block principal pivoting
//! (J. J. Júdice and F. M. Pires, *A block principal pivoting algorithm for large-scale strictly monotone linear complementarity problems*, 1994), which changes the
//! place of all entries that are wrong at once as long as they become fewer, and else one at a time in a fixed order, which ends always (K. G. Murty).

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Rounding of x and a, as parts of the terms that they are sums of.
const ROUNDING: f64 = 1e-12;

/// Blocks may be changed so many times without fewer wrong entries.
const PATIENCE: usize = 10;

/// Where an entry of x is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Place {
    Between,
    AtLower,
    AtUpper,
}

/// The problem.
#[derive(Debug)]
pub(super) struct Problem {
    /// W.
    pub(super) matrix: DMatrix<f64>,
    /// c.
    pub(super) free: DVector<f64>,
    /// l and u.
    pub(super) bounds: Vec<(f64, f64)>,
}

/// What solves it.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) places: Vec<Place>,
    /// x.
    pub(super) efforts: DVector<f64>,
    /// Where a is 0 up to rounding.
    pub(super) is_still: Vec<bool>,
}

impl Problem {
    /// The solution, looked for from `places` on; `None` where W is not positive definite, or where it is not found.
    pub(super) fn solve(&self, mut places: Vec<Place>) -> Option<Found> {
        let size = self.bounds.len();
        let (mut fewest, mut patience) = (size + 1, PATIENCE);
        // Murty's rule alone may need as many as there are places of all entries: nothing that is met does.
        for _ in 0..1000 + 100 * size {
            let efforts = self.efforts(&places)?;
            let moves = self.moves(&places, &efforts);
            if moves.is_empty() {
                return Some(self.found(places, efforts));
            }
            if moves.len() < fewest {
                (fewest, patience) = (moves.len(), PATIENCE);
            } else if patience > 0 {
                patience -= 1;
            } else {
                let &(index, place) = moves.last()?;
                places[index] = place;
                continue;
            }
            for (index, place) in moves {
                places[index] = place;
            }
        }
        None
    }

    /// x where its entries have these places.
    fn efforts(&self, places: &[Place]) -> Option<DVector<f64>> {
        let mut x = DVector::zeros(places.len());
        let mut between = vec![];
        for (i, place) in places.iter().enumerate() {
            match place {
                Place::Between => between.push(i),
                Place::AtLower => x[i] = self.bounds[i].0,
                Place::AtUpper => x[i] = self.bounds[i].1,
            }
        }
        if between.is_empty() {
            return Some(x);
        }
        let known = &self.free + &self.matrix * &x;
        let own = self.matrix.select_rows(&between).select_columns(&between);
        let factors = Cholesky::new(own)?;
        let found = factors.solve(&-known.select_rows(&between));
        let is_finite = found.iter().all(|effort| effort.is_finite());
        for (&i, effort) in between.iter().zip(&found) {
            x[i] = *effort;
        }
        is_finite.then_some(x)
    }

    fn found(&self, places: Vec<Place>, efforts: DVector<f64>) -> Found {
        let a = &self.free + &self.matrix * &efforts;
        let is_still = (0..places.len()).map(|i| a[i].abs() <= self.rounding(i, &efforts));
        Found {
            is_still: is_still.collect(),
            places,
            efforts,
        }
    }

    /// What rounding makes of one entry of a.
    fn rounding(&self, i: usize, x: &DVector<f64>) -> f64 {
        let row = self.matrix.row(i);
        let terms = row.iter().zip(x).map(|(w, x)| (w * x).abs());
        ROUNDING * (self.free[i].abs() + terms.sum::<f64>())
    }

    /// Entries that are in the wrong place, and where they go.
    fn moves(&self, places: &[Place], x: &DVector<f64>) -> Vec<(usize, Place)> {
        let a = &self.free + &self.matrix * x;
        let size = |i: usize| self.rounding(i, x);
        let move_of = |i: usize| {
            let (lower, upper) = self.bounds[i];
            match places[i] {
                Place::Between => {
                    let room = size(i) / self.matrix[(i, i)];
                    let below = (x[i] < lower - room).then_some(Place::AtLower);
                    below.or((x[i] > upper + room).then_some(Place::AtUpper))
                }
                Place::AtLower => (a[i] < -size(i)).then_some(Place::Between),
                Place::AtUpper => (a[i] > size(i)).then_some(Place::Between),
            }
        };
        let all = 0..places.len();
        all.filter_map(|i| Some((i, move_of(i)?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::{Place, Problem};
    use alloc::vec;
    use alloc::vec::Vec;
    use nalgebra::{DMatrix, DVector};

    /// Numbers between −1 and 1 that look random.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    fn problem(size: usize, seed: u64) -> Problem {
        let mut number = numbers(seed);
        let root = DMatrix::from_fn(size, size, |_, _| number());
        let bounds = (0..size).map(|i| match i % 3 {
            0 => (-0.3, 0.3),
            1 => (0.0, f64::INFINITY),
            _ => (f64::NEG_INFINITY, 0.2),
        });
        Problem {
            matrix: &root * root.transpose() + DMatrix::identity(size, size) * 0.05,
            free: DVector::from_fn(size, |_, _| number()),
            bounds: bounds.collect(),
        }
    }

    /// Whether x and a are what the problem asks, by its own words.
    fn is_solved(problem: &Problem, x: &DVector<f64>) -> bool {
        let a = &problem.free + &problem.matrix * x;
        // Sums of ten numbers of size 1 to 10, twice solved for with condition numbers of some hundreds.
        let rounding = 1e-11;
        problem
            .bounds
            .iter()
            .enumerate()
            .all(|(i, &(lower, upper))| {
                let is_within = x[i] >= lower - rounding && x[i] <= upper + rounding;
                let can_fall = x[i] > lower + rounding;
                let can_rise = x[i] < upper - rounding;
                is_within && !(can_fall && a[i] > rounding) && !(can_rise && a[i] < -rounding)
            })
    }

    #[test]
    fn bounds_and_signs_hold_from_every_start() {
        for seed in 0..200 {
            let problem = problem(1 + seed as usize % 10, seed);
            let size = problem.bounds.len();
            let between = problem.solve(vec![Place::Between; size]);
            let between = between.expect("W is positive definite");
            assert!(is_solved(&problem, &between.efforts), "seed {seed}");
            // There is one solution: where the search begins does not matter.
            let at_bounds = problem
                .bounds
                .iter()
                .map(|bounds| match bounds.0.is_finite() {
                    true => Place::AtLower,
                    false => Place::AtUpper,
                });
            let other = problem.solve(at_bounds.collect::<Vec<_>>());
            let other = other.expect("W is positive definite");
            let difference = (other.efforts - between.efforts).amax();
            assert!(difference < 1e-10, "seed {seed}: {difference:e}");
        }
    }

    #[test]
    fn what_cannot_move_has_no_effort() {
        let problem = Problem {
            matrix: DMatrix::zeros(1, 1),
            free: DVector::from_element(1, 1.0),
            bounds: vec![(-1.0, 1.0)],
        };
        assert!(problem.solve(vec![Place::Between]).is_none());
    }
}
