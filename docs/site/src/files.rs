//! Files of the site that are not pages: pictures, and sources that pages link to.

use crate::{chapters, links};
use anyhow::{Context, Result};
use mdbook_driver::book::Book;
use std::fs;
use std::path::Path;

/// Where pages look for those of motions.
const MOTIONS: &str = "docs/gallery";

/// Gathers the files that pages link to, and motions, in a folder.
pub fn gather(root: &Path, book: &Book, motions: Option<&Path>, to: &Path) -> Result<()> {
    if to.exists() {
        fs::remove_dir_all(to).with_context(|| to.display().to_string())?;
    }
    fs::create_dir_all(to).with_context(|| to.display().to_string())?;
    for chapter in book.chapters() {
        let Some(page) = &chapter.path else { continue };
        for file in links::of(root, page, &chapter.content)? {
            if !chapters::is_page(&file) {
                let name = links::in_site(&file.to_string_lossy());
                copy(&root.join(&file), &to.join(name))?;
            }
        }
    }
    let Some(motions) = motions else {
        return Ok(());
    };
    let entries = fs::read_dir(motions).with_context(|| motions.display().to_string())?;
    for entry in entries {
        let entry = entry?;
        copy(&entry.path(), &to.join(MOTIONS).join(entry.file_name()))?;
    }
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let folder = to.parent().unwrap_or(Path::new(""));
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    fs::copy(from, to).with_context(|| from.display().to_string())?;
    Ok(())
}
