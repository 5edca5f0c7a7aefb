//! Motion on a manifold that relations alone give: Φ(Q, ϕ) = Q exp(B ϕ + N λ), with λ so that the relations hold.
//!
//! All factors are groups; together they are G, with its standard directions. `∂φ` holds the derivatives of the c relations along these,
//! c×dim G. The columns of B span its null space, and v is read along them: `Q⁻¹Q̇ = B v`. N holds c directions along which the moved
//! configuration comes back onto the manifold. λ begins with second order in ϕ.

use super::motion::Motion;
use crate::algebra;
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::expr::{Expr, Role, Symbol};
use crate::manifold::{Ideal, Kind};
use crate::matrix::{Matrix, combinations};
use crate::model::{Freedom, Implicit};
use crate::prepare::Prepared;
use crate::spec::code;

/// How v moves Q, and how Φ comes back onto the manifold.
#[derive(Clone, Debug)]
pub struct Flow {
    /// B, dim G × k.
    pub tangent: Matrix,
    /// N, dim G × c.
    pub normal: Matrix,
    /// Never 0: the determinant that B is divided by, or the square of B where that is the cross product.
    pub regular: Expr,
    /// ∂S/∂ϕ_l, from the motion of Q alone; S₀ = I.
    pub slopes: Vec<Matrix>,
    /// ∂φ, c×dim G.
    pub gradient: Matrix,
    /// Whether ϕ adds up along every motion, so that S = I at finite ϕ.
    pub adds: bool,
}

/// Derivatives along the standard directions of G.
struct Directions<'a> {
    along: Motion,
    ideal: &'a Ideal,
    relations: &'a [Expr],
    /// ∂φ, c×dim G.
    gradient: Matrix,
}

/// Φ to second order, and the flow it follows.
///
/// # Errors
/// Factors that are no groups; a number of relations that does not fit; determinants that are 0 everywhere.
pub fn expand(
    joint: &Prepared,
    implicit: &Implicit,
    domain: &Domain<'_>,
) -> Result<(Motion, Flow), Vec<Diagnostic>> {
    check(joint, implicit)?;
    let manifold = &joint.space.manifold;
    let directions = Directions::new(joint);
    let (tangent, normal, regular) = match implicit {
        Implicit::Independent(chosen) => directions.independent(&columns(joint, chosen)),
        Implicit::CrossProduct => directions.cross_product(),
    }
    .ok_or_else(|| vec![dependent(joint)])?;
    let ideal = domain.ideal();
    let k = tangent.columns();
    let corrections = directions
        .corrections(&tangent, &normal)
        .ok_or_else(|| vec![dependent(joint)])?;
    let first: Vec<Vec<Expr>> = (0..k)
        .map(|i| directions.combined(&tangent.column(i)))
        .collect();
    let coordinates = manifold.coordinates();
    let second = |i: usize, j: usize| -> Vec<Expr> {
        let back = directions.combined(&corrections[i][j]);
        let curved = coordinates.iter().zip(&back).map(|(q, back)| {
            let bend = directions.symmetric(&Expr::symbol(q), &tangent, i, j);
            ideal.simplest(&(&bend + back))
        });
        curved.collect()
    };
    let second = (0..k)
        .map(|i| (0..k).map(|j| second(i, j)).collect())
        .collect();
    let motion = Motion::new(coordinates, first, second);
    let flow = (&tangent, &normal, &regular);
    let slopes = slopes(joint, implicit, &motion, flow, &corrections);
    Ok((
        motion,
        Flow {
            tangent,
            adds: adds(joint, implicit, &normal),
            gradient: directions.gradient,
            normal,
            regular,
            slopes,
        },
    ))
}

/// The displacement ξ of Q in G, in its standard directions; none where relations are not all that Φ is made of.
pub fn displacement(joint: &Prepared) -> Vec<Symbol> {
    match joint.spec.implicit {
        Some(_) => Symbol::series(Role::Displacement, "xi", joint.space.manifold.dimension()),
        None => vec![],
    }
}

