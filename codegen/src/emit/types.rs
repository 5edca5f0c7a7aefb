//! Names of the Rust types that joints become.

/// Names of types in emitted files, which a joint must not take.
const RESERVED_TYPES: &[&str] = &[
    "Arc",
    "AnyJoint",
    "Curve",
    "Joint",
    "JointEntry",
    "Limit",
    "Outside",
    "Patterns",
    "Pose",
    "ParameterError",
    "ParameterInfo",
    "Scalar",
    "SMatrix",
    "SVector",
    "Self",
    "Structure",
    "Structures",
    "VelocityFrame",
    "T",
    "Clone",
    "Copy",
    "Debug",
    "PartialEq",
    "Option",
    "Some",
    "None",
    "Result",
    "Ok",
    "Err",
    "Iterator",
];

/// The name of a joint's type: `planar_euclidean` is `PlanarEuclidean`.
pub fn type_name(joint: &str) -> String {
    let capital = |word: &str| {
        let mut letters = word.chars();
        let first = letters.next().map(|letter| letter.to_ascii_uppercase());
        first.into_iter().chain(letters).collect::<String>()
    };
    let name: String = joint.split('_').map(capital).collect();
    match RESERVED_TYPES.contains(&name.as_str()) {
        true => format!("{name}Joint"),
        false => name,
    }
}
