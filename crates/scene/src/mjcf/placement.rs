//! Where an element stands: its position, and its orientation in any of the ways of MJCF.

use super::element::Element;
use super::settings::Settings;
use crate::diagnostics::Diagnostic;
use crate::parse::rotation;
use crate::read::Sink;
use crate::source::Located;
use hamel_runtime::spatial::{Pose, so3};
use nalgebra::{Matrix3, Vector3, Vector4};

/// The ways to write an orientation.
const WAYS: [&str; 5] = ["quat", "axisangle", "euler", "xyaxes", "zaxis"];

/// The position that an element or its class says; 0 without.
pub(super) fn position(element: &Element<'_>) -> Vector3<f64> {
    element
        .vector("pos")
        .map_or_else(Vector3::zeros, Vector3::from)
}

/// The pose that an element or its class says; `None` where it makes no sense, which is noted.
pub(super) fn pose(
    owner: &str,
    element: &Element<'_>,
    settings: &Settings,
    sink: &mut Sink,
) -> Option<Pose<f64>> {
    let rotation = orientation(owner, element, settings, sink)?;
    Some(Pose::new(rotation, position(element)))
}

/// The pose of what lies between the two points of `fromto`: in the middle, z along the way from the second to the first.
pub(super) fn segment(owner: &str, element: &Element<'_>, sink: &mut Sink) -> Option<Pose<f64>> {
    let [a, b, c, d, e, f] = element.vector("fromto")?;
    let (from, to) = (Vector3::new(a, b, c), Vector3::new(d, e, f));
    let along = Located::new(from - to, element.span("fromto"));
    let rotation = rotation::from_axis(&format!("{owner}: the way of `fromto`"), along, sink)?;
    Some(Pose::new(rotation, (from + to) / 2.0))
}

/// Whether the element itself says an orientation.
pub(super) fn is_turned(element: &Element<'_>) -> bool {
    WAYS.iter().any(|way| element.node.has_attribute(*way))
}

fn orientation(
    owner: &str,
    element: &Element<'_>,
    settings: &Settings,
    sink: &mut Sink,
) -> Option<Matrix3<f64>> {
    // An element that says one in any way goes before its class.
    let turned = |node: &roxmltree::Node<'_, '_>| WAYS.iter().any(|way| node.has_attribute(*way));
    let Some(node) = element.chain.iter().copied().find(turned) else {
        return Some(Matrix3::identity());
    };
    let own = Element::plain(node);
    let mut ways = WAYS.iter().filter(|way| node.has_attribute(**way));
    let way = *ways.next()?;
    if let Some(other) = ways.next() {
        let message = format!("{owner}: `{way}` and `{other}` exclude each other");
        sink.push(Diagnostic::new(own.span(other), message));
        return None;
    }
    let (path, span) = (format!("{owner}: `{way}`"), own.span(way));
    match way {
        "quat" => {
            let quaternion = Located::new(Vector4::from(own.vector(way)?), span);
            rotation::from_any_quaternion(&path, quaternion, sink)
        }
        "axisangle" => {
            let [x, y, z, angle] = own.vector(way)?;
            let axis = Located::new(Vector3::new(x, y, z), span);
            let axis = rotation::unit(&path, axis, sink)?;
            Some(so3::exp(&(axis * settings.angle(angle))))
        }
        "euler" => Some(euler(own.vector(way)?, settings)),
        "zaxis" => {
            let axis = Located::new(Vector3::from(own.vector(way)?), span);
            rotation::from_axis(&path, axis, sink)
        }
        _ => {
            let [a, b, c, d, e, f] = own.vector(way)?;
            let x = Located::new(Vector3::new(a, b, c), span.clone());
            let x = rotation::unit(&format!("{path}, its x axis,"), x, sink)?;
            let y = Vector3::new(d, e, f);
            let y = Located::new(y - x * x.dot(&y), span);
            let y = rotation::unit(&format!("{path}, its y axis across x,"), y, sink)?;
            Some(Matrix3::from_columns(&[x, y, x.cross(&y)]))
        }
    }
}

/// Turns about axes in the order of the model: about those that turn along, or about fixed ones.
fn euler(angles: [f64; 3], settings: &Settings) -> Matrix3<f64> {
    let mut turned = Matrix3::identity();
    for (angle, letter) in angles.into_iter().zip(settings.euler) {
        let axis = match letter.to_ascii_lowercase() {
            'x' => Vector3::x(),
            'y' => Vector3::y(),
            _ => Vector3::z(),
        };
        let turn = so3::exp(&(axis * settings.angle(angle)));
        turned = match letter.is_ascii_lowercase() {
            true => turned * turn,
            false => turn * turned,
        };
    }
    turned
}
