//! The committed library: one file a joint with an index, and one page a joint.

use super::{BuildError, watch};
use crate::derived::Derived;
use crate::emit::files::Files;
use crate::emit::page::page;
use crate::emit::rust::{Index, file, index};
use std::path::Path;

/// Writes the folders, or compares them with what the specs say.
pub(super) fn generate(
    joints: &[(String, Derived)],
    label: &str,
    modules: &Path,
    pages: &Path,
    check: bool,
) -> Result<(), BuildError> {
    let (sources, texts) = (sources(joints, label)?, pages_of(joints)?);
    if !check {
        sources.write(modules)?;
        texts.write(pages)?;
        return Ok(());
    }
    let mut lines = vec![];
    for (files, folder) in [(&sources, modules), (&texts, pages)] {
        // Whoever edits, adds or removes a file must meet this check again.
        watch(folder);
        files
            .texts
            .keys()
            .for_each(|name| watch(&folder.join(name)));
        lines.extend(files.differences(folder)?.lines(&folder.to_string_lossy()));
    }
    match lines.is_empty() {
        true => Ok(()),
        false => Err(BuildError::NotFresh(lines)),
    }
}

fn sources(joints: &[(String, Derived)], label: &str) -> Result<Files, BuildError> {
    let mut files = Files::default();
    for (label, joint) in joints {
        files.insert(format!("{}.rs", joint.spec.name.value), file(joint, label)?);
    }
    let joints: Vec<Derived> = joints.iter().map(|(_, joint)| joint.clone()).collect();
    files.insert("mod.rs", index(&joints, label, Index::Files)?);
    Ok(files)
}

fn pages_of(joints: &[(String, Derived)]) -> Result<Files, BuildError> {
    let mut files = Files::default();
    for (label, joint) in joints {
        files.insert(format!("{}.md", joint.spec.name.value), page(joint, label)?);
    }
    Ok(files)
}
