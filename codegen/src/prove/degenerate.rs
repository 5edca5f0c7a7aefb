//! Where a determinant is zero: home and quarter turns from it are tried, by exact arithmetic, so that an error of a rank can name a place.

use crate::domain::{Critical, Domain};
use crate::expr::{Expr, Monomial, Rational, Symbol};
use crate::manifold::{Factor, Kind};
use crate::prepare::Prepared;
use std::collections::{BTreeMap, BTreeSet};

/// Most places that are tried.
const MOST_PLACES: usize = 256;

type Place = BTreeMap<Symbol, Expr>;

/// A place in the domain at which the function is zero for all values of the parameters, in the spec's words: `bend = 0, swing = pi/2`.
pub fn zero(function: &Expr, joint: &Prepared, domain: &Domain<'_>) -> Option<String> {
    let held = function.symbols();
    let found = places(joint, &held).into_iter().find(|place| {
        is_regular(function, place, domain)
            && domain.ideal().vanishes(&function.substitute(place))
            && in_domain(joint, place, domain)
    })?;
    let values = found.iter().filter(|(symbol, _)| held.contains(symbol));
    let texts: Vec<String> = values
        .map(|(symbol, value)| format!("{} = {value}", symbol.spelling()))
        .collect();
    (!texts.is_empty()).then(|| texts.join(", "))
}

/// Whether the function is zero at home, where home is given and the function has a value there.
pub fn is_at_home(function: &Expr, joint: &Prepared, domain: &Domain<'_>) -> bool {
    let home = joint.space.home_values();
    !home.is_empty()
        && is_regular(function, &home, domain)
        && domain.ideal().vanishes(&function.substitute(&home))
}

/// Home, and what is reached from it by quarter turns of the real and unit complex scalars on which the function depends.
fn places(joint: &Prepared, held: &BTreeSet<Symbol>) -> Vec<Place> {
    let home = joint.space.home_values();
    let mut places = vec![home.clone()];
    if !joint.space.manifold.declared().is_empty() {
        return places;
    }
    for factor in joint.space.manifold.factors() {
        for choices in choices(factor, &home, held) {
            let with = |values: &Vec<(Symbol, Expr)>| {
                let place = |known: &Place| {
                    let mut place = known.clone();
                    place.extend(values.iter().cloned());
                    place
                };
                places.iter().map(place).collect::<Vec<Place>>()
            };
            let more: Vec<Place> = choices.iter().flat_map(with).collect();
            if more.len() <= MOST_PLACES {
                places = more;
            }
        }
    }
    places
}

/// For each scalar, or pair of scalars, of a factor that is varied: the values tried, that of home first.
fn choices(
    factor: &Factor,
    home: &Place,
    held: &BTreeSet<Symbol>,
) -> Vec<Vec<Vec<(Symbol, Expr)>>> {
    let of_home = |symbol: &Symbol| home.get(symbol).cloned().unwrap_or_default();
    match (factor.kind, factor.coordinates.as_slice()) {
        (Kind::Real(_), symbols) => {
            let turns = |symbol: &Symbol| {
                let quarter =
                    Expr::pi().scaled(&Rational::new(1.into(), 2.into()), &Monomial::one());
                let turned = [0, 1, 2, -1].map(|n: i64| {
                    let turn = &Expr::rational(n.into()) * &quarter;
                    vec![(symbol.clone(), &of_home(symbol) + &turn)]
                });
                turned.to_vec()
            };
            let varied = symbols.iter().filter(|symbol| held.contains(symbol));
            varied.map(turns).collect()
        }
        (Kind::S1, [c, s]) if held.contains(c) || held.contains(s) => {
            let (of_c, of_s) = (of_home(c), of_home(s));
            let turned = [
                (of_c.clone(), of_s.clone()),
                (-&of_s, of_c.clone()),
                (-&of_c, -&of_s),
                (of_s, -&of_c),
            ];
            let pair = |(x, y): (Expr, Expr)| vec![(c.clone(), x), (s.clone(), y)];
            vec![turned.into_iter().map(pair).collect()]
        }
        _ => vec![],
    }
}

/// Whether no function in it, a quotient or a root, has a singular argument there.
fn is_regular(function: &Expr, place: &Place, domain: &Domain<'_>) -> bool {
    let mut singular = BTreeSet::new();
    Critical::collect(function, &[], &mut singular);
    let mut arguments = singular.iter().flat_map(|critical| &critical.arguments);
    arguments.all(|argument| !domain.ideal().vanishes(&argument.substitute(place)))
}

/// Whether the place is shown to be off every declared exception, and on the side of home of roots, logarithms and angles.
fn in_domain(joint: &Prepared, place: &Place, domain: &Domain<'_>) -> bool {
    let off = |function: &Expr| {
        is_regular(function, place, domain) && domain.nonzero(&function.substitute(place)).is_some()
    };
    let beside_home = |side: &Expr| {
        is_regular(side, place, domain) && domain.is_positive(&side.substitute(place))
    };
    let declared = joint.critical();
    joint
        .space
        .loci
        .iter()
        .all(|locus| off(&locus.value.function))
        && domain.sides(&declared).iter().all(beside_home)
}
