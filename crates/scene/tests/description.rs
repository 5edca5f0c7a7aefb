//! What a file says, before any joint is looked up: values, order, defaults, and text that is no scene.

use hamel_integrate::Method;
use hamel_scene::{Scene, SceneDescription, Settings};
use nalgebra::{Matrix3, Vector3};

const INERTIA: &str = "inertia_xx_yy_zz_xy_xz_yz = [0.3, 0.4, 0.5, 0.01, 0.02, 0.03]\n";

fn body(name: &str, parent: &str, more: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nparent = \"{parent}\"\nmass = 2\n{INERTIA}joint = {{ type = \"any\" }}\n{more}\n"
    )
}

fn read(rest: &str) -> SceneDescription {
    let text = format!("hamel = 1\ngravity = [0, 0, -9.81]\n{rest}");
    Scene::from_toml(&text, "folder/some scene.toml").expect("a sound text")
}

#[test]
fn parents_come_first_whatever_the_file_says() {
    let rest = body("hand", "arm", "") + &body("arm", "base", "") + &body("base", "world", "");
    let bodies = read(&rest).bodies;
    let names: Vec<&str> = bodies.iter().map(|body| body.name.value.as_str()).collect();
    let parents: Vec<Option<usize>> = bodies.iter().map(|body| body.parent).collect();
    assert_eq!(names, ["base", "arm", "hand"]);
    assert_eq!(parents, [None, Some(0), Some(1)]);
}

#[test]
fn what_is_absent_has_its_default() {
    let scene = read(&body("link", "world", ""));
    assert_eq!(scene.name, "some scene");
    assert_eq!(scene.settings, Settings::default());
    let link = &scene.bodies[0];
    assert_eq!(link.joint.name.value, "link");
    assert_eq!(link.mass.com, Vector3::zeros());
    assert_eq!(link.at, hamel_runtime::spatial::Pose::identity());
}

/// A file written on Windows says the same as one written elsewhere, and descriptions come through the writer as they are.
#[test]
fn a_description_has_lines_and_tabs_whatever_ends_the_lines() {
    let unix = format!(
        "hamel = 1\ngravity = [0, 0, -9.81]\ndescription = \"\"\"\nFirst:\n\tsecond\n\"\"\"\n{}",
        body("link", "world", "")
    );
    let windows = unix.replace('\n', "\r\n");
    for text in [unix, windows] {
        let scene = Scene::from_toml(&text, "scene.toml").expect("a sound text");
        assert_eq!(scene.description, "First:\n\tsecond\n");
        let written = scene.to_toml(&[], |_| Vec::new());
        let again = Scene::from_toml(&written, "written.toml").expect("a sound text");
        assert_eq!(again.description, scene.description);
    }
}

#[test]
fn six_moments_fill_a_symmetric_matrix() {
    let link = &read(&body("link", "world", "")).bodies[0];
    let matrix = Matrix3::new(0.3, 0.01, 0.02, 0.01, 0.4, 0.03, 0.02, 0.03, 0.5);
    assert_eq!(link.mass.inertia_com, matrix);
}

#[test]
fn numbers_are_the_nearest_doubles() {
    let position = "at = { position = [0.1, 9007199254740993, 0x10] }";
    let at = read(&body("link", "world", position)).bodies[0].at;
    assert_eq!(at.translation, Vector3::new(0.1, 9007199254740992.0, 16.0));
    let digits = "at = { position = [2.2250738585072011e-308, 1e23, 1_000.5] }";
    let at = read(&body("link", "world", digits)).bodies[0].at;
    assert_eq!(
        at.translation,
        Vector3::new(2.225073858507201e-308, 1e23, 1000.5)
    );
}

#[test]
fn an_accuracy_implies_its_method() {
    let link = body("link", "world", "");
    let method = |table: &str| {
        read(&format!("{link}[simulation]\n{table}"))
            .settings
            .method
    };
    assert_eq!(method("dt = 0.25"), Method::rk4(0.25));
    assert_eq!(method("method = 'rk4'"), Method::rk4(Settings::DEFAULT_DT));
}

/// Without a method and without a step the method is chosen from the scene.
#[test]
fn the_method_is_chosen_unless_it_is_named() {
    let link = body("link", "world", "");
    let settings = |table: &str| read(&format!("{link}[simulation]\n{table}")).settings;
    for (table, chooses) in [
        ("", true),
        ("tol = 0.05", true),
        ("method = 'auto'", true),
        ("method = 'dopri5'\ntol = 0.05", false),
        ("dt = 0.25", false),
        ("method = 'rk4'", false),
    ] {
        assert_eq!(settings(table).chooses, chooses, "{table}");
    }
    assert_eq!(settings("tol = 0.05").method, Method::dormand_prince(0.05));
}

#[test]
fn errors_know_their_line_and_column() {
    let text =
        "hamel = 1\ngravity = [0, 0, 0]\n[[body]]\nname = \"ä\"\nparent = \"ö\"   # a\nmass = -1\n";
    let errors =
        Scene::from_toml(text, "scene.toml").expect_err("a mass below 0 is one of its mistakes");
    let place = |part: &str| {
        let error = errors
            .errors()
            .iter()
            .find(|error| error.message().contains(part));
        let span = error
            .and_then(|error| error.span())
            .expect("an error with a place");
        errors.line_and_column(span.start)
    };
    assert_eq!(place("parent \"ö\""), (5, 10));
    assert_eq!(place("`joint` is missing"), (3, 1));
}

/// Every prefix of a scene, and the scene with one byte changed, is read or refused; nothing panics.
#[test]
fn mutilated_text_is_refused_in_order() {
    let text = include_str!("../../../scenes/plate_cart_arm.toml");
    for end in (0..text.len()).filter(|&end| text.is_char_boundary(end)) {
        let refused = Scene::from_toml(&text[..end], "scene.toml");
        assert!(refused.map_or_else(|errors| !errors.to_string().is_empty(), |_| true));
    }
    for (at, character) in text.char_indices() {
        for replacement in ["[", "\"", "=", "}", "-", "9", "é", "\n"] {
            let rest = &text[at + character.len_utf8()..];
            let changed = format!("{}{replacement}{rest}", &text[..at]);
            if let Err(errors) = Scene::from_toml(&changed, "scene.toml") {
                assert!(!errors.to_string().is_empty());
            }
        }
    }
}

#[test]
fn bodies_of_a_coupling_follow_each_other() {
    let mimic = "mimic = { joint = \"left\", multiplier = -1.0 }";
    let bodies =
        body("left", "world", "") + &body("between", "left", "") + &body("right", "world", mimic);
    let mut scene = read(&bodies.replace("\"any\"", "\"revolute\""));
    let names = |scene: &SceneDescription| -> Vec<String> {
        let bodies = scene.bodies.iter();
        bodies.map(|body| body.name.value.clone()).collect()
    };
    assert_eq!(names(&scene), ["left", "right", "between"]);
    let coupled = scene.coupled().expect("a coupling");
    let parts: Vec<bool> = coupled
        .bodies
        .iter()
        .map(|body| body.part.is_some())
        .collect();
    assert_eq!(parts, [true, true, false]);
    scene.bodies.swap(1, 2);
    let told = scene.coupled().expect_err("bodies apart").to_string();
    let wanted = "body `right`: it does not follow the other bodies of its coupling";
    assert!(told.contains(wanted), "{told}");
}
