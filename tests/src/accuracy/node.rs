//! Numbers that record what is done with them, so that a definition is read once and then evaluated at any number of points.

use super::tape::{Op, System, Tape};
use super::{Grid, Tracked};
use hamel_codegen::expr::{Function, Number, Rational};
use std::cell::RefCell;
use std::rc::Rc;

/// A number of a definition: known beforehand, or a place of a tape.
#[derive(Clone, Debug)]
pub enum Node {
    /// The same at every point.
    Known(Tracked),
    /// What stands at a place of the tape when it is run.
    Place(Rc<RefCell<Tape>>, u32),
}

/// The entries of a matrix if all of them are known.
fn known(grid: &Grid<Node>) -> Option<Grid<Tracked>> {
    let entries: Option<Vec<Tracked>> = grid.entries().iter().map(Node::known).collect();
    Some(Grid::of_entries(grid.rows, grid.columns, entries?))
}

impl Node {
    /// A number that is exact as it stands.
    pub fn input(value: f64) -> Self {
        Self::Known(Tracked::input(value))
    }

    /// The value, where it is the same at every point.
    pub fn known(&self) -> Option<Tracked> {
        match self {
            Self::Known(value) => Some(*value),
            Self::Place(..) => None,
        }
    }

    /// Whether this is 0 without any summand at every point.
    pub fn is_nothing(&self) -> bool {
        self.known().is_some_and(|value| value.is_nothing())
    }

    /// `−self`.
    pub fn negative(&self) -> Self {
        match self {
            Self::Known(value) => Self::Known(value.negative()),
            Self::Place(tape, place) => Self::done(tape, Op::Negative(*place)),
        }
    }

    /// The same value with its own size as scale: where it comes from an iteration, the scales of its steps say nothing.
    pub fn anew(&self) -> Self {
        match self {
            Self::Known(value) => Self::Known(Tracked::computed(value.value, 0.0)),
            Self::Place(tape, place) => Self::done(tape, Op::Anew(*place)),
        }
    }

    fn done(tape: &Rc<RefCell<Tape>>, op: Op) -> Self {
        let place = tape.borrow_mut().push(op);
        Self::Place(Rc::clone(tape), place)
    }

    /// The place on the tape, where known numbers are put down.
    pub fn place(&self, tape: &Rc<RefCell<Tape>>) -> u32 {
        match self {
            Self::Known(value) => tape.borrow_mut().constant(*value),
            Self::Place(_, place) => *place,
        }
    }

    fn tape<'a>(numbers: impl IntoIterator<Item = &'a Self>) -> Option<Rc<RefCell<Tape>>> {
        numbers.into_iter().find_map(|number| match number {
            Self::Known(_) => None,
            Self::Place(tape, _) => Some(Rc::clone(tape)),
        })
    }

    fn pair(&self, other: &Self, op: fn(u32, u32) -> Op) -> Option<Self> {
        let tape = Self::tape([self, other])?;
        let op = op(self.place(&tape), other.place(&tape));
        Some(Self::done(&tape, op))
    }

    /// `self · other` where `self` is known to be 1 or −1.
    fn by_unit(&self, other: &Self) -> Option<Self> {
        let unit = self.known().filter(Tracked::is_unit)?;
        Some(match unit.value.is_negative() {
            true => other.negative(),
            false => other.clone(),
        })
    }
}

impl Number for Node {
    fn rational(&self, value: &Rational) -> Self {
        Self::Known(Tracked::input(1.0).rational(value))
    }

    fn plus(&self, other: &Self) -> Self {
        match (self, other) {
            (Self::Known(a), Self::Known(b)) => Self::Known(a.plus(b)),
            _ if self.is_nothing() => other.clone(),
            _ if other.is_nothing() => self.clone(),
            _ => self.pair(other, Op::plus).unwrap_or(Self::input(f64::NAN)),
        }
    }

    fn times(&self, other: &Self) -> Self {
        if let (Self::Known(a), Self::Known(b)) = (self, other) {
            return Self::Known(a.times(b));
        }
        if self.is_nothing() || other.is_nothing() {
            return Self::input(0.0);
        }
        let by_unit = self.by_unit(other).or_else(|| other.by_unit(self));
        by_unit
            .or_else(|| self.pair(other, Op::times))
            .unwrap_or(Self::input(f64::NAN))
    }

    fn over(&self, other: &Self) -> Self {
        match (self, other) {
            (Self::Known(a), Self::Known(b)) => Self::Known(a.over(b)),
            _ => self.pair(other, Op::Over).unwrap_or(Self::input(f64::NAN)),
        }
    }

    fn function(&self, function: Function, arguments: &[Self]) -> Self {
        let known: Option<Vec<Tracked>> = arguments.iter().map(Self::known).collect();
        if let Some(known) = known {
            return Self::Known(Tracked::input(1.0).function(function, &known));
        }
        match arguments {
            [Self::Place(tape, place)] => Self::done(tape, Op::Apply(function, *place)),
            [y, x] => y.pair(x, Op::Angle).unwrap_or(Self::input(f64::NAN)),
            _ => Self::input(f64::NAN),
        }
    }
}

/// Systems are solved as a whole: their pivots differ from point to point.
impl Grid<Node> {
    /// The solution of a system as the tape finds it.
    fn solved(inputs: &[&Self], (rows, columns): (usize, usize), system: System) -> Self {
        let numbers = || inputs.iter().flat_map(|grid| grid.entries());
        let Some(tape) = Node::tape(numbers()) else {
            return Self::from_fn(rows, columns, |_, _| Node::input(f64::NAN));
        };
        let places = numbers().map(|number| number.place(&tape)).collect();
        let first = tape.borrow_mut().block(system, places, rows * columns);
        Self::from_fn(rows, columns, |i, j| {
            Node::Place(Rc::clone(&tape), first + (i * columns + j) as u32)
        })
    }

    /// `(AᵀA)⁻¹Aᵀ`.
    pub fn left_inverse(&self) -> Self {
        match known(self) {
            Some(matrix) => matrix.left_inverse().map(|entry| Node::Known(*entry)),
            None => Self::solved(
                &[self],
                (self.columns, self.rows),
                System::LeftInverse(self.rows, self.columns),
            ),
        }
    }

    /// [`Grid::solve_by`] of numbers.
    pub fn solve_by(&self, left: &Self, right: &Self) -> Self {
        match (known(self), known(left), known(right)) {
            (Some(matrix), Some(left), Some(right)) => matrix
                .solve_by(&left, &right)
                .map(|entry| Node::Known(*entry)),
            _ => Self::solved(
                &[self, left, right],
                (self.columns, right.columns),
                System::Solve(self.rows, self.columns, right.columns),
            ),
        }
    }

    /// The inverse of a square matrix.
    pub fn inverse(&self) -> Self {
        let entry = |i: usize, j: usize| Node::input(f64::from(u8::from(i == j)));
        self.solve_by(
            &self.left_inverse(),
            &Self::from_fn(self.rows, self.rows, entry),
        )
    }
}
