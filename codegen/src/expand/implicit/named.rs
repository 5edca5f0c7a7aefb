//! The tangent basis where directions are independent, entry by entry under a name: `B = E + N b`, E the independent directions, N
//! standard ones beside them.
//!
//! The columns of b solve `∂φ N b_i = −∂φ E_i`, so that `∂φ B = 0`. What brings Φ back, `N λ_ij`, solves `∂φ N λ_ij = −½ (L_i L_j + L_j L_i) φ`,
//! L_i the derivative along B_i held constant. With P the part of a displacement along E, `∂b_i/∂ϕ_l = λ_li − ½ [B_l, B_i] + ½ B P [B_l, B_i]`
//! along N, and S to first order is `I − ½ P [B ϕ, B ·]`: both sides solve the same system, by the derivative of `∂φ B = 0`. So all that is derived is a short polynomial in Q and these names.

use super::directions::Directions;
use super::system::{Inverse, LONGEST, Names};
use super::{bracket, upper};
use crate::expr::{Expr, Symbol};
use crate::kernel::Word;
use crate::matrix::Matrix;
use crate::prepare::Prepared;
use std::collections::BTreeMap;

/// Most terms of a second derivative of a relation that has no name of its own: multiplied out, those of loops in a plane become shorter.
pub(super) const LONGEST_BEND: usize = 4;

/// A column for each pair of degrees of freedom.
type ByPairs = Vec<Vec<Vec<Expr>>>;

/// B with its derivatives, in names.
pub struct Named {
    pub tangent: Matrix,
    /// `N λ_ij`, in the standard directions.
    pub corrections: Vec<Vec<Vec<Expr>>>,
    /// ∂S/∂ϕ_l.
    pub slopes: Vec<Matrix>,
    /// The derivatives of the names in B along each ϕ_l, such that `X S = J` holds for any values of names.
    pub rates: BTreeMap<Symbol, Vec<Expr>>,
    pub systems: Systems,
}

/// What the names are, and the systems that they solve.
#[derive(Clone, Debug)]
pub struct Systems {
    /// All names, each after those in its value.
    pub words: Vec<Word>,
    /// ∂φ, with names for long entries.
    pub gradient: Matrix,
    /// `½ (L_i L_j + L_j L_i) φ` in names, by i and j.
    pub bends: Vec<Vec<Vec<Expr>>>,
}

/// B and what follows, for these independent directions and those that depend on them.
pub fn expand(
    joint: &Prepared,
    directions: &Directions<'_>,
    (chosen, normal): (&Matrix, &Matrix),
) -> Option<Named> {
    let ideal = joint.space.manifold.ideal();
    let labels = Labels::new(joint, directions, normal);
    let mut names = Names::new(ideal);
    let gradient = named_gradient(directions, &labels, &mut names);
    let square = gradient.times(normal);
    let inverse = Inverse::new(&square, (&labels.relations, &labels.dependent), &mut names)?;
    let mut solver = Solver {
        ideal,
        labels,
        names,
        inverse,
    };
    let dependent = solver.dependent(&gradient, (chosen, normal));
    let tangent = chosen.plus(&normal.times(&dependent));
    let brackets = brackets(joint, &tangent);
    let left = upper(chosen, normal);
    let half = Expr::fraction(1, 2);
    let slope = |bracket: &Matrix| left.times(bracket).scale(&-&half);
    let slopes: Vec<Matrix> = brackets.iter().map(slope).collect();
    let turned = brackets.iter().zip(&slopes);
    let turned = turned.map(|(bracket, slope)| {
        let whole = bracket.scale(&half).plus(&tangent.times(slope));
        normal.transpose().times(&whole)
    });
    let turned: Vec<Matrix> = turned.collect();
    let known = Known {
        dependent: &dependent,
        turned: &turned,
    };
    let (bends, corrections) = solver.corrections(directions, &tangent, &known);
    let (mut words, mut known) = (solver.names.words, BTreeMap::new());
    let columns = (0..tangent.columns()).map(|i| dependent.column(i));
    for (i, column) in columns.enumerate() {
        for (n, entry) in column.iter().enumerate() {
            let Some(symbol) = entry.as_symbol() else {
                continue;
            };
            let along = corrections.iter().zip(&turned);
            let rate = |(bent, turned): (&Vec<Vec<Expr>>, &Matrix)| &bent[i][n] - turned.at(n, i);
            let rates: Vec<Expr> = along.map(rate).collect();
            give_rates(&mut words, symbol, rates.clone());
            known.insert(symbol.clone(), rates);
        }
    }
    let along_normal = |entries: &Vec<Expr>| {
        let column = Matrix::column_vector(entries.clone());
        normal.times(&column).entries().to_vec()
    };
    let rows = corrections.iter();
    Some(Named {
        corrections: rows
            .map(|row| row.iter().map(along_normal).collect())
            .collect(),
        tangent,
        slopes,
        rates: known,
        systems: Systems {
            words,
            gradient,
            bends,
        },
    })
}

/// Gives a name its derivatives along ϕ.
pub(super) fn give_rates(words: &mut [Word], symbol: &Symbol, rates: Vec<Expr>) {
    let own = words.iter_mut().find(|word| word.symbol == *symbol);
    if let Some(word) = own {
        word.rates = rates;
    }
}

/// Names of directions and relations.
pub(super) struct Labels {
    pub relations: Vec<String>,
    pub standard: Vec<String>,
    dependent: Vec<String>,
    pub freedoms: Vec<String>,
}

