//! Values of expressions, and what each may stand for.

use crate::expr::Expr;
use crate::manifold::Kind;
use crate::matrix::Matrix;
use crate::model::PoseExpr;

/// The value of an expression.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Scalar(Expr),
    /// A bracket without `;`: a row, or a column where only a column fits.
    List(Vec<Expr>),
    /// Any other matrix; never 1×1.
    Matrix(Matrix),
    Pose(PoseExpr),
    /// An element of a group, as the square matrix that multiplies.
    Element(Kind, Matrix),
    /// An element of a group's algebra: its coordinates in the standard basis.
    Tangent(Kind, Vec<Expr>),
}

impl Value {
    /// The matrix as a value: a scalar where it is 1×1.
    pub fn matrix(matrix: Matrix) -> Self {
        match (matrix.shape(), matrix.entries()) {
            ((1, 1), [entry]) => Self::Scalar(entry.clone()),
            _ => Self::Matrix(matrix),
        }
    }

    /// The column as a value.
    pub fn column(entries: Vec<Expr>) -> Self {
        Self::matrix(Matrix::column_vector(entries))
    }

    /// What it is, for error messages.
    pub fn describe(&self) -> String {
        match self {
            Self::Scalar(entry) => match entry.as_rational() {
                Some(number) => format!("the number {number}"),
                None => "a scalar".into(),
            },
            Self::List(entries) => format!("a list of {}", entries.len()),
            Self::Matrix(matrix) => format!("a {}×{} matrix", matrix.rows(), matrix.columns()),
            Self::Pose(_) => "a pose".into(),
            Self::Element(kind, _) => format!("an element of {}", kind.name()),
            Self::Tangent(kind, _) => format!(
                "an element of {}",
                kind.algebra_name().unwrap_or_else(|| kind.name())
            ),
        }
    }

    /// All scalars that it holds.
    pub fn entries(&self) -> Vec<Expr> {
        match self {
            Self::Scalar(entry) => vec![entry.clone()],
            Self::List(entries) | Self::Tangent(_, entries) => entries.clone(),
            Self::Matrix(matrix) | Self::Element(_, matrix) => matrix.entries().to_vec(),
            Self::Pose(pose) => [pose.rotation.entries(), pose.translation.entries()].concat(),
        }
    }

    /// A name for each scalar that it holds: `name`, `name1 …` for a column, `name11 …` for a matrix, `name_r11 …` and `name_p1 …` for a
    /// pose; in the order of [`Value::entries`].
    pub fn entry_names(&self, name: &str) -> Vec<String> {
        match self {
            Self::Scalar(_) => vec![name.to_owned()],
            Self::List(entries) | Self::Tangent(_, entries) => by_rows(name, entries.len(), 1),
            Self::Matrix(matrix) | Self::Element(_, matrix) => {
                by_rows(name, matrix.rows(), matrix.columns())
            }
            Self::Pose(_) => {
                let rotation = by_rows(&format!("{name}_r"), 3, 3);
                [rotation, by_rows(&format!("{name}_p"), 3, 1)].concat()
            }
        }
    }

    /// A value of the same shape.
    pub fn map(&self, mut f: impl FnMut(&Expr) -> Expr) -> Self {
        match self {
            Self::Scalar(entry) => Self::Scalar(f(entry)),
            Self::List(entries) => Self::List(entries.iter().map(f).collect()),
            Self::Tangent(kind, entries) => Self::Tangent(*kind, entries.iter().map(f).collect()),
            Self::Matrix(matrix) => Self::Matrix(matrix.map(f)),
            Self::Element(kind, matrix) => Self::Element(*kind, matrix.map(f)),
            Self::Pose(pose) => Self::Pose(PoseExpr {
                rotation: pose.rotation.map(&mut f),
                translation: pose.translation.map(&mut f),
            }),
        }
    }

    /// As a scalar.
    pub fn as_scalar(&self) -> Option<&Expr> {
        match self {
            Self::Scalar(entry) => Some(entry),
            _ => None,
        }
    }

    /// As a matrix: matrices, lists as rows, elements of SO2 and SO3; not scalars.
    pub fn as_matrix(&self) -> Option<Matrix> {
        match self {
            Self::Matrix(matrix) | Self::Element(Kind::So2 | Kind::So3, matrix) => {
                Some(matrix.clone())
            }
            Self::List(entries) => Some(Matrix::column_vector(entries.clone()).transpose()),
            _ => None,
        }
    }

