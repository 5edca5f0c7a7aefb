//! Elements of a scene beside its bodies: `[[frame]]`, `[[spring]]`, `[[wrench]]`, `[[constraint]]`, `[[event]]`, `[[shape]]`.

use super::body::WORLD;
use super::controller::Joints;
use super::event::event;
use super::shape::shape;
use super::{BodyDraft, Tree, placement, rotation, time};
use crate::diagnostics::Diagnostic;
use crate::event::EventDescription;
use crate::forces::{
    BodyPoint, ConstraintDescription, FrameDescription, PointSpring, WrenchAxes, WrenchDescription,
};
use crate::read::{Fields, Sink, Value};
use crate::shape::ShapeDescription;
use crate::source::Located;
use hamel_runtime::spatial::Pose;
use nalgebra::Vector3;
use std::collections::HashMap;

/// What could be read of the elements.
#[derive(Debug, Default)]
pub(crate) struct Elements {
    pub(crate) frames: Vec<FrameDescription>,
    pub(crate) springs: Vec<PointSpring>,
    pub(crate) wrenches: Vec<WrenchDescription>,
    pub(crate) constraints: Vec<ConstraintDescription>,
    pub(crate) events: Vec<EventDescription>,
    pub(crate) shapes: Vec<ShapeDescription>,
}

