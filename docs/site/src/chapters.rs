//! The chapters: those of `docs/SUMMARY.md`, and below them the pages that they link to.

use crate::links;
use anyhow::{Context, Result};
use mdbook_driver::book::{Book, SectionNumber};
use mdbook_summary::{Link, Summary, SummaryItem, parse_summary};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const SUMMARY: &str = "docs/SUMMARY.md";

/// The summary with paths from the root of the repository. A page that it does not list is a sub-chapter of the first page that links to it.
pub fn summary(root: &Path) -> Result<Summary> {
    let text = read(root, Path::new(SUMMARY))?;
    let mut summary = parse_summary(&text).context(SUMMARY)?;
    let mut known = BTreeSet::new();
    for items in parts(&mut summary) {
        place(items, &mut known)?;
    }
    for items in parts(&mut summary) {
        add_linked(root, items, &mut known)?;
    }
    Ok(summary)
}

fn parts(summary: &mut Summary) -> [&mut [SummaryItem]; 3] {
    [
        &mut summary.prefix_chapters,
        &mut summary.numbered_chapters,
        &mut summary.suffix_chapters,
    ]
}

/// Pages of the site, by their paths in it.
pub fn pages(book: &Book) -> Vec<PathBuf> {
    let paths = book.chapters().filter_map(|chapter| chapter.path.as_ref());
    let pages = paths.map(|path| path.with_extension("html"));
    pages.chain(["index.html".into()]).collect()
}

fn links_of(items: &mut [SummaryItem]) -> impl Iterator<Item = &mut Link> {
    items.iter_mut().filter_map(|item| match item {
        SummaryItem::Link(link) => Some(link),
        _ => None,
    })
}

fn place(items: &mut [SummaryItem], known: &mut BTreeSet<PathBuf>) -> Result<()> {
    let folder = Path::new(SUMMARY).parent().unwrap_or(Path::new(""));
    for link in links_of(items) {
        let location = link.location.as_mut();
        let location =
            location.with_context(|| format!("{SUMMARY}: `{}` leads nowhere", link.name))?;
        *location = links::within(&folder.join(&location))?;
        known.insert(location.clone());
        place(&mut link.nested_items, known)?;
    }
    Ok(())
}

fn add_linked(root: &Path, items: &mut [SummaryItem], known: &mut BTreeSet<PathBuf>) -> Result<()> {
    for link in links_of(items) {
        let Some(page) = &link.location else { continue };
        let text = read(root, page)?;
        for file in links::of(root, page, &text)? {
            if is_page(&file) && known.insert(file.clone()) {
                let name = title(&read(root, &file)?, &file)?;
                let mut nested = Link::new(name, file);
                nested.number = number_below(link);
                link.nested_items.push(nested.into());
            }
        }
        add_linked(root, &mut link.nested_items, known)?;
    }
    Ok(())
}

/// The number of the next chapter below another. The contents are indented by it, though they do not show it.
fn number_below(link: &Link) -> Option<SectionNumber> {
    let mut number = link.number.clone()?;
    number.push(u32::try_from(link.nested_items.len() + 1).ok()?);
    Some(number)
}

pub fn is_page(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending == "md")
}

fn read(root: &Path, page: &Path) -> Result<String> {
    std::fs::read_to_string(root.join(page)).with_context(|| page.display().to_string())
}

fn title(text: &str, page: &Path) -> Result<String> {
    let mut headings = text.lines().filter_map(|line| line.strip_prefix("# "));
    let title = headings.next();
    let title = title.with_context(|| format!("{}: no heading", page.display()))?;
    Ok(title.to_owned())
}
