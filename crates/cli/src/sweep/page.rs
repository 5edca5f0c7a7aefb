//! `summary.html`: bands of the samples over time and a histogram of each result, in one file that needs no other.

use super::band;
use super::summary::short;
use hamel_console::files::first_line;
use hamel_sweep::summary::Figures;
use std::fmt;
use std::fs::File;
use std::ops::Range;

/// Bars of a histogram.
const BARS: usize = 48;

/// How the page begins, by which it is known.
const FIRST: &str = "<!doctype html><!-- hamel sweep -->";

const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1c2430;--soft:#5d6878;--bar:#3d7cc9;--mid:#d1783f;--back:#fff;--line:#d8dee6}
@media(prefers-color-scheme:dark){:root{--ink:#e4e9f0;--soft:#9aa6b6;--bar:#6ea3e6;--mid:#e59a66;--back:#14181e;--line:#333c48}}
body{font:15px/1.5 system-ui,sans-serif;color:var(--ink);background:var(--back);margin:0 auto;padding:1rem;max-width:75rem}
h1{font-size:1.6rem;overflow-wrap:anywhere}
pre{overflow-x:auto;border:1px solid var(--line);border-radius:6px;padding:.7rem;font-size:12px}
main{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(20rem,100%),1fr));gap:1rem}
figure{margin:0;border:1px solid var(--line);border-radius:6px;padding:.7rem}
figcaption{font-weight:600;overflow-wrap:anywhere}figure p{margin:.2rem 0 0;color:var(--soft);font-size:13px}
svg{width:100%;height:8rem;display:block}rect{fill:var(--bar)}line{stroke:var(--mid);stroke-width:.6}
.all{fill:var(--bar);opacity:.2}.most{fill:var(--bar);opacity:.45}polyline{fill:none;stroke:var(--mid);stroke-width:1.5;vector-effect:non-scaling-stroke}
";

/// Whether a file is such a page.
pub fn is_own(file: &File) -> bool {
    first_line(file) == FIRST
}

/// How many values lie in each of some equal parts between the least and the greatest, of each column.
pub struct Histograms(Vec<Histogram>);

struct Histogram {
    min: f64,
    width: f64,
    counts: [u64; BARS],
}

impl Histograms {
    /// Of the columns with these figures.
    pub fn new(figures: &[Figures]) -> Self {
        let all = figures.iter().map(|own| Histogram {
            min: own.min,
            width: (own.max - own.min) / BARS as f64,
            counts: [0; BARS],
        });
        Self(all.collect())
    }

    /// Takes a row.
    pub fn see(&mut self, row: &[f64]) {
        for (own, value) in self.0.iter_mut().zip(row) {
            let place = (value - own.min) / own.width;
            // A NaN is in none; of values that are all the same none has a place.
            if value.is_finite() && place >= 0.0 {
                own.counts[(place as usize).min(BARS - 1)] += 1;
            }
        }
    }
}

/// The page.
pub struct Page<'a> {
    pub title: &'a str,
    /// As it is printed.
    pub summary: &'a str,
    pub names: &'a [String],
    pub figures: &'a [Figures],
    pub histograms: &'a Histograms,
    /// Times of samples, s.
    pub times: &'a [f64],
    /// Where the names and figures of the last state and of each sample stand.
    pub states: &'a [Range<usize>],
}

impl fmt::Display for Page<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let title = escaped(self.title);
        writeln!(
            f,
            "{FIRST}\n<html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">"
        )?;
        writeln!(
            f,
            "<title>Sweep of {title}</title>\n<style>{STYLE}</style>\n<h1>Sweep of {title}</h1>"
        )?;
        writeln!(f, "<pre>{}</pre>\n<main>", escaped(self.summary))?;
        let (last, samples) = self.states.split_first().unzip();
        let last = last.cloned().unwrap_or(0..0);
        for (place, column) in last.enumerate() {
            let figures = samples.into_iter().flatten();
            let figures = figures.map(|state| &self.figures[state.start + place]);
            let instants = self.times.iter().copied().zip(figures).collect();
            band::figure(f, &escaped(&self.names[column]), instants)?;
        }
        let columns = self.names.iter().zip(self.figures).zip(&self.histograms.0);
        for ((name, figures), histogram) in columns {
            figure(f, name, figures, histogram)?;
        }
        writeln!(f, "</main></html>")
    }
}

fn figure(f: &mut fmt::Formatter<'_>, name: &str, own: &Figures, drawn: &Histogram) -> fmt::Result {
    let name = escaped(name);
    writeln!(f, "<figure><figcaption>{name}</figcaption>")?;
    let most = drawn.counts.iter().max().copied().unwrap_or(0);
    if most > 0 {
        let [low, _, mid, _, high] = own.quantiles.map(short);
        let label = format!("Histogram of {name}: median {mid}, 90 % between {low} and {high}");
        write!(
            f,
            "<svg viewBox=\"0 0 {BARS} 30\" preserveAspectRatio=\"none\" role=\"img\" aria-label=\"{label}\">"
        )?;
        for (place, &count) in drawn
            .counts
            .iter()
            .enumerate()
            .filter(|(_, count)| **count > 0)
        {
            let height = 30.0 * count as f64 / most as f64;
            write!(
                f,
                "<rect x=\"{place}.05\" y=\"{:.2}\" width=\".9\" height=\"{height:.2}\"/>",
                30.0 - height
            )?;
        }
        for quantile in [own.quantiles[0], own.quantiles[2], own.quantiles[4]] {
            let x = (quantile - drawn.min) / drawn.width;
            write!(f, "<line x1=\"{x:.2}\" x2=\"{x:.2}\" y1=\"0\" y2=\"30\"/>")?;
        }
        writeln!(
            f,
            "</svg>\n<p>{} to {}; lines at 5, 50 and 95 %: {low}, {mid}, {high}</p></figure>",
            short(own.min),
            short(own.max)
        )
    } else {
        let all = match own.count {
            0 => "no values".to_owned(),
            count => format!("{} in all {count} rows that have it", short(own.min)),
        };
        writeln!(f, "<p>{all}</p></figure>")
    }
}

fn escaped(text: &str) -> String {
    let text = hamel_scene::text::visible(text);
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
