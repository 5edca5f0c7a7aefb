//! Springs at a joint, measured on the joint's own manifold.

use super::error::{body, values};
use super::{Action, Curvature, Curvatures, Element, ElementError, Slope, Slopes, View};
use crate::joint::MOST_FREEDOMS;
use crate::mechanism::{CONFIGURATION_TOLERANCE, Mechanism};
use crate::spatial::fused::product;
use crate::spatial::vee;
use crate::steps::EffortLaw;
use alloc::string::String;
use alloc::vec::Vec;
use nalgebra::{DMatrix, Matrix3, Vector3};

/// Energy `½ ϕᵀ K ϕ` with ϕ the local coordinates of Q seen from the rest configuration: `Φ(rest, ϕ) = Q`.
///
/// For a ball joint ϕ is the rotation vector, so that this is a rotational spring without singularity up to a half turn. With
/// `ϕ̇ = D⁻¹ S₀⁻¹ v` its efforts are `τ = −S₀⁻ᵀ D⁻ᵀ K ϕ`.
#[derive(Clone, Debug)]
pub struct JointSpring {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint it turns back.
    pub body: usize,
    /// K by rows, symmetric, one row per freedom: N·m/rad or N/m.
    pub stiffness: Vec<f64>,
    /// The configuration of the joint at which it is at rest.
    pub rest: Vec<f64>,
}

impl JointSpring {
    /// ϕ and Kϕ; NaN where ϕ cannot be found.
    fn stretch(&self, view: &View<'_>) -> ([f64; MOST_FREEDOMS], [f64; MOST_FREEDOMS]) {
        let Some((joint, q)) = view.joint_and_configuration(self.body) else {
            return ([f64::NAN; MOST_FREEDOMS], [f64::NAN; MOST_FREEDOMS]);
        };
        let size = joint.layout().freedoms;
        let (mut phi, mut load) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
        // Where it fails, ϕ is NaN, and so is what follows from it.
        _ = joint.local(&self.rest, q, &mut phi[..size]);
        let rows = self.stiffness.chunks_exact(size.max(1));
        for (load, row) in load.iter_mut().zip(rows) {
            *load = row.iter().zip(&phi).map(|(k, x)| k * x).sum();
        }
        (phi, load)
    }
}

impl Element for JointSpring {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        let body = body(&self.name, mechanism, self.body)?;
        let size = body.ranges().freedoms.len();
        let coordinates = body.ranges().configuration.len();
        values(
            &self.name,
            "rest configuration",
            &self.rest,
            coordinates,
            true,
        )?;
        let residual = body.joint().residual(&self.rest);
        if residual.is_nan() || residual > CONFIGURATION_TOLERANCE {
            return Err(ElementError::Value {
                element: self.name.clone(),
                quantity: "distance of the rest configuration from the joint's manifold",
                value: residual,
                requirement: "at most 1e-9",
            });
        }
        values(&self.name, "stiffness", &self.stiffness, size * size, true)?;
        let entry = |i: usize, j: usize| self.stiffness[i * size + j];
        let pairs = (0..size).flat_map(|i| (0..=i).map(move |j| (i, j)));
        for (i, j) in pairs {
            let (found, requirement) = match i == j {
                true if entry(i, i) < 0.0 => (entry(i, i), "not negative on its diagonal"),
                false if entry(i, j) != entry(j, i) => (entry(i, j), "symmetric"),
                _ => continue,
            };
            return Err(ElementError::Value {
                element: self.name.clone(),
                quantity: "stiffness",
                value: found,
                requirement,
            });
        }
        if size == 0 {
            return Ok(());
        }
        let matrix = DMatrix::from_row_slice(size, size, &self.stiffness);
        let (most, least) = (matrix.amax(), matrix.symmetric_eigenvalues().min());
        // Rounding of a stiffness of less than full rank.
        if least < -1e-12 * most {
            return Err(ElementError::Value {
                element: self.name.clone(),
                quantity: "least eigenvalue of the stiffness",
                value: least,
                requirement: "not negative",
            });
        }
        Ok(())
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        let (phi, load) = self.stretch(view);
        let Some((joint, q)) = view.joint_and_configuration(self.body) else {
            return action.add_effort(view, self.body, &[]);
        };
        let size = joint.layout().freedoms;
        let mut inverse = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let inverse = &mut inverse[..size * size];
        joint.velocity_map_inverse(q, inverse);
        let (mut effort, mut rate) = ([0.0; MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
        for (effort, column) in effort.iter_mut().zip(inverse.chunks_exact(size.max(1))) {
            let rate = &mut rate[..size];
            joint.retract_differential_inverse(&self.rest, &phi[..size], column, rate);
            *effort = -rate.iter().zip(&load).map(|(r, l)| r * l).sum::<f64>();
        }
        action.add_effort(view, self.body, &effort[..size]);
    }

    fn energy(&self, view: &View<'_>) -> f64 {
        let (phi, load) = self.stretch(view);
        phi.iter().zip(&load).map(|(x, l)| 0.5 * x * l).sum()
    }

    fn power(&self, _view: &View<'_>) -> f64 {
        0.0
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }
}

impl Slope for JointSpring {
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        let Some((joint, q)) = view.joint_and_configuration(self.body) else {
            return slopes.add_effort(view, self.body, &[], &[]);
        };
        let (mut by_local, size) = (
            [f64::NAN; MOST_FREEDOMS * MOST_FREEDOMS],
            joint.layout().freedoms,
        );
        let own = &mut by_local[..size * size];
        joint.spring_slope(q, &self.rest, &self.stiffness, own);
        slopes.add_effort(
            view,
            self.body,
            &by_local,
            &[0.0; MOST_FREEDOMS * MOST_FREEDOMS],
        );
    }
}

