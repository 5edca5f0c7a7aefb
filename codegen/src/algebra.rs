//! Lie algebras of the known groups: standard bases, coordinates, brackets, structure constants, and exp in closed form.

use crate::expr::{Expr, Rational, Symbol};
use crate::manifold::{Factor, Ideal, Kind};
use crate::matrix::{Matrix, combinations};
use num_traits::One;

/// The standard basis of the algebra of a group, as matrices that multiply its elements from the right.
///
/// Rotations first: `so3` is (e1, e2, e3), `se2` (turn, x, y), `se3` (rotations, translations). Elements of `so3` on S3 act as
/// half-angle quaternions, so that coordinates are rotation vectors there too.
pub fn standard_basis(kind: Kind) -> Vec<Matrix> {
    (0..kind.dimension())
        .map(|n| hat(kind, &unit(kind.dimension(), n)))
        .collect()
}

fn unit(size: usize, n: usize) -> Vec<Expr> {
    (0..size).map(|i| Expr::integer((i == n).into())).collect()
}

/// The matrix of the algebra element with the given coordinates in the standard basis.
pub fn hat(kind: Kind, x: &[Expr]) -> Matrix {
    let zero = Expr::zero;
    let bordered = |size: usize, rotation: Matrix, translation: &[Expr]| {
        Matrix::from_fn(size + 1, size + 1, |i, j| match (i < size, j < size) {
            (true, true) => rotation.at(i, j).clone(),
            (true, false) => translation[i].clone(),
            _ => zero(),
        })
    };
    let turn = |angle: &Expr| {
        Matrix::from_fn(2, 2, |i, j| match (i, j) {
            (0, 1) => -angle,
            (1, 0) => angle.clone(),
            _ => zero(),
        })
    };
    match kind {
        Kind::Real(size) => bordered(size, Matrix::zeros(size, size), x),
        Kind::S1 | Kind::So2 => turn(&x[0]),
        Kind::Se2 => bordered(2, turn(&x[0]), &x[1..]),
        Kind::So3 => Matrix::tilde(x),
        Kind::Se3 => bordered(3, Matrix::tilde(&x[..3]), &x[3..]),
        Kind::S3 => {
            let half = x.iter().map(|entry| entry * &Expr::fraction(1, 2));
            let quaternion: Vec<Expr> = std::iter::once(zero()).chain(half).collect();
            Factor::new("q", Kind::S3, crate::expr::Role::Intermediate, 0, true).embed(&quaternion)
        }
        Kind::S2 => Matrix::zeros(3, 3),
    }
}

/// Coordinates in the standard basis: the inverse of [`hat`].
pub fn vee(kind: Kind, m: &Matrix) -> Vec<Expr> {
    let pick = |entries: &[(usize, usize)]| {
        entries
            .iter()
            .map(|&(i, j)| m.at(i, j).clone())
            .collect::<Vec<_>>()
    };
    match kind {
        Kind::Real(size) => (0..size).map(|i| m.at(i, size).clone()).collect(),
        Kind::S1 | Kind::So2 => pick(&[(1, 0)]),
        Kind::Se2 => pick(&[(1, 0), (0, 2), (1, 2)]),
        Kind::So3 => pick(&[(2, 1), (0, 2), (1, 0)]),
        Kind::Se3 => pick(&[(2, 1), (0, 2), (1, 0), (0, 3), (1, 3), (2, 3)]),
        Kind::S3 => pick(&[(1, 0), (2, 0), (3, 0)])
            .iter()
            .map(|x| x * &Expr::integer(2))
            .collect(),
        Kind::S2 => vec![],
    }
}

/// The commutator.
pub fn commutator(a: &Matrix, b: &Matrix) -> Matrix {
    a.times(b).minus(&b.times(a))
}

/// Solves `columns · x = target` for constant columns of full rank; `Err` holds the part of the target outside their span.
pub fn coordinates_in(columns: &Matrix, target: &[Expr]) -> Result<Vec<Expr>, Vec<Expr>> {
    let target = Matrix::column_vector(target.to_vec());
    let x = simplified(&left_inverse(columns).times(&target));
    let rest = simplified(&target.minus(&columns.times(&x)));
    match vanishes(&rest) {
        true => Ok(x.entries().to_vec()),
        false => Err(rest.entries().to_vec()),
    }
}

