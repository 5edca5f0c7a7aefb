//! What inputs are made of: every spec of the repository, right or wrong, and the examples of the language reference.

use std::path::{Path, PathBuf};

/// Texts, their statements and their words.
#[derive(Clone, Debug)]
pub struct Corpus {
    /// Whole specs.
    pub texts: Vec<String>,
    /// What ends a statement.
    pub separator: char,
    /// Statements, with their ends.
    pub statements: Vec<String>,
    /// Bracketed parts of expressions.
    pub groups: Vec<String>,
    /// Words and marks of the language that occur.
    pub words: Vec<String>,
}

const FOLDERS: [&str; 4] = [
    "../joint-specs",
    "corpus/specs-bad",
    "corpus/fuzz",
    "downstream/joints",
];

impl Corpus {
    /// Reads the corpus.
    ///
    /// # Panics
    /// Where a folder of the repository cannot be read.
    pub fn read() -> Self {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut texts: Vec<String> = FOLDERS
            .iter()
            .flat_map(|folder| files(&here.join(folder)))
            .collect();
        texts.extend(examples(&here.join("../joint-specs/README.md")));
        texts.extend((0..16).map(crate::specs::random));
        Self::of(texts, ';')
    }

    /// The corpus of these texts, whose statements end with `separator`.
    pub fn of(texts: Vec<String>, separator: char) -> Self {
        let statements = texts
            .iter()
            .flat_map(|text| text.split_inclusive(separator))
            .map(str::to_owned);
        let words = texts.iter().flat_map(|text| words(text)).map(str::to_owned);
        let groups = texts
            .iter()
            .flat_map(|text| groups(text))
            .map(str::to_owned);
        Self {
            separator,
            statements: distinct(statements),
            groups: distinct(groups),
            words: distinct(words),
            texts,
        }
    }
}

fn distinct(texts: impl Iterator<Item = String>) -> Vec<String> {
    let set: std::collections::BTreeSet<String> = texts.collect();
    set.into_iter().collect()
}

fn files(folder: &Path) -> Vec<String> {
    let entries =
        std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries
        .map(|entry| entry.expect("an entry").path())
        .collect();
    paths.sort();
    let specs = paths
        .iter()
        .filter(|path| path.extension().is_some_and(|e| e == "joint"));
    // Bytes that are no UTF-8 never reach the reader.
    specs
        .map(|path| String::from_utf8_lossy(&std::fs::read(path).expect("a spec")).into_owned())
        .collect()
}

/// The code blocks of a page.
fn examples(page: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(page).expect("the language reference");
    text.split("```joint")
        .skip(1)
        .filter_map(|part| Some(part.split_once('\n')?.1.split("```").next()?.to_owned()))
        .collect()
}

/// Words, numbers, runs of blanks and single marks: together they are the text.
pub fn words(text: &str) -> Vec<&str> {
    let class = |c: char| match c {
        _ if c.is_alphanumeric() || c == '_' => 0,
        _ if c.is_whitespace() => 1,
        _ => 2,
    };
    let mut words = vec![];
    let mut start = 0;
    let mut last = 3;
    for (at, c) in text.char_indices() {
        if at > start && (class(c) != last || last == 2) {
            words.push(&text[start..at]);
            start = at;
        }
        last = class(c);
    }
    words.push(&text[start..]);
    words
}

/// The bracketed parts of a text, brackets included.
pub fn groups(text: &str) -> Vec<&str> {
    let mut open = vec![];
    let mut groups = vec![];
    for (at, c) in text.char_indices() {
        match c {
            '(' | '[' => open.push(at),
            ')' | ']' => groups.extend(open.pop().map(|start| &text[start..=at])),
            _ => {}
        }
    }
    groups
}
