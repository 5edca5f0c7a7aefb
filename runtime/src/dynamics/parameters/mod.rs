//! Base inertial parameters: the fewest combinations of inertial parameters on which a mechanism's dynamics depend.
//!
//! Found joint by joint, from the structure of the tree. From the world outward: which twists, which kinetic energies and which directions of
//! gravity a body can have at all (`motions.rs`). At each joint: which inertias of its bodies can be moved to its parent without a difference
//! (`transfer.rs`); where the parent can move in every way that is N_X of the joint, which the generator derived from its spec, and nearer to the
//! world there is more. Each such inertia is a combination of parameters without effect: so much on the bodies, and as much less on the parent. These combinations
//! are independent, and for holonomic joints there are no others: of a combination without effect take the part on a body that carries none; it meets the conditions of
//! `transfer.rs` since nothing else changes with the coordinates and speeds of its joint; moved to the parent it leaves a combination on a smaller tree.
//!
//! Solving the combinations for one parameter each, their pivots, gives the base parameters `B π`: every other parameter, plus multiples of the pivots.
//!
//! What is proved, and what is measured. That an element of N_X does not act is an identity in the joint's coordinates, found over the rationals. That
//! other elements do not act is found at two dozen configurations of the joint, in doubles, to a tolerance, and measured at the random states of the
//! [`Certificate`]. That no further combination is without effect is what its smallest singular value says. Of nonholonomic joints X is taken whole, as if they could
//! move in every way: what is left out then does not act, but they may feel less than that (a joint that points without spin does not feel I_zz).
//! [`Certificate::is_minimal`] is false then.

mod certificate;
mod combination;
mod motions;
mod sample;
mod scale;
mod span;
mod transfer;

pub use certificate::Certificate;
pub use combination::Combination;

use super::JointTorqueRegressor;
use crate::mechanism::{Mechanism, StateError, WHOLE, check_size};
use crate::spatial::{INERTIAL_PARAMETER_NAMES, INERTIAL_PARAMETERS};
use alloc::format;
use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;
use motions::Motions;
use nalgebra::{DMatrix, DVector};
use sample::{Random, Samples};
use scale::Scale;
use transfer::{Element, elements, subtract};

/// To which part of their terms conditions must be met to count as met: far above rounding, far below angles and lengths that someone meant.
pub const PARAMETER_TOLERANCE: f64 = 1e-10;

/// Entries of what is moved to a parent below this part of the largest are rounding of a rotation.
const ROUNDING: f64 = 1e-14;

/// Why base parameters are not found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// A joint that can hardly be moved from home.
    #[error(
        "joint `{joint}`: of {drawn} displacements from home only {found} lead to a configuration that is not singular: its base parameters cannot be determined"
    )]
    NoConfiguration {
        /// The joint.
        joint: String,
        /// How many configurations were found.
        found: usize,
        /// How many were drawn.
        drawn: usize,
    },
    /// A tolerance that is none.
    #[error("tolerance is {tolerance}: it must be at least 0 and below 1")]
    Tolerance {
        /// The tolerance.
        tolerance: f64,
    },
    /// A vector has the wrong size or holds a number that is not finite.
    #[error(transparent)]
    State(#[from] StateError),
}

/// A parameter that is none of the base parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Its place in π.
    pub parameter: usize,
    /// Whether it enters base parameters; otherwise nothing feels it.
    pub is_regrouped: bool,
    /// Whether it is left out for an element of N_X of its body's joint, which is derived from the joint's spec; otherwise because its parent, or the
    /// world, does not move in every way, or because of the other bodies of its joint, which was found at sampled configurations.
    pub is_derived: bool,
}

/// The base parameters of a mechanism, `B π` for the inertial parameters π of [`Mechanism::inertial_parameters`].
///
/// Efforts are those of the tree: what constraints that couple joints take off is not considered.
#[derive(Clone, Debug)]
pub struct BaseParameters {
    mechanism: Arc<Mechanism>,
    kept: Vec<usize>,
    left_out: Vec<LeftOut>,
    matrix: DMatrix<f64>,
    certificate: Certificate,
    margin: (f64, f64),
}