/// A left inverse of constant columns of full rank: from rows whose determinant is one term, else `(MᵀM)⁻¹ Mᵀ`.
pub fn left_inverse(columns: &Matrix) -> Matrix {
    let size = columns.columns();
    let ideal = Ideal::default();
    let simplify = |e: &Expr| ideal.normal_form(e);
    let inverse = |square: &Matrix, determinant: &Expr| {
        let inverse = determinant.recip().unwrap_or_default();
        square.adjugate(&simplify).scale(&inverse)
    };
    let of_rows = |rows: Vec<usize>| {
        let square = columns.select_rows(&rows);
        let determinant = square.determinant(&simplify);
        determinant.is_unit().then(|| {
            let inverse = inverse(&square, &determinant);
            Matrix::from_fn(size, columns.rows(), |i, j| {
                let place = rows.iter().position(|&row| row == j);
                place.map_or_else(Expr::zero, |place| inverse.at(i, place).clone())
            })
        })
    };
    let choices = combinations(columns.rows(), size);
    choices.into_iter().find_map(of_rows).unwrap_or_else(|| {
        let transposed = columns.transpose();
        let gram = transposed.times(columns);
        inverse(&gram, &gram.determinant(&simplify)).times(&transposed)
    })
}

/// Whether all entries vanish modulo the relations of the functions in them.
pub fn vanishes(m: &Matrix) -> bool {
    let ideal = Ideal::default();
    m.entries().iter().all(|entry| ideal.vanishes(entry))
}

/// The matrix with its entries in normal form modulo the relations of the functions in them.
pub fn simplified(m: &Matrix) -> Matrix {
    Ideal::default().normal_forms(m)
}

/// How powers of an algebra element end: the shortest closed form of exp.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Closure {
    /// `ξ² = 0`.
    Nilpotent,
    /// `ξ² = −s`.
    Circle(Expr),
    /// `ξ³ = −s ξ`.
    Rotation(Expr),
    /// `ξ⁴ = −s ξ²`.
    Screw(Expr),
}

/// Finds the identity that the powers of `xi` satisfy; every subalgebra of se(3) and its quaternion has one of these.
pub fn closure(xi: &Matrix) -> Option<Closure> {
    let square = simplified(&xi.times(xi));
    if vanishes(&square) {
        return Some(Closure::Nilpotent);
    }
    let negative_trace = -square.trace();
    let cube = square.times(xi);
    for rank in [2, 4, xi.rows() as i64] {
        let s = &negative_trace * &Expr::rational(Rational::new(One::one(), rank.into()));
        let ends = |power: &Matrix, lower: &Matrix| vanishes(&power.plus(&lower.scale(&s)));
        if ends(&square, &Matrix::identity(xi.rows())) {
            return Some(Closure::Circle(s));
        }
        if ends(&cube, xi) {
            return Some(Closure::Rotation(s));
        }
        if ends(&cube.times(xi), &square) {
            return Some(Closure::Screw(s));
        }
    }
    None
}

/// `exp(xi)` in closed form, with `coefficient(k, s)` for the Stumpff function `c_k(s)`; `None` where no [`Closure`] fits.
pub fn exp_by(xi: &Matrix, mut coefficient: impl FnMut(u8, &Expr) -> Expr) -> Option<Matrix> {
    let identity = Matrix::identity(xi.rows());
    let square = || xi.times(xi);
    Some(match closure(xi)? {
        Closure::Nilpotent => identity.plus(xi),
        Closure::Circle(s) => {
            let (c0, c1) = (coefficient(0, &s), coefficient(1, &s));
            identity.scale(&c0).plus(&xi.scale(&c1))
        }
        Closure::Rotation(s) => {
            let (c1, c2) = (coefficient(1, &s), coefficient(2, &s));
            identity.plus(&xi.scale(&c1)).plus(&square().scale(&c2))
        }
        Closure::Screw(s) => {
            let (c2, c3) = (coefficient(2, &s), coefficient(3, &s));
            let squared = square();
            let cube = squared.times(xi);
            identity
                .plus(xi)
                .plus(&squared.scale(&c2))
                .plus(&cube.scale(&c3))
        }
    })
}

