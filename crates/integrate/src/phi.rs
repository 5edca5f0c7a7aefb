//! φ functions of a matrix: `φ₀(z) = eᶻ`, `φ_k(z) = (φ_{k−1}(z) − 1/(k−1)!)/z`, which integrate linear equations exactly.
//!
//! By scaling and doubling (B. Skaflestad and W. M. Wright, *The scaling and modified squaring method for matrix functions related to the
//! exponential*, 2009), on the balanced matrix: that of an oscillator has the norm of its frequency then, and not of the square.
//!
//! In place of φ₀ stands `φ₀ − 1`. Of a slow mode beside a fast one φ₀ is nearly 1 before the doublings, each of which doubles the error of that; the
//! difference from 1 has a small relative error and keeps it.

use super::product::multiply;
use alloc::vec;
use alloc::vec::Vec;
use nalgebra::DMatrix;
use num_traits::Float;

/// φ₀ − 1, φ₁ … φ₄.
const COUNT: usize = 5;

/// Groups of as many terms of φ₄'s series as there are powers: at norm 1 the term after the last, 1/20!, is below half a rounding of 1/4!.
const GROUPS: usize = 4;

/// φ functions of one matrix and of half of it.
pub(super) struct Phi {
    /// Of the matrix: φ₀ − 1, and φ₁ to φ₄.
    whole: [DMatrix<f64>; COUNT],
    /// Of half of it.
    half: [DMatrix<f64>; COUNT],
    matrix: DMatrix<f64>,
    /// The square, the third and the fourth power of the matrix.
    powers: [DMatrix<f64>; 3],
    work: DMatrix<f64>,
    /// The diagonal D of the balanced `D⁻¹ A D`: powers of 2.
    scales: Vec<f64>,
}

impl Phi {
    pub(super) fn new(size: usize) -> Self {
        let zeros = || DMatrix::zeros(size, size);
        Self {
            whole: core::array::from_fn(|_| zeros()),
            half: core::array::from_fn(|_| zeros()),
            matrix: zeros(),
            powers: core::array::from_fn(|_| zeros()),
            work: zeros(),
            scales: vec![1.0; size],
        }
    }

    /// Evaluates them for the matrix of the given entries; whether all is finite.
    pub(super) fn evaluate(&mut self, entry: impl Fn(usize, usize) -> f64) -> bool {
        let size = self.matrix.nrows();
        for i in 0..size {
            for j in 0..size {
                self.matrix[(i, j)] = entry(i, j);
            }
        }
        if self.matrix.iter().any(|entry| !entry.is_finite()) {
            return false;
        }
        self.balance();
        let doublings = self.scale();
        self.sum_series();
        for left in (0..doublings).rev() {
            if left == 0 {
                for (half, whole) in self.half.iter_mut().zip(&self.whole) {
                    half.copy_from(whole);
                }
            }
            self.double();
        }
        self.whole[1].iter().all(|entry| entry.is_finite())
    }

    /// Adds `weight · φ_k x`, of half the matrix or the whole; `weight · (φ₀ − 1) x` for k = 0.
    pub(super) fn add(&self, is_half: bool, k: usize, weight: f64, x: &[f64], sum: &mut [f64]) {
        let phi = if is_half {
            &self.half[k]
        } else {
            &self.whole[k]
        };
        for ((i, sum), own) in sum.iter_mut().enumerate().zip(&self.scales) {
            let row = x.iter().zip(&self.scales).enumerate();
            let product: f64 = row.map(|(j, (x, scale))| phi[(i, j)] * (x / scale)).sum();
            *sum += weight * own * product;
        }
    }

    /// Makes rows and columns alike in size (B. N. Parlett and C. Reinsch, 1969).
    fn balance(&mut self) {
        self.scales.fill(1.0);
        let size = self.matrix.nrows();
        let mut settled = false;
        while !settled {
            settled = true;
            for k in 0..size {
                let others = || (0..size).filter(move |&i| i != k);
                let column: f64 = others().map(|i| self.matrix[(i, k)].abs()).sum();
                let row: f64 = others().map(|j| self.matrix[(k, j)].abs()).sum();
                if column == 0.0 || row == 0.0 {
                    continue;
                }
                // The power of 2 next to √(row/column).
                let factor = Float::exp2(Float::round(0.5 * Float::log2(row / column)));
                if column * factor + row / factor < 0.95 * (column + row) {
                    settled = false;
                    self.scales[k] *= factor;
                    self.matrix
                        .column_mut(k)
                        .iter_mut()
                        .for_each(|x| *x *= factor);
                    self.matrix.row_mut(k).iter_mut().for_each(|x| *x /= factor);
                }
            }
        }
    }

    /// Halves the matrix until its norm is at most 1, and once at least; how often.
    fn scale(&mut self) -> u32 {
        let rows = self.matrix.row_iter();
        let norm = rows.map(|row| row.iter().map(|x| x.abs()).sum::<f64>());
        let norm = norm.fold(0.0, f64::max);
        let mut count = 1;
        let mut factor = 0.5;
        while norm * factor > 1.0 {
            factor *= 0.5;
            count += 1;
        }
        self.matrix *= factor;
        count
    }

