//! Links of the pages lead somewhere.

use std::path::{Path, PathBuf};

/// Folders whose pages are looked at, and those below them.
const FOLDERS: [&str; 18] = [
    "",
    "codegen",
    "crates/cli",
    "crates/compiled",
    "crates/compiler",
    "crates/control",
    "crates/diagnostics",
    "crates/hamel",
    "crates/integrate",
    "crates/scene",
    "docs",
    "generated",
    "generated/pages",
    "joint-specs",
    "python",
    "runtime",
    "scenes",
    "tests",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn pages() -> Vec<PathBuf> {
    let folders = FOLDERS.iter().map(|folder| root().join(folder));
    let files = folders.flat_map(|folder| std::fs::read_dir(folder).expect("a folder"));
    let paths = files.map(|file| file.expect("an entry").path());
    paths
        .filter(|path| path.extension().is_some_and(|ending| ending == "md"))
        .collect()
}

/// A text without its comments, which may hold links of the site that `docs/site` builds; it checks those.
fn without_comments(text: &str) -> String {
    let mut parts = text.split("<!--");
    let first = parts.next().unwrap_or_default();
    let rests = parts.map(|part| part.split_once("-->").map_or("", |(_, rest)| rest));
    first.to_owned() + &rests.collect::<String>()
}

/// Targets of `[text](target)`, and of definitions `[name]: target`, outside of code.
fn targets(text: &str) -> Vec<String> {
    let text = without_comments(text);
    let mut is_code = false;
    let lines = text.lines().filter(|line| {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        }
        !is_code && !line.starts_with("    ")
    });
    let ends = |line: &str| -> Vec<String> {
        let links = line.split("](").skip(1);
        let ends = links.filter_map(|rest| rest.split_once(')'));
        let ends = ends.map(|(target, _)| target);
        let definition = line
            .strip_prefix('[')
            .and_then(|rest| rest.split_once("]: "));
        let definition = definition.map(|(_, target)| target);
        ends.chain(definition).map(str::to_owned).collect()
    };
    lines.flat_map(ends).collect()
}

#[test]
fn links_lead_to_files() {
    let mut count = 0;
    let mut broken = vec![];
    for page in pages() {
        let text = std::fs::read_to_string(&page).expect("UTF-8");
        let folder = page.parent().expect("a folder");
        for target in targets(&text) {
            let file = target.split('#').next().unwrap_or_default();
            if file.is_empty() || file.contains("://") {
                continue;
            }
            count += 1;
            if !folder.join(file).exists() {
                broken.push(format!("{}: {target}", page.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
    // The overview of joints alone has one per joint.
    assert!(count > 50, "{count}");
}

#[test]
fn every_picture_of_the_gallery_is_of_a_scene() {
    let gallery = std::fs::read_to_string(root().join("docs/gallery.md")).expect("UTF-8");
    let pictures = std::fs::read_dir(root().join("docs/gallery")).expect("a folder");
    let pictures = pictures.map(|file| file.expect("an entry").path());
    let drawn = pictures.filter(|path| path.extension().is_some_and(|ending| ending == "svg"));
    let names = drawn.map(|path| {
        path.file_stem()
            .expect("a name")
            .to_string_lossy()
            .into_owned()
    });
    let names: Vec<String> = names.collect();
    assert_eq!(names.len(), 14);
    for name in names {
        assert!(gallery.contains(&format!("gallery/{name}.svg")), "{name}");
        assert!(gallery.contains(&format!("scenes/{name}.toml")), "{name}");
    }
}
