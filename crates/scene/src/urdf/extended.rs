//! Extended URDF (arXiv 2504.04767): a YAML file beside a robot in URDF says where its loops close, which joints are motors, and which joints are universal or spherical.
//!
//! | YAML | URDF+, in which it is written into the robot |
//! |---|---|
//! | `closed_loop: [[A, B], …]`, `type: ['6d', '3d', …]` | a `<loop>` between the frames A and B, which are links, or joints for the links that they move: `fixed`, or `spherical` of `3d` |
//! | `name_mot: [J, …]`, or a part of their names | `independent` of the joints J that stand in loops |
//! | `joint_name: [J, …]`, `joint_type: [T, …]` | `SPHERICAL`: a ball, or in a loop three turns `J_X`, `J_Y`, `J_Z`; `UJOINT_XY` and the like: two turns `J_X`, `J_Y`; `FIXED` |
//!
//! What is written stays in its line, so that messages tell lines of the file.

use super::document::{child, tag};
use super::supplement::{LOOPS, Supplement, beside};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::read::Sink;
use crate::source::Span;
use crate::suggest::nearest;
use roxmltree::{Document, Node};
use std::collections::{HashMap, HashSet};
use std::path::Path;
use yaml_rust2::Yaml;

/// Begins the processing instruction that names the file.
pub(super) const TARGET: &str = "extended-by";

/// The robot `text` of the file `path`, with what the YAML file of the same name beside it says in URDF+; as it is where there is no such file, or one that closes no loops.
///
/// # Errors
/// A YAML file with `closed_loop` that cannot be read, is larger than 1 MiB or not UTF-8; `closed_loop` inside another key, misspelt, in two documents or two files; lists of different lengths, frames and joints that the robot does not have, and types that are not known: all at once, by the name of the YAML file.
pub fn with_loops(path: &Path, text: String) -> Result<String, Diagnostics> {
    let Some(supplement) = beside(path)? else {
        return Ok(text);
    };
    let mut sink = Sink::default();
    let completed = extended(&text, &supplement, &mut sink);
    match sink.len() {
        0 => Ok(completed.unwrap_or(text)),
        _ => Err(sink.refuse(
            &supplement.name,
            "",
            "the loops of the robot cannot be read",
        )),
    }
}

/// The robot in URDF+; `None` where it is no URDF.
fn extended(text: &str, supplement: &Supplement, sink: &mut Sink) -> Option<String> {
    let Supplement { said, name } = supplement;
    // What is no XML is refused where it is read.
    let document = Document::parse(text).ok()?;
    let mut work = Work {
        robot: Robot::new(document.root_element()),
        edits: Vec::new(),
        errors: Vec::new(),
    };
    let loops = work.loops(said);
    work.types(said, &loops);
    work.motors(said, &loops);
    work.close(&loops, name);
    for why in work.errors {
        sink.push(Diagnostic::without_place(format!("{name}: {why}")));
    }
    Some(edited(text, work.edits))
}

/// Where a text is replaced by another.
struct Edit(Span, String);

/// A loop between two links.
struct Loop {
    name: String,
    links: [String; 2],
    kind: &'static str,
    /// The joints that move in it.
    joints: HashSet<String>,
}

/// A robot's elements by their names.
struct Robot<'a, 'i> {
    root: Node<'a, 'i>,
    links: HashSet<&'a str>,
    joints: HashMap<&'a str, Node<'a, 'i>>,
    /// For each link the joint that moves it.
    above: HashMap<&'a str, Node<'a, 'i>>,
}

impl<'a, 'i> Robot<'a, 'i> {
    fn new(root: Node<'a, 'i>) -> Self {
        let named = |kind: &'static str| {
            let nodes = root.children().filter(move |node| node.has_tag_name(kind));
            nodes.filter_map(|node| Some((node.attribute("name")?, node)))
        };
        let above = named("joint").filter_map(|(_, node)| Some((end(node, "child")?, node)));
        Self {
            links: named("link").map(|(name, _)| name).collect(),
            joints: named("joint").collect(),
            above: above.collect(),
            root,
        }
    }

    /// The link of a frame, which is a link or a joint.
    fn link(&self, frame: &str) -> Option<&'a str> {
        let joint = self.joints.get(frame);
        let link = self.links.get(frame).copied();
        link.or_else(|| joint.and_then(|joint| end(*joint, "child")))
    }

    /// The joints from a link up to the root; a robot whose links go round has no end of them, and is refused elsewhere.
    fn way(&self, link: &'a str) -> HashSet<String> {
        let mut way = HashSet::new();
        let mut at = link;
        while let Some(joint) = self.above.get(at) {
            let name = joint.attribute("name").unwrap_or_default();
            if !way.insert(name.to_owned()) {
                break;
            }
            at = end(*joint, "parent").unwrap_or_default();
        }
        way
    }

    /// The end of a message that names what is meant, if anything is.
    fn meant<'n>(name: &str, known: impl IntoIterator<Item = &'n str>) -> String {
        nearest(name, known).map_or_else(String::new, |near| format!(": did you mean `{near}`?"))
    }
}

