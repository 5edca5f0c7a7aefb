//! Postures that have names: the states of an SRDF, the XML format in which MoveIt says of a robot what its URDF does not.
//!
//! Of an SRDF only its `<group_state>` elements are read: `name`, and for each `<joint>` in it `name` and `value`. A value is one number, rad or m; four numbers, a unit quaternion (x, y, z, w); or
//! seven, a position in m and then such a quaternion, as the states of robots that move freely have it. Several groups may have a state of one name, such as an arm and its hand; it is then that of all
//! of them.

use super::xml;
use super::xml::{finite, tag};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::read::Sink;
use crate::suggest::{nearest, one_of};
use crate::text::{quoted, visible_line};
use nalgebra::Vector4;
use roxmltree::Node;

/// Joints with the numbers that say where they stand: a coordinate, rad or m; a unit quaternion (x, y, z, w) of the child frame in the parent frame; or seven, the position of that frame, m, and
/// such a quaternion.
pub type Coordinates = Vec<(String, Vec<f64>)>;

/// Largest deviation of a quaternion's length from 1 that passes for rounding of its digits.
const QUATERNION_TOLERANCE: f64 = 1e-3;

/// Where the state of that name in an SRDF has the joints of the robot. Messages call the text `source_name`.
///
/// # Errors
/// All mistakes: text that is no SRDF, no state of that name, joints of it without a name or a number.
pub fn state(text: &str, source_name: &str, state: &str) -> Result<Coordinates, Diagnostics> {
    let mut sink = Sink::default();
    let found = xml::tree(text, &mut sink)
        .map(|document| of_document(document.root_element(), state, &mut sink));
    match found {
        Some(found) if sink.len() == 0 => Ok(found),
        _ => Err(sink.refuse(source_name, text, "the SRDF cannot be read")),
    }
}

fn of_document(root: Node<'_, '_>, state: &str, sink: &mut Sink) -> Coordinates {
    if !root.has_tag_name("robot") {
        let name = visible_line(root.tag_name().name());
        let message = format!("the document is a <{name}>, not the <robot> of an SRDF");
        sink.push(Diagnostic::new(tag(root), message));
        return Vec::new();
    }
    let states = || {
        let children = root.children();
        children.filter(|child| child.has_tag_name("group_state"))
    };
    let mut own = states()
        .filter(|found| found.attribute("name") == Some(state))
        .peekable();
    if own.peek().is_none() {
        sink.push(unknown(root, state, states()));
    }
    let joints = own.flat_map(|found| found.children().filter(|child| child.has_tag_name("joint")));
    let mut found = Coordinates::new();
    for joint in joints {
        let Some((name, value)) = coordinates(joint, sink) else {
            continue;
        };
        match found.iter().find(|(other, _)| *other == name) {
            None => found.push((name, value)),
            Some((_, other)) if *other == value => {}
            Some((_, other)) => {
                let (name, state) = (visible_line(&name), visible_line(state));
                let (other, value) = (shown(other), shown(&value));
                let message = format!(
                    "joint `{name}` stands at {other} in one <group_state> of the name `{state}`, and at {value} in another"
                );
                sink.push(Diagnostic::new(tag(joint), message));
            }
        }
    }
    found
}

fn unknown<'a>(
    root: Node<'_, '_>,
    state: &str,
    states: impl Iterator<Item = Node<'a, 'a>>,
) -> Diagnostic {
    let message = format!("the SRDF has no state `{}`", visible_line(state));
    let mut names: Vec<&str> = states.filter_map(|state| state.attribute("name")).collect();
    names.dedup();
    let error = Diagnostic::new(tag(root), message);
    match (nearest(state, names.iter().copied()), names.is_empty()) {
        (Some(near), _) => error.help(format!("did you mean `{near}`?")),
        (None, true) => error.help("it has no <group_state>"),
        (None, false) => error.help(format!("a state is {}", one_of(names.into_iter()))),
    }
}

