//! Where functions of one variable change sign or turn: what a coarse scan brackets, and subdivision then finds to the last digit.
//!
//! A place is found where the function is monotone between neighbouring samples, or has one extremum within three of them, however
//! narrow the feature is that it makes.

/// Steps of a golden section or a bisection: the bracket shrinks by 0.618 or better a step, to less than an ulp of its ends.
const STEPS: usize = 90;
/// Places that are kept of one function: those nearest to 0, and the farthest.
const NEAREST: usize = 6;
const FARTHEST: usize = 2;
/// Halvings of a bracket in search of how wide a feature is.
const HALVINGS: i32 = 60;

/// A place where some function changes sign or turns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Critical {
    /// The place.
    pub at: f64,
    /// How far from it that function has changed by about 1: what an exponential of it, or a quotient by it, sees.
    pub width: f64,
}

/// Samples of all functions, to be called in one go.
pub(super) type Functions<'a> = &'a mut dyn FnMut(f64) -> Vec<f64>;

struct Event {
    column: usize,
    /// Bracket: two samples around a change of sign, three around a turn.
    from: f64,
    to: f64,
    turns: Option<bool>,
    /// By how much the function changes inside the bracket: by more than 1 where it makes something narrower than that.
    change: f64,
}

/// All places along `samples`, which rise; at most `most`.
pub(super) fn critical(samples: &[f64], functions: Functions, most: usize) -> Vec<Critical> {
    let table: Vec<Vec<f64>> = samples.iter().map(|t| functions(*t)).collect();
    let count = table.iter().map(Vec::len).min().unwrap_or(0);
    let mut seen = std::collections::HashSet::new();
    let mut events = vec![];
    for column in 0..count {
        let values: Vec<f64> = table.iter().map(|row| row[column]).collect();
        if seen.insert(values.iter().map(|x| x.abs().to_bits()).collect::<Vec<_>>()) {
            events.extend(events_of(column, samples, &values));
        }
    }
    // What is narrowest beside its samples comes first.
    events.sort_by(|a, b| b.change.total_cmp(&a.change));
    let mut found: Vec<(Critical, [Vec<f64>; 3])> = vec![];
    for event in events {
        if found.len() >= most {
            break;
        }
        if found
            .iter()
            .any(|(place, around)| is_at(&event, place, around))
        {
            continue;
        }
        if let Some(place) = refined(&event, functions) {
            let step = resolution(place.at);
            let around = [-step, 0.0, step].map(|d| functions(place.at + d));
            found.push((place, around));
        }
    }
    found.into_iter().map(|(place, _)| place).collect()
}

fn middle(event: &Event) -> f64 {
    (0.5 * (event.from + event.to)).abs()
}

fn resolution(at: f64) -> f64 {
    1e-7 * at.abs().max(1e-3)
}

/// Changes of sign and turns of one function: the nearest and the farthest.
fn events_of(column: usize, samples: &[f64], values: &[f64]) -> Vec<Event> {
    let mut events = vec![];
    let event = |from: usize, to: usize, turns| Event {
        column,
        from: samples[from],
        to: samples[to],
        turns,
        change: (values[from] - values[from + 1])
            .abs()
            .max((values[to] - values[to - 1]).abs()),
    };
    for i in 1..values.len() {
        let (a, b) = (values[i - 1], values[i]);
        if (a < 0.0) != (b < 0.0) && a.is_finite() && b.is_finite() {
            events.push(event(i - 1, i, None));
        }
        let Some(c) = values.get(i + 1).filter(|c| c.is_finite()) else {
            continue;
        };
        match (b > a, b > *c, b < a, b < *c) {
            (true, true, ..) => events.push(event(i - 1, i + 1, Some(true))),
            (.., true, true) => events.push(event(i - 1, i + 1, Some(false))),
            _ => {}
        }
    }
    events.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
    if events.len() > NEAREST + FARTHEST {
        let last = events.split_off(events.len() - FARTHEST);
        events.truncate(NEAREST);
        events.extend(last);
    }
    events
}