    /// All φ of a matrix of norm 1: φ₄ in powers of the fourth power (M. S. Paterson and L. J. Stockmeyer, 1973), the others from it.
    fn sum_series(&mut self) {
        self.raise();
        let Self {
            whole,
            matrix,
            powers: [square, third, fourth],
            work,
            ..
        } = self;
        let last = COUNT - 1;
        work.fill(0.0);
        for group in (0..GROUPS).rev() {
            if group + 1 < GROUPS {
                multiply(fourth, &whole[last], work);
            }
            let first = last + 4 * group;
            for (term, power) in [&*matrix, square, third].into_iter().enumerate() {
                let weight = 1.0 / factorial(first + term + 1);
                work.zip_apply(power, |sum, x| *sum += weight * x);
            }
            add_to_diagonal(work, 1.0 / factorial(first));
            core::mem::swap(&mut whole[last], work);
        }
        for k in (0..last).rev() {
            let (lower, upper) = whole.split_at_mut(k + 1);
            multiply(matrix, &upper[0], &mut lower[k]);
            if k > 0 {
                add_to_diagonal(&mut lower[k], 1.0 / factorial(k));
            }
        }
    }

    fn raise(&mut self) {
        let Self { matrix, powers, .. } = self;
        let [square, third, fourth] = powers;
        multiply(matrix, matrix, square);
        multiply(matrix, square, third);
        multiply(square, square, fourth);
    }

    /// `φ_k(2z) = 2⁻ᵏ (φ₀(z) φ_k(z) + Σ_{j=1}^{k} φ_j(z)/(k−j)!)`, and `φ₀(2z) − 1 = (φ₀(z) − 1)² + 2 (φ₀(z) − 1)`.
    fn double(&mut self) {
        let Self { whole, work, .. } = self;
        for k in (1..COUNT).rev() {
            multiply(&whole[0], &whole[k], work);
            *work += &whole[k];
            for (j, lower) in whole.iter().enumerate().take(k + 1).skip(1) {
                let weight = 1.0 / factorial(k - j);
                work.zip_apply(lower, |sum, x| *sum += weight * x);
            }
            *work *= Float::powi(0.5, k as i32);
            core::mem::swap(&mut whole[k], work);
        }
        multiply(&whole[0], &whole[0], work);
        work.zip_apply(&whole[0], |sum, x| *sum += 2.0 * x);
        core::mem::swap(&mut whole[0], work);
    }
}

fn add_to_diagonal(matrix: &mut DMatrix<f64>, value: f64) {
    for i in 0..matrix.nrows() {
        matrix[(i, i)] += value;
    }
}

fn factorial(k: usize) -> f64 {
    (1..=k).map(|i| i as f64).product()
}

#[cfg(test)]
mod tests {
    use super::Phi;

    /// φ of an oscillator of frequency ω, written as position and speed, over a step of 1.
    #[test]
    fn oscillators_turn() {
        for frequency in [1e-3, 1.0, 30.0, 1e4] {
            let mut phi = Phi::new(2);
            let entries = [[0.0, 1.0], [-frequency * frequency, 0.0]];
            assert!(phi.evaluate(|i, j| entries[i][j]));
            let (mut moved, mut summed) = ([1.0, 0.0], [0.0; 2]);
            phi.add(false, 0, 1.0, &[1.0, 0.0], &mut moved);
            phi.add(false, 1, 1.0, &[0.0, 1.0], &mut summed);
            let (sine, cosine) = frequency.sin_cos();
            // Rounding of the angle ω in every doubling.
            let allowed = 1e-15 * (10.0 + frequency);
            assert!(
                (moved[0] - cosine).abs() < allowed,
                "{frequency}: {moved:?}"
            );
            assert!((moved[1] / frequency + sine).abs() < allowed);
            let expected = (1.0 - cosine) / (frequency * frequency);
            assert!(
                (summed[0] - expected).abs() * frequency < allowed,
                "{summed:?}"
            );
            assert!((summed[1] - sine / frequency).abs() < allowed);
        }
    }

    #[test]
    fn scalars_agree_with_their_definition() {
        let mut phi = Phi::new(1);
        for z in [-40.0_f64, -2.0, 3.0] {
            assert!(phi.evaluate(|_, _| z));
            let mut expected = z.exp_m1();
            let mut factorial = 1.0;
            for k in 0..5 {
                let mut found = [0.0];
                phi.add(false, k, 1.0, &[1.0], &mut found);
                // The quotients cancel a few digits at |z| of 2.
                assert!(
                    (found[0] - expected).abs() < 1e-13 * expected.abs().max(1.0),
                    "{z} {k}"
                );
                // φ₀ − 1 stands for φ₀.
                let own = if k > 0 { 1.0 / factorial } else { 0.0 };
                expected = (expected - own) / z;
                factorial *= (k + 1).max(1) as f64;
            }
        }
    }

    /// A spring k with a damper c at a mass of 1 creeps with the rate k/c, however fast the other mode is: λ = −c (1 ± √(1 − 4k/c²))/2.
    #[test]
    fn slow_modes_keep_their_digits_beside_fast_ones() {
        for stiffness in [1e4, 1e8, 1e12, 1e14] {
            let mut phi = Phi::new(2);
            let entries = [[0.0, 1.0], [-stiffness, -stiffness]];
            assert!(phi.evaluate(|i, j| entries[i][j]));
            let root = (1.0_f64 - 4.0 / stiffness).sqrt();
            let fast = 0.5 * stiffness * (1.0 + root);
            let slow = stiffness / fast;
            // From x = 1 at rest: (fast e^(−slow) − slow e^(−fast))/(fast − slow), at time 1.
            let expected = (fast * (-slow).exp() - slow * (-fast).exp()) / (fast - slow);
            let mut moved = [1.0, 0.0];
            phi.add(false, 0, 1.0, &[1.0, 0.0], &mut moved);
            // Some roundings for each of up to 47 doublings.
            assert!(
                (moved[0] - expected).abs() < 5e-14,
                "{stiffness:e}: {moved:?} {expected}"
            );
        }
    }
}
