//! Random values of parameters, and random elements of the known manifolds.

use super::Precise;
use crate::expr::{Expr, Number};
use crate::manifold::{Factor, Kind};
use crate::model::Interval;
use crate::precise::Point;
use chacha20::ChaCha8Rng;
use chacha20::rand_core::Rng;

/// Sizes of parameters and, halved, of real coordinates, where nothing else is declared: of order 1, and not near 0.
const SMALLEST: f64 = 0.2;
const LARGEST: f64 = 2.0;

/// Random numbers of a stated precision.
#[derive(Debug)]
pub(super) struct Draw {
    pub random: ChaCha8Rng,
    pub bits: usize,
    /// How many times as far as usual real coordinates and parameters without an end lie from 0.
    pub reach: f64,
}

impl Draw {
    /// In [0, 1), to all bits.
    pub fn fraction(&mut self) -> Precise {
        let words: Vec<u64> = (0..self.bits.div_ceil(64))
            .map(|_| self.random.next_u64())
            .collect();
        Precise::fraction_of_words(&words, self.bits)
    }

    /// In [`lower`, `upper`).
    pub fn between(&mut self, lower: f64, upper: f64) -> Precise {
        let lower = Precise::from_f64(lower, self.bits);
        let upper = Precise::from_f64(upper, self.bits);
        &lower + &(self.fraction() * (&upper - &lower))
    }

    /// A value of a parameter, inside its range and away from its ends and from 0.
    pub fn parameter(&mut self, range: &Interval) -> Precise {
        let unit = Precise::integer(1, self.bits);
        let end =
            |end: &Option<crate::model::End>| end.as_ref().map(|end| unit.rational(&end.value));
        let size = self.between(SMALLEST * self.reach, LARGEST * self.reach);
        match (end(&range.lower), end(&range.upper)) {
            (None, None) => match self.random.next_u32().is_multiple_of(2) {
                true => size,
                false => -size,
            },
            (Some(lower), None) => lower + size,
            (None, Some(upper)) => upper - size,
            (Some(lower), Some(upper)) => {
                let part = self.between(0.05, 0.95);
                &lower + &(part * (&upper - &lower))
            }
        }
    }

    /// Uniform on a known compact manifold or group; real coordinates and translations within ±2, or as many times that as `reach` says.
    pub fn element(&mut self, kind: Kind) -> Vec<Precise> {
        match kind {
            Kind::Real(size) => self.real(size),
            Kind::S1 => self.unit(2),
            Kind::S2 => self.unit(3),
            Kind::S3 => self.unit(4),
            Kind::So2 => planar(&self.unit(2), &[]),
            Kind::Se2 => {
                let translation = self.real(2);
                planar(&self.unit(2), &translation)
            }
            Kind::So3 => rotation(&self.unit(4), &[]),
            Kind::Se3 => {
                let translation = self.real(3);
                rotation(&self.unit(4), &translation)
            }
        }
    }

    /// Home, with a random displacement of every scalar by at most `size`, times `reach`.
    pub fn near(&mut self, home: &[Precise], size: f64) -> Vec<Precise> {
        let size = size * self.reach;
        home.iter()
            .map(|value| value + &self.between(-size, size))
            .collect()
    }

    fn real(&mut self, size: usize) -> Vec<Precise> {
        let reach = LARGEST * self.reach;
        (0..size).map(|_| self.between(-reach, reach)).collect()
    }

    /// Uniform on the unit sphere: a point of the ball, normalised.
    fn unit(&mut self, size: usize) -> Vec<Precise> {
        loop {
            let x: Vec<Precise> = (0..size).map(|_| self.between(-1.0, 1.0)).collect();
            let square = x
                .iter()
                .fold(x[0].same(0), |sum, entry| sum + entry * entry);
            // Near the centre the direction would lose digits.
            if (0.01..1.0).contains(&square.to_f64()) {
                let norm = square.sqrt();
                return x.iter().map(|entry| entry / &norm).collect();
            }
        }
    }
}

fn planar(unit: &[Precise], translation: &[Precise]) -> Vec<Precise> {
    let [c, s] = [&unit[0], &unit[1]];
    let entries = [c.clone(), -s, s.clone(), c.clone()];
    bordered(2, &entries, translation)
}

/// The rotation of a unit quaternion, by the formula that the generator uses, and a translation beside it.
fn rotation(quaternion: &[Precise], translation: &[Precise]) -> Vec<Precise> {
    let symbols = Factor::new("q", Kind::S3, crate::expr::Role::Intermediate, 0, true).coordinates;
    let mut point = Point::new(0, quaternion[0].bits());
    for (symbol, value) in symbols.iter().zip(quaternion) {
        point.bind(symbol, value.clone());
    }
    let symbols: Vec<Expr> = symbols.iter().map(Expr::symbol).collect();
    let entries = point.matrix(&crate::algebra::rotation_of_quaternion(&symbols));
    bordered(3, &entries, translation)
}

fn bordered(size: usize, rotation: &[Precise], translation: &[Precise]) -> Vec<Precise> {
    let row = |i: usize| {
        let turn = rotation[size * i..size * (i + 1)].iter();
        turn.chain(translation.get(i)).cloned()
    };
    (0..size).flat_map(row).collect()
}
