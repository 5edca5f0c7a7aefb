//! The reference of the language keeps its word: its examples are read, and it names all that the language has.

use hamel_codegen::manifold::Kind;
use hamel_codegen::spec::{self, code};

const REFERENCE: &str = include_str!("../../joint-specs/README.md");

/// The chapter on loops.
const LOOPS: &str = include_str!("../../docs/loops.md");

fn examples() -> impl Iterator<Item = &'static str> {
    let blocks = |text: &'static str| text.split("```joint\n").skip(1);
    blocks(REFERENCE)
        .chain(blocks(LOOPS))
        .map(|block| block.split("```").next().unwrap_or_default())
}

#[test]
fn every_example_is_read() {
    assert!(examples().count() >= 10, "the tour has examples");
    for example in examples() {
        if let Err(errors) = spec::parse(example, "README.md") {
            panic!("{errors}");
        }
    }
}

#[test]
fn every_example_is_derived_and_proved() {
    let derived = |example| hamel_codegen::derive(example, "README.md");
    let refused: Vec<String> = examples()
        .filter_map(|example| Some(derived(example).err()?.render()))
        .collect();
    assert!(refused.is_empty(), "{}", refused.join("\n\n"));
}

#[test]
fn every_statement_function_and_manifold_is_named() {
    for statement in spec::STATEMENTS {
        assert!(
            REFERENCE.contains(&format!("| `{statement} ")),
            "statement {statement}"
        );
    }
    for function in spec::FUNCTIONS {
        let named = [format!("`{function}`"), format!("`{function}(")]
            .iter()
            .any(|form| REFERENCE.contains(form));
        assert!(named, "function {function}");
    }
    for kind in Kind::names()
        .into_iter()
        .filter(|name| !["R3", "R4", "R5"].contains(&name.as_str()))
    {
        assert!(REFERENCE.contains(&format!("`{kind}`")), "manifold {kind}");
    }
}

#[test]
fn every_code_is_listed_with_its_meaning() {
    for (code, meaning) in code::ALL {
        assert!(
            REFERENCE.contains(&format!("| {code} | {meaning} |")),
            "{code}"
        );
    }
}
