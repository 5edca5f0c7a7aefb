//! Functions of many states side by side, cut into parts: each is a loop over eight states, whose body is straight.
//!
//! Compilers vectorise a loop over states where they see that what it writes is apart from what it reads, which they no longer do where it has more than some 250
//! places in memory. So a long function becomes several loops, one after the other: each keeps in an array of its own what later ones read.

use super::lines::{Formula, Line, Place};
use crate::alike::Read;
use hamel_codegen::formula::names::NameSet;
use rustc_hash::{FxHashMap, FxHashSet};

/// Places in memory of one loop, read and written: LLVM compares at most 250 with each other.
const PLACES: usize = 240;

/// Angles of which one loop takes sines and cosines: three places each.
const ANGLES: usize = 64;

/// A loop over states.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its lines, those that read what earlier parts kept first.
    pub lines: Vec<Line>,
    /// The array in which it keeps what later parts read.
    pub array: String,
    /// The names of what it keeps, in order.
    pub kept: Vec<String>,
    /// Results with their places.
    pub results: Vec<(usize, Formula)>,
}

/// The parts of the lines of a function with its results; where a function is short, it is one.
pub fn parts(lines: &[Line], outputs: &[Formula]) -> Vec<Part> {
    let lines: Vec<Line> = lines.iter().flat_map(in_lanes).collect();
    let outputs: Vec<Formula> = outputs.iter().map(in_lane).collect();
    let cutter = Cutter::new(&lines, &outputs);
    let mut names = NameSet::default();
    cutter.named.keys().for_each(|name| {
        names.claim(name);
    });
    let mut stored = FxHashMap::default();
    let given = cutter.given.chunks(PLACES / 2);
    let mut parts: Vec<Part> = given
        .map(|results| Part {
            lines: vec![],
            array: names.claim("kept"),
            kept: vec![],
            results: results
                .iter()
                .map(|&(place, of)| (place, of.clone()))
                .collect(),
        })
        .collect();
    let mut start = 0;
    while start < lines.len() {
        let end = cutter.end(start);
        let part = cutter.part([start, end], names.claim("kept"), &stored);
        for (place, name) in part.kept.iter().enumerate() {
            let entry = Formula::Lane(part.array.clone(), place);
            stored.insert(name.clone(), entry);
        }
        parts.push(part);
        start = end;
    }
    parts
}

/// What is known of a name.
#[derive(Clone, Copy, Debug, Default)]
struct Named {
    /// The line that defines it.
    defined: usize,
    /// The last line that reads it, or behind which a result does.
    last: usize,
    /// Whether it stands for several numbers, which no array keeps.
    is_several: bool,
}

/// A result with its place.
type Numbered<'a> = (usize, &'a Formula);

/// A function on its way to parts.
struct Cutter<'a> {
    lines: &'a [Line],
    named: FxHashMap<&'a str, Named>,
    /// Names of entries of arrays that are there beforehand.
    entries: FxHashMap<&'a str, &'a Formula>,
    /// For each line the results that come after it.
    results: Vec<Vec<Numbered<'a>>>,
    /// Results that are numbers or arguments.
    given: Vec<Numbered<'a>>,
}

impl<'a> Cutter<'a> {
    fn new(lines: &'a [Line], outputs: &'a [Formula]) -> Self {
        let mut cutter = Self {
            lines,
            named: FxHashMap::default(),
            entries: FxHashMap::default(),
            results: vec![vec![]; lines.len()],
            given: vec![],
        };
        for (number, line) in lines.iter().enumerate() {
            cutter.note(number, line);
        }
        for (place, output) in outputs.iter().enumerate() {
            let mut home = None;
            names_in(output, &mut |name| {
                home = home.max(cutter.named.get(name).map(|named| named.defined));
            });
            match home {
                Some(home) => {
                    names_in(output, &mut |name| cutter.read(name, home));
                    cutter.results[home].push((place, output));
                }
                None => cutter.given.push((place, output)),
            }
        }
        cutter
    }

    fn note(&mut self, number: usize, line: &'a Line) {
        line.each_formula(&mut |formula| {
            if let Formula::Name(name) = formula {
                self.read(name, number);
            }
        });
        if let Line::Value(name, entry @ Formula::Lane(..)) = line {
            self.entries.insert(name, entry);
        }
        let is_several = matches!(line, Line::Value(_, Formula::Several(..)));
        for name in defined_by(line) {
            let named = Named {
                defined: number,
                last: number,
                is_several,
            };
            self.named.insert(name, named);
        }
    }