/// `exp(xi)` in closed form: by sine and cosine about a fixed axis, else by Stumpff functions.
pub fn exp(xi: &Matrix) -> Option<Matrix> {
    about_fixed_axis(xi).or_else(|| exp_by(xi, |order, s| s.stumpff(order)))
}

/// `exp(r u)` where the angle r is a polynomial that divides all entries of `xi`, times the root of a rational: `s = r²`, by its terms or, for a single symbol, by the laws of the functions in s.
fn about_fixed_axis(xi: &Matrix) -> Option<Matrix> {
    let identity = Matrix::identity(xi.rows());
    let found = closure(xi)?;
    let (Closure::Circle(s) | Closure::Rotation(s) | Closure::Screw(s)) = &found else {
        return None;
    };
    let ideal = Ideal::default();
    let mut symbols = xi.entries().iter().flat_map(Expr::symbols);
    let is_root = |symbol: &Symbol| ideal.vanishes(&(s - &Expr::symbol(symbol).square()));
    let (polynomial, factor) = match root_of_multiple(&ideal.normal_form(s)) {
        Some(found) => found,
        None => (Expr::symbol(&symbols.find(is_root)?), Expr::one()),
    };
    let r = &polynomial * &factor;
    let entries = xi.entries().iter();
    let quotient = |entry: &Expr| entry.exact_quotient(&polynomial);
    let entries: Option<Vec<Expr>> = entries.map(quotient).collect();
    let u = Matrix::from_entries(xi.rows(), xi.columns(), entries?)?;
    let u = u.scale(&factor.recip()?);
    let (cos, sin) = (r.cos(), r.sin());
    let turned = u.times(&u).scale(&(&Expr::one() - &cos));
    Some(match found {
        Closure::Circle(_) => identity.scale(&cos).plus(&u.scale(&sin)),
        Closure::Rotation(_) => identity.plus(&u.scale(&sin)).plus(&turned),
        _ => {
            let cube = u.times(&u).times(&u).scale(&(&r - &sin));
            identity.plus(xi).plus(&turned).plus(&cube)
        }
    })
}

/// A polynomial, and the root of a rational, whose product has the square `s`.
fn root_of_multiple(s: &Expr) -> Option<(Expr, Expr)> {
    if let Some(root) = s.polynomial_root() {
        return Some((root, Expr::one()));
    }
    let (_, coefficient) = s.leading().filter(|(_, c)| c.is_positive())?;
    let factor = Expr::rational(coefficient.clone());
    let rest = s * &factor.recip()?;
    Some((rest.polynomial_root()?, factor.sqrt()))
}

/// `exp(xi)` to second order: `I + ξ + ½ ξ²`.
pub fn exp_second_order(xi: &Matrix) -> Matrix {
    Matrix::identity(xi.rows())
        .plus(xi)
        .plus(&xi.times(xi).scale(&Expr::fraction(1, 2)))
}

/// The rotation matrix of a unit quaternion `(w, x, y, z)`.
pub fn rotation_of_quaternion(q: &[Expr]) -> Matrix {
    let vector = Matrix::tilde(&q[1..4]);
    let two = Expr::integer(2);
    let once = vector.scale(&(&two * &q[0]));
    Matrix::identity(3)
        .plus(&once)
        .plus(&vector.times(&vector).scale(&two))
}

#[cfg(test)]
mod tests {
    use super::{exp, exp_second_order, hat, standard_basis, vee};
    use crate::expr::{Expr, Role, Symbol, evaluate_f64};
    use crate::manifold::Kind;
    use crate::matrix::Matrix;

    const GROUPS: [Kind; 7] = [
        Kind::Real(2),
        Kind::S1,
        Kind::So2,
        Kind::Se2,
        Kind::So3,
        Kind::S3,
        Kind::Se3,
    ];

    fn symbols(kind: Kind) -> Vec<Symbol> {
        Symbol::series(Role::Local, "x", kind.dimension())
    }

    fn value(symbol: &Symbol) -> f64 {
        0.3 + 0.2 * f64::from(symbol.index)
    }