/// The same configuration as one that moves freely in G, by Q exp(ξ).
pub fn freely(joint: &Prepared) -> Prepared {
    let factors = joint.space.manifold.factors().iter().enumerate();
    let directions = factors.flat_map(|(n, factor)| {
        let size = factor.kind.dimension();
        (0..size).map(move |d| (n, Matrix::identity(size).column(d)))
    });
    let named = directions.zip(displacement(joint));
    let freedoms = named.map(|((factor, generator), local)| Freedom {
        name: local.name.to_string(),
        local,
        factor,
        generator,
    });
    let mut free = joint.clone();
    free.spec.freedoms.value = freedoms.collect();
    free
}

/// The chosen directions in the standard ones of G, by columns.
fn columns(joint: &Prepared, chosen: &[(usize, Vec<Expr>)]) -> Matrix {
    let factors = joint.space.manifold.factors();
    let size = joint.space.manifold.dimension();
    let first = |n: usize| -> usize { factors[..n].iter().map(|f| f.kind.dimension()).sum() };
    let column = |(factor, generator): &(usize, Vec<Expr>)| {
        let mut column = vec![Expr::zero(); size];
        let start = first(*factor);
        column[start..start + generator.len()].clone_from_slice(generator);
        column
    };
    Matrix::from_columns(size, &chosen.iter().map(column).collect::<Vec<_>>())
}

impl<'a> Directions<'a> {
    fn new(joint: &'a Prepared) -> Self {
        let manifold = &joint.space.manifold;
        let along = Motion::of_known_manifold(manifold);
        let ideal = manifold.ideal();
        let relations = manifold.declared();
        let gradient = Matrix::from_fn(relations.len(), along.freedoms(), |i, j| {
            ideal.simplest(&along.along(&relations[i], j))
        });
        Self {
            along,
            ideal,
            relations,
            gradient,
        }
    }

    /// B, N and det(∂φ N) where the chosen directions are independent: `B = E − N (∂φ N)⁻¹ ∂φ E`, N standard directions beside them.
    fn independent(&self, chosen: &Matrix) -> Option<(Matrix, Matrix, Expr)> {
        let size = chosen.rows();
        let simplify = |e: &Expr| self.ideal.normal_form(e);
        // Of the standard directions that complete the chosen ones, those with the shortest determinant.
        let candidates = combinations(size, size - chosen.columns());
        let complete = candidates.into_iter().filter_map(|rest| {
            let unit = |&n: &usize| Matrix::identity(size).column(n);
            let normal = Matrix::from_columns(size, &rest.iter().map(unit).collect::<Vec<_>>());
            let whole = chosen.beside(&normal).determinant(&Expr::clone);
            let determinant = self.gradient.times(&normal).determinant(&simplify);
            (whole.as_rational().is_some() && !whole.is_zero() && !determinant.is_zero())
                .then_some((determinant, normal))
        });
        let (determinant, normal) =
            complete.min_by_key(|(determinant, _)| determinant.terms().len())?;
        let inverse = self.gradient.times(&normal).adjugate(&simplify);
        let inverse = inverse.scale(&determinant.recip()?);
        let back = normal.times(&inverse.times(&self.gradient.times(chosen)));
        let tangent = self.ideal.simplest_entries(&chosen.minus(&back));
        Some((tangent, normal, determinant))
    }

    /// B, N = ∂φᵀ and |B|² for one degree of freedom: the maximal minors of ∂φ with alternating signs.
    fn cross_product(&self) -> Option<(Matrix, Matrix, Expr)> {
        let size = self.gradient.columns();
        let simplify = |e: &Expr| self.ideal.normal_form(e);
        let transposed = self.gradient.transpose();
        let minor = |left_out: usize| {
            let rows: Vec<usize> = (0..size).filter(|&n| n != left_out).collect();
            let minor = transposed.select_rows(&rows).determinant(&simplify);
            match left_out % 2 {
                0 => minor,
                _ => -&minor,
            }
        };
        let tangent = Matrix::column_vector((0..size).map(minor).collect());
        let square: Expr = tangent.entries().iter().map(Expr::square).sum();
        let square = self.ideal.simplest(&square);
        (!tangent.is_zero() && !square.is_zero()).then_some((tangent, transposed, square))
    }

