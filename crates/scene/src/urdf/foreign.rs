//! Other formats in XML that files of robots come in, except for MJCF and SDF: they are not read, and errors say what makes a URDF of them.

use super::document::tag;
use crate::diagnostics::Diagnostic;
use crate::text::visible_line;
use roxmltree::{Document, Node};

/// Begin xacro's expressions in attributes. A `$` alone stands in names of meshes and plugins too.
const EXPRESSIONS: [&str; 5] = ["${", "$(find ", "$(arg ", "$(env ", "$(eval "];

/// What makes a URDF of a xacro file.
const EXPAND: &str = "expand it first: `xacro robot.xacro > robot.urdf` (ROS, or `pip install xacro`; arguments follow as `name:=value`)";

/// Why a document is none in URDF, if it is none: by its root element, or by macros of xacro that nothing has expanded.
pub(super) fn refusal(document: &Document<'_>) -> Option<Diagnostic> {
    let root = document.root_element();
    let name = root.tag_name().name();
    if name == "robot" {
        return unexpanded(document);
    }
    let (format, advice) = match name {
        "gazebo" => (
            "SDF before version 1.2, which is not read",
            "`gz sdf -p model.sdf` writes it in a later version",
        ),
        "mujocoinclude" => (
            "a part of a robot in MJCF, the format of MuJoCo",
            "read the file that includes it, whose root is <mujoco>",
        ),
        _ => {
            let name = visible_line(name);
            let message =
                format!("the document is a <{name}>, not a <robot>, a <mujoco> or an <sdf>");
            return Some(Diagnostic::new(tag(root), message));
        }
    };
    let message = format!("the document is a <{name}>: {format}");
    Some(Diagnostic::new(tag(root), message).help(advice))
}

/// The help for XML that cannot be read because nothing declares xacro's prefix.
pub(crate) fn of_prefix(prefix: &str) -> Option<&'static str> {
    (prefix == "xacro").then_some(EXPAND)
}

/// The first macro. What xacro has expanded may still declare its namespace.
fn unexpanded(document: &Document<'_>) -> Option<Diagnostic> {
    let mut elements = document.descendants().filter(Node::is_element);
    let (at, what) = elements.find_map(|node| {
        let (space, name) = (node.tag_name().namespace(), node.tag_name().name());
        if space.is_some_and(|space| space.contains("xacro")) {
            return Some((tag(node), format!("<xacro:{}>", visible_line(name))));
        }
        let mut attributes = node.attributes();
        let expression = attributes.find(|attribute| {
            let value = attribute.value();
            EXPRESSIONS.iter().any(|begin| value.contains(begin))
        })?;
        let place = expression.range_value();
        Some((place, format!("`{}`", visible_line(expression.value()))))
    })?;
    let message = format!("{what}: the file is a xacro template, not a URDF");
    Some(Diagnostic::new(at, message).help(EXPAND))
}
