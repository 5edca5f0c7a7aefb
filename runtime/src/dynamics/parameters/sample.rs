//! Configurations at which a joint is looked at, and how its bodies stand and move there.

use super::ParameterError;
use super::scale::Scale;
use crate::mechanism::{Body, Mechanism};
use crate::spatial::{Pose, SpatialInertia, energy_row};
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;
use nalgebra::{DVector, Matrix6xX, SMatrix, Vector6};

/// Configurations of each joint beside its home. Conditions are linear in ten unknowns a body: generic configurations say all of it in the first few.
const SAMPLES: usize = 24;
/// Configurations that are drawn for them at most.
const DRAWS: usize = 60 * SAMPLES;
/// Longest entries of ϕ from home, rad or m, one after the other: a linkage may not be assembled far from home.
const REACHES: [f64; 4] = [2.5, 1.2, 0.5, 0.1];
/// Least value of the functions that are zero where the joint is singular, as a part of that at home.
const PART_OF_HOME: f64 = 0.1;

/// Numbers in [−1, 1), the same on every machine (splitmix64).
pub(super) struct Random(u64);

impl Random {
    pub(super) const fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(super) fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Configurations of one joint away from home.
///
/// # Errors
/// Where too few of those drawn are configurations of the joint.
pub(super) fn configurations(
    mechanism: &Mechanism,
    joint: usize,
    count: usize,
    random: &mut Random,
) -> Result<Vec<Vec<f64>>, ParameterError> {
    let body = &mechanism.bodies()[joint];
    let clearance = PART_OF_HOME * body.joint().singularity(&body.home());
    let mut found = vec![];
    for draw in 0..DRAWS {
        if found.len() == count {
            return Ok(found);
        }
        let reach = REACHES[draw % REACHES.len()];
        let phi: Vec<f64> = (0..body.ranges().freedoms.len())
            .map(|_| reach * random.number())
            .collect();
        let moved = mechanism.configuration_from_local(joint, &phi).ok();
        let is_clear = |q: &Vec<f64>| {
            let value = body.joint().singularity(q);
            value == f64::INFINITY || value >= clearance
        };
        found.extend(moved.filter(is_clear));
    }
    match found.len() == count {
        true => Ok(found),
        false => Err(ParameterError::NoConfiguration {
            joint: String::from(body.joint_name()),
            found: found.len(),
            drawn: DRAWS,
        }),
    }
}

/// One body of a joint at one configuration, in units of length of the [`Scale`].
pub(super) struct Place {
    /// The body frame in the parent's body frame.
    pub(super) pose: Pose<f64>,
    /// Parameters in the body frame to those in the parent's.
    pub(super) transport: SMatrix<f64, 10, 10>,
    /// X, a column a degree of freedom, in the body frame.
    pub(super) twists: Vec<Vector6<f64>>,
}

impl Place {
    fn new(body: &Body, q: &[f64], scale: &Scale) -> Self {
        let joint = body.joint();
        let child = body.child_placement();
        let pose = scale.pose(&body.placement().compose(&joint.pose(q)).compose(child));
        let mut map = Matrix6xX::zeros(joint.layout().freedoms);
        joint.twist_map_child(q, map.as_mut_slice());
        let columns = map.column_iter();
        let twists = columns.map(|column| scale.twist(&child.act_twist_inverse(&column.into())));
        Self {
            transport: transport(&pose),
            twists: twists.collect(),
            pose,
        }
    }

    /// A functional of parameters in the parent's body frame as one of those in the body frame.
    pub(super) fn of_parent(&self, functional: &DVector<f64>) -> DVector<f64> {
        let read = self.transport.tr_mul(functional);
        DVector::from_column_slice(read.as_slice())
    }

    /// The functional of two twists on parameters, `Uᵀ N V`.
    pub(super) fn pair(u: &Vector6<f64>, v: &Vector6<f64>) -> DVector<f64> {
        DVector::from_column_slice(&energy_row(u, v))
    }
}

/// Parameters in the child frame of a pose to those in its parent frame.
pub(super) fn transport(pose: &Pose<f64>) -> SMatrix<f64, 10, 10> {
    let columns: [_; 10] = core::array::from_fn(|i| {
        let unit = core::array::from_fn(|j| f64::from(u8::from(i == j)));
        let moved = SpatialInertia::from_parameters(&unit).transform(pose);
        nalgebra::SVector::from(moved.parameters())
    });
    SMatrix::from_columns(&columns)
}

/// A joint at its home, and at configurations of which the first is not its home; in each the bodies that it carries.
pub(super) struct Samples {
    pub(super) bodies: Range<usize>,
    pub(super) home: Vec<Place>,
    pub(super) others: Vec<Vec<Place>>,
}

impl Samples {
    /// The joint that carries `bodies`.
    ///
    /// # Errors
    /// Where too few configurations are found.
    pub(super) fn new(
        mechanism: &Mechanism,
        bodies: Range<usize>,
        scale: &Scale,
        random: &mut Random,
    ) -> Result<Self, ParameterError> {
        let joint = bodies.start;
        let freedoms = mechanism.bodies()[joint].ranges().freedoms.len();
        let count = if freedoms == 0 { 0 } else { SAMPLES };
        let all = configurations(mechanism, joint, count, random)?;
        let places = |q: &Vec<f64>| -> Vec<Place> {
            let own = mechanism.bodies()[bodies.clone()].iter();
            own.map(|body| Place::new(body, q, scale)).collect()
        };
        let home = places(&mechanism.bodies()[joint].home());
        let mut others: Vec<_> = all.iter().map(places).collect();
        even(&mut others);
        Ok(Self {
            bodies,
            home,
            others,
        })
    }
}

/// Makes the largest twist of each degree of freedom over all configurations and bodies one of size 1: v may have any unit.
fn even(samples: &mut [Vec<Place>]) {
    let count = samples.first().map_or(0, |places| places[0].twists.len());
    for column in 0..count {
        let sizes = samples.iter().flatten();
        let largest = sizes.fold(0.0, |most: f64, place| {
            most.max(place.twists[column].norm())
        });
        if largest > 0.0 {
            let places = samples.iter_mut().flatten();
            places.for_each(|place| place.twists[column] /= largest);
        }
    }
}