/// The link at an end of a joint.
fn end<'a>(joint: Node<'a, '_>, which: &str) -> Option<&'a str> {
    child(joint, which)?.attribute("link")
}

/// What becomes of a robot.
struct Work<'a, 'i> {
    robot: Robot<'a, 'i>,
    edits: Vec<Edit>,
    errors: Vec<String>,
}

impl Work<'_, '_> {
    /// The texts in a list.
    fn texts<'y>(&mut self, what: &str, list: &'y Yaml) -> Vec<&'y str> {
        let entries = list.as_vec().map_or(&[][..], Vec::as_slice);
        let texts: Vec<&str> = entries.iter().filter_map(Yaml::as_str).collect();
        let is_list = list.is_badvalue() || list.is_null() || list.is_array();
        if !is_list || texts.len() != entries.len() {
            self.errors
                .push(format!("`{what}` must be a list of names"));
        }
        texts
    }

    /// What `closed_loop` and `type` say; without `type` each loop is rigid.
    fn loops(&mut self, said: &Yaml) -> Vec<Loop> {
        let pairs = said[LOOPS].as_vec().cloned().unwrap_or_default();
        if !said[LOOPS].is_array() && !said[LOOPS].is_null() {
            self.errors
                .push(format!("`{LOOPS}` must be a list of pairs of frames"));
        }
        let types = self.texts("type", &said["type"]);
        if !said["type"].is_badvalue() && types.len() != pairs.len() {
            self.errors.push(format!(
                "`{LOOPS}` has {} loops, and `type` {} entries",
                pairs.len(),
                types.len()
            ));
        }
        let mut loops = Vec::new();
        for (place, pair) in pairs.iter().enumerate() {
            let number = place + 1;
            let frames = self.texts(LOOPS, pair);
            let [first, second] = frames.as_slice() else {
                self.errors
                    .push(format!("loop {number} of `{LOOPS}` is no pair of frames"));
                continue;
            };
            let kind = match types.get(place).map(|own| own.to_lowercase()).as_deref() {
                None | Some("6d") => "fixed",
                Some("3d") => "spherical",
                Some(other) => {
                    self.errors.push(format!(
                        "entry {number} of `type` is `{other}`: it must be `3d` or `6d`"
                    ));
                    continue;
                }
            };
            let ends = [*first, *second].map(|frame| {
                let link = self.robot.link(frame);
                if link.is_none() {
                    let known = self.robot.links.iter().chain(self.robot.joints.keys());
                    let meant = Robot::meant(frame, known.copied());
                    self.errors.push(format!(
                        "frame `{frame}` of loop {number} is neither a link nor a joint of the robot{meant}"
                    ));
                }
                link
            });
            let [Some(a), Some(b)] = ends else {
                continue;
            };
            let ways = [self.robot.way(a), self.robot.way(b)];
            loops.push(Loop {
                name: format!("{first}_{second}"),
                links: [a, b].map(str::to_owned),
                kind,
                joints: ways[0].symmetric_difference(&ways[1]).cloned().collect(),
            });
        }
        loops
    }

    /// What `joint_name` and `joint_type` say.
    fn types(&mut self, said: &Yaml, loops: &[Loop]) {
        let names = self.texts("joint_name", &said["joint_name"]);
        let types = self.texts("joint_type", &said["joint_type"]);
        if names.len() != types.len() {
            self.errors.push(format!(
                "`joint_name` has {} joints, and `joint_type` {} types",
                names.len(),
                types.len()
            ));
        }
        let mut seen = HashSet::new();
        for (name, kind) in names.iter().zip(types) {
            if !seen.insert(*name) {
                self.errors
                    .push(format!("joint `{name}` is in `joint_name` twice"));
                continue;
            }
            let Some(&joint) = self.robot.joints.get(name) else {
                let meant = Robot::meant(name, self.robot.joints.keys().copied());
                self.errors.push(format!(
                    "joint `{name}` of `joint_name` is no joint of the robot{meant}"
                ));
                continue;
            };
            let is_in_loop = loops.iter().any(|own| own.joints.contains(*name));
            let axes = match (kind, kind.strip_prefix("UJOINT_")) {
                ("FIXED", _) => {
                    self.retype(joint, "fixed");
                    continue;
                }
                ("SPHERICAL", _) if !is_in_loop => {
                    self.retype(joint, "spherical");
                    continue;
                }
                ("SPHERICAL", _) => "XYZ",
                (_, Some(axes)) if is_pair(axes) => axes,
                _ => {
                    self.errors.push(format!(
                        "joint `{name}` has the type `{kind}`: it must be SPHERICAL, FIXED or UJOINT_ with two axes, as UJOINT_XY"
                    ));
                    continue;
                }
            };
            self.split(joint, name, axes);
        }
    }

    fn retype(&mut self, joint: Node<'_, '_>, kind: &str) {
        if let Some(own) = joint.attribute_node("type") {
            self.edits.push(Edit(own.range_value(), kind.to_owned()));
        }
    }

    /// Turns about these axes after each other, with links without mass between them.
    fn split(&mut self, joint: Node<'_, '_>, name: &str, axes: &str) {
        let (Some(parent), Some(moved)) = (end(joint, "parent"), end(joint, "child")) else {
            return;
        };
        let source = joint.document().input_text();
        let origin = child(joint, "origin").map_or("", |origin| &source[origin.range()]);
        let mut written = String::new();
        let mut before = escaped(parent);
        for (place, axis) in axes.chars().enumerate() {
            let own = format!("{}_{axis}", escaped(name));
            let is_last = place + 1 == axes.len();
            let next = if is_last { escaped(moved) } else { own.clone() };
            let link = if is_last {
                String::new()
            } else {
                format!("<link name=\"{own}\"/>")
            };
            let origin = if place == 0 { origin } else { "" };
            let xyz = match axis {
                'X' => "1 0 0",
                'Y' => "0 1 0",
                _ => "0 0 1",
            };
            written += &format!(
                "{link}<joint name=\"{own}\" type=\"continuous\"><parent link=\"{before}\"/><child link=\"{next}\"/>{origin}<axis xyz=\"{xyz}\"/></joint>"
            );
            before = next;
        }
        let lines = |text: &str| text.matches('\n').count();
        let left = lines(&source[joint.range()]).saturating_sub(lines(&written));
        written.push_str(&"\n".repeat(left));
        self.edits.push(Edit(joint.range(), written));
    }

    /// What `name_mot` says of joints in loops: those that it names, or of one text those whose names contain it.
    fn motors(&mut self, said: &Yaml, loops: &[Loop]) {
        let motors = &said["name_mot"];
        let names: Vec<&str> = match motors.as_str() {
            Some(part) => {
                let all = self.robot.joints.keys().copied();
                all.filter(|name| name.contains(part)).collect()
            }
            None => self.texts("name_mot", motors),
        };
        let mut seen = HashSet::new();
        for name in names.into_iter().filter(|name| seen.insert(*name)) {
            let Some(&joint) = self.robot.joints.get(name) else {
                let meant = Robot::meant(name, self.robot.joints.keys().copied());
                self.errors.push(format!(
                    "motor `{name}` of `name_mot` is no joint of the robot{meant}"
                ));
                continue;
            };
            let is_in_loop = loops.iter().any(|own| own.joints.contains(name));
            let is_split = self
                .edits
                .iter()
                .any(|Edit(span, _)| *span == joint.range());
            if is_split {
                self.errors.push(format!(
                    "motor `{name}` of `name_mot` is several turns by `joint_type`: the file does not say which of them it drives"
                ));
            } else if is_in_loop && joint.attribute("independent").is_none() {
                let at = tag(joint).end;
                let said = String::from(" independent=\"true\"");
                self.edits.push(Edit(at..at, said));
            }
        }
    }

    /// Writes the loops before the end of the robot, and who says so before its beginning.
    fn close(&mut self, loops: &[Loop], name: &str) {
        let range = self.robot.root.range();
        let text = &self.robot.root.document().input_text()[range.clone()];
        let Some(end) = text.rfind("</").map(|at| range.start + at) else {
            return;
        };
        let written = loops.iter().map(|own| {
            let [first, second] = own.links.each_ref().map(|link| escaped(link));
            format!(
                "<loop name=\"{}\" type=\"{}\"><predecessor link=\"{first}\"/><successor link=\"{second}\"/></loop>",
                escaped(&own.name),
                own.kind
            )
        });
        self.edits.push(Edit(end..end, written.collect()));
        // `?>` would end it.
        let name = name.replace("?>", "? >");
        self.edits.push(Edit(
            range.start..range.start,
            format!("<?{TARGET} {name}?>"),
        ));
    }
}

/// Two different axes.
fn is_pair(axes: &str) -> bool {
    let mut letters = axes.chars();
    let pair = (letters.next(), letters.next(), letters.next());
    matches!(pair, (Some(a @ 'X'..='Z'), Some(b @ 'X'..='Z'), None) if a != b)
}

/// A text in an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}

/// The text with edits that do not overlap; of two that do, that of the larger part of the text.
fn edited(text: &str, mut edits: Vec<Edit>) -> String {
    edits.sort_by_key(|Edit(span, _)| (span.start, std::cmp::Reverse(span.end)));
    let mut written = String::with_capacity(text.len());
    let mut at = 0;
    for Edit(span, new) in edits.iter().filter(|edit| edit.0.start <= edit.0.end) {
        if span.start < at {
            continue;
        }
        written.push_str(&text[at..span.start]);
        written.push_str(new);
        at = span.end;
    }
    written.push_str(&text[at..]);
    written
}
