//! What is reported of the mechanism, of each body and of each named frame.

use super::{Ending, suffix};
use hamel::mechanism::{BodyState, Kinematics};
use hamel::spatial::Pose;
use hamel_sweep::columns::quaternion;

/// A vector of numbers, read from an `S`.
pub struct Part<S> {
    /// Its key in JSON.
    pub key: &'static str,
    /// Names of its entries in CSV and Parquet, without unit.
    pub names: &'static [&'static str],
    /// Unit of all of them.
    pub unit: &'static str,
    /// What it is, in which axes.
    pub meaning: &'static str,
    /// Appends the numbers.
    pub read: fn(&S, &mut Vec<f64>),
}

/// Names of the entries of a unit quaternion: scalar last, as in URDF, ROS and SciPy.
const QUATERNION: &[&str] = &["qx", "qy", "qz", "qw"];

/// The mechanism as a whole.
pub struct Whole {
    time: f64,
    kinetic_energy: f64,
    potential_energy: f64,
    energy: f64,
}

impl Whole {
    /// At the time of `kinematics`.
    pub fn new(time: f64, kinematics: &Kinematics) -> Self {
        Self {
            time,
            kinetic_energy: kinematics.kinetic_energy(),
            potential_energy: kinematics.potential_energy(),
            energy: kinematics.energy(),
        }
    }
}

/// Of the mechanism.
pub const MECHANISM: [Part<Whole>; 4] = [
    Part {
        key: "t",
        names: &["t"],
        unit: "s",
        meaning: "time",
        read: |whole, row| row.push(whole.time),
    },
    Part {
        key: "energy",
        names: &["energy"],
        unit: "J",
        meaning: "kinetic and potential energy, of gravity and of springs",
        read: |whole, row| row.push(whole.energy),
    },
    Part {
        key: "kinetic_energy",
        names: &["kinetic_energy"],
        unit: "J",
        meaning: "kinetic energy of the bodies",
        read: |whole, row| row.push(whole.kinetic_energy),
    },
    Part {
        key: "potential_energy",
        names: &["potential_energy"],
        unit: "J",
        meaning: "potential energy, of gravity (zero at the world's origin) and of springs",
        read: |whole, row| row.push(whole.potential_energy),
    },
];

/// Of a body.
pub const BODY: [Part<BodyState>; 4] = [
    Part {
        key: "position_com",
        names: &["x", "y", "z"],
        unit: "m",
        meaning: "position of the centre of mass, world axes",
        read: |state, row| row.extend(state.position_com.iter()),
    },
    Part {
        key: "quaternion_body_to_world_xyzw",
        names: QUATERNION,
        unit: "1",
        meaning: "attitude as unit quaternion, body axes to world axes, scalar last and not negative",
        read: |state, row| row.extend(quaternion(&state.pose.rotation)),
    },
    Part {
        key: "velocity_com_world",
        names: &["vx", "vy", "vz"],
        unit: "m/s",
        meaning: "velocity of the centre of mass, world axes",
        read: |state, row| row.extend(state.velocity_com.iter()),
    },
    Part {
        key: "angular_velocity_body",
        names: &["wx", "wy", "wz"],
        unit: "rad/s",
        meaning: "angular velocity relative to the world, body axes",
        read: |state, row| row.extend(state.angular_velocity_body().iter()),
    },
];

/// Of a named frame.
pub const FRAME: [Part<Pose<f64>>; 2] = [
    Part {
        key: "position",
        names: &["x", "y", "z"],
        unit: "m",
        meaning: "origin of the frame, world axes",
        read: |pose, row| row.extend(pose.translation.iter()),
    },
    Part {
        key: "quaternion_frame_to_world_xyzw",
        names: QUATERNION,
        unit: "1",
        meaning: "attitude as unit quaternion, frame axes to world axes, scalar last and not negative",
        read: |pose, row| row.extend(quaternion(&pose.rotation)),
    },
];

impl<S> Part<S> {
    /// Its columns.
    pub(super) fn endings(&self) -> Vec<Ending> {
        let ending = |name: &&str| Ending {
            name: (*name).to_owned(),
            unit: self.unit,
            meaning: self.meaning.to_owned(),
        };
        self.names.iter().map(ending).collect()
    }
}

/// Ends of the names of all columns of some parts.
pub(super) fn ends<S>(parts: &[Part<S>]) -> Vec<String> {
    let ends = |part: &Part<S>| {
        let unit = suffix(part.unit);
        let named = part.names.iter();
        named
            .map(|name| format!("{name}{unit}"))
            .collect::<Vec<_>>()
    };
    parts.iter().flat_map(ends).collect()
}
