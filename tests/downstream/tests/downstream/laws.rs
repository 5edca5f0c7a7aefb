//! The law suite of the library's joints over this crate's: general Φ, declared manifolds, subgroups.

use hamel::joint::Member;
use hamel_downstream::joints::{
    BallCayley, BallTurns, Bead, CamCircle, CarWheels, Catenary, CatenaryLength, CrankCoupler,
    CrankRocker, Delta, DirectionSensor, FiveBarLeft, FiveBarRods, FixedAxis, FourBarThrough,
    GearedRotor, MeasuredRocker, PlanarTurns, PowerGuide, Press, Rollers, RollingBallCayley, Scara,
    SkateHeading, SkewScrew, SliderCrankLinks, SliderCrankRod, SpherePoint, Stewart, ThreeRrr,
    Unpinned, Valley,
};
use hamel_tests::laws::Reach::{self, Around, Entries, HalfTurn};
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
    cam_circle: CamCircle::new(0.7), HalfTurn;
    catenary: Catenary::new(0.7), HalfTurn;
    catenary_length: CatenaryLength::new(0.7), HalfTurn;
    direction_sensor: DirectionSensor::new(0.7), Entries(1.0);
    fixed_axis: FixedAxis::new(0.6, 0.7), HalfTurn;
    measured_rocker: MeasuredRocker, Entries(1.0);
    planar_turns: PlanarTurns, HalfTurn;
    power_guide: PowerGuide::new(0.7), Entries(1.0);
    rolling_ball_cayley: RollingBallCayley::new(0.7), HalfTurn;
    scara: Scara, HalfTurn;
    skate_heading: SkateHeading, Entries(1.0);
    skew_screw: SkewScrew, HalfTurn;
    sphere_point: SpherePoint::new(0.7), Entries(1.0);
    valley: Valley, HalfTurn;
}

/// The law suite of joints that relations alone give. Definitions in high precision know Φ as a formula, which these have not.
macro_rules! laws_by_relations {
    ($($name:ident: $joint:expr;)*) => {
        const BY_RELATIONS: &[&str] = &[$(stringify!($name)),*];
        $(
            #[test]
            fn $name() {
                check_within(&$joint, Entries(0.5));
            }
        )*
    };
}

laws_by_relations! {
    crank_coupler: CrankCoupler::new(0.9, 0.4, 1.1, 1.2);
    four_bar_through: FourBarThrough;
    slider_crank_rod: SliderCrankRod;
}

/// The law suite of joints that carry several bodies: of the joint as each of them sees it. The first is the joint itself.
macro_rules! laws_of_bodies {
    ($($name:ident: $joint:expr, $reach:expr, [$($body:literal),*];)*) => {
        const OF_BODIES: &[&str] = &[$(stringify!($name)),*];
        $(
            #[test]
            fn $name() {
                let joint = $joint;
                check_within(&joint, $reach);
                $(check_within(&Member::<_, $body>(joint), $reach);)*
                assert_eq!(bodies_of(stringify!($name)), [0, $($body),*]);
            }
        )*
    };
}

laws_of_bodies! {
    car_wheels: CarWheels::new(1.1, 0.7, 0.4), Entries(0.5), [1, 2, 3, 4];
    crank_rocker: CrankRocker::new(0.9, 0.4, 1.1, 1.2), Entries(0.5), [1, 2];
    delta: Delta::new(0.2, 0.35, 0.74), Around(0.05), [1, 2, 3];
    five_bar_left: FiveBarLeft::new(0.3, 0.2, 0.3, 0.22, 0.28), Around(0.1), [1, 2, 3];
    five_bar_rods: FiveBarRods::new(0.3, 0.2, 0.3, 0.22, 0.28), Around(0.1), [1, 2, 3];
    geared_rotor: GearedRotor::new(5.5), Entries(0.5), [1];
    press: Press::new(0.4, 1.1), Entries(0.5), [1, 2];
    stewart: Stewart::new(0.7, 0.4), Around(0.2), [];
    three_rrr: ThreeRrr::new(0.9, 0.3, 0.5, 0.3), Around(0.05), [1, 2, 3];
    rollers: Rollers::new(0.3), Entries(0.5), [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];
    slider_crank_links: SliderCrankLinks::new(1.1, 0.4, 0.2), Entries(0.5), [1, 2];
    unpinned: Unpinned::new(0.7), Entries(0.5), [1];
}

/// What is emitted of the second body, against the definition of a joint with that body alone.
#[test]
fn a_further_body_has_its_definition_everywhere() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("joints");
    let derived = hamel_tests::derived_in(&folder, "geared_rotor");
    let build = |values: &[f64]| Member::<_, 1>(GearedRotor::new(values[0]));
    check_everywhere(&derived, build, &[5.5], Effort::PLAIN);
}

/// The places of the bodies that the spec of a joint names.
fn bodies_of(name: &str) -> Vec<usize> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("joints");
    let derived = hamel_tests::derived_in(&folder, name);
    derived.bodies().map(|body| body.body).collect()
}

#[test]
fn every_joint_has_a_test() {
    let entries = hamel_downstream::entries();
    let names: Vec<&str> = entries.iter().map(|entry| entry.name).collect();
    let mut tested = [TESTED, BY_RELATIONS, OF_BODIES].concat();
    tested.sort_unstable();
    assert_eq!(names, tested);
}
