//! What of a model is not simulated, by section and line.

use super::element::Lines;
use super::include::TARGET;
use super::settings::Settings;
use super::tree::Body;
use crate::notice::{Notices, Severity};
use crate::text::visible_line;
use roxmltree::Node;

/// Sections that are left out, with what is said of them.
const SECTIONS: [(&str, Severity, &str); 5] = [
    ("tendon", Severity::Warning, "tendons are not simulated"),
    (
        "deformable",
        Severity::Warning,
        "flexes and skins are not simulated",
    ),
    ("extension", Severity::Warning, "plugins are not simulated"),
    ("sensor", Severity::Note, "sensors are not read"),
    (
        "keyframe",
        Severity::Note,
        "keyframes are not read: the robot begins with its joints at `ref`",
    ),
];

/// Notes what is not simulated.
pub(super) fn tell(
    root: Node<'_, '_>,
    bodies: &[Body<'_>],
    settings: &Settings,
    lines: &Lines,
    notices: &mut Notices,
) {
    let line = |node: Node<'_, '_>| lines.of(node.range().start);
    for node in root.children().filter(Node::is_element) {
        let name = node.tag_name().name();
        let section = SECTIONS.iter().find(|(known, ..)| *known == name);
        let is_empty = !node.children().any(|child| child.is_element());
        if let Some((_, severity, message)) = section.filter(|_| !is_empty) {
            let element = format!("<{name}> in line {}", line(node));
            match severity {
                Severity::Warning => notices.warn(*message, element),
                Severity::Note => notices.add(*message, element),
            }
        }
    }
    if bodies.iter().skip(1).any(|body| !body.geoms.is_empty()) {
        notices.add(
            "contacts are not simulated: bodies pass through each other",
            "<worldbody>",
        );
    }
    for own in root.descendants().filter_map(|node| node.pi()) {
        if own.target == TARGET {
            let file = visible_line(own.value.unwrap_or_default());
            notices.add(
                "lines are counted with what is included",
                format!("file `{file}`"),
            );
        }
    }
    for body in bodies {
        for joint in &body.joints {
            let align = joint.element.text("align");
            if align == Some("true")
                || settings.aligned
                    && align != Some("false")
                    && joint.element.node.has_tag_name("freejoint")
            {
                notices.warn(
                    "frames of free bodies are those of the file, not those of their inertias (`align`, `alignfree`)",
                    body.owner.clone(),
                );
            }
        }
    }
}
