//! The library's joints twice: compiled, and interpreted from their specs.

use hamel::joint::Joint;
use hamel::joints::specs;
use hamel::registry::JointRegistry;
use hamel_codegen::derived::Derived;
use hamel_interpreted::{JointType, TooLarge};
use std::collections::BTreeMap;

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

/// Values of the parameters that a joint of the library takes.
pub fn parameters(name: &str) -> Vec<f64> {
    let mut all = BTreeMap::new();
    macro_rules! add {
        ($module:ident, $joint:ty, $example:expr, $($size:literal),*) => {
            let example = $example;
            let values: Vec<f64> = Joint::parameters(&example)
                .map(|(_, value)| value)
                .collect();
            all.insert(stringify!($module), values);
        };
    }
    hamel::joints::for_each_joint!(add);
    all.remove(name).expect("a joint of the library")
}
