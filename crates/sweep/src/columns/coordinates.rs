//! Configurations of joints in the quantities that people read: angles, displacements, positions and quaternions.
//!
//! A joint tells the names of its stored scalars and not of which manifold they are. The generator names those of a group by a
//! pattern; that the joint's projection scales them back to their group makes sure of it.

use super::attitude::{quaternion, unit_quaternion};
use hamel::erased::AnyJoint;
use hamel::joint::Unit;
use nalgebra::Matrix3;

/// A part of Q.
#[derive(Clone, Debug)]
pub struct Factor {
    /// What it is.
    pub kind: Kind,
    /// What its names begin with.
    pub stem: String,
    /// Place of its first scalar in Q.
    pub first: usize,
}

/// What a part of Q is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One scalar of a real vector, or of a manifold that is not known here.
    Scalar,
    /// A point of a circle.
    S1,
    /// A rotation of the plane.
    So2,
    /// A motion of the plane.
    Se2,
    /// A unit vector.
    S2,
    /// A unit quaternion.
    S3,
    /// A rotation.
    So3,
    /// A motion.
    Se3,
}

/// How names of the stored scalars end. One list may begin with another: the longer stands first.
const ENDS: [(Kind, &[&str]); 7] = [
    (
        Kind::Se3,
        &[
            "q11", "q12", "q13", "q14", "q21", "q22", "q23", "q24", "q31", "q32", "q33", "q34",
        ],
    ),
    (
        Kind::So3,
        &[
            "q11", "q12", "q13", "q21", "q22", "q23", "q31", "q32", "q33",
        ],
    ),
    (Kind::Se2, &["q11", "q12", "q13", "q21", "q22", "q23"]),
    (Kind::So2, &["q11", "q12", "q21", "q22"]),
    (Kind::S3, &["_w", "_x", "_y", "_z"]),
    (Kind::S2, &["_x", "_y", "_z"]),
    (Kind::S1, &["_c", "_s"]),
];

/// How far off unit length a part is brought to see whether it is projected.
const OFF: f64 = 1e-3;

impl Kind {
    /// Number of stored scalars.
    pub fn size(self) -> usize {
        let ends = ENDS.iter().find(|(kind, _)| *kind == self);
        ends.map_or(1, |(_, ends)| ends.len())
    }

    /// Whether the stored scalar `place` is part of an attitude, and not of a displacement.
    pub const fn turns(self, place: usize) -> bool {
        match self {
            Self::Scalar => false,
            Self::Se2 => place % 3 != 2,
            Self::Se3 => place % 4 != 3,
            _ => true,
        }
    }

    /// Where cosine and sine of its angle are stored, if it has one.
    pub const fn turn(self) -> Option<(usize, usize)> {
        match self {
            Self::S1 => Some((0, 1)),
            Self::So2 => Some((0, 2)),
            Self::Se2 => Some((0, 3)),
            _ => None,
        }
    }

    /// Names and units of the quantities that it is reported in; those of a scalar are the joint's.
    pub const fn quantities(self) -> &'static [(&'static str, Unit)] {
        const ANGLE: Unit = Unit::ANGLE;
        const LENGTH: Unit = Unit::LENGTH;
        const NUMBER: Unit = Unit::NUMBER;
        match self {
            Self::Scalar => &[],
            Self::S1 | Self::So2 => &[("angle", ANGLE)],
            Self::Se2 => &[("angle", ANGLE), ("x", LENGTH), ("y", LENGTH)],
            Self::S2 => &[("x", NUMBER), ("y", NUMBER), ("z", NUMBER)],
            Self::S3 | Self::So3 => &[
                ("qx", NUMBER),
                ("qy", NUMBER),
                ("qz", NUMBER),
                ("qw", NUMBER),
            ],
            Self::Se3 => &[
                ("x", LENGTH),
                ("y", LENGTH),
                ("z", LENGTH),
                ("qx", NUMBER),
                ("qy", NUMBER),
                ("qz", NUMBER),
                ("qw", NUMBER),
            ],
        }
    }
}

impl Factor {
    /// The parts of a joint's Q, in their order.
    pub fn all(joint: &dyn AnyJoint) -> Vec<Self> {
        let names = joint.coordinates();
        let mut factors = Vec::new();
        let mut first = 0;
        while first < names.len() {
            let factor = ENDS.iter().find_map(|(kind, ends)| {
                let stem = stem(&names[first..], ends)?.to_owned();
                let factor = Self {
                    kind: *kind,
                    stem,
                    first,
                };
                factor.is_projected(joint).then_some(factor)
            });
            let factor = factor.unwrap_or_else(|| Self {
                kind: Kind::Scalar,
                stem: names[first].to_owned(),
                first,
            });
            first += factor.kind.size();
            factors.push(factor);
        }
        factors
    }

