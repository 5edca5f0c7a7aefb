//! Links of a page.

use anyhow::{Context, Result, ensure};
use pulldown_cmark::{Event, Options, Parser, Tag};
use std::path::{Component, Path, PathBuf};

/// Files of the repository that a page links to or shows, by their paths from its root.
pub fn of(root: &Path, page: &Path, text: &str) -> Result<Vec<PathBuf>> {
    let folder = page.parent().unwrap_or(Path::new(""));
    let targets = Parser::new_ext(text, Options::ENABLE_TABLES).filter_map(|event| match event {
        Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => Some(dest_url),
        _ => None,
    });
    let mut files = vec![];
    for target in targets {
        let Some(path) = path(&target) else { continue };
        let name = || format!("{}: the link to `{target}`", page.display());
        let file = within(&folder.join(path)).with_context(name)?;
        ensure!(root.join(&file).is_file(), "{} leads to no file", name());
        files.push(file);
    }
    Ok(files)
}

/// The path of a link, if it leads to another file of the site.
pub fn path(target: &str) -> Option<&str> {
    let path = target.split('#').next().unwrap_or_default();
    let is_address = path.contains(':') || path.starts_with("//");
    (!path.is_empty() && !is_address).then_some(path)
}

/// What a link leads to in the site. Sources end with `.txt` there: browsers save files of other names instead of showing them.
pub fn in_site(target: &str) -> String {
    let ending = path(target).and_then(|path| path.rsplit_once('.'));
    match ending {
        Some((_, "rs" | "toml")) => format!("{target}.txt"),
        _ => target.to_owned(),
    }
}

/// A path without `.` and `..`, which must not lead out of the folder where it begins.
pub fn within(path: &Path) -> Result<PathBuf> {
    let mut result = PathBuf::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => result.push(name),
            Component::CurDir => {}
            _ => ensure!(result.pop(), "leads out of its folder"),
        }
    }
    Ok(result)
}