    /// The power series of exp at ‖ξ‖ < 2: 40 terms leave less than 2⁴⁰/40! = 1e-36.
    fn exp_by_series(xi: &Matrix) -> Vec<f64> {
        let n = xi.rows();
        let xi: Vec<f64> = xi
            .entries()
            .iter()
            .map(|e| evaluate_f64(e, &value))
            .collect();
        let identity: Vec<f64> = (0..n * n)
            .map(|i| f64::from(u8::from(i / n == i % n)))
            .collect();
        let (mut sum, mut power) = (identity.clone(), identity);
        for order in 1..40 {
            let product = |i: usize| {
                (0..n)
                    .map(|k| power[n * (i / n) + k] * xi[n * k + i % n])
                    .sum::<f64>()
            };
            power = (0..n * n).map(|i| product(i) / f64::from(order)).collect();
            sum.iter_mut().zip(&power).for_each(|(s, p)| *s += p);
        }
        sum
    }

    #[test]
    fn closed_forms_of_exp_are_exp() {
        for kind in GROUPS {
            let x: Vec<Expr> = symbols(kind).iter().map(Expr::symbol).collect();
            let xi = hat(kind, &x);
            let closed = exp(&xi).expect("a closed form");
            for (entry, expected) in closed.entries().iter().zip(exp_by_series(&xi)) {
                let got = evaluate_f64(entry, &value);
                // Sums of a dozen terms below 4 in double precision.
                assert!(
                    (got - expected).abs() < 1e-14,
                    "{}: {got} against {expected}",
                    kind.name()
                );
            }
        }
    }

    /// Turns and screws about fixed axes, of numbers of which the squares are no squares of numbers too.
    #[test]
    fn turns_about_fixed_axes_need_sines_alone() {
        let angle = Expr::symbol(&Symbol::new(Role::Local, 0, "x1"));
        let along = |number: i64| &angle * &Expr::fraction(number, 5);
        let root = Expr::integer(2).sqrt();
        let by_root = &angle * &root.recip().expect("not 0");
        let zero = Expr::zero;
        for (kind, x) in [
            (Kind::So2, vec![along(7)]),
            (Kind::So3, vec![along(3), along(4), zero()]),
            (Kind::So3, vec![by_root.clone(), zero(), by_root]),
            (Kind::S3, vec![along(3), zero(), along(-4)]),
            (Kind::Se2, vec![along(2), along(3), along(1)]),
            (
                Kind::Se3,
                vec![along(3), along(4), zero(), along(1), along(2), along(6)],
            ),
        ] {
            let xi = hat(kind, &x);
            let closed = exp(&xi).expect("a closed form");
            let functions: Vec<String> = closed
                .entries()
                .iter()
                .flat_map(Expr::related_functions)
                .map(|function| format!("{function:?}"))
                .collect();
            assert!(
                !functions.iter().any(|name| name.contains("Stumpff")),
                "{kind:?}"
            );
            for (entry, expected) in closed.entries().iter().zip(exp_by_series(&xi)) {
                let got = evaluate_f64(entry, &value);
                // As above.
                assert!(
                    (got - expected).abs() < 1e-14,
                    "{kind:?}: {got} against {expected}"
                );
            }
        }
    }

    #[test]
    fn the_series_is_the_closed_form_to_second_order() {
        for kind in GROUPS {
            let locals = symbols(kind);
            let x: Vec<Expr> = locals.iter().map(Expr::symbol).collect();
            let difference = exp(&hat(kind, &x))
                .expect("a closed form")
                .minus(&exp_second_order(&hat(kind, &x)));
            for a in &locals {
                for b in &locals {
                    let second = difference.derivative(a).derivative(b);
                    assert!(
                        second.map(|e| e.at_zero(&locals)).is_zero(),
                        "{}",
                        kind.name()
                    );
                }
            }
        }
    }

    #[test]
    fn coordinates_come_back() {
        for kind in GROUPS {
            for (n, element) in standard_basis(kind).iter().enumerate() {
                let unit: Vec<Expr> = (0..kind.dimension())
                    .map(|i| Expr::integer((i == n).into()))
                    .collect();
                assert_eq!(vee(kind, element), unit, "{}", kind.name());
            }
        }
    }
}
