//! Mass properties of a body, and what makes them physical.

use crate::shown::Number;
use nalgebra::{Matrix3, Vector3};

/// Rounding that an inertia matrix may show, in units of the trace of the inertia about the frame's origin: an inertia about
/// the centre of mass is often what is left of that one.
const INERTIA_TOLERANCE: f64 = 16.0 * f64::EPSILON;

/// The numbers of [`MassProperties`] in the order in which they are checked.
const QUANTITIES: [&str; 13] = [
    "mass",
    "centre of mass x",
    "centre of mass y",
    "centre of mass z",
    "inertia entry (1, 1)",
    "inertia entry (2, 1)",
    "inertia entry (3, 1)",
    "inertia entry (1, 2)",
    "inertia entry (2, 2)",
    "inertia entry (3, 2)",
    "inertia entry (1, 3)",
    "inertia entry (2, 3)",
    "inertia entry (3, 3)",
];

/// Mass, centre of mass, and inertia about the centre of mass, in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the body frame, m.
    pub com: Vector3<f64>,
    /// Inertia about the centre of mass, in body axes, kg m².
    pub inertia_com: Matrix3<f64>,
}

/// Why mass properties are refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MassError {
    /// A number is NaN or infinite.
    #[error("{quantity} is {value}, not a finite number", value = Number(*.value))]
    NotFinite {
        /// Which number.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// The mass is below zero.
    #[error("mass is {mass} kg: it must be at least 0", mass = Number(*.mass))]
    NegativeMass {
        /// The mass given.
        mass: f64,
    },
    /// First moments of a body without mass.
    #[error(
        "mass is 0 and a first moment of size {moment} kg m is not: it is the mass times the position of the centre of mass",
        moment = Number(*.moment)
    )]
    MomentWithoutMass {
        /// The largest of them.
        moment: f64,
    },
    /// The inertia matrix differs from its transpose.
    #[error(
        "inertia is not symmetric: its ({row}, {column}) entry {upper} and its ({column}, {row}) entry {lower} differ by \
         more than {limit:e} kg m²", upper = Number(*.upper), lower = Number(*.lower))]
    NotSymmetric {
        /// Row, counted from 1.
        row: usize,
        /// Column, counted from 1.
        column: usize,
        /// Entry above the diagonal.
        upper: f64,
        /// Entry below the diagonal.
        lower: f64,
        /// Largest difference allowed.
        limit: f64,
    },
    /// A principal moment is below zero.
    #[error("inertia has the principal moment {moment:e} kg m²: it must be at least -{limit:e}")]
    NotPositive {
        /// Smallest principal moment.
        moment: f64,
        /// How far below zero is taken for rounding.
        limit: f64,
    },
    /// A principal moment exceeds the sum of the other two.
    #[error(
        "inertia breaks the triangle inequality: its largest principal moment {largest:e} kg m² exceeds the sum {sum:e} of \
         the other two by more than {limit:e}"
    )]
    Triangle {
        /// Largest principal moment.
        largest: f64,
        /// Sum of the other two.
        sum: f64,
        /// Excess that is taken for rounding.
        limit: f64,
    },
}

impl MassProperties {
    /// Checked mass properties.
    ///
    /// # Errors
    /// Those of [`MassProperties::check`].
    pub fn new(mass: f64, com: Vector3<f64>, inertia_com: Matrix3<f64>) -> Result<Self, MassError> {
        let properties = Self {
            mass,
            com,
            inertia_com,
        };
        properties.check().map(|()| properties)
    }

    /// A body without mass.
    pub fn massless() -> Self {
        Self {
            mass: 0.0,
            com: Vector3::zeros(),
            inertia_com: Matrix3::zeros(),
        }
    }

    /// Whether a rigid body can have these properties, to 16 ε of the trace of its inertia about the
    /// body frame's origin.
    ///
    /// # Errors
    /// NaN or infinity; a negative mass; an inertia that is not symmetric, not positive, or breaks the triangle
    /// inequality.
    pub fn check(&self) -> Result<(), MassError> {
        self.check_finite()?;
        if self.mass < 0.0 {
            return Err(MassError::NegativeMass { mass: self.mass });
        }
        let about_origin =
            self.inertia_com.trace().abs() + 2.0 * self.mass * self.com.norm_squared();
        let limit = INERTIA_TOLERANCE * about_origin;
        self.check_symmetric(limit)?;
        self.check_principal_moments(limit)
    }

    fn check_finite(&self) -> Result<(), MassError> {
        let entries = self.com.iter().chain(&self.inertia_com);
        let values = core::iter::once(&self.mass).chain(entries);
        // The inertia is stored column by column.
        match QUANTITIES.iter().zip(values).find(|(_, v)| !v.is_finite()) {
            Some((quantity, &value)) => Err(MassError::NotFinite { quantity, value }),
            None => Ok(()),
        }
    }

    fn check_symmetric(&self, limit: f64) -> Result<(), MassError> {
        for (row, column) in [(0, 1), (0, 2), (1, 2)] {
            let upper = self.inertia_com[(row, column)];
            let lower = self.inertia_com[(column, row)];
            if (upper - lower).abs() > limit {
                return Err(MassError::NotSymmetric {
                    row: row + 1,
                    column: column + 1,
                    upper,
                    lower,
                    limit,
                });
            }
        }
        Ok(())
    }

    fn check_principal_moments(&self, limit: f64) -> Result<(), MassError> {
        let eigenvalues = self.inertia_com.symmetric_eigenvalues();
        let (smallest, largest) = (eigenvalues.min(), eigenvalues.max());
        if smallest < -limit {
            return Err(MassError::NotPositive {
                moment: smallest,
                limit,
            });
        }
        let sum = self.inertia_com.trace() - largest;
        if largest > sum + limit {
            return Err(MassError::Triangle {
                largest,
                sum,
                limit,
            });
        }
        Ok(())
    }
}
