//! `hamel parameters` as a user runs it: what it prints for people and for programs, and what it refuses.

mod common;

use common::{hamel, stdout};

const SCENE: &str = "scenes/plate_cart_arm.toml";

/// The number after `before` in a text.
fn number_after(text: &str, before: &str) -> f64 {
    let (_, rest) = text
        .split_once(before)
        .unwrap_or_else(|| panic!("{before}: {text}"));
    let number: String = rest.chars().take_while(|c| !c.is_whitespace()).collect();
    number
        .parse()
        .unwrap_or_else(|_| panic!("{before}{number}: {text}"))
}

#[test]
fn combinations_are_told_body_by_body() {
    let text = stdout(&["parameters", SCENE]);
    assert!(
        text.contains("\n14 base parameters of 30 inertial parameters\n"),
        "{text}"
    );
    // The cart of 4.0 kg carries the end effector of 1.7 kg, as the scene says.
    assert_eq!(
        number_after(&text, "  m(cart) + m(end_effector) = "),
        4.0 + 1.7
    );
    let at_end = text.split_once("end_effector on joint").expect("the body");
    assert!(at_end.1.contains("  regrouped: m\n"), "{text}");
}

#[test]
fn programs_read_the_same_with_all_digits() {
    let text = stdout(&["parameters", SCENE, "--json"]);
    let read: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let length = |key: &str| read[key].as_array().map(Vec::len);
    assert_eq!((length("base"), length("left_out")), (Some(14), Some(16)));
    assert_eq!(
        (&read["count"], &read["parameters"]),
        (&14.into(), &30.into())
    );
    assert_eq!(read["certificate"]["minimal"], true);
    let mass = &read["base"][1];
    assert_eq!(mass["terms"][1]["parameter"], "m(end_effector)");
    assert_eq!(
        (mass["value"].as_f64(), &mass["unit"]),
        (Some(4.0 + 1.7), &"kg".into())
    );
}

#[test]
fn a_tolerance_that_is_none_is_refused() {
    let output = hamel(&["parameters", SCENE, "--tolerance=-1"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("--tolerance") && said.contains("-1"),
        "{said}"
    );
}
