//! Where each body's share lies in the arguments, for the header.

use crate::model::{Body, Model};
use hamel_codegen::text::one_line;
use serde::Serialize;
use std::ops::Range;

/// One body, its parts as text.
#[derive(Serialize)]
pub struct Share {
    index: usize,
    body: String,
    joint: String,
    /// Its type.
    joint_type: String,
    is_driven: bool,
    configuration: Part,
    freedoms: Part,
    speeds: Part,
}

/// Entries of an argument.
#[derive(Serialize)]
struct Part {
    /// `[2 .. 4]`, or `[2]`; empty where there are none.
    entries: String,
    names: Vec<String>,
}

/// The shares of all bodies.
pub fn layout(model: &Model) -> Vec<Share> {
    let shares = model.shares().into_iter();
    let bodies = model.bodies.iter().zip(shares).enumerate();
    bodies
        .map(|(index, (body, share))| Share {
            index,
            body: one_line(&body.name),
            joint: one_line(&body.joint_name),
            joint_type: one_line(&body.joint.derived.spec.name.value),
            is_driven: body.driven,
            configuration: part(share.configuration, stored(body)),
            freedoms: part(share.freedoms, freedoms(body)),
            speeds: part(share.speeds, body.joint.derived.speed_names.clone()),
        })
        .collect()
}

fn part(range: Range<usize>, names: Vec<String>) -> Part {
    let entries = match range.len() {
        0 => String::new(),
        1 => format!("[{}]", range.start),
        _ => format!("[{} .. {}]", range.start, range.end - 1),
    };
    Part { entries, names }
}

fn stored(body: &Body) -> Vec<String> {
    let coordinates = body.joint.derived.space.manifold.coordinates();
    coordinates
        .iter()
        .map(|symbol| symbol.name.to_string())
        .collect()
}

fn freedoms(body: &Body) -> Vec<String> {
    let freedoms = body.joint.derived.spec.freedoms.value.iter();
    freedoms.map(|freedom| freedom.name.clone()).collect()
}