impl Labels {
    pub fn new(joint: &Prepared, directions: &Directions<'_>, normal: &Matrix) -> Self {
        let factors = joint.space.manifold.factors().iter();
        let standard = factors.flat_map(|factor| {
            let of_one = |n: usize| match factor.kind.dimension() {
                1 => factor.name.clone(),
                _ => format!("{}_{}", factor.name, n + 1),
            };
            (0..factor.kind.dimension()).map(of_one).collect::<Vec<_>>()
        });
        let standard: Vec<String> = standard.map(|name| name.to_ascii_lowercase()).collect();
        let place = |j: usize| normal.column(j).iter().position(Expr::is_one);
        let dependent = (0..normal.columns()).filter_map(place);
        let freedoms = joint.spec.freedoms.value.iter();
        Self {
            relations: (1..=directions.relations.len())
                .map(|n| n.to_string())
                .collect(),
            dependent: dependent.map(|n| standard[n].clone()).collect(),
            standard,
            freedoms: freedoms.map(|freedom| freedom.name.clone()).collect(),
        }
    }
}

pub(super) fn named_gradient(
    directions: &Directions<'_>,
    labels: &Labels,
    names: &mut Names<'_>,
) -> Matrix {
    let plain = &directions.gradient;
    let mut entries = vec![];
    for (relation, of_relation) in labels.relations.iter().enumerate() {
        for (n, direction) in labels.standard.iter().enumerate() {
            let name = format!("relation_{of_relation}_by_{direction}");
            entries.push(names.if_long(&name, plain.at(relation, n), LONGEST));
        }
    }
    let mut entries = entries.into_iter();
    plain.map(|_| entries.next().unwrap_or_default())
}

struct Solver<'a> {
    ideal: &'a crate::manifold::Ideal,
    labels: Labels,
    names: Names<'a>,
    inverse: Inverse,
}

impl Solver<'_> {
    /// b, by columns.
    fn dependent(&mut self, gradient: &Matrix, (chosen, normal): (&Matrix, &Matrix)) -> Matrix {
        let mut columns = vec![];
        for i in 0..chosen.columns() {
            let along = Matrix::column_vector(chosen.column(i));
            let freedom = self.labels.freedoms[i].clone();
            columns.push(self.solved(gradient.times(&along).entries(), &freedom, &|_| None));
        }
        Matrix::from_columns(normal.columns(), &columns)
    }

    /// The opposite of the inverse times the right side, entry by entry under a name, where the entry is not `known`.
    fn solved(
        &mut self,
        right: &[Expr],
        by: &str,
        known: &dyn Fn(usize) -> Option<Expr>,
    ) -> Vec<Expr> {
        let values = self.inverse.times(right);
        let entry = |(n, value): (usize, &Expr)| {
            if let Some(known) = known(n) {
                return known;
            }
            let value = -self.ideal.simplest(value);
            if value.is_constant() {
                return value;
            }
            let name = format!("{}_by_{by}", self.labels.dependent[n]);
            Expr::symbol(&self.names.named(&name, value))
        };
        values.iter().enumerate().map(entry).collect()
    }

    /// `½ (L_i L_j + L_j L_i) φ` and λ_ij, by i and j.
    fn corrections(
        &mut self,
        directions: &Directions<'_>,
        tangent: &Matrix,
        known: &Known<'_>,
    ) -> (ByPairs, ByPairs) {
        let count = tangent.columns();
        let mut bends = vec![vec![vec![]; count]; count];
        let mut solved = bends.clone();
        for i in 0..count {
            for j in i..count {
                let by = format!("{}_{}", self.labels.freedoms[i], self.labels.freedoms[j]);
                let relations = directions.relations.iter().zip(&self.labels.relations);
                let bend = |(relation, label): (&Expr, &String)| {
                    let value = directions.symmetric(relation, tangent, i, j);
                    let name = format!("relation_{label}_by_{by}");
                    self.names.if_long(&name, &value, LONGEST_BEND)
                };
                bends[i][j] = relations.map(bend).collect();
                solved[i][j] =
                    self.solved(&bends[i][j].clone(), &by, &|n| known.correction(n, i, j));
                bends[j][i] = bends[i][j].clone();
                solved[j][i] = solved[i][j].clone();
            }
        }
        (bends, solved)
    }
}

/// What is known of λ without its system.
struct Known<'a> {
    /// b.
    dependent: &'a Matrix,
    /// `λ_li − ∂b_i/∂ϕ_l`, by l.
    turned: &'a [Matrix],
}

impl Known<'_> {
    /// Entry n of λ_ij where that of b_i or b_j is constant, so that its derivative is 0.
    fn correction(&self, n: usize, i: usize, j: usize) -> Option<Expr> {
        let of_constant = |i: usize, l: usize| {
            let is_constant = self.dependent.at(n, i).is_constant();
            is_constant.then(|| self.turned[l].at(n, i).clone())
        };
        of_constant(i, j).or_else(|| of_constant(j, i))
    }
}

/// [B_l, B_i]: slice l holds it in column i.
fn brackets(joint: &Prepared, tangent: &Matrix) -> Vec<Matrix> {
    let count = tangent.columns();
    let of = |l: usize, i: usize| bracket(joint, &tangent.column(l), &tangent.column(i));
    let slice = |l: usize| {
        let columns: Vec<Vec<Expr>> = (0..count).map(|i| of(l, i)).collect();
        Matrix::from_columns(tangent.rows(), &columns)
    };
    (0..count).map(slice).collect()
}
