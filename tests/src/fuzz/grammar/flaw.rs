//! What makes a true spec false: small, far or narrow, and where it shows.

use super::draft::{Draft, Slot};
use super::formulas::{nothing, pick};
use chacha20::ChaCha8Rng;
use rand::RngExt;

/// Makes one place of the draft wrong; nothing where it has none.
pub fn plant(draft: &mut Draft, random: &mut ChaCha8Rng) -> Option<String> {
    if draft.slots.is_empty() {
        return None;
    }
    let slot = random.random_range(0..draft.slots.len());
    let text = match draft.slots[slot] {
        Slot::Sum => error(draft, random),
        Slot::Factor => zero(draft, random),
    };
    draft.put(slot, &text);
    Some(text)
}

fn place(random: &mut ChaCha8Rng) -> f64 {
    [0.0, 1.0, -2.0, 5.0, 9.5, -17.0, 40.0, -64.0, 173.0][random.random_range(0..9)]
}

/// A real coordinate with its place in the chart.
fn coordinate(draft: &Draft, random: &mut ChaCha8Rng) -> Option<(String, usize)> {
    match draft.reals.len() {
        0 => None,
        count => Some(draft.reals[random.random_range(0..count)].clone()),
    }
}

/// Something that is not 0 at the place where the draft is shown.
fn error(draft: &mut Draft, random: &mut ChaCha8Rng) -> String {
    let Some((x, at)) = coordinate(draft, random) else {
        return of_parameter(draft, random);
    };
    let m = place(random);
    let (text, shown) = match random.random_range(0..10) {
        0 => (
            pick(random, &["0.001", "1e-9", "1e-20", "1e-40 * 1e-40"]).to_owned(),
            m,
        ),
        1 => (
            format!("{} * exp({x})", pick(random, &["1e-9", "1e-40 * 1e-40"])),
            173.0,
        ),
        2 | 3 => {
            let sharp = pick(random, &["1e2", "1e4", "1e6", "1e8", "1e12"]);
            (
                format!(
                    "{}exp(-{sharp} * ({x} - {m}) * ({x} - {m}))",
                    pick(random, &["", "0.001 * "])
                ),
                m,
            )
        }
        4 => {
            let sharp = pick(random, &["1e4", "1e8", "1e16"]);
            (
                format!("1e-3 / (1 + {sharp} * ({x} - {m}) * ({x} - {m}))"),
                m,
            )
        }
        5 | 6 => {
            let (g, shown) = [
                (format!("exp({x} - 60) - 1"), 61.0),
                (format!("{x} - 50"), 51.0),
                (format!("tanh({x} - 30)"), 31.0),
                (format!("-40 - {x}"), -41.0),
                (format!("{x} * {x} - 400"), 21.0),
                (format!("sinh({x} - 20)"), 21.0),
            ][random.random_range(0..6)]
            .clone();
            draft.statements.insert(0, format!("except {g} = 0;"));
            (format!("({g}) + sqrt(({g}) * ({g}))"), shown)
        }
        7 => (
            format!("1e-20 * pow({x}, {})", pick(random, &["4", "8", "16"])),
            64.0,
        ),
        8 => (
            format!("sin({x}) * sin({x}) + cos({x}) * cos({x}) - 1 + 1e-12 * sin({x})"),
            1.0,
        ),
        _ => return of_parameter(draft, random),
    };
    draft.shown.push((at, shown));
    text
}

/// An error in one part of a parameter's range.
fn of_parameter(draft: &mut Draft, random: &mut ChaCha8Rng) -> String {
    let n = draft.parameters.len();
    draft.parameters.push(("gain".into(), "1 > 0".into()));
    draft.values.push((n, 1010.0));
    draft
        .requires
        .push("require (gain - 1000) * (gain - 1000) > 1;".into());
    match random.random_range(0..2) {
        0 => "1 + (gain - 1000) / sqrt((gain - 1000) * (gain - 1000))".into(),
        _ => "gain - 1000 + sqrt((gain - 1000) * (gain - 1000))".into(),
    }
}

/// A factor that vanishes at the place where the draft is shown.
fn zero(draft: &mut Draft, random: &mut ChaCha8Rng) -> String {
    let Some((x, at)) = coordinate(draft, random) else {
        return nothing(random, "1");
    };
    let m = place(random);
    let (text, shown) = match random.random_range(0..7) {
        0 => (nothing(random, &x), m),
        1 => (format!("({x} - {m})"), m),
        2 => (format!("({x} - {m}) * ({x} - {m})"), m),
        3 => (format!("(1 - exp(-1e6 * ({x} - {m}) * ({x} - {m})))"), m),
        4 => (format!("({x} * {x} - {})", m * m), m),
        5 => (format!("tanh({x} - {m})"), m),
        _ => {
            let g = format!("{x} - 50");
            draft.statements.insert(0, format!("except {g} = 0;"));
            (format!("(1 - ({g}) / sqrt(({g}) * ({g})))"), 51.0)
        }
    };
    draft.shown.push((at, shown));
    text
}
