//! Every spec of the joint library is accepted, and proved without recourse to numbers.

use hamel_codegen::derived::Proof;
use std::path::Path;

#[test]
fn every_spec_is_proved_in_symbols() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../joint-specs");
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("the joint library is beside this crate") {
        let path = entry.expect("a folder entry").path();
        if path
            .extension()
            .is_none_or(|extension| extension != "joint")
        {
            continue;
        }
        let source = std::fs::read_to_string(&path).expect("the spec can be read");
        let joint = hamel_codegen::derive(&source, &path.to_string_lossy())
            .unwrap_or_else(|errors| panic!("{errors}"));
        assert!(
            joint
                .claims
                .iter()
                .all(|claim| claim.proof != Proof::Checked),
            "{}",
            joint.spec.name.value
        );
        assert!(
            joint.claims.len() >= 7,
            "{}: {:#?}",
            joint.spec.name.value,
            joint.claims
        );
        seen += 1;
    }
    assert!(seen >= 7, "only {seen} specs");
}
