//! Links of the site lead somewhere.

use crate::links;
use anyhow::{Context, Result, bail};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// What other pages may lead to, and what a page leads to.
#[derive(Default)]
struct Page {
    ids: BTreeSet<String>,
    targets: BTreeSet<String>,
}

/// Fails with all links of pages that lead to no file, or to no place in a page.
pub fn links(site: &Path, names: &[PathBuf]) -> Result<()> {
    let mut pages = BTreeMap::new();
    for name in names {
        let text = std::fs::read_to_string(site.join(name));
        let text = text.with_context(|| name.display().to_string())?;
        pages.insert(name.clone(), read(&text));
    }
    let mut broken = vec![];
    for (name, page) in &pages {
        let targets = page.targets.iter();
        let bad = targets.filter(|target| !leads_somewhere(site, &pages, name, target));
        broken.extend(bad.map(|target| format!("{}: {target}", name.display())));
    }
    match broken.is_empty() {
        true => Ok(()),
        false => bail!("links that lead nowhere:\n{}", broken.join("\n")),
    }
}

fn leads_somewhere(
    site: &Path,
    pages: &BTreeMap<PathBuf, Page>,
    from: &Path,
    target: &str,
) -> bool {
    let (path, place) = target.split_once('#').unwrap_or((target, ""));
    let file = match links::path(target) {
        Some(path) => links::within(&from.with_file_name(path)),
        // An address elsewhere is not looked at.
        None if !path.is_empty() => return true,
        None => Ok(from.to_owned()),
    };
    let Ok(file) = file else { return false };
    let has_place = |page: &Page| place.is_empty() || page.ids.contains(place);
    site.join(&file).is_file() && pages.get(&file).is_none_or(has_place)
}

/// Places and links in the tags of a page as mdBook writes it: values are in double quotes and have no spaces, and text has no `<`.
fn read(html: &str) -> Page {
    let mut page = Page::default();
    let tags = html.split('<').filter_map(|rest| rest.split_once('>'));
    for word in tags.flat_map(|(tag, _)| tag.split_ascii_whitespace()) {
        if let Some(id) = value(word, "id") {
            page.ids.insert(id.to_owned());
        }
        if let Some(target) = value(word, "href").or_else(|| value(word, "src")) {
            page.targets.insert(target.to_owned());
        }
    }
    page
}

/// The value in `name="value"`.
fn value<'a>(word: &'a str, name: &str) -> Option<&'a str> {
    let quoted = word.strip_prefix(name)?.strip_prefix("=\"")?;
    quoted.split('"').next()
}
