//! What came of a sweep: quantiles and failures, printed, as JSON, in tables and on a page.

use super::args::Format;
use super::folder::Folder;
use super::page::{Histograms, Page};
use super::{csv, parquet};
use hamel::shown::Number;
use hamel_console::files::{IsOwn, Output, admit, first_line};
use hamel_console::output::Failure;
use hamel_lanes::Ways;
use hamel_sweep::Sweep;
use hamel_sweep::summary::{Causes, Failures, Figures, QUANTILES, Selection};
use serde_json::{Value, json};
use std::fmt;
use std::fs::File;
use std::io;
use std::ops::Range;
use std::time::Duration;

/// Names of the figures of a column.
const FIGURES: [&str; 9] = [
    "count", "mean", "min", "q05", "q25", "q50", "q75", "q95", "max",
];

/// What is reported of the results that a folder holds.
pub struct Summary {
    folder: String,
    names: Vec<String>,
    figures: Vec<Figures>,
    /// Times of samples, s, and where the names and figures of the last state and of each sample stand.
    times: Vec<f64>,
    states: Vec<Range<usize>>,
    causes: Causes,
    rows: u64,
    /// Rows that this command moved, how long it took, and which way they went.
    moved: (u64, Duration, Ways),
    is_resumed: bool,
    format: Format,
    histograms: Histograms,
}

impl Summary {
    /// Of all results of `sweep` in `folder`.
    ///
    /// # Errors
    /// A part that cannot be read.
    pub fn of(
        folder: &Folder,
        sweep: &Sweep,
        moved: (u64, Duration, Ways),
    ) -> Result<Self, Failure> {
        let names = sweep.results();
        let (mut selection, mut causes) = (Selection::new(names.len()), Causes::default());
        for pass in 0..selection.passes() {
            folder.read(names.len(), &mut |row, outcome, numbers| {
                selection.see(numbers);
                if pass == 0 {
                    causes.see(row, outcome);
                }
            })?;
            selection.narrow();
        }
        let figures = selection.figures();
        let states: Vec<_> = sweep.states().collect();
        let last = states.first().map_or(0, |state| state.end);
        let mut histograms = Histograms::new(&figures[..last]);
        folder.read(names.len(), &mut |_, _, numbers| histograms.see(numbers))?;
        Ok(Self {
            folder: folder.path().display().to_string(),
            names: names.to_vec(),
            times: sweep.times().to_vec(),
            states,
            figures,
            causes,
            rows: folder.manifest.rows,
            moved,
            is_resumed: folder.is_resumed,
            format: folder.format(),
            histograms,
        })
    }

    /// Writes `summary` and `failures` beside the parts, in their format, and the page.
    ///
    /// # Errors
    /// A file that cannot be written; one of these names that others wrote.
    pub fn write(&self, folder: &Folder) -> Result<(), Failure> {
        let ending = self.format.name();
        let own: IsOwn = match self.format {
            Format::Csv => is_own_text,
            Format::Parquet => parquet::is_own,
        };
        let name = |stem: &str| folder.path().join(format!("{stem}.{ending}"));
        let (summary, failures) = (name("summary"), name("failures"));
        let page = folder.path().join("summary.html");
        let written: [(_, IsOwn); 3] = [
            (&*summary, own),
            (&*failures, own),
            (&*page, super::page::is_own),
        ];
        let [summary, failures, page] = &*admit([], written, false)? else {
            return Ok(());
        };
        self.put(
            summary,
            ("column", &self.names),
            &FIGURES.map(|name| (name, self.column(name))),
        )?;
        let causes = self.causes.failures();
        let told: Vec<String> = causes.iter().map(|one| one.cause.clone()).collect();
        let numbers = [
            ("count", causes.iter().map(|one| one.count as f64).collect()),
            ("row", causes.iter().map(|one| one.row as f64).collect()),
        ];
        self.put(failures, ("cause", &told), &numbers)?;
        let drawn = Page {
            title: &folder.manifest.scene.name,
            summary: &self.to_string(),
            names: &self.names,
            figures: &self.figures,
            histograms: &self.histograms,
            times: &self.times,
            states: &self.states,
        };
        page.write(drawn.to_string())
    }

    /// A column of figures by its name.
    fn column(&self, name: &str) -> Vec<f64> {
        let figures = self.figures.iter().map(numbers);
        let place = FIGURES.iter().position(|known| *known == name);
        figures
            .map(|own| place.map_or(f64::NAN, |place| own[place]))
            .collect()
    }

    fn put(
        &self,
        output: &Output,
        texts: (&str, &[String]),
        numbers: &[(&str, Vec<f64>)],
    ) -> Result<(), Failure> {
        let draft = output.open()?;
        let written = match self.format {
            Format::Csv => csv::write_texts(draft, rows(texts, numbers).into_iter()),
            Format::Parquet => parquet::write_small(draft, texts, numbers),
        };
        let written = written.map_err(|error: io::Error| Failure::write(output.path(), error));
        written?.finish()
    }

