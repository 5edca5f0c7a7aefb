//! Euler–Lagrange in ϕ at ϕ = 0, and the change to v and τ.

use super::joint::{homogeneous, product};
use super::{Jet, Matrix4, OracleJoint};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{DMatrix, DVector};
use hamel::spatial::Pose;

/// The infinitesimals: time t at which the equations hold, time s that makes rates, ε that varies the path.
const T: usize = 0;
const S: usize = 1;
const E: usize = 2;

/// Euler–Lagrange equations of a mechanism of joints that [`OracleJoint`] knows.
#[derive(Clone, Debug)]
pub struct Oracle {
    bodies: Vec<Body>,
    gravity: [f64; 3],
    freedoms: usize,
}

#[derive(Clone, Debug)]
struct Body {
    kind: OracleJoint,
    parent: Option<usize>,
    placement: Matrix4,
    child_placement: Matrix4,
    /// `Λ = Σ m (r; 1)(r; 1)ᵀ` over the points of the body, in its frame.
    second_moments: [[f64; 4]; 4],
    q: Vec<f64>,
    first: usize,
    freedoms: usize,
}

/// ϕ̇ and ϕ̈ at ϕ = 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// ϕ̇.
    pub rate: DVector<f64>,
    /// ϕ̈.
    pub second: DVector<f64>,
}

impl Oracle {
    /// The mechanism at the configuration `q`; `None` where it has a joint of another type.
    pub fn new(mechanism: &Mechanism, q: &[f64]) -> Option<Self> {
        let body = |body: &hamel::mechanism::Body| {
            let own = &body.ranges().freedoms;
            Some(Body {
                kind: OracleJoint::named(body.joint().name())?,
                parent: body.parent(),
                placement: constant(body.placement()),
                child_placement: constant(body.child_placement()),
                second_moments: second_moments(body.mass()),
                q: body.configuration(q).to_vec(),
                first: own.start,
                freedoms: own.len(),
            })
        };
        let bodies: Option<Vec<Body>> = mechanism.bodies().iter().map(body).collect();
        let freedoms = mechanism.layout().freedoms;
        Some(Self {
            bodies: bodies?,
            gravity: (*mechanism.gravity()).into(),
            freedoms,
        })
    }

    /// S₀: column k is v for ϕ̇ = e_k.
    pub fn velocity_map(&self) -> DMatrix<f64> {
        let columns = (0..self.freedoms).map(|k| {
            let rate = DVector::from_fn(self.freedoms, |i, _| f64::from(u8::from(i == k)));
            let second = DVector::zeros(self.freedoms);
            self.velocities(&Motion { rate, second }).0
        });
        DMatrix::from_columns(&columns.collect::<Vec<_>>())
    }

    /// v and v̇ of a motion.
    pub fn velocities(&self, motion: &Motion) -> (DVector<f64>, DVector<f64>) {
        let path = motion.path(None);
        let jets = self.bodies.iter().flat_map(|body| {
            let h = body.kind.pose(&body.q, body.own(&path));
            body.kind.velocity(&h, &derivative(&h))
        });
        let jets: Vec<Jet> = jets.collect();
        let part = |mask: usize| {
            DVector::from_iterator(jets.len(), jets.iter().map(|v| v.coefficient(mask)))
        };
        (part(0), part(1 << T))
    }

    /// The motion with the given v and v̇, from `v = S₀ ϕ̇` and `v̇ = S₀ ϕ̈ + Ṡ ϕ̇`; `None` where S₀ is singular.
    pub fn motion(&self, v: &DVector<f64>, v_rate: &DVector<f64>) -> Option<Motion> {
        let map = self.velocity_map().lu();
        let rate = map.solve(v)?;
        let unforced = Motion {
            rate: rate.clone(),
            second: DVector::zeros(self.freedoms),
        };
        let second = map.solve(&(v_rate - self.velocities(&unforced).1))?;
        Some(Motion { rate, second })
    }

    /// `S₀⁻ᵀ (d/dt ∂L/∂ϕ̇ − ∂L/∂ϕ)`, the efforts collocated with v; `None` where S₀ is singular.
    pub fn efforts(&self, motion: &Motion) -> Option<DVector<f64>> {
        let forces = DVector::from_fn(self.freedoms, |k, _| self.force(motion, k));
        self.velocity_map().transpose().lu().solve(&forces)
    }

