//! The YAML file of an Extended URDF: which file it is, and that nothing that it says of loops is passed over.

use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::read::Sink;
use crate::scene::read_bytes;
use crate::text;
use std::path::Path;
use yaml_rust2::parser::{Event, Parser};
use yaml_rust2::{Yaml, YamlLoader};

/// The key without which a YAML file is another one.
pub(super) const LOOPS: &str = "closed_loop";

/// All keys that are read.
const KEYS: [&str; 5] = [LOOPS, "type", "name_mot", "joint_name", "joint_type"];

/// Most bytes of such a file: it names joints.
const MOST_BYTES: usize = 1 << 20;

/// Lists in lists that are read: the reader calls itself for each.
const DEEPEST: usize = 100;

/// What a YAML file says of the loops of a robot.
pub(super) struct Supplement {
    /// The document that has `closed_loop`.
    pub(super) said: Yaml,
    /// What messages call the file.
    pub(super) name: String,
}

/// What stands beside the robot in the file `path`; `None` where no YAML file of its name closes loops.
pub(super) fn beside(path: &Path) -> Result<Option<Supplement>, Diagnostics> {
    let files = ["yaml", "yml"].map(|ending| path.with_extension(ending));
    let mut found = Vec::new();
    for file in files.iter().filter(|file| file.is_file() && *file != path) {
        found.extend(read(file)?);
    }
    if let [first, second] = found.as_slice()
        && first.said != second.said
    {
        let why = format!("{} has `{LOOPS}` too: one file says it", first.name);
        return Err(refuse(&second.name, vec![why]));
    }
    Ok(found.into_iter().next())
}

fn refuse(name: &str, reasons: Vec<String>) -> Diagnostics {
    let mut sink = Sink::default();
    for why in reasons {
        sink.push(Diagnostic::without_place(format!("{name}: {why}")));
    }
    sink.refuse(name, "", "the loops of the robot cannot be read")
}

/// What a file says of loops; `None` where it is of another kind.
fn read(file: &Path) -> Result<Option<Supplement>, Diagnostics> {
    let (bytes, name) = read_bytes(file)?;
    let is_named = is_named(&bytes);
    let documents = match documents(bytes) {
        Ok(documents) => documents,
        // What speaks of no loops need not be YAML.
        Err(_) if !is_named => return Ok(None),
        Err(why) => return Err(refuse(&name, vec![why])),
    };
    let mistakes: Vec<String> = documents.iter().flat_map(mistakes).collect();
    if !mistakes.is_empty() {
        return Err(refuse(&name, mistakes));
    }
    let mut own: Vec<Yaml> = documents.into_iter().filter(closes_loops).collect();
    if own.len() > 1 {
        let why = format!(
            "`{LOOPS}` is in {} of its documents: one says it",
            own.len()
        );
        return Err(refuse(&name, vec![why]));
    }
    Ok(own.pop().map(|said| Supplement { said, name }))
}

/// Whether the key is among the bytes, in UTF-8, or in an encoding that puts bytes 0 between.
fn is_named(bytes: &[u8]) -> bool {
    let bytes: Vec<u8> = bytes.iter().copied().filter(|byte| *byte != 0).collect();
    let mut parts = bytes.windows(LOOPS.len());
    parts.any(|part| part == LOOPS.as_bytes())
}

/// The documents of a file, or why it has none.
fn documents(bytes: Vec<u8>) -> Result<Vec<Yaml>, String> {
    if bytes.len() > MOST_BYTES {
        return Err(format!(
            "it has `{LOOPS}`, and is larger than {} MiB",
            MOST_BYTES >> 20
        ));
    }
    if bytes.contains(&0) {
        return Err(String::from(
            "it has bytes 0, as UTF-16 has: it must be UTF-8",
        ));
    }
    let text = text::from_utf8(bytes)?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let loaded = plain(text).and_then(|()| YamlLoader::load_from_str(text).map_err(told));
    loaded.map_err(|why| format!("not valid YAML: {why}"))
}