    /// As `--json` prints it.
    pub fn told(&self) -> Value {
        let finite = |number: f64| number.is_finite().then_some(number);
        let columns = self.names.iter().zip(&self.figures).map(|(name, own)| {
            let quantiles = QUANTILES.iter().zip(own.quantiles);
            let quantiles =
                quantiles.map(|(part, value)| json!({ "part": part, "value": finite(value) }));
            json!({
                "name": name, "count": own.count, "mean": finite(own.mean), "min": finite(own.min),
                "quantiles": quantiles.collect::<Vec<_>>(), "max": finite(own.max),
            })
        });
        let columns: Vec<Value> = columns.collect();
        let causes = |key: &str, list: Vec<Failures>| -> Vec<Value> {
            let told = list.into_iter();
            told.map(|one| json!({ key: one.cause, "count": one.count, "row": one.row }))
                .collect()
        };
        let ways = &self.moved.2;
        let tree = ways.tree.iter();
        let tree = tree.map(|(cause, count)| json!({ "cause": cause, "count": count }));
        let ways = json!({ "lanes": ways.lanes, "tree": tree.collect::<Vec<_>>() });
        json!({
            "folder": self.folder, "equations": ways, "rows": self.rows, "ended": self.causes.ended(),
            "events": causes("name", self.causes.events()),
            "failures": causes("cause", self.causes.failures()),
            "columns": columns, "moved": self.moved.0, "run_time_s": self.moved.1.as_secs_f64(),
        })
    }
}

fn numbers(own: &Figures) -> [f64; 9] {
    let [a, b, c, d, e] = own.quantiles;
    [own.count as f64, own.mean, own.min, a, b, c, d, e, own.max]
}

/// The table as texts, with its header.
fn rows((name, texts): (&str, &[String]), numbers: &[(&str, Vec<f64>)]) -> Vec<Vec<String>> {
    let header = std::iter::once(name).chain(numbers.iter().map(|(name, _)| *name));
    let mut rows = vec![header.map(str::to_owned).collect::<Vec<_>>()];
    for (place, text) in texts.iter().enumerate() {
        let numbers = numbers.iter().map(|(name, column)| match *name {
            "count" | "row" => format!("{:.0}", column[place]),
            _ => format!("{:?}", column[place]),
        });
        rows.push(std::iter::once(text.clone()).chain(numbers).collect());
    }
    rows
}

fn is_own_text(file: &File) -> bool {
    let line = first_line(file);
    line == format!("column,{}", FIGURES.join(",")) || line == "cause,count,row"
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (moved, time, ways) = &self.moved;
        let moved = *moved;
        let failures = self.causes.failures();
        let failed: u64 = failures.iter().map(|one| one.count).sum();
        write!(f, "rows      {}: {} ended", self.rows, self.causes.ended())?;
        for event in self.causes.events() {
            write!(f, ", {} at the event {}", event.count, event.cause)?;
        }
        writeln!(f, ", {failed} failed")?;
        for one in failures {
            writeln!(
                f,
                "          {} failed, row {} the first: {}",
                one.count, one.row, one.cause
            )?;
        }
        let time = time.as_secs_f64();
        match (self.is_resumed, moved) {
            (_, 0) => writeln!(f, "moved     none: all results were there")?,
            (true, _) => writeln!(
                f,
                "moved     {moved} in {time:.1} s, {:.0} a second; the others were there",
                moved as f64 / time
            )?,
            (false, _) => writeln!(
                f,
                "moved     {moved} in {time:.1} s, {:.0} a second",
                moved as f64 / time
            )?,
        }
        told_ways(ways, f)?;
        writeln!(f, "results   {}", self.folder)?;
        if !self.times.is_empty() {
            let (count, ending) = (self.times.len(), self.format.name());
            writeln!(
                f,
                "samples   {count} of each motion: summary.{ending} has their quantiles, summary.html the bands"
            )?;
        }
        let last = self.states.first().map_or(0, |state| state.end);
        let names = &self.names[..last];
        let width = names.iter().map(|name| name.chars().count()).max();
        let width = width.unwrap_or(0);
        write!(f, "\n{:width$}", "")?;
        for name in &FIGURES[1..] {
            write!(f, " {name:>13}")?;
        }
        for (name, own) in names.iter().zip(&self.figures) {
            write!(f, "\n{name:width$}")?;
            for number in &numbers(own)[1..] {
                write!(f, " {:>13}", short(*number))?;
            }
        }
        writeln!(f)
    }
}

/// By which equations rows moved, and why not side by side.
fn told_ways(ways: &Ways, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    if ways.lanes > 0 {
        writeln!(f, "equations {} side by side", ways.lanes)?;
    }
    for (number, (why, count)) in ways.tree.iter().enumerate() {
        let word = if ways.lanes == 0 && number == 0 {
            "equations"
        } else {
            ""
        };
        writeln!(f, "{word:9} {count} one by one, by the tree: {why}")?;
    }
    Ok(())
}

/// Six digits.
pub fn short(number: f64) -> String {
    let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
    Number(rounded).to_string()
}
