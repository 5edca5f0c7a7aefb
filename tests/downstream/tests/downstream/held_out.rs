//! The law suite over the joints that the generator's tests hold out.

use hamel_downstream::held_out::*;
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
                    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../codegen/tests/held-out");
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

// Joints with exceptions, half a turn or a radius away, take smaller steps than the others.
law_tests! {
    arcsine_crank: ArcsineCrank::new(0.3, 0.85, 0.2), HalfTurn;
    axle_wheel: AxleWheel::new(0.7, 0.85), HalfTurn;
    ball_along_bore: BallAlongBore::new(0.85, 0.3), Entries(0.5);
    ball_in_shell: BallInShell::new(0.85, 0.7), Entries(0.5);
    ball_over_cone: BallOverCone::new(0.2, 0.6), Entries(0.5);
    ball_over_sphere: BallOverSphere::new(0.85, 0.3), Around(0.4);
    bennett: Bennett::new(0.7, 0.85, 1.15), HalfTurn;
    bevel_torus: BevelTorus::new(0.85, 0.7, 1.0), HalfTurn;
    constant_velocity: ConstantVelocity, Entries(0.5);
    cycloid: Cycloid::new(0.7), Entries(0.5);
    dual_crank: DualCrank::new(0.7, 0.85), HalfTurn;
    grashof_coupler: GrashofCoupler::new(0.9, 0.4, 1.1, 1.2), HalfTurn;
    helicoid: Helicoid::new(0.7), HalfTurn;
    hyperbolic_cam: HyperbolicCam::new(0.7, 0.85), HalfTurn;
    lemniscate: Lemniscate::new(0.7), Around(0.2);
    mixed4: Mixed4::new(0.7, 0.85, 1.0, 1.15), HalfTurn;
    moebius: Moebius::new(0.7), HalfTurn;
    named_root: NamedRoot, Entries(0.5);
    offset_wrist: OffsetWrist::new(0.7), HalfTurn;
    phased_cam: PhasedCam, HalfTurn;
    plane_tilt: PlaneTilt::new(0.7), HalfTurn;
    polynomial_knee: PolynomialKnee, Entries(0.5);
    profile_roller: ProfileRoller::new(0.7, 0.85, 1.0), HalfTurn;
    rolling_cone: RollingCone::new(0.7), HalfTurn;
    screw_plane: ScrewPlane::new(0.7), HalfTurn;
    signed_eccentric: SignedEccentric::new(0.7, -0.4, 0.5, 0.3), HalfTurn;
    slider_crank: SliderCrank::new(0.7, 0.85), HalfTurn;
    so3_about: So3About::new(0.7), HalfTurn;
    so3_norm: So3Norm::new(0.7), HalfTurn;
    so3_skew: So3Skew::new(0.7), HalfTurn;
    so3_turn: So3Turn::new(0.7), HalfTurn;
    soft_steps: SoftSteps::new(0.7, 0.85), HalfTurn;
    sphere_skate: SphereSkate::new(0.7), HalfTurn;
    sphere_steer: SphereSteer::new(0.7), Entries(0.5);
    two_vectors: TwoVectors, HalfTurn;
}

/// The law suite alone. Definitions in high precision know Φ as a formula, which relations alone are not, and S by X, which does not tell what
/// moves no body.
macro_rules! laws_alone {
    ($($name:ident: $joint:expr, $reach:expr;)*) => {
        const WITHOUT_DEFINITION: &[&str] = &[$(stringify!($name)),*];
        $(
            #[test]
            fn $name() {
                check_within(&$joint, $reach);
            }
        )*
    };
}

laws_alone! {
    car_steering: CarSteering::new(0.7), Entries(0.5);
    differential_drive: DifferentialDrive::new(0.7, 0.85), Entries(0.5);
    gear_train: GearTrain, Entries(0.5);
    leaning_body: LeaningBody, Entries(0.5);
    motor_platform: MotorPlatform, Entries(0.5);
    watt: Watt, Around(0.1);
}

#[test]
fn every_joint_has_a_test() {
    let registry = hamel_downstream::held_out();
    let names: Vec<&str> = registry.entries().map(|entry| entry.name).collect();
    let mut tested = [TESTED, WITHOUT_DEFINITION].concat();
    tested.sort_unstable();
    assert_eq!(names, tested);
}
