//! Seven joints by their definitions: H(Φ(Q, ϕ)) and the meaning of v, written by hand.

use super::Jet;
use std::array;

/// A homogeneous matrix of jets.
pub type Matrix4 = [[Jet; 4]; 4];

/// `a · b`.
pub fn product(a: &Matrix4, b: &Matrix4) -> Matrix4 {
    let zero = Jet::constant(0.0);
    let entry = |i: usize, j: usize| (0..4).fold(zero, |sum, k| sum + a[i][k] * b[k][j]);
    array::from_fn(|i| array::from_fn(|j| entry(i, j)))
}

/// The homogeneous matrix of a rotation and a translation of numbers.
pub fn homogeneous(rotation: impl Fn(usize, usize) -> f64, translation: [f64; 3]) -> Matrix4 {
    let entry = |i: usize, j: usize| match (i, j) {
        (0..3, 0..3) => rotation(i, j),
        (0..3, 3) => translation[i],
        (3, 3) => 1.0,
        _ => 0.0,
    };
    array::from_fn(|i| array::from_fn(|j| Jet::constant(entry(i, j))))
}

/// A joint type that the oracle knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OracleJoint {
    /// Rotation about z by the angle Q.
    Revolute,
    /// Translation along z by Q.
    Prismatic,
    /// Rotation matrix Q, `Φ = Q exp(ϕ~)`, v the angular velocity in parent axes.
    Ball,
    /// Angle about z, x and y; v their rates.
    PlanarEuclidean,
    /// Planar displacement, `Φ = Q exp(ϕ)`, v = (turn, forward, sideways) in child axes. Also that of the cart.
    Planar,
    /// Displacement, `Φ = Q exp(ϕ)`, v the twist in child axes.
    Free,
}

impl OracleJoint {
    /// The joint type of that name in the library.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "revolute" => Some(Self::Revolute),
            "prismatic" => Some(Self::Prismatic),
            "ball" => Some(Self::Ball),
            "planar_euclidean" => Some(Self::PlanarEuclidean),
            "planar" | "cart" => Some(Self::Planar),
            "free" => Some(Self::Free),
            _ => None,
        }
    }

    /// H(Φ(Q, ϕ)); the jets of ϕ have value 0.
    pub fn pose(self, q: &[f64], phi: &[Jet]) -> Matrix4 {
        let zero = Jet::constant(0.0);
        let angle = |value: f64, phi: Jet| Jet::constant(value) + phi;
        match self {
            Self::Revolute => about_z(angle(q[0], phi[0]), [zero; 3]),
            Self::Prismatic => about_z(zero, [zero, zero, angle(q[0], phi[0])]),
            Self::PlanarEuclidean => {
                let position = [angle(q[1], phi[1]), angle(q[2], phi[2]), zero];
                about_z(angle(q[0], phi[0]), position)
            }
            Self::Ball => {
                let base = homogeneous(|i, j| q[3 * i + j], [0.0; 3]);
                product(&base, &exponential([phi[0], phi[1], phi[2]], [zero; 3]))
            }
            Self::Planar => {
                let planar = |i: usize, j: usize| match (i, j) {
                    (2, 2) => 1.0,
                    (2, _) | (_, 2) => 0.0,
                    _ => q[3 * i + j],
                };
                let base = homogeneous(planar, [q[2], q[5], 0.0]);
                product(
                    &base,
                    &exponential([zero, zero, phi[0]], [phi[1], phi[2], zero]),
                )
            }
            Self::Free => {
                let base = homogeneous(|i, j| q[4 * i + j], [q[3], q[7], q[11]]);
                let [a, b, c, x, y, z] = array::from_fn(|i| phi[i]);
                product(&base, &exponential([a, b, c], [x, y, z]))
            }
        }
    }

    /// v where the pose is `h` and its rate `rate`.
    pub fn velocity(self, h: &Matrix4, rate: &Matrix4) -> Vec<Jet> {
        let child = |i: usize, j: usize| dot(|k| h[k][i], |k| rate[k][j]);
        let spin_in_child = [child(2, 1), child(0, 2), child(1, 0)];
        let parent = |i: usize, j: usize| dot(|k| rate[i][k], |k| h[j][k]);
        match self {
            Self::Revolute => vec![spin_in_child[2]],
            Self::Prismatic => vec![rate[2][3]],
            Self::PlanarEuclidean => vec![spin_in_child[2], rate[0][3], rate[1][3]],
            Self::Ball => vec![parent(2, 1), parent(0, 2), parent(1, 0)],
            Self::Planar => vec![spin_in_child[2], child(0, 3), child(1, 3)],
            Self::Free => {
                let linear = [child(0, 3), child(1, 3), child(2, 3)];
                [spin_in_child, linear].concat()
            }
        }
    }
}

/// Sum over the three axes.
fn dot(a: impl Fn(usize) -> Jet, b: impl Fn(usize) -> Jet) -> Jet {
    (0..3).fold(Jet::constant(0.0), |sum, k| sum + a(k) * b(k))
}

fn about_z(angle: Jet, position: [Jet; 3]) -> Matrix4 {
    let (zero, one) = (Jet::constant(0.0), Jet::constant(1.0));
    let (sin, cos) = angle.sin_cos();
    let [x, y, z] = position;
    [
        [cos, -sin, zero, x],
        [sin, cos, zero, y],
        [zero, zero, one, z],
        [zero, zero, zero, one],
    ]
}

/// `exp [ω~ v; 0 0]` for infinitesimal ω and v: the series ends after the third power, since fourth powers vanish.
fn exponential([a, b, c]: [Jet; 3], [x, y, z]: [Jet; 3]) -> Matrix4 {
    let zero = Jet::constant(0.0);
    let generator = [
        [zero, -c, b, x],
        [c, zero, -a, y],
        [-b, a, zero, z],
        [zero; 4],
    ];
    let mut sum = homogeneous(|i, j| f64::from(u8::from(i == j)), [0.0; 3]);
    let mut power = sum;
    for n in 1..=3 {
        let step = product(&power, &generator);
        let share = Jet::constant(1.0 / f64::from(n));
        power = step.map(|row| row.map(|entry| entry * share));
        sum = array::from_fn(|i| array::from_fn(|j| sum[i][j] + power[i][j]));
    }
    sum
}
