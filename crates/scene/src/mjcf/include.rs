//! The files that a model includes, in the places of the elements that name them.

use super::mesh::weighed;
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::read::Sink;
use crate::robot::xml::{self, tag};
use crate::scene::read_file;
use crate::text::visible_line;
use roxmltree::Node;
use std::path::{Path, PathBuf};

/// How deep files may include each other.
const DEEPEST: usize = 16;

/// Most bytes of a model with all that it includes.
const MOST_BYTES: usize = 512 << 20;

/// The target of the instructions that stand before what was included, with the name of the file.
pub(super) const TARGET: &str = "hamel-included";

/// The model `text` of the file `path`, with what the elements `<include>` name in their places: files beside the one that names them, or beside
/// the first. What its meshes weigh stands before their elements, where bodies may have their masses of them.
///
/// # Errors
/// Files that cannot be read, that are no MJCF or that include each other in a circle, each by the name of the file that includes them.
pub fn with_files(path: &Path, text: String) -> Result<String, Diagnostics> {
    let main = path.parent().unwrap_or(Path::new(""));
    Ok(weighed(main, with_includes(path, text)?))
}

fn with_includes(path: &Path, text: String) -> Result<String, Diagnostics> {
    if !text.contains("<include") {
        return Ok(text);
    }
    let mut including = Including {
        main: path.parent().unwrap_or(Path::new("")).to_owned(),
        open: vec![path.to_owned()],
        size: 0,
    };
    including.expanded(path, &path.display().to_string(), &text, false)
}

/// What is being included.
struct Including {
    /// The folder of the first file.
    main: PathBuf,
    /// The files that include each other, the last one innermost.
    open: Vec<PathBuf>,
    /// Bytes so far.
    size: usize,
}

impl Including {
    /// The text of a file with all that it includes; of a part that is included, what its root holds.
    fn expanded(
        &mut self,
        path: &Path,
        name: &str,
        text: &str,
        is_part: bool,
    ) -> Result<String, Diagnostics> {
        let mut sink = Sink::default();
        let refuse = |sink: Sink| sink.refuse(name, text, "the model cannot be read");
        let Some(document) = xml::tree(text, &mut sink) else {
            // What is wrong with the first file is told where it is read.
            return match is_part {
                true => Err(refuse(sink)),
                false => Ok(text.to_owned()),
            };
        };
        let root = document.root_element();
        if !matches!(root.tag_name().name(), "mujoco" | "mujocoinclude") {
            let message = format!(
                "the document is a <{}>, not a <mujoco> or a <mujocoinclude>",
                visible_line(root.tag_name().name())
            );
            sink.push(Diagnostic::new(tag(root), message));
            return Err(refuse(sink));
        }
        let whole = match (is_part, root.first_child(), root.last_child()) {
            (false, ..) => 0..text.len(),
            (true, Some(first), Some(last)) => first.range().start..last.range().end,
            (true, ..) => 0..0,
        };
        let mut expanded = String::new();
        let mut done = whole.start;
        for node in document
            .descendants()
            .filter(|node| node.has_tag_name("include"))
        {
            let range = node.range();
            if range.start < done {
                // Inside another.
                continue;
            }
            expanded.push_str(&text[done..range.start]);
            done = range.end;
            match self.included(path, node) {
                Ok(part) => expanded.push_str(&part),
                Err(Refusal::Here(error)) => sink.push(*error),
                Err(Refusal::There(errors)) => return Err(errors),
            }
        }
        expanded.push_str(&text[done..whole.end]);
        self.size += expanded.len();
        match sink.len() {
            0 => Ok(expanded),
            _ => Err(refuse(sink)),
        }
    }

    fn included(&mut self, path: &Path, node: Node<'_, '_>) -> Result<String, Refusal> {
        let here = |message: String| {
            let place = node
                .attribute_node("file")
                .map_or_else(|| tag(node), |file| file.range_value());
            Refusal::Here(Box::new(Diagnostic::new(place, message)))
        };
        let Some(file) = node.attribute("file") else {
            return Err(here(String::from("<include> has no attribute `file`")));
        };
        let beside = path.parent().unwrap_or(Path::new("")).join(file);
        let found = match beside.is_file() {
            true => beside,
            false => self.main.join(file),
        };
        let shown = visible_line(file);
        if self.open.contains(&found) {
            return Err(here(format!("`{shown}` includes itself")));
        }
        if self.open.len() >= DEEPEST {
            return Err(here(format!(
                "`{shown}`: files include each other more than {DEEPEST} deep"
            )));
        }
        if self.size > MOST_BYTES {
            return Err(here(format!(
                "`{shown}`: the model with what it includes is larger than {} MiB",
                MOST_BYTES >> 20
            )));
        }
        let (text, name) = read_file(&found).map_err(|errors| {
            let said = errors.errors().first().map_or("", |error| error.message());
            here(format!("`{shown}` is not included: {said}"))
        })?;
        self.open.push(found.clone());
        let part = self
            .expanded(&found, &name, &text, true)
            .map_err(Refusal::There)?;
        self.open.pop();
        Ok(format!("<?{TARGET} {}?>{part}", shown.replace("?>", "")))
    }
}

/// What is wrong with an element, or with the file that it names.
enum Refusal {
    Here(Box<Diagnostic>),
    There(Diagnostics),
}