    /// As a column: columns, lists, elements of S1 and S3, and the coordinates of elements of algebras.
    pub fn as_column(&self) -> Option<Vec<Expr>> {
        match self {
            Self::List(entries) => Some(entries.clone()),
            Self::Matrix(matrix) if matrix.columns() == 1 => Some(matrix.entries().to_vec()),
            Self::Element(Kind::S1 | Kind::S3, matrix) => Some(matrix.column(0)),
            Self::Tangent(_, coordinates) => Some(coordinates.clone()),
            _ => None,
        }
    }

    /// As a matrix in sums and multiples: matrices, and the elements of S1 and S3 as columns of their scalars.
    pub fn as_summand(&self) -> Option<Matrix> {
        match self {
            Self::Element(Kind::S1 | Kind::S3, matrix) => {
                Some(Matrix::column_vector(matrix.column(0)))
            }
            _ => self.as_matrix(),
        }
    }

    /// This minus another of its shape, entry by entry; a list takes the shape of the other.
    pub fn minus(&self, other: &Self) -> Option<Vec<Expr>> {
        let subtract = |a: &[Expr], b: &[Expr]| -> Option<Vec<Expr>> {
            (a.len() == b.len()).then(|| a.iter().zip(b).map(|(a, b)| a - b).collect())
        };
        match (self, other) {
            (Self::Scalar(a), Self::Scalar(b)) => Some(vec![a - b]),
            (Self::Scalar(_), _) | (_, Self::Scalar(_)) => None,
            (Self::List(a), Self::List(b)) => subtract(a, b),
            (Self::List(_), _) => other
                .minus(self)
                .map(|all| all.iter().map(|e| -e).collect()),
            _ => {
                let a = self.as_summand()?;
                let b = match other {
                    Self::List(_) => other.as_shape(a.rows(), a.columns())?,
                    _ => other.as_summand().filter(|b| b.shape() == a.shape())?,
                };
                subtract(a.entries(), b.entries())
            }
        }
    }

    /// As a column of three.
    pub fn as_vector3(&self) -> Option<Vec<Expr>> {
        self.as_column().filter(|column| column.len() == 3)
    }

    /// As a matrix of that shape: a scalar counts as 1×1, a list as a row or a column.
    pub fn as_shape(&self, rows: usize, columns: usize) -> Option<Matrix> {
        let matrix = match self {
            Self::Scalar(entry) => Matrix::column_vector(vec![entry.clone()]),
            Self::List(entries) if columns == 1 => Matrix::column_vector(entries.clone()),
            _ => self.as_matrix()?,
        };
        (matrix.shape() == (rows, columns)).then_some(matrix)
    }

    /// As a rotation matrix: 3×3, or an element of SO3.
    pub fn as_rotation(&self) -> Option<Matrix> {
        self.as_matrix().filter(|matrix| matrix.shape() == (3, 3))
    }

    /// As a pose: poses, elements of SE3, and rotations alone.
    pub fn as_pose(&self) -> Option<PoseExpr> {
        match self {
            Self::Pose(pose) => Some(pose.clone()),
            Self::Element(Kind::Se3, matrix) => Some(PoseExpr {
                rotation: matrix.block(0, 0, 3, 3),
                translation: matrix.block(0, 3, 3, 1),
            }),
            _ => Some(PoseExpr {
                rotation: self.as_rotation()?,
                translation: Matrix::zeros(3, 1),
            }),
        }
    }

    /// Whether this is a pose by itself, not only where one is expected.
    pub fn is_pose(&self) -> bool {
        matches!(self, Self::Pose(_) | Self::Element(Kind::Se3, _))
    }
}

/// `name11 …` row by row, `name1 …` for a column.
fn by_rows(name: &str, rows: usize, columns: usize) -> Vec<String> {
    // Row 1, column 11 is not row 11, column 1.
    let between = if rows.max(columns) > 9 { "_" } else { "" };
    let numbered = |n: usize| match columns {
        1 => format!("{name}{}", n + 1),
        _ => format!("{name}{}{between}{}", n / columns + 1, n % columns + 1),
    };
    (0..rows * columns).map(numbered).collect()
}