impl BaseParameters {
    /// Those of a mechanism, to [`PARAMETER_TOLERANCE`].
    ///
    /// # Errors
    /// A joint of which too few configurations are found; what is not finite.
    pub fn new(mechanism: &Arc<Mechanism>) -> Result<Self, ParameterError> {
        Self::within(mechanism, PARAMETER_TOLERANCE)
    }

    /// Those of a mechanism, where conditions that are met to the part `tolerance` of their terms count as met: a parameter that acts less than that
    /// does not count as felt. An axis that is written as 1.5708 rad beside the vertical asks for 1e-5.
    ///
    /// # Errors
    /// Those of [`BaseParameters::new`]; a tolerance below 0 or not below 1.
    pub fn within(mechanism: &Arc<Mechanism>, tolerance: f64) -> Result<Self, ParameterError> {
        if !(0.0..1.0).contains(&tolerance) {
            return Err(ParameterError::Tolerance { tolerance });
        }
        let mut random = Random::new(1);
        let scale = Scale::of(mechanism);
        let mut null = NullSpace::new(mechanism.bodies().len());
        let mut motions: Vec<Motions> = Vec::new();
        let world = Motions::world(mechanism.gravity());
        for (joint, body) in mechanism.joints() {
            let bodies = mechanism.carried(joint);
            let samples = Samples::new(mechanism, bodies.clone(), &scale, &mut random)?;
            let parent = body.parent().map_or(&world, |parent| &motions[parent]);
            let (elements, conditions) = elements(mechanism, &samples, parent, &scale, tolerance);
            null.decide(conditions.least, conditions.most);
            for element in &elements {
                null.add(&samples, body.parent(), element);
            }
            let own = (0..bodies.len()).map(|own| parent.of_child(&samples, own, tolerance));
            let own: Vec<Motions> = own.collect();
            motions.extend(own);
        }
        null.in_base_parameters(mechanism, &scale, &mut random)
    }

    /// How many base parameters there are.
    pub const fn count(&self) -> usize {
        self.kept.len()
    }

    /// The places in π, and the columns of the regressor, of the parameters that stand for the base parameters: each has the coefficient 1 in its own, and 0 in all others.
    pub fn kept(&self) -> &[usize] {
        &self.kept
    }

    /// The other parameters, in the order of π.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// B: a row for each base parameter, a column for each inertial parameter, in SI units.
    pub const fn matrix(&self) -> &DMatrix<f64> {
        &self.matrix
    }

    /// `B π`.
    ///
    /// # Errors
    /// When π does not have ten numbers a body.
    pub fn values(&self, parameters: &[f64]) -> Result<DVector<f64>, StateError> {
        let columns = self.matrix.ncols();
        check_size(WHOLE, "inertial parameters", columns, parameters.len())?;
        Ok(&self.matrix * DVector::from_column_slice(parameters))
    }

    /// The regressor of the base parameters: `Y π = Y_b (B π)`. A row for each speed, a column for each base parameter.
    ///
    /// # Errors
    /// When the regressor has the columns of another mechanism.
    pub fn regressor(&self, regressor: &JointTorqueRegressor) -> Result<DMatrix<f64>, StateError> {
        let (found, expected) = (regressor.columns(), self.matrix.ncols());
        check_size(WHOLE, "regressor columns", expected, found)?;
        let columns = &self.kept;
        Ok(DMatrix::from_fn(regressor.rows(), columns.len(), |i, j| {
            regressor.entry(i, columns[j])
        }))
    }

    /// What the regressor at random states says of them.
    pub const fn certificate(&self) -> &Certificate {
        &self.certificate
    }

    /// How clear the decisions were: to which part of its terms the condition that is violated least is violated, and to which the one that is
    /// met worst is met. The first is above the tolerance, the second below.
    pub const fn margin(&self) -> (f64, f64) {
        self.margin
    }

