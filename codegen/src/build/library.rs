//! The committed library: one file per joint with an index, one page and one drawing per joint, and their overview.

use super::{BuildError, parallel, watch};
use crate::derived::Derived;
use crate::emit::files::Files;
use crate::emit::report::Accuracy;
use crate::emit::rust::{Index, Runtime, file, index};
use crate::emit::{drawing_file, overview, page};
use std::path::Path;

/// The overview of all joints, beside the folder of pages.
const OVERVIEW: &str = "JOINTS.md";

/// Writes the folders, or compares them with what the specs say.
pub(super) fn generate(
    joints: Vec<(String, Derived)>,
    label: &str,
    (modules, pages): (&Path, &Path),
    accuracy: &Accuracy,
    runtime: &Runtime,
    check: bool,
) -> Result<(), BuildError> {
    let here = Path::new(".");
    let parent = pages
        .parent()
        .filter(|parent| !parent.as_os_str().is_empty());
    let above = parent.unwrap_or(here);
    let kernels =
        |(_, joint): &(String, Derived)| joint.bodies().map(|body| body.kernels.len()).sum();
    let written = parallel::map(joints, kernels, |(label, joint)| {
        let own = of_joint(&joint, &label, accuracy, runtime);
        (joint, own)
    });
    let (mut joints, mut own_sources, mut own_pages) = (vec![], Files::default(), Files::default());
    for (joint, own) in written {
        let (source, page) = own?;
        joints.push(joint);
        own_sources.texts.extend(source.texts);
        own_pages.texts.extend(page.texts);
    }
    own_sources.insert("mod.rs", index(&joints, label, Index::Files, runtime)?);
    let folders = [
        (own_sources, modules),
        (own_pages, pages),
        (overview_of(&joints, label, pages, accuracy)?, above),
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

/// The source file of a joint, and its page with its drawing.
fn of_joint(
    joint: &Derived,
    label: &str,
    accuracy: &Accuracy,
    runtime: &Runtime,
) -> Result<(Files, Files), BuildError> {
    let name = &joint.spec.name.value;
    let (mut source, mut pages) = (Files::default(), Files::default());
    source.insert(format!("{name}.rs"), file(joint, label, runtime)?);
    pages.insert(format!("{name}.md"), page(joint, label, accuracy)?);
    if let Some(drawing) = drawing_file(joint, label) {
        pages.insert(format!("{name}.svg"), drawing);
    }
    Ok((source, pages))
}

fn overview_of(
    joints: &[Derived],
    label: &str,
    pages: &Path,
    accuracy: &Accuracy,
) -> Result<Files, BuildError> {
    let folder = pages.file_name().unwrap_or_default().to_string_lossy();
    let mut files = Files::default();
    files.insert(OVERVIEW, overview(joints, label, &folder, accuracy)?);
    Ok(files)
}
