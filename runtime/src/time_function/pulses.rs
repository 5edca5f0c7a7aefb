//! Pulses and oscillations of an expression or a cubic table between the times at which a step evaluates it.
//!
//! A method sees a function of time at a few times of a step. What it does between them, values and slopes at both ends of a quarter of the step tell where it is smooth: a
//! cubic polynomial has these. A pulse that is short beside the step is far from that polynomial, as is an oscillation of which the step has more than a period, and no error
//! estimate of the step knows of them. Where the distance is largest is searched by branch and bound: parts of the quarter are halved, that with the largest bound first, by
//! the intervals of all values and slopes that the expression has in each. So a pulse is found however short it is, after some tens of parts. Of a table, the distance is that
//! at its times.

use super::expression::Node;
use super::{Moment, Outside, Table};
use alloc::vec::Vec;

/// Parts that are looked at: where intervals are much wider than what the expression does, the search ends without a pulse.
const MOST_PARTS: usize = 200;

/// Pulses of one step that are looked for.
const MOST_PULSES: usize = 64;

/// Parts of a step that have a polynomial each: as many as the stages that methods under step control have at least.
const QUARTERS: usize = 4;

/// Distances from the polynomials that are no pulse, relative to how far the values at their ends are apart: a sine of 6 rad in a step has this.
const OF_RANGE: f64 = 0.005;

/// Distances that are no pulse, relative to the largest value at these ends.
const OF_VALUE: f64 = 1e-9;

/// The same relative to all values of the expression over the whole motion.
const OF_ALL: f64 = 1e-12;

/// The search ends where no part can have a distance that is so many times as large as the one found.
const NEARLY_LARGEST: f64 = 4.0;

/// Where a function is about farthest from the polynomial, s.
struct Pulse {
    time: f64,
    /// The length of the part in whose middle it was found.
    length: f64,
}

/// A time up to the end of a step such that no pulse of the expression lies before it, and near enough to see one that begins: the end where there is none.
pub(super) fn end_before(node: &Node, step: [f64; 2], motion: [f64; 2]) -> f64 {
    if pulse(node, step, 0.0).is_none() {
        return step[1];
    }
    let all = node.over(motion[0], motion[1]).value;
    let largest = all.high.max(-all.low);
    let negligible = match largest.is_finite() {
        true => OF_ALL * largest,
        false => 0.0,
    };
    shortened(step, |step| pulse(node, step, negligible))
}

/// The same for a cubic table: one that repeats is not followed further than a period.
pub(super) fn end_before_in_table(table: &Table, [from, until]: [f64; 2]) -> f64 {
    let times = table.times();
    let (first, last) = (times[0], times[times.len() - 1]);
    let until = match table.outside() {
        Outside::Repeat => until.min(from + (last - first)),
        Outside::Hold | Outside::Zero => until,
    };
    let values = table.values().iter();
    let negligible = OF_ALL * values.fold(0.0, |most, value| value.abs().max(most));
    shortened([from, until], |step| {
        pulse_of_table(table, step, negligible)
    })
}

/// The end of a step that is cut before each pulse that `find` finds in it.
fn shortened([from, until]: [f64; 2], find: impl Fn([f64; 2]) -> Option<Pulse>) -> f64 {
    let mut end = until;
    for _ in 0..MOST_PULSES {
        let Some(Pulse { time, length }) = find([from, end]) else {
            return end;
        };
        // A step that ends where the pulse may begin; from there on, steps that see it.
        let before = time - length;
        end = match before - from > length {
            true => before,
            false => from + 0.5 * length,
        };
    }
    end
}

/// What a step is compared with: polynomials one after the other.
struct Quarters {
    cubics: Vec<Cubic>,
    /// Distances that are no pulse.
    least: f64,
}

impl Quarters {
    /// From the value and the slope of a function at a moment.
    fn new([from, until]: [f64; 2], negligible: f64, jet: impl Fn(Moment) -> [f64; 2]) -> Self {
        let length = until - from;
        let at = |i: usize| match i {
            QUARTERS => until,
            _ => from + length * i as f64 / QUARTERS as f64,
        };
        let quarters = (0..QUARTERS).map(|i| [at(i), at(i + 1)]);
        let cubics: Vec<Cubic> = quarters.map(|quarter| Cubic::new(quarter, &jet)).collect();
        let ends = cubics.iter().flat_map(|cubic| cubic.ends);
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        });
        Self {
            least: OF_RANGE * (high - low) + OF_VALUE * high.max(-low) + negligible,
            cubics,
        }
    }
}

/// The polynomial with the values and slopes of the expression at both ends of a step.
struct Cubic {
    from: f64,
    length: f64,
    ends: [f64; 2],
    /// Slopes times the length.
    rises: [f64; 2],
}

impl Cubic {
    /// From the value and the slope of a function at a moment.
    fn new([from, until]: [f64; 2], jet: &impl Fn(Moment) -> [f64; 2]) -> Self {
        let within = from + 0.5 * (until - from);
        let [first, last] = [from, until].map(|time| jet(Moment { time, within }));
        let length = until - from;
        Self {
            from,
            length,
            ends: [first[0], last[0]],
            rises: [first[1] * length, last[1] * length],
        }
    }