    /// Whether the joint brings the part back to unit length, from a little off it: projections are for what rounding leaves.
    fn is_projected(&self, joint: &dyn AnyJoint) -> bool {
        let mut home = vec![0.0; joint.layout().configuration];
        joint.home(&mut home);
        let mut scaled = home.clone();
        for place in (0..self.kind.size()).filter(|&place| self.kind.turns(place)) {
            scaled[self.first + place] *= 1.0 + OFF;
        }
        let is_projected = joint.project(&mut scaled).is_ok();
        let mut pairs = home.iter().zip(&scaled);
        is_projected && pairs.all(|(home, scaled)| (home - scaled).abs() < OFF * OFF * 10.0)
    }

    /// Appends its quantities at a joint's `q`; `angle` is that of [`Kind::turn`].
    pub fn read(&self, q: &[f64], angle: f64, row: &mut Vec<f64>) {
        let stored = &q[self.first..self.first + self.kind.size()];
        match (self.kind, stored) {
            (Kind::S1 | Kind::So2, _) => row.push(angle),
            (Kind::Se2, [_, _, x, _, _, y]) => row.extend([angle, *x, *y]),
            (Kind::S3, &[w, x, y, z]) => row.extend(unit_quaternion([x, y, z, w])),
            (Kind::So3, rows) => row.extend(quaternion(&Matrix3::from_row_slice(rows))),
            (Kind::Se3, &[a, b, c, x, d, e, f, y, g, h, i, z]) => {
                row.extend([x, y, z]);
                row.extend(quaternion(&Matrix3::new(a, b, c, d, e, f, g, h, i)));
            }
            (_, stored) => row.extend(stored),
        }
    }
}

/// What all names begin with that end so.
fn stem<'n>(names: &[&'n str], ends: &[&str]) -> Option<&'n str> {
    let named = names.get(..ends.len())?.iter().zip(ends);
    let mut stems = named.map(|(name, end)| name.strip_suffix(end));
    let first = stems.next()??;
    stems.all(|stem| stem == Some(first)).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::{Factor, Kind};
    use hamel::erased::AnyJoint;
    use hamel::joint::Unit;
    use std::sync::Arc;

    /// A joint of the library; parameters from 0.2 to 1.2 are tried until they meet its requirements.
    fn joint(name: &str) -> Arc<dyn AnyJoint> {
        let joints = hamel::joints::registry();
        let entry = joints.get(name).expect("a joint of the library");
        // An additive recurrence fills every dimension evenly; its steps are rationally independent.
        let steps = [2.0_f64, 3.0, 5.0, 7.0, 11.0, 13.0].map(f64::sqrt);
        let steps = &steps[..entry.parameters.len()];
        let mut tries = (1..=1000).map(|count| {
            let values = steps
                .iter()
                .map(|step| 0.2 + (f64::from(count) * step).fract());
            (entry.build)(&values.collect::<Vec<_>>())
        });
        let found = tries.find_map(Result::ok);
        found.expect("parameters that meet the requirements")
    }

    fn kinds(name: &str) -> Vec<Kind> {
        let factors = Factor::all(&*joint(name));
        factors.iter().map(|factor| factor.kind).collect()
    }

    #[test]
    fn configurations_of_the_library_are_known() {
        for (name, wanted) in [
            ("revolute", &[Kind::Scalar][..]),
            ("revolute_circle", &[Kind::S1]),
            ("ellipse", &[Kind::S1]),
            ("torus", &[Kind::S1, Kind::S1]),
            ("planar", &[Kind::Se2]),
            ("upright_wheel", &[Kind::Se2, Kind::Scalar]),
            ("ball_quaternion", &[Kind::S3]),
            ("ball", &[Kind::So3]),
            ("pointing", &[Kind::So3]),
            ("falling_disk", &[Kind::So3, Kind::Scalar, Kind::Scalar]),
            ("free", &[Kind::Se3]),
            ("gimbal", &[Kind::Scalar; 3]),
        ] {
            assert_eq!(kinds(name), wanted, "{name}");
        }
    }

    #[test]
    fn units_are_those_of_the_pages() {
        let units = |name: &str| joint(name).units();
        let (angle, length) = (Unit::ANGLE, Unit::LENGTH);
        assert_eq!(units("ellipse").freedoms, [angle]);
        assert_eq!(units("screw").velocities, [angle]);
        assert_eq!(units("cylindrical").coordinates, [angle, length]);
        assert_eq!(units("cart").speeds, [angle, length]);
        assert_eq!(units("falling_disk").speeds, [angle; 3]);
        assert_eq!(units("rail").coordinates, [length]);
        assert_eq!(units("rail").speeds, [length]);
        // v moves the links by products of two lengths.
        let four_bar = Unit::new("1/m^2", "1/(m^2 s)", "N m^3");
        assert_eq!(units("four_bar").velocities, [four_bar]);
        let wheel = units("upright_wheel");
        assert_eq!(wheel.freedoms, [angle, length, length, angle]);
        assert_eq!(wheel.speeds, [angle, angle]);
        for entry in hamel::joints::registry().entries() {
            let found = units(entry.name);
            let all = [
                found.coordinates,
                found.freedoms,
                found.velocities,
                found.speeds,
            ];
            let all = all.concat();
            assert!(!all.contains(&Unit::UNKNOWN), "{}: {found:?}", entry.name);
        }
    }
}