    /// One base parameter as a sum; without terms for an index out of range.
    pub fn combination(&self, base: usize) -> Combination<'_> {
        Combination::new(self, base)
    }

    /// What a place in π is called, as `I_xx(forearm)`; empty where there is none.
    pub fn name(&self, parameter: usize) -> String {
        let body = self.mechanism.bodies().get(parameter / INERTIAL_PARAMETERS);
        let name = INERTIAL_PARAMETER_NAMES[parameter % INERTIAL_PARAMETERS];
        body.map_or_else(String::new, |body| format!("{name}({})", body.name()))
    }
}

/// Combinations of parameters without effect, in units of length of the scale. Each has 1 at a parameter where all others have 0.
struct NullSpace {
    size: usize,
    rows: Vec<DVector<f64>>,
    /// The row of each parameter that is a pivot.
    pivots: Vec<Option<usize>>,
    derived: Vec<bool>,
    margin: (f64, f64),
}

impl NullSpace {
    fn new(bodies: usize) -> Self {
        let size = INERTIAL_PARAMETERS * bodies;
        Self {
            size,
            rows: Vec::new(),
            pivots: alloc::vec![None; size],
            derived: Vec::new(),
            margin: (1.0, 0.0),
        }
    }

    /// Takes the clearness of one joint's conditions.
    fn decide(&mut self, least: f64, most: f64) {
        self.margin = (self.margin.0.min(least), self.margin.1.max(most));
    }

    /// Adds what a joint can move to its parent, whose own is there already.
    fn add(&mut self, samples: &Samples, parent: Option<usize>, element: &Element) {
        let mut row = DVector::zeros(self.size);
        let start = INERTIAL_PARAMETERS * samples.bodies.start;
        row.rows_mut(start, element.entries.len())
            .copy_from(&element.entries);
        if let Some(parent) = parent {
            let place = INERTIAL_PARAMETERS * parent;
            let bodies = samples.home.iter().enumerate();
            let mut moved = DVector::zeros(INERTIAL_PARAMETERS);
            for (number, body) in bodies {
                let own = INERTIAL_PARAMETERS * number;
                moved += body.transport * element.entries.rows(own, INERTIAL_PARAMETERS);
            }
            let limit = ROUNDING * moved.amax();
            moved.apply(|entry| *entry = if entry.abs() <= limit { 0.0 } else { -*entry });
            row.rows_mut(place, INERTIAL_PARAMETERS).copy_from(&moved);
            for parameter in place..place + INERTIAL_PARAMETERS {
                if let Some(known) = self.pivots[parameter] {
                    subtract(&mut row, &self.rows[known], parameter, ROUNDING);
                }
            }
        }
        self.pivots[start + element.pivot] = Some(self.rows.len());
        self.rows.push(row);
        self.derived.push(element.is_derived);
    }

    /// Everything in SI units, and the certificate.
    fn in_base_parameters(
        mut self,
        mechanism: &Arc<Mechanism>,
        scale: &Scale,
        random: &mut Random,
    ) -> Result<BaseParameters, ParameterError> {
        let places = 0..self.size;
        let kept: Vec<usize> = places
            .clone()
            .filter(|&k| self.pivots[k].is_none())
            .collect();
        let mut matrix = DMatrix::zeros(kept.len(), self.size);
        for (base, &place) in kept.iter().enumerate() {
            matrix[(base, place)] = 1.0;
        }
        let mut left_out = Vec::new();
        for (parameter, row) in places.filter_map(|k| Some((k, self.pivots[k]?))) {
            let own = &mut self.rows[row];
            for (place, entry) in own.iter_mut().enumerate() {
                *entry *= scale.unit(place) / scale.unit(parameter);
            }
            let mut is_regrouped = false;
            for (base, &place) in kept.iter().enumerate() {
                matrix[(base, parameter)] = 0.0 - own[place];
                is_regrouped |= own[place] != 0.0;
            }
            left_out.push(LeftOut {
                parameter,
                is_regrouped,
                is_derived: self.derived[row],
            });
        }
        let certificate = certificate::certificate(mechanism, &kept, &self.rows, random)?;
        Ok(BaseParameters {
            mechanism: Arc::clone(mechanism),
            kept,
            left_out,
            matrix,
            certificate,
            margin: self.margin,
        })
    }
}