    /// The value, by Bernstein's form.
    fn at(&self, time: f64) -> f64 {
        let s = (time - self.from) / self.length;
        let r = 1.0 - s;
        let [a, b, c, d] = self.points();
        r * r * (r * a + 3.0 * s * b) + s * s * (3.0 * r * c + s * d)
    }

    /// Its values are within the hull of these.
    fn points(&self) -> [f64; 4] {
        let [a, d] = self.ends;
        [a, a + self.rises[0] / 3.0, d - self.rises[1] / 3.0, d]
    }

    /// The least and the largest slope that it may have.
    fn slopes(&self) -> [f64; 2] {
        let points = self.points();
        let slopes = points
            .windows(2)
            .map(|pair| 3.0 * (pair[1] - pair[0]) / self.length);
        slopes.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], slope| {
            [low.min(slope), high.max(slope)]
        })
    }
}

/// A part of a step.
struct Part {
    from: f64,
    until: f64,
    middle: f64,
    /// How far the expression is from the polynomial in the middle.
    distance: f64,
    /// How far it may be anywhere.
    bound: f64,
}

impl Part {
    fn new(node: &Node, cubic: &Cubic, [from, until]: [f64; 2]) -> Self {
        let half = 0.5 * (until - from);
        let middle = from + half;
        let at = Moment {
            time: middle,
            within: middle,
        };
        let expected = cubic.at(middle);
        let distance = (node.at(at).value - expected).abs();
        let all = node.over(from, until);
        let [least, most] = cubic.slopes();
        let by_slopes = distance + half * (all.slope.high - least).max(most - all.slope.low);
        let reach = half * most.max(-least);
        let by_values = (all.value.high - expected).max(expected - all.value.low) + reach;
        Self {
            from,
            until,
            middle,
            distance,
            bound: by_slopes.min(by_values),
        }
    }
}

/// A pulse of an expression in the first quarter of a step that has one: the largest there.
fn pulse(node: &Node, step: [f64; 2], negligible: f64) -> Option<Pulse> {
    let quarters = Quarters::new(step, negligible, |at| {
        let jet = node.at(at);
        [jet.value, jet.slope]
    });
    let mut cubics = quarters.cubics.iter();
    cubics.find_map(|cubic| pulse_beside(node, cubic, quarters.least))
}

/// The largest distance from a polynomial, if it is more than `least`.
fn pulse_beside(node: &Node, cubic: &Cubic, least: f64) -> Option<Pulse> {
    // Where a root begins, no polynomial has the slope.
    if !cubic.rises.iter().all(|rise| rise.is_finite()) {
        return None;
    }
    let step = [cubic.from, cubic.from + cubic.length];
    // Nothing that is nearer is looked for.
    let mut wanted = least;
    let mut found = None;
    let mut parts: Vec<Part> = [Part::new(node, cubic, step)].into();
    for _ in 0..MOST_PARTS {
        let places = 0..parts.len();
        let farthest = places.max_by(|&a, &b| parts[a].bound.total_cmp(&parts[b].bound));
        let Some(place) = farthest else {
            return found;
        };
        let part = parts.swap_remove(place);
        // Not even the largest bound: the rest is nearer.
        if part.bound <= wanted {
            return found;
        }
        let Part {
            from,
            until,
            middle,
            distance,
            ..
        } = part;
        if middle <= from || middle >= until {
            continue;
        }
        if distance > least && NEARLY_LARGEST * distance > wanted {
            wanted = NEARLY_LARGEST * distance;
            found = Some(Pulse {
                time: middle,
                length: until - from,
            });
        }
        parts.push(Part::new(node, cubic, [from, middle]));
        parts.push(Part::new(node, cubic, [middle, until]));
    }
    found
}

/// The first pulse of a table, at one of its times.
fn pulse_of_table(table: &Table, [from, until]: [f64; 2], negligible: f64) -> Option<Pulse> {
    let quarters = Quarters::new([from, until], negligible, |at| {
        [table.value(at), table.slope(at)]
    });
    let times = table.times();
    let period = times[times.len() - 1] - times[0];
    // A step of a period goes into the next one.
    let periods = match table.outside() {
        Outside::Repeat => 2,
        Outside::Hold | Outside::Zero => 1,
    };
    for next in 0..periods {
        let shift = period * (table.periods(from) + f64::from(next));
        let first = times.partition_point(|time| time + shift <= from).max(1);
        for pair in times[first - 1..].windows(2) {
            let time = pair[1] + shift;
            if time >= until {
                break;
            }
            let part = QUARTERS as f64 * (time - from) / (until - from);
            let cubic = &quarters.cubics[(part as usize).min(QUARTERS - 1)];
            if (table.value(time.into()) - cubic.at(time)).abs() > quarters.least {
                return Some(Pulse {
                    time,
                    length: pair[1] - pair[0],
                });
            }
        }
    }
    None
}
