//! Reproducible numbers for tests.

use nalgebra::{SVector, Vector3};

/// A linear congruential generator (Knuth's MMIX constants): the same numbers everywhere.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        let mut random = Self(seed.wrapping_mul(2) + 1);
        // The first outputs of neighbouring seeds are alike.
        (0..8).for_each(|_| {
            random.next();
        });
        random
    }

    /// In [−1, 1).
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn vector<const D: usize>(&mut self) -> SVector<f64, D> {
        SVector::from_fn(|_, _| self.next())
    }

    pub fn vec(&mut self, size: usize) -> Vec<f64> {
        (0..size).map(|_| self.next()).collect()
    }

    pub fn rotation_vector(&mut self) -> Vector3<f64> {
        self.vector::<3>() * 1.7
    }
}
