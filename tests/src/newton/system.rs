//! Free rigid bodies, rows that tie them together, and what acts on them.

use super::constraint::{Constraint, Row};
use super::load::Load;
use super::number::{Matrix, Real, Vector, real, rotation};
use super::solve::Skyline;

/// Scalars of a body's state: position of the centre of mass, quaternion, velocity, angular velocity in body axes.
pub const STATE: usize = 13;

/// Mass and inertia of a body.
#[derive(Clone, Debug)]
pub struct Inertia {
    pub mass: Real,
    /// About the centre of mass, in body axes.
    pub matrix: Matrix,
    pub inverse: Matrix,
}

impl Inertia {
    pub fn new(mass: Real, matrix: Matrix) -> Self {
        Self {
            mass,
            matrix,
            inverse: inverse(&matrix),
        }
    }
}

/// Inverse of a symmetric positive definite 3×3 matrix, by its cofactors.
fn inverse(m: &Matrix) -> Matrix {
    let [a, b, c] = [0, 1, 2].map(|i| m.column(i).into_owned());
    let cofactors = [b.cross(&c), c.cross(&a), a.cross(&b)];
    let determinant = a.dot(&cofactors[0]);
    Matrix::from_fn(|i, j| cofactors[i][j] / determinant)
}

/// How a body moves at one instant.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Of the centre of mass, world axes.
    pub position: Vector,
    /// Body to world.
    pub rotation: Matrix,
    /// Of the centre of mass, world axes.
    pub velocity: Vector,
    /// Body axes.
    pub rate: Vector,
    /// The same in world axes.
    pub turning: Vector,
}

impl Motion {
    pub fn read(state: &[Real]) -> Self {
        let three = |start: usize| Vector::new(state[start], state[start + 1], state[start + 2]);
        let rotation = rotation(&state[3..7]);
        let rate = three(10);
        Self {
            position: three(0),
            velocity: three(7),
            turning: rotation * rate,
            rotation,
            rate,
        }
    }
}

/// Bodies under gravity, loads and constraints.
#[derive(Clone, Debug)]
pub struct System {
    /// Acceleration of free fall, world axes, m/s².
    pub(super) gravity: Vector,
    pub(super) bodies: Vec<Inertia>,
    pub(super) constraints: Vec<Constraint>,
    pub(super) loads: Vec<Load>,
}

impl System {
    /// All bodies' motions in a state.
    pub fn motions(&self, state: &[Real]) -> Vec<Motion> {
        state.chunks(STATE).map(Motion::read).collect()
    }

    /// The derivative of the state, into `rates`.
    pub fn rates(&self, state: &[Real], rates: &mut [Real]) {
        let motions = self.motions(state);
        let accelerations = self.accelerations(&motions);
        let bodies = rates.chunks_mut(STATE).zip(state.chunks(STATE));
        for (((rate, state), motion), (linear, angular)) in bodies.zip(&motions).zip(&accelerations)
        {
            rate[..3].copy_from_slice(motion.velocity.as_slice());
            rate[3..7].copy_from_slice(&quaternion_rate(&state[3..7], &motion.rate));
            rate[7..10].copy_from_slice(linear.as_slice());
            rate[10..].copy_from_slice(angular.as_slice());
        }
    }

    /// Accelerations of the centres of mass, world axes, and derivatives of the angular velocities, body axes.
    fn accelerations(&self, motions: &[Motion]) -> Vec<(Vector, Vector)> {
        let mut moments = vec![Vector::zeros(); self.bodies.len()];
        for load in &self.loads {
            load.act(motions, &mut moments);
        }
        let mut accelerations: Vec<(Vector, Vector)> = self
            .bodies
            .iter()
            .zip(motions)
            .zip(&moments)
            .map(|((body, motion), moment)| {
                let momentum = body.matrix * motion.rate;
                let angular = body.inverse * (moment - motion.rate.cross(&momentum));
                (self.gravity, angular)
            })
            .collect();
        let rows: Vec<Row> = self
            .constraints
            .iter()
            .flat_map(|constraint| constraint.rows(motions))
            .collect();
        let multipliers = self.multipliers(&rows, &accelerations);
        for (row, &multiplier) in rows.iter().zip(&multipliers) {
            for end in &row.ends {
                let (linear, angular) = &mut accelerations[end.body];
                let body = &self.bodies[end.body];
                *linear += end.linear * (multiplier / body.mass);
                *angular += body.inverse * end.angular * multiplier;
            }
        }
        accelerations
    }

    /// λ of `J M⁻¹ Jᵀ λ = −(J a + bias)`.
    fn multipliers(&self, rows: &[Row], free: &[(Vector, Vector)]) -> Vec<Real> {
        let weighted: Vec<Row> = rows.iter().map(|row| row.weighted(&self.bodies)).collect();
        let matrix = Skyline::new(
            rows.len(),
            |i, j| rows[i].meets(&rows[j]),
            |i, j| rows[i].product(&weighted[j]),
        );
        let mut right: Vec<Real> = rows.iter().map(|row| -row.residual(free)).collect();
        matrix.solve(&mut right);
        right
    }

    /// Kinetic energy, and the potential energy of gravity and springs, J.
    pub fn energies(&self, state: &[Real]) -> (Real, Real) {
        let motions = self.motions(state);
        let half = real(0.5);
        let mut kinetic = real(0.0);
        let mut potential = real(0.0);
        for (body, motion) in self.bodies.iter().zip(&motions) {
            let turning = motion.rate.dot(&(body.matrix * motion.rate));
            kinetic += half * (body.mass * motion.velocity.dot(&motion.velocity) + turning);
            potential -= body.mass * self.gravity.dot(&motion.position);
        }
        for load in &self.loads {
            potential += load.energy(&motions);
        }
        (kinetic, potential)
    }
}

/// `q̇ = ½ q ω`, ω in body axes.
fn quaternion_rate(q: &[Real], rate: &Vector) -> [Real; 4] {
    let (w, x, y, z) = (q[0], q[1], q[2], q[3]);
    let (a, b, c) = (rate.x, rate.y, rate.z);
    let half = real(0.5);
    [
        -(x * a + y * b + z * c) * half,
        (w * a + y * c - z * b) * half,
        (w * b + z * a - x * c) * half,
        (w * c + x * b - y * a) * half,
    ]
}
