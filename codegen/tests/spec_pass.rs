//! Specs that must be read: every joint of the library, and what the language promises beyond them.

use hamel_codegen::model::JointSpec;
use hamel_codegen::spec;

#[test]
fn every_joint_of_the_library_is_read() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../joint-specs")).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "joint") {
            let source = std::fs::read_to_string(&path).expect("a text file");
            let start = std::time::Instant::now();
            let spec = spec::parse(&source, "x");
            eprintln!("{path:?} {:?}", start.elapsed());
            let spec: JointSpec = spec.unwrap_or_else(|errors| panic!("{errors}"));
            eprintln!("{:?}\n{:?}", spec.freedoms.value, spec.retract.map(|r|r.value.iter().map(|e|e.to_string()).collect::<Vec<_>>()));
        }
    }
}
