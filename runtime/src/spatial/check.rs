//! What makes a matrix a rotation, and a pose a pose.

use super::Pose;
use crate::shown::Number;
use nalgebra::Matrix3;

/// Largest entry of RᵀR − I that is taken for rounding of the input.
pub const ROTATION_TOLERANCE: f64 = 1e-9;

/// Why a pose is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// A number is NaN or infinite.
    #[error("{part} entry ({row}, {column}) is {value}, not a finite number", value = Number(*.value))]
    NotFinite {
        /// `rotation` or `translation`.
        part: &'static str,
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        column: usize,
        /// Its value.
        value: f64,
    },
    /// RᵀR differs from the identity.
    #[error(
        "rotation matrix is not orthonormal: RᵀR differs from the identity by {deviation:e}, more than {ROTATION_TOLERANCE:e}"
    )]
    NotOrthonormal {
        /// Largest entry of RᵀR − I.
        deviation: f64,
    },
    /// The determinant is −1.
    #[error("rotation matrix has determinant {determinant}: it is a reflection", determinant = Number(*.determinant))]
    Reflection {
        /// det R.
        determinant: f64,
    },
}

impl Pose<f64> {
    /// Whether this is a rigid displacement, its rotation orthonormal to [`ROTATION_TOLERANCE`].
    ///
    /// # Errors
    /// NaN or infinity; RᵀR ≠ I; det R < 0.
    pub fn check(&self) -> Result<(), PoseError> {
        check_finite("rotation", self.rotation.as_slice())?;
        check_finite("translation", self.translation.as_slice())?;
        let gram = self.rotation.transpose() * self.rotation;
        let deviation = (gram - Matrix3::identity()).amax();
        if deviation > ROTATION_TOLERANCE {
            return Err(PoseError::NotOrthonormal { deviation });
        }
        let determinant = self.rotation.determinant();
        if determinant < 0.0 {
            return Err(PoseError::Reflection { determinant });
        }
        Ok(())
    }
}

/// Entries in column-major order with three rows.
fn check_finite(part: &'static str, entries: &[f64]) -> Result<(), PoseError> {
    match entries
        .iter()
        .enumerate()
        .find(|(_, value)| !value.is_finite())
    {
        Some((index, &value)) => Err(PoseError::NotFinite {
            part,
            row: index % 3 + 1,
            column: index / 3 + 1,
            value,
        }),
        None => Ok(()),
    }
}
