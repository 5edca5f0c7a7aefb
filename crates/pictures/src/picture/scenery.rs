//! What a picture shows of a scene: forms on bodies, and rods where a body has none.

use super::Instant;
use super::colors::{self, Color};
use super::solid::{Form, Solid, from_axis};
use super::view::Ball;
use crate::meshes::Meshes;
use crate::page::Ellipsoid;
use hamel::mechanism::Mechanism;
use hamel::scene::{Geometry, Scene, ShapeDescription};
use hamel::spatial::Pose;
use nalgebra::{Matrix3, Vector3};

/// A form fixed to a body, or to the world.
#[derive(Debug)]
struct Fixed<'a> {
    body: Option<usize>,
    at: Pose<f64>,
    form: Form<'a>,
    color: Color,
}

/// A point of a body, or of the world.
type Point = (Option<usize>, Vector3<f64>);

/// All that a picture shows.
#[derive(Debug)]
pub struct Scenery<'a> {
    fixed: Vec<Fixed<'a>>,
    rods: Vec<[Point; 2]>,
    joints: Vec<Point>,
    /// Corners around round solids.
    around: usize,
    pub up: Vector3<f64>,
}

impl<'a> Scenery<'a> {
    /// Of a scene, with those of its meshes.
    pub fn new(scene: &Scene, meshes: &'a Meshes) -> Self {
        let mechanism = &scene.mechanism;
        let bodies = mechanism.bodies();
        let shapes = scene.shapes.iter();
        let mut fixed: Vec<Fixed<'_>> = shapes.flat_map(|shape| of_shape(shape, meshes)).collect();
        let is_bare = |body: &usize| fixed.iter().all(|fixed| fixed.body != Some(*body));
        let bare: Vec<usize> = (0..bodies.len()).filter(is_bare).collect();
        for body in &bare {
            let ellipsoid = Ellipsoid::new(bodies[*body].mass());
            fixed.extend(ellipsoid.map(|ellipsoid| Fixed {
                body: Some(*body),
                at: ellipsoid.axes(),
                form: Form::Ellipsoid(thick(ellipsoid.half())),
                color: colors::of_body(*body),
            }));
        }
        let gravity = *mechanism.gravity();
        let (rods, joints) = match bare.is_empty() {
            true => (vec![], vec![]),
            false => rods(mechanism),
        };
        Self {
            around: match fixed.len() {
                0..=4 => 40,
                5..=8 => 24,
                9..=16 => 16,
                _ => 12,
            },
            up: (-gravity).try_normalize(0.0).unwrap_or_else(Vector3::z),
            fixed,
            rods,
            joints,
        }
    }

    /// With as many corners around as a picture of pixels has room for.
    pub fn round(self) -> Self {
        Self { around: 48, ..self }
    }

    /// Balls around all that moves at an instant.
    pub fn balls(&self, instant: &Instant) -> Vec<Ball> {
        let moving = self.fixed.iter().filter(|fixed| fixed.body.is_some());
        let balls = moving.flat_map(|fixed| {
            fixed
                .form
                .balls(&place(instant, fixed.body).compose(&fixed.at))
        });
        let joints = self.joints.iter().map(|point| (world(instant, point), 0.0));
        let balls: Vec<Ball> = balls.chain(joints).collect();
        match balls.is_empty() {
            true => vec![(Vector3::zeros(), 1.0)],
            false => balls,
        }
    }

    /// All solids at an instant, in a mechanism of that size; `is_full` also those of the world, and joints.
    pub fn solids(&self, instant: &Instant, size: f64, is_full: bool) -> Vec<Solid> {
        let shown = self
            .fixed
            .iter()
            .filter(|fixed| is_full || fixed.body.is_some());
        let mut solids: Vec<Solid> = shown
            .map(|fixed| {
                let pose = place(instant, fixed.body).compose(&fixed.at);
                fixed.form.solid(&pose, fixed.color, self.around)
            })
            .collect();
        let thick = 0.007 * size;
        let color = colors::named("rod");
        for rod in &self.rods {
            let [a, b] = [&rod[0], &rod[1]].map(|point| world(instant, point));
            let along = b - a;
            if along.norm() > thick {
                let pose = Pose::new(from_axis(&along), (a + b) / 2.0);
                solids.push(Form::Rod(thick, along.norm()).solid(&pose, color, 8));
            }
        }
        for joint in self.joints.iter().filter(|_| is_full) {
            let pose = Pose::new(Matrix3::identity(), world(instant, joint));
            let form = Form::Ellipsoid(Vector3::repeat(2.2 * thick));
            solids.push(form.solid(&pose, color, 8));
        }
        solids
    }
}

/// What stands for a shape: of a mesh its parts.
fn of_shape<'a>(shape: &ShapeDescription, meshes: &'a Meshes) -> Vec<Fixed<'a>> {
    let of_body = shape
        .body
        .map_or_else(|| colors::named("rod"), colors::of_body);
    let fixed = |form, color: Option<[u8; 3]>| Fixed {
        body: shape.body,
        at: shape.at,
        form,
        color: color.map_or(of_body, colors::bytes),
    };
    let Geometry::Mesh(mesh) = &shape.geometry else {
        return vec![fixed(Form::Shape(shape.geometry.clone()), shape.color)];
    };
    let parts = meshes.parts()[meshes.parts_of(mesh)].iter();
    parts
        .map(|part| fixed(Form::mesh(part), part.color.or(shape.color)))
        .collect()
}

/// Flat ellipsoids keep two sides.
fn thick(half: Vector3<f64>) -> Vector3<f64> {
    half.map(|axis| axis.max(0.01 * half.max()))
}

fn place(instant: &Instant, body: Option<usize>) -> Pose<f64> {
    let pose = body.and_then(|body| instant.poses.get(body));
    pose.copied().unwrap_or_else(Pose::identity)
}

fn world(instant: &Instant, point: &Point) -> Vector3<f64> {
    let pose = place(instant, point.0);
    pose.translation + pose.rotation * point.1
}

/// Rods within bodies from their joint to their centre of mass and to the next joints, and along joints that slide; and the joints.
fn rods(mechanism: &Mechanism) -> (Vec<[Point; 2]>, Vec<Point>) {
    let (mut rods, mut joints) = (vec![], vec![]);
    let bodies = mechanism.bodies();
    let own_joint = |body: usize| {
        (
            Some(body),
            bodies[body].child_placement().inverse().translation,
        )
    };
    for (index, body) in bodies.iter().enumerate() {
        let freedoms = body.joint().layout().freedoms;
        let joint = own_joint(index);
        let before = (body.parent(), body.placement().translation);
        if freedoms < 6 {
            joints.push(joint);
        }
        rods.push([joint, (Some(index), body.mass().com)]);
        rods.extend(body.parent().map(|parent| [own_joint(parent), before]));
        // How the bodies of a linkage stand to one another, its shapes may show.
        if freedoms <= 2 && body.joint().bodies().len() <= 1 {
            rods.push([before, joint]);
        }
    }
    (rods, joints)
}
