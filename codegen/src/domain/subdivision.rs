//! Positive by subdivision: an expression of a few bounded variables is positive where enclosures on the cells of a partition all
//! lie above 0.
//!
//! Variables are parameters with two ends, scalars of at most 1, and angles of which sine and cosine alone occur: these two are
//! then functions of one variable, so that c² + s² = 1 is not lost. Anything else is left unbounded, which an enclosure bears
//! only where it does not matter.

use crate::expr::{Atom, Expr, Function, Monomial, Rational, Role, Symbol, budget};
use crate::precise::{Enclosure, Interval, Precise};
use std::collections::{BTreeMap, BTreeSet};

const BITS: usize = 64;
/// Most cells that are looked at.
const MOST_CELLS: usize = 2048;
/// Most halvings of each variable: a cell that is smaller holds a zero that is touched, or something like it.
const DEEPEST: usize = 24;
/// Most variables that are subdivided: cells grow with their power.
const MOST_VARIABLES: usize = 3;
/// What a cell costs in term operations, beside that of each term.
const COST: (u64, u64) = (20, 10);

/// A variable with its ends.
type Axis = (Symbol, Interval);

/// Whether the expression is positive wherever its variables lie in the ranges given; `circles` are the scalars (c, s) of unit
/// complex numbers.
pub fn is_positive(
    expression: &Expr,
    ranges: &BTreeMap<Symbol, Interval>,
    circles: &[(Symbol, Symbol)],
) -> bool {
    let expression = by_angles(expression, circles);
    let (expression, turning) = free_angles(&expression, ranges);
    let symbols = expression.symbols();
    let axes: Vec<Axis> = symbols
        .iter()
        .filter_map(|symbol| {
            let full_turn = turning.contains(symbol).then(full_turn);
            let range = full_turn.or_else(|| ranges.get(symbol).cloned())?;
            Some((symbol.clone(), range))
        })
        .collect();
    axes.len() == symbols.len()
        && !axes.is_empty()
        && axes.len() <= MOST_VARIABLES
        && covers(&expression, axes)
}

fn covers(expression: &Expr, axes: Vec<Axis>) -> bool {
    let cost = COST.0 + COST.1 * expression.terms().len() as u64;
    let deepest = DEEPEST * axes.len();
    let mut open = vec![(axes, 0)];
    let mut enclosure = Enclosure::new(BITS);
    let mut seen = 0;
    while let Some((cell, depth)) = open.pop() {
        seen += 1;
        if seen > MOST_CELLS || depth > deepest || !budget::spend(cost) {
            return false;
        }
        cell.iter()
            .for_each(|(symbol, range)| enclosure.bind(symbol, range.clone()));
        if enclosure.of(expression).is_positive() {
            continue;
        }
        // A middle where it is not positive settles the matter.
        for (symbol, range) in &cell {
            enclosure.bind(symbol, Interval::point(range.middle()));
        }
        if !enclosure.of(expression).is_positive() {
            return false;
        }
        open.extend(halves(cell).map(|half| (half, depth + 1)));
    }
    true
}

/// The cell cut across its longest side.
fn halves(cell: Vec<Axis>) -> [Vec<Axis>; 2] {
    let width = |(_, range): &Axis| (range.high() - range.low()).to_f64();
    let longest = (0..cell.len()).max_by(|a, b| width(&cell[*a]).total_cmp(&width(&cell[*b])));
    let place = longest.unwrap_or(0);
    let range = cell[place].1.clone();
    let middle = range.middle();
    let with = |part: Interval| {
        let mut half = cell.clone();
        half[place].1 = part;
        half
    };
    [
        with(Interval::between(range.low().clone(), middle.clone())),
        with(Interval::between(middle, range.high().clone())),
    ]
}

/// A little more than a full turn.
fn full_turn() -> Interval {
    let end = Precise::from_f64(3.2, BITS);
    Interval::between(-&end, end)
}

/// The scalars of unit complex numbers as cosine and sine of an angle.
fn by_angles(expression: &Expr, circles: &[(Symbol, Symbol)]) -> Expr {
    let symbols = expression.symbols();
    let values = circles
        .iter()
        .filter(|(c, s)| symbols.contains(c) || symbols.contains(s))
        .flat_map(|(c, s)| {
            let angle = Expr::symbol(&Symbol::new(Role::Coordinate, c.index.into(), "angle"));
            [(c.clone(), angle.cos()), (s.clone(), angle.sin())]
        });
    expression.substitute(&values.collect())
}

/// The expression with a symbol for each monomial that occurs as an angle alone and has no range, so that a turn is its range; and those
/// symbols.
fn free_angles(expression: &Expr, ranges: &BTreeMap<Symbol, Interval>) -> (Expr, BTreeSet<Symbol>) {
    let mut turning = BTreeSet::new();
    let mut current = expression.clone();
    for (index, (monomial, part)) in angles(expression).into_iter().enumerate() {
        let held: BTreeSet<Symbol> = Expr::term(1.into(), monomial.clone()).symbols();
        if held.iter().all(|symbol| ranges.contains_key(symbol)) {
            continue;
        }
        let name = format!("turn{index}");
        let symbol = Symbol::new(Role::Constant, index, &name);
        let angle = Expr::term(part.recip(), Monomial::one());
        let replaced = current.atoms().into_iter().filter_map(|atom| {
            let (of, coefficient) = angle_of(&atom)?;
            let turns = &Expr::symbol(&symbol) * &angle;
            let turns = turns.scaled(&coefficient, &Monomial::one());
            let value = match &atom {
                Atom::Apply(application) if application.function == Function::Cos => turns.cos(),
                _ => turns.sin(),
            };
            (of == monomial).then_some((atom, value))
        });
        let values: BTreeMap<Atom, Expr> = replaced.collect();
        let free = current.replace_atoms(&values);
        if !free.contains_any(&held) {
            current = free;
            turning.insert(symbol);
        }
    }
    (current, turning)
}

/// The monomials of which sines and cosines are taken, each with the part of which all its multiples are whole ones.
fn angles(expression: &Expr) -> BTreeMap<Monomial, Rational> {
    let mut found: BTreeMap<Monomial, Rational> = BTreeMap::new();
    for (monomial, coefficient) in expression.atoms().iter().filter_map(angle_of) {
        let part = coefficient.abs();
        let common = match found.get(&monomial) {
            Some(other) => other.common_part(&part),
            None => part,
        };
        found.insert(monomial, common);
    }
    found
}

fn angle_of(atom: &Atom) -> Option<(Monomial, Rational)> {
    let Atom::Apply(application) = atom else {
        return None;
    };
    if !matches!(application.function, Function::Cos | Function::Sin) {
        return None;
    }
    let (monomial, coefficient) = application.arguments.first()?.single_term()?;
    Some((monomial.clone(), coefficient.clone()))
}
