//! When the switches of an expression change: `abs`, `step`, `min` and `max`, by the sign of their argument or of the difference of both.
//!
//! The time is halved until a part of it holds no sign change, by the interval of all values that the argument takes, or one at most, by that of
//! its slopes. That finds the first change whatever the argument is, and none is missed.

use super::Moment;
use super::expression::{Function, Node, Operator};
use super::interval::Interval;
use super::jet::Jet;

/// Parts of the time that are looked at before the search is given up: a change takes some tens of them.
const MOST_PARTS: usize = 100_000;

/// Parts that are no longer than this, relative to the times, are not halved.
const SHORTEST: f64 = 4.0 * f64::EPSILON;

/// The first time after `after`, up to `until`, at which a switch in `node` changes; the name of one that cannot be followed.
pub(super) fn first(node: &Node, after: f64, until: f64) -> Result<Option<f64>, &'static str> {
    let inner = match node {
        Node::Number(_) | Node::Time => None,
        Node::Negative(of) | Node::Call(_, of) => first(of, after, until)?,
        Node::Pair(_, a, b) => {
            let earlier = first(a, after, until)?;
            first(b, after, earlier.unwrap_or(until))?.or(earlier)
        }
    };
    let until = inner.unwrap_or(until);
    let own = Switch::of(node).map(|switch| switch.first_change(after, until));
    Ok(own.transpose()?.flatten().or(inner))
}

/// How long a search goes on.
struct Search {
    /// How many more parts are looked at.
    parts: usize,
    /// The length of parts that are not halved, beside [`SHORTEST`], s.
    least: f64,
}

/// What a switch looks at.
struct Switch<'a> {
    name: &'static str,
    first: &'a Node,
    second: Option<&'a Node>,
}

impl<'a> Switch<'a> {
    fn of(node: &'a Node) -> Option<Self> {
        let (name, first, second) = match node {
            Node::Call(Function::Abs, of) => ("abs", of, None),
            Node::Call(Function::Step, of) => ("step", of, None),
            Node::Pair(Operator::Smaller, a, b) => ("min", a, Some(&**b)),
            Node::Pair(Operator::Larger, a, b) => ("max", a, Some(&**b)),
            _ => return None,
        };
        Some(Self {
            name,
            first,
            second,
        })
    }

    fn over(&self, from: f64, to: f64) -> Jet<Interval> {
        let first = self.first.over(from, to);
        match self.second {
            Some(second) => first.subtract(second.over(from, to)),
            None => first,
        }
    }

    fn value(&self, time: f64) -> f64 {
        let at = Moment::from(time);
        let time = Jet {
            value: at.time,
            slope: 1.0,
            side: at.within,
        };
        let first = self.first.evaluate(time).value;
        self.second
            .map_or(first, |second| first - second.evaluate(time).value)
    }

    /// The first time at which the sign is no longer what it was after `after`.
    fn first_change(&self, after: f64, until: f64) -> Result<Option<f64>, &'static str> {
        let mut search = Search {
            parts: MOST_PARTS,
            least: f64::EPSILON * (until - after),
        };
        self.search(after, until, &mut search)
    }

    fn search(&self, from: f64, to: f64, search: &mut Search) -> Result<Option<f64>, &'static str> {
        if from >= to {
            return Ok(None);
        }
        search.parts = search.parts.checked_sub(1).ok_or(self.name)?;
        let all = self.over(from, to);
        let is_zero = all.value == Interval::number(0.0);
        if is_zero || !all.value.has_zero() {
            return Ok(None);
        }
        let is_monotone = !all.slope.has_zero();
        let is_short = to - from <= search.least.max(SHORTEST * from.abs().max(to.abs()));
        if is_monotone || is_short {
            return Ok(self.change_within(from, to));
        }
        let middle = from + 0.5 * (to - from);
        match self.search(from, middle, search)? {
            Some(found) => Ok(Some(found)),
            None => self.search(middle, to, search),
        }
    }

    /// The one change from one time to another, if there is one, by halving: the first double of the other sign.
    fn change_within(&self, mut from: f64, mut to: f64) -> Option<f64> {
        let (start, end) = (self.value(from), self.value(to));
        let differs = |value: f64| match start > 0.0 {
            true => value <= 0.0,
            false => value >= 0.0,
        };
        // What begins at 0 has changed there, and not here.
        if start == 0.0 || !differs(end) {
            return None;
        }
        loop {
            let middle = from + 0.5 * (to - from);
            if middle <= from || middle >= to {
                return Some(to);
            }
            match differs(self.value(middle)) {
                true => to = middle,
                false => from = middle,
            }
        }
    }
}
