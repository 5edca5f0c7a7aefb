//! The data of a page about the mechanism and the run, as JSON.

use super::charts::Chart;
use super::solids::{Ellipsoid, Shape};
use super::triangles::Triangles;
use crate::meshes::Meshes;
use crate::sample::seven;
use hamel::mechanism::Body;
use hamel::scene::Scene;
use hamel::scene::text::visible;
use serde::Serialize;

/// Everything but the recorded numbers. All in SI units; poses are x, y, z and a quaternion x, y, z, w.
#[derive(Debug, Serialize)]
pub struct Header<'a> {
    /// Version of this layout.
    version: u32,
    /// Name of the scene.
    pub name: &'a str,
    description: String,
    /// How the motion was found, in words.
    method: &'a str,
    gravity: [f64; 3],
    /// Number of frames.
    frames: usize,
    bodies: Vec<BodyHeader<'a>>,
    shapes: Vec<Shape>,
    /// What shapes that are meshes show.
    meshes: Vec<Triangles>,
    /// Named frames.
    marks: Vec<Mark<'a>>,
    charts: Vec<Chart>,
}

#[derive(Debug, Serialize)]
struct BodyHeader<'a> {
    name: &'a str,
    parent: Option<usize>,
    joint: &'a str,
    joint_type: &'static str,
    freedoms: usize,
    mass: f64,
    com: [f64; 3],
    ellipsoid: Option<Ellipsoid>,
    /// The joint's parent frame in the parent's body frame.
    joint_in_parent: [f64; 7],
    /// The joint's child frame in the body frame.
    joint_in_body: [f64; 7],
}

/// A named frame.
#[derive(Debug, Serialize)]
struct Mark<'a> {
    name: &'a str,
    body: Option<usize>,
    pose: [f64; 7],
}

impl<'a> Header<'a> {
    /// What there is to tell of a motion of `scene`: the number of its frames, how it was found, and its charts.
    pub fn new(
        scene: &'a Scene,
        (frames, method): (usize, &'a str),
        meshes: &Meshes,
        charts: Vec<Chart>,
    ) -> Self {
        let shapes = scene.shapes.iter();
        let marks = scene.mechanism.frames().iter().map(|frame| Mark {
            name: &frame.name,
            body: frame.body,
            pose: seven(&frame.at),
        });
        Self {
            version: 3,
            name: &scene.name,
            description: visible(&scene.description),
            method,
            gravity: (*scene.mechanism.gravity()).into(),
            frames,
            bodies: scene
                .mechanism
                .bodies()
                .iter()
                .map(BodyHeader::new)
                .collect(),
            shapes: shapes.flat_map(|shape| Shape::of(shape, meshes)).collect(),
            meshes: meshes.parts().iter().map(Triangles::from).collect(),
            marks: marks.collect(),
            charts,
        }
    }
}

impl<'a> BodyHeader<'a> {
    fn new(body: &'a Body) -> Self {
        let mass = body.mass();
        Self {
            name: body.name(),
            parent: body.parent(),
            joint: body.joint_name(),
            joint_type: body.joint().name(),
            freedoms: body.joint().layout().freedoms,
            mass: mass.mass,
            com: mass.com.into(),
            ellipsoid: Ellipsoid::new(mass),
            joint_in_parent: seven(body.placement()),
            joint_in_body: seven(&body.child_placement().inverse()),
        }
    }
}