fn told(error: impl ToString) -> String {
    error.to_string()
}

/// Whether a text has no aliases, each of which is read as a copy of what it stands for, so that copies of copies fill any memory; and no lists
/// that are too deep.
fn plain(text: &str) -> Result<(), String> {
    let mut events = Parser::new_from_str(text);
    let mut depth = 0_usize;
    loop {
        let (event, at) = events.next_token().map_err(told)?;
        let line = at.line();
        match event {
            Event::Alias(_) => return Err(format!("aliases are not read, in line {line}")),
            Event::SequenceStart(..) | Event::MappingStart(..) if depth == DEEPEST => {
                return Err(format!(
                    "more than {DEEPEST} lists in each other, in line {line}"
                ));
            }
            Event::SequenceStart(..) | Event::MappingStart(..) => depth += 1,
            Event::SequenceEnd | Event::MappingEnd => depth -= 1,
            Event::StreamEnd => return Ok(()),
            _ => {}
        }
    }
}

fn closes_loops(document: &Yaml) -> bool {
    !document[LOOPS].is_badvalue()
}

/// What a document says of loops in a place, or by a name, where it is not read. Other files than those of robots may have the same words: what is no list is none of a robot.
fn mistakes(document: &Yaml) -> Vec<String> {
    let mut mistakes = Vec::new();
    for (key, value) in entries(document) {
        match misspelt(key) {
            Some(LOOPS) if value.is_array() => mistakes.push(unknown(key, LOOPS)),
            Some(meant) if meant != LOOPS && closes_loops(document) => {
                mistakes.push(unknown(key, meant));
            }
            _ => {}
        }
        if has_inside(value) {
            mistakes.push(format!(
                "`{LOOPS}` stands inside `{key}`: it must be a key of the whole file"
            ));
        }
    }
    if document.is_array() && has_inside(document) {
        mistakes.push(format!(
            "`{LOOPS}` stands inside a list: it must be a key of the whole file"
        ));
    }
    mistakes
}

fn unknown(key: &str, meant: &str) -> String {
    format!("key `{key}` is not known: did you mean `{meant}`?")
}

/// The keys of a mapping, with what they say.
fn entries(yaml: &Yaml) -> impl Iterator<Item = (&str, &Yaml)> {
    let entries = yaml.as_hash().into_iter().flatten();
    entries.filter_map(|(key, value)| Some((key.as_str()?, value)))
}

/// The key that another one is meant to be: all but a quarter of its letters are the same.
fn misspelt(key: &str) -> Option<&'static str> {
    if KEYS.contains(&key) {
        return None;
    }
    let key = key.to_lowercase();
    let is_meant = |known: &&str| {
        let away = strsim::damerau_levenshtein(&key, known);
        away <= known.len() / 4 || *known == LOOPS && key.contains(LOOPS)
    };
    KEYS.into_iter().find(is_meant)
}

/// Whether a list of loops is somewhere inside.
fn has_inside(yaml: &Yaml) -> bool {
    let mut waiting = vec![yaml];
    while let Some(next) = waiting.pop() {
        if next[LOOPS].is_array() {
            return true;
        }
        waiting.extend(next.as_vec().into_iter().flatten());
        let values = next.as_hash().into_iter().flatten();
        waiting.extend(values.map(|(_, value)| value));
    }
    false
}

#[cfg(test)]
mod tests {
    use super::misspelt;

    #[test]
    fn keys_that_are_nearly_known_are_meant_to_be() {
        for (key, meant) in [
            ("closed_loops", "closed_loop"),
            ("Closed-Loop", "closed_loop"),
            ("closed_loop_frames", "closed_loop"),
            ("types", "type"),
            ("name_mots", "name_mot"),
            ("joint_names", "joint_name"),
        ] {
            assert_eq!(misspelt(key), Some(meant), "{key}");
        }
        for key in ["name", "closing", "time", "joints", "type", "closed_loop"] {
            assert_eq!(misspelt(key), None, "{key}");
        }
    }
}
