//! The eigenvalues of A⁻¹, which take the system of all stages apart into one for each real eigenvalue and one for each complex pair.
//!
//! `A⁻¹ = T Λ T⁻¹`. They only enter the iteration, not its result, so that eigenvectors to a few digits would do.

use alloc::vec::Vec;
use nalgebra::{Complex, DMatrix, DVector};

/// One block of the system.
#[derive(Clone, Debug)]
pub(super) enum Mode {
    /// A real eigenvalue λ.
    Real(Line<f64>),
    /// An eigenvalue λ with its conjugate.
    Pair(Line<Complex<f64>>),
}

/// An eigenvalue with its row of T⁻¹ and its column of T.
#[derive(Clone, Debug)]
pub(super) struct Line<T> {
    pub(super) value: T,
    /// One entry a stage.
    pub(super) row: Vec<T>,
    pub(super) column: Vec<T>,
}

/// The real eigenvalue of `A⁻¹`, for a matrix that has one.
pub(super) fn real(matrix: &[&[f64]]) -> Option<f64> {
    modes(matrix).iter().find_map(|mode| match mode {
        Mode::Real(line) => Some(line.value),
        Mode::Pair(_) => None,
    })
}

/// The blocks of `A⁻¹`, the real ones first.
pub(super) fn modes(matrix: &[&[f64]]) -> Vec<Mode> {
    let size = matrix.len();
    let inverse = DMatrix::from_fn(size, size, |i, j| matrix[i][j]).try_inverse();
    // All collocation matrices are regular; without blocks the iteration would be that of fixed points.
    let Some(inverse) = inverse else {
        return Vec::new();
    };
    let values = inverse.complex_eigenvalues();
    let complex = inverse.map(Complex::from);
    let mut found: Vec<Mode> = Vec::new();
    for value in values.iter().filter(|value| is_real(value)) {
        let line = line(&complex, *value);
        let real = |entries: &[Complex<f64>]| entries.iter().map(|entry| entry.re).collect();
        found.push(Mode::Real(Line {
            value: line.value.re,
            row: real(&line.row),
            column: real(&line.column),
        }));
    }
    let upper = values
        .iter()
        .filter(|value| !is_real(value) && value.im > 0.0);
    found.extend(upper.map(|value| Mode::Pair(line(&complex, *value))));
    found
}

fn is_real(value: &Complex<f64>) -> bool {
    value.im.abs() <= 1e-10 * value.re.abs()
}

/// Left and right eigenvectors with a product of 1.
fn line(matrix: &DMatrix<Complex<f64>>, value: Complex<f64>) -> Line<Complex<f64>> {
    let column = eigenvector(matrix, value);
    let row = eigenvector(&matrix.transpose(), value);
    let product: Complex<f64> = row.iter().zip(column.iter()).map(|(a, b)| a * b).sum();
    Line {
        value,
        row: row.iter().map(|entry| entry / product).collect(),
        column: column.iter().copied().collect(),
    }
}

/// By inverse iteration beside the eigenvalue.
fn eigenvector(matrix: &DMatrix<Complex<f64>>, value: Complex<f64>) -> DVector<Complex<f64>> {
    let size = matrix.nrows();
    // Far enough from it for the system to be regular, near enough for one step to gain nine digits.
    let beside = value * (1.0 + 1e-9);
    let shifted = matrix - DMatrix::identity(size, size) * beside;
    let factors = shifted.lu();
    let mut vector = DVector::from_element(size, Complex::from(1.0));
    for _ in 0..3 {
        if let Some(next) = factors.solve(&vector) {
            let norm = next.norm();
            vector = next / Complex::from(norm);
        }
    }
    vector
}

#[cfg(test)]
mod tests {
    use super::super::coefficients::{GAUSS_2, GAUSS_3, MIDPOINT, RADAU_5};
    use super::{Mode, modes};
    use nalgebra::DMatrix;

    #[test]
    fn blocks_make_up_the_inverse() {
        for method in [MIDPOINT, GAUSS_2, GAUSS_3, RADAU_5] {
            let size = method.nodes.len();
            let inverse = DMatrix::from_fn(size, size, |i, j| method.matrix[i][j])
                .try_inverse()
                .expect("regular");
            let mut sum = DMatrix::zeros(size, size);
            for mode in modes(method.matrix) {
                sum += DMatrix::from_fn(size, size, |i, j| match &mode {
                    Mode::Real(line) => line.value * line.column[i] * line.row[j],
                    Mode::Pair(line) => (line.value * line.column[i] * line.row[j]).re * 2.0,
                });
            }
            // Eigenvectors come to rounding times the condition of a 3×3 matrix.
            assert!(
                (sum - &inverse).amax() < 1e-12 * inverse.amax(),
                "{method:?}"
            );
        }
    }

    #[test]
    fn ends_are_weights_times_the_inverse() {
        for method in [MIDPOINT, GAUSS_2, GAUSS_3, RADAU_5] {
            for (j, weight) in method.weights.iter().enumerate() {
                let sum: f64 = (0..method.nodes.len())
                    .map(|i| method.ends[i] * method.matrix[i][j])
                    .sum();
                // Three rounded products of numbers below 2.
                assert!((sum - weight).abs() < 1e-15, "{method:?}");
            }
        }
    }
}
