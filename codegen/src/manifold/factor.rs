//! The manifolds that the spec language knows: how each is stored, its relations, and its group where it is one.

use crate::expr::{Expr, Role, Symbol};
use crate::matrix::Matrix;

/// A known manifold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `R1`, `R2`, …: real vectors.
    Real(usize),
    /// `S1`: a unit complex number `(c, s)`.
    S1,
    /// `SO2`: a 2×2 rotation matrix.
    So2,
    /// `SE2`: the 2×3 matrix (11) of a planar motion.
    Se2,
    /// `S3`: a unit quaternion `(w, x, y, z)`; both signs are the same rotation.
    S3,
    /// `SO3`: a 3×3 rotation matrix.
    So3,
    /// `SE3`: the 3×4 matrix of a spatial motion.
    Se3,
    /// `S2`: a unit vector; not a group.
    S2,
}

/// The longest real vector that a joint may have: without relations.
pub const LARGEST_REAL: usize = 6;
/// The longest real vector of a joint whose relations leave fewer degrees of freedom of it.
pub const LARGEST_CONSTRAINED_REAL: usize = 96;

impl Kind {
    /// The manifold of that name in the spec language; real vectors longer than [`LARGEST_REAL`] need relations.
    pub fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "S1" => Self::S1,
            "SO2" => Self::So2,
            "SE2" => Self::Se2,
            "S3" => Self::S3,
            "SO3" => Self::So3,
            "SE3" => Self::Se3,
            "S2" => Self::S2,
            _ => {
                let size: usize = name.strip_prefix('R')?.parse().ok()?;
                (1..=LARGEST_CONSTRAINED_REAL)
                    .contains(&size)
                    .then_some(Self::Real(size))?
            }
        })
    }

    /// Names of all known manifolds.
    pub fn names() -> Vec<String> {
        let real = (1..=LARGEST_REAL).map(|n| format!("R{n}"));
        let others = ["S1", "SO2", "SE2", "S3", "SO3", "SE3", "S2"];
        real.chain(others.map(str::to_owned)).collect()
    }

    /// Name in the spec language.
    pub fn name(self) -> String {
        match self {
            Self::Real(size) => format!("R{size}"),
            Self::S1 => "S1".into(),
            Self::So2 => "SO2".into(),
            Self::Se2 => "SE2".into(),
            Self::S3 => "S3".into(),
            Self::So3 => "SO3".into(),
            Self::Se3 => "SE3".into(),
            Self::S2 => "S2".into(),
        }
    }

    /// Name of its Lie algebra in the spec language.
    pub fn algebra_name(self) -> Option<String> {
        match self {
            Self::Real(size) => Some(format!("r{size}")),
            Self::S1 | Self::So2 => Some("so2".into()),
            Self::Se2 => Some("se2".into()),
            Self::S3 | Self::So3 => Some("so3".into()),
            Self::Se3 => Some("se3".into()),
            Self::S2 => None,
        }
    }

    /// Dimension of the manifold.
    pub fn dimension(self) -> usize {
        match self {
            Self::Real(size) => size,
            Self::S1 | Self::So2 => 1,
            Self::S2 => 2,
            Self::Se2 | Self::S3 | Self::So3 => 3,
            Self::Se3 => 6,
        }
    }

    /// How the spec writes stored scalar `n` of the factor `name`: `q`, `n.x`, `Q[2, 3]`.
    fn spelling(self, name: &str, n: usize) -> String {
        let part = |letters: &str| {
            let letter = letters.get(n..=n).unwrap_or_default();
            format!("{name}.{letter}")
        };
        let entry = |columns: usize| format!("{name}[{}, {}]", n / columns + 1, n % columns + 1);
        match self {
            Self::Real(1) => name.to_owned(),
            Self::Real(2 | 3) | Self::S2 => part("xyz"),
            Self::Real(_) => format!("{name}[{}]", n + 1),
            Self::S1 => part("cs"),
            Self::S3 => part("wxyz"),
            Self::So2 => entry(2),
            Self::Se2 | Self::So3 => entry(3),
            Self::Se3 => entry(4),
        }
    }

    /// Names of the stored scalars, in storage order.
    fn coordinate_names(self) -> Vec<String> {
        let rows = |rows: usize, columns: usize| {
            let entry = move |n: usize| format!("q{}{}", n / columns + 1, n % columns + 1);
            (0..rows * columns).map(entry).collect()
        };
        let letters = |letters: &str| letters.chars().map(String::from).collect();
        match self {
            Self::Real(size) => (1..=size).map(|n| n.to_string()).collect(),
            Self::S1 => letters("cs"),
            Self::S3 => letters("wxyz"),
            Self::S2 => letters("xyz"),
            Self::So2 => rows(2, 2),
            Self::Se2 => rows(2, 3),
            Self::So3 => rows(3, 3),
            Self::Se3 => rows(3, 4),
        }
    }
}