    /// `d/dt ∂L/∂ϕ̇_k − ∂L/∂ϕ_k`.
    ///
    /// The path is varied by `ε (s − t)` in ϕ_k: at time t, where s = 0, that is −εt in ϕ_k and ε in ϕ̇_k. So L gains
    /// `ε (∂L/∂ϕ̇_k(t) − t ∂L/∂ϕ_k)`, whose coefficient of εt is the force.
    fn force(&self, motion: &Motion, k: usize) -> f64 {
        self.lagrangian(&motion.path(Some(k)))
            .coefficient(1 << T | 1 << E)
    }

    /// L along a path ϕ(t + s), with s taken for rates and then left.
    fn lagrangian(&self, path: &[Jet]) -> Jet {
        let mut poses: Vec<Matrix4> = Vec::with_capacity(self.bodies.len());
        let mut sum = Jet::constant(0.0);
        for body in &self.bodies {
            let own = product(&body.placement, &body.kind.pose(&body.q, body.own(path)));
            let own = product(&own, &body.child_placement);
            let pose = body
                .parent
                .map_or(own, |parent| product(&poses[parent], &own));
            sum =
                sum + body.kinetic_energy(&derivative(&pose)) - body.potential(&pose, self.gravity);
            poses.push(pose);
        }
        sum
    }
}

impl Motion {
    /// `ϕ̇ (t + s) + ½ ϕ̈ (t + s)²`, with t² = s² = 0, and its variation.
    fn path(&self, varied: Option<usize>) -> Vec<Jet> {
        let [t, s, e] = [T, S, E].map(Jet::infinitesimal);
        let path = self
            .rate
            .iter()
            .zip(&self.second)
            .enumerate()
            .map(|(k, (&rate, &second))| {
                let phi = Jet::constant(rate) * (t + s) + Jet::constant(second) * t * s;
                if varied == Some(k) {
                    phi + e * (s - t)
                } else {
                    phi
                }
            });
        path.collect()
    }
}

impl Body {
    fn own<'a>(&self, path: &'a [Jet]) -> &'a [Jet] {
        &path[self.first..self.first + self.freedoms]
    }

    /// `½ tr(Ḣ Λ Ḣᵀ)`.
    fn kinetic_energy(&self, rate: &Matrix4) -> Jet {
        let mut sum = Jet::constant(0.0);
        for row in &rate[..3] {
            for (j, moments) in self.second_moments.iter().enumerate() {
                for (k, &moment) in moments.iter().enumerate() {
                    sum = sum + row[j] * row[k] * Jet::constant(0.5 * moment);
                }
            }
        }
        sum
    }

    /// `−m gᵀ r`; the last column of Λ is the mass times the centre of mass, and the mass.
    fn potential(&self, pose: &Matrix4, gravity: [f64; 3]) -> Jet {
        let mut sum = Jet::constant(0.0);
        for (row, g) in pose.iter().zip(gravity) {
            for (entry, moments) in row.iter().zip(&self.second_moments) {
                sum = sum - *entry * Jet::constant(g * moments[3]);
            }
        }
        sum
    }
}

/// The rate: what stands at s. It no longer depends on s; what does, in a pose, plays no part.
fn derivative(pose: &Matrix4) -> Matrix4 {
    pose.map(|row| row.map(|entry| entry.derivative(S)))
}

fn constant(pose: &Pose<f64>) -> Matrix4 {
    homogeneous(|i, j| pose.rotation[(i, j)], pose.translation.into())
}

fn second_moments(mass: &hamel::spatial::MassProperties) -> [[f64; 4]; 4] {
    let (m, c, inertia) = (mass.mass, &mass.com, &mass.inertia_com);
    let half_trace = 0.5 * inertia.trace();
    let entry = |i: usize, j: usize| match (i, j) {
        (3, 3) => m,
        (3, k) | (k, 3) => m * c[k],
        // Σ m r rᵀ about the centre of mass is ½ tr(I) 1 − I.
        _ => m * c[i] * c[j] - inertia[(i, j)] + if i == j { half_trace } else { 0.0 },
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}