    /// The rates of the stored scalars along a combination of the directions.
    fn combined(&self, weights: &[Expr]) -> Vec<Expr> {
        let sum = |n: usize| -> Expr {
            let terms = weights.iter().enumerate();
            terms
                .map(|(d, weight)| weight * &self.along.direction(d)[n])
                .sum()
        };
        let count = self.along.direction(0).len();
        (0..count).map(|n| self.ideal.simplest(&sum(n))).collect()
    }

    /// `½ (L_a L_b + L_b L_a) f` with a and b the columns i and j of `tangent`, held constant.
    fn symmetric(&self, function: &Expr, tangent: &Matrix, i: usize, j: usize) -> Expr {
        let size = tangent.rows();
        let once: Vec<Expr> = (0..size).map(|d| self.along.along(function, d)).collect();
        let twice = |i: usize, j: usize| -> Expr {
            let pairs = (0..size).flat_map(|d| (0..size).map(move |e| (d, e)));
            let weighted = pairs.filter_map(|(d, e)| {
                let weight = tangent.at(d, i) * tangent.at(e, j);
                (!weight.is_zero()).then(|| &weight * &self.along.along(&once[e], d))
            });
            weighted.sum()
        };
        match i == j {
            true => twice(i, i),
            false => &(&twice(i, j) + &twice(j, i)) * &Expr::fraction(1, 2),
        }
    }

    /// `N ∂²λ/∂ϕ_i∂ϕ_j = −N (∂φ N)⁻¹ ½ (L_i L_j + L_j L_i) φ`, in the standard directions.
    fn corrections(&self, tangent: &Matrix, normal: &Matrix) -> Option<Vec<Vec<Vec<Expr>>>> {
        let k = tangent.columns();
        let simplify = |e: &Expr| self.ideal.normal_form(e);
        let square = self.ideal.normal_forms(&self.gradient.times(normal));
        let inverse = square.determinant(&simplify).recip()?;
        let inverse = square.adjugate(&simplify).scale(&inverse);
        let correction = |i: usize, j: usize| {
            let bends = self
                .relations
                .iter()
                .map(|relation| simplify(&self.symmetric(relation, tangent, i, j)));
            let bends = Matrix::column_vector(bends.collect());
            let back = normal.times(&inverse.times(&bends)).map(|entry| -entry);
            self.ideal.simplest_entries(&back).entries().to_vec()
        };
        let rows = (0..k).map(|i| (0..k).map(|j| correction(i, j)).collect());
        Some(rows.collect())
    }
}

/// ∂S/∂ϕ_l from `B S_l e_k = N λ_kl − ½ [B_l, B_k] − ∂_l B_k`, to which a left inverse of B is applied: of the independent directions, or `Bᵀ / |B|²`.
fn slopes(
    joint: &Prepared,
    implicit: &Implicit,
    motion: &Motion,
    flow: (&Matrix, &Matrix, &Expr),
    corrections: &[Vec<Vec<Expr>>],
) -> Vec<Matrix> {
    let (tangent, normal, regular) = flow;
    let ideal = joint.space.manifold.ideal();
    let k = tangent.columns();
    let left = match implicit {
        Implicit::Independent(chosen) => upper(&columns(joint, chosen), normal),
        Implicit::CrossProduct => tangent
            .transpose()
            .scale(&regular.recip().unwrap_or_default()),
    };
    let column = |l: usize, i: usize| -> Vec<Expr> {
        let bracket = bracket(joint, &tangent.column(l), &tangent.column(i));
        let entries = (0..tangent.rows()).map(|d| {
            let curved = &corrections[i][l][d] - &(&bracket[d] * &Expr::fraction(1, 2));
            &curved - &motion.along(tangent.at(d, i), l)
        });
        entries.collect()
    };
    let slope = |l: usize| {
        let columns: Vec<Vec<Expr>> = (0..k).map(|i| column(l, i)).collect();
        let right = Matrix::from_columns(tangent.rows(), &columns);
        ideal.simplest_entries(&left.times(&right))
    };
    (0..k).map(slope).collect()
}