    fn read(&mut self, name: &str, number: usize) {
        if let Some(named) = self.named.get_mut(name) {
            named.last = named.last.max(number);
        }
    }

    /// Where the part that begins at a line ends: as far away as its places in memory allow.
    fn end(&self, start: usize) -> usize {
        let mut read = FxHashSet::<(&str, usize)>::default();
        let mut outside = FxHashSet::<&str>::default();
        let mut open: Vec<usize> = vec![];
        let mut several = start;
        let mut written = 0;
        let mut best = None;
        for number in start..self.lines.len() {
            let mut visit = |formula: &'a Formula| match formula {
                Formula::Lane(array, place) => {
                    read.insert((array, *place));
                }
                Formula::Name(name) if self.is_outside(name, start) => {
                    outside.insert(name);
                }
                _ => {}
            };
            self.lines[number].each_formula(&mut visit);
            for (_, output) in &self.results[number] {
                output.each(&mut visit);
            }
            written += self.results[number].len();
            for name in defined_by(&self.lines[number]) {
                let named = self.named[name];
                match named.is_several {
                    true => several = several.max(named.last),
                    false if self.entries.contains_key(name) => {}
                    false => open.push(named.last),
                }
            }
            open.retain(|&last| last > number);
            if read.len() + outside.len() + written > PLACES && best.is_some() {
                break;
            }
            let places = read.len() + outside.len() + written + open.len();
            if several <= number && (places <= PLACES || best.is_none()) {
                best = Some(number + 1);
            }
        }
        best.unwrap_or(self.lines.len())
    }

    /// Whether a part that begins at a line finds the name in memory.
    fn is_outside(&self, name: &str, start: usize) -> bool {
        let named = self.named.get(name);
        named.is_some_and(|named| named.defined < start)
    }

    /// The part of these lines; `stored` is what earlier ones kept.
    fn part(
        &self,
        [start, end]: [usize; 2],
        array: String,
        stored: &FxHashMap<String, Formula>,
    ) -> Part {
        let results = &self.results[start..end];
        let results: Vec<Numbered<'_>> = results.iter().flatten().copied().collect();
        let own = &self.lines[start..end];
        let mut lines = vec![];
        let mut bound = FxHashSet::default();
        let mut bind = |name: &str| {
            let entry = || self.entries.get(name).copied().or(stored.get(name));
            let is_read = self.is_outside(name, start) || self.entries.contains_key(name);
            if is_read && bound.insert(name.to_owned()) {
                let entry = entry().cloned();
                lines.extend(entry.map(|entry| Line::Value(name.to_owned(), entry)));
            }
        };
        for line in own {
            line.each_formula(&mut |formula| {
                if let Formula::Name(name) = formula {
                    bind(name);
                }
            });
        }
        for (_, output) in &results {
            names_in(output, &mut bind);
        }
        // Entries are read where they are used, which may be in other parts alone.
        let is_entry = |line: &&Line| matches!(line, Line::Value(_, Formula::Lane(..)));
        lines.extend(own.iter().filter(|line| !is_entry(line)).cloned());
        let kept = own.iter().flat_map(defined_by);
        let kept = kept.filter(|&name| {
            let named = self.named[name];
            named.last >= end && !named.is_several && !self.entries.contains_key(name)
        });
        let results = results.into_iter();
        Part {
            lines,
            array,
            kept: kept.map(str::to_owned).collect(),
            results: results.map(|(place, of)| (place, of.clone())).collect(),
        }
    }
}

/// The names that a line defines.
fn defined_by(line: &Line) -> Vec<&str> {
    match line {
        Line::Value(name, _) => vec![name],
        Line::SinCos(sin, cos, _) => vec![sin, cos],
        Line::SinCosAll(all) => {
            let names = all.iter();
            names.flat_map(|(sin, cos, _)| [&sin[..], cos]).collect()
        }
        _ => vec![],
    }
}

fn names_in(formula: &Formula, visit: &mut impl FnMut(&str)) {
    formula.each(&mut |part| {
        if let Formula::Name(name) = part {
            visit(name);
        }
    });
}

