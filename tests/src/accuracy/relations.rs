//! Φ of a joint that declares relations alone, from its definition: `Φ(Q, ϕ) = Q exp(B ϕ + N λ)` with the λ for which the relations hold.
//!
//! B and N come from the relations' derivatives along the group, of the symbols as declared, by systems solved in 256 bits: nothing is
//! simplified by the relations, and no determinant is expanded.

use super::declared::{constants, exponential, values};
use super::environment::Environment;
use super::jet::{MOST, ONCE};
use super::{Grid, Jet, Node};
use hamel_codegen::algebra;
use hamel_codegen::expr::{Expr, Number, Role, Symbol};
use hamel_codegen::manifold::Manifold;
use hamel_codegen::matrix::Matrix;
use hamel_codegen::model::{Implicit, JointSpec};

/// Parts of a finite ϕ, so that Newton's method stays on the branch of Q.
const PARTS: usize = 8;
/// Newton steps after each part: from an error of a tenth, three leave less than a thousandth, where the next part begins well.
const STEPS: usize = 3;
/// Newton steps at the end: from an error of a thousandth, eight that square it leave less than the 256 bits see.
const LAST_STEPS: usize = 8;

/// The definition of Φ by relations.
#[derive(Clone, Debug)]
pub struct Relations {
    relations: Vec<Expr>,
    /// ∂φ along the standard directions of the group, c×G.
    gradient: Matrix,
    choice: Choice,
    /// The rates of the stored scalars along the standard directions, N×G.
    rates: Matrix,
    /// The displacement ξ in the group.
    displacement: Vec<Symbol>,
    /// Q exp(ξ), stored scalars.
    displaced: Vec<Expr>,
}

/// How v moves Q.
#[derive(Clone, Debug)]
enum Choice {
    /// Independent directions, G×k, and the standard directions that follow, G×c.
    Independent(Matrix, Matrix),
    CrossProduct,
}

impl Relations {
    /// That of a spec; nothing where Φ is declared, or is the exponential map.
    pub fn of(spec: &JointSpec) -> Option<Self> {
        let choice = spec.implicit.as_ref()?;
        let manifold = &spec.manifold.value;
        let relations = manifold.declared().to_vec();
        let displacement = Symbol::series(Role::Displacement, "xi", manifold.dimension());
        let symbols: Vec<Expr> = displacement.iter().map(Expr::symbol).collect();
        let rates = rates(manifold);
        let coordinates = manifold.coordinates();
        let along = |i: usize, d: usize| -> Expr {
            let terms = coordinates.iter().zip(&rates[d]);
            terms
                .map(|(q, rate)| &relations[i].derivative(q) * rate)
                .sum()
        };
        Some(Self {
            gradient: Matrix::from_fn(relations.len(), rates.len(), along),
            choice: match choice {
                Implicit::CrossProduct => Choice::CrossProduct,
                Implicit::Independent(chosen) => independent(manifold, chosen),
            },
            displaced: exponential(manifold, &symbols),
            rates: Matrix::from_columns(coordinates.len(), &rates),
            displacement,
            relations,
        })
    }

    /// B and N at Q, G×k and G×c.
    fn bases(&self, at: &Environment) -> (Grid<Jet>, Grid<Jet>) {
        let gradient = at.matrix(&self.gradient);
        match &self.choice {
            Choice::CrossProduct => (cross_product(&gradient), gradient.transpose()),
            Choice::Independent(chosen, rest) => {
                let (chosen, normal) = (at.matrix(chosen), at.matrix(rest));
                let follows = solve(&gradient.times(&normal), &gradient.times(&chosen));
                (chosen.minus(&normal.times(&follows)), normal)
            }
        }
    }

    /// The rates of the stored scalars along the shortest displacement that changes each relation by 1, N×c, and the relations.
    pub fn shifts(&self, at: &Environment) -> (Grid<Node>, Grid<Node>) {
        let across = values(&at.matrix(&self.gradient)).transpose();
        let shortest = across.left_inverse().transpose();
        let rates = values(&at.matrix(&self.rates));
        let relations = Grid::column(at.evaluate_all(&self.relations));
        (rates.times(&shortest), values(&relations))
    }

