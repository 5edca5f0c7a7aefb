//! Identities by their derivatives: a residual that is 0 everywhere changes nowhere. What cancels in a residual is often gone from its
//! derivative by algebra, and then an error shows at any point, however small it is there.

use super::place::Place;
use super::{MOST_TERMS, Open, Search};
use crate::expr::{Atom, Expr, Function, Monomial, Symbol};
use crate::manifold::{Factor, Kind};
use crate::model::Parameter;
use crate::prepare::Prepared;
use std::cell::Cell;
use std::collections::BTreeMap;

/// A tangent of the domain: symbols and how they change.
type Direction = Vec<(Symbol, Expr)>;

impl Search<'_> {
    /// A place where a derivative of some residual excludes 0, so that the residual is not 0 all around it.
    pub(super) fn changes(&self) -> Option<Place> {
        let slopes = self.slopes();
        let terms: usize = slopes.iter().map(|(slope, _)| slope.terms().len()).sum();
        if slopes.is_empty() || terms > MOST_TERMS {
            return None;
        }
        let search = Search {
            identities: self.identities,
            open: &slopes,
            sides: self.sides.clone(),
            agreeing: Cell::new(0),
        };
        let (identities, points) = (self.identities, &self.identities.points);
        let near = search.at_all(points.near(identities));
        let place = near.or_else(|| search.at_all(points.beyond(identities)));
        place.map(Place::of_derivative)
    }

    /// The derivatives of residuals that do not vanish by algebra.
    fn slopes(&self) -> Vec<Open> {
        let directions = tangents(self.identities.joint);
        let of_all = self.open.iter().flat_map(|(_, residual)| {
            directions
                .iter()
                .map(|direction| along(residual, direction))
        });
        let with_normal = of_all.map(|slope| {
            let slope = self.without_zeros(&slope);
            let normal = self.identities.ideal.normal_form(&slope);
            (slope, normal)
        });
        with_normal
            .filter(|(_, normal)| !normal.is_zero())
            .collect()
    }
}

impl Search<'_> {
    /// The expression without what vanishes of it: the terms with the same functions, quotients aside, are looked at together.
    fn without_zeros(&self, expression: &Expr) -> Expr {
        let mut groups: BTreeMap<Monomial, Expr> = BTreeMap::new();
        for (monomial, coefficient) in expression.terms() {
            let functions = monomial.factors().filter(|(atom, _)| match atom {
                Atom::Apply(application) => application.function != Function::Recip,
                Atom::Symbol(_) => false,
            });
            let group = groups.entry(Monomial::of_factors(functions)).or_default();
            *group = &*group + &Expr::term(coefficient.clone(), monomial.clone());
        }
        let left = groups.into_values();
        let left = left.filter(|group| !self.identities.ideal.vanishes(group));
        left.fold(Expr::default(), |sum, group| &sum + &group)
    }
}

fn along(expression: &Expr, direction: &Direction) -> Expr {
    let parts = direction
        .iter()
        .map(|(symbol, rate)| &expression.derivative(symbol) * rate);
    parts.fold(Expr::default(), |sum, part| &sum + &part)
}

/// Tangents of the domain: parameters that have more than one value and do not move the manifold, free scalars, rotations of the others two by two. Where the spec
/// declares relations there are tangents for one of them, of real coordinates.
fn tangents(joint: &Prepared) -> Vec<Direction> {
    let single = |symbol: &Symbol| vec![(symbol.clone(), Expr::integer(1))];
    let manifold = &joint.space.manifold;
    let moves_manifold = |symbol: &Symbol| {
        let mut relations = manifold.declared().iter();
        relations.any(|relation| relation.contains(symbol))
    };
    let free = |p: &&Parameter| !p.range.is_one_number() && !moves_manifold(&p.symbol);
    let ranges = joint.spec.parameters.iter().filter(free);
    let mut tangents: Vec<Direction> = ranges.map(|p| single(&p.symbol)).collect();
    match manifold.declared() {
        [] => manifold.factors().iter().for_each(|factor| {
            let free = factor
                .coordinates
                .iter()
                .filter(|symbol| factor.is_free(symbol));
            tangents.extend(free.map(single));
            tangents.extend(rotations(factor));
        }),
        [relation] => tangents.extend(along_relation(relation, manifold.factors())),
        _ => {}
    }
    tangents
}

/// Two scalars of a unit vector, or two columns of a rotation matrix, turned into each other.
fn rotations(factor: &Factor) -> Vec<Direction> {
    let (rows, columns, turned) = match factor.kind {
        Kind::Real(_) => return vec![],
        Kind::S1 | Kind::S2 | Kind::S3 => (1, factor.coordinates.len(), factor.coordinates.len()),
        Kind::So2 => (2, 2, 2),
        Kind::Se2 => (2, 3, 2),
        Kind::So3 => (3, 3, 3),
        Kind::Se3 => (3, 4, 3),
    };
    let turn = |(a, b): (usize, usize)| -> Direction {
        let in_row = |row: usize| {
            let of = |column: usize| factor.coordinates.get(row * columns + column);
            let (first, second) = (of(a)?, of(b)?);
            Some([
                (first.clone(), Expr::symbol(second)),
                (second.clone(), -Expr::symbol(first)),
            ])
        };
        (0..rows).filter_map(in_row).flatten().collect()
    };
    pairs(turned).map(turn).collect()
}

/// For each two real coordinates, the direction in their plane along which the relation does not change.
fn along_relation(relation: &Expr, factors: &[Factor]) -> Vec<Direction> {
    let real = factors.iter().flat_map(|factor| {
        let free = factor
            .coordinates
            .iter()
            .filter(|symbol| factor.is_free(symbol));
        free.cloned()
    });
    let real: Vec<Symbol> = real.collect();
    let direction = |(a, b): (usize, usize)| {
        let slope = |place: usize| relation.derivative(&real[place]);
        vec![(real[a].clone(), slope(b)), (real[b].clone(), -slope(a))]
    };
    pairs(real.len()).map(direction).collect()
}

fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |a| (a + 1..count).map(move |b| (a, b)))
}
