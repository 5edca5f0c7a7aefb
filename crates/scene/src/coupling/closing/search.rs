//! The posture in which loops close that is nearest to a guess.
//!
//! Newton's method from the guess ends on some posture, and not always on the nearest one: it may step over a fold, or count a whole turn that no joint needs. What is nearer
//! lies in the ball around the guess that reaches to the posture found. So the ball is sampled, each sample is closed in its turn, and the ball shrinks with what is found.
//! Distances are Euclidean in the coordinates, in rad and in lengths of the linkage.

use super::newton::Loops;
use hamel_runtime::joint::MOST_LINKS;
use std::f64::consts::PI;

/// Samples from which loops are closed. Nearer ones come first.
pub(super) const GUESSES: u32 = 128;

/// Steps along the postures that lead nearer to the guess.
const STEPS: usize = 24;

/// Part by which a posture must be nearer than another to be taken in its place, and distance below which none is looked for: digits that files leave out.
const CLEARLY: f64 = 1e-6;

/// Multiples of the roots of primes fill a box evenly, as no sum of whole multiples of them is whole.
const PRIMES: [f64; MOST_LINKS] = [
    2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0, 47.0, 53.0,
];

/// What is looked for.
pub(super) struct Search<'s> {
    pub(super) loops: &'s Loops<'s>,
    pub(super) guess: &'s [f64],
    /// The coordinates that may move.
    pub(super) free: &'s [bool],
    /// Where coordinates are to be, from the least to the greatest value.
    pub(super) ranges: &'s [[f64; 2]],
    /// Whether loops that close at a configuration may be closed so.
    pub(super) is_sound: &'s dyn Fn(&[f64]) -> bool,
}

/// A posture with its distance from the guess.
struct Found(f64, Vec<f64>);

impl Search<'_> {
    /// The nearest posture that is sound and, where there is such a one, within the ranges. From far away it is looked for only if `anywhere`; otherwise Newton's method must lead from
    /// the guess to a posture.
    ///
    /// # Errors
    /// The configuration where the ends come nearest to each other.
    pub(super) fn posture(&self, anywhere: bool) -> Result<Vec<f64>, Vec<f64>> {
        let first = self.loops.closed(self.guess, self.free);
        let failed = first.as_ref().err().cloned();
        let first = first.ok().map(|q| self.improved(q));
        let within = first.as_ref().filter(|own| self.suits(&own.1));
        let (mut best, mut outside) = match within {
            Some(Found(distance, q)) => (Some(Found(*distance, q.clone())), None),
            None => (None, first),
        };
        if best.is_some() || anywhere {
            self.sample(&mut best, &mut outside);
        }
        let found = best.or(outside).map(|Found(_, q)| q);
        found.ok_or_else(|| failed.unwrap_or_else(|| self.guess.to_vec()))
    }

    /// Closes the loops from samples of the ball around the guess that reaches to the best posture known, and keeps the nearest within the ranges and the nearest sound one beyond them.
    fn sample(&self, best: &mut Option<Found>, outside: &mut Option<Found>) {
        for number in 1..=GUESSES {
            let reach = best.as_ref().map_or(f64::INFINITY, |own| own.0);
            if reach <= CLEARLY {
                return;
            }
            let Ok(closed) = self.loops.closed(&self.sampled(number, reach), self.free) else {
                continue;
            };
            let own = self.improved(closed);
            let place = match self.suits(&own.1) {
                true => &mut *best,
                false if (self.is_sound)(&own.1) => &mut *outside,
                false => continue,
            };
            let is_nearer = |other: &Found| own.0 < other.0 * (1.0 - CLEARLY);
            let takes = match place {
                Some(other) => is_nearer(other) || !(self.is_sound)(&other.1),
                None => true,
            };
            if takes {
                *place = Some(own);
            }
        }
    }

    /// A sample of the ball of radius `reach`, of half a turn and the length of the linkage at most; the first ones are near its middle.
    fn sampled(&self, number: u32, reach: f64) -> Vec<f64> {
        let share = f64::from(number) / f64::from(GUESSES);
        let guess = self.guess.iter().zip(PRIMES).enumerate();
        let guess = guess.map(|(k, (at, prime))| {
            let part = 2.0 * (f64::from(number) * prime.sqrt()).fract() - 1.0;
            let most = if self.loops.slides(k) { 1.0 } else { PI };
            match self.free[k] {
                true => at + part * share * most.min(reach) * self.loops.unit(k),
                false => *at,
            }
        });
        guess.collect()
    }

    /// The same posture without turns that nothing asks for, and then the nearest one to which it leads.
    fn improved(&self, q: Vec<f64>) -> Found {
        let q = self.unturned(q);
        let mut best = Found(self.distance(&q), q);
        for _ in 0..STEPS {
            if best.0 <= CLEARLY {
                break;
            }
            let ahead = self.loops.tangent(&best.1, self.guess, self.free);
            let Some(nearer) = ahead.and_then(|step| self.advanced(&best, &step)) else {
                break;
            };
            let gained = best.0 - nearer.0;
            best = nearer;
            if gained <= CLEARLY * best.0 {
                break;
            }
        }
        best
    }

    /// What lies nearer along a step, or along a half, a quarter or an eighth of it.
    fn advanced(&self, from: &Found, step: &[f64]) -> Option<Found> {
        [1.0, 0.5, 0.25, 0.125].iter().find_map(|part| {
            let way = from.1.iter().zip(step);
            let ahead: Vec<f64> = way.map(|(at, step)| at + part * step).collect();
            let q = self.loops.closed(&ahead, self.free).ok()?;
            let found = Found(self.distance(&q), q);
            (found.0 < from.0).then_some(found)
        })
    }

    /// The same posture with each angle, as far as it is free to turn, by whole turns as near to its guess as its range lets it be.
    fn unturned(&self, mut q: Vec<f64>) -> Vec<f64> {
        let turn = 2.0 * PI;
        for k in (0..q.len()).filter(|&k| self.free[k] && !self.loops.slides(k)) {
            let nearest = q[k] - turn * ((q[k] - self.guess[k]) / turn).round();
            let [lower, upper] = self.ranges[k];
            let wanted = match nearest {
                value if value < lower => value + turn * ((lower - value) / turn).ceil(),
                value if value > upper => value - turn * ((value - upper) / turn).ceil(),
                value => value,
            };
            let wanted = if self.is_within(k, wanted) {
                wanted
            } else {
                nearest
            };
            let before = std::mem::replace(&mut q[k], wanted);
            // Joints that follow by a ratio, and sums of positions, know turns from each other.
            if before != wanted && !self.loops.is_closed(&q) {
                q[k] = before;
            }
        }
        q
    }

    fn is_within(&self, k: usize, value: f64) -> bool {
        let [lower, upper] = self.ranges[k];
        lower <= value && value <= upper
    }

    fn suits(&self, q: &[f64]) -> bool {
        let mut values = q.iter().enumerate();
        values.all(|(k, value)| self.is_within(k, *value)) && (self.is_sound)(q)
    }

    fn distance(&self, q: &[f64]) -> f64 {
        let away = q.iter().zip(self.guess).enumerate();
        let away = away.map(|(k, (value, guess))| (value - guess) / self.loops.unit(k));
        away.map(|own| own * own).sum::<f64>().sqrt()
    }
}
