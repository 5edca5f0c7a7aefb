//! Equality on a manifold: normal forms modulo its relations and those of the functions that occur.

use super::groebner::{self, NotMonic};
use crate::expr::{Atom, Expr, Function};
use crate::matrix::Matrix;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// The ideal of a manifold's relations, with its Gröbner basis.
#[derive(Clone, Debug, Default)]
pub struct Ideal {
    basis: Vec<Expr>,
    /// Bases extended by the relations of the functions that an expression holds, by those functions.
    extended: RefCell<BTreeMap<BTreeSet<Atom>, Vec<Expr>>>,
}

impl Ideal {
    /// The ideal of the relations.
    pub fn new(relations: &[Expr]) -> Result<Self, NotMonic> {
        Ok(Self {
            basis: groebner::groebner_basis(relations)?,
            extended: RefCell::default(),
        })
    }

    /// The reduced Gröbner basis of the manifold's own relations.
    pub fn basis(&self) -> &[Expr] {
        &self.basis
    }

    /// The normal form: zero exactly for the expressions that vanish modulo the relations.
    pub fn normal_form(&self, expression: &Expr) -> Expr {
        let functions = related_functions(expression);
        if functions.is_empty() {
            return groebner::reduce(expression, &self.basis);
        }
        let known = self.extended.borrow().get(&functions).cloned();
        let basis = known.unwrap_or_else(|| self.extend(functions));
        groebner::reduce(expression, &basis)
    }

    /// Whether the expression vanishes on the manifold.
    pub fn vanishes(&self, expression: &Expr) -> bool {
        self.normal_form(expression).is_zero()
    }

    /// Entry by entry.
    pub fn normal_forms(&self, matrix: &Matrix) -> Matrix {
        matrix.map(|entry| self.normal_form(entry))
    }

    /// The shorter of an expression and its normal form; the expression as it stands where they are alike.
    pub fn simplest(&self, expression: &Expr) -> Expr {
        let normal = self.normal_form(expression);
        match weight(&normal) < weight(expression) {
            true => normal,
            false => expression.clone(),
        }
    }

    /// Entry by entry.
    pub fn simplest_entries(&self, matrix: &Matrix) -> Matrix {
        matrix.map(|entry| self.simplest(entry))
    }

    /// Whether the expressions have no common zero on the manifold, shown by 1 being among their combinations.
    pub fn has_no_zero_with(&self, expressions: &[Expr]) -> bool {
        let functions: BTreeSet<Atom> = expressions.iter().flat_map(related_functions).collect();
        let mut all = match functions.is_empty() {
            true => self.basis.clone(),
            false => self.extend(functions),
        };
        all.extend_from_slice(expressions);
        groebner::groebner_basis(&all).is_ok_and(|basis| groebner::is_trivial(&basis))
    }

    fn extend(&self, functions: BTreeSet<Atom>) -> Vec<Expr> {
        let relations = functions
            .iter()
            .flat_map(|atom| Expr::atom(atom.clone()).atom_relations());
        let mut all: Vec<Expr> = self.basis.clone();
        for relation in relations {
            if !all.contains(&relation) {
                all.push(relation);
            }
        }
        // Fails only for the reciprocal of a sum of parameters; what needs that relation is then not proved, and refused.
        let basis = groebner::groebner_basis(&all).unwrap_or_else(|_| self.basis.clone());
        self.extended.borrow_mut().insert(functions, basis.clone());
        basis
    }
}

/// Number of operations to write the expression as it stands.
fn weight(expression: &Expr) -> usize {
    expression
        .terms()
        .map(|(monomial, _)| {
            1 + monomial
                .factors()
                .map(|(_, power)| power.unsigned_abs() as usize)
                .sum::<usize>()
        })
        .sum()
}

/// The functions with relations that occur in the expression, those inside arguments of roots and quotients included.
fn related_functions(expression: &Expr) -> BTreeSet<Atom> {
    let mut found = BTreeSet::new();
    for atom in expression.atoms() {
        let Atom::Apply(application) = &atom else {
            continue;
        };
        match application.function {
            Function::Cos | Function::Sin => {
                found.insert(atom);
            }
            Function::Sqrt | Function::Recip => {
                found.extend(application.arguments.iter().flat_map(related_functions));
                found.insert(atom);
            }
            _ => {}
        }
    }
    found
}
