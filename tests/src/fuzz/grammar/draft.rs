//! A spec in parts, before it is written.

use chacha20::ChaCha8Rng;
use rand::RngExt;
use std::fmt::Write;

/// A random spec.
#[derive(Clone, Debug)]
pub struct Made {
    /// Its text.
    pub text: String,
    /// The name of its joint.
    pub name: String,
    /// What is wrong with it, where something is.
    pub flaw: Option<String>,
    /// Values of the chart of Q at which that shows, by number.
    pub chart: Vec<(usize, f64)>,
    /// Values of parameters that are allowed, and at which that shows.
    pub parameters: Vec<(usize, f64)>,
}

/// What can be made wrong in a draft, with the text that stands for it: `{}` is 0 in a true spec, or 1 for factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// Something is added that must be 0.
    Sum,
    /// Something is multiplied that must not vanish.
    Factor,
}

/// A spec in parts. Statements hold `⊕n` where a sum and `⊗n` where a factor may be put.
#[derive(Clone, Debug)]
pub struct Draft {
    name: String,
    pub parameters: Vec<(String, String)>,
    pub requires: Vec<String>,
    pub statements: Vec<String>,
    /// Real coordinates by their names, with their places in the chart.
    pub reals: Vec<(String, usize)>,
    pub slots: Vec<Slot>,
    pub shown: Vec<(usize, f64)>,
    pub values: Vec<(usize, f64)>,
}

impl Draft {
    pub fn new(name: &str) -> Self {
        Self {
            name: name.into(),
            parameters: vec![],
            requires: vec![],
            statements: vec![],
            reals: vec![],
            slots: vec![],
            shown: vec![],
            values: vec![],
        }
    }

    /// A place where a sum may be put, as text.
    pub fn sum(&mut self) -> String {
        self.slots.push(Slot::Sum);
        format!("⊕{}⊖", self.slots.len() - 1)
    }

    /// A place where a factor may be put, as text.
    pub fn factor(&mut self) -> String {
        self.slots.push(Slot::Factor);
        format!("⊗{}⊖", self.slots.len() - 1)
    }

    pub fn line(&mut self, text: impl Into<String>) {
        self.statements.push(text.into());
    }

    /// A parameter with a range in which it is positive.
    pub fn parameter(&mut self, random: &mut ChaCha8Rng) -> String {
        const RANGES: [(&str, f64); 6] = [
            ("1 > 0", 0.75),
            ("1 >= 1", 1.5),
            ("1 > 0 <= 5", 2.5),
            ("1 in 1..8", 3.5),
            ("1 > 0.5", 0.75),
            ("1 > 0 < 1.5", 0.5),
        ];
        let name = ["a", "b", "c", "d"][self.parameters.len() % 4].to_owned();
        let (range, value) = RANGES[random.random_range(0..RANGES.len())];
        self.values.push((self.parameters.len(), value));
        self.parameters.push((name.clone(), range.into()));
        name
    }

    /// Puts a text into a slot.
    pub fn put(&mut self, slot: usize, text: &str) {
        let (sum, factor) = (format!("⊕{slot}⊖"), format!("⊗{slot}⊖"));
        for statement in &mut self.statements {
            *statement = statement
                .replace(&sum, &format!(" + ({text})"))
                .replace(&factor, &format!(" * ({text})"));
        }
    }

    /// The text of the spec, open slots left out.
    pub fn finish(mut self, flaw: Option<String>) -> Made {
        for slot in 0..self.slots.len() {
            for mark in ["⊕", "⊗"] {
                let mark = format!("{mark}{slot}⊖");
                self.statements
                    .iter_mut()
                    .for_each(|s| *s = s.replace(&mark, ""));
            }
        }
        let body: String = self.statements.concat();
        let used = |name: &str| {
            body.split(|c: char| !c.is_ascii_alphanumeric() && c != '_')
                .any(|word| word == name)
        };
        let mut text = format!("hamel = 1;\n\njoint {}", self.name);
        let mut places = vec![];
        let parameters: Vec<String> = self
            .parameters
            .iter()
            .enumerate()
            .filter(|(_, (name, _))| used(name))
            .map(|(n, (name, range))| {
                places.push(n);
                format!("{name}: {range}")
            })
            .collect();
        if !parameters.is_empty() {
            text += &format!("({})", parameters.join(", "));
        }
        text += " {\n";
        // A string takes all that is written.
        for line in self.requires.iter().chain(&self.statements) {
            let _ = writeln!(text, "    {line}");
        }
        text += "}\n";
        let moved = self
            .values
            .iter()
            .filter_map(|(n, value)| Some((places.iter().position(|p| p == n)?, *value)));
        Made {
            text,
            parameters: moved.collect(),
            name: self.name,
            flaw,
            chart: self.shown,
        }
    }
}