/// P with `P E = I` and `P N = 0` for the independent directions E: what a displacement has along them, k×dim G.
fn upper(chosen: &Matrix, normal: &Matrix) -> Matrix {
    let whole = chosen.beside(normal);
    algebra::left_inverse(&whole).block(0, 0, chosen.columns(), whole.rows())
}

/// Whether `P dexp(ξ) = P` at every ξ: then `P B = I` at every Q makes ϕ̇ the same v all along Φ. That is where P takes every bracket to 0.
fn adds(joint: &Prepared, implicit: &Implicit, normal: &Matrix) -> bool {
    let Implicit::Independent(chosen) = implicit else {
        return false;
    };
    let left = upper(&columns(joint, chosen), normal);
    let size = left.columns();
    let unit = |n: usize| Matrix::identity(size).column(n);
    let mut pairs = (0..size).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.all(|(i, j)| {
        let bracket = Matrix::column_vector(bracket(joint, &unit(i), &unit(j)));
        left.times(&bracket).is_zero()
    })
}

/// [a, b] in the standard directions of G.
fn bracket(joint: &Prepared, a: &[Expr], b: &[Expr]) -> Vec<Expr> {
    let mut first = 0;
    let factors = joint.space.manifold.factors().iter();
    let parts = factors.flat_map(|factor| {
        let own = first..first + factor.kind.dimension();
        first = own.end;
        let hat = |x: &[Expr]| algebra::hat(factor.kind, &x[own.clone()]);
        algebra::vee(factor.kind, &algebra::commutator(&hat(a), &hat(b)))
    });
    parts.collect()
}

fn check(joint: &Prepared, implicit: &Implicit) -> Result<(), Vec<Diagnostic>> {
    let manifold = &joint.space.manifold;
    let error = |message: String| {
        Diagnostic::new(code::DIMENSION, joint.spec.manifold.span.clone(), message)
    };
    let mut factors = manifold.factors().iter();
    if let Some(factor) = factors.find(|factor| factor.kind == Kind::S2) {
        let message = format!(
            "factor `{}` is S2, which is no group, so that relations alone do not say how it moves",
            factor.name
        );
        let help = format!(
            "declare Phi, or take `{0}: R3` and `relation dot({0}, {0}) = 1;`",
            factor.name
        );
        return Err(vec![error(message).label("no group").help(help)]);
    }
    let (dimension, count) = (manifold.dimension(), manifold.declared().len());
    let freedoms = joint.spec.freedoms.value.len();
    if freedoms + count == dimension {
        return Ok(());
    }
    let left = dimension.saturating_sub(count);
    let named = match implicit {
        Implicit::CrossProduct => 0,
        Implicit::Independent(_) => freedoms,
    };
    let message = format!(
        "{dimension} dimensions of the factors less {count} of relations leave {left} degrees of freedom; named: {named}"
    );
    let help = match left > freedoms {
        true => format!(
            "name {left} independent directions by `basis`, as in `basis turn of so2(a);`; all others follow by the relations"
        ),
        false => "relations and degrees of freedom together are as many as the factors have dimensions: leave out relations that follow from \
              others, name independent directions by `basis`, or declare Phi"
            .to_owned(),
    };
    Err(vec![error(message).label("of these factors").help(help)])
}

fn dependent(joint: &Prepared) -> Diagnostic {
    Diagnostic::new(
        code::DIMENSION,
        joint.spec.freedoms.span.clone(),
        "the other directions do not follow from these by the relations, at any configuration",
    )
    .label("these directions")
    .help("name other directions by `basis`, or leave out relations that follow from others")
}
