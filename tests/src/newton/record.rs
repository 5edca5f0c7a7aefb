//! What is told of a state: the motion of each body, as the references of the project write it.

use super::number::{Matrix, Real, Vector, decimal, real};
use super::system::System;

/// The motion of one body.
#[derive(Clone, Debug)]
pub struct BodyRecord {
    /// Of the centre of mass, world axes, m.
    pub position: Vector,
    /// Body to world.
    pub rotation: Matrix,
    /// Of the centre of mass, world axes, m/s.
    pub velocity: Vector,
    /// Body axes, rad/s.
    pub rate: Vector,
}

/// The motion of all bodies at one time.
#[derive(Clone, Debug)]
pub struct Record {
    /// s.
    pub time: f64,
    /// In the order of the scene.
    pub bodies: Vec<BodyRecord>,
}

impl Record {
    /// The record of a state.
    pub fn new(system: &System, time: f64, state: &[Real]) -> Self {
        let bodies = system.motions(state).into_iter().map(|motion| BodyRecord {
            position: motion.position,
            rotation: motion.rotation,
            velocity: motion.velocity,
            rate: motion.rate,
        });
        Self {
            time,
            bodies: bodies.collect(),
        }
    }

    /// As an entry of `samples` of a reference.
    pub fn json(&self) -> String {
        let bodies: Vec<String> = self.bodies.iter().map(BodyRecord::json).collect();
        format!(
            "    {{\n      \"t\": {:?},\n      \"bodies\": [\n{}\n      ]\n    }}",
            self.time,
            bodies.join(",\n")
        )
    }
}

fn list<'a>(values: impl IntoIterator<Item = &'a Real>) -> String {
    let written: Vec<String> = values.into_iter().map(|&value| decimal(value)).collect();
    format!("[{}]", written.join(", "))
}

impl BodyRecord {
    fn json(&self) -> String {
        format!(
            "        {{\n          \"position_com\": {},\n          \"rotation_body_to_world_rowmajor\": {},\n          \
             \"velocity_com_world\": {},\n          \"angular_velocity_body\": {}\n        }}",
            list(&self.position),
            list(&self.rotation.transpose()),
            list(&self.velocity),
            list(&self.rate)
        )
    }
}

/// How far two records of one motion are apart: the largest over bodies of attitude (rad), position, velocity and angular velocity, each relative to
/// max(1, size).
pub fn distance(a: &Record, b: &Record) -> f64 {
    let part = |x: &Vector, y: &Vector| {
        let gap = f64::from((x - y).dot(&(x - y)).sqrt());
        gap / f64::from(y.dot(y).sqrt()).max(1.0)
    };
    let bodies = a.bodies.iter().zip(&b.bodies).flat_map(|(a, b)| {
        [
            angle(&a.rotation, &b.rotation),
            part(&a.position, &b.position),
            part(&a.velocity, &b.velocity),
            part(&a.rate, &b.rate),
        ]
    });
    bodies.fold(0.0, |m, x| if x <= m { m } else { x })
}

/// The angle between two attitudes, from the sine of its half, which is exact where it is small.
fn angle(a: &Matrix, b: &Matrix) -> f64 {
    let gap = a - b;
    let square = gap.iter().fold(real(0.0), |sum, &x| sum + x * x);
    // |A − B|² = 8 sin²(angle/2) in Frobenius' norm.
    let sine = f64::from((square / real(8.0)).sqrt());
    2.0 * sine.min(1.0).asin()
}