/// One factor of a configuration manifold, with its stored scalars.
#[derive(Clone, Debug)]
pub struct Factor {
    /// The name that the spec gives it.
    pub name: String,
    /// Which manifold it is.
    pub kind: Kind,
    /// Its stored scalars.
    pub coordinates: Vec<Symbol>,
}

impl Factor {
    /// Whether the scalar can change while all others stay: those of real vectors, and displacements in the last column of a motion's
    /// matrix, which is stored row by row.
    pub fn is_free(&self, symbol: &Symbol) -> bool {
        let place = self.coordinates.iter().position(|other| other == symbol);
        let last_of = |columns: usize| place.is_some_and(|place| place % columns == columns - 1);
        match self.kind {
            Kind::Real(_) => place.is_some(),
            Kind::Se2 => last_of(3),
            Kind::Se3 => last_of(4),
            _ => false,
        }
    }

    /// The factor `name`, its scalars numbered from `first`. Where `alone` says that the configuration has no other factor,
    /// matrix entries are called `q11` and not after the factor.
    pub fn new(name: &str, kind: Kind, role: Role, first: usize, alone: bool) -> Self {
        let prefix = name.to_ascii_lowercase();
        let names = kind.coordinate_names();
        let full = |local: &String| match (kind, alone) {
            (Kind::Real(1), _) => prefix.clone(),
            (Kind::Real(_), _) => format!("{prefix}{local}"),
            (Kind::S1 | Kind::S2 | Kind::S3, _) => format!("{prefix}_{local}"),
            (_, true) => local.clone(),
            (_, false) => format!("{prefix}_{local}"),
        };
        let symbol = |(n, local): (usize, &String)| {
            let symbol = Symbol::new(role, first + n, &full(local));
            symbol.spelled(&kind.spelling(name, n))
        };
        Self {
            name: name.into(),
            kind,
            coordinates: names.iter().enumerate().map(symbol).collect(),
        }
    }

    fn expressions(&self) -> Vec<Expr> {
        self.coordinates.iter().map(Expr::symbol).collect()
    }

    /// The value of `Q` in the spec language: a group element as the square matrix that multiplies, else the column of scalars.
    pub fn matrix(&self) -> Matrix {
        self.embed(&self.expressions())
    }

    /// The square matrix of the element with the given scalars (the column itself, for a manifold that is no group).
    pub fn embed(&self, q: &[Expr]) -> Matrix {
        let (zero, one) = (Expr::zero, Expr::one);
        match self.kind {
            Kind::Real(size) => {
                Matrix::from_fn(size + 1, size + 1, |i, j| match (i == j, j == size) {
                    (true, _) => one(),
                    (false, true) => q[i].clone(),
                    _ => zero(),
                })
            }
            Kind::S1 => Matrix::from_fn(2, 2, |i, j| match (i, j) {
                (0, 1) => -&q[1],
                (1, 0) => q[1].clone(),
                _ => q[0].clone(),
            }),
            Kind::So2 => Matrix::from_fn(2, 2, |i, j| q[2 * i + j].clone()),
            Kind::So3 => Matrix::from_fn(3, 3, |i, j| q[3 * i + j].clone()),
            Kind::Se2 => homogeneous(2, q),
            Kind::Se3 => homogeneous(3, q),
            Kind::S3 => quaternion_matrix(q),
            Kind::S2 => Matrix::column_vector(q.to_vec()),
        }
    }

    /// The stored scalars of the element with the given square matrix: the inverse of [`Factor::embed`].
    pub fn coordinates_of(&self, m: &Matrix) -> Vec<Expr> {
        match self.kind {
            Kind::Real(size) => (0..size).map(|i| m.at(i, size).clone()).collect(),
            Kind::S1 | Kind::S3 | Kind::S2 => m.column(0),
            Kind::So2 | Kind::So3 => m.entries().to_vec(),
            Kind::Se2 => m.block(0, 0, 2, 3).entries().to_vec(),
            Kind::Se3 => m.block(0, 0, 3, 4).entries().to_vec(),
        }
    }

