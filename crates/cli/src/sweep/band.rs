//! The band in which a coordinate or a speed lies over time, drawn for `summary.html`.

use super::summary::short;
use hamel_sweep::summary::Figures;
use std::fmt;
use std::fmt::Write;

/// Size of the drawing, in its own units.
const WIDTH: f64 = 480.0;
const HEIGHT: f64 = 120.0;

/// Draws all values, the middle 90 % and the median of the quantity `name` at instants, s. Nothing where fewer than two instants have values.
pub fn figure(
    f: &mut fmt::Formatter<'_>,
    name: &str,
    mut instants: Vec<(f64, &Figures)>,
) -> fmt::Result {
    instants.retain(|(_, own)| own.count > 0);
    let Some(axes) = Axes::of(&instants) else {
        return Ok(());
    };
    let [from, to] = axes.times.map(short);
    let [least, greatest] = axes.values.map(short);
    writeln!(f, "<figure><figcaption>{name} over time</figcaption>")?;
    write!(
        f,
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"Band of {name} from {from} to {to} s, between {least} and {greatest}\">"
    )?;
    let band = |low: fn(&Figures) -> f64, high: fn(&Figures) -> f64| {
        let there = axes.points(instants.iter(), high);
        let back = axes.points(instants.iter().rev(), low);
        format!("{there}{back}")
    };
    let all = band(|own| own.min, |own| own.max);
    let most = band(|own| own.quantiles[0], |own| own.quantiles[4]);
    let median = axes.points(instants.iter(), |own| own.quantiles[2]);
    write!(f, "<polygon class=\"all\" points=\"{all}\"/>")?;
    write!(f, "<polygon class=\"most\" points=\"{most}\"/>")?;
    writeln!(f, "<polyline points=\"{median}\"/></svg>")?;
    writeln!(
        f,
        "<p>{least} to {greatest}, from {from} to {to} s: all, 5 to 95 %, median</p></figure>"
    )
}

/// What the edges of the drawing stand for.
struct Axes {
    times: [f64; 2],
    values: [f64; 2],
}

impl Axes {
    fn of(instants: &[(f64, &Figures)]) -> Option<Self> {
        let [(from, _), .., (to, _)] = instants else {
            return None;
        };
        let all = instants.iter().map(|(_, own)| own);
        let least = all.clone().map(|own| own.min).fold(f64::INFINITY, f64::min);
        let greatest = all.map(|own| own.max).fold(f64::NEG_INFINITY, f64::max);
        Some(Self {
            times: [*from, *to],
            values: [least, greatest],
        })
    }

    /// Points of a drawing, each with a space behind it.
    fn points<'a>(
        &self,
        instants: impl Iterator<Item = &'a (f64, &'a Figures)>,
        value: fn(&Figures) -> f64,
    ) -> String {
        let mut points = String::new();
        for (time, own) in instants {
            let x = WIDTH * part(*time, self.times);
            let y = HEIGHT * (1.0 - part(value(own), self.values));
            let _ = write!(points, "{x:.1},{y:.1} ");
        }
        points
    }
}

/// Where a number lies between two others, from 0 to 1; in the middle where these are one. Halves, since differences of numbers overflow.
fn part(number: f64, [low, high]: [f64; 2]) -> f64 {
    let width = 0.5 * high - 0.5 * low;
    match width > 0.0 {
        true => (0.5 * number - 0.5 * low) / width,
        false => 0.5,
    }
}