/// Whether the event is the one that was found there.
fn is_at(event: &Event, place: &Critical, around: &[Vec<f64>; 3]) -> bool {
    if place.at < event.from || place.at > event.to {
        return false;
    }
    let [a, b, c] = around
        .each_ref()
        .map(|values| values.get(event.column).copied().unwrap_or(f64::NAN));
    match event.turns {
        None => (a < 0.0) != (c < 0.0),
        Some(true) => b >= a && b >= c,
        Some(false) => b <= a && b <= c,
    }
}

fn refined(event: &Event, functions: Functions) -> Option<Critical> {
    let mut value = |t: f64| functions(t).get(event.column).copied().unwrap_or(f64::NAN);
    let at = match event.turns {
        None => bisected(event.from, event.to, &mut value),
        Some(top) => golden(event.from, event.to, top, &mut value),
    };
    let there = value(at);
    if !there.is_finite() {
        return None;
    }
    let reach = (event.to - event.from).max(f64::MIN_POSITIVE);
    let far = |n: i32| reach * f64::powi(0.5, n);
    let (mut wide, mut narrow) = (0, HALVINGS);
    while narrow - wide > 1 {
        let half = (narrow + wide) / 2;
        let change = (value(at + far(half)) - there).abs();
        match change <= 1.0 {
            true => narrow = half,
            false => wide = half,
        }
    }
    Some(Critical {
        at,
        width: far(narrow),
    })
}

fn bisected(mut from: f64, mut to: f64, value: &mut impl FnMut(f64) -> f64) -> f64 {
    let negative = value(from) < 0.0;
    for _ in 0..STEPS {
        let half = 0.5 * (from + to);
        if half <= from || half >= to {
            break;
        }
        match (value(half) < 0.0) == negative {
            true => from = half,
            false => to = half,
        }
    }
    to
}

fn golden(mut from: f64, mut to: f64, top: bool, value: &mut impl FnMut(f64) -> f64) -> f64 {
    const PART: f64 = 0.618_033_988_749_894_9;
    let mut size = |t: f64| if top { -value(t) } else { value(t) };
    let (mut a, mut b) = (to - PART * (to - from), from + PART * (to - from));
    let (mut at_a, mut at_b) = (size(a), size(b));
    for _ in 0..STEPS {
        if a >= b {
            break;
        }
        if at_a <= at_b {
            (to, b, at_b) = (b, a, at_a);
            a = to - PART * (to - from);
            at_a = size(a);
        } else {
            (from, a, at_a) = (a, b, at_b);
            b = from + PART * (to - from);
            at_b = size(b);
        }
    }
    if at_a <= at_b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::critical;

    fn samples() -> Vec<f64> {
        (-32..=32).map(|i| f64::from(i) * 0.25).collect()
    }

    /// The argument of exp(−1e20 (q − 5.1)²), a step at 1e-9, and a Lorentz line 1e-8 wide at −3.3: none is sampled.
    #[test]
    fn features_far_narrower_than_the_samples_are_found() {
        let mut functions = |t: f64| {
            vec![
                -1e20 * (t - 5.1) * (t - 5.1),
                t - 1e-9,
                1.0 + 1e16 * (t + 3.3) * (t + 3.3),
            ]
        };
        let found = critical(&samples(), &mut functions, 10);
        for (place, width) in [(5.1, 1e-10), (1e-9, 1.0), (-3.3, 1e-8)] {
            let met = found.iter().any(|c| {
                (c.at - place).abs() <= 1e-12 * f64::max(1.0, place.abs())
                    && c.width <= width
                    && c.width >= 0.1 * width
            });
            assert!(met, "{place}: {found:?}");
        }
    }

    #[test]
    fn flat_and_undefined_functions_have_no_places() {
        let mut functions = |t: f64| vec![2.0, f64::NAN, t.sqrt()];
        assert!(critical(&samples(), &mut functions, 10).is_empty());
    }
}
