//! Postures in which loops are put together, and what of a loop is rounding.

use super::super::trials::scene;
use hamel_scene::urdf;
use std::path::Path;

const REVOLUTE: &str = "mass = 1.0\ninertia_xx_yy_zz_xy_xz_yz = [0.01, 0.012, 0.014, 0.001, -0.001, 0.0005]\njoint = { type = \"revolute\" }";

/// At home the links are in a line that is too long, from which no small motion leads; a URDF says of no other posture.
#[test]
fn a_loop_is_put_together_away_from_home() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/urdf-bad/loop_stretched.urdf");
    let text = std::fs::read_to_string(file).expect("a robot");
    let reaches = text.replace("xyz=\"1.45 0 0\"", "xyz=\"0.45 0 0\"");
    assert_ne!(text, reaches);
    let import = urdf::read(&reaches, "robot.urdf", &urdf::Options::default());
    let import = import.unwrap_or_else(|errors| panic!("{errors}"));
    let built = import.build(&hamel_joints::registry());
    let built = built.unwrap_or_else(|errors| panic!("{errors}"));
    let told: Vec<String> = built.notices.iter().map(ToString::to_string).collect();
    assert!(
        told.iter()
            .any(|own| own.contains("so that it closes: `b` at ")),
        "{told:?}"
    );
    for (_, body) in built.mechanism.joints() {
        let residual = body
            .joint()
            .residual(body.configuration(&built.configuration));
        // Rounding of a few products of lengths of half a metre.
        assert!(residual < 1e-14, "{residual:e}");
    }
}

/// Turns about axes that meet but for 5e-17 m: three of the relations of the hinge that closes them follow from two.
#[test]
fn lengths_that_are_rounding_are_none() {
    let bodies: String = [
        ("a", "world", "{ axis = [0.0, 0.0, 1.0] }", "phi = [0.7], speeds = [2.0]"),
        ("b", "a", "{ axis = [1.0, 0.0, 0.9] }", "phi = [0.6]"),
        (
            "c",
            "world",
            "{ position = [5e-17, 0.0, 0.0], axis = [0.3, 1.0, 0.5] }",
            "phi = [0.4]",
        ),
    ]
    .map(|(name, parent, at, initial)| {
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\n{REVOLUTE}\nat = {at}\ninitial = {{ {initial} }}\n"
        )
    })
    .concat();
    let scene = scene(&format!(
        "{bodies}[[loop]]\nname = \"l\"\ntype = \"revolute\"\npredecessor = {{ body = \"b\", at.axis = [0.2, 0.6, 1.0] }}\n\
         successor = {{ body = \"c\", at = {{ position = [-4.0848707377688385e-17, 2.5757962998086472e-17, -1.29580263837204e-17], \
         rotation = [[0.4520268884337125, -0.841436745929167, -0.2960673820823071], [0.8513922511900827, 0.5059986592268456, -0.13819041744678756], [0.26608819354946783, -0.18960369052518256, 0.9451177248326325]] }} }}\n"
    ));
    assert_eq!(scene.mechanism.layout().freedoms, 1);
}

/// Of four joints three are independent; the one whose rate is given is among them, so that the others are at rest.
#[test]
fn joints_of_given_rates_are_independent() {
    let body = |name: &str, parent: &str, x: f64, initial: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\n{REVOLUTE}\nat.position = [{x:?}, 0.0, 0.0]\n{initial}\n"
        )
    };
    let bodies = body(
        "a",
        "world",
        0.0,
        "initial = { phi = [0.3], speeds = [1.0] }",
    ) + &body("b", "a", 0.3, "")
        + &body("c", "world", 0.5, "")
        + &body("d", "c", 0.3, "");
    let scene = scene(&format!(
        "{bodies}[[coupling]]\nname = \"k\"\npredecessor = \"b\"\nsuccessor = \"d\"\nratio = -1.5\noffset = 0.25\n"
    ));
    assert_eq!(scene.mechanism.layout().freedoms, 3);
    assert_eq!(scene.speeds, [1.0, 0.0, 0.0]);
}
