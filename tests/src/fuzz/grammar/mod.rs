//! Random specs that know the grammar: true ones, and false ones that differ from a true one by a small, far or narrow error.
//!
//! A true spec is true by construction (coordinates that stand in H as they are, factors that are sums of positive terms, zeros that are
//! identities); a false one is a true one with a flaw, and says where that shows.

mod draft;
mod families;
mod flaw;
mod formulas;

pub use draft::Made;

use crate::enclosure::Point;
use chacha20::ChaCha8Rng;
use draft::Draft;
use rand::{RngExt, SeedableRng};

/// Spec number `seed`.
pub fn made(seed: u64) -> Made {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x9e37_79b9_7f4a_7c15);
    let mut draft = Draft::new(&format!("made_{seed}"));
    families::fill(&mut draft, &mut random);
    let planted = random
        .random_bool(0.55)
        .then(|| flaw::plant(&mut draft, &mut random))
        .flatten();
    draft.finish(planted)
}

/// Points at which to judge: where the flaw shows, near home, and far from it on both sides of everything.
pub fn points(made: &Made, parameters: usize, dimensions: usize, seed: u64) -> Vec<Point> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut points = vec![];
    let sizes = [1.0, 1.0, 8.0, 64.0];
    for (n, size) in sizes.into_iter().enumerate() {
        let mut number = |size: f64| size * random.random_range(-1.0..1.0_f64);
        let mut point = Point {
            parameters: (0..parameters).map(|_| 0.25 + number(1.0).abs()).collect(),
            chart: (0..dimensions).map(|_| number(size)).collect(),
        };
        if n == 1 {
            point.parameters.iter_mut().for_each(|p| *p *= 1000.0);
        }
        for (place, value) in &made.parameters {
            if let Some(entry) = point.parameters.get_mut(*place) {
                *entry = *value;
            }
        }
        if n == 0 {
            let mut shown = point.clone();
            for (place, value) in &made.chart {
                if let Some(entry) = shown.chart.get_mut(*place) {
                    *entry = *value;
                }
            }
            points.push(shown);
        }
        points.push(point);
    }
    points
}
