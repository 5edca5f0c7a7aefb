//! Builds the pages of this repository as a site in `target/book`. Its one argument, if there is one, is a folder of pages that play the motions of the gallery.

mod chapters;
mod check;
mod files;
mod links;
mod text;

use anyhow::{Context, Result};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// What the site holds besides pages, as mdBook copies it.
const FILES: &str = "target/book-files";

fn main() -> ExitCode {
    match build() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn build() -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let root = root.canonicalize().context("the repository")?;
    let motions = std::env::args_os().nth(1).map(PathBuf::from);

    let config = Config::from_disk(root.join("docs/book.toml"))?;
    let summary = chapters::summary(&root)?;
    let mut book = MDBook::load_with_config_and_summary(&root, config, summary)?;
    files::gather(&root, &book.book, motions.as_deref(), &root.join(FILES))?;
    text::prepare(&mut book.book, motions.is_some())?;
    book.config.book.src = FILES.into();
    book.build()?;

    let site = root.join(&book.config.build.build_dir);
    let pages = chapters::pages(&book.book);
    check::links(&site, &pages)?;
    println!(
        "{}: {} pages",
        site.join("index.html").display(),
        pages.len()
    );
    Ok(())
}
