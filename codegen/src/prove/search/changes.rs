//! Identities by their derivatives: a residual that is 0 everywhere changes nowhere. What cancels in a residual is often gone from its
//! derivative by algebra, and then an error shows at any point, however small it is there.

use super::place::Place;
use super::{MOST_TERMS, Open, Search};
use crate::expr::{Expr, Symbol};
use crate::manifold::Kind;
use crate::model::JointSpec;
use std::cell::Cell;

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
        let directions = free_directions(self.identities.spec);
        let of_all = self.open.iter().flat_map(|(_, residual)| {
            directions
                .iter()
                .map(|direction| along(residual, direction))
        });
        let with_normal = of_all.map(|slope| {
            let normal = self.identities.ideal.normal_form(&slope);
            (slope, normal)
        });
        with_normal
            .filter(|(_, normal)| !normal.is_zero())
            .collect()
    }
}

fn along(expression: &Expr, direction: &Direction) -> Expr {
    let parts = direction
        .iter()
        .map(|(symbol, rate)| &expression.derivative(symbol) * rate);
    parts.fold(Expr::default(), |sum, part| &sum + &part)
}

/// Ways in which one scalar or angle can change while all else stays: parameters that have more than one value, real coordinates,
/// displacements, and unit complex numbers. None of a manifold with declared relations.
fn free_directions(spec: &JointSpec) -> Vec<Direction> {
    let single = |symbol: &Symbol| vec![(symbol.clone(), Expr::integer(1))];
    let ranges = spec.parameters.iter().filter(|p| !p.range.is_one_number());
    let mut directions: Vec<Direction> = ranges.map(|p| single(&p.symbol)).collect();
    let manifold = &spec.manifold.value;
    if !manifold.declared().is_empty() {
        return directions;
    }
    for factor in manifold.factors() {
        match (factor.kind, factor.coordinates.as_slice()) {
            (Kind::S1, [c, s]) => directions.push(vec![
                (c.clone(), -Expr::symbol(s)),
                (s.clone(), Expr::symbol(c)),
            ]),
            (_, symbols) => {
                let free = symbols.iter().filter(|symbol| factor.is_free(symbol));
                directions.extend(free.map(single));
            }
        }
    }
    directions
}