    /// Q exp(ξ).
    fn displaced(&self, at: &Environment, displacement: &Grid<Jet>) -> Vec<Jet> {
        let moved = at.with(&self.displacement, displacement.entries());
        moved.evaluate_all(&self.displaced)
    }

    /// The relations at a configuration.
    fn values(&self, at: &Environment, coordinates: &[Symbol], q: &[Jet]) -> Grid<Jet> {
        Grid::column(at.with(coordinates, q).evaluate_all(&self.relations))
    }

    /// Φ(Q, ϕ); `at` has the values of Q and the parameters.
    ///
    /// Where ϕ is 0 and varies, the relations keep the value that they have at Q, which is off the manifold by roundings; at a finite ϕ they are 0.
    pub fn moved(&self, at: &Environment, coordinates: &[Symbol], phi: &[Jet]) -> Vec<Jet> {
        let (tangent, normal) = self.bases(at);
        let path = Path {
            along: &|phi: &Grid<Jet>, lambda: &Grid<Jet>| {
                let ahead = tangent.times(phi).plus(&normal.times(lambda));
                self.displaced(at, &ahead)
            },
            relations: &|q: &[Jet]| self.values(at, coordinates, q),
            count: self.relations.len(),
        };
        let phi = Grid::column(phi.to_vec());
        let lambda = match phi.entries().iter().all(|entry| entry.value.is_nothing()) {
            true => {
                let slopes = values(&at.matrix(&self.gradient).times(&normal));
                path.near(&phi, &slopes)
            }
            false => path.far(&phi),
        };
        (path.along)(&phi, &lambda)
    }
}

/// ϕ and λ to Q exp(B ϕ + N λ).
type Along<'a> = &'a dyn Fn(&Grid<Jet>, &Grid<Jet>) -> Vec<Jet>;

/// The surface on which λ is sought.
struct Path<'a> {
    along: Along<'a>,
    relations: &'a dyn Fn(&[Jet]) -> Grid<Jet>,
    count: usize,
}

impl Path<'_> {
    fn nothing(&self) -> Grid<Jet> {
        Grid::column(vec![Jet::input(0.0); self.count])
    }

    /// λ as a polynomial in ϕ at ϕ = 0: each step makes it right to one degree more. `slopes` is ∂φ N at Q.
    fn near(&self, phi: &Grid<Jet>, slopes: &Grid<Node>) -> Grid<Jet> {
        let inverse = slopes.inverse().map(|entry| Jet::constant(entry.clone()));
        let mut lambda = self.nothing();
        for _ in 0..MOST {
            let left = (self.relations)(&(self.along)(phi, &lambda));
            lambda = lambda.minus(&inverse.times(&left.map(Jet::varying)));
        }
        lambda
    }

    /// The relations at ϕ and λ, and the inverse of their derivatives by λ.
    fn newton(&self, phi: &Grid<Jet>, lambda: &Grid<Node>) -> (Grid<Node>, Grid<Node>) {
        let variable = |(i, value): (usize, &Node)| Jet::variable(value.clone(), ONCE + i, 1);
        let moving = lambda.entries().iter().enumerate().map(variable).collect();
        let left = (self.relations)(&(self.along)(phi, &Grid::column(moving)));
        let count = self.count;
        let slopes = Grid::from_fn(count, count, |i, j| left.at(i, 0).slope(ONCE + j));
        (values(&left), slopes.inverse())
    }

    /// λ at a finite ϕ, with its derivatives along ϕ to first order.
    fn far(&self, phi: &Grid<Jet>) -> Grid<Jet> {
        let end = values(phi);
        let mut lambda = values(&self.nothing());
        for part in 1..=PARTS {
            let share = Node::input(part as f64 / PARTS as f64);
            let there = end.map(|entry| Jet::constant(entry.times(&share)));
            let steps = if part < PARTS { STEPS } else { LAST_STEPS };
            for _ in 0..steps {
                let (left, inverse) = self.newton(&there, &lambda);
                lambda = lambda.minus(&inverse.times(&left)).map(Node::anew);
            }
        }
        let (_, inverse) = self.newton(&Grid::column(constants(end.entries())), &lambda);
        let lambda = Grid::column(constants(lambda.entries()));
        let left = (self.relations)(&(self.along)(phi, &lambda));
        let inverse = inverse.map(|entry| Jet::constant(entry.clone()));
        lambda.minus(&inverse.times(&left))
    }
}