/// Reads all of them.
pub(super) fn elements(
    fields: &mut Fields<'_>,
    (drafts, joints): (&[BodyDraft], Option<&Joints<'_>>),
    tree: Option<&Tree>,
    sink: &mut Sink,
) -> Elements {
    let bodies = Bodies::new(drafts, tree);
    let elements = Elements {
        frames: each(fields, "frame", |f, s| frame(f, &bodies, s), sink),
        springs: each(fields, "spring", |f, s| spring(f, &bodies, s), sink),
        wrenches: each(fields, "wrench", |f, s| wrench(f, &bodies, s), sink),
        constraints: each(fields, "constraint", |f, s| constraint(f, &bodies, s), sink),
        events: each(fields, "event", |f, s| event(f, &bodies, joints, s), sink),
        shapes: each(fields, "shape", |f, s| shape(f, &bodies, s), sink),
    };
    unique(&elements, drafts, sink);
    elements
}

/// The tables under `key` that could be read.
pub(super) fn each<T>(
    fields: &mut Fields<'_>,
    key: &'static str,
    read: impl Fn(&mut Fields<'_>, &mut Sink) -> Option<T>,
    sink: &mut Sink,
) -> Vec<T> {
    let Some(value) = fields.optional(key) else {
        return Vec::new();
    };
    let tables = value.tables(sink).unwrap_or_default().into_iter();
    let found = tables.enumerate().filter_map(|(index, (span, table))| {
        let mut fields = Fields::new(format!("{key} {}: ", index + 1), span, table);
        let found = read(&mut fields, sink);
        fields.finish(sink);
        found
    });
    found.collect()
}

/// The bodies by name; those of a scene whose tree is wrong have no index.
pub(super) struct Bodies<'a> {
    /// All names, and the world.
    names: Vec<&'a str>,
    indices: HashMap<&'a str, Option<usize>>,
}

impl<'a> Bodies<'a> {
    fn new(drafts: &'a [BodyDraft], tree: Option<&Tree>) -> Self {
        let named = |draft: &'a BodyDraft| Some(draft.name.as_ref()?.value.as_str());
        let mut names: Vec<&str> = drafts.iter().filter_map(named).collect();
        let mut indices: HashMap<&str, Option<usize>> =
            names.iter().map(|&name| (name, None)).collect();
        for (index, &place) in tree.iter().flat_map(|tree| &tree.order).enumerate() {
            if let Some(name) = named(&drafts[place]) {
                indices.insert(name, Some(index));
            }
        }
        names.push(WORLD);
        Self { names, indices }
    }

    /// The body called by `value`; the inner `None` is the world.
    pub(super) fn find(&self, value: &Value<'_>, sink: &mut Sink) -> Option<Option<usize>> {
        let name = value.text(sink)?;
        if name.value == WORLD {
            return Some(None);
        }
        if let Some(index) = self.indices.get(name.value.as_str()) {
            return (*index).map(Some);
        }
        let message = format!(
            "{} is {:?}, which is not a body of the scene",
            value.path(),
            name.value
        );
        let error = Diagnostic::new(name.span, message);
        sink.unknown(error, &name.value, &self.names, "a body is");
        None
    }

    /// As [`Bodies::find`], and not the world, to which `what` is of no use.
    pub(super) fn find_moving(
        &self,
        value: &Value<'_>,
        what: &str,
        sink: &mut Sink,
    ) -> Option<usize> {
        let found = self.find(value, sink)?;
        if found.is_none() {
            let message = format!("{} is the world: {what}", value.path());
            sink.push(Diagnostic::new(value.span(), message));
        }
        found
    }
}

fn frame(
    fields: &mut Fields<'_>,
    bodies: &Bodies<'_>,
    sink: &mut Sink,
) -> Option<FrameDescription> {
    let name = name(fields, "frame", sink);
    let body = fields.required("body", sink);
    let body = body.and_then(|body| bodies.find(&body, sink));
    let at = match fields.optional("at") {
        Some(at) => placement::pose(&at, sink).map(|at| at.value),
        None => Some(Pose::identity()),
    };
    Some(FrameDescription {
        name: name?,
        body: body?,
        at: at?,
    })
}

/// The name of an element, by which messages call it from then on.
pub(super) fn name(
    fields: &mut Fields<'_>,
    element: &str,
    sink: &mut Sink,
) -> Option<Located<String>> {
    let name = fields.required("name", sink)?.text(sink)?;
    if name.value.is_empty() || name.value == WORLD {
        let message = format!("{}`name` may not be {:?}", fields.owner(), name.value);
        sink.push(Diagnostic::new(name.span, message));
        return None;
    }
    fields.set_owner(format!("{element} `{}`: ", name.value));
    Some(name)
}

fn spring(fields: &mut Fields<'_>, bodies: &Bodies<'_>, sink: &mut Sink) -> Option<PointSpring> {
    let from = end(fields, "from", bodies, sink);
    let to = end(fields, "to", bodies, sink);
    let stiffness = fields.required("stiffness", sink);
    let stiffness = stiffness.and_then(|stiffness| stiffness.not_negative(sink));
    let damping = not_negative(fields, "damping", sink);
    let length = not_negative(fields, "length", sink);
    let (from, to) = (from?, to?);
    if from.body == to.body {
        let message = format!("{}both ends are on the same body", fields.owner());
        sink.push(Diagnostic::new(fields.span(), message));
        return None;
    }
    Some(PointSpring {
        from,
        to,
        stiffness: stiffness?.value,
        damping: damping?,
        length: length?,
    })
}

fn end(
    fields: &mut Fields<'_>,
    key: &'static str,
    bodies: &Bodies<'_>,
    sink: &mut Sink,
) -> Option<BodyPoint> {
    let mut fields = fields.required(key, sink)?.table(sink)?;
    let body = fields.required("body", sink);
    let body = body.and_then(|body| bodies.find(&body, sink));
    let point = vector(&mut fields, "point", sink);
    fields.finish(sink);
    Some(BodyPoint {
        body: body?,
        point: point?,
    })
}

fn wrench(
    fields: &mut Fields<'_>,
    bodies: &Bodies<'_>,
    sink: &mut Sink,
) -> Option<WrenchDescription> {
    let body = fields.required("body", sink);
    let body = body.and_then(|body| bodies.find_moving(&body, "a force would not move it", sink));
    let point = vector(fields, "point", sink);
    let force = time::vector(fields, "force", sink);
    let moment = time::vector(fields, "moment", sink);
    let axes = fields.required("axes", sink);
    let axes = axes.and_then(|axes| axes.choice(&WrenchAxes::NAMES, sink));
    Some(WrenchDescription {
        body: body?,
        point: point?,
        force: force?,
        moment: moment?,
        axes: match axes? {
            "world" => WrenchAxes::World,
            _ => WrenchAxes::Body,
        },
    })
}

fn constraint(
    fields: &mut Fields<'_>,
    bodies: &Bodies<'_>,
    sink: &mut Sink,
) -> Option<ConstraintDescription> {
    let name = name(fields, "constraint", sink);
    let body = fields.required("body", sink);
    let body = body.and_then(|body| bodies.find_moving(&body, "it does not move anyway", sink));
    let point = vector(fields, "point", sink);
    let direction = fields.required("direction", sink).and_then(|direction| {
        let vector = direction.vector(sink)?;
        rotation::unit(&direction.path(), vector, sink)
    });
    Some(ConstraintDescription {
        name: name?,
        body: body?,
        point: point?,
        direction: direction?,
    })
}

/// A vector, 0 where it is absent.
pub(super) fn vector(
    fields: &mut Fields<'_>,
    key: &'static str,
    sink: &mut Sink,
) -> Option<Vector3<f64>> {
    match fields.optional(key) {
        Some(value) => Some(value.vector(sink)?.value),
        None => Some(Vector3::zeros()),
    }
}

/// A number of at least 0, 0 where it is absent.
fn not_negative(fields: &mut Fields<'_>, key: &'static str, sink: &mut Sink) -> Option<f64> {
    match fields.optional(key) {
        Some(value) => Some(value.not_negative(sink)?.value),
        None => Some(0.0),
    }
}

/// Refuses two frames, or a frame and a body, of one name; and two constraints or events of one name.
fn unique(elements: &Elements, drafts: &[BodyDraft], sink: &mut Sink) {
    let bodies = drafts.iter().filter_map(|draft| draft.name.as_ref());
    let frames = elements.frames.iter().map(|frame| &frame.name);
    let constraints = elements.constraints.iter().map(|c| &c.name);
    unique_among(bodies, frames, "frame", sink);
    unique_among([].into_iter(), constraints, "constraint", sink);
    let events = elements.events.iter().map(|event| &event.name);
    unique_among([].into_iter(), events, "event", sink);
}

fn unique_among<'a>(
    others: impl Iterator<Item = &'a Located<String>>,
    names: impl Iterator<Item = &'a Located<String>>,
    element: &str,
    sink: &mut Sink,
) {
    let mut first: HashMap<&str, &Located<String>> =
        others.map(|name| (name.value.as_str(), name)).collect();
    for name in names {
        match first.get(name.value.as_str()) {
            None => _ = first.insert(name.value.as_str(), name),
            Some(other) => {
                let message = format!("{element} `{}`: the name is taken", name.value);
                let error = Diagnostic::new(name.span.clone(), message);
                sink.push(error.context(other.span.clone(), "here"));
            }
        }
    }
}
