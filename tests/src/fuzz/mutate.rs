//! Mutations: of bytes, of words, and of whole statements and bracketed parts.

use super::corpus::{Corpus, groups, words};
use chacha20::ChaCha8Rng;
use rand::{RngExt, SeedableRng};

/// Most mutations of one input.
const DEEPEST: usize = 6;
/// Tries for an input that the reader accepts.
const TRIES: u64 = 2000;

/// What the corpus does not hold, and readers stumble over.
const STRANGE: [&str; 16] = [
    "\0",
    "\u{feff}",
    "🦀",
    "é",
    "ϕ",
    "S\u{304}",
    "'",
    "\"",
    "r#\"",
    "//",
    "/*",
    "*/",
    "1e999",
    "0x1",
    "18446744073709551616",
    "..=",
];

/// Makes inputs from a corpus.
#[derive(Clone, Debug)]
pub struct Mutator {
    corpus: Corpus,
}

impl Mutator {
    /// A maker of inputs.
    pub fn new(corpus: Corpus) -> Self {
        Self { corpus }
    }

    /// Input number `seed`.
    pub fn input(&self, seed: u64) -> String {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let start = random.random_range(0..self.corpus.texts.len());
        let count = random.random_range(1..=DEEPEST);
        let text = self.corpus.texts[start].clone();
        (0..count).fold(text, |text, _| self.mutated(&text, &mut random))
    }

    /// Input number `seed` for what lies behind the reader: one that it accepts, by few mutations of a right spec.
    pub fn accepted(&self, seed: u64) -> Option<String> {
        let first = seed.wrapping_mul(TRIES);
        (first..first.wrapping_add(TRIES)).find_map(|number| {
            let mut random = ChaCha8Rng::seed_from_u64(number ^ 0x5eed);
            let start = match random.random_bool(0.3) {
                true => crate::specs::random(number),
                false => self.corpus.texts[random.random_range(0..self.corpus.texts.len())].clone(),
            };
            let count = random.random_range(1..=3);
            let text = (0..count).fold(start, |text, _| self.rephrased(&text, &mut random));
            hamel_codegen::spec::parse(&text, "input.joint")
                .is_ok()
                .then_some(text)
        })
    }

    fn mutated(&self, text: &str, random: &mut ChaCha8Rng) -> String {
        match random.random_range(0..3) {
            0 => bytes(text, random),
            _ => self.rephrased(text, random),
        }
    }

    fn rephrased(&self, text: &str, random: &mut ChaCha8Rng) -> String {
        match random.random_range(0..5) {
            0..=1 => self.word(text, random),
            2 => self.statement(text, random),
            3 => self.group(text, random),
            _ => number(text, random),
        }
    }

    /// One word deleted, doubled, swapped with another or replaced.
    fn word(&self, text: &str, random: &mut ChaCha8Rng) -> String {
        let mut words = words(text);
        let (at, other) = (
            random.random_range(0..words.len()),
            random.random_range(0..words.len()),
        );
        match random.random_range(0..5) {
            0 => _ = words.remove(at),
            1 => words.insert(at, words[at]),
            2 => words.swap(at, other),
            3 => words[at] = STRANGE[random.random_range(0..STRANGE.len())],
            _ => words[at] = &self.corpus.words[random.random_range(0..self.corpus.words.len())],
        }
        words.concat()
    }

    /// One statement deleted, doubled, swapped or replaced by one of another spec.
    fn statement(&self, text: &str, random: &mut ChaCha8Rng) -> String {
        let mut statements: Vec<&str> = text.split_inclusive(self.corpus.separator).collect();
        if statements.is_empty() {
            return text.to_owned();
        }
        let (at, other) = (
            random.random_range(0..statements.len()),
            random.random_range(0..statements.len()),
        );
        match random.random_range(0..4) {
            0 => _ = statements.remove(at),
            1 => statements.insert(at, statements[at]),
            2 => statements.swap(at, other),
            _ => {
                statements[at] =
                    &self.corpus.statements[random.random_range(0..self.corpus.statements.len())]
            }
        }
        statements.concat()
    }

    /// One bracketed part replaced by another, of the same spec or of any.
    fn group(&self, text: &str, random: &mut ChaCha8Rng) -> String {
        let own = groups(text);
        if own.is_empty() {
            return text.to_owned();
        }
        let old = own[random.random_range(0..own.len())];
        let new = match random.random_bool(0.5) {
            true => own[random.random_range(0..own.len())],
            false => &self.corpus.groups[random.random_range(0..self.corpus.groups.len())],
        };
        text.replacen(old, new, 1)
    }
}

/// One number replaced by another.
fn number(text: &str, random: &mut ChaCha8Rng) -> String {
    const NUMBERS: [&str; 8] = ["0", "1", "2", "-1", "0.5", "12", "1e-3", "1000000007"];
    let mut words = words(text);
    let places: Vec<usize> = (0..words.len())
        .filter(|&i| words[i].starts_with(|c: char| c.is_ascii_digit()))
        .collect();
    if let Some(&at) = places.get(random.random_range(0..places.len().max(1))) {
        words[at] = NUMBERS[random.random_range(0..NUMBERS.len())];
    }
    words.concat()
}

/// A few bytes flipped, inserted, deleted or copied.
fn bytes(text: &str, random: &mut ChaCha8Rng) -> String {
    let mut bytes = text.as_bytes().to_vec();
    let at = random.random_range(0..=bytes.len());
    let end = (at + random.random_range(1..24)).min(bytes.len());
    match random.random_range(0..4) {
        0 if at < bytes.len() => bytes[at] ^= 1 << random.random_range(0..8),
        1 => bytes.insert(at, random.random()),
        2 => _ = bytes.drain(at..end),
        _ => {
            let copy = bytes[at..end].to_vec();
            let to = random.random_range(0..=bytes.len());
            _ = bytes.splice(to..to, copy);
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
