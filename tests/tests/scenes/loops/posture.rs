//! Postures in which loops are put together, and what of a loop is rounding.

use super::super::trials::scene;
use chacha20::ChaCha8Rng;
use hamel_scene::{Scene, urdf};
use rand::{RngExt, SeedableRng};
use std::f64::consts::{FRAC_PI_2, TAU};
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

/// Turns about axes that meet to within 5e-17 m: three of the relations of the hinge that closes them follow from two.
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

/// A four-bar of three bodies on hinges about z: the crank and the rocker on the world, the ground's length apart, and the coupler on the crank.
fn four_bar([ground, crank, coupler, rocker]: [f64; 4], said: [&str; 3], at: [f64; 2]) -> String {
    let body = |name: &str, parent: &str, (x, angle): (f64, f64), said: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\n{REVOLUTE}\nat = {{ position = [{x:?}, 0.0, 0.0], rpy = [0.0, 0.0, {angle:?}] }}\n{said}\n"
        )
    };
    body("crank", "world", (0.0, at[0]), said[0])
        + &body("coupler", "crank", (crank, 0.0), said[1])
        + &body("rocker", "world", (ground, at[1]), said[2])
        + &format!(
            "[[loop]]\nname = \"closed\"\ntype = \"revolute\"\npredecessor = {{ body = \"coupler\", at.position = [{coupler:?}, 0.0, 0.0] }}\n\
             successor = {{ body = \"rocker\", at.position = [{rocker:?}, 0.0, 0.0] }}\nindependent = [\"crank\"]\n"
        )
}

/// Angles of coupler and rocker with which a four-bar closes at this angle of the crank: where two circles meet.
fn closures([ground, crank, coupler, rocker]: [f64; 4], angle: f64) -> Vec<[f64; 2]> {
    let (x, y) = (ground - crank * angle.cos(), -crank * angle.sin());
    let apart = x.hypot(y);
    let cosine = (coupler * coupler - apart * apart - rocker * rocker) / (2.0 * apart * rocker);
    let sides = [1.0, -1.0].into_iter().filter(|_| cosine.abs() <= 1.0);
    sides
        .map(|side| {
            let own = y.atan2(x) + side * cosine.acos();
            let (x, y) = (x + rocker * own.cos(), y + rocker * own.sin());
            [y.atan2(x) - angle, own]
        })
        .collect()
}

/// An angle by whole turns as near to another as it can be.
fn turned(angle: f64, near: f64) -> f64 {
    angle - TAU * ((angle - near) / TAU).round()
}

/// Crank, coupler and rocker at time 0.
fn start(scene: &Scene) -> [f64; 3] {
    let (_, body) = scene.mechanism.joints().next().expect("one joint");
    let q = body.configuration(&scene.configuration);
    ["crank", "coupler", "rocker"].map(|name| {
        let mut ports = body.joint().ports().iter();
        let port = ports.position(|port| port.name == name);
        body.joint()
            .port_value(q, port.expect("a port of that name"))
    })
}

/// Rough guesses about one of both closures, also of a rhombus that can fold flat, and of one that nearly folds.
#[test]
fn loops_are_put_together_in_the_posture_nearest_to_what_is_said() {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let mut cases = 0;
    for lengths in [
        [0.3, 0.3, 0.3, 0.3],
        [0.3, 0.12, 0.35, 0.25],
        [0.4, 0.2, 0.4, 0.2],
        [0.3, 0.25, 0.2, 0.3],
    ] {
        for _ in 0..40 {
            let angle = random.random_range(0.3..2.0);
            let known = closures(lengths, angle);
            let Some(&[coupler, rocker]) = known.first() else {
                continue;
            };
            let guess = [coupler, rocker].map(|at| at + random.random_range(-0.6..0.6));
            let distance = |[coupler, rocker]: [f64; 2]| {
                let away = |value: f64, guess: f64| turned(value, guess) - guess;
                away(coupler, guess[0]).hypot(away(rocker, guess[1]))
            };
            let nearest = known.iter().map(|own| distance(*own));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            let said =
                [angle, guess[0], guess[1]].map(|phi| format!("initial = {{ phi = [{phi:?}] }}"));
            let text = four_bar(lengths, said.each_ref().map(String::as_str), [0.0; 2]);
            let found = start(&scene(&text));
            let own = (found[1] - guess[0]).hypot(found[2] - guess[1]);
            // Rounding of what closes the loop, much magnified where both closures are near each other.
            assert!(
                own <= nearest + 1e-6 && (found[0] - angle).abs() < 1e-12,
                "{lengths:?}, crank {angle}, guess {guess:?}: {found:?} is {own} away, the nearest is {nearest}"
            );
            cases += 1;
        }
    }
    assert!(cases > 100, "{cases}");
}

/// Each of both closures, and a whole turn on either side of it: nothing is said of where coupler and rocker are but the rocker's limit.
#[test]
fn loops_are_put_together_within_limits() {
    let lengths = [0.4, 0.3, 0.3, 0.3];
    for crank in [-1.1, 0.4, 1.2] {
        let known = closures(lengths, crank);
        assert_eq!(known.len(), 2, "{crank}");
        for [_, rocker] in known {
            for turns in [-1.0, 0.0, 1.0] {
                // The rocker's own zero is a quarter turn away.
                let wanted = rocker - FRAC_PI_2 + turns * TAU;
                let limit = format!(
                    "limit = {{ lower = {:?}, upper = {:?}, stiffness = 1e4 }}",
                    wanted - 0.3,
                    wanted + 0.2
                );
                let text = four_bar(lengths, ["", "", &limit], [crank, FRAC_PI_2]);
                let found = start(&scene(&text))[2];
                // Rounding of what closes the loop.
                assert!(
                    (found - wanted).abs() < 1e-9,
                    "crank {crank}: {found}, not {wanted}"
                );
            }
        }
    }
}

/// The rod's zero leads the slider to stand the other way round, until it is turned by more than a quarter turn.
#[test]
fn a_slider_is_put_together_the_right_way_round() {
    let name = "data/urdf/loops/slider_crank.urdf";
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    let text = std::fs::read_to_string(file).expect("a robot");
    let rod = "<child link=\"rod\"/><origin xyz=\"0.12 0 0\"/>";
    assert!(text.contains(rod), "the rod's origin");
    for step in 0..24 {
        let angle = f64::from(step) * TAU / 24.0 + 0.01;
        let turned = text.replace(
            rod,
            &format!("<child link=\"rod\"/><origin rpy=\"0 0 {angle}\" xyz=\"0.12 0 0\"/>"),
        );
        let import = urdf::read(&turned, "robot.urdf", &urdf::Options::default());
        let import = import.unwrap_or_else(|errors| panic!("{angle}: {errors}"));
        let built = import.build(&hamel_joints::registry());
        let built = built.unwrap_or_else(|errors| panic!("{angle}: {errors}"));
        assert_eq!(built.mechanism.layout().freedoms, 1);
    }
}
