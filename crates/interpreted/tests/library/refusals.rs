//! What is refused: joints that are too large, values of parameters, names that are taken.

use hamel::registry::JointRegistry;
use hamel_interpreted::JointType;

fn type_of(spec: &str, name: &str) -> JointType {
    let derived = hamel_codegen::derive(spec, &format!("{name}.joint"));
    let derived = derived.unwrap_or_else(|errors| panic!("{errors}"));
    JointType::new(&derived).expect("not too large")
}

#[test]
fn joints_that_are_too_large_say_what_of_them_is() {
    let refused = super::common::all()
        .into_iter()
        .filter_map(|(_, own)| own.err());
    let told: Vec<String> = refused.map(|error| error.to_string()).collect();
    assert_eq!(
        told,
        [
            "joint `car` has 8 degrees of freedom: one that is interpreted has at most 6; build it into a program (docs/library.md)"
        ]
    );
}

#[test]
fn values_are_refused_as_emitted_joints_refuse_them() {
    let library = hamel::joints::registry();
    let mut refused = 0;
    for (name, own) in super::common::all() {
        let Ok(own) = own else { continue };
        let entry = library.get(name).expect("a joint of the library");
        let count = entry.parameters.len();
        for value in [0.0, -1.0, 1.0, 0.5, 1e3, f64::NAN, f64::INFINITY] {
            for place in 0..count {
                let mut values = vec![0.7; count];
                values[place] = value;
                let expected = (entry.build)(&values).err().map(|error| error.to_string());
                let told = own.build(&values).err().map(|error| error.to_string());
                assert_eq!(told, expected, "{name} {values:?}");
                refused += usize::from(told.is_some());
            }
        }
        let count = vec![1.0; count + 1];
        let expected = (entry.build)(&count).expect_err("too many").to_string();
        assert_eq!(
            own.build(&count).expect_err("too many").to_string(),
            expected
        );
    }
    assert!(refused > 50, "{refused}");
}

#[test]
fn parameters_without_a_range_are_not_zero() {
    let spec = "hamel = 1;\njoint lead(pitch: m/rad) {\n    config theta: R1;\n    H = trans_z(pitch * theta) * rot_z(theta);\n}\n";
    let told = type_of(spec, "lead")
        .build(&[0.0])
        .expect_err("zero")
        .to_string();
    assert_eq!(
        told,
        "parameter `pitch` of joint type `lead` is 0: it must be other than 0"
    );
}

#[test]
fn a_name_is_taken_once() {
    let mut registry: JointRegistry = hamel::joints::registry();
    let spec = "hamel = 1;\njoint revolute {\n    config theta: R1;\n    H = rot_z(theta);\n}\n";
    let told = type_of(spec, "revolute")
        .register(&mut registry)
        .expect_err("taken")
        .to_string();
    assert_eq!(
        told,
        "a joint type of the name `revolute` is already registered"
    );
}

#[test]
fn an_entry_alone_does_not_build_such_a_joint() {
    let mut registry = JointRegistry::new();
    let spec = "hamel = 1;\njoint slot {\n    config x: R1;\n    H = trans_x(x);\n}\n";
    type_of(spec, "slot")
        .register(&mut registry)
        .expect("a new name");
    let entry = registry.get("slot").expect("registered");
    let told = (entry.build)(&[])
        .expect_err("made while the program runs")
        .to_string();
    assert_eq!(
        told,
        "a joint type that was made while the program runs is built by its registry: JointRegistry::build"
    );
    assert!(registry.build("slot", &[]).expect("registered").is_ok());
}
