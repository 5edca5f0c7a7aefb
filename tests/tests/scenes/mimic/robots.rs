//! Robots with mimic joints, each beside the one whose joints all move by themselves.

use hamel::dynamics::{Dynamics, Recursive, Reference};
use hamel::mechanism::Mechanism;
use hamel::nalgebra::{DMatrix, DVector};
use hamel_scene::urdf::{self, Import};
use hamel_scene::{Scene, SceneDescription};
use std::path::Path;
use std::sync::Arc;

/// A follower, what it follows, the multiplier and the offset: as the file has them, those of a chain multiplied out.
type Law = (&'static str, &'static str, f64, f64);

/// A robot, the joint that its coupling is, and who follows whom.
pub(super) struct Robot {
    pub(super) name: &'static str,
    pub(super) joint: &'static str,
    laws: &'static [Law],
}

pub(super) const ROBOTS: [Robot; 4] = [
    Robot {
        name: "parallel_gripper",
        joint: "left",
        laws: &[("right", "left", -1.0, 0.0)],
    },
    Robot {
        name: "adaptive_gripper",
        joint: "finger_joint",
        laws: &[
            ("left_inner_knuckle_joint", "finger_joint", 1.0, 0.0),
            ("left_inner_finger_joint", "finger_joint", -1.0, 0.0),
            ("right_outer_knuckle_joint", "finger_joint", 1.0, 0.0),
            ("right_inner_knuckle_joint", "finger_joint", 1.0, 0.0),
            ("right_inner_finger_joint", "finger_joint", -1.0, 0.0),
        ],
    },
    Robot {
        name: "tendon_finger",
        joint: "knuckle",
        laws: &[
            ("pip", "knuckle", 1.1, 0.05),
            ("dip", "knuckle", 0.67 * 1.1, 0.67 * 0.05 - 0.02),
        ],
    },
    Robot {
        name: "two_limbs",
        joint: "swing+crank",
        laws: &[("rack", "crank", 0.11, 0.04)],
    },
];

impl Robot {
    pub(super) fn text(&self) -> String {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/urdf/mimic");
        let path = folder.join(format!("{}.urdf", self.name));
        std::fs::read_to_string(path).expect("a robot of the tests")
    }

    pub(super) fn import(&self) -> Import {
        read(&self.text(), self.name)
    }

    /// The robot whose joints all move by themselves.
    fn free(&self) -> Arc<Mechanism> {
        let lines = self.text();
        let lines = lines.lines().filter(|line| !line.contains("<mimic"));
        let text: Vec<&str> = lines.collect();
        build(&read(&text.join("\n"), self.name).scene).mechanism
    }

    pub(super) fn pair(&self) -> Pair {
        let coupled = build(&self.import().scene).mechanism;
        let free = self.free();
        let map = self.map(&coupled, &free);
        Pair { coupled, free, map }
    }

    /// Where a joint's first freedom stands among those of the coupled robot, and its first scalar in Q.
    fn place(&self, coupled: &Mechanism, joint: &str) -> (usize, usize) {
        let named = |name: &str| coupled.joints().find(|(_, body)| body.joint_name() == name);
        if let Some((_, body)) = named(joint) {
            let ranges = body.ranges();
            return (ranges.freedoms.start, ranges.configuration.start);
        }
        let (_, coupling) =
            named(self.joint).expect("the coupling has the name of what is followed");
        let number = self.joint.split('+').position(|name| name == joint);
        let number = number.unwrap_or_else(|| panic!("no joint {joint}"));
        let ranges = coupling.ranges();
        (
            ranges.freedoms.start + number,
            ranges.configuration.start + number,
        )
    }

    fn map(&self, coupled: &Mechanism, free: &Mechanism) -> Map {
        let (rows, columns) = (free.layout().freedoms, coupled.layout().freedoms);
        let mut map = Map {
            rates: DMatrix::zeros(rows, columns),
            scalars: DMatrix::zeros(free.layout().configuration, coupled.layout().configuration),
            offset: DVector::zeros(free.layout().configuration),
        };
        for (_, body) in free.joints() {
            let (own, ranges) = (body.joint_name(), body.ranges());
            let law = self.laws.iter().find(|(follower, ..)| *follower == own);
            let (leader, ratio, offset) = match law {
                Some((_, leader, ratio, offset)) => (*leader, *ratio, *offset),
                None => (own, 1.0, 0.0),
            };
            let (freedom, scalar) = self.place(coupled, leader);
            for (n, row) in ranges.freedoms.clone().enumerate() {
                map.rates[(row, freedom + n)] = ratio;
            }
            for (n, row) in ranges.configuration.clone().enumerate() {
                map.scalars[(row, scalar + n)] = ratio;
                map.offset[row] = offset;
            }
        }
        map
    }
}

pub(super) fn read(text: &str, name: &str) -> Import {
    let options = urdf::Options::default();
    urdf::read(text, name, &options).unwrap_or_else(|errors| panic!("{errors}"))
}

pub(super) fn build(scene: &SceneDescription) -> Scene {
    let built = scene.build(&hamel_joints::registry());
    built.unwrap_or_else(|errors| panic!("{errors}"))
}

/// How motions of the coupled robot are motions of the free one.
pub(super) struct Map {
    /// G.
    pub(super) rates: DMatrix<f64>,
    /// The same for the stored scalars of Q, with y₀.
    scalars: DMatrix<f64>,
    offset: DVector<f64>,
}

pub(super) struct Pair {
    pub(super) coupled: Arc<Mechanism>,
    pub(super) free: Arc<Mechanism>,
    pub(super) map: Map,
}

/// Numbers in waves, another for each seed.
pub(super) fn numbers(count: usize, seed: u32) -> Vec<f64> {
    let phase = 0.3 + 1.9 * f64::from(seed);
    (0..count).map(|i| (1.7 * i as f64 + phase).sin()).collect()
}

impl Pair {
    pub(super) fn configuration(&self, seed: u32) -> Vec<f64> {
        let phi = numbers(self.coupled.layout().freedoms, seed);
        let joints = self.coupled.joints();
        let q = joints.flat_map(|(index, body)| {
            let own = &phi[body.ranges().freedoms.clone()];
            self.coupled
                .configuration_from_local(index, own)
                .expect("finite")
        });
        q.collect()
    }

    pub(super) fn of_free(&self, q: &[f64]) -> DVector<f64> {
        &self.map.scalars * DVector::from_column_slice(q) + &self.map.offset
    }

    pub(super) fn forms(&self) -> [Box<dyn Dynamics>; 2] {
        [
            Box::new(Recursive::new(Arc::clone(&self.coupled))),
            Box::new(Reference::new(Arc::clone(&self.coupled))),
        ]
    }
}