/// The rates of the stored scalars along each standard direction of the group.
fn rates(manifold: &Manifold) -> Vec<Vec<Expr>> {
    let size = manifold.dimension();
    let direction = |d: usize| -> Vec<Expr> {
        let unit = Matrix::identity(size).column(d);
        let mut rest = unit.as_slice();
        let factors = manifold.factors().iter().flat_map(|factor| {
            let (own, others) = rest.split_at(factor.kind.dimension());
            rest = others;
            factor.coordinates_of(&factor.matrix().times(&algebra::hat(factor.kind, own)))
        });
        factors.collect()
    };
    (0..size).map(direction).collect()
}

/// The chosen directions, and the standard directions that none of them has a part along.
///
/// # Panics
/// Where these are not as many as are left: a choice of what follows would then be the generator's own.
fn independent(manifold: &Manifold, chosen: &[(usize, Vec<Expr>)]) -> Choice {
    let size = manifold.dimension();
    let factors = manifold.factors();
    let first = |n: usize| -> usize { factors[..n].iter().map(|f| f.kind.dimension()).sum() };
    let column = |(factor, generator): &(usize, Vec<Expr>)| {
        let mut column = vec![Expr::zero(); size];
        let start = first(*factor);
        column[start..start + generator.len()].clone_from_slice(generator);
        column
    };
    let columns: Vec<Vec<Expr>> = chosen.iter().map(column).collect();
    let rest = (0..size).filter(|&d| columns.iter().all(|column| column[d].is_zero()));
    let rest: Vec<Vec<Expr>> = rest.map(|d| Matrix::identity(size).column(d)).collect();
    assert_eq!(columns.len() + rest.len(), size, "directions that follow");
    Choice::Independent(
        Matrix::from_columns(size, &columns),
        Matrix::from_columns(size, &rest),
    )
}

/// The maximal minors of c×(c + 1) with alternating signs: what the rows are orthogonal to.
fn cross_product(gradient: &Grid<Jet>) -> Grid<Jet> {
    let (rows, columns) = (gradient.rows, gradient.columns);
    let minor = |left_out: usize| {
        let kept: Vec<usize> = (0..columns).filter(|&j| j != left_out).collect();
        let minor = determinant(&Grid::from_fn(rows, rows, |i, j| {
            gradient.at(i, kept[j]).clone()
        }));
        match left_out % 2 {
            0 => minor,
            _ => negative(&minor),
        }
    };
    Grid::column((0..columns).map(minor).collect())
}

fn negative(jet: &Jet) -> Jet {
    Grid::column(vec![jet.clone()]).negative().at(0, 0).clone()
}

/// By the first row.
fn determinant(matrix: &Grid<Jet>) -> Jet {
    let size = matrix.rows;
    if size == 1 {
        return matrix.at(0, 0).clone();
    }
    let term = |j: usize| {
        let column = |n: usize| if n < j { n } else { n + 1 };
        let rest = Grid::from_fn(size - 1, size - 1, |i, n| {
            matrix.at(i + 1, column(n)).clone()
        });
        let term = matrix.at(0, j).times(&determinant(&rest));
        match j.is_multiple_of(2) {
            true => term,
            false => negative(&term),
        }
    };
    (1..size).fold(term(0), |sum, j| sum.plus(&term(j)))
}

/// `A⁻¹ R` of polynomials: the inverse of A's constant part, and a correction that is right to one degree more each time.
fn solve(matrix: &Grid<Jet>, right: &Grid<Jet>) -> Grid<Jet> {
    let inverse = values(matrix).inverse();
    let inverse = inverse.map(|entry| Jet::constant(entry.clone()));
    let varying = matrix.map(Jet::varying);
    let mut solution = inverse.times(right);
    for _ in 0..MOST {
        solution = inverse.times(&right.minus(&varying.times(&solution)));
    }
    solution
}
