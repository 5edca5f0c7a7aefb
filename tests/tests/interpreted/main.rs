//! The law suite on joints that are interpreted, of each kind of spec one, and motions of such joints.

mod ends;

use hamel::joint::Joint;
use hamel_codegen::derived::Derived;
use hamel_interpreted::{Interpreted, JointType};
use hamel_tests::laws::{Reach, check_within};

fn derived(name: &str) -> Derived {
    let text = hamel_joints::spec(name).expect("a joint of the library");
    let derived = hamel_codegen::derive(text, &format!("{name}.joint"));
    derived.unwrap_or_else(|errors| panic!("{errors}"))
}

fn check<
    const N: usize,
    const K: usize,
    const S: usize,
    const C: usize,
    const R: usize,
    const G: usize,
>(
    name: &str,
    parameters: &[f64],
    reach: Reach,
) {
    let exact = JointType::exact(&derived(name), parameters).expect("values that it takes");
    let joint: Interpreted<N, K, S, C, R, G> = exact.expect("its sizes");
    assert_eq!(joint.facts().name, name);
    check_within(&joint, reach);
}

#[test]
fn on_a_line() {
    check::<1, 1, 1, 0, 0, 1>("screw", &[0.7], Reach::HalfTurn);
}

#[test]
fn along_a_curve() {
    check::<2, 1, 1, 0, 0, 1>("ellipse", &[0.9, 0.7], Reach::HalfTurn);
}

#[test]
fn on_a_group() {
    check::<12, 6, 6, 0, 0, 6>("free", &[], Reach::HalfTurn);
}

#[test]
fn on_a_quaternion() {
    check::<4, 3, 3, 0, 0, 3>("ball_quaternion", &[], Reach::HalfTurn);
}

#[test]
fn rolling() {
    check::<11, 5, 3, 2, 0, 5>("falling_disk", &[0.7], Reach::HalfTurn);
}

#[test]
fn in_a_loop() {
    let links = [0.2, 0.85, 1.0, 1.15];
    check::<6, 1, 1, 0, 2, 3>("four_bar", &links, Reach::Around(0.2));
}

/// An independent direction may have a parameter for a factor: v is then the rate divided by it.
#[test]
fn along_a_scaled_direction() {
    let text = "hamel = 1;
        joint half(k: 1 > 0) {
            config   a: S1, b: R1;
            relation a.c = b;
            basis    turn = k * e1 of so2(a);
            home     = [1, 0], 1;
            H        = pose(rot_z(a), [b, 0, 0]);
        }";
    let derived = hamel_codegen::derive(text, "half.joint").expect("a spec that is proved");
    let exact = JointType::exact(&derived, &[0.7]).expect("values that it takes");
    let joint: Interpreted<3, 1, 1, 0, 1, 2> = exact.expect("its sizes");
    check_within(&joint, Reach::HalfTurn);
}

/// Of a parameter that the spec does not describe the unit is told.
#[test]
fn a_missing_parameter_is_told_by_its_unit() {
    let text = "hamel = 1;
        joint raised(height: m) {
            config   a: S1;
            basis    turn of so2(a);
            velocity in child;
            H        = pose(rot_z(a), [0, 0, height]);
        }";
    let derived = hamel_codegen::derive(text, "raised.joint").expect("a spec that is proved");
    let mut registry = hamel_joints::registry();
    let kind = JointType::new(&derived).expect("sizes that are interpreted");
    kind.register(&mut registry).expect("a name of its own");
    let scene = "hamel = 1\n[[body]]\nname = \"link\"\nparent = \"world\"\nmass = 1.0\njoint = { type = \"raised\" }\n";
    let error = hamel_scene::Scene::parse(scene, "scene.toml", &registry);
    let message = error.expect_err("a parameter is missing").to_string();
    assert!(message.contains("= help: its unit is m"), "{message}");
}