fn coordinates(joint: Node<'_, '_>, sink: &mut Sink) -> Option<(String, Vec<f64>)> {
    let mut attribute = |name: &str| {
        let found = joint.attribute_node(name);
        if found.is_none() {
            let message = format!("<joint> of a state has no attribute `{name}`");
            sink.push(Diagnostic::new(tag(joint), message));
        }
        found
    };
    let (name, value) = (attribute("name"), attribute("value"));
    let (name, value) = (name?, value?);
    let numbers = finite(value.value()).filter(|numbers| match numbers.as_slice() {
        [_] => true,
        [x, y, z, w] | [_, _, _, x, y, z, w] => {
            let norm = Vector4::new(*x, *y, *z, *w).norm();
            (norm - 1.0).abs() <= QUATERNION_TOLERANCE
        }
        _ => false,
    });
    if numbers.is_none() {
        let message = format!(
            "joint `{}` stands at {}, not at a finite number, a unit quaternion (x, y, z, w), or a position and such a quaternion",
            visible_line(name.value()),
            quoted(value.value())
        );
        sink.push(Diagnostic::new(value.range_value(), message));
    }
    Some((name.value().to_owned(), numbers?))
}

/// The numbers as a state has them.
fn shown(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(f64::to_string).collect();
    numbers.join(" ")
}

#[cfg(test)]
mod tests {
    use super::state;

    const TEXT: &str = "<robot name='panda'>
  <group name='arm'/>
  <group_state name='ready' group='arm'><joint name='a' value='0.5'/><joint name='b' value=' -1e-1 '/></group_state>
  <group_state name='ready' group='hand'><joint name='f' value='0.04'/></group_state>
  <group_state name='odd' group='hand'><joint name='f' value='1 2'/><joint name='g' value='0 0 1 2'/><joint value='0'/></group_state>
  <group_state name='up' group='all'><joint name='root_joint' value='0 0 0.5 0 0 1. 0'/><joint name='h' value='0 0.6 0 .8'/></group_state>
</robot>";

    #[test]
    fn states_of_one_name_are_put_together() {
        let found = state(TEXT, "panda.srdf", "ready").expect("a state");
        let wanted = [("a", 0.5), ("b", -0.1), ("f", 0.04)];
        assert_eq!(
            found,
            wanted.map(|(name, number)| (name.to_owned(), vec![number]))
        );
    }

    #[test]
    fn poses_and_attitudes_have_several_numbers() {
        let found = state(TEXT, "panda.srdf", "up").expect("a state");
        let wanted = [
            ("root_joint", vec![0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0]),
            ("h", vec![0.0, 0.6, 0.0, 0.8]),
        ];
        assert_eq!(found, wanted.map(|(name, own)| (name.to_owned(), own)));
    }

    #[test]
    fn mistakes_are_told_all_at_once() {
        let said = |text: &str, name: &str| {
            let errors = state(text, "panda.srdf", name).expect_err("a mistake");
            errors.to_string()
        };
        let odd = said(TEXT, "odd");
        assert!(
            odd.contains("joint `f` stands at \"1 2\", not at a finite number"),
            "{odd}"
        );
        assert!(
            odd.contains("<joint> of a state has no attribute `name`"),
            "{odd}"
        );
        assert!(said(TEXT, "raedy").contains("did you mean `ready`?"));
        assert!(said("<sdf/>", "ready").contains("a <sdf>, not the <robot> of an SRDF"));
        assert!(said("<robot/>", "ready").contains("it has no <group_state>"));
        let twice = said(
            &TEXT.replace("name='f' value='0.04'", "name='a' value='0.04'"),
            "ready",
        );
        assert!(
            twice.contains("joint `a` stands at 0.5 in one <group_state> of the name `ready`, and at 0.04 in another"),
            "{twice}"
        );
        let same = TEXT.replace("name='f' value='0.04'", "name='a' value='0.5'");
        assert_eq!(
            state(&same, "panda.srdf", "ready").expect("a state").len(),
            2
        );
        assert!(said("<robot>", "ready").contains("not valid XML"));
    }
}
