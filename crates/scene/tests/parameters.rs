//! Parameters of joints on their way from the file to the registry, on an entry that tells what it is given.

use hamel_runtime::registry::{JointEntry, JointRegistry, ParameterError, ParameterInfo};
use hamel_scene::Scene;

const PARAMETERS: [ParameterInfo; 2] = [
    ParameterInfo {
        name: "lead",
        unit: "m",
        description: "advance of one turn",
        lower: None,
        upper: None,
    },
    ParameterInfo {
        name: "radius",
        unit: "m",
        description: "distance from the axis",
        lower: None,
        upper: None,
    },
];

/// Refuses every value of `radius`, and thereby shows which one reached it.
fn registry() -> JointRegistry {
    let mut registry = JointRegistry::new();
    let entry = JointEntry {
        name: "coil",
        summary: "for tests",
        parameters: &PARAMETERS,
        build: |values| {
            Err(ParameterError::OutOfRange {
                joint: "coil",
                parameter: "radius",
                value: values[1],
                requirement: "something else",
            })
        },
    };
    registry.insert(entry).expect("the registry is empty");
    registry
}

fn refusal(joint: &str) -> String {
    let text = format!(
        "hamel = 1\ngravity = [0, 0, 0]\n[[body]]\nname = \"link\"\nparent = \"world\"\nmass = 1\n\
         inertia = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\njoint = {joint}\n"
    );
    let refused = Scene::parse(&text, "scene.toml", &registry());
    refused.expect_err("the entry builds nothing").to_string()
}

#[test]
fn values_arrive_in_the_order_of_the_entry() {
    let message = refusal("{ radius = 0.25, type = \"coil\", lead = 2 }");
    assert!(
        message.contains("joint `link`: parameter `radius` of joint type `coil` is 0.25"),
        "{message}"
    );
    assert!(message.contains("--> scene.toml:8:9"), "{message}");
}

#[test]
fn a_missing_parameter_is_named_with_its_unit() {
    let message = refusal("{ type = \"coil\", lead = 0.01 }");
    assert!(
        message.contains("the type `coil` needs the parameter `radius`"),
        "{message}"
    );
    assert!(message.contains("distance from the axis, m"), "{message}");
}

#[test]
fn an_unknown_parameter_gets_the_nearest_name() {
    let message = refusal("{ type = \"coil\", lead = 0.01, radus = 1 }");
    assert!(
        message.contains("the type `coil` has no parameter `radus`"),
        "{message}"
    );
    assert!(message.contains("did you mean `radius`?"), "{message}");
    assert!(
        message.contains("needs the parameter `radius`"),
        "{message}"
    );
}
