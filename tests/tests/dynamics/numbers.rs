//! Modules of a build script, which has no compiled joints to simulate with: what is not a finite number is refused with the element that makes it.

use hamel_compiler::functions::Kind;
use hamel_compiler::{Error, Language, scene_of};
use hamel_scene::{Scene, SceneDescription};

fn described(text: &str) -> SceneDescription {
    let text = format!("hamel = 1\ngravity = [0.0, 0.0, -9.81]\n{text}");
    Scene::from_toml(&text, "numbers.toml").unwrap_or_else(|errors| panic!("{errors}"))
}

/// The reasons why a scene is refused, in each language.
fn refused(text: &str) -> Vec<String> {
    refused_description(&described(text))
}

fn refused_description(description: &SceneDescription) -> Vec<String> {
    let both = [Language::Rust, Language::C99].map(|language| {
        let build = scene_of("numbers", description.clone())
            .library(hamel_joints::specs())
            .language(language)
            .functions(Kind::ALL);
        match build.module("numbers.toml") {
            Err(Error::Refused(refused)) => refused.reasons,
            Err(other) => panic!("another error: {other}"),
            Ok(module) => panic!("accepted: {}", module.text),
        }
    });
    let [rust, c] = both;
    assert_eq!(rust, c);
    rust
}

fn body(name: &str, parent: &str, rest: &str) -> String {
    format!("[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\n{rest}\n")
}

const NONE: &str = "inertia = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]";
const REGULAR: &str =
    "mass = 1.0\ncom = [0.1, 0.0, 0.0]\ninertia = [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0.1]]";
const HINGE: &str = "joint = { type = \"revolute\", name = \"hinge\" }";

#[test]
fn a_joint_that_moves_no_inertia_is_named() {
    for mass in ["mass = 0", "mass = 1.0\ncom = [0.0, 0.0, 0.5]"] {
        let reasons = refused(&body("arm", "world", &format!("{mass}\n{NONE}\n{HINGE}")));
        assert_eq!(
            reasons,
            [
                "the mass matrix is singular at joint `hinge`, speed `q`: its pivot 0e0 is not above 0e0; give mass or inertia to the \
                 bodies that this joint moves"
            ]
        );
    }
    let arm = body("arm", "world", &format!("{REGULAR}\n{HINGE}"));
    let slot = "joint = { type = \"prismatic\", name = \"slot\" }";
    let tip = body("tip", "arm", &format!("mass = 0\n{NONE}\n{slot}"));
    let reasons = refused(&format!("{arm}{tip}"));
    assert!(
        reasons.iter().any(|reason| reason.contains("`slot`")),
        "{reasons:?}"
    );
    assert!(
        reasons.iter().all(|reason| !reason.contains("`hinge`")),
        "{reasons:?}"
    );
}

#[test]
fn what_leaves_the_range_of_doubles_is_named() {
    let heavy = body(
        "arm",
        "world",
        &format!("mass = 1e300\ncom = [1e10, 0, 0]\n{NONE}\n{HINGE}"),
    );
    assert_eq!(
        refused(&heavy),
        ["body `arm`: its inertia about its joint is beyond the range of numbers"]
    );
    let arm = body("arm", "world", &format!("{REGULAR}\n{HINGE}"));
    let stiff = "[[spring]]\nfrom = { body = \"arm\", point = [0.1, 0, 0] }\nto = { body = \"world\", point = [1, 0, 0] }\nstiffness = 1e308\nlength = 1e10\n";
    let reasons = refused(&format!("{arm}{stiff}"));
    assert_eq!(reasons, ["spring 1 comes to a number that is not finite"]);
    // The spring of a joint, beside whose stiffness an inertia of 0.1 kg m² is too little.
    let spring = "spring = { stiffness = 1e308, rest = { configuration = [1e10] } }";
    let arm = body("arm", "world", &format!("{REGULAR}\n{HINGE}\n{spring}"));
    let reasons = refused(&arm);
    assert!(
        reasons
            .iter()
            .all(|reason| reason.contains("joint `hinge`")),
        "{reasons:?}"
    );
    // Two bodies of which each is within the range, and the two together are not.
    let heavy = |name: &str, parent: &str, joint: &str| {
        let joint = format!("joint = {{ type = \"prismatic\", name = \"{joint}\" }}");
        body(name, parent, &format!("mass = 1e308\n{NONE}\n{joint}"))
    };
    let reasons = refused(&format!(
        "{}{}",
        heavy("a", "world", "first"),
        heavy("b", "a", "second")
    ));
    assert!(
        reasons[0].starts_with("body `a` (joint `first`)"),
        "{reasons:?}"
    );
}

/// Numbers at the ends of the range are written, and read back as they are.
#[test]
fn what_is_small_or_large_and_finite_is_written() {
    for number in ["5e-324", "1e-310", "2.5e-308", "1e150", "-0.0"] {
        let text = body(
            "arm",
            "world",
            &format!("{REGULAR}\n{HINGE}\neffort = [{number}]"),
        );
        for language in [Language::Rust, Language::C99] {
            let build = scene_of("numbers", described(&text))
                .library(hamel_joints::specs())
                .language(language);
            let module = build
                .module("numbers.toml")
                .unwrap_or_else(|error| panic!("{number}: {error}"));
            assert!(
                !module.text.contains("inf") && !module.text.contains("INF"),
                "{number}"
            );
        }
    }
}

/// A description by a program: no index of it is trusted.
#[test]
fn bodies_that_are_not_there_are_named() {
    let arm = body("arm", "world", &format!("{REGULAR}\n{HINGE}"));
    let tip = body(
        "tip",
        "arm",
        &format!("{REGULAR}\njoint = {{ type = \"ball\", name = \"elbow\" }}"),
    );
    let more = "[[spring]]\nfrom = { body = \"arm\", point = [0.1, 0, 0] }\nto = { body = \"world\", point = [1, 0, 0] }\nstiffness = 1.0\n\
                [[wrench]]\nbody = \"tip\"\nforce = [1, 0, 0]\naxes = \"world\"\n";
    let description = described(&format!("{arm}{tip}{more}"));
    for index in [1, 7, usize::MAX] {
        let mut wrong = description.clone();
        wrong.bodies[1].parent = Some(index);
        let reasons = refused_description(&wrong);
        assert!(
            reasons[0].contains("a parent comes before its children"),
            "{reasons:?}"
        );
        assert!(wrong.build(&hamel_joints::registry()).is_err());
    }
    for index in [2, usize::MAX] {
        let mut wrong = description.clone();
        wrong.springs[0].from.body = Some(index);
        wrong.wrenches[0].body = index;
        let reasons = refused_description(&wrong);
        assert_eq!(reasons.len(), 2, "{reasons:?}");
        assert!(
            reasons[0].starts_with("spring 1: there is no body of index"),
            "{reasons:?}"
        );
        assert!(wrong.build(&hamel_joints::registry()).is_err());
    }
    let mut wrong = description.clone();
    wrong.bodies[0].mass.mass = f64::NAN;
    assert!(refused_description(&wrong)[0].contains("body `arm`: mass is NaN"));
}
