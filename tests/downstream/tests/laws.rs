//! The law suite of the library's joints over this crate's: general Φ, declared manifolds, subgroups.

use hamel_downstream::joints::{
    BallCayley, BallTurns, Bead, Catenary, CatenaryLength, DirectionSensor, ENTRIES, PlanarTurns,
    PowerGuide, RollingBallCayley, Scara, SkateHeading, SkewScrew, SpherePoint,
};
use hamel_tests::laws::Reach::{self, Entries, HalfTurn};
use hamel_tests::laws::check_within;
use hamel_tests::laws::search::{Effort, check_everywhere};
use std::path::Path;

/// Two tests a joint, and the list of those that have them.
macro_rules! law_tests {
    ($($name:ident: $joint:ident $(::new($($value:expr),*))?, $reach:expr;)*) => {
        const TESTED: &[&str] = &[$(stringify!($name)),*];
        $(
            #[test]
            fn $name() {
                let reach: Reach = $reach;
                check_within(&$joint $(::new($($value),*))?, reach);
            }
        )*
        mod everywhere {
            use super::*;
            $(
                #[test]
                fn $name() {
                    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("joints");
                    let derived = hamel_tests::derived_in(&folder, stringify!($name));
                    let build = |_values: &[f64]| {
                        let _values = &mut _values.iter().copied().chain(std::iter::repeat(f64::NAN));
                        $joint $(::new($({
                            let _: f64 = $value;
                            _values.next().unwrap_or(f64::NAN)
                        }),*))?
                    };
                    check_everywhere(&derived, build, &[$($($value),*)?], Effort::PLAIN);
                }
            )*
        }
    };
}

// Products of exponentials take values twice where their first and last axes align; roots and logarithms end at their
// exceptions, a metre or more from the configurations of the suite.
law_tests! {
    ball_cayley: BallCayley, HalfTurn;
    ball_turns: BallTurns, Entries(0.5);
    bead: Bead::new(0.7), HalfTurn;
    catenary: Catenary::new(0.7), HalfTurn;
    catenary_length: CatenaryLength::new(0.7), HalfTurn;
    direction_sensor: DirectionSensor::new(0.7), Entries(1.0);
    motor_platform: MotorPlatform, HalfTurn;
    planar_turns: PlanarTurns, HalfTurn;
    power_guide: PowerGuide::new(0.7), Entries(1.0);
    rolling_ball_cayley: RollingBallCayley::new(0.7), HalfTurn;
    scara: Scara, HalfTurn;
    skate_heading: SkateHeading, Entries(1.0);
    skew_screw: SkewScrew, HalfTurn;
    sphere_point: SpherePoint::new(0.7), Entries(1.0);
}

#[test]
fn every_joint_has_a_test() {
    let names: Vec<&str> = ENTRIES.iter().map(|entry| entry.name).collect();
    assert_eq!(names, TESTED);
}