    /// The polynomials that vanish on the manifold.
    pub fn relations(&self) -> Vec<Expr> {
        let q = self.expressions();
        let unit = |entries: &[Expr]| {
            let squares: Expr = entries.iter().map(Expr::square).sum();
            vec![squares - Expr::one()]
        };
        match self.kind {
            Kind::Real(_) => vec![],
            Kind::S1 | Kind::S2 | Kind::S3 => unit(&q),
            Kind::So2 => planar_rotation(&Matrix::from_fn(2, 2, |i, j| q[2 * i + j].clone())),
            Kind::Se2 => planar_rotation(&self.matrix().block(0, 0, 2, 2)),
            Kind::So3 => rotation(&self.matrix()),
            Kind::Se3 => rotation(&self.matrix().block(0, 0, 3, 3)),
        }
    }

    /// The inverse of a group element's square matrix, polynomial in its entries.
    pub fn inverse(&self, m: &Matrix) -> Option<Matrix> {
        match self.kind {
            Kind::Real(size) => Some(Matrix::from_fn(size + 1, size + 1, |i, j| {
                match j == size && i < size {
                    true => -m.at(i, j),
                    false => m.at(i, j).clone(),
                }
            })),
            Kind::S1 | Kind::So2 | Kind::So3 | Kind::S3 => Some(m.transpose()),
            Kind::Se2 => Some(inverse_motion(2, m)),
            Kind::Se3 => Some(inverse_motion(3, m)),
            Kind::S2 => None,
        }
    }

    /// The stored scalars of the identity; the north pole for a sphere.
    pub fn home(&self) -> Vec<Expr> {
        let size = self.coordinates.len();
        match self.kind {
            Kind::S2 => [0, 0, 1].map(Expr::integer).to_vec(),
            Kind::Real(_) => vec![Expr::zero(); size],
            Kind::S1 | Kind::S3 => (0..size).map(|i| Expr::integer((i == 0).into())).collect(),
            Kind::So2 => self.coordinates_of(&Matrix::identity(2)),
            Kind::So3 | Kind::Se2 => self.coordinates_of(&Matrix::identity(3)),
            Kind::Se3 => self.coordinates_of(&Matrix::identity(4)),
        }
    }
}

fn homogeneous(size: usize, q: &[Expr]) -> Matrix {
    Matrix::from_fn(size + 1, size + 1, |i, j| match i < size {
        true => q[(size + 1) * i + j].clone(),
        false => Expr::integer((i == j).into()),
    })
}

fn inverse_motion(size: usize, m: &Matrix) -> Matrix {
    let rotation = m.block(0, 0, size, size).transpose();
    let translation = rotation.times(&m.block(0, size, size, 1));
    Matrix::from_fn(size + 1, size + 1, |i, j| match (i < size, j < size) {
        (true, true) => rotation.at(i, j).clone(),
        (true, false) => -translation.at(i, 0),
        _ => m.at(i, j).clone(),
    })
}

/// Left multiplication by the quaternion.
fn quaternion_matrix(q: &[Expr]) -> Matrix {
    let signs = [[0, -1, -2, -3], [1, 0, -3, 2], [2, 3, 0, -1], [3, -2, 1, 0]];
    Matrix::from_fn(4, 4, |i, j| {
        let entry: i32 = signs[i][j];
        match entry < 0 {
            true => -&q[entry.unsigned_abs() as usize],
            false => q[entry.unsigned_abs() as usize].clone(),
        }
    })
}

fn planar_rotation(r: &Matrix) -> Vec<Expr> {
    vec![
        r.at(1, 1) - r.at(0, 0),
        r.at(0, 1) + r.at(1, 0),
        &(&r.at(0, 0).square() + &r.at(1, 0).square()) - &Expr::one(),
    ]
}

/// `RᵀR = I`, `RRᵀ = I` and `cof R = R`: together they generate all relations of SO(3).
fn rotation(r: &Matrix) -> Vec<Expr> {
    let identity = Matrix::identity(3);
    let products = [
        r.transpose().times(r).minus(&identity),
        r.times(&r.transpose()).minus(&identity),
    ];
    let cofactors = r.adjugate(&Expr::clone).transpose().minus(r);
    let upper = |m: &Matrix| {
        (0..3)
            .flat_map(|i| (i..3).map(move |j| (i, j)))
            .map(|(i, j)| m.at(i, j).clone())
            .collect::<Vec<_>>()
    };
    products
        .iter()
        .flat_map(upper)
        .chain(cofactors.entries().iter().cloned())
        .collect()
}
