//! Vectors, placements and inertias of the graph, as few operations as their structure allows.

mod coriolis;
mod inertia;
mod step;

pub use coriolis::Coriolis;
pub use inertia::{Articulated, Rigid};
pub use step::{Step, simplified};

use super::graph::Sym;
use nalgebra::{Matrix3, Vector3};
use num_traits::Zero;

/// Three scalars.
pub type Vec3 = Vector3<Sym>;
/// Nine scalars.
pub type Mat3 = Matrix3<Sym>;

/// A wrench, or a momentum: moment and force.
#[derive(Clone, Debug, PartialEq)]
pub struct Wrench {
    /// About the origin.
    pub moment: Vec3,
    /// Its force.
    pub force: Vec3,
}

impl Wrench {
    /// None.
    pub fn zero() -> Self {
        Self {
            moment: Vec3::zeros(),
            force: Vec3::zeros(),
        }
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            moment: self.moment + other.moment,
            force: self.force + other.force,
        }
    }

    /// The same without signs beside its scalars ([`Sym::settled`]).
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            moment: self.moment.map(Sym::settled),
            force: self.force.map(Sym::settled),
        }
    }

    /// Entry 0 to 5: moments first.
    pub fn entry_mut(&mut self, entry: usize) -> &mut Sym {
        match entry < 3 {
            true => &mut self.moment[entry],
            false => &mut self.force[entry - 3],
        }
    }

    /// The wrench `factor` times as large.
    #[must_use]
    pub fn times(&self, factor: Sym) -> Self {
        Self {
            moment: self.moment * factor,
            force: self.force * factor,
        }
    }
}

/// A twist, or an acceleration: rotation and translation of the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Twist {
    /// Angular part.
    pub angular: Vec3,
    /// Linear part.
    pub linear: Vec3,
}

impl Twist {
    /// None.
    pub fn zero() -> Self {
        Self {
            angular: Vec3::zeros(),
            linear: Vec3::zeros(),
        }
    }

    /// The sum.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            angular: self.angular + other.angular,
            linear: self.linear + other.linear,
        }
    }

    /// The same without signs beside its scalars ([`Sym::settled`]).
    #[must_use]
    pub fn settled(&self) -> Self {
        Self {
            angular: self.angular.map(Sym::settled),
            linear: self.linear.map(Sym::settled),
        }
    }

    /// Entry 0 to 5: rotations first.
    pub fn entry_mut(&mut self, entry: usize) -> &mut Sym {
        match entry < 3 {
            true => &mut self.angular[entry],
            false => &mut self.linear[entry - 3],
        }
    }

    /// The twist `factor` times as large.
    #[must_use]
    pub fn times(&self, factor: Sym) -> Self {
        Self {
            angular: self.angular * factor,
            linear: self.linear * factor,
        }
    }

    /// Power of a wrench on it.
    pub fn dot(&self, wrench: &Wrench) -> Sym {
        dot(&self.angular, &wrench.moment) + dot(&self.linear, &wrench.force)
    }

    /// `ad_V U`.
    #[must_use]
    pub fn bracket(&self, other: &Self) -> Self {
        Self {
            angular: cross(&self.angular, &other.angular),
            linear: cross(&self.angular, &other.linear) + cross(&self.linear, &other.angular),
        }
    }

    /// `ad_Vᵀ h`.
    pub fn bracket_dual(&self, momentum: &Wrench) -> Wrench {
        Wrench {
            moment: -cross(&self.angular, &momentum.moment) - cross(&self.linear, &momentum.force),
            force: -cross(&self.angular, &momentum.force),
        }
    }

    /// The one entry that is not 0, if it is 1.
    pub fn unit_entry(&self) -> Option<usize> {
        let entries: Vec<Sym> = self.angular.iter().chain(&self.linear).copied().collect();
        let mut others = (0..6).filter(|&i| !entries[i].is_zero());
        let first = others.next()?;
        (others.next().is_none() && entries[first].number() == Some(1.0)).then_some(first)
    }
}

/// `aᵀb`, without terms that are known to be 0.
pub fn dot(a: &Vec3, b: &Vec3) -> Sym {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// `a × b`.
pub fn cross(a: &Vec3, b: &Vec3) -> Vec3 {
    Vec3::from_fn(|i, _| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// A symmetric matrix from its upper triangle.
pub fn symmetric(entry: impl Fn(usize, usize) -> Sym) -> Mat3 {
    let mut matrix = Mat3::from_element(Sym::zero());
    for i in 0..3 {
        for j in i..3 {
            matrix[(i, j)] = entry(i, j);
            matrix[(j, i)] = matrix[(i, j)];
        }
    }
    matrix
}

/// `M a`.
pub fn apply(matrix: &Mat3, a: &Vec3) -> Vec3 {
    Vec3::from_fn(|i, _| (0..3).map(|j| matrix[(i, j)] * a[j]).sum())
}

/// The matrix `a~` with `a~ b = a × b`.
fn tilde(a: &Vec3) -> Mat3 {
    let o = Sym::zero();
    Mat3::new(o, -a.z, a.y, a.z, o, -a.x, -a.y, a.x, o)
}

/// `M N`.
pub fn product(m: &Mat3, n: &Mat3) -> Mat3 {
    Mat3::from_fn(|i, j| (0..3).map(|k| m[(i, k)] * n[(k, j)]).sum())
}
