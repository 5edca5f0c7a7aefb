//! The ten inertial parameters of a body, and the body regressor: the wrench on a body is linear in them.

use super::fused::cross;
use super::{MassError, MassProperties, SpatialInertia, Symmetric3, hat, split};
use crate::scalar::Scalar;
use nalgebra::{Matrix3, SMatrix, Vector3, Vector6};

/// How many inertial parameters a body has.
pub const INERTIAL_PARAMETERS: usize = 10;

/// Names of the inertial parameters, in their order: that of Pinocchio.
pub const INERTIAL_PARAMETER_NAMES: [&str; INERTIAL_PARAMETERS] = [
    "m", "mc_x", "mc_y", "mc_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz",
];

/// Their units, as [`INERTIAL_PARAMETER_NAMES`].
pub const INERTIAL_PARAMETER_UNITS: [&str; INERTIAL_PARAMETERS] = [
    "kg", "kg m", "kg m", "kg m", "kg m²", "kg m²", "kg m²", "kg m²", "kg m²", "kg m²",
];

impl<T: Scalar> SpatialInertia<T> {
    /// `[m, mc_x, mc_y, mc_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz]`, I about the **origin of the frame**: kg, kg m, kg m².
    pub fn parameters(&self) -> [T; INERTIAL_PARAMETERS] {
        let (first, i) = (&self.first_moment, &self.inertia);
        [
            self.mass, first.x, first.y, first.z, i.xx, i.xy, i.yy, i.xz, i.yz, i.zz,
        ]
    }

    /// The inverse of [`SpatialInertia::parameters`]. Any ten numbers are an inertia here, also one that no rigid body has.
    pub fn from_parameters(parameters: &[T; INERTIAL_PARAMETERS]) -> Self {
        let [mass, x, y, z, xx, xy, yy, xz, yz, zz] = *parameters;
        Self {
            mass,
            first_moment: Vector3::new(x, y, z),
            inertia: Symmetric3 {
                xx,
                xy,
                xz,
                yy,
                yz,
                zz,
            },
        }
    }
}

impl MassProperties {
    /// The ten parameters [`INERTIAL_PARAMETER_NAMES`] in the body frame: kg, kg m, kg m². The inertia is about the **origin of the body frame**,
    /// not about the centre of mass.
    pub fn inertial_parameters(&self) -> [f64; INERTIAL_PARAMETERS] {
        SpatialInertia::from(self).parameters()
    }

    /// The inverse of [`MassProperties::inertial_parameters`], checked.
    ///
    /// # Errors
    /// Those of [`MassProperties::check`]; first moments without a mass.
    pub fn from_inertial_parameters(
        parameters: &[f64; INERTIAL_PARAMETERS],
    ) -> Result<Self, MassError> {
        let inertia = SpatialInertia::from_parameters(parameters);
        let (mass, moment) = (inertia.mass, inertia.first_moment);
        if mass == 0.0 && moment != Vector3::zeros() {
            return Err(MassError::MomentWithoutMass {
                moment: moment.amax(),
            });
        }
        let com = match mass == 0.0 {
            true => moment,
            false => moment / mass,
        };
        // Steiner's terms of the origin seen from the centre of mass.
        let central = hat(&com) * hat(&moment) + inertia.inertia.matrix();
        Self::new(mass, com, central)
    }
}

/// The body regressor, 6×10: `N V̇ − ad_Vᵀ N V` of [`SpatialInertia::wrench`] is this matrix times the [`SpatialInertia::parameters`] of N.
///
/// V is `twist`, rad/s and m/s, V̇ is `rate`; both, N and the wrench (moment; force) are in one frame. Gravity is part of V̇, as an upward
/// acceleration.
pub fn body_regressor<T: Scalar>(
    twist: &Vector6<T>,
    rate: &Vector6<T>,
) -> SMatrix<T, 6, INERTIAL_PARAMETERS> {
    let ((omega, linear), (alpha, rate)) = (split(twist), split(rate));
    // Acceleration of the point at the origin.
    let origin = rate + cross(&omega, &linear);
    let turn = hat(&omega);
    let mut regressor = SMatrix::<T, 6, INERTIAL_PARAMETERS>::zeros();
    let mut put = |row: usize, column: usize, values: &Vector3<T>| {
        regressor
            .fixed_view_mut::<3, 1>(row, column)
            .copy_from(values);
    };
    put(3, 0, &origin);
    let (lever, points) = (-hat(&origin), hat(&alpha) + turn * turn);
    for k in 0..3 {
        put(0, 1 + k, &lever.column(k).into_owned());
        put(3, 1 + k, &points.column(k).into_owned());
    }
    for (n, (i, j)) in ENTRIES.into_iter().enumerate() {
        let unit = unit_moment(i, j);
        put(0, 4 + n, &(unit * alpha + cross(&omega, &(unit * omega))));
    }
    regressor
}

