//! Motion on a manifold that relations alone give: Φ(Q, ϕ) = Q exp(B ϕ + N λ), with λ so that the relations hold.
//!
//! All factors are groups; together they are G, with its standard directions. `∂φ` holds the derivatives of the c relations along these,
//! c×dim G. The columns of B span its null space, and v is read along them: `Q⁻¹Q̇ = B v`. N holds c directions along which the moved
//! configuration comes back onto the manifold. λ begins with second order in ϕ.

mod cross_product;
mod directions;
mod named;
mod system;

pub use directions::Directions;
pub use named::Systems;
pub use system::without_content;

use named::Named;

use super::dimension::relation_slopes;
use super::motion::Motion;
use crate::algebra;
use crate::diagnostic::Diagnostic;
use crate::domain::Domain;
use crate::expr::{Expr, Role, Symbol};
use crate::kernel::Word;
use crate::manifold::{Ideal, Kind};
use crate::matrix::Matrix;
use crate::model::{Freedom, Implicit};
use crate::prepare::{Prepared, insert};
use crate::spec::code;

/// How v moves Q, and how Φ comes back onto the manifold.
#[derive(Clone, Debug)]
pub struct Flow {
    /// B, dim G × k.
    pub tangent: Matrix,
    /// N, dim G × c.
    pub normal: Matrix,
    /// `N ∂²λ/∂ϕ_i∂ϕ_j`, in the standard directions of G.
    pub corrections: Vec<Vec<Vec<Expr>>>,
    /// These have no common zero: the determinant that B is divided by, or the entries of B where that is the cross product.
    pub regular: Vec<Expr>,
    /// ∂S/∂ϕ_l, from the motion of Q alone; S₀ = I.
    pub slopes: Vec<Matrix>,
    /// ∂φ, c×dim G.
    pub gradient: Matrix,
    /// Whether ϕ adds up along every motion, so that S = I at finite ϕ.
    pub adds: bool,
    /// The names in B and in what is derived of it, and what they are.
    pub systems: Systems,
}

impl Flow {
    /// The names in B and in what is derived of it, each after those in its value.
    pub fn words(&self) -> &[Word] {
        &self.systems.words
    }
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
    let directions = Directions::new(joint);
    let bases = match implicit {
        Implicit::Independent(chosen) => {
            Bases::independent(joint, domain, &directions, &columns(joint, chosen))
        }
        Implicit::CrossProduct => Bases::cross_product(joint, &directions),
    };
    let bases = bases.ok_or_else(|| vec![dependent(joint)])?;
    let motion = motion(joint, domain.ideal(), &directions, &bases.named);
    let ideal = domain.ideal();
    let slopes = bases.named.slopes.iter();
    let flow = Flow {
        slopes: slopes.map(|slope| ideal.simplest_entries(slope)).collect(),
        adds: adds(joint, implicit, &bases.normal),
        tangent: bases.named.tangent,
        normal: bases.normal,
        regular: bases.regular,
        systems: bases.named.systems,
        corrections: bases.named.corrections,
        gradient: directions.gradient,
    };
    Ok((motion, flow))
}

/// What Φ is made of.
struct Bases {
    named: Named,
    /// N.
    normal: Matrix,
    /// These have no common zero.
    regular: Vec<Expr>,
}

impl Bases {
    fn independent(
        joint: &Prepared,
        domain: &Domain<'_>,
        directions: &Directions<'_>,
        chosen: &Matrix,
    ) -> Option<Self> {
        let (normal, determinant) = directions.normal(chosen, domain)?;
        Some(Self {
            named: named::expand(joint, directions, (chosen, &normal))?,
            normal,
            regular: vec![determinant],
        })
    }

    fn cross_product(joint: &Prepared, directions: &Directions<'_>) -> Option<Self> {
        let regular = directions.cross_product();
        let ideal = joint.space.manifold.ideal();
        if regular.iter().all(|entry| ideal.vanishes(entry)) {
            return None;
        }
        Some(Self {
            named: cross_product::expand(joint, directions, &regular)?,
            normal: directions.gradient.transpose(),
            regular,
        })
    }
}

/// Φ to second order.
fn motion(joint: &Prepared, ideal: &Ideal, directions: &Directions<'_>, named: &Named) -> Motion {
    let Named {
        tangent,
        corrections,
        ..
    } = named;
    let k = tangent.columns();
    let first = (0..k)
        .map(|i| directions.combined(&tangent.column(i)))
        .collect();
    let coordinates = joint.space.manifold.coordinates();
    let second = |i: usize, j: usize| -> Vec<Expr> {
        let back = directions.combined(&corrections[i][j]);
        let curved = coordinates.iter().zip(&back).map(|(q, back)| {
            let bend = directions.symmetric(&Expr::symbol(q), tangent, i, j);
            ideal.simplest(&(&bend + back))
        });
        curved.collect()
    };
    let second = (0..k)
        .map(|i| (0..k).map(|j| second(i, j)).collect())
        .collect();
    Motion::new(coordinates.clone(), first, second).with_named(named.rates.clone())
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
        name: local.name().to_string(),
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
            "name {left} independent directions, as in `{}`; all others follow by the relations",
            independent_directions(joint, left)
        ),
        false => "relations and degrees of freedom together are as many as the factors have dimensions: leave out relations that follow from \
              others, name independent directions by `basis`, or declare Phi"
            .to_owned(),
    };
    Err(vec![error(message).label("of these factors").help(help)])
}

/// Statements that name as many directions, such that at home the relations determine all others; the first ones where no such are found.
fn independent_directions(joint: &Prepared, count: usize) -> String {
    let manifold = &joint.space.manifold;
    let home = joint.space.manifold.coordinates().into_iter();
    let home = home.zip(joint.space.home.iter().cloned()).collect();
    let slopes = relation_slopes(joint).map(|slope| slope.substitute(&home));
    let (mut found, mut dependent) = (vec![], vec![]);
    // From the last on, so that the directions that come first are named.
    for direction in (0..slopes.columns()).rev() {
        if !insert(&mut dependent, slopes.column(direction)) {
            found.push(direction);
        }
    }
    found.reverse();
    if found.len() != count {
        found = (0..count).collect();
    }
    let mut first = 0;
    let mut statements = vec![];
    for factor in manifold.factors() {
        let own = first..first + factor.kind.dimension();
        let named = found.iter().enumerate();
        let named: Vec<String> = named
            .filter(|(_, direction)| own.contains(direction))
            .map(|(n, direction)| format!("v{} = e{}", n + 1, direction - own.start + 1))
            .collect();
        if let (false, Some(algebra)) = (named.is_empty(), factor.kind.algebra_name()) {
            let named = named.join(", ");
            statements.push(format!("basis {named} of {algebra}({});", factor.name));
        }
        first = own.end;
    }
    statements.join(" ")
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
