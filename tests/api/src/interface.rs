//! Which crates are listed, and what of them.

use public_api::{Builder, PublicItem};
use std::collections::{BTreeSet, HashSet};
use std::error::Error;
use std::path::Path;

/// What a crate offers to users.
pub struct Interface {
    /// Of the crate, as Rust writes it.
    pub name: &'static str,
    /// Names in the crate's root that users are meant to name; without any, all of the crate.
    only: &'static [&'static str],
}

const fn all(name: &'static str) -> Interface {
    Interface { name, only: &[] }
}

/// The crates that users depend on, and those that they reach through `hamel`. Of the generators, what build scripts call.
pub const CRATES: &[Interface] = &[
    all("hamel"),
    all("hamel_runtime"),
    all("hamel_integrate"),
    all("hamel_control"),
    all("hamel_compiled"),
    all("hamel_scene"),
    all("hamel_interpreted"),
    all("hamel_joints"),
    all("hamel_sweep"),
    all("hamel_lanes"),
    Interface {
        name: "hamel_compiler",
        only: &[
            "Build",
            "Error",
            "Language",
            "Module",
            "Refused",
            "functions::Kind",
            "scene",
            "scene_of",
        ],
    },
    Interface {
        name: "hamel_codegen",
        only: &["Build", "BuildError", "GENERATE_VARIABLE"],
    },
];

impl Interface {
    /// A line for each item, sorted. Which traits a type implements is listed, their items are not, as the trait lists them; nor are implementations for all types
    /// and those that the compiler adds.
    pub fn lines(&self, folder: &Path) -> Result<Vec<String>, Box<dyn Error>> {
        let path = folder.join(format!("{}.json", self.name));
        let builder = Builder::from_rustdoc_json(&path)
            .omit_blanket_impls(true)
            .omit_auto_trait_impls(true);
        let found = builder
            .build()
            .map_err(|error| format!("{}: {error}", path.display()))?;
        let implementations = found.items().filter(|item| is_of_trait(item));
        let implementations: HashSet<_> = implementations.map(PublicItem::id).collect();
        let own = found.items().filter(|item| {
            item.parent_id()
                .is_none_or(|parent| !implementations.contains(&parent))
        });
        let lines: BTreeSet<String> = own.map(ToString::to_string).collect();
        let lines = lines.into_iter().filter(|line| {
            // What `derive(PartialEq)` adds besides.
            self.lists(line) && !line.contains("core::marker::StructuralPartialEq")
        });
        Ok(lines.collect())
    }

    /// Whether a line is of something that users are meant to name: its first name of this crate, or in an implementation any.
    fn lists(&self, line: &str) -> bool {
        let start = format!("{}::", self.name);
        let names = line.match_indices(&start);
        let rests = names.map(|(at, found)| &line[at + found.len()..]);
        let count = if line.starts_with("impl") {
            usize::MAX
        } else {
            1
        };
        let mut rests = rests.take(count);
        self.only.is_empty() || rests.any(|rest| self.only.iter().any(|known| begins(rest, known)))
    }
}

/// Whether a path begins with these names, the last of them whole.
fn begins(path: &str, names: &str) -> bool {
    let rest = path.strip_prefix(names);
    rest.is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '_'))
}

/// Whether an item is the head of an implementation of a trait.
fn is_of_trait(item: &PublicItem) -> bool {
    let line = item.to_string();
    let is_implementation = line.starts_with("impl") || line.starts_with("unsafe impl");
    is_implementation && line.contains(" for ")
}