/// Row and column of each moment of inertia among the parameters.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)];

/// The inertia matrix of which entry (i, j) alone is 1.
fn unit_moment<T: Scalar>(i: usize, j: usize) -> Matrix3<T> {
    let mut unit = Matrix3::zeros();
    unit[(i, j)] = T::one();
    unit[(j, i)] = T::one();
    unit
}

/// The numbers, one for each inertial parameter, whose product with the [`SpatialInertia::parameters`] of N is `Uᵀ N V`: for U = V twice the
/// kinetic energy.
pub fn energy_row<T: Scalar>(u: &Vector6<T>, v: &Vector6<T>) -> [T; INERTIAL_PARAMETERS] {
    let ((omega_u, linear_u), (omega_v, linear_v)) = (split(u), split(v));
    let first = cross(&linear_v, &omega_u) + cross(&linear_u, &omega_v);
    let mut row = [T::zero(); INERTIAL_PARAMETERS];
    row[0] = linear_u.dot(&linear_v);
    row[1..4].copy_from_slice(first.as_slice());
    for (entry, (i, j)) in row[4..].iter_mut().zip(ENTRIES) {
        let product = omega_u[i] * omega_v[j];
        *entry = match i == j {
            true => product,
            false => product + omega_u[j] * omega_v[i],
        };
    }
    row
}

#[cfg(test)]
mod tests {
    use super::{body_regressor, energy_row};
    use crate::spatial::{MassError, MassProperties, SpatialInertia};
    use nalgebra::{Matrix3, SVector, Vector3, Vector6};

    const PARAMETERS: [f64; 10] = [1.5, 0.3, -0.4, 0.7, 2.0, -0.1, 2.5, 0.2, 0.3, 1.9];
    const V: [f64; 6] = [0.3, -0.7, 1.1, 0.5, 0.9, -1.3];
    const W: [f64; 6] = [-1.2, 0.4, 0.6, 2.0, -0.8, 0.1];

    #[test]
    fn the_regressor_times_the_parameters_is_the_wrench() {
        let (twist, rate) = (Vector6::from(V), Vector6::from(W));
        let inertia = SpatialInertia::from_parameters(&PARAMETERS);
        assert_eq!(inertia.parameters(), PARAMETERS);
        let product = body_regressor(&twist, &rate) * SVector::from(PARAMETERS);
        // Sums of a dozen products of size 5.
        assert!((product - inertia.wrench(&twist, &rate)).amax() < 1e-14);
        let row = SVector::from(energy_row(&twist, &rate));
        let form = twist.dot(&(inertia.matrix() * rate));
        assert!((row.dot(&SVector::from(PARAMETERS)) - form).abs() < 1e-14);
    }

    #[test]
    fn mass_properties_go_there_and_back() {
        let own = MassProperties::new(
            2.0,
            Vector3::new(0.1, -0.2, 0.3),
            Matrix3::new(0.5, 0.01, 0.02, 0.01, 0.6, 0.03, 0.02, 0.03, 0.7),
        );
        let own = own.expect("physical");
        let back = MassProperties::from_inertial_parameters(&own.inertial_parameters());
        let back = back.expect("physical");
        assert_eq!((back.mass, back.com), (own.mass, own.com));
        // A difference of numbers of size 1.
        assert!((back.inertia_com - own.inertia_com).amax() < 1e-15);
    }

    #[test]
    fn what_no_body_has_is_refused() {
        let mut parameters = [0.0; 10];
        let none = MassProperties::from_inertial_parameters(&parameters);
        assert_eq!(none, Ok(MassProperties::massless()));
        parameters[2] = -0.25;
        let refused = MassProperties::from_inertial_parameters(&parameters);
        assert_eq!(refused, Err(MassError::MomentWithoutMass { moment: 0.25 }));
        parameters[0] = f64::NAN;
        let refused = MassProperties::from_inertial_parameters(&parameters);
        assert!(matches!(refused, Err(MassError::NotFinite { .. })));
    }
}
