//! Where each body's share lies in the arguments, for the header.

use crate::model::Model;
use crate::products::JointType;
use hamel_codegen::derived::Derived;
use hamel_codegen::emit::report::units::{of_coordinates, of_efforts, of_speed_rates};
use hamel_codegen::model::VelocityFrame;
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
    /// Whether it stands for its joint; what follows is that of the joint.
    leads: bool,
    /// In which axes v is read; empty where it is the rates of what is stored.
    axes: &'static str,
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
            leads: body.leads(),
            axes: axes(&body.joint.derived),
            configuration: part(share.configuration, stored(&body.joint)),
            freedoms: part(share.freedoms, efforts(&body.joint.derived)),
            speeds: part(share.speeds, speeds(&body.joint.derived)),
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

fn axes(derived: &Derived) -> &'static str {
    match derived.spec.velocity.value {
        VelocityFrame::Child => "of the joint's child frame",
        VelocityFrame::Parent => "of the joint's parent frame",
        VelocityFrame::Rates => "",
    }
}

/// Stored scalars with their units: those of matrices, quaternions and unit vectors, which are numbers, stand without. Those of several joints of the scene in one say which they
/// move.
fn stored(joint: &JointType) -> Vec<String> {
    let derived = &joint.derived;
    let coordinates = derived.space.manifold.coordinates();
    let units = of_coordinates(derived).into_iter();
    let units = units.map(|unit| if unit == "1" { String::new() } else { unit });
    let scalars = coordinates.iter().zip(units).enumerate();
    scalars
        .map(|(k, (symbol, unit))| {
            named(symbol.name(), &unit) + &moved_by(joint, (k, symbol.name()))
        })
        .collect()
}

/// `` of `elbow` and `wrist` (which is 0.5 q + 0.1) ``; nothing where the scene gives the joint as it is.
fn moved_by(joint: &JointType, (coordinate, symbol): (usize, &str)) -> String {
    let Some(linkage) = &joint.linkage else {
        return String::new();
    };
    let joints = linkage.moved_by(coordinate).map(|(name, line)| {
        let name = one_line(name);
        match line {
            [1.0, 0.0] => format!("`{name}`"),
            [ratio, offset] => format!("`{name}` (which is {})", of_line(symbol, ratio, offset)),
        }
    });
    format!(" of {}", joints.collect::<Vec<_>>().join(" and "))
}

/// `-1.7 q + 0.4`.
fn of_line(symbol: &str, ratio: f64, offset: f64) -> String {
    let scaled = match ratio {
        1.0 => symbol.to_owned(),
        -1.0 => format!("-{symbol}"),
        _ => format!("{ratio} {symbol}"),
    };
    match offset {
        0.0 => scaled,
        0.0.. => format!("{scaled} + {offset}"),
        _ => format!("{scaled} - {}", -offset),
    }
}

/// Efforts do work with velocities.
fn efforts(derived: &Derived) -> Vec<String> {
    let freedoms = derived.spec.freedoms.value.iter();
    let freedoms = freedoms.zip(of_efforts(derived));
    freedoms
        .map(|(freedom, unit)| named(&freedom.name, &unit))
        .collect()
}

fn speeds(derived: &Derived) -> Vec<String> {
    let speeds = derived.speed_names.iter().zip(of_speed_rates(derived));
    speeds.map(|(name, unit)| named(name, &unit)).collect()
}

/// `turn (rad/s)`.
fn named(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => format!("{name} ({unit})"),
    }
}
