//! Closing of loops from a guess: Newton's method on all relations, redundant ones among them.

use hamel_runtime::joint::{Link, LinkMotion, MOST_LINKS, Tie};
use nalgebra::{DMatrix, DVector};

/// Steps of Newton's method. It doubles the digits from a guess that is near; the others are for guesses that are far.
const STEPS: usize = 60;

/// Longest step, rad and lengths of the linkage: what turns farther leads to another branch.
const LONGEST: f64 = 0.5;

/// Residual, as part of the size of the linkage, at which a loop is closed.
const CLOSED: f64 = 1e-12;

/// Part of the largest singular value below which a direction of the relations is one that others imply.
const IMPLIED: f64 = 1e-9;

/// Links and what holds them together, with the length that makes numbers of lengths.
#[derive(Clone, Debug)]
pub(super) struct Loops<'l> {
    pub(super) links: &'l [Link],
    pub(super) ties: &'l [Tie],
    pub(super) coordinates: usize,
    pub(super) length: f64,
}

impl Loops<'_> {
    /// For each tie its relations: value and derivatives along all coordinates, as numbers.
    pub(super) fn rows(&self, q: &[f64]) -> Vec<Vec<(f64, Vec<f64>)>> {
        let units: Vec<f64> = (0..self.coordinates).map(|k| self.unit(k)).collect();
        let ties = self.ties.iter().map(|tie| {
            let mut rows = Vec::new();
            let lengths = lengths(tie, self.links);
            tie.relations(
                self.links,
                q,
                |(value, slopes): (f64, [f64; MOST_LINKS])| {
                    let is_length = lengths.get(rows.len()).is_some_and(|own| *own);
                    let scale = if is_length { 1.0 / self.length } else { 1.0 };
                    let slopes = slopes.iter().zip(&units);
                    let slopes = slopes.map(|(slope, unit)| slope * scale * unit);
                    rows.push((value * scale, slopes.collect()));
                },
            );
            rows
        });
        ties.collect()
    }

    pub(super) fn slides(&self, coordinate: usize) -> bool {
        let mut links = self.links.iter();
        let first = links.find(|link| link.coordinate == coordinate);
        first.is_some_and(|link| link.motion == LinkMotion::Slide)
    }

    /// What makes a number of a coordinate: 1 rad, or the length of the linkage.
    pub(super) fn unit(&self, coordinate: usize) -> f64 {
        match self.slides(coordinate) {
            true => self.length,
            false => 1.0,
        }
    }

    /// Whether all ties hold.
    pub(super) fn is_closed(&self, q: &[f64]) -> bool {
        self.residual(q) <= CLOSED
    }

    /// Root of the sum of squares of all relations, as numbers.
    pub(super) fn residual(&self, q: &[f64]) -> f64 {
        let rows = self.rows(q).into_iter().flatten();
        rows.map(|(value, _)| value * value).sum::<f64>().sqrt()
    }

    /// A configuration on all ties that is near the guess, where only free coordinates move; otherwise the one where they come nearest.
    pub(super) fn closed(&self, guess: &[f64], free: &[bool]) -> Result<Vec<f64>, Vec<f64>> {
        let mut q = guess.to_vec();
        let mut best = (self.residual(&q), q.clone());
        for _ in 0..STEPS {
            let Some(step) = self.step(&q, free) else {
                break;
            };
            let length = step.norm();
            let part = if length > LONGEST {
                LONGEST / length
            } else {
                1.0
            };
            for (k, way) in step.iter().enumerate() {
                q[k] += part * way * self.unit(k);
            }
            let residual = self.residual(&q);
            if residual < best.0 {
                best = (residual, q.clone());
            }
            if length < f64::EPSILON {
                break;
            }
        }
        match best.0 <= CLOSED {
            true => Ok(best.1),
            false => Err(best.1),
        }
    }

    /// Whether no small motion brings the ends nearer: where a linkage is stretched, or folded.
    pub(super) fn is_stuck(&self, q: &[f64]) -> bool {
        let rows = self.rows(q).into_iter().flatten();
        let mut slope = vec![0.0; self.coordinates];
        for (value, slopes) in rows {
            slope
                .iter_mut()
                .zip(slopes)
                .for_each(|(sum, own)| *sum += value * own);
        }
        let steepest = slope.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
        steepest <= IMPLIED * self.residual(q)
    }

    /// The shortest step that solves the relations to first order.
    fn step(&self, q: &[f64], free: &[bool]) -> Option<DVector<f64>> {
        let (values, slopes) = self.linear(q, free)?;
        let svd = slopes.svd(true, true);
        let largest = svd.singular_values.max();
        svd.solve(&-values, IMPLIED * largest).ok()
    }

    /// The way from q to `aim` in free coordinates, except for what leads off the ties to first order.
    pub(super) fn tangent(&self, q: &[f64], aim: &[f64], free: &[bool]) -> Option<Vec<f64>> {
        let (_, slopes) = self.linear(q, free)?;
        let way = |k: usize| match free[k] {
            true => (aim[k] - q[k]) / self.unit(k),
            false => 0.0,
        };
        let way = DVector::from_fn(self.coordinates, |k, _| way(k));
        let svd = slopes.svd(false, true);
        let least = IMPLIED * svd.singular_values.max();
        let rows = svd.v_t?;
        let off = svd.singular_values.iter().zip(rows.row_iter());
        let off = off.filter(|(value, _)| **value > least);
        let along = off.fold(way.clone(), |left, (_, row)| {
            left - row.transpose() * (row * &way)[0]
        });
        let along = along.iter().enumerate();
        Some(along.map(|(k, way)| way * self.unit(k)).collect())
    }

    /// The values of all relations, and their derivatives along free coordinates, if they are finite.
    fn linear(&self, q: &[f64], free: &[bool]) -> Option<(DVector<f64>, DMatrix<f64>)> {
        let rows: Vec<(f64, Vec<f64>)> = self.rows(q).into_iter().flatten().collect();
        let values = DVector::from_iterator(rows.len(), rows.iter().map(|(value, _)| *value));
        let slope = |i: usize, k: usize| match free[k] {
            true => rows[i].1[k],
            false => 0.0,
        };
        let slopes = DMatrix::from_fn(rows.len(), self.coordinates, slope);
        let mut all = slopes.iter().chain(&values);
        all.all(|entry| entry.is_finite())
            .then_some((values, slopes))
    }
}

/// Which relations of a tie are lengths.
fn lengths(tie: &Tie, links: &[Link]) -> Vec<bool> {
    use hamel_runtime::joint::Relation::Meets;
    match tie {
        Tie::Sum { terms, .. } => {
            let first = terms.first().and_then(|(link, _)| links.get(*link));
            vec![first.is_some_and(|link| link.motion == LinkMotion::Slide)]
        }
        Tie::Closure { relations, .. } => {
            let relations = relations.iter();
            relations.map(|own| matches!(own, Meets(_))).collect()
        }
    }
}