/// The lines with arguments of the lane; sines and cosines of many angles in several lines.
fn in_lanes(line: &Line) -> Vec<Line> {
    match line {
        Line::SinCosAll(all) => {
            let all = all.iter();
            let all = all.map(|(sin, cos, angle)| (sin.clone(), cos.clone(), in_lane(angle)));
            let all: Vec<(String, String, Formula)> = all.collect();
            let groups = all.chunks(ANGLES);
            groups
                .map(|group| Line::SinCosAll(group.to_vec()))
                .collect()
        }
        Line::SinCos(sin, cos, angle) => {
            vec![Line::SinCos(sin.clone(), cos.clone(), in_lane(angle))]
        }
        Line::Value(name, formula) => vec![Line::Value(name.clone(), in_lane(formula))],
        other => vec![other.clone()],
    }
}

/// The formula with arguments of the lane.
pub fn in_lane(formula: &Formula) -> Formula {
    let boxed = |of: &Formula| Box::new(in_lane(of));
    let all = |of: &[Formula]| of.iter().map(in_lane).collect();
    match formula {
        Formula::Input(Read::Argument(argument), Place::Known(place)) => {
            Formula::Lane(argument.name().to_owned(), *place)
        }
        Formula::Sum(terms) => {
            let terms = terms.iter();
            Formula::Sum(terms.map(|(minus, term)| (*minus, in_lane(term))).collect())
        }
        Formula::Product(a, b) => Formula::Product(boxed(a), boxed(b)),
        Formula::Quotient(a, b) => Formula::Quotient(boxed(a), boxed(b)),
        Formula::Negative(of) => Formula::Negative(boxed(of)),
        Formula::Call(function, arguments) => Formula::Call(*function, all(arguments)),
        Formula::Several(function, arguments) => Formula::Several(*function, all(arguments)),
        Formula::Gathered(numbers) => Formula::Gathered(all(numbers)),
        Formula::Part(of, result) => Formula::Part(boxed(of), *result),
        Formula::Number(_)
        | Formula::Column(_)
        | Formula::Input(..)
        | Formula::Lane(..)
        | Formula::Source(..)
        | Formula::Row(..)
        | Formula::Name(_) => formula.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::Argument;
    use hamel_codegen::derived::Primitive;
    use std::collections::HashMap;

    const ENTRIES: usize = 60;

    fn input(place: usize) -> Formula {
        Formula::Input(Read::Argument(Argument::Configuration), Place::Known(place))
    }

    fn name(number: usize) -> Formula {
        Formula::Name(format!("x_{number}"))
    }

    fn product(a: Formula, b: Formula) -> Formula {
        Formula::Product(Box::new(a), Box::new(b))
    }

    /// Each value is made of the one before it, one far before it and an argument.
    fn long(count: usize) -> Vec<Line> {
        let line = |number: usize| {
            let formula = match number {
                0 => product(input(0), input(1)),
                _ => Formula::Sum(vec![
                    (false, product(name(number - 1), input(number % ENTRIES))),
                    (true, name(number / 2)),
                ]),
            };
            Line::Value(format!("x_{number}"), formula)
        };
        (0..count).map(line).collect()
    }

    /// Values of one state.
    #[derive(Default)]
    struct State {
        arrays: HashMap<String, Vec<f64>>,
        names: HashMap<String, f64>,
    }

    impl State {
        fn value(&self, formula: &Formula) -> f64 {
            match formula {
                Formula::Number(number) => *number,
                Formula::Lane(array, place) => self.arrays[array][*place],
                Formula::Name(name) => self.names[name],
                Formula::Product(a, b) => self.value(a) * self.value(b),
                Formula::Sum(terms) => {
                    let terms = terms.iter();
                    terms.fold(0.0, |sum, (minus, term)| match minus {
                        true => sum - self.value(term),
                        false => sum + self.value(term),
                    })
                }
                other => panic!("{other:?}"),
            }
        }

        fn run(&mut self, lines: &[Line]) {
            for line in lines {
                if let Line::Value(name, formula) = line {
                    let value = self.value(formula);
                    self.names.insert(name.clone(), value);
                }
            }
        }
    }

    fn places(part: &Part) -> usize {
        let mut read = FxHashSet::default();
        let mut visit = |formula: &Formula| {
            if let Formula::Lane(array, place) = formula {
                read.insert((array.clone(), *place));
            }
        };
        part.lines
            .iter()
            .for_each(|line| line.each_formula(&mut visit));
        part.results.iter().for_each(|(_, of)| of.each(&mut visit));
        read.len() + part.kept.len() + part.results.len()
    }

    #[test]
    fn parts_compute_what_the_lines_do_in_few_places() {
        let lines = long(3000);
        let results = (0..1500).map(|number| match number % 3 {
            0 => Formula::Number(number as f64),
            1 => input(number % ENTRIES),
            _ => product(name(2 * number), name(number)),
        });
        let results: Vec<Formula> = results.collect();
        let arguments = (0..ENTRIES).map(|i| (0.7 * i as f64).cos());
        let q = HashMap::from([("q".to_owned(), arguments.collect::<Vec<f64>>())]);
        let mut whole = State {
            arrays: q.clone(),
            ..State::default()
        };
        whole.run(&lines.iter().flat_map(in_lanes).collect::<Vec<Line>>());

        let parts = parts(&lines, &results);
        let mut found = vec![None; results.len()];
        let mut arrays = q;
        for part in &parts {
            assert!(places(part) <= PLACES, "{} places", places(part));
            // No name goes from loop to loop.
            let mut state = State {
                arrays,
                ..State::default()
            };
            state.run(&part.lines);
            for (place, result) in &part.results {
                let before = found[*place].replace(state.value(result));
                assert_eq!(before, None, "result {place} is assigned twice");
            }
            let kept = part.kept.iter().map(|name| state.names[name]).collect();
            arrays = state.arrays;
            arrays.insert(part.array.clone(), kept);
        }
        for (found, result) in found.into_iter().zip(&results) {
            assert_eq!(found, Some(whole.value(&in_lane(result))));
        }
    }

    /// C compilers warn of variables that nothing reads.
    #[test]
    fn parts_define_what_they_read_alone() {
        let mut lines = long(3000);
        // As a cosine of the last joint: read at the end, and once more before.
        lines.insert(0, Line::Value("cosine".to_owned(), input(0)));
        let cosine = || Formula::Name("cosine".to_owned());
        lines.insert(
            1500,
            Line::Value("middle".to_owned(), product(cosine(), name(1497))),
        );
        let last = product(cosine(), Formula::Name("middle".to_owned()));
        lines.push(Line::Value("last".to_owned(), product(last, name(2999))));
        let mut results: Vec<Formula> = (0..1500).map(|number| name(2 * number)).collect();
        results.push(Formula::Name("last".to_owned()));
        let parts = parts(&lines, &results);
        assert!(parts.len() > 3, "{}", parts.len());
        for part in &parts {
            let mut read = FxHashSet::default();
            let mut visit = |name: &str| {
                read.insert(name.to_owned());
            };
            for line in &part.lines {
                line.each_formula(&mut |formula| names_in(formula, &mut visit));
            }
            let results = part.results.iter();
            results.for_each(|(_, of)| names_in(of, &mut visit));
            read.extend(part.kept.iter().cloned());
            for name in part.lines.iter().flat_map(defined_by) {
                assert!(read.contains(name), "{name} is not read");
            }
        }
        let defines = |part: &&Part| {
            part.lines
                .iter()
                .flat_map(defined_by)
                .any(|n| n == "cosine")
        };
        assert_eq!(parts.iter().filter(defines).count(), 2);
    }

    #[test]
    fn what_stands_for_several_numbers_is_not_cut() {
        let mut lines = long(400);
        let rotation = (0..9).map(input).collect();
        let several = Formula::Several(Primitive::RotationVector, rotation);
        lines.insert(1, Line::Value("vector".to_owned(), several));
        let part = |result| Formula::Part(Box::new(Formula::Name("vector".to_owned())), result);
        lines.push(Line::Value("last".to_owned(), product(part(2), name(399))));
        let parts = parts(&lines, &[Formula::Name("last".to_owned())]);
        let [only] = &parts[..] else {
            panic!("{} parts", parts.len());
        };
        assert!(only.kept.is_empty(), "{:?}", only.kept);
    }

    #[test]
    fn names_of_arrays_are_free() {
        let lines = vec![
            Line::Value("kept".to_owned(), input(0)),
            Line::Value("x".to_owned(), Formula::Name("kept".to_owned())),
        ];
        let parts = parts(&lines, &[Formula::Name("x".to_owned())]);
        assert_ne!(parts[0].array, "kept");
    }
}
