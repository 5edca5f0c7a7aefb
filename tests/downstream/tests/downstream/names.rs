//! Names that emitted files use themselves are names of joints and parameters as any other.

use hamel_downstream::names;

#[test]
fn joints_and_parameters_may_be_called_like_what_is_emitted() {
    for entry in names() {
        let ones: Vec<f64> = entry.parameters.iter().map(|_| 1.0).collect();
        let joint = (entry.build)(&ones).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(joint.name(), entry.name);
    }
}

/// Constants in the requirement keep their values beside parameters of their names.
#[test]
fn requirements_are_checked_beside_parameters_called_like_constants() {
    let mut entries = names().into_iter();
    let entry = entries.find(|entry| entry.name == "parameters");
    let entry = entry.expect("a joint with parameters");
    let build = |value: f64| (entry.build)(&vec![value; entry.parameters.len()]);
    // The first counts twice: 11 values stand on the left of the requirement.
    assert!(build(1.5 / 11.0 + 1e-9).is_ok());
    assert!(build(1.5 / 11.0 - 1e-9).is_err());
}

#[test]
fn zero_is_no_value_of_a_parameter_without_a_range() {
    let mut entries = names().into_iter();
    let entry = entries.find(|entry| entry.name == "parameters");
    let entry = entry.expect("a joint with parameters");
    for n in 0..entry.parameters.len() {
        let mut values = vec![1.0; entry.parameters.len()];
        values[n] = 0.0;
        let error = (entry.build)(&values).err().map(|error| error.to_string());
        let name = entry.parameters[n].name;
        assert!(
            error.is_some_and(|error| error.contains(name) && error.contains("other than 0")),
            "{name}"
        );
    }
}
