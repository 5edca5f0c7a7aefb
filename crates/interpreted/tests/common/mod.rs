//! The library's joints twice: compiled, and interpreted from their specs.

use hamel::erased::Shared;
use hamel::joints::specs;
use hamel::registry::{JointRegistry, ParameterError};
use hamel_codegen::derived::Derived;
use hamel_interpreted::{JointType, TooLarge};

/// A joint of the library, derived anew.
pub fn derived(name: &str) -> Derived {
    let (_, text) = specs()
        .find(|(known, _)| *known == name)
        .expect("a joint of the library");
    hamel_codegen::derive(text, &format!("{name}.joint"))
        .unwrap_or_else(|errors| panic!("{errors}"))
}

/// All joints of the library as types that are interpreted, by their names.
pub fn all() -> Vec<(&'static str, Result<JointType, TooLarge>)> {
    specs()
        .map(|(name, _)| (name, JointType::new(&derived(name))))
        .collect()
}

/// A registry of the library's joints, interpreted where they are not too large, else compiled.
pub fn registry() -> JointRegistry {
    let compiled = hamel::joints::registry();
    let mut registry = JointRegistry::new();
    for (name, own) in all() {
        let added = match own {
            Ok(own) => own.register(&mut registry),
            Err(_) => registry.insert(*compiled.get(name).expect("a joint of the library")),
        };
        added.expect("names are unique");
    }
    registry
}

/// A joint with values of its parameters that it takes: near 0.7, and where it refuses these, others.
pub fn example(
    parameters: usize,
    build: impl Fn(&[f64]) -> Result<Shared, ParameterError>,
) -> (Shared, Vec<f64>) {
    let ascending = (0..parameters).map(|i| 0.7 + 0.15 * i as f64);
    let small_second = (0..parameters).map(|i| if i == 1 { 0.2 } else { 0.9 + 0.1 * i as f64 });
    let thirds = (0..parameters).map(|i| 0.9 / 3.0_f64.powi(i as i32));
    let choices: [Vec<f64>; 4] = [
        ascending.clone().collect(),
        ascending.rev().collect(),
        small_second.collect(),
        thirds.collect(),
    ];
    let built = choices
        .into_iter()
        .find_map(|values| Some((build(&values).ok()?, values)));
    built.expect("one of the choices is taken")
}
