//! The committed library: one file a joint with an index, one page and one drawing a joint, and their overview.

use super::{BuildError, watch};
use crate::derived::Derived;
use crate::emit::files::Files;
use crate::emit::report::Accuracy;
use crate::emit::rust::{Index, file, index};
use crate::emit::{drawing_file, overview, page};
use std::path::Path;

/// The overview of all joints, beside the folder of pages.
const OVERVIEW: &str = "JOINTS.md";

/// Writes the folders, or compares them with what the specs say.
pub(super) fn generate(
    joints: &[(String, Derived)],
    label: &str,
    (modules, pages): (&Path, &Path),
    accuracy: &Accuracy,
    check: bool,
) -> Result<(), BuildError> {
    let here = Path::new(".");
    let parent = pages
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty());
    let above = parent.unwrap_or(here);
    let folders = [
        (sources(joints, label)?, modules),
        (pages_of(joints, accuracy)?, pages),
        (overview_of(joints, label, pages, accuracy)?, above),
    ];
    let mut lines = vec![];
    for (files, folder) in &folders {
        match check {
            false => {
                files.write(folder)?;
            }
            true => lines.extend(compared(files, folder)?),
        }
    }
    match lines.is_empty() {
        true => Ok(()),
        false => Err(BuildError::NotFresh(lines)),
    }
}

/// The differences of one folder. Whoever edits, adds or removes a file must meet this check again.
fn compared(files: &Files, folder: &Path) -> Result<Vec<String>, BuildError> {
    let holds_others = files.texts.contains_key(OVERVIEW);
    if !holds_others {
        watch(folder);
    }
    let names = files.texts.keys();
    names.for_each(|name| watch(&folder.join(name)));
    Ok(files.differences(folder)?.lines(&folder.to_string_lossy()))
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

fn pages_of(joints: &[(String, Derived)], accuracy: &Accuracy) -> Result<Files, BuildError> {
    let mut files = Files::default();
    for (label, joint) in joints {
        let name = &joint.spec.name.value;
        files.insert(format!("{name}.md"), page(joint, label, accuracy)?);
        if let Some(drawing) = drawing_file(joint, label) {
            files.insert(format!("{name}.svg"), drawing);
        }
    }
    Ok(files)
}

fn overview_of(
    joints: &[(String, Derived)],
    label: &str,
    pages: &Path,
    accuracy: &Accuracy,
) -> Result<Files, BuildError> {
    let folder = pages.file_name().unwrap_or_default().to_string_lossy();
    let joints: Vec<Derived> = joints.iter().map(|(_, joint)| joint.clone()).collect();
    let mut files = Files::default();
    files.insert(OVERVIEW, overview(&joints, label, &folder, accuracy)?);
    Ok(files)
}