impl Curvature for JointSpring {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        let law = EffortLaw::Spring {
            rest: &self.rest,
            stiffness: &self.stiffness,
        };
        curvatures.add_effort(view, self.body, &law);
    }
}

/// Energy `k (3 − tr R)/2` with R the rotation of the joint's child frame from its attitude at rest: `k (1 − cos θ)`, smooth at every attitude.
///
/// Its moment on the child is `−k vee(½(R − Rᵀ))`, in the axes of the joint's parent frame.
#[derive(Clone, Debug)]
pub struct RotationSpring {
    /// Name, for messages.
    pub name: String,
    /// The body whose joint it turns back.
    pub body: usize,
    /// k, N·m; not negative.
    pub stiffness: f64,
    /// The rotation of the joint's child frame in its parent frame at rest.
    pub rest: Matrix3<f64>,
}

impl RotationSpring {
    fn turn(&self, view: &View<'_>) -> Matrix3<f64> {
        let known = view.joint_and_configuration(self.body);
        let rotation = known.map_or(Matrix3::repeat(f64::NAN), |(joint, q)| {
            joint.pose(q).rotation
        });
        product(&rotation, &self.rest.transpose())
    }
}

impl Element for RotationSpring {
    fn name(&self) -> &str {
        &self.name
    }

    fn check(&self, mechanism: &Mechanism) -> Result<(), ElementError> {
        body(&self.name, mechanism, self.body)?;
        values(&self.name, "stiffness", &[self.stiffness], 1, false)?;
        values(&self.name, "rest rotation", self.rest.as_slice(), 9, true)?;
        let away = (self.rest.transpose() * self.rest - Matrix3::identity()).amax();
        let proper = self.rest.determinant() > 0.0;
        match proper && away <= CONFIGURATION_TOLERANCE {
            true => Ok(()),
            false => Err(ElementError::Value {
                element: self.name.clone(),
                quantity: "distance of the rest rotation from a rotation",
                value: if proper { away } else { 2.0 },
                requirement: "at most 1e-9",
            }),
        }
    }

    fn act(&self, view: &View<'_>, action: &mut Action<'_>) {
        let moment: Vector3<f64> = vee(&self.turn(view)) * -self.stiffness;
        let Some((joint, q)) = view.joint_and_configuration(self.body) else {
            return action.add_effort(view, self.body, &[]);
        };
        let size = joint.layout().freedoms;
        let (mut map, mut effort) = ([0.0; MOST_FREEDOMS * MOST_FREEDOMS], [0.0; MOST_FREEDOMS]);
        let map = &mut map[..6 * size];
        joint.twist_map(q, map);
        for (effort, column) in effort.iter_mut().zip(map.chunks_exact(6)) {
            *effort = column[..3].iter().zip(&moment).map(|(x, m)| x * m).sum();
        }
        action.add_effort(view, self.body, &effort[..size]);
    }

    fn energy(&self, view: &View<'_>) -> f64 {
        // (3 − tr R)/2 loses digits near rest; ¼ |R − I|² is the same and keeps them.
        let away = self.turn(view) - Matrix3::identity();
        0.25 * self.stiffness * away.norm_squared()
    }

    fn power(&self, _view: &View<'_>) -> f64 {
        0.0
    }

    fn slope(&self) -> Option<&dyn Slope> {
        Some(self)
    }

    fn curvature(&self) -> Option<&dyn Curvature> {
        Some(self)
    }
}

impl Slope for RotationSpring {
    fn add_slopes(&self, view: &View<'_>, slopes: &mut Slopes<'_>) {
        let Some((joint, q)) = view.joint_and_configuration(self.body) else {
            return slopes.add_effort(view, self.body, &[], &[]);
        };
        let size = joint.layout().freedoms;
        let mut by_local = [0.0; MOST_FREEDOMS * MOST_FREEDOMS];
        let own = &mut by_local[..size * size];
        joint.turn_slope(q, &self.rest, self.stiffness, own);
        slopes.add_effort(
            view,
            self.body,
            &by_local,
            &[0.0; MOST_FREEDOMS * MOST_FREEDOMS],
        );
    }
}

impl Curvature for RotationSpring {
    fn add_curvatures(&self, view: &View<'_>, curvatures: &mut Curvatures<'_>) {
        let law = EffortLaw::RotationSpring {
            rest: &self.rest,
            stiffness: self.stiffness,
        };
        curvatures.add_effort(view, self.body, &law);
    }
}
